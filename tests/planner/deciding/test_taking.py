"""What Utak does where he takes a thing: he goes by what he feels, and not again where it failed."""

import math
from dataclasses import replace

import numpy as np
import pytest
import shapely

import planner.carrying.plan_executor
import planner.carrying.remaining_plan
from geometry.manipulation.plan_carrying import CarryingPlan, Inside, Leg
from geometry.motion.se2 import Rotate, Translate
from kb.body import Command, Grasp, Move, Push, Release
from kb.language.reader import facts_of
from kb.mapping.occupancy import OPEN
from kb.task.binding import Reconciled
from kb.world.model import Node, WorldModel
from planner.advice import Act, Go
from planner.carrying.infeasibility import Infeasibility
from planner.carrying.manipulation_oracle import ManipulationOracle, ManipulationPlan, Request
from planner.carrying.plan_executor import PlanExecutor
from planner.carrying.remaining_plan import RemainingPlan
from planner.deciding import transport
from planner.deciding.decider import Decider
from planner.goals.placement import Placement
from planner.sights.frontiers import CLOSE
from planner.situation import Situation
from planner.stages import Stage
from tests.kb.drawings import seen_whole
from tests.planner.situations import BESIDE_A_THING, NO_TASK, situation_of

NOTHING: tuple[str | None, ...] = (None,) * 8
EAST, NORTHWEST = 2, 7


def touching(directions: dict[int, str]) -> tuple[str | None, ...]:
    return tuple(directions.get(n) for n in range(8))


def beside(touch: tuple[str | None, ...], place: tuple[float, float] = (0.5, 0.5)) -> Situation:
    """One who stands right beside a square thing, and feels this."""
    model = seen_whole(BESIDE_A_THING)
    (node,) = model.objects
    west, south = node.patch.west, node.patch.south
    node = replace(node, polygon=shapely.box(west, south, west + 3, south + 3), colour="g", shape={"square": 99})
    model = replace(model, objects=(node,), touch=touch, place=place)
    return situation_of(model, {"x": node.name})


def advice(carrier: PlanExecutor, situation: Situation) -> planner.carrying.plan_executor.Advice:
    """What to do to bring the thing to the eastern end of the room."""
    (node,) = situation.model.objects
    return carrier.advise(node, {"r": Inside(shapely.box(14, 2, 19, 14))}, situation)


def doubtful(situation: Situation, x: float, y: float, chance: float) -> Situation:
    """The same, but the square of a point is not settled: this likely it is occupied."""
    model = situation.model
    view, place = model.view, model.view.locate(x, y)
    state, probability = view.state.copy(), view.probability.copy()
    state[place], probability[place] = OPEN, chance
    return situation_of(replace(model, view=view._replace(state=state, probability=probability)), situation.binding)


def haul_over(situation: Situation, x: float, y: float, pushes: int, taken: bool = False) -> ManipulationPlan:
    """A plan of so many pushes that needs the square of a point. taken : it goes on with the hold he has."""
    view = situation.model.view
    swept = np.zeros(view.state.shape, np.bool_)
    swept[view.locate(x, y)] = True
    legs = (Leg((0.5, 0.5), (1, 0), (Translate(1.0, 0.0),) * pushes, taken=taken),)
    return ManipulationPlan(CarryingPlan("found", legs, held=taken), "r", 0, swept)


def way_of(situation: Situation) -> str | None:
    """The direction of a grasp that was planned towards the east."""
    (node,) = situation.model.objects
    leg = Leg(situation.model.place, (1, 0), ())
    course = RemainingPlan(node.name, "r", node.polygon, (leg,), node.patch, 0)
    return planner.carrying.remaining_plan.grasp_direction(leg, course, situation.model)


@pytest.mark.parametrize(
    ("touch", "direction"),
    [
        ((), "east"),  # of what is felt nothing is known
        (touching({EAST: "g"}), "east"),
        (touching({EAST - 1: "g"}), "northeast"),  # it covers that square too
        (touching({NORTHWEST: "g"}), "northwest"),  # it must lie there
        (touching({NORTHWEST: "b"}), None),  # that is something else
        (touching({EAST: "b"}), None),
        (NOTHING, None),
    ],
)
def test_he_takes_it_where_he_feels_it(touch: tuple[str | None, ...], direction: str | None) -> None:
    assert way_of(beside(touch)) == direction


def test_while_its_colour_is_not_known_it_is_only_taken_where_it_is_believed() -> None:
    def uncoloured(touch: tuple[str | None, ...]) -> Situation:
        situation = beside(touch)
        (node,) = situation.model.objects
        return replace(situation, model=replace(situation.model, objects=(replace(node, colour=None),)))

    assert way_of(uncoloured(touching({EAST: "g"}))) == "east"
    assert way_of(uncoloured(touching({NORTHWEST: "g"}))) is None


