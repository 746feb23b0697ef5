"""An open fact turns the verdict `impossible` into `possible_if`, and is named."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.kb.drawings import known_model
from tests.planner.situations import situation_of
from utak.kb.world.model import WorldModel
from utak.planner.carrying.open_facts import (
    OpenFact,
    least_that_allow,
    open_fact_against,
    open_facts,
    possible_width,
    proof_if_not_found,
)
from utak.planner.decision import impossible
from utak.planner.sights.walls import ALL_WALLS, FeelingScope, unfelt_walls
from utak.planner.situation import Situation

ROOM = ["bbbbbbb", "b.....b", "b..U..b", "b.....b", "bbbbbbb"]
WITH_A_THING = ["bbbbbbbbb", "b.......b", "b..U.gg.b", "b....gg.b", "b....gg.b", "b.......b", "bbbbbbbbb"]
GIVEN_UP = impossible("no way leads there", "no way leads there")


def felt(model: WorldModel, but: int = 0) -> WorldModel:
    """Return a model with every wall beside the floor felt, but for the first `but` squares."""
    rows, columns = np.nonzero(unfelt_walls(model))
    squares = sorted(zip((columns + model.view.west).tolist(), (rows + model.view.south).tolist(), strict=True))
    return replace(model, felt=dict.fromkeys(squares[but:], "b"))


def nearest(situation: Situation, scope: FeelingScope = ALL_WALLS) -> str:
    """Return the first open fact, in words; "" for none."""
    return next((fact.words for fact in open_facts(situation, situation.model.place_on_view, scope)), "")


def test_a_wall_that_was_never_felt_may_be_an_object() -> None:
    found = open_fact_against(GIVEN_UP, situation_of(known_model(ROOM)))
    assert found.verdict == "possible_if" and found.why.startswith("no way leads there; it may be possible if the wall")


def test_the_only_unfelt_wall_is_named() -> None:
    model = felt(known_model(ROOM), but=1)
    assert open_fact_against(GIVEN_UP, situation_of(model)).why.endswith(
        "if the wall at POINT (-3.0 -1.0), which was never felt, is a thing that can be moved"
    )


def test_nothing_is_open_where_all_is_felt_and_seen() -> None:
    assert open_fact_against(GIVEN_UP, situation_of(felt(known_model(ROOM)))).result == "idle"


def test_a_wall_felt_to_be_an_object_is_still_open() -> None:
    model = felt(known_model(ROOM))
    thing = replace(model, felt=dict.fromkeys(model.felt, "g"))
    assert open_fact_against(GIVEN_UP, situation_of(thing)).verdict == "possible_if"


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
    found = open_fact_against(replace(GIVEN_UP, unless="o1 is more than one thing"), situation_of(known_model(ROOM)))
    assert found.why == "no way leads there; it may be possible if o1 is more than one thing"


def test_the_unfelt_wall_nearest_to_the_place_of_the_verdict_is_named() -> None:
    model = known_model(ROOM)
    near = replace(GIVEN_UP, near=(5.5, 2.5))
    assert "the wall at POINT (3.0 0.0)" in open_fact_against(near, situation_of(model)).why


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


@given(st.lists(st.integers(0, 63), min_size=1, max_size=12), st.integers(1, 63))
def test_the_facts_that_are_named_allow_a_plan_and_none_of_them_can_be_left_out(bits: list[int], wanted: int) -> None:
    """A fact opens some of six squares, and a plan needs some of these."""
    facts = [OpenFact(str(n), np.array([bits[n] >> k & 1 for k in range(6)], np.bool_)) for n in range(len(bits))]

    def plan_exists(opened: np.ndarray) -> bool:
        return sum(1 << k for k in range(6) if opened[k]) & wanted == wanted

    def allow(some: list[OpenFact]) -> bool:
        return bool(some) and plan_exists(np.any([fact.opens for fact in some], axis=0))

    found = least_that_allow(facts, plan_exists)
    assert allow(found) == allow(facts)
    assert not any(allow([one for one in found if one is not left_out]) for left_out in found)


def test_a_wall_that_leads_nowhere_is_not_named() -> None:
    """What lies beyond the nearest wall does not help; a thing beside the parting wall may reach past it."""
    rows = ["b" * 24, "b......U.....bb........b", *["b............bb........b"] * 6, "b" * 24]
    situation = situation_of(known_model(rows))
    wanted = np.zeros(situation.model.labels.shape, np.bool_)
    wanted[4, 18] = True

    def plan_exists(opened: np.ndarray) -> bool:
        return situation.with_free(opened).cost_maps.nearest(np.flatnonzero(wanted)) is not None

    near = replace(GIVEN_UP, near=(0.5, 4.5))
    west, east = (open_fact_against(near, situation, plan_exists=exists).why for exists in (np.any, plan_exists))
    assert "the wall at POINT (-7.0" in west
    assert "the wall at POINT (4.0 -7.0)" in east
