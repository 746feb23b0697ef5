"""Infeasibility certificates of the manipulation oracle, and the clearance that its plans keep."""

import math
from dataclasses import replace
from types import SimpleNamespace
from typing import cast

import pytest
import shapely
import shapely.affinity

from tests.kb.drawings import known_model
from tests.planner.situations import situation_of
from utak.geometry.cspace.bottleneck import Bottleneck
from utak.geometry.cspace.plan_motion import MotionPlan
from utak.geometry.manipulation.plan_carrying import CarryingPlan, Inside
from utak.kb.language.reader import facts_from_text
from utak.kb.mapping.occupancy import OCCUPIED
from utak.kb.mapping.patch import patch_of_polygon
from utak.kb.task.task import Task
from utak.kb.world.model import Node
from utak.kb.world.rooms import MIN_DOOR_CONFIDENCE
from utak.planner.carrying.infeasibility import Infeasibility, certify, closest_refuted, how_narrow
from utak.planner.carrying.manipulation_oracle import (
    CONTACTS_FOR_CLEARANCE,
    WALL_CLEARANCE,
    ManipulationOracle,
    ManipulationPlan,
    Request,
)
from utak.planner.goals.placement import POSSIBLE_OBJECT

PARTED = [
    "b" * 24,
    *["b" + "." * 10 + "bb" + "." * 10 + "b"] * 4,
    "b...gggg...............b",
    "b...gggg..........U....b",
    "b...gggg...bb..........b",
    "b...gggg...bb..........b",
    *["b" + "." * 10 + "bb" + "." * 10 + "b"] * 4,
    "b" * 24,
]

STOPPED_UP = [  # a square in the door leaves it too narrow
    "b" * 24,
    *["b" + "." * 10 + "bb" + "." * 10 + "b"] * 3,
    *["b" + "." * 22 + "b"] * 2,
    "b...................U..b",
    "b" + "." * 10 + "r" + "." * 11 + "b",
    "b" + "." * 22 + "b",
    *["b" + "." * 10 + "bb" + "." * 10 + "b"] * 3,
    "b" * 24,
]


def asked(
    west: float, turned: float = 0.0, dubious: bool = False, stuck: int = 0, sure: bool = True
) -> ManipulationPlan | Infeasibility:
    """Return the answer for an object 4 squares wide and a door of 2; `west` : of the object, which is drawn at 4."""
    model = known_model(PARTED)
    (node,) = model.objects
    view = model.view._replace(sure=sure)
    model = replace(model, view=view)
    left, bottom = view.west + west, view.south + 5
    square = shapely.box(left, bottom, left + 4, bottom + 4)
    node = replace(
        node, polygon=square, moved=turned != 0.0, turned=turned, dubious=dubious, resisted=("north",) * stuck
    )
    return ManipulationOracle().find(Request(node, {"r": Inside(shapely.box(13, 1, 23, 13))}), situation_of(model))


def test_a_passage_that_is_too_narrow_is_a_proof() -> None:
    answer = asked(4)
    assert isinstance(answer, Infeasibility)
    assert answer.proved
    assert "too narrow by 2.00" in answer.reason()


@pytest.mark.parametrize("west", [-0.5, 0.5, 9.0])
def test_an_object_that_overlaps_a_wall_proves_nothing(west: float) -> None:
    answer = asked(west)
    assert isinstance(answer, Infeasibility)
    assert not answer.proved
    assert "overlap a wall" in answer.reason()


@pytest.mark.parametrize(("turned", "proved"), [(0.0, True), (-90.0, True), (181.0, True), (75.0, False)])
def test_an_object_that_was_turned_askew_proves_nothing(turned: float, proved: bool) -> None:
    answer = asked(4, turned)
    assert isinstance(answer, Infeasibility)
    assert answer.proved == proved
    assert ("askew" in answer.reason()) != proved


@pytest.mark.parametrize(
    ("moved", "west", "opens", "proved"),
    [
        (True, 4.3, False, False),
        (True, 4.0, False, True),
        (False, 4.3, False, True),
        (True, 4.3, True, True),
    ],
)
def test_an_object_stopped_off_the_grid_that_no_wider_passage_helps_proves_nothing(
    moved: bool, west: float, opens: bool, proved: bool
) -> None:
    shape = shapely.box(west, 5, west + 4, 9)
    node = Node("o1", "object", 60, "part1", patch_of_polygon(shape), 0, polygon=shape, moved=moved)
    plan = CarryingPlan("impossible", reason="body")
    neck = Bottleneck((9.0, 7.0), ((9.0, 6.0), (9.0, 8.0)), 2.0)
    plan.__dict__.update(passage=neck, opens=opens, missing=0.5 if opens else math.inf)  # as if it had been worked out
    answer = certify(node, [(2, plan)], known_model(PARTED))
    assert answer.proved == proved
    assert ("stopped on its way" in answer.reason()) != proved


