"""Where something that is carried must end."""

import itertools
from dataclasses import replace

import numpy as np
import pytest
import shapely
import shapely.affinity

from kb.language.reader import facts_of
from kb.mapping.patch import covered
from kb.world.model import Node, WorldModel
from planner.carrying.plan_executor import PlanExecutor
from planner.goals.object_goals import landing
from planner.goals.placement import Placement, lands
from tests.kb.drawings import seen_whole, unclear
from tests.planner.situations import situation_of

SHUT_IN = [
    "b" * 20,
    *["b" + "." * 18 + "b"] * 5,
    "bggggg" + "." * 13 + "b",
    "bUgggg" + "." * 13 + "b",
    "bggggg" + "." * 13 + "b",
    *["b" + "." * 18 + "b"] * 5,
    "b" * 20,
]
NORTHEAST = facts_of("at(x, corner(northeast)).")[0]


def landing_of(model: WorldModel, held: bool) -> Placement:
    """Where the ring about him must end, and whether he has hold of it."""
    ring = shapely.box(-1, -1, 4, 2) - shapely.box(0, 0, 1, 1) - shapely.box(-1, 0, 0, 1)
    node = Node("o1", "object", 95, "part1", covered(ring), 0, polygon=ring, moved=held)
    situation = situation_of(replace(model, objects=(node,), held="o1" if held else None), {"x": "o1"})
    return landing(NORTHEAST, node, (0.0, 0.0), situation)


@pytest.mark.parametrize("held", [True, False])
def test_what_he_carries_does_not_shut_him_in(held: bool) -> None:
    model = seen_whole(SHUT_IN)
    assert np.count_nonzero(situation_of(model).cost_maps.floor) == 1
    assert landing_of(model, held).ends


def test_what_cannot_be_carried_away_does() -> None:
    model = seen_whole([row.replace("g", "b") for row in SHUT_IN])
    square = shapely.box(8, 0, 11, 3)
    node = Node("o1", "object", 95, "part1", covered(square), 0, polygon=square)
    found = landing(NORTHEAST, node, (0.0, 0.0), situation_of(replace(model, objects=(node,)), {"x": "o1"}))
    assert not found.ends
    assert "passage" in found.missing


@pytest.mark.parametrize("wide", [2, 4])
def test_what_stands_before_a_door_is_too_wide_for_it_or_may_pass_whatever_lies_behind(wide: int) -> None:
    door = "b" * 8 + "." * wide + "b" * (12 - wide)
    rows = ["?" * 20] * 4 + ["b" + "." * 18 + "b"] * 2 + [door] * 2
    rows += ["b" + "." * 18 + "b"] * 6 + ["b..U" + "." * 15 + "b", "b" * 20]
    model = seen_whole(rows)
    square = shapely.box(5, 4, 8, 7)
    node = Node("o1", "object", 95, "part1", covered(square), 0, polygon=square, moved=True, movable=99)
    situation = situation_of(replace(model, objects=(node,)), {"x": node.name})
    found = landing(NORTHEAST, node, (0.0, 0.0), situation)
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


def test_while_the_corner_is_not_seen_a_thing_is_brought_into_that_of_what_is() -> None:
    model = seen_whole(OPEN_ENDED)
    square = shapely.box(2, 0, 5, 3)
    node = Node("o1", "object", 95, "part1", covered(square), 0, polygon=square)
    situation = situation_of(replace(model, objects=(node,)), {"x": "o1"})
    found = landing(NORTHEAST, node, (3.5, 1.5), situation)
    assert not found.ends
    assert "unseen" in found.missing
    corner, about = found.approach.values()
    row, column = np.argwhere(model.view.seen)[-1]
    shape = shapely.box(column - 2, row - 2, column + 1, row + 1)
    assert lands(corner, shape)
    assert not lands(corner, shapely.affinity.translate(shape, -2, 0))
    assert lands(about, shapely.affinity.translate(shape, -2, 0))
    there = shapely.transform(shape, lambda points: points + np.array([model.view.west, model.view.south]))
    arrived = replace(node, patch=covered(there), polygon=there)
    situation = situation_of(replace(model, objects=(arrived,)), {"x": "o1"})
    assert not landing(NORTHEAST, arrived, (3.5, 1.5), situation).approach


WALLED = ["b" * 22, *["b" + "." * 20 + "b"] * 9, "b.U" + "." * 18 + "b", *["b" + "." * 20 + "b"] * 4, "b" * 22]


