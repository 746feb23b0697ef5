"""Expected information gain: how many squares that were never seen come into sight from each square.

An unseen square counts fully when the nearest seen squares include floor: there the floor likely goes on. It counts
VERGE_WEIGHT when they are occupied only. The counts within the reach of the eye are added up with a summed-area table
(Crow 1984).
"""

import numpy as np
from numpy.typing import NDArray

from utak.geometry.counts.retina import RETINA_REACH
from utak.geometry.kernels.arrays import Bools, Floats, Longs
from utak.kb.mapping.occupancy import MapView

# Squares, in rows and columns, within which an unseen square comes into sight: a little below the retina's reach
GAIN_REACH = RETINA_REACH - 2
VERGE_WEIGHT = 0.1  # the weight of an unseen square beside the verge, where one beside floor counts 1 (tuned)
OCCUPIED_THRESHOLD = 0.5  # a seen square with at most this probability of being occupied counts as floor here
BESIDE_FLOOR, BESIDE_WALL, BESIDE_NOTHING = 0, 1, 2  # labels of squares by what is nearest; the least one wins


def expected_gain(view: MapView) -> Floats:
    """Compute the expected information gain of looking from each square, (rows, columns) float64."""
    seen = np.pad(view.seen, GAIN_REACH)
    labels = np.pad(np.where(view.probability <= OCCUPIED_THRESHOLD, BESIDE_FLOOR, BESIDE_WALL), GAIN_REACH)
    beside_floor = _nearest_label(labels, seen) == BESIDE_FLOOR
    weight = np.where(seen, 0.0, np.where(beside_floor, 1.0, VERGE_WEIGHT))
    return window_sums(weight, GAIN_REACH)


def window_sums(padded: Floats, reach: int) -> Floats:
    """Compute for each square the sum of the values within `reach` rows and columns of it, itself included."""
    table = np.pad(padded, 1).cumsum(0).cumsum(1)[:-1, :-1]
    side = 2 * reach + 1
    sums: Floats = table[side:, side:] - table[:-side, side:] - table[side:, :-side] + table[:-side, :-side]
    return sums


def _nearest_label(labels: Longs, seen: Bools) -> NDArray[np.int8]:
    """Give each unseen square within GAIN_REACH steps the least label of the nearest seen squares."""
    near = np.where(seen, labels, BESIDE_NOTHING).astype(np.int8)
    for _ in range(GAIN_REACH):
        least = near.copy()
        np.minimum(least[1:], near[:-1], out=least[1:])
        np.minimum(least[:-1], near[1:], out=least[:-1])
        np.minimum(least[:, 1:], near[:, :-1], out=least[:, 1:])
        np.minimum(least[:, :-1], near[:, 1:], out=least[:, :-1])
        near = np.where(near == BESIDE_NOTHING, least, near)
    return near
