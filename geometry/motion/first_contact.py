"""Exact first contact: how far a body can be pushed or turned among obstacles before it would enter one.

A body is a polygon, a point (such as Utak), or both as one rigid thing. Its motion is a translation or a rotation about
a fixed point. Touching and sliding are allowed, entering is not, and nothing can be jumped over however long the motion
is.

# Strategy: the first contact of two polygons is a corner of one against an edge of the other. So the exact times at
# which corners of the body cross edges of the obstacles, and corners of the obstacles edges of the body, are all that
# is needed. A skin makes this robust: a motion is *stopped by* the obstacle drawn inward by SKIN_DEPTH, which a body
# that merely touches never meets. It is *stopped at* the true surface, at the moment the corner last crossed it. Flush
# contact, sliding along a wall and corners that graze each other need no special case, and rounding errors stay within
# the skin.
"""

import math
from collections.abc import Iterable, Sequence
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
import shapely

from utak.geometry.kernels.arrays import Floats
from utak.geometry.motion.se2 import Motion, Translate
from utak.geometry.motion.time_of_impact import (
    Surface,
    first_push_contact,
    first_turn_contact,
    is_push_clear,
    push_fractions,
)

SKIN_DEPTH = 1e-8  # squares: a body may be this deep in an obstacle before a motion further in is stopped; a convention
EDGES_PER_CHUNK = 4  # edges with one bounding box in the broad phase; tuned for speed (benchmarks.contact)
MIN_EDGE_LENGTH = 1e-7  # squares: shorter edges are left out; ten skin depths, lest the inward offset turns them over


NO_EDGES = np.empty((0, 7))


class ContactBody:
    """A rigid thing that moves: a polygon (or several), points, or all as one.

    Parameters
    ----------
    shape : shapely Polygon or MultiPolygon, or None. Squares, table frame, where it stands before a motion.
    points : (x, y) pairs in the same frame that move with it, such as Utak.

    Attributes
    ----------
    edges : (n, 7) float64 rows x0, y0, x1, y1, outward unit normal x and y, length, of the shape; (0, 7) without one.
    points : (n, 2) float64 x, y.
    runs : what the kernels are asked, one after another: tuples of corners (an array whose rows begin with x, y), edges
        (n, 7), and whether all obstacles count as one.
    """

    def __init__(self, shape: Any = None, points: Iterable[tuple[float, float]] = ()) -> None:
        edges = NO_EDGES if shape is None else with_normals(boundary_edges(shape))
        self._set_parts(edges, np.array([tuple(p) for p in points], dtype=float).reshape(-1, 2))

    def _set_parts(self, edges: Floats, points: Floats) -> None:
        """Set `edges` (n, 7), `points` (n, 2) and `runs` of this body; squares, table frame."""
        self.edges, self.points = edges, points
        solid = [(edges, edges, False)] if len(edges) else []
        loose = [(points, NO_EDGES, True), (points, NO_EDGES, False)] if len(points) else []
        self.runs: tuple[tuple[Floats, Floats, bool], ...] = (*solid, *loose)

    def after(self, motion: Motion) -> "ContactBody":
        """Return a new body, this one as it lies after the whole of a motion, whether or not that motion is free.

        Its edges (n, 7) and points (n, 2) are in squares, table frame, in the same order. `motion` : Translate or
        Rotate, table frame.
        """
        moved = ContactBody()
        edges = with_normals(motion.points(self.edges[:, :4].reshape(-1, 2)).reshape(-1, 4))
        moved._set_parts(edges, np.ascontiguousarray(motion.points(self.points)))
        return moved


class ObstaclePart(NamedTuple):
    """One obstacle, prepared to be put together with others."""

    polygon: Any  # shapely Polygon or MultiPolygon, squares, table frame
    edges: Floats  # (n, 7) its edges as rows x0, y0, x1, y1, outward unit normal x and y, length
    skin: Floats  # (n, 7) the same edges drawn inward by SKIN_DEPTH, row for row


def obstacle_part(polygon: Any) -> ObstaclePart:
    """Return a polygon prepared as an obstacle."""
    edges = with_normals(boundary_edges(polygon))
    return ObstaclePart(polygon, edges, _offset_inward(edges))


