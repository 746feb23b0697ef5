"""Exact first contact: how far a body can be pushed or turned among obstacles before it would go into one.

A body is a polygon, a point (Utak), or both as one rigid thing. Its motion is a translation or a rotation about a fixed
point. Touching and sliding are allowed, going in is not, and nothing can be jumped over however long the motion is.

# Strategy: the first contact of two polygons is a corner of one against an edge of the other, so the exact times at
# which corners of the body cross edges of the obstacles, and corners of the obstacles those of the body, are all.
# What makes this robust is a skin: a motion is *stopped by* the obstacle drawn in by SKIN, which a body that merely
# touches never meets, and is *stopped at* the true surface, at the moment the corner last crossed it. Flush contact,
# sliding along a wall and corners that graze each other need no special case, and rounding errors stay within the skin.
"""

import math
from collections.abc import Iterable, Sequence
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
import shapely

from geometry.kernels.arrays import Floats
from geometry.motion.se2 import Motion, Translate
from geometry.motion.time_of_impact import Surface, first_push, first_turn, many_pushes, many_turns

SKIN = 1e-8  # squares: a body may be this deep in an obstacle before a motion further in is stopped
CHUNK = 4  # edges that are looked at or left alone together
SHORT = 1e-7  # squares: points of a contour nearer to the one before are left out, for the skin would turn them over


class Contact(NamedTuple):
    """How far a motion went.

    Attributes
    ----------
    fraction : part of the motion that was travelled, 0 to 1; 1 when nothing stopped it.
    place : where it touches, (x, y) in the table frame after the motion; None when nothing stopped it.
    obstacle : index of the obstacle that stopped it; None likewise.
    normal : unit vector across the edges in contact, away from the obstacle; None likewise.
    """

    fraction: float
    place: tuple[float, float] | None = None
    obstacle: int | None = None
    normal: tuple[float, float] | None = None


UNSTOPPED = Contact(1.0)
NO_EDGES = np.empty((0, 7))


class ContactBody:
    """Something rigid that moves: a polygon (or several), points, or all as one.

    Parameters
    ----------
    shape : shapely Polygon or MultiPolygon, or None. Table frame, squares.
    points : (x, y) pairs that move with it, such as Utak.
    """

    def __init__(self, shape: Any = None, points: Iterable[tuple[float, float]] = ()) -> None:
        self._made_of(
            with_normals(boundary_edges(shape)), np.array([tuple(p) for p in points], dtype=float).reshape(-1, 2)
        )

    def _made_of(self, edges: Floats, points: Floats) -> None:
        """Keep edges (n, 7) and points (n, 2), and ``runs``: what the kernels are asked of them, one after another.

        A run is corners, edges, and whether it is against all obstacles as one. The shape meets them one by one, points
        all as one as well: in the seam of two flush obstacles, which is inside of both as one, only each by itself
        stops them.
        """
        self.edges, self.points = edges, points
        solid = [(edges, edges, False)] if len(edges) else []
        loose = [(points, NO_EDGES, True), (points, NO_EDGES, False)] if len(points) else []
        self.runs: tuple[tuple[Floats, Floats, bool], ...] = (*solid, *loose)

    def after(self, motion: Motion) -> "ContactBody":
        """The body after a motion."""
        moved = ContactBody()
        edges = with_normals(motion.points(self.edges[:, :4].reshape(-1, 2)).reshape(-1, 4))
        moved._made_of(edges, np.ascontiguousarray(motion.points(self.points)))
        return moved


class Obstacles:
    """Standing polygons, prepared once for many motions among them.

    Parameters
    ----------
    polygons : shapely Polygons or MultiPolygons, holes allowed, in squares, table frame. They may touch or overlap each
        other. The position in this sequence is the index that a Contact tells.
    """

    def __init__(self, polygons: Sequence[Any]) -> None:
        self.polygons = tuple(polygons)
        rings = [boundary_edges(polygon) for polygon in polygons]
        edges = with_normals(np.concatenate([np.empty((0, 4)), *rings]))
        owner = np.repeat(np.arange(len(rings)), [len(ring) for ring in rings])
        self.surface = Surface(edges, _drawn_in(edges, SKIN), _chunks(edges), edges, owner)

    @cached_property
    def point_surface(self) -> Surface:
        """The surface that a point meets: the skin of all obstacles as one, so that no point slips into a seam.

        Between two obstacles that stand flush the skins would leave a gap of 2 SKIN, enough for a point, for no body.
        """
        one = shapely.union_all([shapely.orient_polygons(p) for p in self.polygons], grid_size=SKIN / 10)
        hull = with_normals(boundary_edges(one))
        return Surface(hull, _drawn_in(hull, SKIN), _chunks(hull), self.surface.edges, self.surface.owner)

    def first_contact(self, body: ContactBody, motion: Motion) -> Contact:
        """Move a body until it would go into an obstacle.

        Returns
        -------
        Contact : fraction 1 when the whole motion is free. A body that touches at the start may slide along or leave
            (fraction above 0) and may not go in (fraction 0). It ends at most 1e-7 squares deep, or 3e-7 where points
            of the contours lie nearer to each other than that.

        Raises
        ------
        ValueError : when a number of the motion is not finite.
        """
        if isinstance(motion, Translate):
            turn, x, y = 0.0, float(motion.dx), float(motion.dy)
        else:
            turn, x, y = math.radians(motion.degrees), float(motion.about[0]), float(motion.about[1])
        if not math.isfinite(turn + x + y):
            raise ValueError(f"a motion must be finite, not {motion}")
        contact = UNSTOPPED
        for corners, edges, as_one in body.runs:
            surface = self.point_surface if as_one else self.surface
            if isinstance(motion, Translate):
                found = first_push.swift(corners, edges, surface, x, y)
            else:
                found = first_turn.swift(corners, edges, surface, turn, x, y)
            fraction, at_x, at_y, owner, nx, ny = found
            if owner >= 0 and fraction < contact.fraction:
                contact = Contact(fraction, (at_x, at_y), owner, (nx, ny))
        return contact

    def pushes(self, body: ContactBody, vectors: Floats) -> Floats:
        """Fractions travelled (n,) for many translations (n, 2) of one body from where it stands.

        Raises
        ------
        ValueError : when a number is not finite.
        """
        vectors = _finite(vectors)
        free = np.ones(len(vectors))
        for corners, edges, as_one in body.runs:
            surface = self.point_surface if as_one else self.surface
            free = np.minimum(free, many_pushes(corners, edges, surface, vectors))
        return free

    def turns(self, body: ContactBody, degrees: Floats, pivots: Floats) -> Floats:
        """Fractions travelled (n,) for many turns (n,), degrees, about pivots (n, 2) of one body from where it stands.

        Raises
        ------
        ValueError : when a number is not finite.
        """
        turns, pivots = np.radians(_finite(degrees)), _finite(pivots)
        free = np.ones(len(turns))
        for corners, edges, as_one in body.runs:
            surface = self.point_surface if as_one else self.surface
            free = np.minimum(free, many_turns(corners, edges, surface, turns, pivots))
        return free


