"""Where a body cannot pass, and by how much: the neck that stops it, and how much wider it would have to be.

# Strategy: of all ways to the goal through empty space the widest is taken. Its narrowest place near the pose nearest
# to the goal that the search got to is the neck. The walls are then moved apart across the neck, along the line between
# its two sides alone, until the body passes: what it takes is what is missing.
"""

import heapq
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
import shapely
from shapely import affinity

from geometry.kernels.arrays import Bools, Floats
from geometry.kernels.jit import compiled
from geometry.motion.obstacle_field import ObstacleField, cheapest

Answer = Callable[[Any, bool], str]
CLOSE = 0.02  # squares: to which the missing width is found
NEARLY = 0.25  # squares: until it is told to that, what is hard to decide is asked at length
SHIFTS = 9  # copies of the free space that stand for moving a wall, at least
MOST_SHIFTS = 129  # in a slit they lie as close as it is wide, that no bars are left between them
DETOUR = 1000.0  # going through pixels narrower than need be looks so much dearer
LOOK = 2.5  # radii of the body: how far from where it is stuck the neck is looked for
EVEN = 1e-9  # squares: room that differs by less is the same
FINER = (1, 2, 4)  # times as fine as the floor's raster: a slit between its pixels is looked for more finely


@dataclass(frozen=True)
class Bottleneck:
    """A locally narrowest place between obstacles.

    place : (x, y), its middle. sides : the two points (x, y) of the obstacles that make it. width : between them.
    """

    place: tuple[float, float]
    sides: tuple[tuple[float, float], tuple[float, float]]
    width: float


def neck_near(floor: ObstacleField, goals: Bools, reached: Floats, radius: float) -> Bottleneck | None:
    """The narrowest place on the widest way to the goal, not further than LOOK radii from where a body came to.

    goals : the goal's pixels in the floor's raster. reached : (n, 2) places that the body came to, the start first.
    Of these the one counts from which there is least to go; but where there is room for the body however it is turned
    it was not stopped, and then the whole way counts. None without walls.
    """
    field, wide = _field_with_a_way(floor, goals, reached[0])
    ways = _ways(field, max(wide, field.frame[2] / 10))
    pixels = field.pixels(reached)
    stuck = reached[int(np.argmin(ways[pixels[:, 0], pixels[:, 1]]))]
    track = _descent(ways, pixels[0])
    centres = field.frame[:2] + (track[:, ::-1] + 0.5) * field.frame[2]
    near = np.hypot(*(centres - stuck).T) <= LOOK * radius
    room = field.raster[track[:, 0], track[:, 1]]
    stopped = near.any() and room[near].min() < radius
    x, y = centres[_narrowest(room, near if stopped else np.ones(len(room), np.bool_))]
    return _neck_at(floor, (float(x), float(y)))


def _narrowest(room: Floats, asked: Bools) -> int:
    """Where a way is narrowest, of the pixels asked for, and on from there as long as it grows narrower.

    That is amid a neck of several pixels, not at its mouth. room : of each pixel of the way, in squares.
    """
    first = int(np.argmin(np.where(asked, room, np.inf)))
    for ahead in (1, -1):
        while 0 <= first + ahead < len(room) and room[first + ahead] < room[first] - EVEN:
            first += ahead
    wider = np.flatnonzero(room[first:] > room[first] + EVEN)
    return first + (int(wider[0]) if len(wider) else len(room) - first) // 2


class ClearanceField(NamedTuple):
    """Distances to obstacles: frame and raster as of a ObstacleField or finer; goals: (rows, columns) the goal's
    pixels.
    """

    frame: Floats
    raster: Floats
    goals: Bools

    def pixels(self, places: Floats) -> npt.NDArray[np.intp]:
        """The pixels (n, 2) row, column of places (n, 2) x, y."""
        found = np.floor((places - self.frame[:2]) / self.frame[2]).astype(np.intp)[:, ::-1]
        pixels: npt.NDArray[np.intp] = np.clip(found, 0, np.array(self.raster.shape) - 1)
        return pixels


def _field_with_a_way(floor: ObstacleField, goals: Bools, start: Floats) -> tuple[ClearanceField, float]:
    """The coarsest field with a way from the start to a goal, and the least room on the widest way.

    The floor's own field and 0.0 when there is a way in none.
    """
    field = ClearanceField(floor.frame, floor.raster, goals)
    for times in FINER:
        if times > 1:
            frame, raster = floor.finer(times)
            field = ClearanceField(frame, raster, goals.repeat(times, 0).repeat(times, 1) & (raster > 0.0))
        row, column = field.pixels(start[None])[0].tolist()
        wide = _widest(field.raster, field.goals, row, column, field.frame[2])
        if wide > 0.0:
            return field, wide
    return ClearanceField(floor.frame, floor.raster, goals), 0.0


