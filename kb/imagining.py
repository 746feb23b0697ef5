"""What stands where squares are not settled: pictures that agree with all counts, and what they have in common.

Counts that settle no single square may yet tell that something as wide as long stands apart from the wall. Geometry
draws simple pictures that agree with the counts (geometry.sketch); how many of them show a thing of some shape at a
place is how likely one is there.
"""

import math

import numpy as np
from numpy.typing import NDArray

from geometry.sketch import DRAWN, FREE, FULL, UNSEEN, Blobs, blobs, pictures
from kb.evidence import OPEN, STRAY, MapView
from kb.lattice import Lattice

PICTURES = 8
WARMING, AGAIN = 60, 24  # sweeps before the first picture: of a new map, of one that was pictured before
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


class Imagination:
    """Pictures the unsettled part of the map, and remembers the last picture to begin the next one with."""

    def __init__(self) -> None:
        self._lattice: Lattice | None = None
        self._corner = (0, 0)
        self._last = np.zeros((0, 0), np.int8)

    def likely(self, view: MapView, lattice: Lattice, shape: str) -> Floats:
        """(rows, columns): how likely each square belongs to an isolated thing of a shape."""
        ground = _ground(view)
        first, known = self._first(view, lattice)
        drawn = pictures(ground, view.counts, first, PICTURES, AGAIN if known else WARMING, 1.0 if known else HALF)
        self._lattice, self._corner, self._last = lattice, (view.west, view.south), drawn[-1]
        heat = np.zeros(ground.shape)
        for image in drawn:
            found = blobs(image, ground)
            like = likeness(found, shape) * found.apart * (found.area >= SMALLEST)
            heat += np.append(0.0, like)[found.labels]
        return heat / PICTURES

    def _first(self, view: MapView, lattice: Lattice) -> tuple[NDArray[np.int8], bool]:
        """The picture to begin with, and whether most of it was pictured before."""
        image = (view.probability > HALF).astype(np.int8)
        known = lattice == self._lattice
        if known:
            west, south = self._corner[0] - view.west, self._corner[1] - view.south
            rows, columns = self._last.shape
            image[south : south + rows, west : west + columns] = self._last
        return image, known


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
