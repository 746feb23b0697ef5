"""Laws of the random worlds: valid, the same for the same seed, unambiguous, and possible unless said otherwise."""

import math
import operator
import os
import subprocess
import sys
from itertools import combinations, pairwise
from pathlib import Path

import clingo
import numpy as np
import pytest
from shapely import Point, box

from benchmarks.worlds.carrying import ELLS
from benchmarks.worlds.floorplans import is_simple_row
from benchmarks.worlds.makers import WORLD_MAKERS, scenario
from benchmarks.worlds.placing import digital
from benchmarks.worlds.scenes import RandomScenario, write
from benchmarks.worlds.walking import CORNER_DIRECTIONS
from tests.tables import few

ROOT = Path(__file__).resolve().parents[3]
SEEDS = range(14)
WORLDS = [(task, seed) for task in sorted(WORLD_MAKERS["wide"]) for seed in SEEDS]
DIGEST = """
from benchmarks.worlds.makers import scenario
print("".join(scenario(t, s).world + scenario(t, s).texts.expect for t in range(1, 10) for s in (0, 11)), end="")
"""


def occupied(world: RandomScenario) -> np.ndarray:
    """Return all squares that something covers."""
    plan = world.plan
    shapes = [plan.verge, *(thing.polygon for thing in world.things)]
    return np.logical_or.reduce([digital(shape, plan.width, plan.height) for shape in shapes])


def wide_reach(world: RandomScenario) -> np.ndarray:
    """Return the squares that a body of 2 x 2 squares reaches from near the robot: bool (height, width)."""
    free = ~occupied(world)
    blocks = free[:-1, :-1] & free[1:, :-1] & free[:-1, 1:] & free[1:, 1:]
    x, y = int(world.utak.x), int(world.utak.y)
    rows, columns = np.mgrid[y - 2 : y + 2, x - 2 : x + 2]
    todo = [(j, i) for j, i in zip(rows.ravel(), columns.ravel(), strict=True) if blocks[j, i]]
    seen = set(todo)
    while todo:
        j, i = todo.pop()
        for near in ((j + 1, i), (j - 1, i), (j, i + 1), (j, i - 1)):
            if (
                near not in seen
                and min(near) >= 0
                and near[0] < len(blocks)
                and near[1] < len(blocks[0])
                and blocks[near]
            ):
                seen.add(near)
                todo.append(near)
    reach = np.zeros_like(free)
    for j, i in seen:
        reach[j : j + 2, i : i + 2] = True
    return reach


@pytest.mark.parametrize(("task", "seed"), few(WORLDS, 9))
def test_a_world_is_valid(task: int, seed: int) -> None:
    world = scenario(task, seed)
    plan = world.plan
    assert 20 <= plan.width <= 80 and 20 <= plan.height <= 80
    assert 0 <= world.heading < 360
    assert len(world.things) <= 6
    for thing in world.things:
        assert thing.polygon.is_valid and thing.polygon.is_simple and not thing.polygon.interiors
        assert plan.floor.covers(thing.polygon)
        assert not thing.polygon.buffer(-1e-9).contains(world.utak)
    for one, other in combinations(world.things, 2):
        assert one.polygon.intersection(other.polygon).area < 1e-9
    assert not occupied(world)[int(world.utak.y), int(world.utak.x)]
    assert min(abs(v - round(v)) for v in (world.utak.x, world.utak.y)) > 0.01
    assert len({thing.name for thing in world.things}) == len(world.things)


@pytest.mark.parametrize(("task", "seed"), few(WORLDS, 9))
def test_rooms_are_joined_by_doors_at_most_half_as_wide(task: int, seed: int) -> None:
    plan = scenario(task, seed).plan
    assert is_simple_row(plan) or not plan.doors
    for door in plan.doors:
        for name in door.rooms:
            west, south, east, north = plan.room(name).bounds
            assert 2 * door.width <= min(east - west, north - south)
            assert door.polygon.intersection(plan.room(name)).length == pytest.approx(door.width)


@pytest.mark.long
@pytest.mark.parametrize(("task", "seed"), [(task, seed) for task, seed in WORLDS if task <= 3])
def test_the_target_can_be_reached_through_wide_passages(task: int, seed: int) -> None:
    world = scenario(task, seed)
    rows, columns = np.nonzero(wide_reach(world))
    target = world.target.buffer(-0.4)
    reached = any(target.intersects(box(i, j, i + 1, j + 1)) for i, j in zip(columns, rows, strict=True))
    assert reached == world.possible


@pytest.mark.parametrize("seed", few(SEEDS, 3))
def test_the_square_of_task_four_can_be_circled(seed: int) -> None:
    world = scenario(4, seed)
    if world.possible:
        square = world.things[0]
        ring = digital(square.polygon.buffer(2), world.plan.width, world.plan.height)
        ring &= ~digital(square.polygon, world.plan.width, world.plan.height)
        assert not (ring & occupied(world)).any()
        assert wide_reach(world)[ring].all()


