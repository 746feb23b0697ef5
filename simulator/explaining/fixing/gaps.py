"""The passages of the true floor, the places for new doors, and how they are made wider.

All places are (x, y) in squares, table frame. The floor here is the table without its verge and its fixed things;
what can be moved does not count.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from enum import StrEnum
from itertools import groupby, pairwise
from typing import Any

import numpy as np
import shapely
from shapely import affinity

from utak.geometry import Screen
from utak.geometry.kernels.arrays import XY, Bools, Labels
from utak.geometry.passages.necks import halfway
from utak.geometry.raster.components import components
from utak.geometry.raster.rasterize import squares
from utak.simulator.world.world import World

WIDTH_STEP = 0.25  # squares; widths are tried in these steps; a convention
FINE_CELLS = 4  # cells along a square, in worlds whose walls do not lie on whole squares; a convention
CELL_DIAGONAL = math.sqrt(2) / FINE_CELLS  # squares; how far a wall may lie from where the raster shows it
MAX_FINE_SIDE = 256  # squares; greater tables are surveyed in whole squares; a convention
MIN_NECK_RATIO = 1.05  # how many times as wide the floor is on both sides of a passage; a convention, near 1
WALL_MARGIN = 0.5  # squares about a passage within which its walls are measured; a convention
ROUGH_MARGIN = 1.5  # squares about a passage found on a raster within which its walls lie; more than a cell's diagonal
JAMB_MARGIN = 0.05  # squares beyond jambs that lie askew, so that no sliver of them stays; more than the tolerance
MAX_MEASURINGS = 8  # times that a gap in a thick wall is measured further; each time the window grows; a convention
JAMB_TOLERANCE = 0.01  # squares by which a wall may be further away and still bounds a passage; coordinates are rounded
GAP_LENGTH_TOLERANCE = 1e-6  # squares; rounding of lengths
MIN_FLOOR_AREA = 1e-6  # square squares; smaller pieces of floor come from rounding
MAX_OPENED_WALL = 8  # squares; no door is made in a thicker wall; a convention


class GapSide(StrEnum):
    """The end of a gap at which its wall is moved back: one of both ends, or half of the width at each."""

    LEFT = "left"
    RIGHT = "right"
    BOTH = "both"


@dataclass(frozen=True)
class Gap:
    """A passage of the true floor, or a place in a wall for a new door."""

    left: XY  # its ends on the walls, (x, y); equal for a new door
    right: XY
    width: float  # from wall to wall, in squares; 0 for a new door
    depth: float  # from one mouth to the other, in squares
    wall: str  # WKT of what is moved sideways: the quadrangle between the mouths, or the line through the wall
    along: XY  # the unit vector from right to left
    room: float  # the greatest clearance on the narrower of its sides, in squares: a door is at most so wide

    @property
    def is_new(self) -> bool:
        """Return whether it is a new door, where there was none."""
        return self.width == 0.0

    @property
    def place(self) -> XY:
        """Return the point halfway between its ends."""
        return (self.left[0] + self.right[0]) / 2, (self.left[1] + self.right[1]) / 2


def solid_of(world: World) -> Any:
    """Return verge and fixed things as one shapely geometry."""
    return shapely.union_all([world.verge, *(thing.polygon for thing in world.fixed)])


def floor_of(world: World) -> Any:
    """Return the floor as a shapely geometry."""
    return shapely.box(0, 0, world.width, world.height).difference(solid_of(world))


def passages_of(world: World) -> list[Gap]:
    """Return the passages of the floor, the narrowest first, then from the south and the west."""
    found = {gap.wall: gap for gap in (*_passages_in(world, world.verge), *_passages_in(world, solid_of(world)))}
    return sorted(found.values(), key=lambda gap: (gap.width, gap.place[1], gap.place[0]))


def _passages_in(world: World, solid: Any) -> list[Gap]:
    """Return the passages of what is left of a table beside a solid, in no particular order."""
    cells = _cells_per_square(solid, world)
    free = ~_covered(solid, world, cells)
    if not free.any():
        return []
    found = []
    for passage in Screen(free).passages(MIN_NECK_RATIO):
        (a, b), (c, d) = ([(x / cells, y / cells) for x, y in mouth] for mouth in passage.mouths)
        if math.dist(halfway(a, c), halfway(b, d)) < GAP_LENGTH_TOLERANCE:
            continue  # its mouths cross each other: there is no direction in which it could be made wider
        gap = _gap_between(halfway(a, c), halfway(b, d), shapely.MultiPoint([a, b, c, d]), passage.width / cells)
        gap = replace(gap, room=min(passage.sides) / cells)
        found.append(gap if cells == 1 else _measured(solid, gap))
    return found


def _gap_between(left: XY, right: XY, mouths: Any, width: float) -> Gap:
    """Return the gap between two ends; `mouths` are the points at which its two mouths end."""
    length = math.dist(left, right)
    along = ((left[0] - right[0]) / length, (left[1] - right[1]) / length)
    across = [y * along[0] - x * along[1] for x, y in shapely.get_coordinates(mouths).tolist()]
    return Gap(left, right, width, max(across) - min(across), mouths.convex_hull.wkt, along, 0.0)


def _measured(solid: Any, rough: Gap) -> Gap:
    """Return a gap that was found on a raster with the ends, the width and the depth that its walls have."""
    gap = _measured_once(solid, rough)
    for _ in range(MAX_MEASURINGS):
        again = _measured_once(solid, gap)
        if again.depth <= gap.depth + JAMB_TOLERANCE:
            break
        gap = again
    return gap


def _measured_once(solid: Any, rough: Gap) -> Gap:
    """Return a gap with the measures that its walls have near where it was thought to be."""
    margin = max(ROUGH_MARGIN, rough.width / 2)
    left, right = _walls_beside(solid, shapely.from_wkt(rough.wall), margin, CELL_DIAGONAL, rough)
    if left.is_empty or right.is_empty or left.distance(right) < GAP_LENGTH_TOLERANCE:
        return rough
    width = float(left.distance(right))
    q, p = shapely.get_coordinates(shapely.shortest_line(right, left)).tolist()
    along = ((p[0] - q[0]) / width, (p[1] - q[1]) / width)
    near = [
        shapely.get_coordinates(one.intersection(other.buffer(width + JAMB_TOLERANCE)))
        for one, other in ((left, right), (right, left))
    ]
    across = [points[:, 1] * along[0] - points[:, 0] * along[1] for points in near]
    low, high = max(float(one.min()) for one in across), min(float(one.max()) for one in across)
    if high - low < JAMB_TOLERANCE:
        low = high = (low + high) / 2
    else:
        low, high = low - JAMB_MARGIN, high + JAMB_MARGIN
    ends = [q[0] * along[0] + q[1] * along[1], p[0] * along[0] + p[1] * along[1]]
    corners = [
        (at * along[0] - beside * along[1], at * along[1] + beside * along[0]) for at in ends for beside in (low, high)
    ]
    gap = _gap_between(halfway(*corners[2:]), halfway(*corners[:2]), shapely.MultiPoint(corners), round(width, 9))
    return replace(gap, room=rough.room)


def new_doors_of(world: World) -> list[Gap]:
    """Return one place for a new door for each two separate parts of the floor that only a wall of verge divides."""
    free = ~_covered(solid_of(world), world, 1)
    labels = components(free).labels
    best: dict[tuple[int, int], tuple[int, int, Gap]] = {}
    for grid, turned in ((labels, False), (labels.T, True)):
        for pair, thickness, length, gap in _walls_between(grid, turned):
            rank = (thickness, -length)
            if pair not in best or rank < best[pair][:2]:
                best[pair] = (*rank, gap)
    return [gap for _, (_, _, gap) in sorted(best.items())]


def _walls_between(labels: Labels, turned: bool) -> Iterator[tuple[tuple[int, int], int, int, Gap]]:
    """Yield straight walls across the rows of a grid: the parts (two labels), thickness, length, and the door in it."""
    runs = [
        (int(first), int(second), west, east, row)
        for row, line in enumerate(labels)
        for west, east in _blocked_runs(line)
        if (first := line[west - 1]) != (second := line[east])
    ]
    for (first, second, west, east), group in groupby(sorted(runs), key=lambda run: run[:4]):
        rows = [run[4] for run in group]
        for _, stretch in groupby(enumerate(rows), key=lambda item: item[1] - item[0]):
            span = [row for _, row in stretch]
            low, length = span[0], len(span)
            at = float(low + length // 2)
            ends = [(float(west), at), (float(east), at)]
            points = [(y, x) for x, y in ends] if turned else ends
            middle = ((points[0][0] + points[1][0]) / 2, (points[0][1] + points[1][1]) / 2)
            along = (1.0, 0.0) if turned else (0.0, 1.0)
            line = shapely.LineString(points).wkt
            gap = Gap(middle, middle, 0.0, float(east - west), line, along, float(length - length // 2))
            yield (min(first, second), max(first, second)), east - west, length, gap


def _blocked_runs(line: Labels) -> Iterator[tuple[int, int]]:
    """Yield (first, end) of the runs of blocked squares between two free ones that are thin enough for a door."""
    free = np.flatnonzero(line > 0)
    for before, after in zip(free[:-1].tolist(), free[1:].tolist(), strict=True):
        if 1 < after - before <= MAX_OPENED_WALL + 1:
            yield before + 1, after


def widened(world: World, gap: Gap, side: GapSide, by: float) -> World | None:
    """Return the world in which a gap is wider by `by` squares; None when that cannot be."""
    # It cannot be when a fixed thing stands there, when the gap would not be wider after all, or when other parts of
    # the floor would be joined as well.
    shape = shapely.from_wkt(gap.wall)
    if not gap.is_new and gap.depth < GAP_LENGTH_TOLERANCE:
        shape = _thickened(shape, gap, by)
    floor = floor_of(world)
    local = shape if gap.is_new else _part_at(shape.intersection(floor), gap.place)
    if local is None:
        return None
    x, y = gap.along
    ends = {
        GapSide.LEFT: [(x * by, y * by)],
        GapSide.RIGHT: [(-x * by, -y * by)],
        GapSide.BOTH: [(x * by / 2, y * by / 2), (-x * by / 2, -y * by / 2)],
    }
    swept = shapely.union_all([_sweep(local, offset) for offset in ends[side]])
    carved = swept.difference(floor)
    if carved.area < MIN_FLOOR_AREA or not shapely.box(0, 0, world.width, world.height).covers(carved):
        return None
    verge = _clean(world.verge.difference(carved))
    changed = replace(world, verge=verge)
    if not verge.is_valid or verge.is_empty:
        return None
    if not gap.is_new and _width(solid_of(changed), swept, gap) < gap.width + by - GAP_LENGTH_TOLERANCE:
        return None
    parts, holes = _topology(floor)
    new_parts, new_holes = _topology(floor_of(changed))
    expected = (parts - 1, holes) if gap.is_new else (parts, holes)
    if (new_parts, new_holes) != expected:
        return None
    return changed


def _part_at(shape: Any, place: XY) -> Any:
    """Return the part with an area of a shape that is nearest to a place; None when there is none."""
    parts = [part for part in shapely.get_parts(shape) if part.area > MIN_FLOOR_AREA]
    return min(parts, key=lambda part: part.distance(shapely.Point(place)), default=None)


def _thickened(shape: Any, gap: Gap, by: float) -> Any:
    """Return the line of a gap without depth as a band that reaches `by` squares to both sides of it."""
    x, y = gap.along
    line = shapely.LineString([gap.left, gap.right])
    moved = [affinity.translate(line, -y * k * by, x * k * by) for k in (-1, 1)]
    return shapely.union_all([shape, *moved]).convex_hull


def _sweep(shape: Any, offset: XY) -> Any:
    """Return all points of a shape moved by all parts of an offset, as one geometry."""
    moved = affinity.translate(shape, *offset)
    parts = [shape, moved]
    for part in shapely.get_parts(shape):
        lines = [part.exterior] if part.geom_type == "Polygon" else [part] if part.geom_type == "LineString" else []
        for line in lines:
            points = shapely.get_coordinates(line)
            for p, q in pairwise(points):
                corners = [p, q, q + offset, p + offset]
                parts.append(shapely.MultiPoint(corners).convex_hull)
    return shapely.union_all([part for part in parts if part.area > 0])


def _width(solid: Any, opening: Any, gap: Gap) -> float:
    """Return how far the walls on the left and on the right of an opening are apart, in squares."""
    left, right = _walls_beside(solid, opening, WALL_MARGIN, GAP_LENGTH_TOLERANCE, gap)
    return math.inf if left.is_empty or right.is_empty else float(left.distance(right))


def _walls_beside(solid: Any, opening: Any, margin: float, apart: float, gap: Gap) -> list[Any]:
    """Return what is solid on the left and on the right of a gap's middle."""
    window = opening.buffer(margin)
    near = solid.intersection(window)
    x0, y0, x1, y1 = window.bounds
    reach = 2 * (x1 - x0 + y1 - y0)
    (x, y), (cx, cy) = gap.along, gap.place
    a, b = (cx - y * reach, cy + x * reach), (cx + y * reach, cy - x * reach)
    halves = []
    for sign in (1, -1):
        far = [(px + sign * x * reach, py + sign * y * reach) for px, py in (b, a)]
        parts = shapely.get_parts(near.intersection(shapely.Polygon([a, b, *far])))
        halves.append(shapely.union_all([part for part in parts if part.area > 0 and part.distance(opening) <= apart]))
    return halves