def test_who_feels_it_takes_it_and_who_does_not_goes_elsewhere() -> None:
    felt = advice(PlanExecutor(), beside(touching({EAST - 1: "g", EAST: "g", EAST + 1: "g"})))
    assert isinstance(felt, Act)
    assert felt.command == Grasp("east")
    carrier = PlanExecutor()
    unfelt = advice(carrier, beside(NOTHING))
    assert isinstance(unfelt, Go)
    assert math.dist(unfelt.place, (0.5, 0.5)) >= 1
    assert carrier.failed


@pytest.mark.parametrize("place", [(0.5, 0.5), (0.8, 0.3), (0.1, 0.9)])
def test_where_it_failed_he_does_not_take_it_again_wherever_in_the_square_he_stands(place: tuple[float, float]) -> None:
    carrier, situation = PlanExecutor(), beside(touching({EAST: "g"}), place)
    first = advice(carrier, situation)
    assert isinstance(first, Act)
    model: WorldModel = situation.model
    carrier.given_up(replace(model, held=model.objects[0].name))
    second = advice(carrier, situation)
    assert isinstance(second, Go)
    assert (np.floor(second.place) != np.floor(place)).any()


@pytest.mark.parametrize("refused", [True, False])
def test_he_goes_on_with_a_hold_that_brought_him_nowhere_when_nothing_else_helps(
    refused: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    situation = beside(touching({EAST: "g"}))
    (node,) = situation.model.objects
    held = situation_of(replace(situation.model, held=node.name), situation.binding)
    carrier, find, asked = PlanExecutor(), ManipulationOracle.find, []
    carrier._went_on = held.model.place

    def grudging(self: ManipulationOracle, request: Request, situation: Situation) -> ManipulationPlan | Infeasibility:
        asked.append(request.held)
        return find(self, request, situation) if request.held or not refused else Infeasibility(False, lambda: "no way")

    monkeypatch.setattr(ManipulationOracle, "find", grudging)
    found = advice(carrier, held)
    assert isinstance(found, Act)
    assert asked == ([False, True] if refused else [False])
    assert isinstance(found.command, Push) or not refused


@pytest.mark.parametrize(("aside", "goes_on"), [(0.0, True), (0.2, True), (1.0, False)])
def test_what_he_would_take_again_from_where_he_stands_he_does_not_let_go(aside: float, goes_on: bool) -> None:
    situation = beside(touching({EAST: "g"}))
    (node,) = situation.model.objects
    held = situation_of(replace(situation.model, held=node.name), situation.binding)
    push = Translate(10.0, 0.0)
    leg = Leg((0.5, 0.5 - aside), (1, 0), (push,))
    course = RemainingPlan(node.name, "r", node.polygon, (leg,), node.patch, 0)
    ends = {"r": Inside(shapely.box(14, 2, 19, 14))}
    advice = PlanExecutor()._taking(course, leg, ends, held)
    assert isinstance(advice, Act)
    assert advice.command == (Push(10.0, 0.0) if goes_on else Release())


@pytest.mark.parametrize(("pushes", "chance", "looks"), [(7, 0.9, True), (3, 0.9, False), (7, 0.05, False)])
def test_what_takes_away_the_room_of_a_tedious_way_is_looked_at(pushes: int, chance: float, looks: bool) -> None:
    situation = doubtful(beside(()), 8.5, 3.5, chance)
    view, (node,) = situation.model.view, situation.model.objects
    see = PlanExecutor()._seen(haul_over(situation, 8.5, 1.5, pushes), node, situation)
    assert (see is not None) == looks
    if see is not None:
        place = view.locate(8.5, 3.5)
        rows, columns = np.divmod(see.viewpoint.squares, view.state.shape[1])
        assert max(abs(rows - place[0]).max(), abs(columns - place[1]).max()) <= CLOSE


@pytest.mark.parametrize(("pushes", "taken", "looks"), [(3, False, True), (3, True, False), (8, True, True)])
def test_he_does_not_let_go_of_a_thing_to_look_at_its_way_unless_that_is_tedious(
    pushes: int, taken: bool, looks: bool
) -> None:
    situation = doubtful(beside(()), 8.5, 1.5, 0.2)
    (node,) = situation.model.objects
    haul = haul_over(situation, 8.5, 1.5, pushes, taken)
    assert (PlanExecutor()._seen(haul, node, situation) is not None) == looks


@pytest.mark.parametrize("lost", [False, True])
def test_who_was_lost_does_not_say_that_a_thing_is_in_the_next_room(
    lost: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    situation = beside(())
    (node,) = situation.model.objects
    decider, stage = Decider(NO_TASK, bound=situation.binding), Stage(facts_of("through(x, d)."))
    decider.transporter.beginnings.at("x", node, situation)
    monkeypatch.setattr("planner.deciding.transport.landing", lambda *_: Placement({}, holds=True))
    after = situation_of(replace(situation.model, anew=lost), situation.binding)
    decision = decider.transporter.towards(stage.goals[0], stage, after, Reconciled({}, (), (), ()))
    if lost:
        assert decision is not None and decision.verdict == "limit" and "the robot was lost" in decision.why
    else:
        assert decision is None


def about_to_turn(spread: float, turn: float, looks: int) -> tuple[Situation, Decider, Node, Stage]:
    """One who has looked so often and is about to take a thing and to turn it."""
    situation = beside(())
    looked = frozenset((x, 0) for x in range(looks))
    model = replace(situation.model, spread=spread, likely_spread=spread, looked_from=looked)
    situation = situation_of(model, situation.binding)
    (node,) = situation.model.objects
    motions = (Rotate(turn, (0.5, 0.5)),) if turn else (Translate(3.0, 0.0),)
    decider = Decider(NO_TASK, bound=situation.binding)
    leg = Leg((0.5, 0.5), (1, 0), motions)
    decider.transporter.carrier._course = RemainingPlan(node.name, "r", node.polygon, (leg,), node.patch, 0)
    return situation, decider, node, Stage(facts_of("at(x, corner(northeast))."))


@pytest.mark.parametrize("command", [Move(0.2, 0.0), Grasp("east"), Push(1.0, 0.0)])
def test_he_looks_before_he_makes_ready_to_take_it(command: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    situation, decider, _, stage = about_to_turn(math.pi, 90.0, 2)
    monkeypatch.setattr(PlanExecutor, "advise", lambda *_: Act(command, "so"))
    decision = decider.transporter.towards(stage.goals[0], stage, situation, Reconciled({}, (), (), ()))
    assert decision is not None
    assert decision.why.startswith("so" if isinstance(command, Push) else "how the squares lie")


@pytest.mark.parametrize(
    ("spread", "sure", "verdict"), [(math.pi, True, "limit"), (0.0, True, "impossible"), (0.0, False, "limit")]
)
def test_while_it_is_open_how_the_squares_lie_nothing_is_proved_of_what_does_not_move(
    spread: float, sure: bool, verdict: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    situation, decider, node, stage = about_to_turn(spread, 0.0, 9)
    decider.bound = {}
    view = situation.model.view._replace(sure=sure)
    fixed = replace(situation.model, objects=(replace(node, movable=0),), view=view)
    reconciled = Reconciled({}, ("x",), (), (), (("x", node.name),))
    looking = decider.transporter.towards(stage.goals[0], stage, situation_of(fixed, {}), reconciled)
    assert looking is not None and looking.command is not None  # for another x
    monkeypatch.setattr(transport, "aims_towards", lambda *_: [])
    decision = decider.transporter.towards(stage.goals[0], stage, situation_of(fixed, {}), reconciled)
    assert decision is not None
    assert (decision.command, decision.verdict) == (None, verdict)
    assert f"{node.name} cannot be moved" in decision.why


@pytest.mark.parametrize(
    ("pushed", "moved", "stuck", "pull", "drawn"),
    [
        (Translate(6.0, 8.0), True, 1, True, (-0.6, -0.8)),
        (Translate(0.3, 0.0), True, 1, True, (-0.3, 0.0)),  # no further than it was pushed
        (Translate(6.0, 8.0), True, 2, True, None),  # that did not help
        (Translate(6.0, 8.0), False, 1, True, None),  # it may not be in hand at all
        (Translate(6.0, 8.0), True, 1, False, None),
        (None, True, 1, True, None),  # it was turned, or drawn back
    ],
)
def test_what_stands_against_something_is_first_drawn_back_from_it(
    pushed: Translate | None, moved: bool, stuck: int, pull: bool, drawn: tuple[float, float] | None
) -> None:
    model = beside(()).model
    node = replace(model.objects[0], moved=moved, stuck=stuck)
    model = replace(model, objects=(node,), held=node.name)
    carrier = PlanExecutor(pull)
    carrier._pushed = pushed
    found = carrier._failure(None, model)
    assert isinstance(found, Act)
    if drawn is None:
        assert found.command == Release()
        return
    assert isinstance(found.command, Push)
    assert (found.command.east, found.command.north) == pytest.approx(drawn)
    again = carrier._failure(None, model)
    assert isinstance(again, Act)
    assert again.command == Release()
