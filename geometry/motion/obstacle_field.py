"""A floor prepared for many motions: obstacles as one, a raster of distances to them, and which of them are near where.

All that does not depend on the body is made once; what depends on its radius is kept by radius. Kernels are plain loops
for numba.
"""

import heapq
import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
import shapely

from geometry.kernels.arrays import Floats, Longs
from geometry.kernels.bucket_queue import Queue, new_queue, put, take
from geometry.kernels.jit import bare, compiled
from geometry.motion.body import centre_pose
from geometry.motion.cell_clearance import MovingBody, NearbyEdges, distance_at, inside, point_to_edge
from geometry.motion.first_contact import Obstacles
from geometry.motion.se2 import Pose
from geometry.motion.validation import FURTHEST, sound

PIXELS = 128  # along the longer side of the raster
BLOCK = 8  # pixels along the side of a block
RIM = 0.1  # of the longer side, around the bounds
TOUCH = 1e-6  # squares: a start or goal may be this deep in an obstacle, or out of bounds
SIDE, DIAGONAL = 10, 14  # the cost of a pixel's way
FAR = 2**40  # dearer than any
WALL = 60  # going through pixels where the disc does not fit, but for a slot in them, looks so much dearer


class ObstacleField:
    """Obstacles and bounds, prepared once for many calls of plan_motion.

    Parameters
    ----------
    obstacles : shapely geometry or a sequence of them, squares, table frame. Only polygons count.
    bounds : (x0, y0, x1, y1) of the body's reference point; None for the box around the obstacles.
    """

    def __init__(self, obstacles: Any, bounds: Sequence[float] | None = None) -> None:
        several = list(obstacles) if isinstance(obstacles, list | tuple) else [obstacles]
        self.polygons = [part for each in several for part in shapely.get_parts(sound(each, "obstacles"))]
        if bounds is None:
            bounds = shapely.total_bounds(self.polygons).tolist() if self.polygons else None
        if bounds is None or len(bounds) != 4 or not (np.abs(bounds) <= FURTHEST).all():
            raise ValueError(f"bounds must be four finite numbers of at most {FURTHEST:g}, not {bounds}")
        if bounds[2] <= bounds[0] or bounds[3] <= bounds[1]:
            raise ValueError(f"bounds must be x0 < x1, y0 < y1, not {bounds}")
        self.bounds = np.array(bounds, dtype=float)
        self.surface = Obstacles(self.polygons).point_surface
        self.side = float(max(self.bounds[2:] - self.bounds[:2]))
        pixel = self.side * (1 + 2 * RIM) / PIXELS
        corner = self.bounds[:2] - RIM * self.side
        columns, rows = np.ceil((self.bounds[2:] - self.bounds[:2] + 2 * RIM * self.side) / pixel).astype(int)
        self.frame = np.array([corner[0], corner[1], pixel])
        self.raster = np.empty((int(rows), int(columns)))
        _measure(self.surface.hull, self.frame, self.raster)
        self._grounds: dict[float, NearbyEdges] = {}
        self._around: dict[bytes, ObstacleField] = {}

    def finer(self, times: int) -> tuple[Floats, Floats]:
        """The frame and the raster with pixels of which so many make the side of one."""
        frame = self.frame * np.array([1.0, 1.0, 1.0 / times])
        raster = np.empty((times * self.raster.shape[0], times * self.raster.shape[1]))
        _measure(self.surface.hull, frame, raster)
        return frame, raster

    def ground(self, mover: MovingBody) -> NearbyEdges:
        """What the kernels need to know of the floor for a body of this radius."""
        if mover.radius not in self._grounds:
            self._grounds[mover.radius] = self._prepare(mover.radius)
        return self._grounds[mover.radius]

    def around(self, polygon: Any) -> "ObstacleField":
        """The floor on which all but a polygon is an obstacle: where a body is free it is within the polygon."""
        key = shapely.to_wkb(polygon)
        if key not in self._around:
            outer = shapely.box(*self.bounds).buffer(self.side, join_style="mitre")
            for part in shapely.get_parts(polygon):
                outer = outer.difference(part)
            self._around[key] = ObstacleField(outer, self.bounds.tolist())
        return self._around[key]

    def _prepare(self, radius: float) -> NearbyEdges:
        rows, columns = self.raster.shape
        down, across = math.ceil(rows / BLOCK), math.ceil(columns / BLOCK)
        first, near = _blocks(self.surface.hull, self.frame, down, across, 2 * radius)
        blocks = np.array([across, BLOCK])
        return NearbyEdges(self.surface.hull, self.raster, self.frame, first, near, blocks, radius, self.bounds)

    def has_room(self, mover: MovingBody, shape: Any, points: Sequence[tuple[float, float]], pose: Pose) -> bool:
        """Whether a body at a pose of its reference point is within bounds and at most touches obstacles.

        mover : the same shape and points, ready to be moved. Only what may touch needs the shape itself looked at.
        """
        x0, y0, x1, y1 = self.bounds
        if not (x0 - TOUCH <= pose.x <= x1 + TOUCH and y0 - TOUCH <= pose.y <= y1 + TOUCH):
            return False
        x, y, angle = centre_pose(mover, pose).tolist()
        if distance_at(mover, self.ground(mover), x, y, math.cos(angle), math.sin(angle)) > TOUCH:
            return True
        body = shapely.buffer(pose.place(shape), -TOUCH, join_style="mitre")
        specks = [pose.place(shapely.Point(p)) for p in points]
        if shapely.intersects(self.polygons, body).any():
            return False
        deep = [shapely.buffer(polygon, -TOUCH, join_style="mitre") for polygon in self.polygons] if specks else []
        return not any(polygon.intersects(speck) for polygon in deep for speck in specks)

    def ways(self, goals: npt.NDArray[np.bool_], radius: float) -> Floats:
        """How far it is from every pixel to the nearest goal pixel for a disc: (rows, columns). A guess, never inf."""
        ways: Floats = disc_ways(self.raster < radius - self.frame[2], goals) * (self.frame[2] / SIDE)
        return ways

    def pixel_of(self, x: float, y: float) -> npt.NDArray[np.bool_]:
        """The raster with one pixel True: the one of a place."""
        goals = np.zeros(self.raster.shape, bool)
        column, row = ((np.array([x, y]) - self.frame[:2]) / self.frame[2]).astype(int)
        goals[min(max(row, 0), len(goals) - 1), min(max(column, 0), goals.shape[1] - 1)] = True
        return goals


