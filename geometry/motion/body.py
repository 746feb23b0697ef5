"""A body made ready to be moved: its edges about the centre that it is turned about, with discs inscribed in it."""

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
from geometry.motion.validation import require_bounded, valid_polygons

MAX_DISCS = 16  # inscribed discs of a body at most; tuned on random worlds (benchmarks.campaign)
CANDIDATES_PER_SIDE = 16  # candidate disc centres along the longer side of a body's bounding box; tuned likewise
POINT_HALF_DIAGONAL = 1e-3  # squares: half the diagonal of the square that stands for a point; a convention


def new_moving_body(
    shape: Any, points: Iterable[tuple[float, float]] = (), pivot: tuple[float, float] | None = None
) -> MovingBody:
    """Return a body for planning, made from its shape and from points that move with it.

    Parameters
    ----------
    shape : shapely Polygon or MultiPolygon in squares, body frame: its reference point is the origin, not turned.
    points : (x, y) in the body frame, squares, that move rigidly with the shape and must not enter obstacles either.
    pivot : (x, y) in the body frame that the body is turned about. None stands for the centre of the smallest enclosing
        circle, where a turn moves the body least.

    Returns
    -------
    MovingBody : edges (m, 7) with outward normals, discs within it and its corners (k, 4), the radius of the circle
        about the pivot that encloses it, its reference point (2,) and one corner of each part; in squares, body frame
        shifted so that the pivot is the origin ("centre"). It is cached and shared: its arrays must not be written to.

    Raises
    ------
    ValueError : the shape has no area, or a number is not finite or too large.
    """
    at = None if pivot is None else (float(pivot[0]), float(pivot[1]))
    specks = tuple((float(x), float(y)) for x, y in points)
    require_bounded([*specks, *([] if at is None else [at])], "points and pivot")
    # Normalised, so that the cache knows a shape again when its rings start elsewhere or come in another order.
    normalised = shapely.normalize(shapely.simplify(valid_polygons(shape, "the body"), 0))
    return _moving_body(shapely.to_wkb(normalised), specks, at)


@lru_cache(maxsize=32)
def _moving_body(wkb: bytes, points: tuple[XY, ...], pivot: XY | None) -> MovingBody:
    """Return the body of a polygon in WKB, cached: one body is planned for many times. Nothing writes to its arrays.

    Parameters
    ----------
    wkb : well-known binary of a shapely Polygon or MultiPolygon, squares, body frame.
    points : (x, y) in that frame; each becomes a tiny square of half diagonal POINT_HALF_DIAGONAL.
    pivot : (x, y) in that frame to turn about; None for the centre of the smallest enclosing circle.

    Returns
    -------
    MovingBody : edges (m, 7), inscribed discs and corners (k, 4), enclosing radius, reference point (2,) and one corner
        of each part, in squares, body frame shifted so that the pivot is the origin.

    Raises
    ------
    ValueError : the polygon has no area.
    """
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
    """Return discs within a shape that cover most of it, the largest first.

    Method: of the candidates on a grid take the one with the most room, then the next that is not near a taken one.

    Parameters
    ----------
    shape : shapely Polygon or MultiPolygon, squares, body frame.
    centre : (2,) x, y in that frame that the result is relative to.

    Returns
    -------
    (k, 3) float64 rows x, y, r in squares, x and y relative to `centre`; k is at most MAX_DISCS.
    """
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
    """Return the pose of the body's centre, the point that it is turned about, when its reference point is at `pose`.

    Parameters
    ----------
    body : body made by new_moving_body.
    pose : pose of the reference point, table frame, squares and degrees.

    Returns
    -------
    (3,) float64: x, y of the centre in squares, table frame; angle in radians, counter-clockwise positive, the same
    angle as that of `pose`.
    """
    angle = math.radians(pose.degrees)
    c, s = math.cos(angle), math.sin(angle)
    ox, oy = body.reference
    return np.array([pose.x - c * ox + s * oy, pose.y - s * ox - c * oy, angle])
