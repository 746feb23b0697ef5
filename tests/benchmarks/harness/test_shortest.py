"""Shortest walks are checked against closed forms and against distances on a fine grid."""

import heapq
import math

import numpy as np
import pytest
import shapely
from shapely import Point, Polygon, box

from benchmarks.harness.shortest import free_space, shortest_loop, shortest_way
from benchmarks.worlds.makers import scenario

BEND = Polygon([(0, 0), (10, 0), (10, 10), (8, 10), (8, 2), (0, 2)])


def by_grid(free: Polygon, start: Point, goal: Polygon, step: float = 0.5) -> float:
    """Return the length of the shortest 8-connected way over points half a square apart within free space."""
    west, south, east, north = free.bounds
    x, y = np.meshgrid(np.arange(west, east + step, step), np.arange(south, north + step, step))
    inside = shapely.intersects_xy(free, x, y)
    ends = shapely.intersects_xy(goal.intersection(free).buffer(1e-9), x, y)
    j, i = round((start.y - south) / step), round((start.x - west) / step)
    best = {(j, i): 0.0}
    todo = [(0.0, j, i)]
    while todo:
        length, j, i = heapq.heappop(todo)
        if ends[j, i]:
            return length
        for dj in (-1, 0, 1):
            for di in (-1, 0, 1):
                b, a = j + dj, i + di
                if 0 <= b < len(x) and 0 <= a < len(x[0]) and inside[b, a] and inside[j, a] and inside[b, i]:
                    way = length + step * math.hypot(dj, di)
                    if way < best.get((b, a), math.inf):
                        best[b, a] = way
                        heapq.heappush(todo, (way, b, a))
    return math.inf


def test_the_way_is_straight_where_nothing_stands_between() -> None:
    assert shortest_way(box(0, 0, 9, 9), Point(1, 1), box(4, 5, 6, 8)) == pytest.approx(5.0)


def test_the_way_goes_around_a_bend() -> None:
    free = free_space(BEND, [], Point(1, 1))
    assert shortest_way(free, Point(1, 1), box(9, 8, 10, 10)) == pytest.approx(math.hypot(7, 1) + math.hypot(1, 6))


def test_the_last_leg_may_touch_a_corner() -> None:
    free = free_space(BEND, [], Point(1, 1.5))
    assert shortest_way(free, Point(1, 1.5), Point(9, 9)) == pytest.approx(math.hypot(7, 0.5) + math.hypot(1, 7))


def test_there_is_no_way_to_an_unreachable_region() -> None:
    free = free_space(box(0, 0, 9, 9).difference(box(4, 0, 5, 9)), [], Point(1, 1))
    assert shortest_way(free, Point(1, 1), box(7, 7, 8, 8)) == math.inf
    assert shortest_way(free, Point(1, 1), box(0, 0, 2, 2)) == 0.0


def test_a_loop_is_the_hull_of_start_and_obstacle() -> None:
    square = box(10, 10, 14, 14)
    start = Point(12, 2)
    free = free_space(box(0, 0, 24, 24), [square], start)
    hull = shapely.union(square, start).convex_hull.exterior.length
    assert shortest_loop(free, start, square.centroid) == pytest.approx(hull)


def test_there_is_no_loop_around_an_object_against_the_wall() -> None:
    free = free_space(box(0, 0, 24, 24), [box(0, 10, 4, 14)], Point(12, 2))
    assert shortest_loop(free, Point(12, 2), Point(2, 12)) == math.inf


@pytest.mark.parametrize("seed", range(12, 20))
def test_ways_in_random_worlds_are_within_an_eighth_of_the_grid_distance(seed: int) -> None:
    world = scenario(1, seed)
    start = Point(math.floor(world.utak.x) + 0.5, math.floor(world.utak.y) + 0.5)
    free = free_space(world.plan.floor, [thing.polygon for thing in world.things], start)
    exact, grid = shortest_way(free, start, world.target), by_grid(free, start, world.target)
    assert exact <= grid + 1e-9
    assert grid <= 1.1 * exact + 1.0
