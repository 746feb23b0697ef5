"""Presses of a held object against the walls of a corner."""

from dataclasses import replace

import pytest
import shapely

from tests.kb.drawings import known_model
from tests.planner.goals.test_object_goals import facts_from_text
from tests.planner.situations import BESIDE_A_THING, situation_of
from utak.geometry.manipulation.goals import InCorner
from utak.geometry.motion.se2 import Translate
from utak.kb.body import Push
from utak.kb.world.model import Node
from utak.planner.goals.corner_goal import WALL_DEPTH, _wall_pushes
from utak.planner.goals.placement import Placement
from utak.planner.situation import Situation
from utak.planner.skills.press import Presser

(GOAL,) = facts_from_text("at(x, corner(northeast)).")
ACROSS, UP = Translate(1.0, 0.0), Translate(0.0, 1.5)
LAND = Placement({}, holds=True, presses={"across": ACROSS, "up": UP})


def holding() -> tuple[Situation, Node]:
    """Return the situation of a robot beside an object that it holds, and the object."""
    model = known_model(BESIDE_A_THING)
    (node,) = model.objects
    west, south, mask = node.patch
    node = replace(node, polygon=shapely.box(west, south, west + mask.shape[1], south + mask.shape[0]))
    return situation_of(replace(model, objects=(node,), held=node.name)), node


def moved(node: Node, dx: float, dy: float) -> Node:
    """Return an object that was moved, in squares."""
    return replace(node, polygon=shapely.affinity.translate(node.polygon, dx, dy))


def test_each_press_is_given_once_and_an_object_stopped_by_all_is_pressed() -> None:
    situation, node = holding()
    presser = Presser()
    assert not presser.is_pressed(GOAL, node, situation)
    presser.begin(GOAL, node, LAND, situation)
    for way in (ACROSS, UP):
        act = presser.next(node, situation.model)
        assert act.command == Push(way.dx, way.dy)
        node = moved(node, 0.3 * way.dx, 0.3 * way.dy)
        assert presser.is_pressed(GOAL, node, situation)
    assert not presser.has_next(node)
    assert presser.is_pressed(GOAL, node, situation)


def test_an_object_that_went_the_whole_way_was_not_stopped() -> None:
    situation, node = holding()
    presser = Presser()
    presser.begin(GOAL, node, LAND, situation)
    presser.next(node, situation.model)
    assert not presser.is_pressed(GOAL, moved(node, 1.0, 0.0), situation)
    assert not presser.is_pressed(GOAL, node, situation)  # all presses are forgotten


@pytest.mark.parametrize("change", ["released", "another goal", "another corner", "pushed"])
def test_presses_count_for_one_held_object_one_goal_and_one_corner(change: str) -> None:
    situation, node = holding()
    presser, goal = Presser(), GOAL
    presser.begin(GOAL, node, LAND, situation)
    presser.next(node, situation.model)
    if change == "released":
        situation = replace(situation, model=replace(situation.model, held=None))
    elif change == "another goal":
        (goal,) = facts_from_text("at(x, corner(southwest)).")
    elif change == "another corner":
        corner = situation.corners["northeast"]
        corners = {**situation.corners, "northeast": corner._replace(point=(corner.point[0] + 3.0, corner.point[1]))}
        situation = replace(situation, corners=corners)
    else:
        presser.forget()
    assert not presser.is_pressed(goal, node, situation)


def test_an_object_without_presses_or_not_held_is_not_pressed() -> None:
    situation, node = holding()
    presser = Presser()
    presser.begin(GOAL, node, replace(LAND, presses={}), situation)
    assert not presser.is_pressed(GOAL, node, situation)
    loose = replace(situation, model=replace(situation.model, held=None))
    presser.begin(GOAL, node, LAND, loose)
    assert not presser.is_pressed(GOAL, node, loose)


def test_presses_are_given_for_the_object_that_is_pressed_alone() -> None:
    situation, node = holding()
    presser = Presser()
    presser.begin(GOAL, node, LAND, situation)
    assert not presser.has_next(replace(node, name="another"))
    assert presser.has_next(node)
    assert presser.next(node, situation.model).command == Push(ACROSS.dx, ACROSS.dy)
    assert presser.is_pressed(GOAL, moved(node, 0.3, 0.0), situation)


@pytest.mark.parametrize(
    ("gap", "short", "ways"),
    [
        ((0.0, 0.0), (0.0, 0.0, 0.0, 0.0), {}),  # right beside these squares is near enough
        ((0.0, 0.0), (0.0, 0.9, 0.0, 0.0), {"across": WALL_DEPTH + 0.9}),  # its eastern side may lie further in
        ((0.0, 0.5), (0.9, 0.0, 0.9, 0.0), {"up": WALL_DEPTH + 0.5}),  # others do not matter
        ((0.5, 0.5), (0.0, 0.0, 0.0, 0.5), {"across": WALL_DEPTH + 0.5, "up": WALL_DEPTH + 1.0}),
    ],
)
def test_an_object_is_pressed_towards_walls_that_may_be_further_than_a_square(
    gap: tuple[float, float], short: tuple[float, float, float, float], ways: dict[str, float]
) -> None:
    _, node = holding()
    end = InCorner(20.0, 20.0, 1, 1)
    shape = shapely.box(16.0 - gap[0], 17.0 - gap[1], 20.0 - gap[0], 20.0 - gap[1])
    found = _wall_pushes(end, replace(node, short=short), shape)
    assert {name: push.dx + push.dy for name, push in found.items()} == pytest.approx(ways)
