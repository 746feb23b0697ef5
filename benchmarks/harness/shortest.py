"""The length of the shortest walk for a point that knows everything, by an exact visibility graph with shapely.

It shares no code with geometry/, which it serves to measure.
"""

import math
from itertools import pairwise
from typing import NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely import LineString, Point
from shapely.geometry.base import BaseGeometry

SIGHT_TOLERANCE = 1e-7  # squares: a line of sight may touch walls
UNREACHABLE = math.inf

Points = NDArray[np.float64]


class Sight(NamedTuple):
    """A visibility graph: points (n, 2), the start first, then reflex corners; lengths (n, n), inf where hidden."""

    free: BaseGeometry
    points: Points
    lengths: NDArray[np.float64]


def free_space(floor: BaseGeometry, things: list[BaseGeometry], start: Point) -> BaseGeometry:
    """Return the part of the floor without the objects that holds the start; empty when no part does."""
    free = floor.difference(shapely.union_all(things)) if things else floor
    parts = shapely.orient_polygons(shapely.get_parts(free))
    return next((part for part in parts if part.covers(start)), shapely.Polygon())


def reflex_corners(free: BaseGeometry) -> Points:
    """Return the corners of an oriented polygon around which a shortest way may bend, (n, 2)."""
    found = []
    for ring in (free.exterior, *free.interiors):
        points = np.asarray(ring.coords)[:-1]
        before, after = points - np.roll(points, 1, axis=0), np.roll(points, -1, axis=0) - points
        turn = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
        found.append(points[turn < 0])
    return np.concatenate(found)


def visibility(free: BaseGeometry, start: Point) -> Sight:
    """Return the visibility graph of a free space (one oriented polygon) with a start."""
    points = np.concatenate([[[start.x, start.y]], reflex_corners(free)])
    one, other = np.triu_indices(len(points), 1)
    lengths = np.full((len(points), len(points)), UNREACHABLE)
    seen = _visible(free, points[one], points[other])
    distance = np.hypot(*(points[one] - points[other]).T)
    lengths[one[seen], other[seen]] = lengths[other[seen], one[seen]] = distance[seen]
    return Sight(free, points, lengths)


def shortest_way(free: BaseGeometry, start: Point, goal: BaseGeometry) -> float:
    """Return the length of the shortest way from the start to the nearest point of a region; inf when there is none.

    From each corner the last leg goes to the nearest point of one of the region's edges. If that were hidden, the leg
    would touch another corner first.
    """
    region = goal.intersection(free)
    if region.is_empty:
        return UNREACHABLE
    if region.covers(start):
        return 0.0
    sight = visibility(free, start)
    reached = distances(sight.lengths, 0)
    corners, ends = _feet(sight.points, region)
    seen = _visible(free, sight.points[corners], ends)
    legs = np.hypot(*(sight.points[corners] - ends).T)
    return float(np.min(np.where(seen, reached[corners] + legs, UNREACHABLE), initial=UNREACHABLE))


def shortest_loop(free: BaseGeometry, start: Point, about: Point) -> float:
    """Return the length of the shortest closed way from the start once around a point in an obstacle; inf for none."""
    sight = visibility(free, start)
    n = len(sight.points)
    crossing = _crossings(sight.points, about)
    lifted = np.full((3 * n, 3 * n), UNREACHABLE)  # a block for each of -1, 0 and 1 windings
    for level in range(3):
        for step in (-1, 0, 1):
            if 0 <= level + step < 3:
                block = np.where(crossing == step, sight.lengths, UNREACHABLE)
                lifted[level * n : (level + 1) * n, (level + step) * n : (level + step + 1) * n] = block
    reached = distances(lifted, n)
    return float(min(reached[0], reached[2 * n]))


def distances(lengths: NDArray[np.float64], source: int) -> NDArray[np.float64]:
    """Compute Dijkstra's distances from one point of a dense graph (n, n) to all, (n,)."""
    best = np.full(len(lengths), UNREACHABLE)
    best[source] = 0.0
    open_ = np.ones(len(lengths), bool)
    while open_.any():
        at = int(np.argmin(np.where(open_, best, UNREACHABLE)))
        if not open_[at] or best[at] == UNREACHABLE:
            break
        open_[at] = False
        best = np.minimum(best, best[at] + lengths[at])
    return best


def _visible(free: BaseGeometry, one: Points, other: Points) -> NDArray[np.bool_]:
    wide = free.buffer(SIGHT_TOLERANCE, join_style="mitre")
    shapely.prepare(wide)
    return np.asarray(shapely.covers(wide, shapely.linestrings(np.stack([one, other], axis=1))))


def _feet(points: Points, region: BaseGeometry) -> tuple[NDArray[np.intp], Points]:
    """Return for each point and each edge of a region the point's index and the nearest place of the edge."""
    edges = [(a, b) for part in shapely.get_parts(region) for ring in _lines(part) for a, b in pairwise(ring)]
    a, b = np.array([edge[0] for edge in edges]), np.array([edge[1] for edge in edges])
    along = b - a
    square = np.maximum((along**2).sum(1), 1e-18)
    t = np.clip(((points[:, None] - a) * along).sum(2) / square, 0.0, 1.0)
    feet = a + t[..., None] * along
    corners = np.repeat(np.arange(len(points)), len(edges))
    return corners, feet.reshape(-1, 2)


def _lines(part: BaseGeometry) -> list[Points]:
    if isinstance(part, Point):
        return [np.array([part.coords[0], part.coords[0]])]
    if isinstance(part, LineString):
        return [np.asarray(part.coords)]
    return [np.asarray(ring.coords) for ring in (part.exterior, *part.interiors)]


def _crossings(points: Points, about: Point) -> NDArray[np.int_]:
    """Return the sense (1, -1, 0 for none) in which ways between points cross the ray east of `about`, (n, n)."""
    x, y = points[:, 0] - about.x, points[:, 1] - about.y
    up = (y[:, None] <= 0) & (y[None] > 0)
    down = (y[None] <= 0) & (y[:, None] > 0)
    turn = x[:, None] * y[None] - x[None] * y[:, None]
    return np.asarray((up & (turn > 0)).astype(int) - (down & (turn < 0)).astype(int))
