"""What stands where squares are not settled: pictures that agree with all counts, and what they have in common.

Counts that settle no single square may yet tell that something as wide as long stands apart from the wall. Geometry
draws simple pictures that agree with the counts (geometry.sketch); how many of them show a thing of some shape at a
place is how likely one is there.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from geometry.sketch import DRAWN, FREE, FULL, UNSEEN, Blobs, blobs, pictures
from kb.evidence import OPEN, STRAY, MapView
from kb.lattice import Lattice

CHAINS, EACH = 4, 2  # chains of pictures, pictures taken of each
WARMING, AGAIN = 30, 12  # sweeps before the first picture: of a new map, of one that was pictured before
HALF = 0.5
SMALLEST = 4  # squares of a thing that is worth a look
LOOSE = (0.012, 0.03)  # how much wider than a rectangle a part may be spread: at least, and if it is one square wide
TIGHT = (0.003, 0.15)  # how much less: corners seen rounded, but less than a disc's; likewise, by its squares
EVEN = (0.12, 0.4)  # likewise how much longer than wide a square may seem, by the squares that it covers
DEEP = 2  # squares: within what is full or empty so far from its edge nothing is pictured
SURELY = 0.93  # under a field that shows the last gray level and yet may miss a square
DISC = 1 / (2 * math.pi)
OTHERS = 0.04  # by so much and more is the spread of what is neither wider than a rectangle's
Floats = NDArray[np.float64]


class Imagined(NamedTuple):
    """Pictures of the map as it may be.

    ground : (rows, columns) int8, what is given (geometry.sketch). drawn : (pictures, rows, columns) int8, 1 where
    occupied.
    """

    ground: NDArray[np.int8]
    drawn: NDArray[np.int8]

    def probability(self, by_counts: NDArray[np.float32]) -> NDArray[np.float32]:
        """(rows, columns): that a square is occupied, with what counts alone say for one more picture."""
        shares = (self.drawn.sum(0, dtype=np.float32) + by_counts) / np.float32(len(self.drawn) + 1)
        answer: NDArray[np.float32] = np.where(self.ground == DRAWN, shares, by_counts)
        return answer

    def likely(self, shape: str) -> Floats:
        """(rows, columns): how likely each square belongs to an isolated thing of a shape."""
        heat = np.zeros(self.ground.shape)
        for image in self.drawn:
            found = blobs(image, self.ground)
            like = likeness(found, shape) * found.apart * (found.area >= SMALLEST)
            heat += np.append(0.0, like)[found.labels]
        return heat / len(self.drawn)


NOTHING_IMAGINED = Imagined(np.zeros((0, 0), np.int8), np.zeros((0, 0, 0), np.int8))


class Imagination:
    """Pictures the unsettled part of the map, and remembers the last pictures to begin the next ones with."""

    def __init__(self) -> None:
        self._lattice: Lattice | None = None
        self._corner = (0, 0)
        self._last = np.zeros((CHAINS, 0, 0), np.int8)

    def imagine(self, view: MapView, lattice: Lattice) -> Imagined:
        """Pictures of a map, from chains of chances that know nothing of each other."""
        ground, known = _ground(view), lattice == self._lattice
        warming, hot = (AGAIN, 1.0) if known else (WARMING, HALF)
        drawn = np.concatenate(
            [
                pictures(ground, view.counts, self._first(chain, view, known), EACH, warming, hot, chain)
                for chain in range(CHAINS)
            ]
        )
        self._lattice, self._corner, self._last = lattice, (view.west, view.south), drawn[EACH - 1 :: EACH]
        return Imagined(ground, drawn)

    def _first(self, chain: int, view: MapView, known: bool) -> NDArray[np.int8]:
        """The picture to begin with: the last one where most of it was pictured before."""
        image = (view.probability > HALF).astype(np.int8)
        if known:
            west, south = self._corner[0] - view.west, self._corner[1] - view.south
            rows, columns = self._last.shape[1:]
            image[south : south + rows, west : west + columns] = self._last[chain]
        return image


def _ground(view: MapView) -> NDArray[np.int8]:
    """What is given of the pictures: what is settled, and what lies amid its like."""
    ground = np.where(view.seen, np.where(view.state == OPEN, DRAWN, view.state), UNSEEN)
    ground[(ground == DRAWN) & _amid(view.probability > SURELY)] = FULL
    ground[(ground == DRAWN) & _amid(view.seen & (view.probability <= STRAY))] = FREE
    return ground.astype(np.int8)


def _amid(mask: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """The squares of a mask all of whose neighbours within DEEP rows or columns are of it."""
    for axis in (0, 1):
        framed = np.pad(mask, [(DEEP, DEEP) if a == axis else (0, 0) for a in (0, 1)], mode="edge")
        parts = [np.take(framed, np.arange(k, k + mask.shape[axis]), axis) for k in range(2 * DEEP + 1)]
        mask = np.logical_and.reduce(parts)
    return mask


def likeness(found: Blobs, shape: str) -> Floats:
    """(n,) 0 to 1: how well the moments of each part agree with a shape."""
    ratio = np.sqrt((1 + found.lengthy) / np.maximum(1 - found.lengthy, 1e-6))
    longer = found.spread - (ratio + 1 / ratio) / 12
    loose, tight = LOOSE[0] + LOOSE[1] / np.sqrt(found.area), TIGHT[0] + TIGHT[1] / found.area
    straight = _near(longer, np.where(longer > 0, loose, tight))
    even = _near(found.lengthy, EVEN[0] + EVEN[1] / np.sqrt(found.area))
    match shape:
        case "square":
            return straight * even
        case "disc":
            return _near(found.spread - DISC, tight) * even
        case "brick":
            return straight * (1 - even)
        case "rectangle":
            return straight
    other: Floats = np.clip(longer / OTHERS, 0.1, 1.0)
    return other


def _near(off: Floats, loose: Floats) -> Floats:
    answer: Floats = np.exp(-((off / loose) ** 2))
    return answer
