"""Taking an object along to where the robot wants to look, instead of releasing it and coming back for it."""

import math
from dataclasses import replace
from typing import Any, cast

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.kb.drawings import known_model
from tests.planner.situations import Tools, situation_of, tools_with, turn_of
from utak.geometry.manipulation.goals import Inside
from utak.geometry.manipulation.plan_carrying import Leg
from utak.geometry.manipulation.workspace import Workspace
from utak.geometry.motion.se2 import Motion, Rotate, Translate
from utak.kb.body import DIRECTIONS, Grasp, Move, Push, Release
from utak.kb.language.reader import facts_from_text
from utak.kb.mapping.patch import Patch
from utak.kb.objects.movability import way_of
from utak.kb.world.model import Node
from utak.planner.advice import Act, See
from utak.planner.carrying.infeasibility import Infeasibility
from utak.planner.carrying.plan_executor import Advice, PlanExecutor
from utak.planner.carrying.remaining_plan import RemainingPlan
from utak.planner.deciding.transport import Transporter
from utak.planner.decision import Decision, TaskVerdict
from utak.planner.goals.placement import Placement, to_view_frame
from utak.planner.navigation.subgoals import Subgoal
from utak.planner.question import NO_QUESTION
from utak.planner.screen.projection import SquareIndices
from utak.planner.sights.frontiers import Viewpoint
from utak.planner.situation import Situation
from utak.planner.skills.take_along import VIEWPOINT_RADIUS, detour_push, escape_push, region_near, shortest_push
from utak.planner.stages import Stage
from utak.planner.subgoal_kind import SubgoalKind

EAST = 2
ROOM = [
    "b" * 24,
    *["b" + "." * 22 + "b"] * 5,
    "b" + "." * 16 + "b" + "." * 5 + "b",
    "b....ggg" + "." * 9 + "b" + "." * 5 + "b",
    "b...Uggg" + "." * 9 + "b" + "." * 5 + "b",
    "b" + "." * 16 + "b" + "." * 5 + "b",
    "b" * 24,
]


def holding(place: tuple[float, float] = (0.5, 0.5), stuck: int = 0) -> tuple[Situation, Node]:
    """Return the situation of a robot that holds an object to its east, and the object."""
    model = known_model(ROOM)
    (node,) = model.objects
    west, south = node.patch.west, node.patch.south
    node = replace(node, polygon=shapely.box(west, south, west + 3, south + 2), colour="g", resisted=("north",) * stuck)
    return situation_of(replace(model, objects=(node,), held=node.name, place=place), {"x": node.name}), node


def at(situation: Situation, *squares: tuple[int, int]) -> SquareIndices:
    """Return squares (x, y) of the map frame as flat indices of the view."""
    view = situation.model.view
    return np.array([(y - view.south) * view.state.shape[1] + x - view.west for x, y in squares])


@pytest.mark.parametrize("place", [(0.5, 0.5), (0.75, 0.3)])
def test_the_shortest_push_leads_to_the_nearest_square(place: tuple[float, float]) -> None:
    situation, node = holding(place)
    push = shortest_push(node, at(situation, (9, 5), (0, 6), (3, 5)), situation)
    assert push is not None
    x, y = place[0] + push.dx, place[1] + push.dy
    assert (x, y) == pytest.approx((3.5, 5.5))


def test_no_push_leads_where_the_object_would_hit_a_wall() -> None:
    situation, node = holding()
    assert (
        shortest_push(node, at(situation, (10, 0)), situation) is None
    )  # the robot could stand there, the object before it could not
    assert shortest_push(node, at(situation, (9, 0)), situation) is not None
    assert shortest_push(node, at(situation, (0, 0)), situation) is None  # the robot stands there


class AskingExecutor:
    """A plan executor that always advises to look from some squares first."""

    def __init__(self, executor: PlanExecutor, squares: SquareIndices) -> None:
        self._executor, self._squares = executor, squares

    def advise(self, *_: object) -> Advice:
        return See(Viewpoint(self._squares, "the way is not clear"), NO_QUESTION)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._executor, name)


def asked_to_see(situation: Situation, squares: SquareIndices, pull: bool = True) -> tuple[Transporter, Tools]:
    """Return a transporter, and tools whose executor wants to see something from some squares before it goes on."""
    executor = AskingExecutor(PlanExecutor(pull), squares)
    return Transporter(), tools_with(cast(PlanExecutor, executor))


