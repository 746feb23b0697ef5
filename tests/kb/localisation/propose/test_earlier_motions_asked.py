"""Proposals of earlier motions: which ends of them are asked when an observation is explained, and which are left."""

import math

import numpy as np
import pytest
import shapely

from utak.kb.body import Move
from utak.kb.localisation.field_account import FIELD_AREAS
from utak.kb.localisation.hypotheses.correction import WalkCorrection
from utak.kb.localisation.hypotheses.explanation import Explanation
from utak.kb.localisation.hypotheses.frames import CENTRED_HYPOTHESES, Observation
from utak.kb.localisation.hypotheses.walk_outcomes import StraightMotion
from utak.kb.localisation.known.situation import ObservedSituation
from utak.kb.localisation.known.state import TrackerState
from utak.kb.localisation.propose.earlier_motion import ends_left, propose
from utak.kb.objects.held_object import HeldObject
from utak.kb.perception.frame import CENTRE, Frame

CENTRED = CENTRED_HYPOTHESES[0]
EARLIER = CENTRED._replace(prior_cost=1.0, since=1, shift=(-0.5, 0.0))  # the first walk ended half a square early
STUCK = Explanation("stuck", CENTRE, Frame(), 0, 0.5)
NOTHING_TOLD = np.stack([np.zeros(160, np.int16), FIELD_AREAS.astype(np.int16)], 1)


def situation(*found: Explanation, kept: bool = True) -> ObservedSituation:
    """Return the situation after two walks east of one square each, and a third one; nothing was seen on the way."""
    observations = tuple(Observation(NOTHING_TOLD, (float(n), 0.0)) for n in range(3))
    walks = tuple(StraightMotion(n, (1.0, 0.0), (CENTRED,)) for n in (1, 2))
    brick = HeldObject("o1", shapely.box(6, 6, 7, 7), shapely.box(6, 6, 7, 7))
    state = TrackerState(
        place=(2.5, 0.5),
        observations=observations,
        hypotheses=(CENTRED, EARLIER) if kept else (CENTRED,),
        motions=walks,
        held_objects={"o1": brick},
    )
    return ObservedSituation(state, Move(1.0, 0.0), NOTHING_TOLD, found)


@pytest.mark.parametrize(
    ("kept", "simple", "asked"),
    [
        (True, STUCK, {1}),
        (False, STUCK, set()),
        (True, STUCK._replace(how="blocked", chance=0.5), set()),  # the chance of the simple explanation is known
        (True, STUCK._replace(how="slipped"), {1, 2}),  # nothing simple explains it: all are re-estimated
        (True, STUCK._replace(residual=3), {1, 2}),
    ],
)
def test_only_kept_ends_are_asked_where_something_simple_explains_an_observation(
    kept: bool, simple: Explanation, asked: set[int]
) -> None:
    found = [(one, one.correction) for one in propose(situation(simple, kept=kept))]
    assert {correction.since for _, correction in found if correction} == asked
    for one, correction in found:
        likely = correction is not None and correction.since == 1 and abs(correction.shift[0] + 0.5) < 1e-5
        assert one.chance == (math.exp(-EARLIER.prior_cost) if kept and likely else None)


def test_another_end_of_a_motion_is_left_until_a_look_contradicts_it() -> None:
    went = Explanation("predicted", (3.5, 0.5), Frame(), 0, 0.0)
    assert ends_left(situation(), went) == [EARLIER]
    assert ends_left(situation(), went._replace(correction=WalkCorrection(1, (-1.0, 0.0)))) == []
    walled_in = Observation(np.repeat(NOTHING_TOLD[:, 1:], 2, 1), (2.0, 0.0))
    observations = (*situation().state.observations[:2], walled_in)
    assert ends_left(situation().supposing(observations=observations), went) == []
    stopped = went._replace(how="blocked")  # who was stopped may have ended beside that, too
    assert ends_left(situation().supposing(observations=observations), stopped) == [EARLIER]
