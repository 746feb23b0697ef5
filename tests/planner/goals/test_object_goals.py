"""The placements of carried objects: where a goal holds for them."""

import itertools
from dataclasses import replace

import numpy as np
import pytest
import shapely
import shapely.affinity

from tests.kb.drawings import known_model, unclear
from tests.planner.situations import known_situation, situation_of
from utak.kb.language.reader import facts_from_text
from utak.kb.mapping.patch import patch_of_polygon
from utak.kb.world.corners import Corner
from utak.kb.world.model import Node, WorldModel
from utak.planner.carrying.plan_executor import PlanExecutor
from utak.planner.goals.object_goals import goal_placement
from utak.planner.goals.placement import Placement, meets_end

SHUT_IN = [
    "b" * 20,
    *["b" + "." * 18 + "b"] * 5,
    "bggggg" + "." * 13 + "b",
    "bUgggg" + "." * 13 + "b",
    "bggggg" + "." * 13 + "b",
    *["b" + "." * 18 + "b"] * 5,
    "b" * 20,
]
NORTHEAST = facts_from_text("at(x, corner(northeast)).")[0]


def landing_of(model: WorldModel, held: bool) -> Placement:
    """Return the placement of a ring around the robot in the northeast corner. held : whether the robot holds it."""
    ring = shapely.box(-1, -1, 4, 2) - shapely.box(0, 0, 1, 1) - shapely.box(-1, 0, 0, 1)
    node = Node("o1", "object", 95, "part1", patch_of_polygon(ring), 0, polygon=ring, moved=held)
    situation = situation_of(replace(model, objects=(node,), held="o1" if held else None), {"x": "o1"})
    return goal_placement(NORTHEAST, node, (0.0, 0.0), situation)


@pytest.mark.parametrize("held", [True, False])
def test_a_carried_object_does_not_shut_the_robot_in(held: bool) -> None:
    model = known_model(SHUT_IN)
    assert np.count_nonzero(situation_of(model).cost_maps.floor) == 1
    assert landing_of(model, held).ends


def test_walls_do_shut_the_robot_in() -> None:
    model = known_model([row.replace("g", "b") for row in SHUT_IN])
    square = shapely.box(8, 0, 11, 3)
    node = Node("o1", "object", 95, "part1", patch_of_polygon(square), 0, polygon=square)
    found = goal_placement(NORTHEAST, node, (0.0, 0.0), situation_of(replace(model, objects=(node,)), {"x": "o1"}))
    assert not found.ends
    assert "passage" in found.missing


def test_a_corner_under_another_thing_that_was_brought_there_is_known() -> None:
    room = ["b" * 20, *["b" + "." * 15 + "hhhb"] * 3, *["b" + "." * 18 + "b"] * 3]
    room += ["b..ggg" + "." * 13 + "b"] * 3 + ["b.......U" + "." * 10 + "b", "b" * 20]
    situation = known_situation(room, moved=True)
    node = next(one for one in situation.model.objects if one.name == "g")
    under = {**situation.corners, "northeast": Corner((19.0, 11.0), (18, 10))}  # of the floor under h
    found = goal_placement(NORTHEAST, node, (0.0, 0.0), replace(situation, binding={"x": "g"}, corners=under))
    assert "northeast" in found.ends and not found.missing


@pytest.mark.parametrize("wide", [2, 4])
def test_an_object_before_a_door_is_refused_only_where_it_is_too_wide(wide: int) -> None:
    door = "b" * 8 + "." * wide + "b" * (12 - wide)
    rows = ["?" * 20] * 4 + ["b" + "." * 18 + "b"] * 2 + [door] * 2
    rows += ["b" + "." * 18 + "b"] * 6 + ["b..U" + "." * 15 + "b", "b" * 20]
    model = known_model(rows)
    square = shapely.box(5, 4, 8, 7)
    node = Node("o1", "object", 95, "part1", patch_of_polygon(square), 0, polygon=square, moved=True, movable=99)
    situation = situation_of(replace(model, objects=(node,)), {"x": node.name})
    found = goal_placement(NORTHEAST, node, (0.0, 0.0), situation)
    assert not found.ends
    refusal = PlanExecutor().infeasibility(node, found.must_reach.ends(), situation)
    if wide > 3:
        assert refusal is None
        return
    assert refusal is not None
    assert refusal.proved
    assert "2.00 squares wide" in refusal.reason()
    assert "too narrow by 1.00" in refusal.reason()


