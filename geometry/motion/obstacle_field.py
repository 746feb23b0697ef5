"""An obstacle field: obstacles united and prepared once for many motions among them.

It holds the united boundary, a raster of signed distances to it, and for each block of pixels the edges near it. What
does not depend on the body is made once; what depends on its radius is kept by radius. Kernels are plain loops for
numba.
"""

import heapq
import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
import shapely

from utak.geometry.kernels.arrays import Floats, Longs
from utak.geometry.kernels.bucket_queue import Queue, new_queue, put, take
from utak.geometry.kernels.jit import bare, compiled
from utak.geometry.motion.body import centre_pose
from utak.geometry.motion.cell_clearance import MovingBody, NearbyEdges, clearance_at, squared_distance_to_edge
from utak.geometry.motion.first_contact import Obstacles
from utak.geometry.motion.se2 import Pose
from utak.geometry.motion.validation import MAX_COORDINATE, valid_polygons

RASTER_PIXELS = 128  # pixels along the longer side of the raster; tuned on random worlds (benchmarks.campaign)
BLOCK_PIXELS = 8  # pixels along the side of a block; tuned likewise
RASTER_MARGIN = 0.1  # width of the raster's rim around the bounds, as a part of their longer side; a convention
OVERLAP_TOLERANCE = 1e-6  # squares: a start or goal may be this deep in an obstacle, or out of bounds; a convention
PIXEL_STEP_COST, PIXEL_DIAGONAL_COST = 10, 14  # costs of a step to a neighbouring pixel; 14 / 10 approximates sqrt(2)
COST_NOT_REACHED = 2**40  # above every cost of a path
TIGHT_PIXEL_FACTOR = 60  # a step into a pixel where the disc does not fit costs so many times more; tuned likewise


