"""The bottleneck that stops a body, and by how much wider it would have to be.

# Strategy: of all paths to the goal through free space the widest is taken. The bottleneck is its narrowest place near
# the place closest to the goal that the search got to. The walls are then moved apart across the bottleneck, along the
# line between its two sides alone, until the body passes: by how much is the missing width.
"""

import heapq
import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import combinations, product
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
import shapely
from shapely import affinity

from utak.geometry.kernels.arrays import Bools, Floats
from utak.geometry.kernels.jit import compiled
from utak.geometry.motion.obstacle_field import ObstacleField, cheapest_path_costs

StatusQuery = Callable[[Any, int], tuple[str, int]]  # status and cells used, of obstacles and the cells allowed
WIDTH_PRECISION = 0.02  # squares: the bisection for the missing width ends at this; a convention
WIDENING_CELLS = 45_000  # cells of configuration space for one missing width, and for whether widening helps
WIDENING_CELLS_PER_QUESTION = 12_000  # of these, for one width; both bound time, about 20 microseconds a cell
MIN_WALL_COPIES = 9  # translated copies of the free space that stand for moving a wall, at least; a convention
MAX_WALL_COPIES = 129  # at most; in a slit the copies lie as close as it is wide, lest bars are left between them
NARROWER_PIXEL_COST = 1000.0  # cost of entering a pixel narrower than the widest path is, against at most 1 for others
NECK_SEARCH_RADII = 2.5  # radii of the body: how far from where the search ended the bottleneck is looked for; tuned
EQUAL_CLEARANCE = 1e-9  # squares: clearances that differ by less count as equal; bounds rounding
RASTER_REFINEMENTS = (1, 2, 4)  # factors by which the field's raster is refined in turn to find slits between pixels


@dataclass(frozen=True)
class Bottleneck:
    """A locally narrowest place between obstacles. Squares, table frame."""

    place: tuple[float, float]  # (x, y), its middle
    # The two points (x, y) of the obstacles that make it, in no order that means anything
    sides: tuple[tuple[float, float], tuple[float, float]]
    width: float  # distance between them


def least_gap(body: Any) -> float:
    """Return a width, squares: the body passes between no two points closer than that, whether it turns or not.

    While a convex part of the body passes the line between two points, it meets that in a chord between them. The
    supporting lines at the ends of the chord meet before the line at first, and behind it at last; once they are
    parallel, and then the part is at most as wide as the chord. So no convex part passes a gap narrower than its least
    width (G. Strang, "The width of a chair", 1982). 0 where no convex part is known: of a body that is not convex,
    rectangles along its sides alone are looked at.
    """
    ring = np.array(shapely.normalize(body).exterior.coords)
    if body.convex_hull.area - body.area <= EQUAL_CLEARANCE:
        return _least_width(ring)
    dx, dy = ring[1] - ring[0]
    upright = affinity.rotate(body, -math.degrees(math.atan2(dy, dx)), origin=(0.0, 0.0))
    corners = np.array(upright.exterior.coords)
    xs, ys = (np.unique(np.round(corners[:, axis], 9)) for axis in (0, 1))
    boxes = [
        shapely.box(west, south, east, north)
        for (west, east), (south, north) in product(combinations(xs, 2), combinations(ys, 2))
    ]
    whole = upright.buffer(EQUAL_CLEARANCE, join_style="mitre")
    return max((min(b[2] - b[0], b[3] - b[1]) for b in (box.bounds for box in boxes if whole.covers(box))), default=0.0)


def _least_width(ring: Floats) -> float:
    """Return the least width of a convex polygon: across one of its sides. ring : (n + 1, 2) its closed boundary."""
    sides = np.diff(ring, axis=0)
    sides = sides[np.hypot(*sides.T) > 0]
    normals = np.stack([-sides[:, 1], sides[:, 0]]) / np.hypot(*sides.T)
    across = ring @ normals
    return float((across.max(0) - across.min(0)).min())


def find_bottleneck(obstacle_field: ObstacleField, goals: Bools, reached: Floats, radius: float) -> Bottleneck | None:
    """Return the narrowest place on the widest path to the goal, near where the search ended; None without walls."""
    field, path_clearance = _coarsest_passable_raster(obstacle_field, goals, reached[0])
    costs = _costs_to_goal(field, max(path_clearance, field.frame[2] / 10))
    pixels = field.pixels_at(reached)
    end_of_search = reached[int(np.argmin(costs[pixels[:, 0], pixels[:, 1]]))]
    path = _descend(costs, pixels[0])
    centres = field.frame[:2] + (path[:, ::-1] + 0.5) * field.frame[2]
    near = np.hypot(*(centres - end_of_search).T) <= NECK_SEARCH_RADII * radius
    clearance = field.raster[path[:, 0], path[:, 1]]
    stopped = near.any() and clearance[near].min() < radius
    x, y = centres[_narrowest_index(clearance, near if stopped else np.ones(len(clearance), np.bool_))]
    return _bottleneck_at(obstacle_field, (float(x), float(y)))


