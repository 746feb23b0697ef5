"""The corners of the known floor: geometry finds its convex corners, and kb/asp/corners.lp decides which is which.

The corner furthest towards any side is a corner of the convex hull of the floor, so only those are found.
"""

import math
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import NamedTuple

import numpy as np
import shapely

from utak.geometry.kernels.arrays import XY, Bools, Square
from utak.geometry.raster.components import components
from utak.kb.mapping.occupancy import OCCUPIED
from utak.kb.mapping.patch import patch_of_polygon
from utak.kb.perception.regions import label_of
from utak.kb.reasoning.encodings import KB_ENCODINGS
from utak.kb.reasoning.solver import solve
from utak.kb.world.model import WorldModel, hundredths

WALL_SAMPLE_LENGTH = 8.0  # squares: a wall is followed so far; if it leaves its row of squares within, it lies askew
MIN_CORNER_SINE = 0.5  # the sine of the angle between the walls of a corner; below it they are taken for one wall
MIN_FLOOR_SQUARES = 6  # squares: smaller parts of the floor have no corner; tuned


class Corner(NamedTuple):
    """A convex corner of the known floor."""

    # The corner, in squares, in the frame of the view's arrays: origin at the south-west corner of the map view's
    # square [0, 0], x to the east, y to the north, along the grid
    point: XY
    square: Square  # The square of floor that has it: (column, row) on the view's arrays, row 0 in the south
    # The unit normals of the walls that form it, pointing out of the floor, same frame, if at least one of these lies
    # askew to the grid; None otherwise
    walls: tuple[XY, XY] | None = None


def known_floor(model: WorldModel) -> Bools:
    """Return all squares known to be floor."""
    # (rows, columns) bool, on the arrays of the map view (row 0 in the south).
    # Other squares that a moved object may cover may be wall, even where they were seen to be occupied.
    sizes = np.bincount(model.labels.ravel())
    large = (sizes >= MIN_FLOOR_SQUARES)[model.labels]
    mask: Bools = model.floor | (model.space & large)
    for node in model.objects:
        if node.moved:
            under = model.view.state == OCCUPIED
            if node.polygon is not None:
                under &= model.mask(patch_of_polygon(node.polygon))
            if model.floor_under_moved is not None:
                under |= model.floor_under_moved
            mask |= (model.labels == label_of(node.region)) & under
    return mask


def corners(model: WorldModel, rules: tuple[Path, ...] = ()) -> Mapping[str, Corner]:
    """Find the corner of the known floor furthest towards each side of the robot frame."""
    found = _convex_corners(known_floor(model))
    facts = []
    for number, corner in enumerate(found):
        east, north = model.place_to_utak(*corner.point)
        facts.append(f"convex({number},{hundredths(east)},{hundredths(north)})")
    answer = solve([KB_ENCODINGS / "corners.lp", *rules], facts) or ()
    return {str(a.arguments[0]): found[a.arguments[1].number] for a in answer if a.match("furthest", 2)}


def _convex_corners(floor: Bools) -> list[Corner]:
    """Return the corners of the convex hull of a mask, sorted by (x, y), each with the square that has it."""
    owner = _end_squares(floor)
    whole = _hull(owner)
    found = []
    for x, y in sorted(set(whole.coords)):
        square = owner[round(x), round(y)]
        normals = _wall_normals(whole, (x, y), 1 / 8)
        if normals is not None and _is_straight(floor, (x, y), square):
            normals = None  # the hull of all floor leads on to that of other rooms, past no wall
        found.append(Corner((x, y), square, normals))
    return found


def _end_squares(floor: Bools) -> dict[Square, Square]:
    """Return the grid points at the ends of the rows of a mask, each with a square of it that has this corner."""
    rows = np.flatnonzero(floor.any(axis=1))
    first = floor[rows].argmax(axis=1)
    last = floor.shape[1] - 1 - floor[rows, ::-1].argmax(axis=1)
    owner: dict[Square, Square] = {}
    for row, west, east in zip(rows.tolist(), first.tolist(), last.tolist(), strict=True):
        for height in (row, row + 1):
            owner[west, height] = (west, row)
            owner[east + 1, height] = (east, row)
    return owner


def _hull(points: Iterable[Square]) -> shapely.LinearRing:
    """Return the convex hull of some points, not all on a line, as a ring."""
    return shapely.convex_hull(shapely.multipoints(sorted(points))).exterior


def _wall_normals(ring: shapely.LinearRing, point: XY, share: float) -> tuple[XY, XY] | None:
    """Return the outward unit normals of the two walls at a corner of a convex ring, each a share of it at most."""
    # None where both walls lie along the grid, or where they are nearly one wall.
    along, length = ring.project(shapely.Point(point)), ring.length
    ends = [ring.interpolate((along + way * min(WALL_SAMPLE_LENGTH, length * share)) % length) for way in (-1, 1)]
    steps = np.array([(end.x - point[0], end.y - point[1]) for end in ends])
    if (np.abs(steps).min(axis=1) < 1.0).all():
        return None
    turn = 1 if ring.is_ccw else -1
    (ax, ay), (bx, by) = steps / np.hypot(*steps.T)[:, None]
    normals = (-turn * ay, turn * ax), (turn * by, -turn * bx)
    return normals if abs(normals[0][0] * normals[1][1] - normals[0][1] * normals[1][0]) > MIN_CORNER_SINE else None


def _is_straight(floor: Bools, point: XY, square: Square) -> bool:
    """Return whether the floor about a corner of a mask has walls along the grid there."""
    return _wall_normals(_hull(_end_squares(_floor_about(floor, square))), point, 1 / 4) is None


def _floor_about(floor: Bools, square: Square) -> Bools:
    """Return the floor within WALL_SAMPLE_LENGTH rows and columns of a square of it that hangs together with that."""
    (column, row), reach = square, math.ceil(WALL_SAMPLE_LENGTH)
    window = tuple(slice(max(at - reach, 0), at + reach + 1) for at in (row, column))
    labels = components(floor[window]).labels
    about = np.zeros_like(floor)
    about[window] = labels == labels[row - window[0].start, column - window[1].start]
    return about