@pytest.mark.parametrize(
    ("turned", "gap", "holds"),
    [(0.0, 0.9, True), (90.0, 0.9, True), (20.0, 0.1, True), (20.0, 0.4, False), (45.0, 0.0, False)],
)
def test_what_lies_askew_in_a_corner_must_not_reach_far_from_its_walls(turned: float, gap: float, holds: bool) -> None:
    model = seen_whole(WALLED)
    row, column = np.argwhere(model.space)[-1]
    east, north = model.view.west + column + 1, model.view.south + row + 1
    askew = shapely.affinity.rotate(shapely.box(0, 0, 4, 4), turned)
    _, _, x, y = askew.bounds
    there = shapely.affinity.translate(askew, east - x - gap, north - y - gap)
    node = Node("o1", "object", 100, "part1", covered(there), 0, polygon=there, moved=True, turned=turned)
    situation = situation_of(replace(model, objects=(node,)), {"x": "o1"})
    found = landing(NORTHEAST, node, (3.5, 1.5), situation)
    assert found.holds == holds
    shape = shapely.affinity.translate(there, -model.view.west, -model.view.south)
    assert bool(found.loose) == (not holds)
    assert all(lands(end, shape) for end in found.loose.values())


@pytest.mark.parametrize(("gap", "inexact", "holds"), [(0.9, False, True), (0.9, True, False), (0.4, True, True)])
def test_what_lies_only_about_there_must_be_nearer_to_its_corner_if_it_can(
    gap: float, inexact: bool, holds: bool
) -> None:
    model = seen_whole(WALLED)
    row, column = np.argwhere(model.space)[-1]
    east, north = model.view.west + column + 1 - gap, model.view.south + row + 1 - gap
    there = shapely.box(east - 4, north - 4, east, north)
    node = Node("o1", "object", 100, "part1", covered(there), 0, polygon=there, moved=True, inexact=inexact)
    found = landing(NORTHEAST, node, (3.5, 1.5), situation_of(replace(model, objects=(node,)), {"x": "o1"}))
    shape = shapely.affinity.translate(there, -model.view.west, -model.view.south)
    assert found.holds == holds
    assert [lands(end, shape) for end in found.loose.values()] == [True] * inexact


@pytest.mark.parametrize(
    ("gap", "short", "holds"),
    [(0, 1.0, True), (1, 1.0, False), (1, 0.0, True), (0.75, 0.25, True), (0.75, 0.3, False), (0.75, 1.0, False)],
)
def test_what_may_be_smaller_than_it_looks_is_in_a_corner_when_it_is_however_small(
    gap: float, short: float, holds: bool
) -> None:
    model = seen_whole(WALLED)
    row, column = np.argwhere(model.space)[-1]
    east, north = model.view.west + column + 1 - gap, model.view.south + row + 1 - gap
    there = shapely.box(east - 4, north - 4, east, north)
    sides = (1.0, short, 1.0, short)  # how small it is on the other sides does not matter
    node = Node("o1", "object", 100, "part1", covered(there), 0, polygon=there, moved=True, short=sides)
    found = landing(NORTHEAST, node, (3.5, 1.5), situation_of(replace(model, objects=(node,)), {"x": "o1"}))
    shape = shapely.affinity.translate(there, -model.view.west, -model.view.south)
    assert found.holds == holds
    assert holds or not any(lands(end, shape) for end in found.ends.values())  # there is something left to do


@pytest.mark.parametrize(
    ("chance", "rows_open", "further"),
    [(0.3, 1, 1), (0.3, 2, 2), (0.3, 3, 2), (0.6, 1, 0), (0.0, 0, 0)],
)
def test_a_corner_that_rather_lies_further_is_hoped_for_there(chance: float, rows_open: int, further: int) -> None:
    """Some rows of the wall to the north are not settled, and rather floor or not."""
    model = seen_whole([*["b" * 22] * 4, *WALLED[1:]])
    top = int(np.argwhere(model.space)[-1][0])
    model = unclear(model, slice(top + 1, top + 1 + rows_open), slice(1, 21), chance)
    square = shapely.box(2, 0, 5, 3)
    node = Node("o1", "object", 95, "part1", covered(square), 0, polygon=square)
    situation = situation_of(replace(model, objects=(node,)), {"x": "o1"})
    found = landing(NORTHEAST, node, (3.5, 1.5), situation)
    (name, end), *_ = [*found.ends.items(), *found.approach.items()]
    hoped = found.hoped.ends()
    assert list(hoped) == [name] * (further > 0)
    for other in hoped.values():
        assert (other.x - end.x, other.y - end.y) == (0, further)
        assert other.press > 0  # on to the wall, however far it is