class Obstacles:
    """Standing polygons, prepared once for many motions among them.

    Parameters
    ----------
    polygons : shapely Polygons or MultiPolygons, holes allowed, squares, table frame; or parts made of such by
        `obstacle_part`, which spares their preparation. They may touch or overlap each other.

    Attributes
    ----------
    polygons : the same, as a tuple of polygons.
    surface : their edges and skins, each obstacle by itself; what a shape meets.
    """

    def __init__(self, polygons: Sequence[Any]) -> None:
        parts = [one if isinstance(one, ObstaclePart) else obstacle_part(one) for one in polygons]
        self.polygons = tuple(part.polygon for part in parts)
        edges = np.concatenate([NO_EDGES, *(part.edges for part in parts)])
        skin = np.concatenate([NO_EDGES, *(part.skin for part in parts)])
        self.surface = Surface(edges, skin, _chunks(edges), edges)

    @cached_property
    def point_surface(self) -> Surface:
        """Return the surface that a point meets: the skin of all obstacles as one, so that no point slips into a seam.

        A Surface holds edges as rows x0, y0, x1, y1, outward normal x and y, length: squares, table frame.

        Between two obstacles that stand flush the skins would leave a gap of 2 SKIN_DEPTH: enough for a point, for no
        body. Its `hull` and `skin` are those of the union; its `edges` those of the single obstacles.
        Computed at first use.
        """
        one = shapely.union_all([shapely.orient_polygons(p) for p in self.polygons], grid_size=SKIN_DEPTH / 10)
        hull = with_normals(boundary_edges(one))
        return Surface(hull, _offset_inward(hull), _chunks(hull), self.surface.edges)

    def first_contact(self, body: ContactBody, motion: Motion) -> float:
        """Return the part of a motion, 0 to 1, that a body travels before an obstacle stops it.

        Parameters
        ----------
        body : the body where it stands before the motion.
        motion : Translate or Rotate, table frame.

        Returns
        -------
        float : 1 when the whole motion is free. A body that touches at the start may slide along or leave (more than 0)
            and may not go in (0). It ends at most 1e-7 squares deep, or 3e-7 where points of the contours lie nearer
            to each other than that.

        Raises
        ------
        ValueError : a number of the motion is not finite.
        """
        if isinstance(motion, Translate):
            turn, x, y = 0.0, float(motion.dx), float(motion.dy)
        else:
            turn, x, y = math.radians(motion.degrees), float(motion.about[0]), float(motion.about[1])
        if not math.isfinite(turn + x + y):
            raise ValueError(f"a motion must be finite, not {motion}")
        fraction = 1.0
        for corners, edges, as_one in body.runs:
            if as_one and self._spares_union(corners, motion, x, y):
                continue
            surface = self.point_surface if as_one else self.surface
            if isinstance(motion, Translate):
                travelled = first_push_contact.call_unchecked(corners, edges, surface, x, y)
            else:
                travelled = first_turn_contact.call_unchecked(corners, edges, surface, turn, x, y)
            fraction = min(fraction, travelled)
        return fraction

    def _spares_union(self, points: Floats, motion: Motion, x: float, y: float) -> bool:
        """Return whether points surely meet nothing, so that `point_surface` need not be computed for them."""
        if "point_surface" in self.__dict__:
            return False
        if isinstance(motion, Translate):
            return is_push_clear.call_unchecked(points, self.surface.edges, x, y)
        return bool((points == (x, y)).all())

    def pushes(self, body: ContactBody, vectors: Floats) -> Floats:
        """Return the fractions travelled, 0 to 1, of many translations of one body from where it stands.

        Parameters
        ----------
        body : the body where it stands.
        vectors : (n, 2) translations dx, dy in squares, table frame; each from the same place.

        Returns
        -------
        (n,) float64; 1 where the whole translation is free, 0 where it is stopped at once.

        Raises
        ------
        ValueError : a number is not finite.
        """
        vectors = _finite(vectors)
        fractions = np.ones(len(vectors))
        for corners, edges, as_one in body.runs:
            surface = self.point_surface if as_one else self.surface
            fractions = np.minimum(fractions, push_fractions(corners, edges, surface, vectors))
        return fractions


