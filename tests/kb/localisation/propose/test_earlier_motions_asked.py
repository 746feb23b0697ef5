"""Proposals of earlier motions: which of them are re-estimated when an observation is explained."""

import numpy as np
import pytest
import shapely

from utak.kb.body import Move
from utak.kb.localisation.hypotheses.correction import WalkCorrection
from utak.kb.localisation.hypotheses.explanation import Explanation
from utak.kb.localisation.hypotheses.frames import CENTRED_HYPOTHESES, Observation
from utak.kb.localisation.hypotheses.walk_outcomes import MotionHypothesis
from utak.kb.localisation.known.situation import ObservedSituation, with_chance
from utak.kb.localisation.known.state import TrackerState
from utak.kb.localisation.propose.earlier_motion import motions_in_question
from utak.kb.objects.held_object import HeldObject
from utak.kb.perception.frame import CENTRE, Frame

HELD = CENTRED_HYPOTHESES[0]
STUCK = Explanation("stuck", CENTRE, Frame(), 0, 0.5)


@pytest.mark.parametrize(
    ("likely", "simple", "asked"),
    [
        (0.3, STUCK, [1]),  # the push before was in doubt
        (0.01, STUCK, []),
        (0.3, STUCK._replace(how="blocked", chance=0.5), []),  # the chance of the simple explanation is known
        (0.3, STUCK._replace(how="slipped"), [1, 2]),  # nothing simple explains it: all are re-estimated
        (0.3, STUCK._replace(residual=3), [1, 2]),
    ],
)
def test_only_doubtful_motions_are_reestimated_where_something_simple_explains_an_observation(
    likely: float, simple: Explanation, asked: list[int]
) -> None:
    observations = tuple(Observation(np.zeros((160, 2), np.int16), (float(n), 0.0)) for n in range(3))
    doubts = (((0.75, 0.5), likely), ((0.0, 0.0), 0.001))
    moved = (
        MotionHypothesis(1, (1.0, 0.0), (HELD,), alternative_ends=doubts),
        MotionHypothesis(2, (1.0, 0.0), (HELD,)),
    )
    brick = HeldObject("o1", shapely.box(0, 0, 1, 1), shapely.box(0, 0, 1, 1))
    state = TrackerState(observations=observations, motions=moved, held_objects={"o1": brick})
    situation = ObservedSituation(state, Move(1.0, 0.0), observations[0].ranges, (simple,))
    assert [motion.number for motion in motions_in_question(situation)] == asked
    told = Explanation("misled", CENTRE, Frame(), 0, 0.6, None, (HELD,), WalkCorrection(1, (-0.25, 0.5)), True)
    assert with_chance(state, told).chance == likely