@pytest.mark.parametrize("behind", ["?", "b"])
def test_who_is_shut_in_a_corner_by_what_he_holds_sees_the_rooms_that_he_could_take_it_to(behind: str) -> None:
    """There is a door in the south wall; what lies behind it was never seen, or is wall."""
    wall, door = "b" * 18, "b" * 12 + "..." + "b" * 3
    rows = [wall, "b" + "." * 12 + "gggUb", *["b" + "." * 12 + "ggggb"] * 3, *["b" + "." * 16 + "b"] * 6]
    rows += [door if behind == "?" else wall] * 2
    model = seen_whole([*rows, *[behind * 18] * 3])
    there = shapely.box(-2.75, -2.75, 0.25, 0.25)  # three quarters of a square from the walls that meet about him
    node = Node("o1", "object", 100, "part1", covered(there), 0, polygon=there, moved=True, movable=99)
    for held in ("o1", None):
        situation = situation_of(replace(model, objects=(node,), held=held), {"x": "o1"})
        assert np.count_nonzero(situation.cost_maps.floor) <= 1
        found = landing(NORTHEAST, node, (-1.5, -1.5), situation)
        if behind == "?" and held:
            assert found.shut_in and not found.holds and not found.there
            assert "a room is not seen" in found.missing
        else:
            assert found.holds and not found.shut_in


@pytest.mark.parametrize("held", [True, False])
@pytest.mark.parametrize("behind", ["?", "b"])
def test_rooms_that_he_must_see_before_it_is_there_he_may_see_by_the_way(behind: str, held: bool) -> None:
    """There is a door in the south wall; what lies behind it was never seen, or is wall."""
    wall, door = "b" * 18, "b" * 12 + "..." + "b" * 3
    rows = [wall, *["b" + "." * 16 + "b"] * 8, "bUggg" + "." * 12 + "b", *["b.ggg" + "." * 12 + "b"] * 2]
    rows += [door if behind == "?" else wall] * 2
    model = seen_whole([*rows, *[behind * 18] * 3])
    there = shapely.box(1, -2, 4, 1)
    node = Node("o1", "object", 100, "part1", covered(there), 0, polygon=there, moved=True, movable=99)
    situation = situation_of(replace(model, objects=(node,), held="o1" if held else None), {"x": "o1"})
    found = landing(NORTHEAST, node, (2.5, -0.5), situation)
    assert found.ends and not found.holds
    assert bool(found.by_the_way.viewpoints()) == (behind == "?" and held)


NOOK = [  # where he woke, too narrow for a thing to lie on any side of that with its middle beside it
    "b" * 14,
    "b" + "." * 12 + "b",
    "bU" + "." * 11 + "b",
    *["b" + "." * 12 + "b"] * 8,
    "b" * 14,
]


@pytest.mark.parametrize("goal", ["at(x, start).", 'pose(x, "POINT (1.9 -1)", 0).'])
def test_that_a_thing_can_be_brought_to_none_of_some_ends_proves_nothing(goal: str) -> None:
    """It may lie across the corner of where he woke, or nearly where its pose is."""
    model = seen_whole(NOOK)
    square = shapely.box(5, -6, 10, -1)
    node = Node("o1", "object", 95, "part1", covered(square), 0, polygon=square, moved=True, movable=99)
    situation = situation_of(replace(model, objects=(node,)), {"x": node.name})
    found = landing(facts_of(goal)[0], node, (0.0, 0.0), situation)
    assert found.some
    refused = PlanExecutor().infeasibility(node, found.ends, situation)
    assert refused is not None
    assert refused.proved
    assert PlanExecutor().infeasibility(node, found.must_reach.ends(), situation) is None


def test_what_lies_loosely_near_to_something_is_near_to_it() -> None:
    model = seen_whole(NOOK)
    square = shapely.box(5, -6, 9, -3)
    node = Node("o1", "object", 95, "part1", covered(square), 0, polygon=square, moved=True, movable=99)
    situation = situation_of(replace(model, objects=(node,)), {"x": node.name})
    found = landing(facts_of("at(x, start).")[0], node, (0.0, 0.0), situation)
    (end,) = found.loose.values()
    start = shapely.box(1, 9, 2, 10)  # on the view's arrays
    near = 0
    for dx, dy in itertools.product(np.arange(-6.0, 1.0, 0.25), np.arange(2.0, 9.0, 0.25)):
        lying = shapely.affinity.translate(shapely.box(6, 4, 10, 7), dx, dy)
        near += lands(end, lying)
        assert not lands(end, lying) or lying.distance(start) <= 1.0
    assert near
