"""Taking a thing along to where Utak wants to look, instead of letting it go and coming back for it."""

import math
from dataclasses import replace

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

import planner.deciding.pursuit
import planner.deciding.transport
from geometry.manipulation.plan_carrying import Leg
from geometry.manipulation.workspace import Workspace
from geometry.motion.se2 import Motion, Rotate, Translate
from kb.body import Grasp, Move, Push, Release
from kb.language.reader import facts_of
from kb.mapping.patch import Patch
from kb.task.binding import Reconciled
from kb.world.model import Node
from planner.advice import Act, See
from planner.carrying.infeasibility import Infeasibility
from planner.carrying.plan_executor import PlanExecutor
from planner.carrying.remaining_plan import RemainingPlan
from planner.deciding.decider import Decider
from planner.deciding.transport import Transporter
from planner.decision import Decision
from planner.goals.placement import Placement, in_view
from planner.navigation.subgoals import Subgoal
from planner.screen.projection import Squares
from planner.sights.frontiers import Viewpoint
from planner.situation import Situation
from planner.skills.take_along import NEARBY, by_way, lead, near, out
from planner.stages import Stage
from tests.kb.drawings import seen_whole
from tests.planner.situations import NO_TASK, situation_of

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
    """One who has hold of a thing to the east of him."""
    model = seen_whole(ROOM)
    (node,) = model.objects
    west, south = node.patch.west, node.patch.south
    node = replace(node, polygon=shapely.box(west, south, west + 3, south + 2), colour="g", stuck=stuck)
    return situation_of(replace(model, objects=(node,), held=node.name, place=place), {"x": node.name}), node


def at(situation: Situation, *squares: tuple[int, int]) -> Squares:
    """Squares of the lattice as flat indices."""
    view = situation.model.view
    return np.array([(y - view.south) * view.state.shape[1] + x - view.west for x, y in squares])


@pytest.mark.parametrize("place", [(0.5, 0.5), (0.75, 0.3)])
def test_the_nearest_square_to_which_he_can_push_it_straight(place: tuple[float, float]) -> None:
    situation, node = holding(place)
    push = lead(node, at(situation, (9, 5), (0, 6), (3, 5)), situation)
    assert push is not None
    x, y = place[0] + push.dx, place[1] + push.dy
    assert (x, y) == pytest.approx((3.5, 5.5))


def test_what_the_thing_would_run_into_is_no_way() -> None:
    situation, node = holding()
    assert lead(node, at(situation, (10, 0)), situation) is None  # he could stand there, the thing before him could not
    assert lead(node, at(situation, (9, 0)), situation) is not None
    assert lead(node, at(situation, (0, 0)), situation) is None  # there he stands


def to_be_seen(decider: Decider, situation: Situation, squares: Squares, monkeypatch: pytest.MonkeyPatch) -> object:
    """What he does who must look from some squares before he can go on with what he holds."""
    monkeypatch.setattr(PlanExecutor, "advise", lambda *_: See(Viewpoint(squares, "the way is not clear")))
    (goal,) = facts_of("at(x, corner(northeast)).")
    decision = decider.transporter.towards(goal, Stage((goal,)), situation, Reconciled({}, (), (), ()))
    assert decision is not None
    return decision.command


def test_he_takes_it_along_when_he_must_look_on_the_way(monkeypatch: pytest.MonkeyPatch) -> None:
    situation, _ = holding()
    decider = Decider(NO_TASK, bound=situation.binding)
    squares = at(situation, (3, 5))
    assert to_be_seen(decider, situation, squares, monkeypatch) == Push(3.0, 5.0)
    assert to_be_seen(decider, situation, squares, monkeypatch) == Release()  # so it told nothing new