OPEN_ENDED = [
    "?" * 22,
    *["b" + "." * 18 + "???"] * 9,
    "b.U" + "." * 16 + "???",
    *["b" + "." * 18 + "???"] * 4,
    "b" * 22,
]


def test_an_object_is_brought_into_the_corner_of_the_seen_floor_while_the_true_corner_is_unseen() -> None:
    model = known_model(OPEN_ENDED)
    square = shapely.box(2, 0, 5, 3)
    node = Node("o1", "object", 95, "part1", patch_of_polygon(square), 0, polygon=square)
    situation = situation_of(replace(model, objects=(node,)), {"x": "o1"})
    found = goal_placement(NORTHEAST, node, (3.5, 1.5), situation)
    assert not found.ends
    assert "unseen" in found.missing
    corner, about = found.approach.values()
    row, column = np.argwhere(model.view.seen)[-1]
    shape = shapely.box(column - 2, row - 2, column + 1, row + 1)
    assert meets_end(corner, shape)
    assert not meets_end(corner, shapely.affinity.translate(shape, -2, 0))
    assert meets_end(about, shapely.affinity.translate(shape, -2, 0))
    there = shapely.transform(shape, lambda points: points + np.array([model.view.west, model.view.south]))
    arrived = replace(node, patch=patch_of_polygon(there), polygon=there)
    situation = situation_of(replace(model, objects=(arrived,)), {"x": "o1"})
    assert not goal_placement(NORTHEAST, arrived, (3.5, 1.5), situation).approach


WALLED = ["b" * 22, *["b" + "." * 20 + "b"] * 9, "b.U" + "." * 18 + "b", *["b" + "." * 20 + "b"] * 4, "b" * 22]


@pytest.mark.parametrize(
    ("turned", "gap", "holds"),
    [(0.0, 0.9, True), (90.0, 0.9, True), (20.0, 0.1, True), (20.0, 0.4, False), (45.0, 0.0, False)],
)
def test_a_rotated_object_in_a_corner_must_not_reach_far_from_the_walls(turned: float, gap: float, holds: bool) -> None:
    model = known_model(WALLED)
    row, column = np.argwhere(model.space)[-1]
    east, north = model.view.west + column + 1, model.view.south + row + 1
    askew = shapely.affinity.rotate(shapely.box(0, 0, 4, 4), turned)
    _, _, x, y = askew.bounds
    there = shapely.affinity.translate(askew, east - x - gap, north - y - gap)
    node = Node("o1", "object", 100, "part1", patch_of_polygon(there), 0, polygon=there, moved=True, turned=turned)
    situation = situation_of(replace(model, objects=(node,)), {"x": "o1"})
    found = goal_placement(NORTHEAST, node, (3.5, 1.5), situation)
    assert found.holds == holds
    shape = shapely.affinity.translate(there, -model.view.west, -model.view.south)
    assert bool(found.loose) == (not holds)
    assert all(meets_end(end, shape) for end in found.loose.values())