def _finite(numbers: npt.ArrayLike) -> Floats:
    """Return numbers as a contiguous float64 array of the same shape, or raise ValueError when one is not finite."""
    array = np.ascontiguousarray(numbers, dtype=float)
    if not np.isfinite(array).all():
        raise ValueError("motions must be finite")
    return array


def boundary_edges(shape: Any) -> Floats:
    """Return the edges of a polygon's rings, with the interior on their left."""
    pieces = [np.empty((0, 4))]
    parts = [] if shape is None else shapely.get_parts(shapely.orient_polygons(shape))
    for part in parts:
        for ring in (part.exterior, *part.interiors) if part.geom_type == "Polygon" and not part.is_empty else ():
            pieces.append(_ring_edges(shapely.get_coordinates(ring)[:-1]))
    return np.concatenate(pieces)


def _ring_edges(points: Floats) -> Floats:
    """Return the edges of an open ring (n, 2), without points that are within MIN_EDGE_LENGTH of the one before."""
    step = np.hypot(*(points - np.roll(points, 1, axis=0)).T)
    if not (step > MIN_EDGE_LENGTH).all():
        points = _spaced(points)
    return np.hstack([points, np.roll(points, -1, axis=0)]) if len(points) > 1 else np.empty((0, 4))


def _spaced(points: Floats) -> Floats:
    """Return the points (m, 2) of an open ring (n, 2) without those within MIN_EDGE_LENGTH of the last one kept."""
    line = points.tolist()
    kept = line[:1]
    for point in line[1:]:
        if math.dist(point, kept[-1]) > MIN_EDGE_LENGTH:
            kept.append(point)
    while len(kept) > 1 and math.dist(kept[0], kept[-1]) <= MIN_EDGE_LENGTH:
        kept.pop()
    return np.array(kept)


def with_normals(edges: Floats) -> Floats:
    """Return edges (n, 4) with their normals: (n, 7) rows x0, y0, x1, y1, outward unit normal x and y, length."""
    # The interior lies on the left of an edge, so its outward normal points to the right. Edges must not be of length
    # 0.
    rows = np.empty((len(edges), 7))
    rows[:, :4] = edges[:, :4]
    along = edges[:, 2:4] - edges[:, :2]
    rows[:, 6] = np.hypot(along[:, 0], along[:, 1])
    rows[:, 4] = along[:, 1] / rows[:, 6]
    rows[:, 5] = -(along[:, 0] / rows[:, 6])
    return rows


def _offset_inward(edges: Floats) -> Floats:
    """Return edges (n, 7) of closed rings moved inward by SKIN_DEPTH, corners mitred, row for row."""
    shifted = edges.copy()
    next_edge = _next_on_ring(edges)
    normal, after = edges[:, 4:6], edges[next_edge, 4:6]
    mitre = -(normal + after) / np.maximum(1.0 + np.sum(normal * after, axis=1), 1e-3)[:, None]
    corner = edges[:, 2:4] + SKIN_DEPTH * mitre
    shifted[:, 2:4] = corner
    shifted[next_edge, 0:2] = corner
    shifted[:, 6] = np.hypot(shifted[:, 2] - shifted[:, 0], shifted[:, 3] - shifted[:, 1])
    return shifted


def _chunks(edges: Floats) -> Floats:
    """Return ranges of EDGES_PER_CHUNK edges and their bounding boxes: (k, 6) rows first, stop, x0, y0, x1, y1."""
    first = np.arange(0, len(edges), EDGES_PER_CHUNK)
    if len(first) == 0:
        return np.empty((0, 6))
    stop = np.minimum(first + EDGES_PER_CHUNK, len(edges))
    low = np.minimum.reduceat(np.minimum(edges[:, :2], edges[:, 2:4]), first)
    high = np.maximum.reduceat(np.maximum(edges[:, :2], edges[:, 2:4]), first)
    return np.column_stack([first, stop, low, high])


def _next_on_ring(edges: Floats) -> npt.NDArray[np.intp]:
    """Return for every row of `edges` (n, 7) the index of the next edge on its ring, (n,). Rings follow one another."""
    next_edge = np.arange(1, len(edges) + 1)
    start = 0
    for i in range(len(edges)):
        if edges[i, 2] == edges[start, 0] and edges[i, 3] == edges[start, 1]:
            next_edge[i] = start
            start = i + 1
    return next_edge