def _narrowest_index(clearance: Floats, candidates: Bools) -> int:
    """Return the index of the pixel where a path is narrowest, starting from the pixels in `candidates`."""
    first = int(np.argmin(np.where(candidates, clearance, np.inf)))
    for ahead in (1, -1):
        while 0 <= first + ahead < len(clearance) and clearance[first + ahead] < clearance[first] - EQUAL_CLEARANCE:
            first += ahead
    wider = np.flatnonzero(clearance[first:] > clearance[first] + EQUAL_CLEARANCE)
    return first + (int(wider[0]) if len(wider) else len(clearance) - first) // 2


class ClearanceField(NamedTuple):
    """A raster of distances to obstacles, with a goal."""

    frame: Floats  # (3,) x, y of the raster's lower left corner in the table frame, side of a pixel; squares
    # (rows, columns) signed distance to the obstacles, squares, negative inside; row 0 in the south. As of an
    # ObstacleField, or finer.
    raster: Floats
    goals: Bools  # (rows, columns) bool: pixels of the goal

    def pixels_at(self, places: Floats) -> npt.NDArray[np.intp]:
        """Return the pixels (n, 2) row, column of places (n, 2) x, y; the nearest pixel for places outside."""
        found = np.floor((places - self.frame[:2]) / self.frame[2]).astype(np.intp)[:, ::-1]
        pixels: npt.NDArray[np.intp] = np.clip(found, 0, np.array(self.raster.shape) - 1)
        return pixels


def _coarsest_passable_raster(
    obstacle_field: ObstacleField, goals: Bools, start: Floats
) -> tuple[ClearanceField, float]:
    """Return the coarsest raster with a path from start to goal, and the clearance of the widest path, in squares."""
    field = ClearanceField(obstacle_field.frame, obstacle_field.raster, goals)
    for times in RASTER_REFINEMENTS:
        if times > 1:
            frame, raster = obstacle_field.finer_raster(times)
            field = ClearanceField(frame, raster, goals.repeat(times, 0).repeat(times, 1) & (raster > 0.0))
        row, column = field.pixels_at(start[None])[0].tolist()
        path_clearance = _widest_path_clearance(field.raster, field.goals, row, column, field.frame[2])
        if path_clearance > 0.0:
            return field, path_clearance
    return ClearanceField(obstacle_field.frame, obstacle_field.raster, goals), 0.0


def _costs_to_goal(field: ClearanceField, path_clearance: float) -> Floats:
    """Return the cost to the goal from every pixel, by paths no narrower than the widest one from the start."""
    # Clearance is cheap, so that paths keep off walls and are narrow only where they must be. They end at goal pixels
    # that are as wide, if there are any: a narrower one beside the bottleneck would be taken for it.
    clearance = np.maximum(field.raster, path_clearance)
    narrower = field.raster < path_clearance - EQUAL_CLEARANCE
    goals = field.goals & ~narrower
    return cheapest_path_costs(
        np.where(narrower, NARROWER_PIXEL_COST, (path_clearance / clearance) ** 3),
        goals if goals.any() else field.goals,
    )


@compiled
def _widest_path_clearance(raster: Floats, goals: Bools, row: int, column: int, pixel: float) -> float:
    """Return the least clearance, on the widest path (maximin) from goal pixels to a pixel, in squares."""
    rows, columns = raster.shape
    path_clearance = np.full((rows, columns), -1e9)
    heap = [(0.0, 0, 0)]
    heap.pop()
    for r in range(rows):
        for c in range(columns):
            if goals[r, c]:
                path_clearance[r, c] = raster[r, c]
                heapq.heappush(heap, (-raster[r, c], r, c))
    while len(heap) > 0:
        minus, r, c = heapq.heappop(heap)
        if r == row and c == column:
            return -minus
        if -minus < path_clearance[r, c]:
            continue
        for up in range(max(r - 1, 0), min(r + 2, rows)):
            for along in range(max(c - 1, 0), min(c + 2, columns)):
                step = pixel * (1.4142135623730951 if up != r and along != c else 1.0)
                clearance = min(-minus, raster[up, along])
                if raster[r, c] + raster[up, along] < step:  # there may be a thin wall between the two
                    clearance = min(clearance, 0.0)
                if clearance > path_clearance[up, along]:
                    path_clearance[up, along] = clearance
                    heapq.heappush(heap, (-clearance, up, along))
    return 0.0


def _descend(costs: Floats, start: npt.NDArray[np.intp]) -> npt.NDArray[np.intp]:
    """Return the pixels (n, 2) row, column on the way of steepest descent of `costs` from `start` to the goal."""
    row, column = int(start[0]), int(start[1])
    path = [(row, column)]
    while costs[row, column] > 0.0:
        window = costs[max(row - 1, 0) : row + 2, max(column - 1, 0) : column + 2]
        down, along = np.unravel_index(int(np.argmin(window)), window.shape)
        step = (max(row - 1, 0) + int(down), max(column - 1, 0) + int(along))
        if step == (row, column):
            break
        row, column = step
        path.append(step)
    return np.array(path)


