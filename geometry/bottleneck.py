"""Where a body cannot pass, and by how much: the neck that stops it, and how much wider it would have to be.

# Strategy: the disc that fits in the body has a way to the goal. Its narrowest place near the pose nearest to the goal
# that the search got to is the neck. The walls are then moved apart across the neck, along the
# line between its two sides alone, until the body passes: what it takes is what is missing.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
import shapely
from shapely import affinity

from geometry.floor import Floor

Floats = npt.NDArray[np.float64]
CLOSE = 0.02  # squares: to which the missing width is found
SHIFTS = 9  # copies of the free space that stand for moving a wall
LOOK = 2.5  # radii of the body: how far from where it is stuck the neck is looked for


@dataclass(frozen=True)
class Neck:
    """A locally narrowest place between obstacles.

    place : (x, y), its middle. sides : the two points (x, y) of the obstacles that make it. width : between them.
    """

    place: tuple[float, float]
    sides: tuple[tuple[float, float], tuple[float, float]]
    width: float


def neck_near(
    floor: Floor, ways: Floats, start: tuple[float, float], stuck: tuple[float, float], radius: float
) -> Neck | None:
    """The narrowest place on a disc's way, not further than LOOK radii from where a body is stuck; None without walls.

    ways : (rows, columns) what is left to go from every pixel of the floor's raster. start : where the way begins.
    """
    track = _descent(floor, ways, start)
    centres = floor.frame[:2] + (track[:, ::-1] + 0.5) * floor.frame[2]
    near = np.hypot(*(centres - np.array(stuck)).T) <= LOOK * radius
    if not near.any():
        near[:] = True
    room = np.where(near, floor.raster[track[:, 0], track[:, 1]], np.inf)
    x, y = centres[int(np.argmin(room))]
    return _neck_at(floor, (float(x), float(y)))


def _descent(floor: Floor, ways: Floats, start: tuple[float, float]) -> npt.NDArray[np.intp]:
    """The pixels (n, 2) row, column from a place downhill to the goal."""
    rows, columns = ways.shape
    column, row = ((np.array(start) - floor.frame[:2]) / floor.frame[2]).astype(int)
    row, column = min(max(int(row), 0), rows - 1), min(max(int(column), 0), columns - 1)
    track = [(row, column)]
    while ways[row, column] > 0.0:
        window = ways[max(row - 1, 0) : row + 2, max(column - 1, 0) : column + 2]
        down, along = np.unravel_index(int(np.argmin(window)), window.shape)
        step = (max(row - 1, 0) + int(down), max(column - 1, 0) + int(along))
        if step == (row, column):
            break
        row, column = step
        track.append(step)
    return np.array(track)


def _neck_at(floor: Floor, place: tuple[float, float]) -> Neck | None:
    """The neck about a place: from the nearest point of an obstacle to the nearest on the other side, made straight."""
    solid = shapely.union_all(floor.polygons)
    here = np.array(place)
    sides: list[Floats] = []
    for _ in range(3):
        if solid.is_empty or solid.contains(shapely.Point(here)):
            break
        near = _nearest(here, solid)
        if near is None:
            break
        far = _nearest(here, solid.intersection(_beyond(here, here - near, 4 * floor.side)))
        if far is None:
            break
        sides = [near, far]
        here = (near + far) / 2
    if not sides:
        return None
    (ax, ay), (bx, by) = sides
    width = math.hypot(bx - ax, by - ay)
    return Neck((float(here[0]), float(here[1])), ((float(ax), float(ay)), (float(bx), float(by))), width)


def _nearest(here: Floats, solid: Any) -> Floats | None:
    """The point of a geometry that is nearest to a place; None when it is empty."""
    line = shapely.shortest_line(shapely.Point(here), solid)
    return None if line is None or line.is_empty else np.array(line.coords[1])


def _beyond(here: Floats, ahead: Floats, far: float) -> Any:
    """The half-plane, cut off far away, of what lies ahead of a place."""
    unit = ahead / max(float(np.hypot(*ahead)), 1e-12)
    across = np.array([-unit[1], unit[0]]) * far
    base = here + 1e-6 * unit
    return shapely.Polygon([base - across, base - across + far * unit, base + across + far * unit, base + across])


def widened(solid: Any, neck: Neck, extra: float, reach: float) -> Any:
    """The obstacles with the two sides of a neck moved apart by `extra`, within `reach` of it."""
    window = shapely.Point(neck.place).buffer(reach)
    free = window.difference(solid)
    (ax, ay), (bx, by) = neck.sides
    length = max(neck.width, 1e-9)
    dx, dy = (bx - ax) / length * extra / 2, (by - ay) / length * extra / 2
    copies = [affinity.translate(free, dx * t, dy * t) for t in np.linspace(-1, 1, SHIFTS)]
    return solid.difference(shapely.union_all(copies).intersection(window))


def missing_width(solid: Any, neck: Neck, radius: float, passes: Callable[[Any], bool]) -> float:
    """How much wider a neck must be, in squares, for a body of some radius to pass; inf when that is not enough.

    passes : whether the body can be moved when the obstacles are these.
    """
    low, high = 0.0, max(2.2 * radius - neck.width, 4 * CLOSE)
    reach = neck.width + 2 * radius + high
    if not passes(widened(solid, neck, high, reach)):
        return math.inf
    while high - low > CLOSE:
        middle = (low + high) / 2
        if passes(widened(solid, neck, middle, reach)):
            high = middle
        else:
            low = middle
    return (low + high) / 2
