"""A body made ready to be moved: its edges about the centre that it is turned about, with discs inscribed in it."""

import math
from collections.abc import Iterable
from functools import lru_cache
from typing import Any

import numpy as np
import shapely

from utak.geometry.kernels.arrays import XY, Floats
from utak.geometry.motion.cell_clearance import MovingBody
from utak.geometry.motion.first_contact import boundary_edges, with_normals
from utak.geometry.motion.se2 import Pose
from utak.geometry.motion.validation import require_bounded, valid_polygons

MAX_DISCS = 16  # inscribed discs of a body at most; tuned on random worlds (benchmarks.campaign)
CANDIDATES_PER_SIDE = 16  # candidate disc centres along the longer side of a body's bounding box; tuned likewise
POINT_HALF_DIAGONAL = 1e-3  # squares: half the diagonal of the square that stands for a point; a convention


def new_moving_body(
    shape: Any, points: Iterable[tuple[float, float]] = (), pivot: tuple[float, float] | None = None
) -> MovingBody:
    """Return a body for planning, made from its shape and from points that move with it."""
    at = None if pivot is None else (float(pivot[0]), float(pivot[1]))
    specks = tuple((float(x), float(y)) for x, y in points)
    require_bounded([*specks, *([] if at is None else [at])], "points and pivot")
    # Normalised, so that the cache knows a shape again when its rings start elsewhere or come in another order.
    normalised = shapely.normalize(shapely.simplify(valid_polygons(shape, "the body"), 0))
    return _moving_body(shapely.to_wkb(normalised), specks, at)


@lru_cache(maxsize=32)
def _moving_body(wkb: bytes, points: tuple[XY, ...], pivot: XY | None) -> MovingBody:
    """Return the body of a polygon in WKB, cached: one body is planned for many times. Nothing writes to its arrays."""
    shape = shapely.from_wkb(wkb)
    specks = [shapely.Point(p).buffer(POINT_HALF_DIAGONAL, quad_segs=1) for p in points]
    whole = shapely.union_all([shape, *specks]) if specks else shape
    if whole is None or not len(edges := boundary_edges(whole)):
        raise ValueError("the body has no area")
    centre = np.array(shapely.minimum_bounding_circle(whole).centroid.coords[0] if pivot is None else pivot)
    edges -= np.tile(centre, 2)
    radius = float(np.hypot(edges[:, 0], edges[:, 1]).max())
    corners = np.column_stack([edges[:, :2], np.zeros(len(edges))])
    probes = np.vstack([_inscribed_discs(shape, centre), corners])
    away = np.hypot(probes[:, 0], probes[:, 1])
    seeds = np.array([part.exterior.coords[0] for part in shapely.get_parts(whole)]) - centre
    return MovingBody(
        with_normals(edges), np.ascontiguousarray(np.column_stack([probes, away])), radius, -centre, seeds
    )


def _inscribed_discs(shape: Any, centre: Floats) -> Floats:
    """Return discs within a shape that cover most of it, the largest first."""
    x0, y0, x1, y1 = shape.bounds
    step = max(x1 - x0, y1 - y0) / CANDIDATES_PER_SIDE
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
        if len(taken) == MAX_DISCS:
            break
    return np.column_stack([places[taken] - centre, room[taken]])


def centre_pose(body: MovingBody, pose: Pose) -> Floats:
    """Return the pose of the body's centre (it turns about it) when its reference point is at `pose`."""
    angle = math.radians(pose.degrees)
    c, s = math.cos(angle), math.sin(angle)
    ox, oy = body.reference
    return np.array([pose.x - c * ox + s * oy, pose.y - s * ox - c * oy, angle])
