"""What an impression is explained by: where it was received, on which lattice, and what that means for all else."""

import math
import statistics
from collections.abc import Iterable, Sequence
from enum import StrEnum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kb.localisation.hypotheses.carry_outcomes import Outcome
from kb.localisation.hypotheses.frames import FrameHypothesis, Observation
from kb.localisation.hypotheses.walk_outcomes import ReestimatedWalk
from kb.mapping.occupancy import OPEN, OccupancyMap
from kb.objects.held_object import HeldObject, Square
from kb.perception.frame import CENTRE, Frame, Samples
from kb.perception.retina import FIELDS
from kb.reasoning.solver import KB, solve

NAT = 2  # prices of accommodation.lp that make something less likely by a factor of e
LEAST_CHANCE = 1e-9
Place = tuple[float, float]


class CellStatus(StrEnum):
    """How a cell of the impression is accounted for."""

    PREDICTED = "predicted"
    EXPLAINED = "explained"
    NOISE = "noise"


class Explanation(NamedTuple):
    """A pose that may have given rise to the impression. place: a point of that lattice.

    outcome: what it means for the load in hand; None when nothing was to be moved with him. hypotheses: what is left
    if the lattice lies otherwise than believed. retold: which looks were received elsewhere than is believed, if any.
    chance: how likely the motion ended so by what was known before it; None when that was not asked. crooked: by how
    much the simplest picture of the table costs more than where it is plainest
    (kb.localisation.hypotheses.map_prior). against: the open
    squares one of which stopped it. weighed: does crooked tell as well how likely he woke where he did then? larger:
    the load before the motion, if more of it was there than was seen.
    """

    how: str
    place: Place
    frame: Frame
    misfits: int
    distance: float
    outcome: Outcome | None = None
    hypotheses: tuple[FrameHypothesis, ...] = ()
    retold: ReestimatedWalk | None = None
    chance: float | None = None
    crooked: float = 0.0
    against: frozenset[Square] = frozenset()
    weighed: bool = False
    larger: HeldObject | None = None

    @property
    def anew(self) -> bool:
        """Does it say that the lattice lies otherwise, or that looks were received elsewhere, than was believed?"""
        return self.how in ("turned", "misled", "lost", "anew")

    @property
    def met(self) -> bool:
        """Does it say that an earlier motion was stopped by something that is known by now?"""
        return self.retold is not None and self.retold.known

    @property
    def odd(self) -> bool:
        """Does it say both that the lattice lies askew and that he did not wake amid his square, and weighs neither?"""
        return self.frame.angle != 0 and self.frame.origin != CENTRE and not self.weighed


class Accommodated(NamedTuple):
    """What one impression led to. cells: a CellStatus for each of the 160 fields."""

    explanation: Explanation
    cells: tuple[CellStatus, ...]


def statuses(
    occupancy: OccupancyMap, samples: Samples, ranges: NDArray[np.int16], x: int, y: int
) -> tuple[CellStatus, ...]:
    """How each field of a look from square (x, y) is accounted for, before it is taken in as evidence."""
    noise = occupancy.misfits(samples, ranges, x, y)
    row, column = occupancy.index(x, y)
    state = occupancy.state[samples.rows + row, samples.columns + column]
    new = ((state == OPEN) & (samples.weight > 0)).any(1)
    return tuple(
        CellStatus.NOISE if noise[i] else CellStatus.EXPLAINED if new[i] else CellStatus.PREDICTED
        for i in range(len(FIELDS))
    )


def misled(observation: Observation, told: Iterable[Iterable[ReestimatedWalk]]) -> list[Explanation]:
    """The lattices to believe instead on which one of some motions was stopped, or an earlier one was not.

    look : the new one, as predicted. told : of each motion what else may have come of it.
    """
    found = [one for motion in told for one in motion]
    if not found:
        return []
    left = tuple(dict.fromkeys(one.hypothesis for one in found))
    middle = statistics.median(hypothesis.angle for hypothesis in left)
    ordered = sorted(found, key=lambda one: (not one.known, abs(one.hypothesis.angle - middle)))
    return [told_again(one, left) for one in ordered]


def told_again(one: ReestimatedWalk, left: tuple[FrameHypothesis, ...]) -> Explanation:
    """What came of a motion as it was told again. left : how the lattice may lie then."""
    frame, far = one.hypothesis.frame, math.hypot(*one.correction.shift)
    place = frame.place_from_utak(*one.newest)
    return Explanation("misled", place, frame, one.misfits, far, None, left, one)


def cheapest(explanations: Sequence[Explanation], facts: Sequence[str]) -> Explanation:
    """The explanation to believe (kb/asp/accommodation.lp). facts : of what else bears on the choice."""
    offered = [
        f"explanation({number},{e.how},{e.misfits},{math.ceil(e.distance)})" for number, e in enumerate(explanations)
    ]
    offered += [f"odd({number})" for number, e in enumerate(explanations) if e.odd]
    for number, e in enumerate(explanations):
        offered += [f"crooked({number},{round(NAT * e.crooked)})"] * (e.crooked > 0)
        if e.chance is not None:
            offered.append(f"unlikely({number},{round(-NAT * math.log(max(e.chance, LEAST_CHANCE)))})")
    answer = solve([KB / "accommodation.lp"], [*offered, *facts])
    if not answer:
        raise AssertionError("accommodation.lp always has an answer")
    return explanations[answer[0].arguments[0].number]
