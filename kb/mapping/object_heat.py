"""Common features of completions: how likely squares are occupied, and where an object of a shape may be.

Counts that settle no single square may yet say where a wall runs, where a door is in it, and that something as wide as
long stands apart from it: simple maps that agree with all counts (kb.mapping.completions) show it. The share of
completions in which a square is occupied is the probability that it is. Which connected parts of a completion look
like a shape is judged by their second moments (geometry.counts.moments).
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from utak.geometry.counts.gibbs import DRAWN
from utak.geometry.counts.moments import Blobs, blobs
from utak.geometry.kernels.arrays import Floats, Longs
from utak.kb.mapping.completions import NO_COMPLETIONS, Completions, draw_completions, given_squares
from utak.kb.mapping.occupancy import MapView

# All figures below were tuned on random worlds (benchmarks.campaign), unless they are derived.
MIN_OBJECT_AREA = 4  # squares: smaller parts are no object worth a look
END_PROBABILITY = 0.7  # that an object ends at the side of a square beyond which nothing was seen
ABSENCE_EXPONENT = 2  # the share of completions without an object there, to this power, is how likely there is none
MAX_OPEN_SIDES = 9  # sides of squares along which an object goes on unseen, at most; along more sides it is a wall
MAX_DEPTH_RATIO = 1.15  # area of an object by the square of those sides, at most: as wide as long, and a little more
OBJECT_PROBABILITY = 0.7  # that what keeps within both bounds is an object rather than a wall
# (squares seen at least, that it is the one meant)
SEEN_PART_PROBABILITY = ((18, 0.5), (12, 0.3), (6, 0.18), (0, 0.02))
# The spread of a part (sum of principal moments by squared area) is compared with that of a rectangle. Each tolerance
# is a constant, and a term that falls with the area of the part.
WIDER_TOLERANCE = (0.012, 0.03)  # spread above a rectangle's; the second term is for a part of one square
NARROWER_TOLERANCE = (0.003, 0.15)  # spread below a rectangle's: corners seen rounded, but less than a disc's
EVEN_TOLERANCE = (0.12, 0.4)  # difference of the principal moments, by their sum, of what is as wide as long
DISC_SPREAD = 1 / (2 * math.pi)  # of a disc; derived
OTHER_SPREAD_RATIO = 0.2  # other shapes have a spread greater than a rectangle's by this share, and more
BRICK_RATIO = (4.0, 2.0)  # a brick is at most so many times as long as wide; how soon beyond that it is a wall
OTHER_RATIO = (3.0, 1.0)  # likewise of other shapes, such as an L with long arms
MIN_LIKENESS = 0.1  # the least likeness of what is too slender, or has the spread of a rectangle and should not
WALL_ELONGATION = 10  # squares seen for each open side, from which on what goes on unseen is a wall


class CompletionSummary(NamedTuple):
    """Completions of the map, and what they have in common."""

    pictures: Completions  # The completions; all arrays are on theirs, [row, column] with row 0 in the south

    def probability(self, by_counts: NDArray[np.float32]) -> NDArray[np.float32]:
        """Return the probability that each square is occupied."""
        ground, images = self.pictures.ground, self.pictures.images
        shares = (images.sum(0, dtype=np.float32) + by_counts) / np.float32(len(images) + 1)
        answer: NDArray[np.float32] = np.where(ground == DRAWN, shares, by_counts)
        return answer

    def likely(self, shape: str) -> Floats:
        """Return the probability that each square belongs to an isolated object of a shape class."""
        ground, images = self.pictures.ground, self.pictures.images
        heat = np.zeros(ground.shape)
        for image in images:
            found = blobs(image, ground)
            like = likeness(found, shape) * end_probability(found) * (found.area >= MIN_OBJECT_AREA)
            heat += np.append(0.0, np.maximum(like, part_seen_probability(found)))[found.labels]
        likely: Floats = 1 - (1 - heat / len(images)) ** ABSENCE_EXPONENT
        return likely


NO_COMPLETION_SUMMARY = CompletionSummary(NO_COMPLETIONS)


def summarise_completions(view: MapView, before: CompletionSummary = NO_COMPLETION_SUMMARY) -> CompletionSummary:
    """Draw completions of a map, and return them with what they have in common."""
    return CompletionSummary(draw_completions(view, given_squares(view), before.pictures))


def likeness(found: Blobs, shape: str) -> Floats:
    """Return how well the moments of each of n parts agree with a shape class, (n,) from 0 (not at all) to 1."""
    # For brick and rectangle slenderness counts against it, for square and disc that it is longer than wide.
    ratio = np.sqrt((1 + found.lengthy) / np.maximum(1 - found.lengthy, 1e-6))
    rectangular = (ratio + 1 / ratio) / 12
    longer = found.spread - rectangular
    wider = WIDER_TOLERANCE[0] + WIDER_TOLERANCE[1] / np.sqrt(found.area)
    narrower = NARROWER_TOLERANCE[0] + NARROWER_TOLERANCE[1] / found.area
    straight = _agreement(longer, np.where(longer > 0, wider, narrower))
    even = _agreement(found.lengthy, EVEN_TOLERANCE[0] + EVEN_TOLERANCE[1] / np.sqrt(found.area))
    match shape:
        case "square":
            return straight * even
        case "disc":
            return _agreement(found.spread - DISC_SPREAD, narrower) * even
        case "brick":
            return straight * _not_slender(ratio) * (1 - even)
        case "rectangle":
            return straight * _not_slender(ratio)
    excess = np.clip(longer / (OTHER_SPREAD_RATIO * rectangular), 0.0, 1.0)
    return np.maximum(excess * _agreement_at_most(ratio, *OTHER_RATIO), MIN_LIKENESS)


def end_probability(found: Blobs) -> Floats:
    """Return how likely each of n parts ends where its squares border on unseen ones, (n,) from 0 to 1."""
    wall = (found.outward > 0) & (found.area >= WALL_ELONGATION * found.outward)
    return np.where(wall, 0.0, END_PROBABILITY**found.outward)


def part_seen_probability(found: Blobs) -> Floats:
    """Return how likely each of n parts is the seen part of the object looked for, (n,) from 0 to 1."""
    compact = found.area <= MAX_DEPTH_RATIO * found.outward**2
    may_be = (found.outward > 1) & (found.outward <= MAX_OPEN_SIDES) & compact
    answer: Floats = np.where(may_be, OBJECT_PROBABILITY * chance_by_seen_squares(found.area), 0.0)
    return answer


def chance_by_seen_squares(squares: Longs) -> Floats:
    """Return how likely something that goes on unseen, and may be an object, is the one looked for."""
    parts = SEEN_PART_PROBABILITY
    answer: Floats = np.select([squares >= least for least, _ in parts], [chance for _, chance in parts])
    return answer


def _not_slender(ratio: Floats) -> Floats:
    """Return how well a ratio agrees with a brick: 1 up to 4, less beyond, but at least MIN_LIKENESS (0.1)."""
    return np.maximum(_agreement_at_most(ratio, *BRICK_RATIO), MIN_LIKENESS)


def _agreement_at_most(value: Floats, limit: float, tolerance: float) -> Floats:
    """Return 1 for values up to a limit, and less, down to 0, the further a value is above it."""
    return _agreement(np.maximum(value - limit, 0.0), tolerance)


def _agreement(error: Floats, tolerance: Floats | float) -> Floats:
    """Return exp(-(error / tolerance)^2): 1 for no error, 1 / e for an error of `tolerance`; an array like `error`."""
    answer: Floats = np.exp(-((error / tolerance) ** 2))
    return answer
