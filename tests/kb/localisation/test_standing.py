"""Where the robot may stand: frames, ends of motions, and looks on the map of before, by their likelihood."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from utak.kb.localisation.hypotheses.frames import OFF_CENTRE_COST, Hypothesis, Observation
from utak.kb.localisation.hypotheses.walk_outcomes import StraightMotion
from utak.kb.localisation.known.state import TrackerState
from utak.kb.localisation.standing import standing
from utak.kb.perception.frame import CENTRE, Frame

WALK = StraightMotion(1, (5.0, 0.0), (Hypothesis(0, CENTRE + CENTRE),))
RANGES = np.zeros((160, 2), np.int16)
CENTRED = (Hypothesis(0, CENTRE + CENTRE),)


def other_end(shift: float, odds: float) -> Hypothesis:
    """Return the hypothesis that the walk ended elsewhere. odds : for it, against the believed end."""
    return CENTRED[0]._replace(prior_cost=-math.log(odds), since=1, shift=(shift, 0.0))


def state(*places: tuple[float, float], **known: object) -> TrackerState:
    """Return a state after observations at some places, Utak's own frame; the last one is where the robot is."""
    observations = tuple(Observation(RANGES, place) for place in places)
    begun = TrackerState(observations=observations, hypotheses=CENTRED)
    return replace(begun, place=begun.frame.place_from_utak(*places[-1]), **known)


def test_what_is_settled_is_one_square() -> None:
    found = standing(state((0.0, 0.0), (4.0, -2.0)))
    assert (found.case, found.shares) == ("sure", {(4, -2): 1.0})


def test_a_motion_that_may_have_ended_elsewhere_shares_by_its_chance() -> None:
    known = {"motions": (WALK,), "hypotheses": (*CENTRED, other_end(-0.5, 0.01), other_end(-2.5, 0.3))}
    found = standing(state((0.0, 0.0), (5.0, 0.0), **known))
    assert found.shares == pytest.approx({(5, 0): 1.01 / 1.31, (3, 0): 0.3 / 1.31})
    assert found.case == "unsure"
    later = standing(state((0.0, 0.0), (5.0, 0.0), (5.0, 3.0), **known))
    assert later.shares == pytest.approx({(5, 3): 1.01 / 1.31, (3, 3): 0.3 / 1.31})


def test_other_ends_of_motions_that_are_no_longer_remembered_say_nothing() -> None:
    assert standing(state((0.0, 0.0), (5.0, 0.0), hypotheses=(*CENTRED, other_end(-2.5, 0.3)))).shares == {(5, 0): 1.0}


def test_an_origin_beside_the_middle_weighs_by_its_room() -> None:
    """The robot went 4.25 squares east: it is in the fourth square, or in the fifth if it woke in the east."""
    beside = Hypothesis(0, (0.75, 0.0, 1.0, 1.0))
    found = standing(state((0.0, 0.0), (4.25, 0.0), hypotheses=(*CENTRED, beside)))
    weight = math.exp(-OFF_CENTRE_COST) / 4
    assert found.shares == pytest.approx({(4, 0): 1 / (1 + weight), (5, 0): weight / (1 + weight)})


def test_an_unlikely_orientation_is_left_out() -> None:
    turned = Hypothesis(30, CENTRE + CENTRE, prior_cost=20.0)
    assert set(standing(state((0.0, 0.0), (9.0, 0.0), hypotheses=(*CENTRED, turned))).shares) == {(9, 0)}
    likelier = turned._replace(prior_cost=0.0)
    found = standing(state((0.0, 0.0), (9.0, 0.0), hypotheses=(*CENTRED, likelier))).shares
    assert found == pytest.approx({(9, 0): 0.5, (8, 5): 0.5})


@given(st.integers(-44, 45), st.floats(-9, 9), st.floats(-9, 9))
def test_a_quarter_turn_of_the_grid_is_the_same_grid(angle: int, east: float, north: float) -> None:
    frame, other = Frame(angle), Hypothesis(angle - 90 if angle > 0 else angle + 90, (0.2, 0.2, 0.3, 0.4))
    here = state((0.0, 0.0), (east, north), hypotheses=(other,), frame=frame)
    x, y = frame.to_map(east, north)
    (west, south), (far, high) = ((0.6, 0.2), (0.8, 0.3)) if angle > 0 else ((0.2, 0.7), (0.4, 0.8))
    squares = {(math.floor(x + a), math.floor(y + b)) for a in (west, far) for b in (south, high)}
    assert set(standing(replace(here, place=frame.place_from_utak(east, north))).shares) <= squares


@given(st.lists(st.floats(0, 0.49), min_size=4, max_size=4))
def test_who_was_put_somewhere_shares_what_is_left_of_squares(error: list[float]) -> None:
    west, south, east, north = (side * sign for side, sign in zip(error, (-1, -1, 1, 1), strict=True))
    found = standing(state((0.0, 0.0), (3.0, 3.0), place_error=(west, south, east, north), lifted_at=frozenset({0})))
    assert set(found.shares) == {(3, 3)}
    beside = replace(state((0.0, 0.0), lifted_at=frozenset({0})), place=(3.9, 3.5), place_error=(-0.1, 0.0, 0.3, 0.0))
    assert standing(beside).shares == pytest.approx({(3, 3): 0.5, (4, 3): 0.5})


def test_a_map_that_was_begun_anew_lies_anywhere() -> None:
    found = standing(state((0.0, 0.0), (4.0, -2.0), been=((0.0, 0.0),), unsteady=True))
    assert (found.case, found.shares) == ("anew", {(4, -2): 1.0})


def test_who_is_lost_or_slips_says_so() -> None:
    assert standing(state((0.0, 0.0), residuals=(9, 9))) == ("lost", Frame(), {})
    assert standing(state((0.0, 0.0), slipped=True)).case == "slips"
    assert standing(state((0.0, 0.0), residuals=(1,))).case == "unsure"
