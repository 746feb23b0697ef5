"""The corners of the known floor: geometry gives its convex corners, and kb/asp/corners.lp says which is which.

The corner furthest towards any side is a corner of the floor's convex hull, so only those are given.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray

from kb.mapping.occupancy import FULL
from kb.mapping.patch import covered
from kb.perception.regions import label_of
from kb.reasoning.solver import KB, solve
from kb.world.model import WorldModel

ALONG = 8.0  # squares of a wall that tell how it lies: where it leaves its row within that, it lies askew
LEAST_ANGLE = 0.5  # the sine of that between the walls of a corner: they are no one wall
SMALLEST = 6  # squares of floor that are worth a corner
HUNDREDTHS = 100
SIDES = ("northeast", "northwest", "southeast", "southwest")


class Corner(NamedTuple):
    """A convex corner: its point (x, y) in the frame of the view, and the square (column, row) of floor that has it.

    walls : the outward unit normals of the walls that form it, where these lie askew to the squares; else None.
    """

    point: tuple[float, float]
    square: tuple[int, int]
    walls: tuple[tuple[float, float], tuple[float, float]] | None = None


def known_floor(model: WorldModel) -> NDArray[np.bool_]:
    """(rows, columns): the floor on which Utak stands, all other floor that is seen and large enough to be some, and
    the floor under what he has moved: squares that were floor before it came there, or that it surely covers by its
    outline. Others that it may cover may be wall, also where they were seen to be occupied.
    """
    sizes = np.bincount(model.labels.ravel())
    large = (sizes >= SMALLEST)[model.labels]
    mask: NDArray[np.bool_] = model.floor | (model.space & large)
    for node in model.objects:
        if node.moved:
            under = model.view.state == FULL
            if node.polygon is not None:
                under &= model.mask_within(covered(node.polygon))
            if model.beneath is not None:
                under |= model.beneath
            mask |= (model.labels == label_of(node.region)) & under
    return mask


def corners(model: WorldModel, rules: tuple[Path, ...] = ()) -> Mapping[str, Corner]:
    """The corner of the known floor towards each side of Utak's frame."""
    found = _convex(known_floor(model))
    facts = []
    for number, corner in enumerate(found):
        east, north = model.place_to_utak(*corner.point)
        facts.append(f"convex({number},{round(HUNDREDTHS * east)},{round(HUNDREDTHS * north)})")
    answer = solve([KB / "corners.lp", *rules], facts) or ()
    return {str(a.arguments[0]): found[a.arguments[1].number] for a in answer if a.match("furthest", 2)}


def _convex(floor: NDArray[np.bool_]) -> list[Corner]:
    """The corners of the convex hull of a mask, each with the square that has it; by place."""
    rows = np.flatnonzero(floor.any(axis=1))
    first = floor[rows].argmax(axis=1)
    last = floor.shape[1] - 1 - floor[rows, ::-1].argmax(axis=1)
    owner: dict[tuple[int, int], tuple[int, int]] = {}
    for row, west, east in zip(rows.tolist(), first.tolist(), last.tolist(), strict=True):
        for height in (row, row + 1):
            owner[west, height] = (west, row)
            owner[east + 1, height] = (east, row)
    ring = shapely.convex_hull(shapely.multipoints(sorted(owner))).exterior
    points = sorted(set(ring.coords))
    return [Corner((x, y), owner[round(x), round(y)], _walls(ring, (x, y))) for x, y in points]


def _walls(
    ring: shapely.LinearRing, point: tuple[float, float]
) -> tuple[tuple[float, float], tuple[float, float]] | None:
    """The outward normals of the walls that meet in a corner of a convex ring; None where both lie along the squares.

    A wall is followed as far as ALONG. One that leaves a row of squares within that lies askew.
    """
    along, length = ring.project(shapely.Point(point)), ring.length
    ends = [ring.interpolate((along + way * min(ALONG, length / 8)) % length) for way in (-1, 1)]
    steps = np.array([(end.x - point[0], end.y - point[1]) for end in ends])
    if (np.abs(steps).min(axis=1) < 1.0).all():
        return None
    turn = 1 if ring.is_ccw else -1
    (ax, ay), (bx, by) = steps / np.hypot(*steps.T)[:, None]
    normals = (-turn * ay, turn * ax), (turn * by, -turn * bx)
    return normals if abs(normals[0][0] * normals[1][1] - normals[0][1] * normals[1][0]) > LEAST_ANGLE else None
