"""Laws of the worlds about several things: valid files, the same for the same seed, and goals that mean their truth."""

import os
import subprocess
import sys
from functools import cache
from itertools import combinations
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely import Point, Polygon, box
from shapely.affinity import rotate, translate

from benchmarks.worlds.floorplans import FloorPlan, PlanRoom
from benchmarks.worlds.furniture import rectangle
from benchmarks.worlds.scenes import PlacedThing, write
from benchmarks.worlds.several.kinds import SEVERAL_KINDS, main, several_kinds, several_world
from benchmarks.worlds.several.tasks import SeveralWorld, Want, moved_polygon, stages_reached, to_corner, to_pose
from tests.tables import few
from utak.kb.language.goal_words import ROBOT
from utak.simulator.scenario.expectation import Snapshot, unmet
from utak.simulator.scenario.scenario import read_scenario

ROOT = Path(__file__).resolve().parents[3]
SEEDS = range(5)
WORLDS = [(kind, seed) for kind in SEVERAL_KINDS for seed in SEEDS]
DIGEST = """
from benchmarks.worlds.several.kinds import SEVERAL_KINDS, several_world
made = [several_world(kind, seed) for kind in SEVERAL_KINDS for seed in range(2)]
print("".join(world.world + world.texts.goal + world.texts.expect for world in made), end="")
"""


@cache
def world_of(kind: str, seed: int) -> SeveralWorld:
    """Return a world, made once."""
    return several_world(kind, seed)


@pytest.mark.parametrize(("kind", "seed"), few(WORLDS, len(SEVERAL_KINDS)))
def test_a_world_is_a_valid_scenario_and_not_done_at_the_start(kind: str, seed: int, tmp_path: Path) -> None:
    world = world_of(kind, seed)
    scenario = read_scenario(write(world, tmp_path / world.name))
    assert scenario.expectations
    start = Snapshot(0, scenario.world.utak, {thing.name: thing.polygon for thing in scenario.world.movable})
    assert unmet(scenario.expectations, scenario.world, [start])
    assert len(scenario.task.goals) == sum(len(stage) for stage in world.stages)


@pytest.mark.parametrize(("kind", "seed"), few(WORLDS, len(SEVERAL_KINDS)))
def test_the_things_of_a_task_differ_in_what_is_claimed_of_them(kind: str, seed: int) -> None:
    world = world_of(kind, seed)
    claims = [line.partition(". ")[2].replace(f"({name},", "(_,") for name, line in _claims(world.claims)]
    assert len(set(claims)) == len(claims) >= 1
    assert kind == "row" or len(claims) >= 2
    for parameter, thing in zip(_claims(world.claims), world.things, strict=kind != "row"):
        assert f"shape({parameter[0]}, {thing.shape})" in parameter[1]
        assert "colour" not in parameter[1] or f"colour({parameter[0]}, {thing.colour})" in parameter[1]


def _claims(text: str) -> list[tuple[str, str]]:
    """Return (parameter, line) of each line of start.lp."""
    return [(line.partition("(")[2][0], line) for line in text.splitlines()]


@pytest.mark.parametrize(("kind", "seed"), few(WORLDS, len(SEVERAL_KINDS)))
def test_things_touch_nothing_and_the_robot_stands_on_free_floor(kind: str, seed: int) -> None:
    world = world_of(kind, seed)
    solid = [world.plan.verge, *(thing.polygon for thing in world.things)]
    assert all(one.distance(other) >= 1 for one, other in combinations(solid, 2))
    square = box(world.utak.x - 0.5, world.utak.y - 0.5, world.utak.x + 0.5, world.utak.y + 0.5)
    assert not any(square.intersection(shape).area for shape in solid)
    assert world.heading % 90 == 0


@pytest.mark.parametrize("kind", SEVERAL_KINDS)
def test_regions_of_things_can_hold_them_on_the_floor(kind: str) -> None:
    for seed in SEEDS:
        world = world_of(kind, seed)
        polygons = {thing.name: thing.polygon for thing in world.things}
        for want in (want for stage in world.stages for want in stage):
            if want.move is not None:
                place = moved_polygon(polygons[want.subject], want.move)
                assert world.plan.floor.covers(place)
                assert want.holds({want.subject: place})
                assert not want.holds({want.subject: translate(place, 1.0, 0.0)})
            elif want.subject == ROBOT:
                assert want.region.intersection(world.plan.floor).area >= 1
            else:
                assert want.region.area >= polygons[want.subject].area


def test_the_places_of_one_stage_do_not_overlap() -> None:
    for kind, seed in WORLDS:
        world = world_of(kind, seed)
        polygons = {thing.name: thing.polygon for thing in world.things}
        poses = [want for want in world.stages[-1] if want.move is not None]
        ends = [moved_polygon(polygons[want.subject], want.move) for want in poses if want.move is not None]
        assert all(one.intersection(other).area == 0 for one, other in combinations(ends, 2))


def test_equal_seeds_give_equal_worlds_in_another_process() -> None:
    told = [
        subprocess.run(
            [sys.executable, "-c", DIGEST],
            cwd=ROOT,
            env={**os.environ, "PYTHONHASHSEED": hash_seed},
            capture_output=True,
            check=True,
        ).stdout
        for hash_seed in ("1", "2")
    ]
    assert told[0] == told[1] != b""


