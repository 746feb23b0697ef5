"""The oracle of places: where an object can lie, out of the way of others or within a region.

It certifies that the object, not turned, lies there over squares of a floor, and that it can be pushed there by itself
from square to square.

An outline is a shapely Polygon where the object lies, in squares, in the frame of the arrays, (rows, columns) bool:
`floor` are squares on which it may lie, `around` those over which it may be pushed; those of `floor` and its own count,
too.
"""

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from utak.geometry.kernels.arrays import Bools, Ints
from utak.geometry.motion.se2 import Rotate, Translate
from utak.geometry.raster.geodesic import GEODESIC_UNREACHED, reach
from utak.geometry.raster.rasterize import squares
from utak.planner.screen.projection import dilate

SPOT_SLACK = 0.4  # squares about an outline within which a thing lies at its spot: less than half a square
DIAGONALS = ((1, 1), (1, -1), (-1, 1), (-1, -1))  # (rows, columns) towards the corners of a floor
TURN_DECIMALS = 6  # digits of coordinates after a quarter turn that count; bounds rounding
MAX_CLEAR_SPOTS = 6  # places off the ways of others that are offered for one object; a bound on choices
MAX_OTHER_SPOTS = 2  # places on such ways, for want of better ones; a bound on choices
MAX_TESTED_SPOTS = 400  # places on ways of others of which it is tested whether these find another way; a bound on time


class KeptWay(NamedTuple):
    """A way of another object that must stay possible, not turned."""

    offsets: Ints  # (n, 2), its squares (row, column) relative to its lowest row and column
    start: tuple[int, int]  # its lowest (row, column) where it lies, and where it shall lie
    end: tuple[int, int]
    floor: Bools  # (rows, columns) bool, the squares over which it may be pushed when nothing else lies there

    @property
    def is_open(self) -> bool:
        """Whether it is possible when nothing else lies there."""
        return is_way_left(_fits(self.floor, self.offsets), self.start, self.end)


def is_way_left(fits: Bools, start: tuple[int, int], end: tuple[int, int]) -> bool:
    """Return whether an object can be pushed from one place to another one."""
    return bool(fits[start] and fits[end] and reach(fits, start[1], start[0])[end] != GEODESIC_UNREACHED)


def kept_way_of(start: Any, end: Any, floor: Bools) -> KeptWay | None:
    """Return the way of an object from an outline to another one; None when it covers other squares there."""
    rows, columns = floor.shape
    covered = [np.argwhere(squares(outline, columns, rows)) for outline in (start, end)]
    if not all(len(one) for one in covered):
        return None
    lows = [one.min(axis=0) for one in covered]
    if not np.array_equal(covered[0] - lows[0], covered[1] - lows[1]):
        return None
    (row, column), (last_row, last_column) = (tuple(int(v) for v in low) for low in lows)
    return KeptWay(covered[0] - lows[0], (row, column), (last_row, last_column), floor)


def spots(
    outline: Any, floor: Bools, around: Bools, keep_clear: Bools, kept: Sequence[KeptWay] = ()
) -> list[tuple[int, int]]:
    """Return translations (columns, rows) of an object to places where it can lie, a handful, chosen apart."""
    usable = _usable(outline, floor, around)
    if usable is None:
        return []
    offsets, passable, far, mask, (row, column) = usable
    clear = mask & _fits(~keep_clear, offsets)
    roomy = clear & _fits(~dilate(~passable, 1), offsets)
    apart = int(max(offsets.max(axis=0)) + 1)
    chosen = _apart(roomy, far, MAX_CLEAR_SPOTS, apart)
    chosen += _apart(clear & ~roomy, far, MAX_CLEAR_SPOTS - len(chosen), apart)
    if kept and len(chosen) < MAX_CLEAR_SPOTS:
        leaving = _leaving_ways(mask & ~clear, far, offsets, kept)
        chosen += _apart(leaving, far, MAX_CLEAR_SPOTS - len(chosen), apart)
        mask &= ~leaving
    chosen += _apart(mask & ~clear, far, MAX_OTHER_SPOTS, apart)
    return [(x - column, y - row) for x, y in chosen]


def corner_spots(outline: Any, floor: Bools, around: Bools) -> list[tuple[int, int]]:
    """Return translations (columns, rows) of an object to the corners of a floor."""
    # There it leaves most room for others.
    usable = _usable(outline, floor, around)
    if usable is None or not usable.mask.any():
        return []
    row, column = usable.home
    deepest = sorted(_corners_of(usable.mask), key=lambda place: (-int(usable.far[place]), place))
    return [(x - column, y - row) for y, x in deepest]


