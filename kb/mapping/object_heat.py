"""What stands where squares are not settled: pictures that agree with all counts, and what they have in common.

Counts that settle no single square may yet tell where a wall runs, where a door is in it, and that something as wide as
long stands apart from it: simple pictures that agree with all counts (kb.mapping.completions) show it. In how many
of them a
square is occupied is how likely it is so.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from geometry.counts.gibbs import DRAWN
from geometry.counts.moments import Blobs, blobs
from kb.mapping.completions import NO_PICTURES, Completions, ground_of, pictured
from kb.mapping.occupancy import MapView

SMALLEST = 4  # squares of a thing that is worth a look
ENDED = 0.7  # that a thing ends at the side of a square beyond which nothing was seen
SHY = 2  # pictures show a thing more rarely than it is there: none is, by this power of how often they show none
WIDEST = 9  # sides of squares along which a thing goes on unseen; along more a wall does
NO_DEEPER = 1.15  # times that: how far a thing as wide as long may reach from there
NO_WALL = 0.7  # that what is within both is no wall
PARTLY = ((18, 0.5), (12, 0.3), (6, 0.18), (0, 0.02))  # squares seen of what may be a thing; that it is the one meant
LOOSE = (0.012, 0.03)  # how much wider than a rectangle a part may be spread: at least, and if it is one square wide
TIGHT = (0.003, 0.15)  # how much less: corners seen rounded, but less than a disc's; likewise, by its squares
EVEN = (0.12, 0.4)  # likewise how much longer than wide a square may seem, by the squares that it covers
DISC = 1 / (2 * math.pi)
OTHERS = 0.2  # by this share and more the spread of what is neither is wider than a rectangle's
SLENDER = (4.0, 2.0)  # how much longer than wide a brick is at most, and how soon beyond that what is so is wall
STOUT = (3.0, 1.0)  # likewise of what is neither, an L with long arms
SELDOM = 0.1  # the least likeness of what is too slender, and of what has the spread of a rectangle to what is none
GONE_ON = 10  # squares along which what goes on unseen is seen, from where on it is taken for wall
Floats = NDArray[np.float64]


class CompletionSummary(NamedTuple):
    """Completions of the map as it may be."""

    pictures: Completions

    def probability(self, by_counts: NDArray[np.float32]) -> NDArray[np.float32]:
        """(rows, columns): that a square is occupied, with what counts alone say for one more picture."""
        ground, images = self.pictures.ground, self.pictures.images
        shares = (images.sum(0, dtype=np.float32) + by_counts) / np.float32(len(images) + 1)
        answer: NDArray[np.float32] = np.where(ground == DRAWN, shares, by_counts)
        return answer

    def likely(self, shape: str) -> Floats:
        """(rows, columns): how likely each square belongs to an isolated thing of a shape."""
        ground, images = self.pictures.ground, self.pictures.images
        heat = np.zeros(ground.shape)
        for image in images:
            found = blobs(image, ground)
            like = likeness(found, shape) * ended(found) * (found.area >= SMALLEST)
            heat += np.append(0.0, np.maximum(like, going_on(found)))[found.labels]
        likely: Floats = 1 - (1 - heat / len(images)) ** SHY
        return likely


NOTHING_IMAGINED = CompletionSummary(NO_PICTURES)


def imagine(view: MapView, before: CompletionSummary = NOTHING_IMAGINED) -> CompletionSummary:
    """Completions of a map. before : those of the last look, on the same lattice."""
    return CompletionSummary(pictured(view, ground_of(view), before.pictures))


def likeness(found: Blobs, shape: str) -> Floats:
    """(n,) 0 to 1: how well the moments of each part agree with a shape."""
    ratio = np.sqrt((1 + found.lengthy) / np.maximum(1 - found.lengthy, 1e-6))
    rectangular = (ratio + 1 / ratio) / 12
    longer = found.spread - rectangular
    loose, tight = LOOSE[0] + LOOSE[1] / np.sqrt(found.area), TIGHT[0] + TIGHT[1] / found.area
    straight = _near(longer, np.where(longer > 0, loose, tight))
    even = _near(found.lengthy, EVEN[0] + EVEN[1] / np.sqrt(found.area))
    match shape:
        case "square":
            return straight * even
        case "disc":
            return _near(found.spread - DISC, tight) * even
        case "brick":
            return straight * _not_slender(ratio) * (1 - even)
        case "rectangle":
            return straight * _not_slender(ratio)
    wider = np.clip(longer / (OTHERS * rectangular), 0.0, 1.0)
    return np.maximum(wider * _at_most(ratio, *STOUT), SELDOM)


def ended(found: Blobs) -> Floats:
    """(n,) 0 to 1: how likely each part ends where its squares border on what was never seen."""
    wall = (found.outward > 0) & (found.area >= GONE_ON * found.outward)
    return np.where(wall, 0.0, ENDED**found.outward)


def going_on(found: Blobs) -> Floats:
    """(n,) 0 to 1: how likely each part is what is seen of a thing that goes on unseen and is the one looked for."""
    no_deeper = found.area <= NO_DEEPER * found.outward**2
    may_be = (found.outward > 1) & (found.outward <= WIDEST) & no_deeper
    answer: Floats = np.where(may_be, NO_WALL * seen_in_part(found.area), 0.0)
    return answer


def seen_in_part(squares: NDArray[np.int64]) -> Floats:
    """0 to 1: how likely what goes on unseen, and may be a thing, is the one looked for, by how much of it is seen."""
    answer: Floats = np.select([squares >= least for least, _ in PARTLY], [chance for _, chance in PARTLY])
    return answer


def _not_slender(ratio: Floats) -> Floats:
    return np.maximum(_at_most(ratio, *SLENDER), SELDOM)


def _at_most(value: Floats, most: float, loose: float) -> Floats:
    return _near(np.maximum(value - most, 0.0), loose)


def _near(off: Floats, loose: Floats | float) -> Floats:
    answer: Floats = np.exp(-((off / loose) ** 2))
    return answer