def command_to_see(transporter: Transporter, situation: Situation, tools: Tools) -> object:
    """Return the command towards a goal for the held object."""
    (goal,) = facts_from_text("at(x, corner(northeast)).")
    decision = transporter.towards(goal, turn_of(Stage((goal,)), situation, tools))
    assert decision is not None
    return decision.command


def test_a_held_object_is_taken_along_to_a_look_on_the_way() -> None:
    situation, _ = holding()
    transporter, tools = asked_to_see(situation, at(situation, (3, 5)))
    assert command_to_see(transporter, situation, tools) == Push(3.0, 5.0)
    assert command_to_see(transporter, situation, tools) == Release()  # the push told nothing new


@pytest.mark.parametrize(("stuck", "pull"), [(1, True), (0, False)])
def test_an_object_that_did_not_move_or_may_not_be_pulled_is_released_before_a_look(stuck: int, pull: bool) -> None:
    situation, _ = holding(stuck=stuck)
    transporter, tools = asked_to_see(situation, at(situation, (3, 5)), pull)
    assert command_to_see(transporter, situation, tools) == Release()


def exploring(situation: Situation, squares: SquareIndices, viewpoints: bool, tools: Tools | None = None) -> Decision:
    """Return what is decided while it is not known where an object must end, and some squares are worth a look.

    viewpoints : whether the robot must look from just these squares; else from anywhere.
    """
    looks = (Viewpoint(squares, "what may be a door is not clear"),)
    nowhere = Placement({}, "it is not seen yet", looks if viewpoints else ())
    subgoals = [Subgoal(SubgoalKind.EXPLORE, squares, "it goes on unseen")]
    (goal,) = facts_from_text("around(x, corner).")
    transporter, turn = transporter_where(nowhere, subgoals), turn_of(Stage((goal,)), situation, tools)
    return transporter.led_out(transporter.towards(goal, turn), turn)


def transporter_where(land: Placement, subgoals: list[Subgoal]) -> Transporter:
    """Return a transporter for which goals hold at one placement, and that finds some subgoals while they do not."""
    transporter = Transporter()
    transporter.place, transporter.search = lambda *_: land, lambda *_: subgoals
    return transporter


def beside(stuck: int = 0) -> Situation:
    """Return the situation of a robot that stands beside the object and does not hold it."""
    situation, _ = holding(stuck=stuck)
    felt = tuple("g" if n == EAST else None for n in range(8))
    return situation_of(replace(situation.model, held=None, touch=felt), situation.binding)


def test_the_object_is_fetched_before_the_robot_explores() -> None:
    situation = beside()
    decision = exploring(situation, at(situation, (9, 6), (10, 6)), viewpoints=False)
    assert decision.command == Grasp("east")
    looking = exploring(situation, at(situation, (9, 6), (10, 6)), viewpoints=True)
    assert isinstance(looking.command, Move)  # at a door the object would be in the way


@pytest.mark.parametrize(("spread", "command"), [(0.0, Grasp), (1.0, Move)])
def test_nothing_is_fetched_while_the_frame_is_open(spread: float, command: type) -> None:
    situation = beside()
    unsure = situation_of(replace(situation.model, likely_spread=spread), situation.binding)
    decision = exploring(unsure, at(unsure, (9, 6), (10, 6)), viewpoints=False)
    assert isinstance(decision.command, command)


def test_an_object_that_did_not_move_is_not_fetched() -> None:
    situation = beside(stuck=1)
    decision = exploring(situation, at(situation, (9, 6), (10, 6)), viewpoints=False)
    assert isinstance(decision.command, Move)


def test_the_region_near_a_viewpoint_is_what_is_free_about_it() -> None:
    situation, _ = holding()
    end = region_near(at(situation, (9, 0)), situation)
    assert end is not None
    west, _, east, north = end.polygon.bounds
    view = situation.model.view
    assert (west + view.west, east + view.west) == (9 - VIEWPOINT_RADIUS, 9 + VIEWPOINT_RADIUS + 1)
    assert north + view.south == VIEWPOINT_RADIUS + 1
    wall = shapely.Point(13.5 - view.west, 0.5 - view.south)
    assert not end.polygon.intersects(wall)


