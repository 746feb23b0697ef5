"""The odds that open squares are occupied: the maximum-entropy distribution with the mean counts of the fields.

They are found by iterative proportional fitting (Deming and Stephan 1940) after every impression, from the odds that
the impression before left. Most maps are made only to compare what they settle, and nobody asks for their odds: so the
fitting is put off until somebody does.
"""

from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from utak.geometry.counts.settle import remaining_counts
from utak.geometry.kernels.arrays import Floats, Ints

FITTING_ROUNDS = 6  # rounds of iterative proportional fitting after an impression; tuned
STRAY_COUNT = 0.05  # occupied squares expected under a field that shows level 0 and yet may hide one; tuned
MAX_LOGIT = 6.0  # log odds are kept within plus and minus this; convention
MIN_TARGET_SHARE, MAX_TARGET_SHARE = 0.002, 0.998  # shares of occupied squares are clipped to these; convention

Logits = NDArray[np.float32]


class Fields(NamedTuple):
    """Fields, and the states of squares when the odds were fitted to them; as geometry.counts.settle takes them."""

    state: NDArray[np.int8]  # What was settled, by flat index of the square: OPEN (-1), FREE (0) or OCCUPIED (1)
    where: Ints  # Flat indices of the squares under each field
    weight: NDArray[np.int16]  # How often each of them counts; 0 is padding
    low: NDArray[np.int16]  # The least and the greatest count of occupied squares
    high: NDArray[np.int16]


class Forgotten(NamedTuple):
    """A change of the map: nothing is known any more of some squares, given by flat indices (n,) int32."""

    squares: Ints


class Grown(NamedTuple):
    """A change of the map: numbers of rows and columns that were added, ((south, north), (west, east))."""

    widths: tuple[tuple[int, int], tuple[int, int]]


class Odds:
    """The log odds that squares are occupied, after some changes; computed when they are asked for."""

    def __init__(self, logit: Logits, changes: tuple[Fields | Forgotten | Grown, ...] = ()) -> None:
        """Begin with nothing computed; `logit` is not changed."""
        self._before, self._changes = logit, changes

    def after(self, change: Fields | Forgotten | Grown) -> "Odds":
        """Return the log odds after one more change, to be computed when they are asked for; these stay as they are."""
        if "logit" in self.__dict__:
            return Odds(self.logit, (change,))
        return Odds(self._before, (*self._changes, change))

    @cached_property
    def logit(self) -> Logits:
        """The log odds (natural logarithm), (rows, columns) float32, within -6 to 6; 0 where nothing was seen."""
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
    """Fit the odds of open squares to the mean counts of the fields, in place."""
    where, weights = fields.where, fields.weight
    open_, weight, low, high = remaining_counts(*fields)
    if not open_.any():
        return
    under, entry = where[open_], np.nonzero(open_)[0]
    squares, column = np.unique(under, return_inverse=True)
    times = np.maximum(np.bincount(column, minlength=len(squares)), 1)
    logit = logits.ravel()[squares].astype(np.float64)
    middle = 0.5 * (low + high).astype(np.float64)
    middle = np.where((fields.low == 0) & (fields.high == 1), np.minimum(middle, STRAY_COUNT), middle)
    target = _logit(middle[entry] / np.maximum(weight, 1)[entry])
    share = weights[open_] / np.maximum(weight, 1)[entry]
    for _ in range(FITTING_ROUNDS):
        p = 1.0 / (1.0 + np.exp(-logit))
        mean = np.bincount(entry, p[column] * share, minlength=len(weight)).astype(np.float64)[entry]
        logit += np.bincount(column, target - _logit(mean), minlength=len(squares)) / times
        np.clip(logit, -MAX_LOGIT, MAX_LOGIT, out=logit)
    logits.ravel()[squares] = logit


def _logit(p: Floats) -> Floats:
    """Return the log odds (natural logarithm) of probabilities, clipped to 0.002 and 0.998; an array like `p`."""
    p = np.clip(p, MIN_TARGET_SHARE, MAX_TARGET_SHARE)
    answer: Floats = np.log(p / (1 - p))
    return answer