@bare
def _measure(edges: Floats, frame: Floats, raster: Floats) -> None:
    """Fill a raster with the signed distance to the obstacles at every pixel's centre."""
    for row in range(raster.shape[0]):
        y = frame[1] + (row + 0.5) * frame[2]
        for column in range(raster.shape[1]):
            x = frame[0] + (column + 0.5) * frame[2]
            best = 1e12
            for j in range(len(edges)):
                best = min(best, point_to_edge(x, y, edges, j))
            raster[row, column] = -math.sqrt(best) if inside(x, y, edges) else math.sqrt(best)


@compiled
def _blocks(edges: Floats, frame: Floats, rows: int, columns: int, reach: float) -> tuple[Longs, Longs]:
    """For each block of pixels the edges within reach of a place in it: (blocks + 1,) where each list begins, lists."""
    first = np.zeros(rows * columns + 1, np.int64)
    near = np.empty(rows * columns * max(len(edges), 1), np.int64)
    size = frame[2] * BLOCK
    count = 0
    for block in range(rows * columns):
        x = frame[0] + (block % columns + 0.5) * size
        y = frame[1] + (block // columns + 0.5) * size
        for j in range(len(edges)):
            if point_to_edge(x, y, edges, j) <= (reach + 0.7072 * size) ** 2:
                near[count] = j
                count += 1
        first[block + 1] = count
    return first, near[:count].copy()


def disc_ways(tight: npt.NDArray[np.bool_], goals: npt.NDArray[np.bool_]) -> Longs:
    """Dijkstra's algorithm from the goal pixels over the eight neighbours, WALL times as dear where it is tight.

    Returns (rows, columns), in units of which SIDE make a pixel's way.
    """
    price = np.pad(np.where(tight, WALL, 1), 1)
    ways = np.pad(np.where(goals, 0, FAR), 1, constant_values=-1)
    _spread(price.reshape(-1), ways.reshape(-1), tight.shape[1] + 2, new_queue(8 * tight.size))
    return ways[1:-1, 1:-1]


@bare
def _spread(price: Longs, ways: Longs, width: int, queue: Queue) -> None:
    """Find the ways of all pixels, from those that are 0. The rim of pixels around them, all -1, leads nowhere."""
    for at in range(len(ways)):
        if ways[at] == 0:
            put(queue, 0, at)
    beside = (1, -1, width, -width, width + 1, width - 1, -width + 1, -width - 1)
    now = 0
    while queue.used[1] > 0:
        at = take(queue, now)
        if at < 0:
            now += 1
            continue
        if ways[at] != now:
            continue
        for k in range(8):
            other = at + beside[k]
            then = now + (SIDE if k < 4 else DIAGONAL) * price[other]
            if then < ways[other]:
                ways[other] = then
                put(queue, then, other)


@compiled
def cheapest(price: Floats, goals: npt.NDArray[np.bool_]) -> Floats:
    """Dijkstra's algorithm from the goal pixels over the eight neighbours. price : (rows, columns) to enter a pixel."""
    rows, columns = price.shape
    ways = np.full(rows * columns, 1e15)
    heap = [(0.0, 0)]
    heap.pop()
    for row in range(rows):
        for column in range(columns):
            if goals[row, column]:
                ways[row * columns + column] = 0.0
                heapq.heappush(heap, (0.0, row * columns + column))
    while len(heap) > 0:
        way, at = heapq.heappop(heap)
        if way > ways[at]:
            continue
        row, column = at // columns, at % columns
        for up in range(max(row - 1, 0), min(row + 2, rows)):
            for along in range(max(column - 1, 0), min(column + 2, columns)):
                step = price[up, along] * (1.4142135623730951 if up != row and along != column else 1.0)
                if way + step < ways[up * columns + along]:
                    ways[up * columns + along] = way + step
                    heapq.heappush(heap, (way + step, up * columns + along))
    return ways.reshape(rows, columns)
