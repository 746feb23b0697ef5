"""Ways over a raster against Dijkstra's algorithm on a graph, and winding ways against angles."""

import heapq
import itertools
import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from geometry.raster.geodesic import UNREACHED, reach
from geometry.raster.winding import MOST, crossings, winding_way

STEPS = [(dr, dc) for dr in (-1, 0, 1) for dc in (-1, 0, 1) if dr or dc]


def moves(free: np.ndarray, row: int, column: int):  # type: ignore[no-untyped-def]
    """Squares reached in one step, with its cost; no corner of a blocked square is cut."""
    for dr, dc in STEPS:
        p, q = row + dr, column + dc
        if 0 <= p < free.shape[0] and 0 <= q < free.shape[1] and free[p, q] and free[row, q] and free[p, column]:
            yield (p, q), 7 if dr and dc else 5


def ways(free: np.ndarray, start: tuple[int, int]) -> dict[tuple[int, int], int]:
    best, queue = {start: 0}, [(0, start)]
    while queue:
        far, square = heapq.heappop(queue)
        if far == best[square]:
            for other, cost in moves(free, *square):
                if far + cost < best.get(other, 10**9):
                    best[other] = far + cost
                    heapq.heappush(queue, (far + cost, other))
    return best


def raster(rows: int, columns: int, seed: int) -> tuple[np.ndarray, np.random.Generator]:
    rng = np.random.default_rng(seed)
    return rng.random((rows, columns)) < rng.uniform(0.5, 1.0), rng


@settings(max_examples=100, deadline=None)
@given(st.integers(1, 12), st.integers(1, 12), st.integers(0, 2**32 - 1))
def test_reach_is_dijkstra(rows: int, columns: int, seed: int) -> None:
    free, rng = raster(rows, columns, seed)
    row, column = int(rng.integers(rows)), int(rng.integers(columns))
    free[row, column] = True
    want = np.full(free.shape, UNREACHED)
    for square, far in ways(free, (row, column)).items():
        want[square] = far
    assert np.array_equal(reach(free, column, row), want)


def test_a_start_in_a_wall_or_outside_is_refused() -> None:
    free = np.array([[True, False]])
    for column, row in ((1, 0), (2, 0), (-1, 0), (0, 1)):
        with pytest.raises(ValueError, match="not a free square"):
            reach(free, column, row)


point = st.tuples(st.integers(-9, 9), st.integers(-9, 9)).map(lambda p: (p[0] + 0.5, p[1] + 0.25))


def turning(points: list[tuple[float, float]], about: tuple[float, float]) -> float:
    """How far a polyline turns about a point, in full turns, by angles."""
    angles = [math.atan2(y - about[1], x - about[0]) for x, y in points]
    steps = [(b - a + math.pi) % (2 * math.pi) - math.pi for a, b in itertools.pairwise(angles)]
    return sum(steps) / (2 * math.pi)


@settings(max_examples=300, deadline=None)
@given(st.lists(point, min_size=2, max_size=12))
def test_crossings_of_a_closed_line_are_its_turns(points: list[tuple[float, float]]) -> None:
    about = (0.1, 0.1)
    closed = [*points, points[0]]
    for (ax, ay), (bx, by) in itertools.pairwise(closed):  # no side through the point itself
        cross = (bx - ax) * (about[1] - ay) - (by - ay) * (about[0] - ax)
        assume(abs(cross) > 1e-6 or (ax, ay) == (bx, by))
    assert crossings(np.array(closed), about) == round(turning(closed, about))


@settings(max_examples=300, deadline=None)
@given(st.lists(point, min_size=1, max_size=6), st.lists(point, min_size=1, max_size=6), point)
def test_crossings_add_up_and_turn_round(one: list, other: list, middle: tuple[float, float]) -> None:
    first, second = np.array([*one, middle]), np.array([middle, *other])
    about = (0.1, 0.1)
    assert crossings(np.vstack([first, second[1:]]), about) == crossings(first, about) + crossings(second, about)
    assert crossings(first[::-1], about) == -crossings(first, about)


def sheets(free: np.ndarray, start: tuple[int, int], about: tuple[float, float]) -> dict[tuple[int, int, int], int]:
    """Least cost to each (crossings, row, column), by Dijkstra on pairs of square and crossing number."""
    best, queue = {(0, *start): 0}, [(0, (0, *start))]
    while queue:
        far, state = heapq.heappop(queue)
        if far > best[state]:
            continue
        number, row, column = state
        for (p, q), cost in moves(free, row, column):
            step = crossings(np.array([(column + 0.5, row + 0.5), (q + 0.5, p + 0.5)]), about)
            other = (number + step, p, q)
            if abs(other[0]) <= MOST and far + cost < best.get(other, 10**9):
                best[other] = far + cost
                heapq.heappush(queue, (far + cost, other))
    return best


def cost_of(squares: list[tuple[int, int]]) -> int:
    return sum(7 if a != c and b != d else 5 for (a, b), (c, d) in itertools.pairwise(squares))


@settings(max_examples=40, deadline=None)
@given(st.integers(3, 9), st.integers(3, 9), st.integers(0, 2**32 - 1), st.integers(-MOST, MOST))
def test_a_winding_way_is_the_shortest_of_its_number(rows: int, columns: int, seed: int, number: int) -> None:
    free, rng = raster(rows, columns, seed)
    row, column = int(rng.integers(1, rows - 1)), int(rng.integers(1, columns - 1))
    free[row, column] = False
    free[0, 0] = free[-1, -1] = True
    about = (column + 0.5, row + 0.5)
    best = sheets(free, (0, 0), about)
    for goal in ((0, 0), (rows - 1, columns - 1)):
        way = winding_way(free, (0, 0), goal[::-1], about, number)
        want = best.get((number, *goal))
        if way is None:
            assert want is None
            continue
        assert way[0] == (0, 0)
        assert way[-1] == goal[::-1]
        assert crossings(np.array(way) + 0.5, about) == number
        assert cost_of(way) == want
        assert all((b, a) in [m for m, _ in moves(free, d, c)] for (c, d), (a, b) in itertools.pairwise(way))


def test_a_number_out_of_range_and_a_blocked_end_are_refused() -> None:
    free = np.array([[True, False], [True, True]])
    with pytest.raises(ValueError, match="crossing numbers"):
        winding_way(free, (0, 0), (0, 1), (1.5, 0.5), MOST + 1)
    with pytest.raises(ValueError, match="not a free square"):
        winding_way(free, (0, 0), (1, 0), (1.5, 0.5), 0)
