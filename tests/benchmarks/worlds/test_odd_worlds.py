"""Laws of the odd worlds: valid files, the same for the same seed, and of each kind the property that it names."""

import os
import subprocess
import sys
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest
from shapely import LineString, box, union_all
from shapely.affinity import translate
from shapely.geometry.base import BaseGeometry

from benchmarks.claims.asked import ASKED_KINDS
from benchmarks.worlds.odd import constraints, openings, plugged, touching
from benchmarks.worlds.odd.houses import OddNeck
from benchmarks.worlds.odd.kinds import odd_world
from benchmarks.worlds.odd.lying import own_square
from benchmarks.worlds.odd.tasks import NO, NOT_KNOWN, ODD_GOALS, YES, OddWorld
from benchmarks.worlds.scenes import write
from tests.tables import few
from utak.geometry.cspace.plan_motion import plan_motion
from utak.geometry.motion.se2 import Pose
from utak.simulator.scenario.expectation import Snapshot, unmet
from utak.simulator.scenario.scenario import read_scenario

ROOT = Path(__file__).resolve().parents[3]
SEEDS = range(12)
WALKED_ALONE = ("part_gap", "leaning", "heading")  # kinds in which nothing is to be carried
WORLDS = [(kind, seed) for kind in ASKED_KINDS for seed in SEEDS]
DIGEST = """
from benchmarks.claims.asked import ASKED_KINDS
from benchmarks.worlds.odd.kinds import odd_world
made = [odd_world(kind, seed, ASKED_KINDS) for kind in ASKED_KINDS for seed in range(3)]
print("".join(world.world + world.texts.goal + world.texts.expect for world in made), end="")
"""


def worlds_of(kind: str, count: int = 20) -> list[OddWorld]:
    """Return the first worlds of a kind."""
    return [odd_world(kind, seed, ASKED_KINDS) for seed in range(count)]


def coordinates(shape: BaseGeometry) -> np.ndarray:
    """Return all coordinates of a floor's outline as one row."""
    return np.asarray(shape.exterior.coords).ravel()


@pytest.mark.parametrize(("kind", "seed"), few(WORLDS, len(ASKED_KINDS)))
def test_a_world_passes_utak_check_and_says_what_is_true(kind: str, seed: int, tmp_path: Path) -> None:
    world = odd_world(kind, seed, ASKED_KINDS)
    scenario = read_scenario(write(world, tmp_path / world.name))
    assert scenario.expectations
    assert [fact.name for fact in scenario.expectations] == ["fails"] or world.possible != NO
    assert (world.possible == NO) == bool(world.texts.unable)
    start = Snapshot(0, (world.utak.x, world.utak.y), {t.name: t.polygon for t in world.things if not t.fixed})
    if world.possible == YES:
        assert unmet(scenario.expectations, scenario.world, [start]), "it holds before anything is done"


@pytest.mark.parametrize("kind", few(ASKED_KINDS, 4))
def test_objects_and_the_robot_are_apart_on_the_floor(kind: str) -> None:
    for world in worlds_of(kind):
        assert world.plan.width <= 64 and world.plan.height <= 64
        shapes = [thing.polygon for thing in world.things]
        assert all(world.plan.floor.buffer(1e-6).covers(shape) for shape in shapes)
        assert all(one.intersection(other).area < 1e-9 for one, other in combinations(shapes, 2))
        assert world.plan.floor.covers(world.utak)
        assert not any(shape.buffer(-1e-9).covers(world.utak) for shape in shapes)


def test_the_same_seed_gives_the_same_world_under_any_hash_seed() -> None:
    said = {
        subprocess.run(
            [sys.executable, "-c", DIGEST],
            capture_output=True,
            cwd=ROOT,
            env=os.environ | {"PYTHONHASHSEED": seed},
            check=True,
        ).stdout
        for seed in ("0", "1")
    }
    assert len(said) == 1 and len(said.pop()) > 1000


@pytest.mark.parametrize("kind", few(ASKED_KINDS, 4))
def test_each_kind_has_walks_and_carries_that_can_be_done(kind: str) -> None:
    worlds = worlds_of(kind, 26)
    assert {world.world for world in worlds[:2]} != {worlds[0].world}
    able = [world for world in worlds if world.possible == YES] + [w for w in worlds if w.possible == NOT_KNOWN]
    carried = any("(x," in world.texts.goal and "utak" not in world.texts.goal for world in able)
    assert carried != (kind in WALKED_ALONE)
    assert any("utak" in world.texts.goal for world in able)
    assert set(ODD_GOALS) >= {world.task for world in worlds} or kind == "constraint"


