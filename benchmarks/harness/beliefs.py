"""The robot's beliefs, brought to the table frame and compared with the truth.

Only the campaign knows both sides. The robot keeps its map in a frame of its own, turned by some quarter turns against
the table, and its world model hangs on the robot itself. So the two maps are aligned at the square in which the robot
stands at the end. The place where it woke must then fall on (0, 0) of the map frame; the difference is its drift.
"""

import math
from collections.abc import Iterable, Mapping
from itertools import product
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from shapely import Polygon, box, union_all
from shapely.affinity import affine_transform

from benchmarks.worlds.furniture import OUTLINE_SHAPES

SETTLED_FULL = 1  # the state of kb.mapping.occupancy of a square that is certainly occupied
FOVEA_HALF_WIDTH = 4  # squares from the robot to the edge of its fovea
LINE_TOLERANCE = 1e-5  # squares from a line between two squares to a point that is on it
MIN_SHARED_PART = 0.1  # the least common part of union for a believed object to be the true one


class SeenBeliefs(NamedTuple):
    """The beliefs of a robot, in squares, table frame.

    Attributes
    ----------
    objects : (class, polygon) of the objects of its model.
    certain : (x, y, occupied), the squares held with confidence 100.
    drift : how far its map has slipped from where it woke, in squares (the greater of both axes).
    """

    objects: list[tuple[str, Polygon]]
    certain: list[tuple[int, int, bool]]
    drift: int = 0


class Score(NamedTuple):
    """The comparison of beliefs with the truth: objects seen by the fovea, right ones; certain squares, wrong ones."""

    met: int
    known: int
    whole: int
    whole_known: int
    certain: int
    wrong: int
    drift: int
    mistaken: tuple[str, ...]


class TableFrame(NamedTuple):
    """The table frame seen from the map frame: quarter turns, and the table's square at (0, 0) of the map."""

    quarters: int
    east: int
    north: int

    def square(self, x: int, y: int) -> tuple[int, int]:
        """Convert a square of the map frame to a square of the table frame."""
        for _ in range(self.quarters):
            x, y = -y, x
        return x + self.east, y + self.north

    def polygon(self, shape: Any) -> Polygon:
        """Convert a polygon of the map frame to a polygon of the table frame."""
        c, s = [(1, 0), (0, 1), (-1, 0), (0, -1)][self.quarters]
        x = self.east + 0.5 - c * 0.5 + s * 0.5
        y = self.north + 0.5 - s * 0.5 - c * 0.5
        return affine_transform(shape, [c, -s, s, c, x, y])


def beliefs(robot: Any, origin: tuple[float, float], now: tuple[float, float], heading: int) -> SeenBeliefs:
    """Return the beliefs of a robot at the end; empty when it exposes no model.

    Parameters
    ----------
    robot : has `model` with `frame`, `place`, `objects` and `view`, as in kb.world.model.
    origin, now : where it woke and where it stands, points of the table frame.
    heading : the direction that it faced when it woke, in degrees from table north.
    """
    model = getattr(robot, "model", None)
    if model is None:
        return SeenBeliefs([], [])
    frame, drift = table_frame(model, origin, now, heading)
    objects = [(_class(node.shape), frame.polygon(_outline(node))) for node in model.objects]
    rows, columns = np.nonzero(model.certain)
    full = model.view.state[rows, columns] == SETTLED_FULL
    west, south = model.view.west, model.view.south
    certain = [
        (*frame.square(column + west, row + south), bool(occupied))
        for row, column, occupied in zip(rows.tolist(), columns.tolist(), full.tolist(), strict=True)
    ]
    return SeenBeliefs(objects, certain, drift)


