"""An open fact turns the verdict `impossible` into `possible_if`, and is named."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.kb.drawings import known_model
from tests.planner.situations import situation_of
from utak.kb.explanation.proof import explain_decision
from utak.kb.explanation.values import ProofNode
from utak.kb.tracing.decisions import record_decisions
from utak.kb.world.model import WorldModel
from utak.planner.agenda.choice import Activity, Agenda
from utak.planner.carrying.infeasibility import possible_width
from utak.planner.carrying.open_facts import (
    OpenFact,
    OpenQuestion,
    PlanExists,
    open_facts,
    proof_if_not_found,
)
from utak.planner.decision import Decision, impossible
from utak.planner.question import Question
from utak.planner.sights.walls import ALL_WALLS, FeelingScope, unfelt_walls
from utak.planner.situation import Situation

ROOM = ["bbbbbbb", "b.....b", "b..U..b", "b.....b", "bbbbbbb"]
WITH_A_THING = ["bbbbbbbbb", "b.......b", "b..U.gg.b", "b....gg.b", "b....gg.b", "b.......b", "bbbbbbbbb"]
GIVEN_UP = impossible("no way leads there", "no way leads there")
STUCK = (
    "own_goals",
    "came_to(errand,idle)",
    "came_to(go,impossible)",
    "came_to(settle,idle)",
    "came_to(blame(robot),idle)",
)


def felt(model: WorldModel, but: int = 0) -> WorldModel:
    """Return a model with every wall beside the floor felt, but for the first `but` squares."""
    rows, columns = np.nonzero(unfelt_walls(model))
    squares = sorted(zip((columns + model.view.west).tolist(), (rows + model.view.south).tolist(), strict=True))
    return replace(model, felt=dict.fromkeys(squares[but:], "b"))


def nearest(situation: Situation, scope: FeelingScope = ALL_WALLS) -> str:
    """Return the first open fact, in words; "" for none."""
    return next((fact.words for fact in open_facts(GIVEN_UP, situation, scope)), "")


def ruled(question: OpenQuestion) -> tuple[str, tuple[str, ...]]:
    """Return the verdict of the agenda on what the robot is stuck with, and the names of the open facts it rests on."""
    agenda = Agenda(Question(facts=tuple(STUCK)))
    agenda.ask(Activity("doubt", "robot"), question)
    while isinstance(found := agenda.next(), Activity):
        assert found == Activity("suppose")
        agenda.learn(question.answer(agenda.named))
    agenda.question.recorded()
    return str(found.verdict), agenda.named


def told(decision: Decision, situation: Situation, plan_exists: PlanExists = np.any) -> str:
    """Return the verdict on what was given up, and the open facts that it rests on, in words."""
    question = OpenQuestion(open_facts(decision, situation), plan_exists)
    verdict, named = ruled(question)
    return f"{verdict}: {question.in_words(named)}"


def test_a_wall_that_was_never_felt_may_be_an_object() -> None:
    assert told(GIVEN_UP, situation_of(known_model(ROOM))).startswith("possible_if: the wall")


def test_the_only_unfelt_wall_is_named() -> None:
    model = felt(known_model(ROOM), but=1)
    assert told(GIVEN_UP, situation_of(model)).endswith(
        "the wall at POINT (-3.0 -1.0), which was never felt, is a thing that can be moved"
    )


def test_nothing_is_open_where_all_is_felt_and_seen() -> None:
    assert told(GIVEN_UP, situation_of(felt(known_model(ROOM)))) == "impossible: "


def test_a_wall_felt_to_be_an_object_is_still_open() -> None:
    model = felt(known_model(ROOM))
    thing = replace(model, felt=dict.fromkeys(model.felt, "g"))
    assert "possible_if" in told(GIVEN_UP, situation_of(thing))


def test_the_floor_may_go_on_where_nothing_was_seen() -> None:
    model = felt(known_model([*ROOM[:2], "b..U..?", *ROOM[3:]]))
    assert nearest(situation_of(model)) == "the floor goes on at POINT (3.0 0.0), which was never seen"


def test_an_object_that_was_never_moved_may_be_several() -> None:
    model = felt(known_model(WITH_A_THING))
    (node,) = model.objects
    assert nearest(situation_of(model)) == f"{node.name}, which was never moved, is more than one thing"
    moved = situation_of(replace(model, objects=(replace(node, moved=True),)))
    assert "which was not seen to move as one thing" in nearest(moved)
    whole = situation_of(replace(model, objects=(replace(node, moved=True, whole=True),)))
    assert nearest(whole) == ""


def test_an_object_with_reached_floor_all_around_leads_a_walking_robot_nowhere() -> None:
    situation = situation_of(felt(known_model(WITH_A_THING)))
    assert "more than one thing" in nearest(situation)
    assert nearest(situation, FeelingScope(parting=False, things=False)) == ""
    assert "more than one thing" in nearest(situation, FeelingScope(parting=False))


def test_an_open_fact_that_the_decision_names_comes_first() -> None:
    stated = replace(GIVEN_UP, unless="o1 is more than one thing")
    assert told(stated, situation_of(known_model(ROOM))) == "possible_if: o1 is more than one thing"


def test_the_unfelt_wall_nearest_to_the_place_of_the_verdict_is_named() -> None:
    model = known_model(ROOM)
    near = replace(GIVEN_UP, near=(5.5, 2.5))
    assert "the wall at POINT (3.0 0.0)" in told(near, situation_of(model))


def test_a_passage_may_be_wider_by_the_squares_of_both_its_walls() -> None:
    upright, askew = ((3.0, 1.0), (3.0, 4.0)), ((0.0, 0.0), (2.0, 2.0))
    said = possible_width(3.0, 1.9, upright, "HERE")
    assert said == "the passage at HERE, which is between 3.00 and 5.00 squares wide, is wide enough"
    assert possible_width(3.0, 2.0, upright, "HERE") == ""
    assert "between 2.83 and 5.66 squares" in possible_width(8**0.5, 2.7, askew, "HERE")
    assert possible_width(8**0.5, 2.9, askew, "HERE") == ""


@pytest.mark.parametrize(
    ("shaken", "sure", "immovable", "proved"),
    [
        (False, True, False, True),
        (True, True, False, False),  # it may have been seen and lost
        (False, True, True, True),
        (False, False, True, False),  # another object may have been pushed
    ],
)
def test_a_missing_object_proves_nothing_while_the_map_is_in_doubt(
    shaken: bool, sure: bool, immovable: bool, proved: bool
) -> None:
    model = known_model(ROOM)
    model = replace(model, shaken=shaken, view=model.view._replace(sure=sure))
    assert bool(proof_if_not_found(model, immovable)) == proved


def test_floor_that_is_seen_beyond_felt_walls_is_reached_by_an_opening_that_fills_no_square() -> None:
    """A wall that covers two rows of squares in part leaves up to two squares between them, and nothing shows it."""
    two = ["b" * 20, *["b" + "." * 8 + "bb" + "." * 8 + "b"] * 7, "b...U....bb........b", "b" * 20]
    one = [*two[:4], "b" + "." * 18 + "b", *two[5:]]
    own = FeelingScope(parting=False, things=False)

    def fact(rows: list[str]) -> str:
        """Return the open fact that is named in a drawing with all walls felt."""
        situation = situation_of(felt(known_model(rows)))
        return nearest(situation, own)

    assert "a passage that fills no whole square leads to the floor" in fact(two)
    assert fact(one) == ""


LIKELIEST_FIRST = ("wall", "unseen", "passage")
FAMILIES = st.lists(
    st.tuples(st.integers(0, 63), st.sampled_from(LIKELIEST_FIRST), st.integers(1, 9)), min_size=1, max_size=7
)


@settings(deadline=None)
@given(FAMILIES, st.lists(st.integers(1, 63), min_size=1, max_size=3), st.booleans())
def test_no_fewer_open_facts_allow_a_plan_and_none_that_are_likelier_or_nearer(
    family: list[tuple[int, str, int]], plans: list[int], parts: bool
) -> None:
    """A fact frees some of six squares, and each of several plans needs some of these."""

    def plan_exists(opened: np.ndarray) -> bool:
        squares = sum(1 << k for k in range(6) if opened[k])
        return any(squares & plan == plan for plan in plans)

    facts = [
        OpenFact(kind, "", np.array([bits >> k & 1 for k in range(6)], np.bool_), far) for bits, kind, far in family
    ]
    question = OpenQuestion([*facts, *([OpenFact("parts", "")] if parts else [])], plan_exists)
    sets = [some for size in range(1, len(facts) + 1) for some in combinations(range(len(facts)), size)]
    enough = [some for some in sets if plan_exists(np.any([facts[n].opens for n in some], axis=0))]

    def price(some: Sequence[int]) -> tuple[int, int, int]:
        """Return how many facts some are, how unlikely their kinds are, and how far off they are."""
        return (
            len(some),
            sum(LIKELIEST_FIRST.index(facts[n].kind) for n in some),
            sum(round(10 * facts[n].far) for n in some),
        )

    verdict, named = ruled(question)
    if enough:
        chosen = [int(name[1:]) - 1 for name in named]
        assert verdict == "possible_if" and tuple(sorted(chosen)) in enough
        assert price(chosen) == min(map(price, enough))
    elif parts:
        assert (verdict, named) == ("possible_if", (f"f{len(facts) + 1}",))
    else:
        assert (verdict, named) == ("limit", ())


def claims_below(node: ProofNode) -> set[str]:
    """Return the claims of a proof."""
    return {node.claim}.union(*map(claims_below, node.children))


def test_open_facts_and_what_geometry_answered_are_premises_of_the_verdict() -> None:
    masks = [np.array(mask, np.bool_) for mask in ([1, 0], [0, 1])]
    walls = [OpenFact("wall", "", mask, far) for far, mask in enumerate(masks, 1)]
    with record_decisions() as record:
        assert ruled(OpenQuestion(walls, lambda opened: bool(opened[1]))) == ("possible_if", ("f2",))
    proof = explain_decision("deciding", record[-1].facts, record[-1].answer, "verdict(possible_if)").root
    premises = {
        "open_fact(f2,wall,20)",
        "left_out(a2,f2)",
        "refutes(a2)",
        "plan_with(f2)",
        "stuck(robot,impossible)",
        "helpless",
    }
    assert premises <= claims_below(proof)


def test_a_wall_that_leads_nowhere_is_not_named() -> None:
    """What lies beyond the nearest wall does not help; a thing beside the parting wall may reach past it."""
    rows = ["b" * 24, "b......U.....bb........b", *["b............bb........b"] * 6, "b" * 24]
    situation = situation_of(known_model(rows))
    wanted = np.zeros(situation.model.labels.shape, np.bool_)
    wanted[4, 18] = True

    def plan_exists(opened: np.ndarray) -> bool:
        return situation.with_free(opened).cost_maps.nearest(np.flatnonzero(wanted)) is not None

    near = replace(GIVEN_UP, near=(0.5, 4.5))
    west, east = (told(near, situation, exists) for exists in (np.any, plan_exists))
    assert "the wall at POINT (-7.0" in west
    assert "the wall at POINT (4.0 -7.0)" in east