def test_variants_occur() -> None:
    variants = {
        (kind, world_of(kind, seed).variant) for kind in ("corners", "swap", "closet", "dead_end") for seed in range(12)
    }
    assert variants == {
        ("corners", "free"),
        ("corners", "taken"),
        ("corners", "exchange"),
        ("swap", "rooms"),
        ("swap", "poses"),
        ("closet", "2 things"),
        ("closet", "3 things"),
        ("dead_end", "2 things"),
        ("dead_end", "3 things"),
        ("dead_end", "exchange"),
    }


ROOM = FloorPlan(30, 24, (PlanRoom("r1", box(2, 2, 28, 22)),), ())
BRICK = PlacedThing("t1", "c", "brick", translate(rectangle(5, 2), 10, 10))


@settings(deadline=None)
@given(gap_x=st.floats(0, 3), gap_y=st.floats(0, 3), turned=st.booleans(), heading=st.sampled_from([0, 90, 180, 270]))
def test_a_corner_holds_what_is_within_a_square_of_both_walls(
    gap_x: float, gap_y: float, turned: bool, heading: int
) -> None:
    # The robot's corner that is the table's northeast corner: it is at (28, 22).
    compass = {0: "northeast", 90: "southeast", 180: "southwest", 270: "northwest"}[heading]
    want = to_corner("x", BRICK, ROOM, compass, heading)
    assert want is not None
    lying = rotate(BRICK.polygon, 90 if turned else 0, origin="center")
    _, _, east, north = lying.bounds
    there = translate(lying, 28 - gap_x - east, 22 - gap_y - north)
    if max(gap_x, gap_y) <= 1:
        assert want.holds({"t1": there})
    if max(gap_x, gap_y) >= 1.5:
        assert not want.holds({"t1": there})


@settings(deadline=None)
@given(heading=st.sampled_from([0, 90, 180, 270]), east=st.integers(-5, 5), north=st.integers(-5, 5))
def test_a_pose_is_told_in_the_robots_frame(heading: int, east: int, north: int) -> None:
    utak = Point(5.5, 5.5)
    want = to_pose("x", BRICK, (east, north, 0.0), utak, heading)
    told = want.goal.partition("POINT (")[2].partition(")")[0].split()
    there = rotate(Point(float(told[0]), float(told[1])), heading, origin=(0, 0))
    centre = BRICK.polygon.centroid
    assert there.x + utak.x == pytest.approx(centre.x + east)
    assert there.y + utak.y == pytest.approx(centre.y + north)


def test_stages_count_in_order_and_the_last_one_at_the_end() -> None:
    here, there, third = (Want(ROBOT, "", Point(x, 0).buffer(0.5)) for x in (0, 10, 20))
    stages = [[here], [there], [third]]

    def track(*places: int) -> list[dict[str, Point]]:
        return [{ROBOT: Point(x, 0)} for x in places]

    assert stages_reached(stages, track(0, 10, 20)) == 3
    assert stages_reached(stages, track(5, 0, 3, 10, 0, 20)) == 3
    assert stages_reached(stages, track(10, 0, 20)) == 1
    assert stages_reached(stages, track(0, 10, 20, 10)) == 2
    assert stages_reached(stages, track(20, 10, 5)) == 0
    assert stages_reached([[here, there]], track(0, 10)) == 0
    assert stages_reached([[here]], track(10, 0)) == 1


def test_a_kind_that_does_not_exist_is_refused() -> None:
    with pytest.raises(ValueError, match="kinds are"):
        several_world("corner", 0)
    with pytest.raises(ValueError, match="seeds from 0"):
        several_world("corners", -1)
    with pytest.raises(Exception, match="no kind corner"):
        several_kinds("corners,corner")


def test_the_program_writes_scenarios(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    main(["--kinds", "plug,swap", "--seed", "3", "--count", "2", "-o", str(tmp_path)])
    folders = capsys.readouterr().out.split()
    assert [Path(folder).name for folder in folders] == ["plug-0003", "plug-0004", "swap-0003", "swap-0004"]
    assert all(read_scenario(folder).expectations for folder in folders)


def test_what_fills_a_neck_lies_in_the_only_one() -> None:
    for seed in SEEDS:
        world = world_of("plug", seed)
        want = world.stages[0][1]
        assert want.move is not None
        assert len(world.plan.doors) == 1
        assert world.plan.doors[0].polygon.covers(moved_polygon(world.things[1].polygon, want.move))


def test_x_is_the_only_thing_of_its_shape_beside_a_row_that_it_cannot_pass() -> None:
    for seed in SEEDS:
        world = world_of("row", seed)
        x, *row = world.things
        door = world.plan.doors[0]
        assert all(thing.shape != x.shape and door.polygon.covers(thing.polygon) for thing in row)
        least = min(x.polygon.bounds[2] - x.polygon.bounds[0], x.polygon.bounds[3] - x.polygon.bounds[1])
        assert all(door.width - _across(thing.polygon, door.vertical) - 1 < least <= door.width for thing in row)


def _across(polygon: Polygon, vertical: bool) -> float:
    """Return the extent of a polygon across a door in squares."""
    west, south, east, north = polygon.bounds
    return north - south if vertical else east - west