@pytest.mark.parametrize(("stuck", "pull"), [(1, True), (0, False)])
def test_what_did_not_move_or_may_not_be_pulled_is_let_go(
    stuck: int, pull: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    situation, _ = holding(stuck=stuck)
    decider = Decider(NO_TASK, pull=pull, bound=situation.binding)
    assert to_be_seen(decider, situation, at(situation, (3, 5)), monkeypatch) == Release()


def exploring(situation: Situation, squares: Squares, viewpoints: bool, monkeypatch: pytest.MonkeyPatch) -> Decision:
    """What he does who does not know where a thing must end, and may see it from some squares.

    lookouts : it is just there that he must look; else anywhere.
    """
    looks = (Viewpoint(squares, "what may be a door is not clear"),)
    nowhere = Placement({}, "it is not seen yet", looks if viewpoints else ())
    monkeypatch.setattr(planner.deciding.transport, "landing", lambda *_: nowhere)
    monkeypatch.setattr(
        planner.deciding.transport, "aims_towards", lambda *_: [Subgoal("explore", squares, "it goes on unseen")]
    )
    (goal,) = facts_of("around(x, corner).")
    decision = Decider(NO_TASK, bound=situation.binding).transporter.towards(
        goal, Stage((goal,)), situation, Reconciled({}, (), (), ())
    )
    assert decision is not None
    return decision


def beside(stuck: int = 0) -> Situation:
    """One who stands beside the thing and has not got hold of it."""
    situation, _ = holding(stuck=stuck)
    felt = tuple("g" if n == EAST else None for n in range(8))
    return situation_of(replace(situation.model, held=None, touch=felt), situation.binding)


def test_who_explores_fetches_the_thing_first(monkeypatch: pytest.MonkeyPatch) -> None:
    situation = beside()
    decision = exploring(situation, at(situation, (9, 6), (10, 6)), viewpoints=False, monkeypatch=monkeypatch)
    assert decision.command == Grasp("east")
    monkeypatch.undo()
    looking = exploring(situation, at(situation, (9, 6), (10, 6)), viewpoints=True, monkeypatch=monkeypatch)
    assert isinstance(looking.command, Move)  # about a door it would be in the way


@pytest.mark.parametrize(("spread", "command"), [(0.0, Grasp), (1.0, Move)])
def test_nothing_is_fetched_while_it_is_open_how_the_squares_lie(
    spread: float, command: type, monkeypatch: pytest.MonkeyPatch
) -> None:
    situation = beside()
    unsure = situation_of(replace(situation.model, likely_spread=spread), situation.binding)
    decision = exploring(unsure, at(unsure, (9, 6), (10, 6)), viewpoints=False, monkeypatch=monkeypatch)
    assert isinstance(decision.command, command)


def test_what_did_not_move_is_left_where_it_is(monkeypatch: pytest.MonkeyPatch) -> None:
    situation = beside(stuck=1)
    decision = exploring(situation, at(situation, (9, 6), (10, 6)), viewpoints=False, monkeypatch=monkeypatch)
    assert isinstance(decision.command, Move)


def test_near_is_what_is_free_about() -> None:
    situation, _ = holding()
    end = near(at(situation, (9, 0)), situation)
    assert end is not None
    west, _, east, north = end.polygon.bounds
    view = situation.model.view
    assert (west + view.west, east + view.west) == (9 - NEARBY, 9 + NEARBY + 1)
    assert north + view.south == NEARBY + 1
    wall = shapely.Point(13.5 - view.west, 0.5 - view.south)
    assert not end.polygon.intersects(wall)


def in_a_nook(rows: list[str]) -> tuple[Situation, Node]:
    """One who has hold of an L, in its nook; what he holds is not drawn."""
    outline = shapely.union_all([shapely.box(-2, 0, 0, 1), shapely.box(-2, -1, 1, 0)])
    patch = Patch(-2, -1, np.array([[1, 1, 1], [1, 1, 0]], np.bool_))
    node = Node("o1", "object", 100, "", patch, 0, polygon=outline, colour="g")
    return situation_of(replace(seen_whole(rows), objects=(node,), held="o1"), {"x": "o1"}), node


NOOK = ["b" * 16, "b.............Ub", "b..............b"]


def test_what_shuts_him_in_is_led_out_no_further_than_need_be() -> None:
    situation, node = in_a_nook([*NOOK, *["b" + "." * 14 + "b"] * 6, "b" * 16])
    assert out(node, situation) == (-1, 0)  # down beside the wall he goes then
    situation, node = in_a_nook([*NOOK, "b" * 16])
    assert out(node, situation) == (-3, 0)  # the squares right beside it are no room


def test_what_cannot_be_led_out_stays() -> None:
    row = "b" * 12
    situation, node = in_a_nook(["b" * 16, row + "..Ub", row + "...b", "b" * 16])
    assert out(node, situation) is None


def test_what_did_not_move_is_not_led_out_again() -> None:
    situation, node = in_a_nook([*NOOK, *["b" + "." * 14 + "b"] * 6, "b" * 16])
    carrier = PlanExecutor(pull=True)
    led = carrier.led_out(node, situation)
    assert led is not None
    assert isinstance(led.command, Push)
    assert carrier.led_out(replace(node, stuck=1), situation) is None


def at_a_loss(situation: Situation, monkeypatch: pytest.MonkeyPatch) -> Decision:
    """What he does with something in hand who knows no way for it, and nothing to look at."""
    monkeypatch.setattr(Transporter, "_advice", lambda *_: Infeasibility(False, lambda: "it is not seen yet"))
    monkeypatch.setattr(planner.deciding.pursuit, "against_walls", lambda _: [])
    return exploring(situation, at(situation), viewpoints=False, monkeypatch=monkeypatch)


def test_who_is_shut_in_and_at_a_loss_leads_it_out(monkeypatch: pytest.MonkeyPatch) -> None:
    """For from there he sees nothing that he has not seen."""
    drawn = ["b" * 16, "b...........ggUb", "b...........gggb", *["b" + "." * 14 + "b"] * 6, "b" * 16]
    decision = at_a_loss(in_a_nook(drawn)[0], monkeypatch)
    assert decision.command == Push(-1.0, 0.0)
    assert "led out" in decision.why


def test_what_shuts_him_in_is_taken_along_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Who comes back, and must look once more, leads it out and takes it from elsewhere: so he is shut in no more."""
    drawn = ["b" * 16, "b...........ggUb", "b...........gggb", *["b" + "." * 14 + "b"] * 6, "b" * 16]
    situation, _ = in_a_nook(drawn)
    looks = (Viewpoint(at(situation, (-5, -5)), "a room is not seen"),)
    land = Placement({}, "a room is not seen", looks, shut_in=True)
    subgoals = [Subgoal("inspect", looks[0].squares, looks[0].what)]
    monkeypatch.setattr(planner.deciding.transport, "landing", lambda *_: land)
    monkeypatch.setattr(planner.deciding.transport, "aims_towards", lambda *_: subgoals)
    decider, (goal,) = Decider(NO_TASK, bound=situation.binding), facts_of("at(x, corner(northeast)).")
    stage, nothing = Stage((goal,)), Reconciled({}, (), (), ())
    decisions = [decider.transporter.towards(goal, stage, situation, nothing) for _ in range(2)]
    assert [decision and decision.command for decision in decisions] == [Push(-5.0, -5.0), Push(-1.0, 0.0)]


def test_who_is_not_shut_in_and_at_a_loss_gives_up(monkeypatch: pytest.MonkeyPatch) -> None:
    decision = at_a_loss(holding()[0], monkeypatch)
    assert decision.command is None and decision.verdict == "limit"


def surely_free(situation: Situation, node: Node) -> Workspace:
    return Workspace(situation.cost_maps.free(0) | situation.model.mask(node.patch))


@given(st.integers(-3, 14), st.integers(-2, 6), st.integers(-3, 14), st.integers(-2, 6))
@settings(max_examples=60, deadline=None)
def test_a_way_by_a_place_to_look_is_two_pushes_that_are_free(x: int, y: int, dx: int, dy: int) -> None:
    situation, node = holding()
    push = by_way(node, at(situation, (x, y)), (float(dx), float(dy)), situation)
    yard, shape = surely_free(situation, node), in_view(node.polygon, situation)
    here = 0.5 - situation.model.view.west, 0.5 - situation.model.view.south
    there = Translate(float(x), float(y))
    on = Translate(float(dx - x), float(dy - y))
    direct = math.hypot(x, y) > 0.5 and yard.lets(shape, here, there)
    possible = direct and yard.lets(there.carry(shape), (here[0] + x, here[1] + y), on)
    assert push == (there if possible else None)


def test_of_the_places_to_look_from_that_which_is_least_out_of_the_way() -> None:
    situation, node = holding()
    squares = at(situation, (0, 5), (5, 4), (2, 5))
    assert by_way(node, squares, (9.0, 4.0), situation) == Translate(5.0, 4.0)
    assert by_way(node, squares, (-3.0, 4.0), situation) == Translate(0.0, 5.0)


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
def test_he_sees_by_the_way_of_a_push_what_he_would_have_to_come_back_for(
    motions: tuple[Motion, ...], taken: bool, pull: bool
) -> None:
    situation, node = holding()
    carrier = PlanExecutor(pull)
    leg = Leg((0.5, 0.5), (1, 0), motions)
    carrier._course = RemainingPlan(
        node.name, "northeast", node.polygon, (leg,), node.patch, 0, (0.5, 0.5), grasped=True
    )
    assert isinstance(carrier.gone_on(node, situation), Act)
    act = carrier.by_way_of(node, at(situation, (4, 5)), situation)
    assert (act is not None) == (taken and pull)
    if act is not None:
        assert act.command == Push(4.0, 5.0)
        assert carrier.by_way_of(node, at(situation, (4, 5)), situation) == act  # the plan is kept till it is given
        carrier.depart(act)
        assert carrier.gone_on(node, situation) is None  # from there it is planned anew


def test_what_he_has_not_got_hold_of_he_takes_first() -> None:
    situation, node = holding()
    leg = Leg((0.5, 0.5), (1, 0), (Translate(9.0, 4.0),))
    carrier = PlanExecutor()
    carrier._course = RemainingPlan(node.name, "northeast", node.polygon, (leg,), node.patch, 0)
    assert carrier.by_way_of(node, at(situation, (4, 5)), situation) is None
