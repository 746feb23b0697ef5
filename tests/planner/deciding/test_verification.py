"""Looks by which he makes sure before he commits himself, or says that something is so."""

import math
from dataclasses import replace

import numpy as np
import pytest
import shapely

import planner.deciding.transport
from geometry.manipulation.plan_carrying import Inside
from kb.body import Move
from kb.language.reader import facts_of
from kb.task.binding import Reconciled
from kb.world.model import WorldModel
from kb.world.rooms import SURE
from planner.carrying.infeasibility import Infeasibility
from planner.carrying.manipulation_oracle import ManipulationOracle, Request
from planner.carrying.open_facts import qualified
from planner.deciding.decider import Decider
from planner.deciding.verification import (
    Verifier,
    _jambs_in_line,
    before_elsewhere,
    before_taking,
    misgiving,
    unseen_beyond,
)
from planner.sights.frontiers import CLOSE
from planner.stages import Stage
from tests.kb.drawings import seen_whole, walked
from tests.planner.situations import BESIDE_A_THING, NO_TASK, situation_of

AT_START = replace(NO_TASK, goals=facts_of("at(utak, start)."))
NARROW = [
    "b" * 30,
    *["b" + "." * 13 + "bb" + "." * 13 + "b"] * 5,
    "b...gggg......bb.............b",
    "b...gggg......bb.............b",
    "b...gggg.....................b",
    "b...gggg................U....b",
    *["b" + "." * 13 + "bb" + "." * 13 + "b"] * 5,
    "b" * 30,
]


def stood_in(rows: list[str], contradicted: bool) -> WorldModel:
    """A room seen whole, by one whose last look, from where he stands, agrees with it or does not."""
    model = seen_whole(rows)
    here = (math.floor(model.place[0]), math.floor(model.place[1]))
    return replace(model, looked_from=frozenset({here}), contradicted=contradicted)


def squares_from(model: WorldModel, squares: np.ndarray) -> np.ndarray:
    """(n, 2): how far east and north of Utak each of some squares of the view is."""
    rows, columns = np.divmod(squares, model.labels.shape[1])
    row, column = model.view.locate(*model.place)
    return np.stack([columns - column, rows - row], axis=1)


@pytest.mark.parametrize(
    ("spread", "turns", "looks", "stuck", "first"),
    [
        (math.pi, True, 2, 0, True),
        (math.pi, False, 2, 0, False),  # what is pushed stays as it lies
        (0.0, True, 2, 0, False),
        (math.pi, True, 9, 0, False),  # he has looked often enough
        (math.pi, False, 2, 1, True),  # it was pushed, and did not move
        (0.0, False, 2, 1, False),
    ],
)
def test_before_a_thing_is_turned_or_tried_again_he_looks_how_the_squares_lie(
    spread: float, turns: bool, looks: int, stuck: int, first: bool
) -> None:
    looked = frozenset((x, 0) for x in range(looks))
    model = replace(seen_whole(BESIDE_A_THING), likely_spread=spread, looked_from=looked)
    (node,) = model.objects
    subgoal = before_taking(replace(node, stuck=stuck), turns, situation_of(model))
    assert (subgoal is not None) == first
    if subgoal is not None:
        assert "how the squares lie" in subgoal.what
        assert len(subgoal.squares)


@pytest.mark.parametrize("sure", [True, False])
def test_who_is_not_sure_of_his_map_looks_at_a_narrow_passage_from_close_by_before_he_says_so(sure: bool) -> None:
    model = seen_whole(NARROW)
    (node,) = model.objects
    node = replace(node, polygon=shapely.box(-20, 0, -16, 4), colour="g", shape={"square": 99})
    model = replace(model, objects=(node,), view=model.view._replace(sure=sure))
    refusal = ManipulationOracle().find(Request(node, {"r": Inside(shapely.box(16, 1, 29, 15))}), situation_of(model))
    assert isinstance(refusal, Infeasibility)
    neck = refusal.neck()
    assert refusal.proved
    assert neck == pytest.approx((15, 7), abs=1.0)
    verifier = Verifier()
    first = verifier.narrow_again(refusal, situation_of(model))
    assert (first is None) == sure
    if first is None:
        return
    rows, columns = np.divmod(first.squares, model.labels.shape[1])
    assert max(np.abs(columns + 0.5 - neck[0]).max(), np.abs(rows + 0.5 - neck[1]).max()) <= CLOSE
    x, y = columns[0] + model.view.west + 0.5, rows[0] + model.view.south + 0.5
    there = situation_of(replace(model, place=(float(x), float(y))))
    assert verifier.narrow_again(refusal, there) is None
    assert verifier.narrow_again(refusal, situation_of(model)) is None  # he need not go there again


def test_who_sees_what_contradicts_his_beliefs_looks_from_elsewhere_near_by() -> None:
    assert misgiving(situation_of(stood_in(BESIDE_A_THING, False))) is None
    model = stood_in(BESIDE_A_THING, True)
    subgoal = misgiving(situation_of(model))
    assert subgoal is not None
    away = np.abs(squares_from(model, subgoal.squares)).max(1)
    assert len(away)
    assert away.min() > 0
    assert away.max() <= CLOSE