@pytest.mark.parametrize(
    ("between", "words"),
    [
        ((math.inf, math.inf, math.inf), "is not all that stops it: a wider one would not help"),
        ((0.0, math.nan, math.inf), "is too narrow"),
        ((0.49, 0.5, 0.51), "is too narrow by 0.50 squares"),
        ((0.4, 0.5, 0.6), "is too narrow by 0.50 squares (between 0.40 and 0.60)"),
    ],
)
def test_a_reason_says_no_more_than_the_search_decided(between: tuple[float, float, float], words: str) -> None:
    body = MotionPlan("impossible")
    body.__dict__.update(passage=Bottleneck((9.0, 7.0), ((9.0, 6.0), (9.0, 8.0)), 2.0), missing_between=between)
    body.__dict__["when_wide"] = "found" if between[1] == 0.5 else "limit" if between[0] == 0.0 else "impossible"
    plan = CarryingPlan("impossible", body=body)
    assert plan.missing == pytest.approx(between[1], nan_ok=True)
    assert how_narrow(plan) == words


@pytest.mark.parametrize(("anew", "askew", "proved"), [(False, 20.0, True), (True, 20.0, False), (True, 0.0, True)])
def test_an_object_that_lies_askew_proves_nothing_after_a_restart(anew: bool, askew: float, proved: bool) -> None:
    model = replace(known_model(PARTED), anew=anew)
    (node,) = model.objects
    shape = shapely.affinity.rotate(shapely.box(4, 5, 8, 9), askew)
    west, south = model.view.west, model.view.south
    node = replace(node, polygon=shapely.affinity.translate(shape, west, south), moved=False)
    answer = ManipulationOracle().find(Request(node, {"r": Inside(shapely.box(13, 1, 23, 13))}), situation_of(model))
    assert isinstance(answer, Infeasibility)
    assert answer.proved == proved
    assert ("forgotten" in answer.reason()) != proved


@pytest.mark.parametrize("dubious", [False, True])
def test_an_object_that_impressions_disagree_with_proves_nothing(dubious: bool) -> None:
    answer = asked(4, dubious=dubious)
    assert isinstance(answer, Infeasibility)
    assert answer.proved != dubious
    assert ("agree" in answer.reason()) == dubious


@pytest.mark.parametrize(("stuck", "sure"), [(0, True), (0, False), (1, True), (1, False)])
def test_an_object_that_did_not_move_proves_nothing_while_the_map_is_not_sure(stuck: int, sure: bool) -> None:
    answer = asked(4, stuck=stuck, sure=sure)
    assert isinstance(answer, Infeasibility)
    assert answer.proved == (sure or not stuck)
    assert ("did not move" in answer.reason()) != answer.proved


@pytest.mark.parametrize(("inexact", "apart", "proved"), [(False, 0, True), (True, 0, False), (True, 2, True)])
def test_an_obstacle_that_may_be_part_of_the_object_proves_nothing(inexact: bool, apart: int, proved: bool) -> None:
    model = known_model(STOPPED_UP)
    x, y = model.view.west + 11, model.view.south + 5
    small, square = shapely.box(x, y, x + 1, y + 1), shapely.box(x - 4 - apart, y - 1, x - apart, y + 3)
    assert model.view.state[model.view.locate(x + 0.5, y + 0.5)] == OCCUPIED
    squares = patch_of_polygon(small)
    beside = Node("o1", "object", POSSIBLE_OBJECT - 1, "part1", squares, 0, polygon=small, felt_first=True)
    node = Node("o2", "object", 99, "part2", patch_of_polygon(square), 0, polygon=square, moved=True, inexact=inexact)
    model = replace(model, objects=(beside, node))
    answer = ManipulationOracle().find(Request(node, {"r": Inside(shapely.box(13, 1, 23, 11))}), situation_of(model))
    assert isinstance(answer, Infeasibility) == proved
    assert not isinstance(answer, Infeasibility) or answer.proved


@pytest.mark.parametrize(("movable", "thick", "proved"), [(0, 1, False), (0, 3, True), (50, 1, False)])
def test_an_immovable_obstacle_may_cover_the_squares_at_its_rim_in_part(movable: int, thick: int, proved: bool) -> None:
    """The obstacle, `thick` squares on each side, stands in a door of five; the carried object is four squares wide.

    A movable obstacle is moved out of the way.
    """
    rows, half = [line.replace("r", ".") for line in STOPPED_UP], thick // 2
    for n in range(6 - half, 7 + half):
        rows[n] = rows[n][: 11 - half] + "r" * thick + rows[n][12 + half :]
    model = known_model(rows)
    x, y = model.view.west + 11 - half, model.view.south + 6 - half
    assert model.view.state[model.view.locate(x + 0.5, y + 0.5)] == OCCUPIED
    fixed, square = shapely.box(x, y, x + thick, y + thick), shapely.box(x - 6, y - 2, x - 2, y + 2)
    squares = patch_of_polygon(fixed)
    other = Node("o1", "object", 60, "part1", squares, 0, polygon=fixed, movable=movable, felt_first=True)
    node = Node("o2", "object", 99, "part2", patch_of_polygon(square), 0, polygon=square)
    model = replace(model, objects=(other, node))
    answer = ManipulationOracle().find(Request(node, {"r": Inside(shapely.box(13, 1, 23, 12))}), situation_of(model))
    assert isinstance(answer, Infeasibility) == proved
    assert answer.proved if isinstance(answer, Infeasibility) else answer.aside == ("o1",)