def test_off_grid_walls_are_off_the_grid_and_doors_nearly_as_wide_as_the_load() -> None:
    worlds = worlds_of("off_grid", 40)
    for world in worlds:
        places = coordinates(world.plan.floor)
        assert np.mean(np.abs(places - np.round(places)) > 1e-3) > 0.5
    carried = [w for w in worlds if w.task in ("carry_next", "carry_door", "both")]
    for world in carried:
        sides = np.linalg.norm(np.diff(world.things[0].polygon.exterior.coords, axis=0), axis=1)
        assert (world.plan.necks[0].clear >= min(sides) - 1e-6) == (world.possible == YES)
    assert {world.possible for world in carried} == {YES, NO}
    assert any(world.plan.necks[0].clear < 2 for world in worlds if world.task == "next")


def test_slanted_walls_are_slanted() -> None:
    for world in worlds_of("slanted"):
        sides = np.diff(world.plan.floor.exterior.coords, axis=0)
        askew = np.minimum(*np.abs(sides.T)) > 0.02 * np.linalg.norm(sides, axis=1)
        assert np.mean(askew) >= 0.25
        assert any(side > 4 for side in np.linalg.norm(sides[askew], axis=1))


def test_round_rooms_are_round() -> None:
    for world in worlds_of("round"):
        for room in world.plan.rooms:
            assert len(room.exterior.coords) > 16
            assert 4 * np.pi * room.area > 0.97 * room.exterior.length**2


def test_a_plug_leaves_no_way_through_the_door_until_it_is_moved() -> None:
    seen = set()
    for world in worlds_of("plugged", 30):
        plugs = [thing.polygon for thing in world.things if thing.name.startswith("p")]
        start, end = (room.representative_point() for room in world.plan.rooms)
        open_floor, shut_floor = world.plan.floor, world.plan.floor.difference(union_all(plugs).buffer(1e-6))
        assert parted(open_floor, start, end) is False
        assert parted(shut_floor, start, end) is True
        assert len(plugs) == (2 if world.variant.startswith("two") else 1)
        assert any(thing.fixed for thing in world.things) == (world.variant == "fixed")
        seen.add(world.variant)
    assert seen == set(plugged.PLUGGED_VARIANTS)


def parted(floor: BaseGeometry, start: BaseGeometry, end: BaseGeometry) -> bool:
    """Return whether two points lie in different parts of a floor."""
    parts = list(getattr(floor, "geoms", [floor]))
    return not any(part.distance(start) < 2 and part.distance(end) < 2 for part in parts)


def test_touching_objects_have_no_distance() -> None:
    seen = set()
    for world in worlds_of("touching", 40):
        x, others = world.things[0].polygon, [thing.polygon for thing in world.things[1:]]
        assert all(x.distance(other) < 1e-9 for other in others)
        assert all(x.intersection(other).length > 0.9 for other in others)
        if world.variant in ("wall", "corner"):
            touched = x.exterior.intersection(world.plan.floor.exterior).length
            assert touched == pytest.approx(touching.SQUARE_SIDE * (2 if world.variant == "corner" else 1))
        if world.variant.startswith("robot"):
            assert x.distance(own_square(world.utak)) < 1
        if world.variant == "same_colour":
            assert len({thing.colour for thing in world.things}) == 1
        if world.variant == "pair":
            assert len({thing.colour for thing in world.things}) == 2
        seen.add(world.variant)
    assert seen == set(touching.TOUCHING_VARIANTS)


def test_wide_openings_are_no_doors_and_narrower_ones_are() -> None:
    for world in worlds_of("wide", 24):
        assert openings.is_door(world.plan) == (world.variant != "no_door") == (world.possible == YES)
        assert world.plan.necks[0].clear >= 4


def test_the_widest_circle_before_an_opening_touches_its_jambs_and_the_wall_opposite() -> None:
    floor, opening = 10.0, 6.0
    radius = openings.widest(floor, opening) / 2
    middle = np.array([floor - radius, 0.0])  # the wall opposite at floor, the opening at 0
    assert np.hypot(*(middle - [0, opening / 2])) == pytest.approx(radius)


