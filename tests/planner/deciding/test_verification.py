"""Goal verification and active perception: looks before the robot commits itself, or claims something."""

import math
from dataclasses import replace

import numpy as np
import pytest
import shapely

from tests.kb.drawings import known_model, walked
from tests.kb.eyes import utak_in
from tests.planner.situations import BESIDE_A_THING, NO_TASK, situation_of, turn_of
from utak.geometry.manipulation.plan_carrying import Inside
from utak.kb.body import Move
from utak.kb.language.reader import facts_from_text
from utak.kb.language.terms import Fact
from utak.kb.localisation.tracker import RESIDUAL_WINDOW
from utak.kb.task.binding import Reconciliation
from utak.kb.world.model import WorldModel
from utak.kb.world.rooms import MIN_DOOR_CONFIDENCE
from utak.planner.agenda.decider import Decider
from utak.planner.carrying.infeasibility import Infeasibility
from utak.planner.carrying.manipulation_oracle import ManipulationOracle, Request
from utak.planner.carrying.open_facts import open_facts
from utak.planner.carrying.preconditions import Doubt, doubt_of_frame, sensed_first
from utak.planner.deciding.transport import Transporter
from utak.planner.deciding.verification import Verifier, doubts_of_belief, doubts_of_bounds, unseen_beyond_door
from utak.planner.goals.bounds import unfelt_bounds
from utak.planner.sights.frontiers import FOVEA_RANGE, Viewpoint
from utak.planner.stages import Stage

IN_NEXT_ROOM, THROUGH_A_DOOR, AROUND_A_CORNER = facts_from_text(
    "in(utak, room(next)). through(utak, d). around(utak, corner)."
)
AT_START = replace(NO_TASK, goals=facts_from_text("at(utak, start)."))
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


def stood_in(rows: list[str], contradicted: int) -> WorldModel:
    """Return the model of a room seen whole. contradicted : how many of the last impressions disagree with it."""
    model = known_model(rows)
    here = (math.floor(model.place[0]), math.floor(model.place[1]))
    return replace(model, looked_from=frozenset({here}), contradicted=contradicted)


def squares_from(model: WorldModel, squares: np.ndarray) -> np.ndarray:
    """Return how far east and north of the robot each of some squares of the view is, (n, 2)."""
    rows, columns = np.divmod(squares, model.labels.shape[1])
    row, column = model.view.locate(*model.place)
    return np.stack([columns - column, rows - row], axis=1)


@pytest.mark.parametrize(
    ("spread", "turns", "looks", "stuck", "first"),
    [
        (math.pi, True, 2, 0, True),
        (math.pi, False, 2, 0, False),  # a pushed object stays as it lies
        (0.0, True, 2, 0, False),
        (math.pi, True, 9, 0, False),  # the robot has looked often enough
        (math.pi, False, 2, 1, True),  # it was pushed, and did not move
        (0.0, False, 2, 1, False),
    ],
)
def test_the_orientation_of_the_frame_is_looked_at_before_an_object_is_turned_or_tried_again(
    spread: float, turns: bool, looks: int, stuck: int, first: bool
) -> None:
    looked = frozenset((x, 0) for x in range(looks))
    model = replace(known_model(BESIDE_A_THING), likely_spread=spread, looked_from=looked)
    (node,) = model.objects
    situation = situation_of(model)
    sense = sensed_first(doubt_of_frame(replace(node, resisted=("north",) * stuck), turns, situation), situation)
    assert (sense is not None) == first
    if sense is not None:
        assert "how the squares of the map lie" in sense.doubt.look.what
        assert len(sense.doubt.look.squares)


@pytest.mark.parametrize("sure", [True, False])
def test_a_narrow_passage_on_an_unsure_map_is_looked_at_from_close_by(sure: bool) -> None:
    model = known_model(NARROW)
    (node,) = model.objects
    node = replace(node, polygon=shapely.box(-20, 0, -16, 4), colour="g", shape={"square": 99})
    model = replace(model, objects=(node,), view=model.view._replace(sure=sure))
    refusal = ManipulationOracle().find(Request(node, {"r": Inside(shapely.box(16, 1, 29, 15))}), situation_of(model))
    assert isinstance(refusal, Infeasibility)
    neck = refusal.neck()
    assert refusal.proved
    assert neck == pytest.approx((15, 7), abs=1.0)
    verifier = Verifier()
    looks = verifier.recheck_passage(refusal, situation_of(model))
    assert bool(looks) != sure
    if sure:
        return
    (first,) = looks
    rows, columns = np.divmod(first.squares, model.labels.shape[1])
    assert max(np.abs(columns + 0.5 - neck[0]).max(), np.abs(rows + 0.5 - neck[1]).max()) <= FOVEA_RANGE
    x, y = columns[0] + model.view.west + 0.5, rows[0] + model.view.south + 0.5
    there = situation_of(replace(model, place=(float(x), float(y))))
    assert not verifier.recheck_passage(refusal, there)
    assert not verifier.recheck_passage(refusal, situation_of(model))  # it need not be looked at again