def _ways(field: ClearanceField, wide: float) -> Floats:
    """What it costs to the goal from every pixel, by ways nowhere narrower than the widest way from the start is.

    Room is cheap, so that ways keep off walls and are narrow only where they must be. They end at goal pixels that are
    as wide, if there are any: a narrower one beside the neck would be taken for it.
    """
    room = np.maximum(field.raster, wide)
    narrower = field.raster < wide - EVEN
    goals = field.goals & ~narrower
    return cheapest(np.where(narrower, DETOUR, (wide / room) ** 3), goals if goals.any() else field.goals)


@compiled
def _widest(raster: Floats, goals: Bools, row: int, column: int, pixel: float) -> float:
    """The least distance to walls on the way from the goal pixels to a pixel where that is greatest (maximin)."""
    rows, columns = raster.shape
    wide = np.full((rows, columns), -1e9)
    heap = [(0.0, 0, 0)]
    heap.pop()
    for r in range(rows):
        for c in range(columns):
            if goals[r, c]:
                wide[r, c] = raster[r, c]
                heapq.heappush(heap, (-raster[r, c], r, c))
    while len(heap) > 0:
        minus, r, c = heapq.heappop(heap)
        if r == row and c == column:
            return -minus
        if -minus < wide[r, c]:
            continue
        for up in range(max(r - 1, 0), min(r + 2, rows)):
            for along in range(max(c - 1, 0), min(c + 2, columns)):
                step = pixel * (1.4142135623730951 if up != r and along != c else 1.0)
                room = min(-minus, raster[up, along])
                if raster[r, c] + raster[up, along] < step:  # there may be a thin wall between the two
                    room = min(room, 0.0)
                if room > wide[up, along]:
                    wide[up, along] = room
                    heapq.heappush(heap, (-room, up, along))
    return 0.0


def _descent(ways: Floats, start: npt.NDArray[np.intp]) -> npt.NDArray[np.intp]:
    """The pixels (n, 2) row, column from one downhill to the goal."""
    row, column = int(start[0]), int(start[1])
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


def _neck_at(floor: ObstacleField, place: tuple[float, float]) -> Bottleneck | None:
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
    return Bottleneck((float(here[0]), float(here[1])), ((float(ax), float(ay)), (float(bx), float(by))), width)


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


def widened(solid: Any, neck: Bottleneck, extra: float, reach: float) -> Any:
    """The obstacles with the two sides of a neck moved apart by `extra`, within `reach` of it.

    Only the free space that the neck is in moves: what lies behind a wall would open it from behind.
    """
    middle = shapely.Point(neck.place)
    window = middle.buffer(reach)
    parts = shapely.get_parts(window.difference(solid))
    free = parts[int(np.argmin(shapely.distance(parts, middle)))]
    (ax, ay), (bx, by) = neck.sides
    length = max(neck.width, 1e-9)
    dx, dy = (bx - ax) / length * extra / 2, (by - ay) / length * extra / 2
    shifts = min(max(SHIFTS, 2 + math.ceil(1.1 * extra / length)), MOST_SHIFTS)
    copies = [affinity.translate(free, dx * t, dy * t) for t in np.linspace(-1, 1, shifts)]
    return solid.difference(shapely.union_all(copies).intersection(window))


def helps(solid: Any, neck: Bottleneck, radius: float, answer: Answer) -> bool:
    """Would a body of some radius get through if only a neck were as wide as that? answer : as for missing_width."""
    return _decided(widened(solid, neck, _most(neck, radius), _reach(neck, radius)), answer) == "found"


def missing_width(solid: Any, neck: Bottleneck, radius: float, answer: Answer) -> float:
    """How much wider a neck must be, in squares, for a body of some radius to pass, if that helps.

    answer : the status of planning the body's motion when the obstacles are these, and whether it is asked at length.
    What is not decided lies within the resolution of the very width that is sought, unless it is hard otherwise:
    so that is asked at length only while the width is not told to NEARLY.
    """
    low, high, reach = 0.0, _most(neck, radius), _reach(neck, radius)
    while high - low > CLOSE:
        middle = (low + high) / 2
        walls = widened(solid, neck, middle, reach)
        status = answer(walls, False) if high - low <= NEARLY else _decided(walls, answer)
        if status == "limit":
            return middle
        if status == "found":
            high = middle
        else:
            low = middle
    return (low + high) / 2


def _decided(walls: Any, answer: Answer) -> str:
    """The status when the obstacles are these, asked at length when it is not told otherwise."""
    status = answer(walls, False)
    return answer(walls, True) if status == "limit" else status


def _most(neck: Bottleneck, radius: float) -> float:
    """By how much a neck is widened at most, in squares."""
    return max(2.2 * radius - neck.width, 4 * CLOSE)


def _reach(neck: Bottleneck, radius: float) -> float:
    """Within how many squares of a neck its sides are moved."""
    return neck.width + 2 * radius + _most(neck, radius)