class ObstacleField:
    """Obstacles and bounds, prepared once for many calls of plan_motion."""

    def __init__(self, obstacles: Any, bounds: Sequence[float] | None = None) -> None:
        several = list(obstacles) if isinstance(obstacles, list | tuple) else [obstacles]
        self.polygons = [part for each in several for part in shapely.get_parts(valid_polygons(each, "obstacles"))]
        if bounds is None:
            bounds = shapely.total_bounds(self.polygons).tolist() if self.polygons else None
        if bounds is None or len(bounds) != 4 or not (np.abs(bounds) <= MAX_COORDINATE).all():
            raise ValueError(f"bounds must be four finite numbers of at most {MAX_COORDINATE:g}, not {bounds}")
        if bounds[2] <= bounds[0] or bounds[3] <= bounds[1]:
            raise ValueError(f"bounds must be x0 < x1, y0 < y1, not {bounds}")
        self.bounds = np.array(bounds, dtype=float)
        self.surface = Obstacles(self.polygons).point_surface
        self.side = float(max(self.bounds[2:] - self.bounds[:2]))
        pixel = self.side * (1 + 2 * RASTER_MARGIN) / RASTER_PIXELS
        corner = self.bounds[:2] - RASTER_MARGIN * self.side
        columns, rows = np.ceil((self.bounds[2:] - self.bounds[:2] + 2 * RASTER_MARGIN * self.side) / pixel).astype(int)
        self.frame = np.array([corner[0], corner[1], pixel])
        self.raster = np.empty((int(rows), int(columns)))
        _fill_signed_distances(self.surface.hull, self.frame, self.raster)
        self._grounds: dict[float, NearbyEdges] = {}
        self._complements: dict[bytes, ObstacleField] = {}

    def finer_raster(self, times: int) -> tuple[Floats, Floats]:
        """Return (frame, raster) as of this field, with `times` pixels along each side of one of its pixels."""
        frame = self.frame * np.array([1.0, 1.0, 1.0 / times])
        raster = np.empty((times * self.raster.shape[0], times * self.raster.shape[1]))
        _fill_signed_distances(self.surface.hull, frame, raster)
        return frame, raster

    def ground(self, body: MovingBody) -> NearbyEdges:
        """Return the obstacle edges prepared for a body of this radius; made once for each radius."""
        if body.radius not in self._grounds:
            self._grounds[body.radius] = self._prepare(body.radius)
        return self._grounds[body.radius]

    def complement_of(self, polygon: Any) -> "ObstacleField":
        """Return the field in which all but `polygon` is an obstacle: a body free there lies within the polygon."""
        key = shapely.to_wkb(polygon)
        if key not in self._complements:
            outer = shapely.box(*self.bounds).buffer(self.side, join_style="mitre")
            for part in shapely.get_parts(polygon):
                outer = outer.difference(part)
            self._complements[key] = ObstacleField(outer, self.bounds.tolist())
        return self._complements[key]

    def _prepare(self, radius: float) -> NearbyEdges:
        """Return the obstacle edges, with a list for each block of pixels, for a body of a radius in squares."""
        rows, columns = self.raster.shape
        down, across = math.ceil(rows / BLOCK_PIXELS), math.ceil(columns / BLOCK_PIXELS)
        block_start, block_edges = _list_block_edges(self.surface.hull, self.frame, down, across, 2 * radius)
        blocks = np.array([across, BLOCK_PIXELS])
        return NearbyEdges(
            self.surface.hull, self.raster, self.frame, block_start, block_edges, blocks, radius, self.bounds
        )

    def is_free_at(self, body: MovingBody, shape: Any, points: Sequence[tuple[float, float]], pose: Pose) -> bool:
        """Return whether a body whose reference point is at `pose` is within bounds and at most touches obstacles."""
        x0, y0, x1, y1 = self.bounds
        if not (
            x0 - OVERLAP_TOLERANCE <= pose.x <= x1 + OVERLAP_TOLERANCE
            and y0 - OVERLAP_TOLERANCE <= pose.y <= y1 + OVERLAP_TOLERANCE
        ):
            return False
        x, y, angle = centre_pose(body, pose).tolist()
        if clearance_at(body, self.ground(body), x, y, math.cos(angle), math.sin(angle)) > OVERLAP_TOLERANCE:
            return True
        inner = shapely.buffer(pose.place(shape), -OVERLAP_TOLERANCE, join_style="mitre")
        points_placed = [pose.place(shapely.Point(p)) for p in points]
        if shapely.intersects(self.polygons, inner).any():
            return False
        deep = (
            [shapely.buffer(polygon, -OVERLAP_TOLERANCE, join_style="mitre") for polygon in self.polygons]
            if points_placed
            else []
        )
        return not any(polygon.intersects(speck) for polygon in deep for speck in points_placed)

    def disc_distances(self, goals: npt.NDArray[np.bool_], radius: float) -> Floats:
        """Return for every pixel the estimated length, in squares, of a disc's path to the nearest goal pixel."""
        unit = self.frame[2] / PIXEL_STEP_COST
        distances: Floats = disc_path_costs(self.raster < radius - self.frame[2], goals) * unit
        return distances

    def pixel_mask(self, x: float, y: float) -> npt.NDArray[np.bool_]:
        """Return a mask that is True at the one pixel of (x, y), or at the nearest pixel for a place off the raster."""
        goals = np.zeros(self.raster.shape, bool)
        column, row = ((np.array([x, y]) - self.frame[:2]) / self.frame[2]).astype(int)
        goals[min(max(row, 0), len(goals) - 1), min(max(column, 0), goals.shape[1] - 1)] = True
        return goals


@compiled
def _fill_signed_distances(edges: Floats, frame: Floats, raster: Floats) -> None:
    """Fill `raster` with the signed distance from every pixel's centre to the obstacles, negative inside."""
    rows, columns = raster.shape
    near, away = np.empty(len(edges), np.int64), np.empty(len(edges))
    reach = 0.7072 * frame[2] * BLOCK_PIXELS  # no pixel's centre is further from the middle of its block
    for first_row in range(0, rows, BLOCK_PIXELS):
        for first_column in range(0, columns, BLOCK_PIXELS):
            x = frame[0] + (first_column + 0.5 * BLOCK_PIXELS) * frame[2]
            y = frame[1] + (first_row + 0.5 * BLOCK_PIXELS) * frame[2]
            least = 1e12
            for j in range(len(edges)):
                away[j] = math.sqrt(squared_distance_to_edge(x, y, edges, j))
                least = min(least, away[j])
            count = 0
            for j in range(len(edges)):
                if away[j] <= least + 2.0 * reach:
                    near[count] = j
                    count += 1
            for row in range(first_row, min(first_row + BLOCK_PIXELS, rows)):
                y = frame[1] + (row + 0.5) * frame[2]
                for column in range(first_column, min(first_column + BLOCK_PIXELS, columns)):
                    x = frame[0] + (column + 0.5) * frame[2]
                    best = 1e12
                    for n in range(count):
                        best = min(best, squared_distance_to_edge(x, y, edges, near[n]))
                    raster[row, column] = math.sqrt(best)
    _negate_inside(edges, frame, raster)