def test_after_a_contradiction_the_robot_looks_from_elsewhere_near_by() -> None:
    assert [*doubts_of_belief((), situation_of(stood_in(BESIDE_A_THING, False)))] == []
    model = stood_in(BESIDE_A_THING, True)
    (doubt,) = doubts_of_belief((), situation_of(model))
    assert doubt.name == "differs" and doubt.must
    away = np.abs(squares_from(model, doubt.look.squares)).max(1)
    assert len(away)
    assert away.min() > 0
    assert away.max() <= FOVEA_RANGE


def test_what_was_moved_is_seen_from_close_by_again_after_a_contradiction() -> None:
    model = known_model(BESIDE_A_THING)
    (node,) = model.objects
    here, far = (math.floor(model.place[0]), math.floor(model.place[1])), (1000, 1000)
    moved = replace(model, objects=(replace(node, moved=True),), looked_from=frozenset({here, far}))
    for looked, again in (({here, far}, False), ({here}, False), ({far}, True), (set(), True)):
        situation = situation_of(replace(moved, looked_since=frozenset(looked)))
        found = [doubt.name for doubt in doubts_of_belief(situation.model.objects, situation)]
        assert found == ["again(o1)"] * again, looked
    unmoved = situation_of(replace(model, looked_from=frozenset({here})))
    assert [*doubts_of_belief([node], unmoved)] == []


@pytest.mark.parametrize("again", [False, True])
def test_what_others_may_have_moved_is_looked_at_again(again: bool) -> None:
    model = known_model(BESIDE_A_THING)
    node = replace(model.objects[0], looked_at_again=again)
    found = [*doubts_of_belief([node], situation_of(replace(model, objects=(node,))))]
    assert bool(found) == again
    assert all(f"others may have moved {node.name}" in doubt.look.what for doubt in found)


def test_what_two_goals_rest_on_and_cannot_be_seen_is_given_up_once() -> None:
    situation = situation_of(known_model(BESIDE_A_THING))
    unreached = [Doubt("again(o1)", Viewpoint(np.array([0, one]), "it"), ("claimed(again(o1))",)) for one in (1, 2)]
    decision = turn_of(Stage(()), situation).make_sure(unreached)
    assert not decision
    assert decision.verdict is None


@pytest.mark.parametrize("contradicted", [False, True])
def test_nothing_is_done_while_the_last_impression_contradicts_what_is_believed(contradicted: bool) -> None:
    model = stood_in(BESIDE_A_THING, contradicted)
    decider = Decider(AT_START)
    decision = decider.decide(model, [model.place])
    assert (decision.verdict == "done") == (not contradicted)
    if contradicted:
        assert isinstance(decision.command, Move)
        assert decision.why.startswith("what is seen differs from what is believed, near POINT (")
        assert decider.decide(replace(model, contradicted=False), [model.place]).verdict == "done"


def test_looks_that_tell_nothing_new_come_to_an_end() -> None:
    """A thing whose outline is believed otherwise than it is looks otherwise from everywhere."""
    for times in range(1, RESIDUAL_WINDOW + 1):
        model = stood_in(BESIDE_A_THING, times)
        decision = Decider(AT_START).decide(model, [model.place])
        assert (decision.verdict == "limit") == (times == RESIDUAL_WINDOW)
        assert "what is seen differs from what is believed" in decision.why


def test_a_contradiction_that_stays_from_everywhere_ends_with_limit() -> None:
    model = known_model(BESIDE_A_THING)
    rows, columns = np.nonzero(model.floor)
    everywhere = frozenset(zip((columns + model.view.west).tolist(), (rows + model.view.south).tolist(), strict=True))
    model = replace(model, contradicted=True, looked_from=everywhere)
    decision = Decider(AT_START).decide(model, [model.place])
    assert decision.command is None
    assert decision.verdict == "limit"
    assert "what is seen differs from what is believed" in decision.why


