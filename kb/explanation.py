"""What an impression is explained by: where it was received, on which lattice, and what that means for all else."""

import math
from collections.abc import Sequence
from enum import StrEnum
from typing import NamedTuple

from kb.encodings import KB, solve
from kb.hauling import Outcome
from kb.heading import Hypothesis
from kb.lattice import Lattice
from kb.stops import Retold

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
    """

    how: str
    place: Place
    lattice: Lattice
    misfits: int
    distance: float
    outcome: Outcome | None = None
    hypotheses: tuple[Hypothesis, ...] = ()
    retold: Retold | None = None

    @property
    def anew(self) -> bool:
        """Does it say that the lattice lies otherwise, or that looks were received elsewhere, than was believed?"""
        return self.how in ("turned", "misled", "lost")


class Accommodated(NamedTuple):
    """What one impression led to. cells: a CellStatus for each of the 160 fields."""

    explanation: Explanation
    cells: tuple[CellStatus, ...]


def cheapest(explanations: Sequence[Explanation], facts: Sequence[str]) -> Explanation:
    """The explanation to believe (kb/asp/accommodation.lp). facts : of what else bears on the choice."""
    offered = [
        f"explanation({number},{e.how},{e.misfits},{math.ceil(e.distance)})" for number, e in enumerate(explanations)
    ]
    answer = solve([KB / "accommodation.lp"], [*offered, *facts])
    if not answer:
        raise AssertionError("accommodation.lp always has an answer")
    return explanations[answer[0].arguments[0].number]