def _topology(floor: Any) -> tuple[int, int]:
    """Return how many parts a floor has, and how many holes."""
    parts = [part for part in shapely.get_parts(floor) if part.area > MIN_FLOOR_AREA]
    holes = sum(shapely.Polygon(ring).area > MIN_FLOOR_AREA for part in parts for ring in part.interiors)
    return len(parts), int(holes)


def _clean(verge: Any) -> Any:
    """Return a verge without lines and slivers that come from rounding."""
    parts = [part for part in shapely.get_parts(verge) if part.geom_type == "Polygon" and part.area > MIN_FLOOR_AREA]
    rounded = [shapely.set_precision(part, 1e-9) for part in parts]
    whole = [piece for part in rounded for piece in shapely.get_parts(part) if piece.area > MIN_FLOOR_AREA]
    return whole[0] if len(whole) == 1 else shapely.MultiPolygon(whole)


def _cells_per_square(solid: Any, world: World) -> int:
    """Return into how many cells a square's side is divided: 1 where all walls lie on whole squares."""
    points = shapely.get_coordinates(solid)
    on_squares = bool(np.all(np.abs(points - np.round(points)) < GAP_LENGTH_TOLERANCE))
    return 1 if on_squares or max(world.width, world.height) > MAX_FINE_SIDE else FINE_CELLS


def _covered(solid: Any, world: World, cells: int) -> Bools:
    """Return which cells a solid covers, (rows, columns) bool, row 0 in the south."""
    grown = shapely.transform(solid, lambda points: points * cells)
    found: Bools = squares(grown, world.width * cells, world.height * cells)
    return found