def _finite(numbers: npt.ArrayLike) -> Floats:
    """An array of finite numbers, or an error."""
    array = np.ascontiguousarray(numbers, dtype=float)
    if not np.isfinite(array).all():
        raise ValueError("motions must be finite")
    return array


def boundary_edges(shape: Any) -> Floats:
    """The edges of a polygon as (n, 4) x0, y0, x1, y1 with the interior on their left; edges of no length left out."""
    pieces = [np.empty((0, 4))]
    parts = [] if shape is None else shapely.get_parts(shapely.orient_polygons(shape))
    for part in parts:
        for ring in (part.exterior, *part.interiors) if part.geom_type == "Polygon" and not part.is_empty else ():
            pieces.append(_ring_edges(shapely.get_coordinates(ring)[:-1]))
    return np.concatenate(pieces)


def _ring_edges(points: Floats) -> Floats:
    """The edges of one open ring (n, 2) through points none of which is within SHORT of the one before."""
    step = np.hypot(*(points - np.roll(points, 1, axis=0)).T)
    if not (step > SHORT).all():
        points = _spaced(points)
    return np.hstack([points, np.roll(points, -1, axis=0)]) if len(points) > 1 else np.empty((0, 4))


def _spaced(points: Floats) -> Floats:
    """The points of an open ring without those within SHORT of the last one kept: the ring moves by no more."""
    line = points.tolist()
    kept = line[:1]
    for point in line[1:]:
        if math.dist(point, kept[-1]) > SHORT:
            kept.append(point)
    while len(kept) > 1 and math.dist(kept[0], kept[-1]) <= SHORT:
        kept.pop()
    return np.array(kept)


def with_normals(edges: Floats) -> Floats:
    """Edges (n, 4) as (n, 7): x0, y0, x1, y1, outward unit normal (x, y), length."""
    along = edges[:, 2:4] - edges[:, :2]
    length = np.hypot(along[:, 0], along[:, 1])
    unit = along / length[:, None]
    return np.ascontiguousarray(np.column_stack([edges[:, :4], unit[:, 1], -unit[:, 0], length]))


def _drawn_in(edges: Floats, depth: float) -> Floats:
    """The edges of closed rings moved inward by a depth, corners mitred: (n, 7) like the edges themselves."""
    shifted = edges.copy()
    following = _following(edges)
    normal, after = edges[:, 4:6], edges[following, 4:6]
    mitre = -(normal + after) / np.maximum(1.0 + np.sum(normal * after, axis=1), 1e-3)[:, None]
    corner = edges[:, 2:4] + depth * mitre
    shifted[:, 2:4] = corner
    shifted[following, 0:2] = corner
    shifted[:, 6] = np.hypot(shifted[:, 2] - shifted[:, 0], shifted[:, 3] - shifted[:, 1])
    return shifted


def _chunks(edges: Floats) -> Floats:
    """Runs of CHUNK edges and the boxes around them: (k, 6) rows first, stop, x0, y0, x1, y1."""
    first = np.arange(0, len(edges), CHUNK)
    if len(first) == 0:
        return np.empty((0, 6))
    stop = np.minimum(first + CHUNK, len(edges))
    low = np.minimum.reduceat(np.minimum(edges[:, :2], edges[:, 2:4]), first)
    high = np.maximum.reduceat(np.maximum(edges[:, :2], edges[:, 2:4]), first)
    return np.column_stack([first, stop, low, high])


def _following(edges: Floats) -> npt.NDArray[np.intp]:
    """For every edge the index of the one that follows it on its ring. Rings lie one after another."""
    following = np.arange(1, len(edges) + 1)
    start = 0
    for i in range(len(edges)):
        if edges[i, 2] == edges[start, 0] and edges[i, 3] == edges[start, 1]:
            following[i] = start
            start = i + 1
    return following