@pytest.mark.parametrize("contradicted", [False, True])
def test_nothing_is_held_for_done_while_the_last_look_contradicts_what_is_believed(contradicted: bool) -> None:
    model = stood_in(BESIDE_A_THING, contradicted)
    decider = Decider(AT_START)
    decision = decider.decide(model, [model.place])
    assert (decision.verdict == "done") == (not contradicted)
    if contradicted:
        assert isinstance(decision.command, Move)
        assert decision.why == "what is seen is not as it is believed to be; at(utak,start)"
        assert decider.decide(replace(model, contradicted=False), [model.place]).verdict == "done"


def test_who_has_looked_from_everywhere_and_still_sees_what_contradicts_says_that_he_does_not_know() -> None:
    model = seen_whole(BESIDE_A_THING)
    rows, columns = np.nonzero(model.floor)
    everywhere = frozenset(zip((columns + model.view.west).tolist(), (rows + model.view.south).tolist(), strict=True))
    model = replace(model, contradicted=True, looked_from=everywhere)
    decision = Decider(AT_START).decide(model, [model.place])
    assert decision.command is None
    assert decision.verdict == "limit"
    assert "what is seen is not as it is believed to be" in decision.why


@pytest.mark.parametrize("sure", [True, False])
def test_that_a_thing_is_nowhere_is_not_proved_by_not_seeing_it(sure: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """It may stand against a wall, and look like a piece of that."""
    model = seen_whole(BESIDE_A_THING)
    model = replace(model, objects=(), view=model.view._replace(sure=sure))
    monkeypatch.setattr(planner.deciding.transport, "aims_towards", lambda *_: [])
    (goal,) = facts_of("in(x, room(next)).")
    unseen = Reconciled({}, ("x",), (), ())
    decision = Decider(NO_TASK).transporter.towards(goal, Stage((goal,)), situation_of(model), unseen)
    assert decision is not None
    found = qualified(decision, model)
    assert (found.command, found.verdict) == (None, "possible_if")
    assert "nothing seen so far is x" in found.why and "never felt" in found.why


STUB = [  # a wall between two rooms with a door in it
    "b" * 30,
    *["b" + "." * 13 + "bb" + "." * 13 + "b"] * 5,
    *["b" + "." * 28 + "b"] * 4,
    *["b" + "." * 13 + "bb" + "." * 8 + "U" + "." * 4 + "b"] * 5,
    "b" * 30,
]
BAR = [  # what may be a thing that stands against a wall, and leaves a passage
    "b" * 34,
    *["b" + "." * 32 + "b"] * 5,
    *["b" + "." * 15 + "bb" + "." * 8 + "U" + "." * 6 + "b"] * 8,
    "b" * 34,
]


@pytest.mark.parametrize(("rows", "wall"), [(STUB, True), (BAR, False)])
def test_two_jambs_in_line_are_one_wall(rows: list[str], wall: bool) -> None:
    situation = situation_of(seen_whole(rows))
    (door,) = situation.rooms.doors
    beside = [mask for mask in situation.model.protruding if mask.sum() in (10, 16)]
    assert beside
    assert all(_jambs_in_line(mask, door, situation.model) == wall for mask in beside)


ARM = [  # a room with an arm to the east, just as long as it is seen to be
    *["b" * 54] * 2,
    *["bb" + "." * 25 + "b" * 27] * 11,
    "bb" + "." * 8 + "U" + "." * 16 + "b" * 27,
    *["bb" + "." * 25 + "b" * 27] * 6,
    *["bb" + "." * 50 + "bb"] * 9,
    *["b" * 54] * 2,
]
NEXT = [row[:27] + "bb" + row[29:] if "." * 40 in row else row for row in ARM]  # the same with a wall before the arm
NEXT[22:25] = ARM[22:25]  # and a door in it
WAY = [(0, 3), (4, -3), (-2, 4), (2, -17), (8, 0)]


@pytest.mark.parametrize("goal", ["in", "through"])
def test_what_was_never_seen_makes_no_door_of_the_mouth_of_an_arm(goal: str) -> None:
    situation = situation_of(walked(ARM, WAY).model)
    model = situation.model
    lying, began = model.squares([(24, -10), (25, -10)]), (0.5, 5.0)
    look = before_elsewhere(goal, began, lying, situation)
    assert look is not None
    rows, columns = np.divmod(look.squares, model.labels.shape[1])
    assert (columns + model.view.west > 16).all() and (rows + model.view.south < -4).all()
    assert before_elsewhere("around", began, lying, situation) is None
    assert 1 in {side for door in situation.rooms.sure for side in door.sides}


def test_what_is_seen_to_be_wide_enough_is_another_room() -> None:
    situation = situation_of(walked(NEXT, [*WAY, (10, 2)]).model)
    lying = situation.model.squares([(24, -10), (25, -10)])
    assert unseen_beyond("in", (0.5, 5.0), lying, situation) is None
    assert situation.next_to((0.5, 5.0), situation.rooms, SURE)[lying].all()