def table_frame(
    model: Any, origin: tuple[float, float], now: tuple[float, float], heading: float
) -> tuple[TableFrame, int]:
    """Return the table frame seen from the map frame of a model, and the drift in squares; arguments as `beliefs`."""
    quarters = round((heading - model.frame.angle) / 90) % 4
    x, y = TableFrame(quarters, 0, 0).square(*(math.floor(v) for v in model.place))
    frames = [TableFrame(quarters, east - x, north - y) for east, north in _beside(now)]
    drift, frame = min(
        (max(abs(frame.east - math.floor(origin[0])), abs(frame.north - math.floor(origin[1]))), frame)
        for frame in frames
    )
    return frame, drift


def _beside(place: tuple[float, float]) -> Iterable[tuple[int, int]]:
    """Return the square of a point; on a grid line the squares on both sides, for the robot may be in either."""
    return product(*({math.floor(v - LINE_TOLERANCE), math.floor(v + LINE_TOLERANCE)} for v in place))


def _class(shape: Mapping[str, int]) -> str:
    """Return the class believed most, among equals the first by name; rectangle and polygon count as none."""
    narrow = {name: sure for name, sure in shape.items() if name in OUTLINE_SHAPES} or shape
    return min(narrow, key=lambda name: (-narrow[name], name)) if narrow else "unknown"


def _outline(node: Any) -> Any:
    if node.polygon is not None:
        return node.polygon
    return union_all([box(x, y, x + 1, y + 1) for x, y in sorted(node.patch.squares())])


def under_fovea(track: Iterable[tuple[float, float]], heading: int) -> set[tuple[int, int]]:
    """Return the table's squares that were ever under the 8 x 8 squares of the fovea."""
    c, s = math.cos(math.radians(heading)), math.sin(math.radians(heading))
    offsets = [
        (e, n) for e in range(-FOVEA_HALF_WIDTH, FOVEA_HALF_WIDTH) for n in range(-FOVEA_HALF_WIDTH, FOVEA_HALF_WIDTH)
    ]
    turned = {(round(e * c - n * s), round(e * s + n * c)) for e, n in offsets}
    halts = {(math.floor(x), math.floor(y)) for x, y in track}
    return {(x + dx, y + dy) for x, y in halts for dx, dy in turned}


def squares_of(grid: NDArray[np.bool_]) -> set[tuple[int, int]]:
    """Return the squares (x, y) of a digital representation."""
    rows, columns = np.nonzero(grid)
    return set(zip(columns.tolist(), rows.tolist(), strict=True))


def compare(
    held: SeenBeliefs,
    things: Mapping[str, tuple[str, Polygon, NDArray[np.bool_]]],
    occupied: NDArray[np.bool_],
    seen: set[tuple[int, int]],
) -> Score:
    """Compare beliefs with the truth.

    Parameters
    ----------
    held : the beliefs.
    things : by name, the class, polygon and digital representation (height, width) of each object at the end.
    occupied : (height, width), all that is not floor; beyond it all is verge.
    seen : the squares that were ever under the fovea.
    """
    met = known = whole = whole_known = 0
    mistaken = []
    for name, (kind, polygon, grid) in sorted(things.items()):
        squares = squares_of(grid)
        if not squares & seen:
            continue
        believed = _match(held, polygon)
        met, known = met + 1, known + (believed == kind)
        if squares <= seen:
            whole, whole_known = whole + 1, whole_known + (believed == kind)
        if believed != kind:
            mistaken.append(f"{name}: {kind} taken for {believed}")
    height, width = occupied.shape
    wrong = sum(full != (occupied[y, x] if 0 <= x < width and 0 <= y < height else True) for x, y, full in held.certain)
    return Score(met, known, whole, whole_known, len(held.certain), int(wrong), held.drift, tuple(mistaken))


def _match(held: SeenBeliefs, polygon: Polygon) -> str:
    """Return the class of the believed object that covers the true one best; "nothing" where none does."""
    best, name = MIN_SHARED_PART, "nothing"
    for kind, shape in held.objects:
        common = shape.intersection(polygon).area
        part = common / (shape.area + polygon.area - common)
        if part > best:
            best, name = part, kind
    return name
