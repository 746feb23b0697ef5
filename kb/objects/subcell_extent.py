"""Sub-cell extents: how far the sides of an object lie within the squares in which it was seen.

An object with its sides parallel to the grid looks as if it filled whole squares: on each side it may be smaller, by
less than one square. Most objects do fill whole squares, so that is believed. A push by a part of a square shows it: a
side on a grid line enters the next row of squares at once, and one that lies further in does not.

Sides come in the order west, east, south, north. An inset is the distance, in squares, from the outer line of the
squares in which the object was seen, inwards to the side.
"""

import math
from collections.abc import Callable, Iterable
from itertools import product
from typing import Any, NamedTuple

import numpy as np
import shapely

SideValues = tuple[float, float, float, float]  # one value for each side: west, east, south, north
GRID_ALIGNMENT_TOLERANCE = 1e-6  # squares: a side is parallel to the grid if it deviates by no more; rounding
MIN_TESTED_INTERVAL = 0.04  # squares: an inset known within this is not narrowed further; tuned
MIN_ROW_DEPTH = 1e-3  # squares: less of a row than this shows nothing; rounding
NO_INSETS: SideValues = (0.0, 0.0, 0.0, 0.0)
FULL_INSETS: SideValues = (1.0, 1.0, 1.0, 1.0)


class SubcellExtent(NamedTuple):
    """The possible insets of the sides of an object, as it lay when it was first held, unless stated otherwise."""

    least: SideValues = NO_INSETS  # The least inset of each side (west, east, south, north), in squares
    most: SideValues = FULL_INSETS  # Each inset is less than this, in squares

    @property
    def believed(self) -> SideValues:
        """The believed inset of each side, in squares: west, east, south, north."""
        return (*_believed(self.least[:2], self.most[:2]), *_believed(self.least[2:], self.most[2:]))

    @property
    def uneven(self) -> bool:
        """Whether a side is believed not to fill the squares in which the object was seen."""
        return any(self.believed)

    @property
    def short(self) -> SideValues:
        """The distance by which each side (west, east, south, north) may lie further in than believed, in squares."""
        west, east, south, north = (most - here for most, here in zip(self.most, self.believed, strict=True))
        return west, east, south, north

    @property
    def plays(self) -> tuple[SideValues, SideValues]:
        """The distances by which each side may lie further out than believed, and further in, in squares."""
        # Two tuples, for further out and for further in, each of west, east, south, north. 0 for a side that is
        # believed to fill its squares, that is, to have the inset 0.
        here = self.believed
        out = as_sides(at - least if at else 0.0 for at, least in zip(here, self.least, strict=True))
        return out, as_sides(most - at if at else 0.0 for at, most in zip(here, self.most, strict=True))

    @property
    def play(self) -> float:
        """The greatest value of `plays`, in squares; 0 when every side is believed to fill its squares."""
        return max(max(sides) for sides in self.plays)

    def after(self, quarters: int) -> "SubcellExtent":
        """Return the insets of the sides as they lie after a number of quarter turns, counter-clockwise positive."""
        return SubcellExtent(turn_sides(self.least, quarters), turn_sides(self.most, quarters))


def _believed(least: tuple[float, ...], most: tuple[float, ...]) -> tuple[float, float]:
    """Return the believed insets of two opposite sides, in squares: west and east, or south and north."""
    if not any(least):
        return 0.0, 0.0
    low, high = max(least[1], 1.0 - most[0]), min(most[1], 1.0 - least[0])
    if low < high:
        far = (low + high) / 2
        return 1.0 - far, far
    return (least[0] + most[0]) / 2, (least[1] + most[1]) / 2


def turn_sides(sides: SideValues, quarters: int) -> SideValues:
    """Return the values of the sides as they lie after a number of quarter turns, counter-clockwise positive."""
    for _ in range(quarters % 4):
        west, east, south, north = sides
        sides = north, south, west, east
    return sides


def inset_change(to: SubcellExtent, since: SubcellExtent) -> SideValues:
    """Return by how much further in the sides are believed to lie in `to` than in `since`, in squares."""
    west, east, south, north = (new - old for new, old in zip(to.believed, since.believed, strict=True))
    return west, east, south, north