@pytest.mark.parametrize(("gap", "inexact", "holds"), [(0.9, False, True), (0.9, True, False), (0.4, True, True)])
def test_an_object_at_an_inexact_place_must_be_nearer_to_the_corner_if_possible(
    gap: float, inexact: bool, holds: bool
) -> None:
    model = known_model(WALLED)
    row, column = np.argwhere(model.space)[-1]
    east, north = model.view.west + column + 1 - gap, model.view.south + row + 1 - gap
    there = shapely.box(east - 4, north - 4, east, north)
    node = Node("o1", "object", 100, "part1", patch_of_polygon(there), 0, polygon=there, moved=True, inexact=inexact)
    found = goal_placement(NORTHEAST, node, (3.5, 1.5), situation_of(replace(model, objects=(node,)), {"x": "o1"}))
    shape = shapely.affinity.translate(there, -model.view.west, -model.view.south)
    assert found.holds == holds
    assert [meets_end(end, shape) for end in found.loose.values()] == [True] * inexact


@pytest.mark.parametrize(
    ("gap", "short", "holds"),
    [(0, 1.0, True), (1, 1.0, False), (1, 0.0, True), (0.75, 0.25, True), (0.75, 0.3, False), (0.75, 1.0, False)],
)
def test_an_object_that_may_be_smaller_is_in_a_corner_only_if_it_is_at_its_smallest(
    gap: float, short: float, holds: bool
) -> None:
    model = known_model(WALLED)
    row, column = np.argwhere(model.space)[-1]
    east, north = model.view.west + column + 1 - gap, model.view.south + row + 1 - gap
    there = shapely.box(east - 4, north - 4, east, north)
    sides = (1.0, short, 1.0, short)  # the other sides do not matter
    node = Node("o1", "object", 100, "part1", patch_of_polygon(there), 0, polygon=there, moved=True, short=sides)
    found = goal_placement(NORTHEAST, node, (3.5, 1.5), situation_of(replace(model, objects=(node,)), {"x": "o1"}))
    shape = shapely.affinity.translate(there, -model.view.west, -model.view.south)
    assert found.holds == holds
    assert holds or not any(meets_end(end, shape) for end in found.ends.values())  # an end is left to reach


@pytest.mark.parametrize(
    ("chance", "rows_open", "further"),
    [(0.3, 1, 1), (0.3, 2, 2), (0.3, 3, 2), (0.6, 1, 0), (0.0, 0, 0)],
)
def test_an_optimistic_corner_lies_where_the_floor_likely_goes_on(chance: float, rows_open: int, further: int) -> None:
    """Some rows of the wall to the north are not settled; chance : their probability of being occupied."""
    model = known_model([*["b" * 22] * 4, *WALLED[1:]])
    top = int(np.argwhere(model.space)[-1][0])
    model = unclear(model, slice(top + 1, top + 1 + rows_open), slice(1, 21), chance)
    square = shapely.box(2, 0, 5, 3)
    node = Node("o1", "object", 95, "part1", patch_of_polygon(square), 0, polygon=square)
    situation = situation_of(replace(model, objects=(node,)), {"x": "o1"})
    found = goal_placement(NORTHEAST, node, (3.5, 1.5), situation)
    (name, end), *_ = [*found.ends.items(), *found.approach.items()]
    hoped = found.hoped.ends()
    assert list(hoped) == [name] * (further > 0)
    for other in hoped.values():
        assert (other.x - end.x, other.y - end.y) == (0, further)
        assert other.press > 0  # the object is pressed on to the wall


@pytest.mark.parametrize("behind", ["?", "b"])
def test_a_robot_shut_in_by_its_held_object_must_look_into_unseen_rooms(behind: str) -> None:
    """The room has a door in its south wall; behind it all is unseen, or is wall."""
    wall, door = "b" * 18, "b" * 12 + "..." + "b" * 3
    rows = [wall, "b" + "." * 12 + "gggUb", *["b" + "." * 12 + "ggggb"] * 3, *["b" + "." * 16 + "b"] * 6]
    rows += [door if behind == "?" else wall] * 2
    model = known_model([*rows, *[behind * 18] * 3])
    there = shapely.box(-2.75, -2.75, 0.25, 0.25)  # 0.75 squares from the two walls of the corner
    node = Node("o1", "object", 100, "part1", patch_of_polygon(there), 0, polygon=there, moved=True, movable=99)
    for held in ("o1", None):
        situation = situation_of(replace(model, objects=(node,), held=held), {"x": "o1"})
        assert np.count_nonzero(situation.cost_maps.floor) <= 1
        found = goal_placement(NORTHEAST, node, (-1.5, -1.5), situation)
        if behind == "?" and held:
            assert found.shut_in and not found.holds and not found.there
            assert "a room is not seen" in found.missing
        else:
            assert found.holds and not found.shut_in


