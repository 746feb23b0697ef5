"""Grasping an object: by what is felt, and not again where it failed; and what comes before and after it."""

import math
from dataclasses import replace
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest
import shapely

from tests.kb.drawings import known_model
from tests.planner.situations import BESIDE_A_THING, known_situation, situation_of, tools_with, turn_of
from utak.geometry.manipulation.plan_carrying import At, CarryingPlan, Inside, Leg
from utak.geometry.motion.se2 import Pose, Rotate, Translate
from utak.kb.body import Command, Grasp, Move, Push, Release
from utak.kb.language.reader import facts_from_text
from utak.kb.mapping.occupancy import OPEN
from utak.kb.task.binding import Reconciliation
from utak.kb.world.model import Node, WorldModel
from utak.planner.advice import Act, Go
from utak.planner.carrying.infeasibility import Infeasibility
from utak.planner.carrying.manipulation_oracle import EndsFunction, ManipulationOracle, ManipulationPlan, Request
from utak.planner.carrying.plan_executor import Advice, PlanExecutor
from utak.planner.carrying.preconditions import doubts_of_way, sensed_first
from utak.planner.carrying.remaining_plan import RemainingPlan, grasp_direction
from utak.planner.deciding.transport import Transporter
from utak.planner.decision import TaskVerdict
from utak.planner.goals.placement import Placement
from utak.planner.sights.frontiers import FOVEA_RANGE
from utak.planner.situation import Situation
from utak.planner.stages import Stage

NOTHING: tuple[str | None, ...] = (None,) * 8
NOT_DRAWN_BACK = Path(__file__).resolve().parents[3] / "docs" / "sense_rules" / "04_not_drawn_back.lp"
EAST, NORTHWEST = 2, 7


def touching(directions: dict[int, str]) -> tuple[str | None, ...]:
    return tuple(directions.get(n) for n in range(8))


def beside(touch: tuple[str | None, ...], place: tuple[float, float] = (0.5, 0.5)) -> Situation:
    """Return the situation of a robot that stands right beside a square object, and feels `touch`."""
    model = known_model(BESIDE_A_THING)
    (node,) = model.objects
    west, south = node.patch.west, node.patch.south
    node = replace(node, polygon=shapely.box(west, south, west + 3, south + 3), colour="g", shape={"square": 99})
    model = replace(model, objects=(node,), touch=touch, place=place)
    return situation_of(model, {"x": node.name})


def advice(executor: PlanExecutor, situation: Situation) -> Advice:
    """Return what to do to carry the object to the eastern end of the room."""
    (node,) = situation.model.objects
    return executor.advise(node, {"r": Inside(shapely.box(14, 2, 19, 14))}, situation)


def doubtful(situation: Situation, x: float, y: float, chance: float) -> Situation:
    """Return the situation with the square of a point unsettled; chance : probability that it is occupied."""
    model = situation.model
    view, place = model.view, model.view.locate(x, y)
    state, probability = view.state.copy(), view.probability.copy()
    state[place], probability[place] = OPEN, chance
    return situation_of(replace(model, view=view._replace(state=state, probability=probability)), situation.binding)


def plan_over(situation: Situation, x: float, y: float, pushes: int, taken: bool = False) -> ManipulationPlan:
    """Return a plan of some pushes that needs the square of a point. taken : it goes on with the present grasp."""
    view = situation.model.view
    swept = np.zeros(view.state.shape, np.bool_)
    swept[view.locate(x, y)] = True
    legs = (Leg((0.5, 0.5), (1, 0), (Translate(1.0, 0.0),) * pushes, taken=taken),)
    return ManipulationPlan(CarryingPlan("found", legs, held=taken), "r", 0, swept)


def way_of(situation: Situation) -> str | None:
    """Return the direction of a grasp that was planned towards the east."""
    (node,) = situation.model.objects
    leg = Leg(situation.model.place, (1, 0), ())
    plan = RemainingPlan(node.name, "r", node.polygon, (leg,), node.patch, 0)
    return grasp_direction(plan, situation.model)


@pytest.mark.parametrize(
    ("touch", "direction"),
    [
        ((), "east"),  # touches are not known
        (touching({EAST: "g"}), "east"),
        (touching({EAST - 1: "g"}), "northeast"),  # the object covers that square too
        (touching({NORTHWEST: "g"}), "northwest"),  # the object must lie there
        (touching({NORTHWEST: "b"}), None),  # that is something else
        (touching({EAST: "b"}), None),
        (NOTHING, None),
    ],
)
def test_an_object_is_grasped_where_it_is_felt(touch: tuple[str | None, ...], direction: str | None) -> None:
    assert way_of(beside(touch)) == direction