@pytest.mark.parametrize("seed", few(SEEDS, 3))
def test_the_corner_of_task_one_is_the_furthest_of_the_floor(seed: int) -> None:
    world = scenario(1, seed)
    east, north = CORNER_DIRECTIONS[world.texts.goal.split("(")[2].split(")")[0]]
    angle = math.radians(world.heading)
    c, s = math.cos(angle), math.sin(angle)
    rows, columns = np.nonzero(digital(world.plan.floor, world.plan.width, world.plan.height))
    out = (columns + 0.5) * (east * c - north * s) + (rows + 0.5) * (east * s + north * c)
    best = int(np.argmax(out))
    assert world.target.covers(Point(columns[best] + 0.5, rows[best] + 0.5))


@pytest.mark.parametrize("seed", few(SEEDS, 3))
@pytest.mark.parametrize("task", [3, 4])
def test_nothing_but_squares_looks_like_a_square(task: int, seed: int) -> None:
    world = scenario(task, seed)
    for thing in world.things:
        squares = digital(thing.polygon, world.plan.width, world.plan.height)
        rows, columns = np.nonzero(squares)
        high, wide = np.ptp(rows) + 1, np.ptp(columns) + 1
        if thing.shape != "square":
            assert not (high == wide and squares.sum() == high * wide), thing


def test_all_squares_that_may_be_meant_are_expected() -> None:
    for seed in range(60):
        world = scenario(3, seed)
        squares = [thing for thing in world.things if thing.shape == "square"]
        assert all(world.target.covers(thing.polygon) for thing in squares)
        assert world.possible == ("fails." not in world.texts.expect)


@pytest.mark.parametrize("task", sorted(WORLD_MAKERS["wide"]))
def test_the_files_are_facts(task: int, tmp_path: Path) -> None:
    folder = write(scenario(task, 3), tmp_path)
    for name in ("world", "start", "goal", "expect"):
        control = clingo.Control()
        control.load(str(folder / f"{name}.lp"))
        control.ground([("base", [])])
        assert all(atom.is_fact for atom in control.symbolic_atoms)


@pytest.mark.parametrize("seed", few([*SEEDS, 23, 35], 2))
@pytest.mark.parametrize("task", [5, 6, 7, 9])
def test_doors_let_the_load_through_or_are_too_narrow_by_the_stated_width(task: int, seed: int) -> None:
    world = scenario(task, seed)
    load = world.things[0].polygon
    corners = list(load.minimum_rotated_rectangle.exterior.coords)
    least = min(math.dist(one, other) for one, other in pairwise(corners))
    if world.things[0].shape == "l_shape":
        least = next(need for (arm, thick), need in ELLS.items() if load.area == thick * (2 * arm - thick))
    for door in world.plan.doors:
        if world.possible:
            assert 1 <= door.width - least <= 3
        else:
            assert world.missing == pytest.approx(least - door.width)
            assert 0.5 <= world.missing <= 1.5


@pytest.mark.parametrize("seed", few(SEEDS, 3))
def test_the_load_lies_apart_from_its_target(seed: int) -> None:
    for task in (5, 6, 7, 8, 9):
        world = scenario(task, seed)
        assert not world.target.intersects(world.things[0].polygon)
        assert world.possible == (world.missing == 0)


@pytest.mark.parametrize("task", few([5, 6, 7, 9], [6]))
def test_snug_worlds_have_two_or_three_rooms_of_18_to_24_squares(task: int) -> None:
    worlds = [scenario(task, seed, "snug") for seed in range(24)]
    assert {len(world.plan.rooms) for world in worlds} == {2, 3}
    for world in worlds:
        west, south, east, north = zip(*(room.polygon.bounds for room in world.plan.rooms), strict=True)
        assert max(map(operator.sub, [*east, *north], [*west, *south])) <= 24
        assert min(map(operator.sub, [*east, *north], [*west, *south])) >= 14
        assert all(door.polygon.area == 2 * door.width for door in world.plan.doors)
    assert len({world.heading for world in worlds}) > 6
    assert worlds[3] == scenario(task, 3, "snug")
    assert worlds[3] != scenario(task, 3)


@pytest.mark.long
def test_half_of_the_headings_are_quarter_turns() -> None:
    headings = [scenario(task, seed).heading for task in (2, 3, 4) for seed in range(80)]
    quarter = sum(heading % 90 == 0 for heading in headings) / len(headings)
    assert 0.4 < quarter < 0.62


@pytest.mark.long
def test_worlds_differ_by_seed_and_by_task() -> None:
    texts = {scenario(task, seed).world for task, seed in WORLDS}
    assert len(texts) == len(WORLDS)


def test_the_same_seed_gives_the_same_world_under_any_hash_seed() -> None:
    environment = dict(os.environ, PYTHONHASHSEED="7", PYTHONPATH=str(ROOT))
    command = [sys.executable, "-c", DIGEST]
    other = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, check=True).stdout
    parts = [scenario(t, s).world + scenario(t, s).texts.expect for t in range(1, 10) for s in (0, 11)]
    assert other == "".join(parts)


def test_an_unknown_task_is_refused() -> None:
    with pytest.raises(ValueError, match="tasks are 1 to 9"):
        scenario(10, 0)
    with pytest.raises(ValueError, match="wide, snug, plain"):
        scenario(5, 0, "huge")