def in_a_nook(rows: list[str]) -> tuple[Situation, Node]:
    """Return the situation of a robot in the nook of an L that it holds, and the L, which is not drawn."""
    outline = shapely.union_all([shapely.box(-2, 0, 0, 1), shapely.box(-2, -1, 1, 0)])
    patch = Patch(-2, -1, np.array([[1, 1, 1], [1, 1, 0]], np.bool_))
    node = Node("o1", "object", 100, "", patch, 0, polygon=outline, colour="g")
    return situation_of(replace(known_model(rows), objects=(node,), held="o1"), {"x": "o1"}), node


NOOK = ["b" * 16, "b.............Ub", "b..............b"]


def test_an_object_that_shuts_the_robot_in_is_led_out_no_further_than_needed() -> None:
    situation, node = in_a_nook([*NOOK, *["b" + "." * 14 + "b"] * 6, "b" * 16])
    assert escape_push(node, situation) == (-1, 0)  # then the robot can go down beside the wall
    situation, node = in_a_nook([*NOOK, "b" * 16])
    assert escape_push(node, situation) == (-3, 0)  # the squares right beside it are no room


def test_no_push_leads_out_where_there_is_no_room() -> None:
    row = "b" * 12
    situation, node = in_a_nook(["b" * 16, row + "..Ub", row + "...b", "b" * 16])
    assert escape_push(node, situation) is None


def test_an_object_that_did_not_move_one_way_is_led_out_another_way() -> None:
    """What is pressed against a wall does not move that way, and shuts the robot in all the same."""
    situation, node = in_a_nook([*NOOK, *["b" + "." * 14 + "b"] * 6, "b" * 16])
    executor = PlanExecutor(pull=True)
    led = executor.lead_out(replace(node, resisted=("north",)), situation)
    assert isinstance(led, Act)
    assert led.command == Push(-1.0, 0.0)
    otherwise = executor.lead_out(replace(node, resisted=("west",)), situation)
    assert isinstance(otherwise, Act)
    assert isinstance(otherwise.command, Push)
    assert way_of(otherwise.command) != "west"
    none = executor.lead_out(replace(node, resisted=DIRECTIONS), situation)
    assert isinstance(none, Infeasibility) and not none.proved


def at_a_loss(situation: Situation) -> Decision:
    """Return what is decided with a held object, no way for it known, and nothing left to look at or feel."""
    unproved = replace(situation, model=replace(situation.model, shaken=True))
    tools = tools_with()
    return exploring(unproved, at(situation), viewpoints=False, tools=tools)


def test_a_robot_that_is_shut_in_and_at_a_loss_leads_the_object_out() -> None:
    """From inside it sees nothing that it has not seen."""
    drawn = ["b" * 16, "b...........ggUb", "b...........gggb", *["b" + "." * 14 + "b"] * 6, "b" * 16]
    decision = at_a_loss(in_a_nook(drawn)[0])
    assert decision.command == Push(-1.0, 0.0)
    assert "led out" in decision.why


def test_an_object_that_shuts_the_robot_in_is_taken_along_once() -> None:
    """Back again with one more look to do, the robot leads it out, to grasp it so that it is not shut in."""
    drawn = ["b" * 16, "b...........ggUb", "b...........gggb", *["b" + "." * 14 + "b"] * 6, "b" * 16]
    situation, _ = in_a_nook(drawn)
    looks = (Viewpoint(at(situation, (-5, -5)), "a room is not seen"),)
    land = Placement({}, "a room is not seen", looks, shut_in=True)
    subgoals = [Subgoal(SubgoalKind.INSPECT, looks[0].squares, looks[0].what)]
    transporter, tools = transporter_where(land, subgoals), tools_with()
    (goal,) = facts_from_text("at(x, corner(northeast)).")
    turn = turn_of(Stage((goal,)), situation, tools)
    decisions = [transporter.led_out(transporter.towards(goal, turn), turn) for _ in range(2)]
    assert [decision.command for decision in decisions] == [Push(-5.0, -5.0), Push(-1.0, 0.0)]


def test_a_robot_that_is_at_a_loss_and_not_shut_in_gives_up() -> None:
    decision = at_a_loss(holding()[0])
    assert decision.command is None and decision.verdict == TaskVerdict.LIMIT


