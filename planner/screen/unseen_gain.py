"""How much that was never seen comes into sight from where."""

import numpy as np
from numpy.typing import NDArray

from kb.mapping.occupancy import MapView

REACH = 14  # squares from the edge of what is seen at which most of it is seen anew
BARREN = 0.1  # of a square unseen beside the verge, how much less it promises than one beside the floor
HALF = 0.5
FLOOR, WALL, NOTHING = 0, 1, 2  # what a square lies beside
Mask = NDArray[np.bool_]


def gain(view: MapView) -> NDArray[np.float64]:
    """(rows, columns): how many squares never seen come into sight there, each by what it promises."""
    seen = np.pad(view.seen, REACH)
    beside_floor = _beside(np.pad(np.where(view.probability <= HALF, FLOOR, WALL), REACH), seen) == FLOOR
    worth = np.where(seen, 0.0, np.where(beside_floor, 1.0, BARREN))
    return sums(worth, REACH)


def sums(framed: NDArray[np.float64], reach: int) -> NDArray[np.float64]:
    """(rows, columns): for each square the sum over all within so many rows and columns.

    framed : the values, with as many rows and columns more on each side.
    """
    sums = np.pad(framed, 1).cumsum(0).cumsum(1)[:-1, :-1]
    side = 2 * reach + 1
    answer: NDArray[np.float64] = sums[side:, side:] - sums[:-side, side:] - sums[side:, :-side] + sums[:-side, :-side]
    return answer


def _beside(labels: NDArray[np.int64], seen: Mask) -> NDArray[np.int8]:
    """Of each square never seen the least label of the nearest seen ones, as far as REACH rows and columns."""
    near = np.where(seen, labels, NOTHING).astype(np.int8)
    for _ in range(REACH):
        least = near.copy()
        np.minimum(least[1:], near[:-1], out=least[1:])
        np.minimum(least[:-1], near[1:], out=least[:-1])
        np.minimum(least[:, 1:], near[:, :-1], out=least[:, 1:])
        np.minimum(least[:, :-1], near[:, 1:], out=least[:, :-1])
        near = np.where(near == NOTHING, least, near)
    return near
