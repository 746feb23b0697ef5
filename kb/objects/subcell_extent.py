"""How far the sides of a thing lie within the squares in which it was seen.

Whatever lies with its sides along the lattice looks as if it filled whole squares: on each side it may be less, by up
to one. Mostly things do lie on whole squares, so that is believed. It shows when one is pushed by a part of a square: a
side that lies on the line comes upon the next row of squares at once, and one that lies further in does not.
"""

import math
from collections.abc import Callable, Iterable
from itertools import product
from typing import Any, NamedTuple

import numpy as np
import shapely

Sides = tuple[float, float, float, float]  # west, east, south, north
ALONG = 1e-6  # squares: how straight a side along the lattice is
TELLING = 0.04  # squares: what is known that well of a side is not told better
HAIR = 1e-3  # squares: less of a row than this tells nothing
NONE: Sides = (0.0, 0.0, 0.0, 0.0)
WHOLE: Sides = (1.0, 1.0, 1.0, 1.0)


class SubcellExtent(NamedTuple):
    """How far each side lies within the squares in which a thing was seen, in squares: at least, and less than.

    The sides are those of the thing as it lay when it was first held.
    """

    least: Sides = NONE
    most: Sides = WHOLE

    @property
    def believed(self) -> Sides:
        """Nothing, along an axis of which nothing else is known; else what a thing of whole squares would have.

        Where that cannot be, amid what is left.
        """
        return (*_believed(self.least[:2], self.most[:2]), *_believed(self.least[2:], self.most[2:]))

    @property
    def short(self) -> Sides:
        """How much further in each side may lie than it is believed to."""
        west, east, south, north = (most - here for most, here in zip(self.most, self.believed, strict=True))
        return west, east, south, north

    @property
    def plays(self) -> tuple[Sides, Sides]:
        """By how much each side may lie further out than believed, and further in; 0 where it fills whole squares."""
        here = self.believed
        out = _sides(at - least if at else 0.0 for at, least in zip(here, self.least, strict=True))
        return out, _sides(most - at if at else 0.0 for at, most in zip(here, self.most, strict=True))

    @property
    def play(self) -> float:
        """The greatest of these."""
        return max(max(sides) for sides in self.plays)

    def after(self, quarters: int) -> "SubcellExtent":
        """Of the sides as they lie after so many quarter turns."""
        return SubcellExtent(turned(self.least, quarters), turned(self.most, quarters))


def _believed(least: tuple[float, ...], most: tuple[float, ...]) -> tuple[float, float]:
    """What is believed of two sides, one against the other."""
    if not any(least):
        return 0.0, 0.0
    low, high = max(least[1], 1.0 - most[0]), min(most[1], 1.0 - least[0])
    if low < high:
        far = (low + high) / 2
        return 1.0 - far, far
    return (least[0] + most[0]) / 2, (least[1] + most[1]) / 2


def turned(sides: Sides, quarters: int) -> Sides:
    """What belongs to the sides of a thing, as they lie after so many quarter turns."""
    for _ in range(quarters % 4):
        west, east, south, north = sides
        sides = north, south, west, east
    return sides


def further(to: SubcellExtent, since: SubcellExtent) -> Sides:
    """How much further in the sides are believed to lie than they were."""
    west, east, south, north = (new - old for new, old in zip(to.believed, since.believed, strict=True))
    return west, east, south, north


def moved_in(polygon: Any, sides: Sides) -> Any:
    """An outline with its sides moved in by so much, or out where that is negative.

    None when not all its sides lie along the lattice, or when it would not be an outline with the same corners.
    """
    points = shapely.get_coordinates(polygon)[:-1]
    along = np.roll(points, -1, axis=0) - points  # each side from its corner
    upright = np.abs(along[:, 0]) <= ALONG
    if not (upright ^ (np.abs(along[:, 1]) <= ALONG)).all() or (upright == np.roll(upright, 1)).any():
        return None
    ahead = along if polygon.exterior.is_ccw else -along
    west, east, south, north = sides
    shift = np.where(upright, np.where(ahead[:, 1] > 0, -east, west), np.where(ahead[:, 0] > 0, south, -north))
    by_own, by_last = shift, np.roll(shift, 1)  # of the two sides that meet in a corner
    new = points + np.column_stack([np.where(upright, by_own, by_last), np.where(upright, by_last, by_own)])
    left = np.roll(new, -1, axis=0) - new
    if ((left * along) < -ALONG).any() or (np.abs(left).max(1) <= ALONG).any():
        return None
    outline = shapely.Polygon(new)
    return outline if outline.is_valid else None


def within_play(polygon: Any, inwards: Sides, hair: float) -> Any:
    """An outline with its sides moved in by so much, and by a hair besides unless they lie on lines of the lattice.

    Both are negative where they are moved out. None as of moved_in.
    """
    moved = moved_in(polygon, _sides(far + hair for far in inwards))
    if moved is None:
        return None
    points, new = (shapely.get_coordinates(outline)[:-1] for outline in (polygon, moved))
    exact = np.array([not any(inwards[:2]), not any(inwards[2:])])
    return shapely.Polygon(np.where(exact & (np.abs(points - np.rint(points)) < ALONG), points, new))


def depths(image: tuple[float, float, float, float]) -> Sides:
    """How much of the last row of squares on each side an image covers, from its bounds x0, y0, x1, y1; 0 to 1."""
    x0, y0, x1, y1 = image
    return math.floor(x0) + 1 - x0, x1 - math.ceil(x1) + 1, math.floor(y0) + 1 - y0, y1 - math.ceil(y1) + 1


def told(insets: SubcellExtent, polygon: Any, agrees: Callable[[Any], bool]) -> SubcellExtent | None:
    """What a look leaves of what may be; None when it agrees with nothing.

    insets, polygon : the sides as they lie at the look, by which the outline is believed where it is. agrees : does
    the look agree with an outline?
    """
    west, east, south, north = insets.believed
    x0, y0, x1, y1 = polygon.bounds
    deep = depths((x0 - west, y0 - south, x1 + east, y1 + north))
    halves = [_halves(*side) for side in zip(insets.least, insets.most, deep, strict=True)]
    if all(len(parts) == 1 for parts in halves):
        return insets if agrees(polygon) else None
    left = []
    for parts in product(*halves):
        part = SubcellExtent(_sides(p[0] for p in parts), _sides(p[1] for p in parts))
        lying = moved_in(polygon, further(part, insets))
        if lying is not None and agrees(lying):
            left.append(part)
    if not left:
        return None
    least = _sides(min(side) for side in zip(*(part.least for part in left), strict=True))
    most = _sides(max(side) for side in zip(*(part.most for part in left), strict=True))
    return SubcellExtent(least, most)


def _halves(least: float, most: float, deep: float) -> list[tuple[float, float]]:
    """What may be of one side: parts in each of which it covers the same squares."""
    if least + HAIR < deep < most - HAIR and most - least > TELLING:
        return [(least, deep), (deep, most)]
    return [(least, most)]


def _sides(values: Iterable[float]) -> Sides:
    west, east, south, north = values
    return west, east, south, north