def test_an_object_of_unknown_colour_is_grasped_only_where_it_is_believed() -> None:
    def uncoloured(touch: tuple[str | None, ...]) -> Situation:
        situation = beside(touch)
        (node,) = situation.model.objects
        return replace(situation, model=replace(situation.model, objects=(replace(node, colour=None),)))

    assert way_of(uncoloured(touching({EAST: "g"}))) == "east"
    assert way_of(uncoloured(touching({NORTHWEST: "g"}))) is None


def test_an_object_that_is_not_felt_is_grasped_from_elsewhere() -> None:
    felt = advice(PlanExecutor(), beside(touching({EAST - 1: "g", EAST: "g", EAST + 1: "g"})))
    assert isinstance(felt, Act)
    assert felt.command == Grasp("east")
    executor = PlanExecutor()
    unfelt = advice(executor, beside(NOTHING))
    assert isinstance(unfelt, Go)
    assert math.dist(unfelt.place, (0.5, 0.5)) >= 1
    assert executor.failed


@pytest.mark.parametrize("place", [(0.5, 0.5), (0.8, 0.3), (0.1, 0.9)])
def test_a_failed_grasp_is_not_repeated_from_the_same_square(place: tuple[float, float]) -> None:
    executor, situation = PlanExecutor(), beside(touching({EAST: "g"}), place)
    first = advice(executor, situation)
    assert isinstance(first, Act)
    model: WorldModel = situation.model
    executor.release_looping(replace(model, held=model.objects[0].name))
    second = advice(executor, situation)
    assert isinstance(second, Go)
    assert (np.floor(second.place) != np.floor(place)).any()


class GrudgingOracle:
    """An oracle that notes whether each request may go on with the present grasp, and may refuse the others."""

    def __init__(self, refuses: bool) -> None:
        self.oracle, self.refuses = ManipulationOracle(), refuses
        self.asked: list[bool] = []

    def find(
        self, request: Request, situation: Situation, hoped: EndsFunction = dict
    ) -> ManipulationPlan | Infeasibility:
        self.asked.append(request.held)
        if self.refuses and not request.held:
            return Infeasibility(False, "no way")
        return self.oracle.find(request, situation, hoped)


@pytest.mark.parametrize("refused", [True, False])
def test_a_grasp_that_led_to_no_progress_is_kept_when_nothing_else_helps(refused: bool) -> None:
    situation = beside(touching({EAST: "g"}))
    (node,) = situation.model.objects
    held = situation_of(replace(situation.model, held=node.name), situation.binding)
    oracle = GrudgingOracle(refused)
    executor = PlanExecutor(oracle=cast(ManipulationOracle, oracle))
    first = advice(executor, held)
    assert isinstance(first, Act) and isinstance(first.command, Push) and oracle.asked == [True]
    oracle.asked.clear()
    found = advice(executor, held)  # the robot is where it was
    assert isinstance(found, Act)
    assert oracle.asked == ([False, True] if refused else [False])
    assert isinstance(found.command, Push) or not refused


@pytest.mark.parametrize(("aside", "goes_on"), [(0.0, True), (0.2, True), (1.0, False)])
def test_an_object_that_would_be_grasped_again_from_here_is_not_released(aside: float, goes_on: bool) -> None:
    situation = beside(touching({EAST: "g"}))
    (node,) = situation.model.objects
    held = situation_of(replace(situation.model, held=node.name), situation.binding)
    push = Translate(10.0, 0.0)
    leg = Leg((0.5, 0.5 - aside), (1, 0), (push,))
    plan = RemainingPlan(node.name, "r", node.polygon, (leg,), node.patch, 0)
    ends = {"r": Inside(shapely.box(14, 2, 19, 14))}
    advice = PlanExecutor()._take(plan, ends, held)
    assert isinstance(advice, Act)
    assert advice.command == (Push(10.0, 0.0) if goes_on else Release())


@pytest.mark.parametrize(("pushes", "chance", "looks"), [(7, 0.9, True), (3, 0.9, False), (7, 0.05, False)])
def test_a_square_that_narrows_the_way_of_a_long_plan_is_looked_at(pushes: int, chance: float, looks: bool) -> None:
    situation = doubtful(beside(()), 8.5, 3.5, chance)
    view, (node,) = situation.model.view, situation.model.objects
    sense = sensed_first(doubts_of_way(plan_over(situation, 8.5, 1.5, pushes), node, situation), situation)
    assert (sense is not None) == looks
    if sense is not None:
        assert sense.doubt.name == f"surroundings({node.name})"
        place = view.locate(8.5, 3.5)
        rows, columns = np.divmod(sense.doubt.look.squares, view.state.shape[1])
        assert max(abs(rows - place[0]).max(), abs(columns - place[1]).max()) <= FOVEA_RANGE