@pytest.mark.parametrize("sure", [True, False])
def test_an_object_that_is_not_seen_is_not_proved_to_be_missing(sure: bool) -> None:
    """It may stand against a wall, and look like a piece of that."""
    model = known_model(BESIDE_A_THING)
    model = replace(model, objects=(), view=model.view._replace(sure=sure))
    (goal,) = facts_from_text("in(x, room(next)).")
    unseen = Reconciliation({}, ("x",), (), ())
    transporter = Transporter()
    transporter.search = lambda *_: []
    decision = transporter.towards(goal, turn_of(Stage((goal,)), situation_of(model), None, unseen))
    assert (decision.command, decision.verdict) == (None, "impossible")
    assert "nothing seen so far is x" in decision.why
    assert "never felt" in next(open_facts(decision, situation_of(model))).words


STUB = [  # a wall between two rooms with a door in it
    "b" * 30,
    *["b" + "." * 13 + "bb" + "." * 13 + "b"] * 5,
    *["b" + "." * 28 + "b"] * 4,
    *["b" + "." * 13 + "bb" + "." * 8 + "U" + "." * 4 + "b"] * 5,
    "b" * 30,
]


def test_a_door_is_sure_when_verge_was_felt_on_both_of_its_jambs() -> None:
    """Each side of the wall may be a thing that stands against the verge, and then there is one room."""
    model, (x, y) = known_model(STUB), utak_in(STUB)
    jambs = [(15 - x, 5 - y), (15 - x, 10 - y)]  # squares of the map frame

    def is_doubtful(*felt: tuple[int, int]) -> bool:
        """Return whether the robot, in the east, may be in the same room still, with verge felt on some squares."""
        situation = situation_of(replace(model, felt=dict.fromkeys(felt, "b")))
        return any(doubts_of_bounds([IN_NEXT_ROOM], "x", (-20.0, 0.5), model.squares([(0, 0)]), situation))

    assert is_doubtful()
    assert all(is_doubtful(jamb) for jamb in jambs)
    assert not is_doubtful(*jambs)


def test_of_what_is_to_be_felt_the_nearest_is_asked_for_first() -> None:
    model = known_model(STUB)
    situation = situation_of(model)
    began, covered = (-20.0, 0.5), model.squares([(0, 0)])
    looks = [look.squares for look in unfelt_bounds(IN_NEXT_ROOM, began, covered, situation)]
    ways = [way.cost for way in map(situation.cost_maps.nearest, looks) if way is not None]
    assert len(ways) == len(looks) > 1
    assert ways == sorted(ways)
    (first,) = doubts_of_bounds([IN_NEXT_ROOM], "x", began, covered, situation)
    assert first.look.squares.tolist() == looks[0].tolist()


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


@pytest.mark.long
@pytest.mark.parametrize("goal", [IN_NEXT_ROOM, THROUGH_A_DOOR], ids=str)
def test_the_mouth_of_an_arm_is_no_door_while_squares_beyond_are_unseen(goal: Fact) -> None:
    situation = situation_of(walked(ARM, WAY).model)
    model = situation.model
    covered, began = model.squares([(24, -10), (25, -10)]), (0.5, 5.0)
    (doubt,) = doubts_of_bounds([goal], "x", began, covered, situation)
    rows, columns = np.divmod(doubt.look.squares, model.labels.shape[1])
    assert (columns + model.view.west > 16).all() and (rows + model.view.south < -4).all()
    assert not [*doubts_of_bounds([AROUND_A_CORNER], "x", began, covered, situation)]
    assert 1 in {side for door in situation.rooms.sure for side in door.sides}


def test_a_floor_that_is_seen_to_be_wide_is_another_room() -> None:
    situation = situation_of(walked(NEXT, [*WAY, (10, 2)]).model)
    covered = situation.model.squares([(24, -10), (25, -10)])
    assert [*unseen_beyond_door(IN_NEXT_ROOM, (0.5, 5.0), covered, situation)] == []
    assert situation.goal_rooms(IN_NEXT_ROOM, (0.5, 5.0), situation.rooms, MIN_DOOR_CONFIDENCE)[covered].all()