@pytest.mark.parametrize(
    ("plans", "closest"),
    [([(4, 1.0), (4, math.inf)], 0), ([(0, 1.0), (4, math.inf)], 1), ([(4, 2.0), (4, 1.0)], 1), ([(4, math.nan)], 0)],
)
def test_the_named_passage_is_one_that_could_be_widened(plans: list[tuple[int, float]], closest: int) -> None:
    asked_for = [(level, cast(CarryingPlan, SimpleNamespace(opens=math.isfinite(missing)))) for level, missing in plans]
    assert closest_refuted(asked_for) is asked_for[closest][1]


FLUSH = [  # an L of five squares, and a door as wide
    "b" * 30,
    *["b" + "." * 13 + "bb" + "." * 13 + "b"] * 4,
    "b" + "." * 28 + "b",
    "b....gg" + "." * 22 + "b",
    "b....gg" + "." * 15 + "U......b",
    "b....ggggg" + "." * 19 + "b",
    "b....ggggg" + "." * 19 + "b",
    *["b" + "." * 13 + "bb" + "." * 13 + "b"] * 5,
    "b" * 30,
]


@pytest.mark.parametrize(("contacts", "clearance"), [(0, 0.0), (CONTACTS_FOR_CLEARANCE, WALL_CLEARANCE)])
def test_an_object_with_many_contacts_keeps_its_distance(contacts: int, clearance: float) -> None:
    model = known_model(FLUSH)
    (node,) = model.objects
    west, south = model.view.west + 5, model.view.south + 6
    ell = [(0, 0), (5, 0), (5, 2), (2, 2), (2, 4), (0, 4)]
    node = replace(node, polygon=shapely.Polygon([(x + west, y + south) for x, y in ell]))
    room = Inside(shapely.box(16, 1, 29, 15))
    found = ManipulationOracle().find(Request(node, {"r": room}, contacts=contacts), situation_of(model))
    assert isinstance(found, ManipulationPlan)
    walls = shapely.union_all(
        [shapely.box(c, r, c + 1, r + 1) for r, c in zip(*(model.view.state == OCCUPIED).nonzero(), strict=True)]
    ).difference(shapely.box(5, 6, 10, 10))
    shape = shapely.Polygon([(x + 5, y + 6) for x, y in ell])
    nearest = 1.0
    for leg in found.plan.legs:
        for motion in leg.motions:
            nearest = min(nearest, *(motion.part(n / 64).carry(shape).distance(walls) for n in range(1, 65)))
            shape = motion.carry(shape)
    assert room.polygon.covers(shape)
    assert nearest >= clearance - 1e-6


@pytest.mark.parametrize(
    ("who", "found", "proved"), [("", True, False), ("y", True, False), ("x", False, True), ("utak", False, False)]
)
def test_no_object_is_carried_through_a_forbidden_door(who: str, found: bool, proved: bool) -> None:
    """A door forbidden to the robot alone lets the object pass: then a plan that is not found proves nothing."""
    rows = [row.replace("gggg", "gg..") for row in PARTED]
    model = known_model(rows)
    (node,) = model.objects
    left, bottom = node.patch.west, node.patch.south
    node = replace(node, polygon=shapely.box(left, bottom, left + 2, bottom + 4))
    model = replace(model, objects=(node,), held=node.name, place=(left + 2.5, bottom + 1.5))
    task = Task({}, (), facts_from_text(f"not_through({who}, d).") if who else ())
    situation = situation_of(model, {"x": node.name}, task)
    assert len(situation.rooms.sure) == 1
    request = Request(node, {"r": Inside(shapely.box(13, 1, 23, 13))}, held=True)
    answer = ManipulationOracle().find(request, situation)
    assert isinstance(answer, ManipulationPlan) == found
    assert not isinstance(answer, Infeasibility) or answer.proved == proved
    (door,) = situation.rooms.doors
    likely = replace(
        situation, rooms=replace(situation.rooms, doors=(replace(door, confidence=MIN_DOOR_CONFIDENCE - 1),))
    )
    assert bool(likely.forbidden(node.name)) == (who == "x")  # an object is kept from whatever may be a door
    assert bool(likely.forbidden("utak")) == (who == "utak")  # and so is the robot, while no door is sure