def _bottleneck_at(obstacle_field: ObstacleField, place: tuple[float, float]) -> Bottleneck | None:
    """Return the bottleneck about a place: from the nearest point of an obstacle to the nearest on the other side."""
    # None without obstacles on both sides, or if the place is in an obstacle.
    obstacles = shapely.union_all(obstacle_field.polygons)
    here = np.array(place)
    sides: list[Floats] = []
    for _ in range(3):
        if obstacles.is_empty or obstacles.contains(shapely.Point(here)):
            break
        near = _nearest_point(here, obstacles)
        if near is None:
            break
        far = _nearest_point(here, obstacles.intersection(_half_plane(here, here - near, 4 * obstacle_field.side)))
        if far is None:
            break
        sides = [near, far]
        here = (near + far) / 2
    if not sides:
        return None
    (ax, ay), (bx, by) = sides
    width = math.hypot(bx - ax, by - ay)
    return Bottleneck((float(here[0]), float(here[1])), ((float(ax), float(ay)), (float(bx), float(by))), width)


def _nearest_point(here: Floats, obstacles: Any) -> Floats | None:
    """Return the point (2,) x, y of a geometry that is nearest to the place `here` (2,); None if it is empty."""
    line = shapely.shortest_line(shapely.Point(here), obstacles)
    return None if line is None or line.is_empty else np.array(line.coords[1])


def _half_plane(here: Floats, ahead: Floats, far: float) -> Any:
    """Return the half-plane of what lies from `here` in the direction `ahead`, cut off at the distance `far`."""
    unit = ahead / max(float(np.hypot(*ahead)), 1e-12)
    across = np.array([-unit[1], unit[0]]) * far
    base = here + 1e-6 * unit
    return shapely.Polygon([base - across, base - across + far * unit, base + across + far * unit, base + across])


def widen_bottleneck(obstacles: Any, bottleneck: Bottleneck, extra: float, reach: float) -> Any:
    """Return the obstacles (shapely geometry, table frame) with the two sides of a bottleneck moved apart."""
    # Only the connected free space that the bottleneck is in grows: what lies behind a wall would open it from behind.
    middle = shapely.Point(bottleneck.place)
    window = middle.buffer(reach)
    parts = shapely.get_parts(window.difference(obstacles))
    free = parts[int(np.argmin(shapely.distance(parts, middle)))]
    (ax, ay), (bx, by) = bottleneck.sides
    length = max(bottleneck.width, 1e-9)
    dx, dy = (bx - ax) / length * extra / 2, (by - ay) / length * extra / 2
    shifts = min(max(MIN_WALL_COPIES, 2 + math.ceil(1.1 * extra / length)), MAX_WALL_COPIES)
    copies = [affinity.translate(free, dx * t, dy * t) for t in np.linspace(-1, 1, shifts)]
    return obstacles.difference(shapely.union_all(copies).intersection(window))


def status_when_wide(obstacles: Any, bottleneck: Bottleneck, radius: float, status_with: StatusQuery) -> str:
    """Return the status of planning if one bottleneck alone were as wide as the body however it is turned."""
    extra, reach = _max_widening(bottleneck, radius), _window_radius(bottleneck, radius)
    return status_with(widen_bottleneck(obstacles, bottleneck, extra, reach), WIDENING_CELLS)[0]


def missing_width(
    obstacles: Any, bottleneck: Bottleneck, radius: float, status_with: StatusQuery
) -> tuple[float, float, float]:
    """Return how much wider a bottleneck must be for a body to pass, provided that widening it suffices."""
    low, high, reach = 0.0, _max_widening(bottleneck, radius), _window_radius(bottleneck, radius)
    undecided: list[float] = []  # the least and the greatest width for which planning stayed undecided
    left = WIDENING_CELLS
    while left > 0:
        below, above = (undecided[0], undecided[-1]) if undecided else (high, low)
        if not undecided:
            gap, middle = high - low, (low + high) / 2
        else:
            gap, middle = max((below - low, (low + below) / 2), (high - above, (above + high) / 2))
        if gap <= WIDTH_PRECISION:
            break
        status, used = status_with(
            widen_bottleneck(obstacles, bottleneck, middle, reach), min(left, WIDENING_CELLS_PER_QUESTION)
        )
        left -= used
        if status == "limit":
            undecided = [min(below, middle), max(above, middle)] if undecided else [middle]
        elif status == "found":
            high = middle
        else:
            low = middle
        undecided = [width for width in undecided if low < width < high]
    middle = (undecided[0] + undecided[-1]) / 2 if undecided else high
    return low, (low + middle) / 2, high


def _max_widening(bottleneck: Bottleneck, radius: float) -> float:
    """Return by how many squares a bottleneck is widened at most, for a body of a radius in squares."""
    return max(2.2 * radius - bottleneck.width, 4 * WIDTH_PRECISION)


def _window_radius(bottleneck: Bottleneck, radius: float) -> float:
    """Return within how many squares of a bottleneck's middle its sides are moved, for a body's radius in squares."""
    return bottleneck.width + 2 * radius + _max_widening(bottleneck, radius)