@pytest.mark.parametrize(("pushes", "taken", "looks"), [(3, False, True), (3, True, False), (8, True, True)])
def test_a_held_object_is_not_released_to_look_at_its_way_unless_that_is_long(
    pushes: int, taken: bool, looks: bool
) -> None:
    situation = doubtful(beside(()), 8.5, 1.5, 0.2)
    (node,) = situation.model.objects
    plan = plan_over(situation, 8.5, 1.5, pushes, taken)
    assert (sensed_first(doubts_of_way(plan, node, situation), situation) is not None) == looks


@pytest.mark.parametrize(
    ("goal", "told"),
    [
        ("through(x, d)", False),
        ('pose(x, "POINT (3 4)", 0)', False),
        ("at(x, start)", False),
        ("at(x, corner(northeast))", True),
    ],
)
@pytest.mark.parametrize(
    "land", [Placement({}, holds=True), Placement({}, loose={"near": Inside(shapely.box(-9, -9, 99, 99))})]
)
def test_after_a_restart_an_object_is_not_said_to_be_where_only_the_old_map_shows(
    goal: str, told: bool, land: Placement
) -> None:
    """Which room is the next one, and where the robot woke, was told by the map that it forgot."""
    situation = beside(())
    (node,) = situation.model.objects
    for lost in (False, True):
        transporter, stage = Transporter(), Stage(facts_from_text(f"{goal}."))
        transporter.place = lambda *_: land
        transporter.origin_of("x", node, situation)
        after = situation_of(replace(situation.model, anew=lost), situation.binding)
        decision = transporter.towards(stage.goals[0], turn_of(stage, after))
        assert decision.verdict == (TaskVerdict.LIMIT if lost and not told else TaskVerdict.DONE)
        assert ("the robot was lost" in decision.why) == (lost and not told)


def about_to_turn(spread: float, turn: float, looks: int) -> tuple[Situation, RemainingPlan, Node, Stage]:
    """Return a situation after some looks, with a plan to grasp an object and turn it by `turn` degrees."""
    situation = beside(())
    looked = frozenset((x, 0) for x in range(looks))
    model = replace(situation.model, spread=spread, likely_spread=spread, looked_from=looked)
    situation = situation_of(model, situation.binding)
    (node,) = situation.model.objects
    motions = (Rotate(turn, (0.5, 0.5)),) if turn else (Translate(3.0, 0.0),)
    leg = Leg((0.5, 0.5), (1, 0), motions)
    plan = RemainingPlan(node.name, "r", node.polygon, (leg,), node.patch, 0)
    return situation, plan, node, Stage(facts_from_text("at(x, corner(northeast))."))


class AdvisingExecutor:
    """A plan executor that follows a plan and always advises the same."""

    def __init__(self, executor: PlanExecutor, advice: Advice) -> None:
        self._executor, self._advice = executor, advice

    def advise(self, *_: object) -> Advice:
        return self._advice

    def __getattr__(self, name: str) -> Any:
        return getattr(self._executor, name)


@pytest.mark.parametrize("command", [Move(0.2, 0.0), Grasp("east"), Push(1.0, 0.0)])
def test_the_robot_looks_before_it_gets_ready_to_grasp_what_it_will_turn(command: Command) -> None:
    situation, plan, _, stage = about_to_turn(math.pi, 90.0, 2)
    executor = AdvisingExecutor(PlanExecutor(plan=plan), Act(command, "so"))
    tools = tools_with(cast(PlanExecutor, executor))
    decision = Transporter().towards(stage.goals[0], turn_of(stage, situation, tools))
    assert decision is not None
    assert decision.why.startswith("so" if isinstance(command, Push) else "it is not clear how the squares")


@pytest.mark.parametrize(
    ("spread", "sure", "verdict"), [(math.pi, True, "limit"), (0.0, True, "impossible"), (0.0, False, "limit")]
)
def test_an_object_that_does_not_move_proves_nothing_while_the_frame_is_open(
    spread: float, sure: bool, verdict: str
) -> None:
    situation, plan, node, stage = about_to_turn(spread, 0.0, 9)
    tools = tools_with(PlanExecutor(plan=plan))
    view = situation.model.view._replace(sure=sure)
    fixed = replace(situation.model, objects=(replace(node, movable=0),), view=view)
    reconciled = Reconciliation({}, ("x",), (), (), unmovable=(("x", node.name),))
    looking = Transporter().towards(stage.goals[0], turn_of(stage, situation_of(fixed, {}), tools, reconciled))
    assert looking.command is not None  # for another x
    seen_all = Transporter()
    seen_all.search = lambda *_: []
    decision = seen_all.towards(stage.goals[0], turn_of(stage, situation_of(fixed, {}), tools, reconciled))
    assert (decision.command, decision.verdict) == (None, verdict)
    assert f"{node.name} cannot be moved" in decision.why


