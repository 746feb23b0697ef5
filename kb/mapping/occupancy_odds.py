"""How likely open squares are occupied: the maximum-entropy distribution with the fields' mean counts.

It is found by iterative proportional fitting after every look, from where the look before left it. Most maps are made
to be compared in what they settle, and nobody asks them for odds: so the fitting is put off until somebody does.
"""

from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from geometry.counts.settle import residue

FITTING_ROUNDS = 6
STRAY = 0.05  # occupied squares expected under a field that shows level 0 and yet may hide one
LARGEST_LOGIT = 6.0

Logits = NDArray[np.float32]
Squares = NDArray[np.int32]


class Fields(NamedTuple):
    """Fields and what was settled when they were fitted to: as for geometry.counts.settle."""

    state: NDArray[np.int8]
    where: Squares
    weight: NDArray[np.int16]
    low: NDArray[np.int16]
    high: NDArray[np.int16]


class Forgotten(NamedTuple):
    """That nothing is known any more of some squares (flat)."""

    squares: Squares


class Grown(NamedTuple):
    """That the map grew by so many rows and columns before and after those it had."""

    widths: tuple[tuple[int, int], tuple[int, int]]


class Odds:
    """Log odds that squares are occupied, as some changes leave them that are worked out when they are asked for."""

    def __init__(self, logit: Logits, changes: tuple[Fields | Forgotten | Grown, ...] = ()) -> None:
        self._before, self._changes = logit, changes

    def after(self, change: Fields | Forgotten | Grown) -> "Odds":
        """The odds after one more change."""
        if "logit" in self.__dict__:
            return Odds(self.logit, (change,))
        return Odds(self._before, (*self._changes, change))

    @cached_property
    def logit(self) -> Logits:
        """(rows, columns): 0 where nothing was seen."""
        logit = self._before.copy()
        for change in self._changes:
            if isinstance(change, Grown):
                logit = np.pad(logit, change.widths)
            elif isinstance(change, Forgotten):
                logit.ravel()[change.squares] = 0.0
            else:
                _fit(logit, change)
        return logit


def _fit(logits: Logits, fields: Fields) -> None:
    """Fit the open squares' odds to the fields' mean counts."""
    where, weights = fields.where, fields.weight
    open_, weight, low, high = residue(*fields)
    if not open_.any():
        return
    under, entry = where[open_], np.nonzero(open_)[0]
    squares, column = np.unique(under, return_inverse=True)
    times = np.maximum(np.bincount(column, minlength=len(squares)), 1)
    logit = logits.ravel()[squares].astype(np.float64)
    middle = 0.5 * (low + high).astype(np.float64)
    middle = np.where((fields.low == 0) & (fields.high == 1), np.minimum(middle, STRAY), middle)
    target = _logit(middle[entry] / np.maximum(weight, 1)[entry])
    share = weights[open_] / np.maximum(weight, 1)[entry]
    for _ in range(FITTING_ROUNDS):
        p = 1.0 / (1.0 + np.exp(-logit))
        mean = np.bincount(entry, p[column] * share, minlength=len(weight)).astype(np.float64)[entry]
        logit += np.bincount(column, target - _logit(mean), minlength=len(squares)) / times
        np.clip(logit, -LARGEST_LOGIT, LARGEST_LOGIT, out=logit)
    logits.ravel()[squares] = logit


def _logit(p: NDArray[np.float64]) -> NDArray[np.float64]:
    p = np.clip(p, 0.002, 0.998)
    answer: NDArray[np.float64] = np.log(p / (1 - p))
    return answer
