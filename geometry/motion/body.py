"""A body made ready to be moved: drawn about the centre that it is turned about, with discs inscribed in it."""

import math
from collections.abc import Iterable
from functools import lru_cache
from typing import Any

import numpy as np
import shapely

from geometry.kernels.arrays import XY, Floats
from geometry.motion.cell_clearance import MovingBody
from geometry.motion.first_contact import boundary_edges, with_normals
from geometry.motion.se2 import Pose
from geometry.motion.validation import check, sound

DISCS = 16  # inscribed in a body at most
GRID = 16  # places along the body's longer side where discs are tried
SPECK = 1e-3  # squares: half the diagonal of what stands for a point that moves with the body


def new_mover(
    shape: Any, points: Iterable[tuple[float, float]] = (), pivot: tuple[float, float] | None = None
) -> MovingBody:
    """A body from its shape, its own origin being the reference point, and points that move with it.

    pivot : what it is turned about; None for the centre of the enclosing circle, about which it moves least.

    Raises
    ------
    ValueError : when the shape has no area, or a number is not finite.
    """
    at = None if pivot is None else (float(pivot[0]), float(pivot[1]))
    specks = tuple((float(x), float(y)) for x, y in points)
    check([*specks, *([] if at is None else [at])], "points and pivot")
    told = shapely.normalize(shapely.simplify(sound(shape, "the body"), 0))  # however its rings are told
    return _mover(shapely.to_wkb(told), specks, at)


@lru_cache(maxsize=32)
def _mover(wkb: bytes, points: tuple[XY, ...], pivot: XY | None) -> MovingBody:
    """The same: one body is planned for many times. Nobody writes into a MovingBody's arrays."""
    shape = shapely.from_wkb(wkb)
    specks = [shapely.Point(p).buffer(SPECK, quad_segs=1) for p in points]
    whole = shapely.union_all([shape, *specks]) if specks else shape
    if whole is None or not len(edges := boundary_edges(whole)):
        raise ValueError("the body has no area")
    middle = np.array(shapely.minimum_bounding_circle(whole).centroid.coords[0] if pivot is None else pivot)
    edges -= np.tile(middle, 2)
    radius = float(np.hypot(edges[:, 0], edges[:, 1]).max())
    corners = np.column_stack([edges[:, :2], np.zeros(len(edges))])
    probes = np.vstack([_discs(shape, middle), corners])
    away = np.hypot(probes[:, 0], probes[:, 1])
    seeds = np.array([part.exterior.coords[0] for part in shapely.get_parts(whole)]) - middle
    return MovingBody(
        with_normals(edges), np.ascontiguousarray(np.column_stack([probes, away])), radius, -middle, seeds
    )


def _discs(shape: Any, middle: Floats) -> Floats:
    """Discs within the shape that cover most of it, the greatest first: (k, 3) rows x, y, r about the middle.

    Of the places on a grid the one with the most room is taken, then the next that is not near one taken before.
    """
    x0, y0, x1, y1 = shape.bounds
    step = max(x1 - x0, y1 - y0) / GRID
    x, y = np.meshgrid(np.arange(x0 + step / 2, x1, step), np.arange(y0 + step / 2, y1, step))
    best = shapely.maximum_inscribed_circle(shape).coords[0] if shape.geom_type == "Polygon" else (x0, y0)
    places = np.vstack([[best], np.column_stack([x.ravel(), y.ravel()])])
    points = shapely.points(places)
    room = np.where(shapely.contains(shape, points), shapely.distance(shape.boundary, points), 0.0)
    taken: list[int] = []
    for n in np.argsort(-room, kind="stable"):
        near = any(math.dist(places[n], places[m]) < 0.75 * room[m] for m in taken)
        if room[n] > 0.0 and not near:
            taken.append(int(n))
        if len(taken) == DISCS:
            break
    return np.column_stack([places[taken] - middle, room[taken]])


def centre_pose(mover: MovingBody, pose: Pose) -> Floats:
    """The pose of the enclosing circle's centre, (x, y, radians), when the reference point is at a pose."""
    angle = math.radians(pose.degrees)
    c, s = math.cos(angle), math.sin(angle)
    ox, oy = mover.reference
    return np.array([pose.x - c * ox + s * oy, pose.y - s * ox - c * oy, angle])


def reference_pose(mover: MovingBody, pose: Floats) -> Pose:
    """The pose of the reference point when the centre's is (x, y, radians)."""
    x, y, angle = (float(v) for v in pose)
    c, s = math.cos(angle), math.sin(angle)
    ox, oy = mover.reference
    return Pose(float(x + c * ox - s * oy), float(y + s * ox + c * oy), math.degrees(angle))