@compiled
def _negate_inside(edges: Floats, frame: Floats, raster: Floats) -> None:
    """Make the distances of pixels inside obstacles negative, by the even-odd rule as in `is_inside`."""
    crossing = np.empty(len(edges))
    for row in range(raster.shape[0]):
        y = frame[1] + (row + 0.5) * frame[2]
        count = 0
        for j in range(len(edges)):
            y0, y1 = edges[j, 1], edges[j, 3]
            if (y0 > y) != (y1 > y):
                crossing[count] = edges[j, 0] + (y - y0) / (y1 - y0) * (edges[j, 2] - edges[j, 0])
                count += 1
        for column in range(raster.shape[1]):
            x = frame[0] + (column + 0.5) * frame[2]
            odd = False
            for n in range(count):
                if x < crossing[n]:
                    odd = not odd
            if odd:
                raster[row, column] = -raster[row, column]


@compiled
def _list_block_edges(edges: Floats, frame: Floats, rows: int, columns: int, reach: float) -> tuple[Longs, Longs]:
    """Return the edges within `reach` squares of each block of pixels, as (block_start, block_edges)."""
    block_start = np.zeros(rows * columns + 1, np.int64)
    block_edges = np.empty(rows * columns * max(len(edges), 1), np.int64)
    size = frame[2] * BLOCK_PIXELS
    count = 0
    for block in range(rows * columns):
        x = frame[0] + (block % columns + 0.5) * size
        y = frame[1] + (block // columns + 0.5) * size
        for j in range(len(edges)):
            if squared_distance_to_edge(x, y, edges, j) <= (reach + 0.7072 * size) ** 2:
                block_edges[count] = j
                count += 1
        block_start[block + 1] = count
    return block_start, block_edges[:count].copy()


def disc_path_costs(tight: npt.NDArray[np.bool_], goals: npt.NDArray[np.bool_]) -> Longs:
    """Return the cost of the cheapest 8-connected path from every pixel to a goal pixel (Dijkstra's algorithm)."""
    price = np.pad(np.where(tight, TIGHT_PIXEL_FACTOR, 1), 1)
    costs = np.pad(np.where(goals, 0, COST_NOT_REACHED), 1, constant_values=-1)
    _relax_all(price.reshape(-1), costs.reshape(-1), tight.shape[1] + 2, new_queue(8 * tight.size))
    return costs[1:-1, 1:-1]


@bare
def _relax_all(price: Longs, costs: Longs, width: int, queue: Queue) -> None:
    """Fill the costs of all pixels from those of cost 0. The rim of pixels around the raster, all -1, leads nowhere."""
    for at in range(len(costs)):
        if costs[at] == 0:
            put(queue, 0, at)
    neighbours = (1, -1, width, -width, width + 1, width - 1, -width + 1, -width - 1)
    now = 0
    while queue.used[1] > 0:
        at = take(queue, now)
        if at < 0:
            now += 1
            continue
        if costs[at] != now:
            continue
        for k in range(8):
            other = at + neighbours[k]
            then = now + (PIXEL_STEP_COST if k < 4 else PIXEL_DIAGONAL_COST) * price[other]
            if then < costs[other]:
                costs[other] = then
                put(queue, then, other)


@compiled
def cheapest_path_costs(price: Floats, goals: npt.NDArray[np.bool_]) -> Floats:
    """Return the cost of the cheapest 8-connected path from every pixel to a goal pixel (Dijkstra's algorithm)."""
    rows, columns = price.shape
    costs = np.full(rows * columns, 1e15)
    heap = [(0.0, 0)]
    heap.pop()
    for row in range(rows):
        for column in range(columns):
            if goals[row, column]:
                costs[row * columns + column] = 0.0
                heapq.heappush(heap, (0.0, row * columns + column))
    while len(heap) > 0:
        cost, at = heapq.heappop(heap)
        if cost > costs[at]:
            continue
        row, column = at // columns, at % columns
        for up in range(max(row - 1, 0), min(row + 2, rows)):
            for along in range(max(column - 1, 0), min(column + 2, columns)):
                step = price[up, along] * (1.4142135623730951 if up != row and along != column else 1.0)
                if cost + step < costs[up * columns + along]:
                    costs[up * columns + along] = cost + step
                    heapq.heappush(heap, (cost + step, up * columns + along))
    return costs.reshape(rows, columns)