def turned_corner_outlines(outline: Any, floor: Bools) -> list[Any]:
    """Return an object as it lies, turned by quarters, in the corners of a floor."""
    # Outlines in the frame of the arrays.
    # At most four for each way in which the object then lies otherwise than now.
    rows, columns = floor.shape
    found, shapes = list[Any](), set[bytes]()
    for quarters in range(4):  # about the middle of a square, as the robot turns it
        turned = Rotate(90.0 * quarters, (0.5, 0.5)).carry(outline)
        west, south = (math.floor(round(v, TURN_DECIMALS)) for v in turned.bounds[:2])
        turned = Translate(float(-west), float(-south)).carry(turned)
        if turned.bounds[2] > columns or turned.bounds[3] > rows:
            continue
        own = squares(turned, columns, rows)
        fits = np.zeros_like(floor) if own.tobytes() in shapes else _fits(floor, np.argwhere(own).astype(np.int32))
        shapes.add(own.tobytes())
        found += [Translate(float(x), float(y)).carry(turned) for y, x in sorted(_corners_of(fits)) if quarters]
    return found


def _corners_of(mask: Bools) -> set[tuple[int, int]]:
    """Return the squares (row, column) of a mask that are furthest along its four diagonals; none of an empty mask."""
    places = np.argwhere(mask)
    ends = [places[np.argmax(places @ np.array(diagonal))] for diagonal in DIAGONALS if len(places)]
    return {(int(row), int(column)) for row, column in ends}


class _Usable(NamedTuple):
    """The places of an object on a floor, each by the lowest row and column of its squares."""

    offsets: Ints
    passable: Bools
    far: Ints
    mask: Bools
    home: tuple[int, int]


def _usable(outline: Any, floor: Bools, around: Bools) -> _Usable | None:
    """Return the places of an object that it can be pushed to, as for `spots`; None where it cannot even lie."""
    rows, columns = floor.shape
    own = squares(outline, columns, rows)
    if not own.any():
        return None
    row, column = (int(v) for v in np.argwhere(own).min(axis=0))
    offsets = np.argwhere(own) - np.array([row, column])
    passable = around | floor | own
    fits = _fits(passable, offsets)
    if not fits[row, column]:
        return None
    far = reach(fits, column, row)
    mask = _fits(floor, offsets) & (far != GEODESIC_UNREACHED)
    mask[row, column] = False
    return _Usable(offsets, passable, far, mask, (row, column))


def _leaving_ways(candidates: Bools, far: Ints, offsets: Ints, kept: Sequence[KeptWay]) -> Bools:
    """Return which places of an object, of the nearest MAX_TESTED_SPOTS, leave each kept way possible."""
    found = np.zeros_like(candidates)
    where = np.argwhere(candidates)
    where = where[np.argsort(far[candidates], kind="stable")][:MAX_TESTED_SPOTS]
    ways = []
    for way in kept:
        blocked = np.unique((offsets[:, None] - way.offsets[None]).reshape(-1, 2), axis=0)
        ways.append((_fits(way.floor, way.offsets), blocked, way))
    rows, columns = candidates.shape
    for row, column in where.tolist():
        leaves = True
        for fits, blocked, way in ways:
            there = blocked + np.array([row, column])
            there = there[(there >= 0).all(1) & (there[:, 0] < rows) & (there[:, 1] < columns)]
            left = fits.copy()
            left[there[:, 0], there[:, 1]] = False
            leaves = is_way_left(left, way.start, way.end)
            if not leaves:
                break
        found[row, column] = leaves
    return found


def _fits(mask: Bools, offsets: Ints) -> Bools:
    """Return where the lowest row and column of some squares may be so that all of them lie on a mask."""
    rows, columns = mask.shape
    found = np.ones_like(mask)
    for dy, dx in offsets:
        shifted = np.zeros_like(mask)
        shifted[: rows - dy, : columns - dx] = mask[dy:, dx:]
        found &= shifted
    return found


def _apart(mask: Bools, far: Ints, number: int, apart: int) -> list[tuple[int, int]]:
    """Return at most `number` squares (column, row) of a mask: the nearest, then those furthest from these."""
    where = np.argwhere(mask)
    if not len(where) or number < 1:
        return []
    chosen = [int(np.argmin(far[mask]))]
    gap = np.abs(where - where[chosen[0]]).max(axis=1)
    while len(chosen) < number and gap.max() >= apart:
        chosen.append(int(np.argmax(gap)))
        gap = np.minimum(gap, np.abs(where - where[chosen[-1]]).max(axis=1))
    return [(int(where[i][1]), int(where[i][0])) for i in chosen]


def covered_by(outlines: Sequence[Any], shape: tuple[int, int]) -> Bools:
    """Return the squares that some shapely Polygons cover, (rows, columns) bool of a shape."""
    found = np.zeros(shape, np.bool_)
    for outline in outlines:
        found |= squares(outline, shape[1], shape[0])
    return found
