"""Bounds by discs: they decide the motion of a body that is too small, compared to its surroundings, for cells.

# Strategy: where the body's largest inscribed disc cannot get from start to goal the body cannot either, whatever its
shape. Where its enclosing disc can, so can the body, without turning on its way. Both are questions about a point among
obstacles grown by a radius. Grown corners are round; polygons approximate them, from inside for the first question,
from outside for the second.
"""

import heapq
import math
from typing import Any

import numpy as np
import shapely

from utak.geometry.kernels.arrays import XY, Floats
from utak.geometry.motion.validation import MAX_COORDINATE

DISC_SHRINKAGE = 1e-7  # squares: the inscribed disc is taken to be smaller by this, for bodies may touch; a convention
SIDES_PER_QUARTER = 4  # sides of the polygon that approximates a quarter of a circle; a convention
MAX_PATH_CORNERS = 400  # corners of the free space up to which paths are sought; bounds a search over all pairs of them


def grow_obstacles(obstacles: Any, radius: float, outer: bool) -> Any:
    """Return obstacles grown by a radius, in squares: never less than that if `outer`, else never more."""
    times = 1.0 / math.cos(math.pi / (4 * SIDES_PER_QUARTER)) if outer else 1.0
    return shapely.buffer(obstacles, max(radius, 0.0) * times, quad_segs=SIDES_PER_QUARTER)


def disc_room(obstacles: Any, radius: float, bounds: Floats, start: XY) -> Any:
    """Return where the centre of a disc can be at most when it comes from a place: shapely geometry."""
    room = shapely.box(*bounds).difference(grow_obstacles(obstacles, radius - DISC_SHRINKAGE, outer=False))
    parts = [part for part in shapely.get_parts(room) if part.distance(shapely.Point(start)) <= DISC_SHRINKAGE]
    return shapely.MultiPolygon(parts)


def is_cut_off(room: Any, goal: Any) -> bool:
    """Return whether the centre of a disc surely cannot get to a goal; False proves nothing."""
    return not room.is_empty and bool(room.distance(goal) > DISC_SHRINKAGE)


def find_disc_path(obstacles: Any, radius: float, bounds: Floats, start: XY, goal: XY) -> list[XY] | None:
    """Return the corners of a path for the centre of a disc from `start` to `goal`, both among them, or None."""
    room = shapely.box(*bounds).difference(grow_obstacles(obstacles, radius, outer=True))
    for part in shapely.get_parts(room):
        if part.covers(shapely.Point(start)) and part.covers(shapely.Point(goal)):
            return shortest_path_within(part, start, goal)
    return None


def shortest_path_within(part: Any, start: XY, goal: XY) -> list[XY] | None:
    """Return the corners (x, y) of the shortest path within a polygon, from `start` to `goal`, both among them."""
    # None if the polygon has more than MAX_PATH_CORNERS corners, or if no path is found.
    corners = sorted({(x, y) for x, y in shapely.get_coordinates(part).tolist()} - {start, goal})
    if len(corners) > MAX_PATH_CORNERS:
        return None
    places = [start, *corners, goal]
    points, cover = np.array(places), part.buffer(DISC_SHRINKAGE / 10)
    shapely.prepare(cover)
    best, parent, done = {0: 0.0}, {0: 0}, set()
    heap = [(0.0, 0)]
    while heap:
        length, at = heapq.heappop(heap)
        if at == len(places) - 1:
            path = [at]
            while path[-1]:
                path.append(parent[path[-1]])
            return [places[n] for n in reversed(path)]
        if at in done:
            continue
        done.add(at)
        steps = np.hypot(*(points - points[at]).T)
        others = [n for n in range(1, len(places)) if length + steps[n] < best.get(n, MAX_COORDINATE)]
        lines = shapely.linestrings([[places[at], places[n]] for n in others]) if others else []
        for n, is_open in zip(others, shapely.covers(cover, lines), strict=True):
            if is_open:
                best[n], parent[n] = float(length + steps[n]), at
                heapq.heappush(heap, (best[n], n))
    return None