def inset_outline(polygon: Any, sides: SideValues) -> Any:
    """Return an outline with its sides moved inwards."""
    points = shapely.get_coordinates(polygon)[:-1]
    along = np.roll(points, -1, axis=0) - points  # each side from its corner
    upright = np.abs(along[:, 0]) <= GRID_ALIGNMENT_TOLERANCE
    level = np.abs(along[:, 1]) <= GRID_ALIGNMENT_TOLERANCE
    if not (upright ^ level).all() or (upright == np.roll(upright, 1)).any():
        return None
    ahead = along if polygon.exterior.is_ccw else -along
    west, east, south, north = sides
    shift = np.where(upright, np.where(ahead[:, 1] > 0, -east, west), np.where(ahead[:, 0] > 0, south, -north))
    by_own, by_last = shift, np.roll(shift, 1)  # of the two sides that meet in a corner
    new = points + np.column_stack([np.where(upright, by_own, by_last), np.where(upright, by_last, by_own)])
    left = np.roll(new, -1, axis=0) - new
    if ((left * along) < -GRID_ALIGNMENT_TOLERANCE).any() or (np.abs(left).max(1) <= GRID_ALIGNMENT_TOLERANCE).any():
        return None
    outline = shapely.Polygon(new)
    return outline if outline.is_valid else None


def within_play(polygon: Any, inwards: SideValues, margin: float) -> Any:
    """Return an outline with its sides moved inwards, and by a margin more where they do not lie on grid lines."""
    moved = inset_outline(polygon, as_sides(far + margin for far in inwards))
    if moved is None:
        return None
    points, new = (shapely.get_coordinates(outline)[:-1] for outline in (polygon, moved))
    exact = np.array([not any(inwards[:2]), not any(inwards[2:])])
    on_line = np.abs(points - np.rint(points)) < GRID_ALIGNMENT_TOLERANCE
    return shapely.Polygon(np.where(exact & on_line, points, new))


def last_row_coverage(image: tuple[float, float, float, float]) -> SideValues:
    """Return how much of the last row of squares on each side an image covers, from above 0 to 1 square."""
    x0, y0, x1, y1 = image
    return math.floor(x0) + 1 - x0, x1 - math.ceil(x1) + 1, math.floor(y0) + 1 - y0, y1 - math.ceil(y1) + 1


def narrowed(insets: SubcellExtent, polygon: Any, agrees: Callable[[Any], bool]) -> SubcellExtent | None:
    """Return the insets that an impression leaves possible."""
    # None when the impression agrees with no possible outline.
    west, east, south, north = insets.believed
    x0, y0, x1, y1 = polygon.bounds
    deep = last_row_coverage((x0 - west, y0 - south, x1 + east, y1 + north))
    halves = [_halves(*side) for side in zip(insets.least, insets.most, deep, strict=True)]
    if all(len(parts) == 1 for parts in halves):
        return insets if agrees(polygon) else None
    left = []
    for parts in product(*halves):
        part = SubcellExtent(as_sides(p[0] for p in parts), as_sides(p[1] for p in parts))
        lying = inset_outline(polygon, inset_change(part, insets))
        if lying is not None and agrees(lying):
            left.append(part)
    if not left:
        return None
    least = as_sides(min(side) for side in zip(*(part.least for part in left), strict=True))
    most = as_sides(max(side) for side in zip(*(part.most for part in left), strict=True))
    return SubcellExtent(least, most)


def _halves(least: float, most: float, deep: float) -> list[tuple[float, float]]:
    """Return intervals of the inset of a side in each of which it covers the same squares; `deep` divides them."""
    if least + MIN_ROW_DEPTH < deep < most - MIN_ROW_DEPTH and most - least > MIN_TESTED_INTERVAL:
        return [(least, deep), (deep, most)]
    return [(least, most)]


def as_sides(values: Iterable[float]) -> SideValues:
    """Return four values as a tuple (west, east, south, north); ValueError for any other number of values."""
    west, east, south, north = values
    return west, east, south, north
