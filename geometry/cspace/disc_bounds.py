"""A body between two discs: what decides its motion where it is too small beside the floor for cells.

# Strategy: where its greatest inscribed disc cannot get from start to goal the body cannot either, whatever its shape;
where the disc that encloses it can, so can the body, without turning on its way. Both are questions about a point among
obstacles grown by a radius. Grown corners are round; polygons stand for them, inside for the first, about for the
second.
"""

import heapq
import math
from typing import Any

import numpy as np
import shapely

from geometry.kernels.arrays import Floats
from geometry.motion.validation import FURTHEST

Place = tuple[float, float]
FLESH = 1e-7  # squares by which the inscribed disc is taken to be smaller, for bodies may touch
QUARTER = 4  # sides of the polygon that stands for a quarter of a circle
CORNERS = 400  # of the grown obstacles at most, for a way to be looked for: every two are held against each other


def grown(obstacles: Any, radius: float, about: bool) -> Any:
    """Return obstacles grown by a radius; about : never less than that, else never more."""
    times = 1.0 / math.cos(math.pi / (4 * QUARTER)) if about else 1.0
    return shapely.buffer(obstacles, max(radius, 0.0) * times, quad_segs=QUARTER)


def cannot_pass(obstacles: Any, radius: float, bounds: Floats, start: Place, goal: Any) -> bool:
    """Return whether a disc surely cannot get from a place into a goal, a geometry.

    bounds : (4,) x0, y0, x1, y1, that its centre cannot leave.
    """
    room = shapely.box(*bounds).difference(grown(obstacles, radius - FLESH, about=False))
    own = [part for part in shapely.get_parts(room) if part.distance(shapely.Point(start)) <= FLESH]
    return bool(own) and all(part.distance(goal) > FLESH for part in own)


def way_of_disc(obstacles: Any, radius: float, bounds: Floats, start: Place, goal: Place) -> list[Place] | None:
    """Return the corners of a way of a disc's centre; None when none is found, which proves nothing."""
    room = shapely.box(*bounds).difference(grown(obstacles, radius, about=True))
    for part in shapely.get_parts(room):
        if part.covers(shapely.Point(start)) and part.covers(shapely.Point(goal)):
            return shortest_within(part, start, goal)
    return None


def shortest_within(part: Any, start: Place, goal: Place) -> list[Place] | None:
    """Return the shortest way within a polygon over its corners; None when it has too many."""
    corners = sorted({(x, y) for x, y in shapely.get_coordinates(part).tolist()} - {start, goal})
    if len(corners) > CORNERS:
        return None
    places = [start, *corners, goal]
    spots, cover = np.array(places), part.buffer(FLESH / 10)
    shapely.prepare(cover)
    best, came, done = {0: 0.0}, {0: 0}, set()
    heap = [(0.0, 0)]
    while heap:
        length, at = heapq.heappop(heap)
        if at == len(places) - 1:
            way = [at]
            while way[-1]:
                way.append(came[way[-1]])
            return [places[n] for n in reversed(way)]
        if at in done:
            continue
        done.add(at)
        steps = np.hypot(*(spots - spots[at]).T)
        others = [n for n in range(1, len(places)) if length + steps[n] < best.get(n, FURTHEST)]
        lines = shapely.linestrings([[places[at], places[n]] for n in others]) if others else []
        for n, open_ in zip(others, shapely.covers(cover, lines), strict=True):
            if open_:
                best[n], came[n] = float(length + steps[n]), at
                heapq.heappush(heap, (best[n], n))
    return None