def test_fixed_things_look_like_movable_ones_beside_them() -> None:
    for world in worlds_of("fixed"):
        assert any(thing.fixed for thing in world.things)
        assert len({round(thing.polygon.area, 6) for thing in world.things}) == 1
        stays = all(thing.fixed for thing in world.things)
        assert (world.possible == NO) == (stays and world.task != "at_x")
        assert all(thing.polygon.distance(world.plan.verge) > 2 for thing in world.things)


def test_constraint_worlds_ask_every_question_and_have_no_square_where_none_is_meant() -> None:
    worlds = worlds_of("constraint", 2 * len(constraints.QUESTIONS))
    assert {world.variant for world in worlds} == set(constraints.QUESTIONS)
    for world in worlds:
        question = constraints.QUESTIONS[world.variant]
        assert any(thing.shape == "square" for thing in world.things) == question.there
        assert len(world.plan.necks) == question.doors


def test_a_necks_gap_and_clear_width() -> None:
    straight = OddNeck((0, 0), (0, 3), (2, 0), (2, 3))
    assert straight.gap == straight.clear == 3
    askew = OddNeck((0, 0), (0, 3), (2, 2), (2, 5))
    assert askew.clear == pytest.approx(3 / np.sqrt(2))
    assert askew.gap == pytest.approx(LineString([(0, 0), (2, 2)]).distance(LineString([(0, 3), (2, 5)])))
    assert box(0, 0, 1, 3).equals(straight.half(False)) and box(1, 0, 2, 3).equals(straight.half(True))


def test_unknown_kinds_are_refused() -> None:
    with pytest.raises(ValueError, match="kinds are off_grid"):
        odd_world("even", 0)


@pytest.mark.parametrize("kind", ["off_grid", "slanted", "round"])
def test_motions_of_the_object_alone_agree_with_the_known_doors(kind: str) -> None:
    for world in worlds_of(kind, 20):
        if world.task not in ("carry_next", "carry_door", "both"):
            continue
        thing, plan = world.things[0].polygon, world.plan
        middle = thing.centroid
        home = min(range(2), key=lambda n: plan.rooms[n].distance(middle))
        there = plan.rooms[1 - home].centroid
        body = translate(thing, -middle.x, -middle.y)
        motion = plan_motion(
            body,
            plan.verge,
            Pose(middle.x, middle.y, 0),
            Pose(there.x, there.y, 0),
            bounds=(0, 0, plan.width, plan.height),
        )
        assert (motion.status, world.possible) in {("found", YES), ("impossible", NO), ("found", NOT_KNOWN)}, world.name


def test_walls_of_things_leave_one_room() -> None:
    for world in worlds_of("thing_wall"):
        assert len(world.plan.rooms) == (2 if world.variant == "beyond" else 1)
        walls = union_all([thing.polygon for thing in world.things if thing.name.startswith("w")])
        left = world.plan.rooms[0].difference(walls.union(world.plan.verge).buffer(2.7))
        assert len(getattr(left, "geoms", [left])) >= 2 or world.variant == "screen", "they seem to part it"


def test_part_gaps_cover_no_whole_square() -> None:
    for world in worlds_of("part_gap"):
        west, south, east, north = (float(v) for v in world.plan.necks[0].polygon.bounds)
        squares = [
            box(i, j, i + 1, j + 1) for i in range(int(west), int(east) + 1) for j in range(int(south), int(north) + 1)
        ]
        middle = world.plan.necks[0].polygon.centroid
        assert not any(world.plan.floor.covers(square) and square.distance(middle) < 0.3 for square in squares)


def test_rules_close_or_price_the_narrow_door_and_the_wide_one_is_free() -> None:
    for world in worlds_of("door_rule"):
        narrow, wide = sorted(world.plan.necks, key=lambda neck: neck.clear)
        assert narrow.clear < 4.5 and wide.clear > 5.5 and "W < 500" in world.texts.rules
        assert narrow.polygon.covers(world.avoid) and not world.avoid.is_empty


def test_the_robot_wakes_within_what_is_about_it() -> None:
    for world in worlds_of("enclosed"):
        about = world.things[0].polygon
        assert about.convex_hull.covers(world.utak) and not about.covers(world.utak)


def test_leaning_things_touch_the_verge() -> None:
    assert all(world.plan.verge.distance(world.things[0].polygon) < 1e-6 for world in worlds_of("leaning"))