@pytest.mark.parametrize("held", [True, False])
@pytest.mark.parametrize("behind", ["?", "b"])
def test_unseen_rooms_are_looked_into_on_the_way_with_the_object_in_hand(behind: str, held: bool) -> None:
    """The room has a door in its south wall; behind it all is unseen, or is wall."""
    wall, door = "b" * 18, "b" * 12 + "..." + "b" * 3
    rows = [wall, *["b" + "." * 16 + "b"] * 8, "bUggg" + "." * 12 + "b", *["b.ggg" + "." * 12 + "b"] * 2]
    rows += [door if behind == "?" else wall] * 2
    model = known_model([*rows, *[behind * 18] * 3])
    there = shapely.box(1, -2, 4, 1)
    node = Node("o1", "object", 100, "part1", patch_of_polygon(there), 0, polygon=there, moved=True, movable=99)
    situation = situation_of(replace(model, objects=(node,), held="o1" if held else None), {"x": "o1"})
    found = goal_placement(NORTHEAST, node, (2.5, -0.5), situation)
    assert found.ends and not found.holds
    assert bool(found.by_the_way.viewpoints()) == (behind == "?" and held)


NOOK = [  # the start is too near to the walls for the object to be centred on any side of it
    "b" * 14,
    "b" + "." * 12 + "b",
    "bU" + "." * 11 + "b",
    *["b" + "." * 12 + "b"] * 8,
    "b" * 14,
]


@pytest.mark.parametrize("goal", ["at(x, start).", 'pose(x, "POINT (1.9 -1)", 0).'])
def test_a_refusal_of_all_ends_proves_nothing_when_others_exist(goal: str) -> None:
    """The object may be across the corner of the start, or nearly at its pose."""
    model = known_model(NOOK)
    square = shapely.box(5, -6, 10, -1)
    node = Node("o1", "object", 95, "part1", patch_of_polygon(square), 0, polygon=square, moved=True, movable=99)
    situation = situation_of(replace(model, objects=(node,)), {"x": node.name})
    found = goal_placement(facts_from_text(goal)[0], node, (0.0, 0.0), situation)
    assert found.some
    refused = PlanExecutor().infeasibility(node, found.ends, situation)
    assert refused is not None
    assert refused.proved
    assert PlanExecutor().infeasibility(node, found.must_reach.ends(), situation) is None


def test_a_loose_end_near_a_target_is_within_one_square_of_it() -> None:
    model = known_model(NOOK)
    square = shapely.box(5, -6, 9, -3)
    node = Node("o1", "object", 95, "part1", patch_of_polygon(square), 0, polygon=square, moved=True, movable=99)
    situation = situation_of(replace(model, objects=(node,)), {"x": node.name})
    found = goal_placement(facts_from_text("at(x, start).")[0], node, (0.0, 0.0), situation)
    (end,) = found.loose.values()
    start = shapely.box(1, 9, 2, 10)  # view frame
    near = 0
    for dx, dy in itertools.product(np.arange(-6.0, 1.0, 0.25), np.arange(2.0, 9.0, 0.25)):
        lying = shapely.affinity.translate(shapely.box(6, 4, 10, 7), dx, dy)
        near += meets_end(end, lying)
        assert not meets_end(end, lying) or lying.distance(start) <= 1.0
    assert near