@pytest.mark.parametrize(
    ("pushed", "moved", "stuck", "pull", "drawn"),
    [
        (Translate(6.0, 8.0), True, 1, True, (-0.6, -0.8)),
        (Translate(0.3, 0.0), True, 1, True, (-0.3, 0.0)),  # no further than it was pushed
        (Translate(6.0, 8.0), True, 2, True, None),  # that did not help
        (Translate(6.0, 8.0), False, 1, True, None),  # it may not be held at all
        (Translate(6.0, 8.0), True, 1, False, None),
        (None, True, 1, True, None),  # it was turned, or drawn back
    ],
)
def test_an_object_that_stands_against_something_is_first_drawn_back(
    pushed: Translate | None, moved: bool, stuck: int, pull: bool, drawn: tuple[float, float] | None
) -> None:
    model = beside(()).model
    node = replace(model.objects[0], moved=moved, resisted=("north",) * stuck)
    model = replace(model, objects=(node,), held=node.name)
    executor = PlanExecutor(pull)
    if pushed is not None:
        executor.depart(Act(Push(pushed.dx, pushed.dy), "so", pushed))
    situation = situation_of(model)
    found = executor._react(None, situation, False)
    assert isinstance(found, Act)
    if drawn is None:
        assert found.command == Release()
        return
    assert isinstance(found.command, Push)
    assert (found.command.east, found.command.north) == pytest.approx(drawn)
    again = executor._react(None, situation, False)
    assert isinstance(again, Act)
    assert again.command == Release()


@pytest.mark.parametrize("ruled", [False, True])
def test_a_rule_tells_what_is_done_with_an_object_that_was_stopped(ruled: bool) -> None:
    model = beside(()).model
    node = replace(model.objects[0], moved=True, resisted=("north",))
    situation = situation_of(replace(model, objects=(node,), held=node.name))
    executor = PlanExecutor()
    executor.depart(Act(Push(3.0, 0.0), "so", Translate(3.0, 0.0)))
    question = situation.question._replace(rules=(NOT_DRAWN_BACK,) if ruled else ())
    reaction = executor._react(None, replace(situation, question=question), False)
    assert isinstance(reaction, Act)
    assert isinstance(reaction.command, Release if ruled else Push)


@pytest.mark.parametrize(
    ("untried", "command"), [(("south", "east"), Push(0.0, -3.0)), (("east",), Push(4.0, 0.0)), ((), Release())]
)
def test_an_object_that_did_not_move_is_moved_another_way_with_the_same_grasp(
    untried: tuple[str, ...], command: Command
) -> None:
    model = known_situation(["b" * 12, *["b..........b"] * 3, "b..ggU.....b", *["b..........b"] * 3, "b" * 12]).model
    node = replace(model.objects[0], resisted=("north",), untried=untried)
    situation = situation_of(replace(model, objects=(node,), held=node.name))
    found = PlanExecutor().advise(node, {"there": At(Pose(0.0, 2.0, 0.0))}, situation)
    assert isinstance(found, Act)
    assert found.command == command


def test_what_was_grasped_anew_is_not_let_go_for_what_failed_before() -> None:
    model = known_situation(["b" * 12, *["b..........b"] * 3, "b..ggU.....b", *["b..........b"] * 3, "b" * 12]).model
    node, executor = replace(model.objects[0], resisted=("north",)), PlanExecutor()
    situation = situation_of(replace(model, objects=(node,)))
    taken = executor.advise(node, {"there": At(Pose(0.0, -2.0, 0.0))}, situation)
    assert isinstance(taken, Act) and isinstance(taken.command, Grasp)
    held = situation_of(replace(situation.model, held=node.name))
    otherwise = executor.advise(node, {"elsewhere": At(Pose(2.0, 0.0, 0.0))}, held)
    assert isinstance(otherwise, Act) and isinstance(otherwise.command, Push)
    refused = executor.advise(node, {"there": At(Pose(0.0, 2.0, 0.0))}, held)
    assert isinstance(refused, Act) and refused.command == Release()
