"""Proposals of earlier motions: which of them are re-estimated when an observation is explained."""

from collections.abc import Sequence
from typing import cast

import numpy as np
import pytest

from utak.kb.localisation.hypotheses.explanation import Explanation
from utak.kb.localisation.hypotheses.frames import CENTRED_HYPOTHESES, Observation
from utak.kb.localisation.hypotheses.reestimation import ReestimatedWalk, WalkCorrection
from utak.kb.localisation.hypotheses.walk_outcomes import MotionHypothesis
from utak.kb.localisation.hypotheses.what_if import Surprise, WhatIf
from utak.kb.localisation.propose.earlier_motion import ReestimatedMotion
from utak.kb.localisation.score import SearchBudget, propose_earlier_motions
from utak.kb.localisation.state import TrackerState
from utak.kb.perception.frame import CENTRE, Frame

HELD = CENTRED_HYPOTHESES[0]
STUCK = Explanation("stuck", CENTRE, Frame(), 0, 0.5)
NO_SURPRISE = cast(Surprise, None)


@pytest.mark.parametrize(
    ("likely", "simple", "asked"),
    [
        (0.3, STUCK, [1]),  # the push before was in doubt
        (0.01, STUCK, []),
        (0.3, STUCK._replace(how="blocked", chance=0.5), None),  # the chance of the simple explanation is known
        (0.3, STUCK._replace(how="slipped"), [1, 2]),  # nothing simple explains it: all are re-estimated
        (0.3, STUCK._replace(residual=3), [1, 2]),
    ],
)
def test_only_doubtful_motions_are_reestimated_where_something_simple_explains_an_observation(
    likely: float, simple: Explanation, asked: list[int] | None
) -> None:
    observations = tuple(Observation(np.zeros((160, 2), np.int16), (float(n), 0.0)) for n in range(3))
    doubts = (((0.75, 0.5), likely), ((0.0, 0.0), 0.001))
    moved = (
        MotionHypothesis(1, (1.0, 0.0), (HELD,), alternative_ends=doubts),
        MotionHypothesis(2, (1.0, 0.0), (HELD,)),
    )
    told = ReestimatedMotion(
        ReestimatedWalk(HELD, WalkCorrection(1, (-0.25, 0.5)), True, 0),
        WhatIf(Frame(), (HELD,), CENTRE, None, 0, False),
    )
    calls: list[list[int]] = []

    def reestimate(_: Surprise, motions: Sequence[MotionHypothesis]) -> list[ReestimatedMotion]:
        calls.append([motion.number for motion in motions])
        return [told] * bool(motions)

    state, budget = TrackerState(observations=observations, motions=moved), SearchBudget(0)
    found = propose_earlier_motions(state, NO_SURPRISE, [simple], budget, reestimate)
    assert calls == ([] if asked is None else [asked])
    assert len(found) == bool(asked)
    for one in found:
        assert (one.how, one.chance, one.reestimated) == ("misled", likely, told.walk)
