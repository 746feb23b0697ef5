"""Taking a thing along to where Utak wants to look, instead of letting it go and coming back for it."""

from dataclasses import replace

import numpy as np
import pytest
import shapely

from kb.body import Push, Release
from kb.factfile import facts_of
from kb.reconciliation import Reconciled
from kb.worldmodel import Node
from planner.carrier import Carrier, See
from planner.deciding import Decider
from planner.destinations import Situation
from planner.exploring import Lookout
from planner.goals import Stage
from planner.leading import lead
from planner.screen import Squares
from tests.kb.drawings import seen_whole
from tests.planner.situations import NO_TASK, situation_of

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
    monkeypatch.setattr(Carrier, "advise", lambda *_: See(Lookout(squares, "the way is not clear")))
    (goal,) = facts_of("at(x, corner(northeast)).")
    decision = decider._carry(goal, Stage((goal,)), situation, Reconciled({}, (), (), ()))
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