def surely_free(situation: Situation, node: Node) -> Workspace:
    """Return what is surely free for an object."""
    return Workspace(situation.cost_maps.free(0) | situation.model.mask(node.patch))


@given(st.integers(-3, 14), st.integers(-2, 6), st.integers(-3, 14), st.integers(-2, 6))
@settings(max_examples=60, deadline=None)
def test_a_detour_is_two_pushes_that_are_free(x: int, y: int, dx: int, dy: int) -> None:
    situation, node = holding()
    push = detour_push(node, [at(situation, (x, y))], {}, [Translate(float(dx), float(dy))], situation)
    yard, shape = surely_free(situation, node), to_view_frame(node.polygon, situation)
    here = 0.5 - situation.model.view.west, 0.5 - situation.model.view.south
    there = Translate(float(x), float(y))
    on = Translate(float(dx - x), float(dy - y))
    direct = math.hypot(x, y) > 0.5 and yard.lets(shape, here, there)
    possible = direct and yard.lets(there.carry(shape), (here[0] + x, here[1] + y), on)
    assert push == (there if possible else None)


def test_a_detour_leads_by_the_square_that_is_least_out_of_the_way() -> None:
    situation, node = holding()
    squares = at(situation, (0, 5), (5, 4), (2, 5))
    assert detour_push(node, [squares], {}, [Translate(9.0, 4.0)], situation) == Translate(5.0, 4.0)
    assert detour_push(node, [squares], {}, [Translate(-3.0, 4.0)], situation) == Translate(0.0, 5.0)


def test_the_last_push_ends_where_something_is_seen_within_the_region_of_the_goal() -> None:
    """A push that must end in a region need not end where the plan says, and two looks may take two pushes."""
    situation, node = holding()
    west, south = situation.model.view.west, situation.model.view.south
    region = {"r2": Inside(shapely.box(6 - west, 0 - south, 12 - west, 6 - south))}
    end = [Translate(7.0, 1.0)]
    halt, other = at(situation, (6, 4)), at(situation, (2, 3))
    assert detour_push(node, [halt], region, end, situation) == Translate(6.0, 4.0)
    assert detour_push(node, [halt], {}, end, situation) == Translate(6.0, 4.0)
    assert detour_push(node, [halt, other], region, end, situation) == Translate(2.0, 3.0)


@pytest.mark.parametrize("pull", [True, False])
@pytest.mark.parametrize(
    ("motions", "taken"),
    [
        ((Translate(9.0, 4.0),), True),
        ((Translate(9.0, 0.0), Translate(0.0, 4.0)), True),
        ((Rotate(90.0, (0.5, 0.5)), Translate(4.0, 0.0)), False),
        ((Translate(4.0, 0.0), Rotate(90.0, (4.5, 0.5))), False),
    ],
)
def test_a_detour_takes_the_place_of_pushes_but_not_of_turns(
    motions: tuple[Motion, ...], taken: bool, pull: bool
) -> None:
    situation, node = holding()
    leg = Leg((0.5, 0.5), (1, 0), motions)
    plan = RemainingPlan(node.name, "northeast", node.polygon, (leg,), node.patch, 0, (0.5, 0.5), grasped=True)
    executor = PlanExecutor(pull, plan=plan)
    assert isinstance(executor.continue_plan(node, situation), Act)
    act = executor.detour(node, [at(situation, (4, 5))], {}, situation)
    assert isinstance(act, Act) == (taken and pull)
    if isinstance(act, Act):
        assert act.command == Push(4.0, 5.0)
        assert (
            executor.detour(node, [at(situation, (4, 5))], {}, situation) == act
        )  # the plan is kept until the push is given
        executor.depart(act)
        assert isinstance(executor.continue_plan(node, situation), Infeasibility)  # another plan is made from there


def test_there_is_no_detour_with_an_object_that_is_not_held() -> None:
    situation, node = holding()
    leg = Leg((0.5, 0.5), (1, 0), (Translate(9.0, 4.0),))
    executor = PlanExecutor(plan=RemainingPlan(node.name, "northeast", node.polygon, (leg,), node.patch, 0))
    assert isinstance(executor.detour(node, [at(situation, (4, 5))], {}, situation), Infeasibility)
