"""What the robot believes, brought to the table's frame and compared with the truth.

Only the campaign knows both sides. The robot keeps his map on the lattice of the table's squares, turned by some
quarter turns, and his world model hangs on himself: so the two maps are laid on each other at the square in which he
stands at the end. Where he woke must then fall on (0, 0) of the lattice; by how much it does not is his drift.
"""

import math
from collections.abc import Iterable, Mapping
from itertools import product
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from shapely import Polygon, box, union_all
from shapely.affinity import affine_transform

from benchmarks.worlds.furniture import SHAPES

FULL = 1  # the state of kb.mapping.occupancy of a square that is certainly occupied
FOVEA = 4  # squares from Utak to the edge of his fovea
HAIR = 1e-5  # squares from a line between two squares to a point that is on it
NEAR = 0.1  # the least common part of union for a believed object to be the true one


class SeenBeliefs(NamedTuple):
    """What a robot holds, in squares of the table.

    objects : (class, polygon) of the objects of his model. certain : (x, y, occupied) squares held with confidence 100.
    drift : how far his map has slipped from where he woke, in squares (the greater of both axes).
    """

    objects: list[tuple[str, Polygon]]
    certain: list[tuple[int, int, bool]]
    drift: int = 0


class Score(NamedTuple):
    """How beliefs compare with the truth: objects in sight of the fovea, those right; certain squares, those wrong."""

    met: int
    known: int
    whole: int
    whole_known: int
    certain: int
    wrong: int
    drift: int
    mistaken: tuple[str, ...]


class Frame(NamedTuple):
    """The table's frame seen from the robot's lattice: quarter turns, and the table's square at (0, 0)."""

    quarters: int
    east: int
    north: int

    def square(self, x: int, y: int) -> tuple[int, int]:
        """A square of the lattice as a square of the table."""
        for _ in range(self.quarters):
            x, y = -y, x
        return x + self.east, y + self.north

    def polygon(self, shape: Any) -> Polygon:
        """A polygon of the lattice as a polygon of the table."""
        c, s = [(1, 0), (0, 1), (-1, 0), (0, -1)][self.quarters]
        x = self.east + 0.5 - c * 0.5 + s * 0.5
        y = self.north + 0.5 - s * 0.5 - c * 0.5
        return affine_transform(shape, [c, -s, s, c, x, y])


def beliefs(robot: Any, origin: tuple[float, float], now: tuple[float, float], heading: int) -> SeenBeliefs:
    """What a robot believes at the end; empty when he exposes no model.

    Parameters
    ----------
    robot : has `model` with `lattice.angle`, `place`, `objects` and `view`, as in kb.world.model.
    woke, now : the table's points where he woke and where he stands. heading : degrees from table north, as he woke.
    """
    model = getattr(robot, "model", None)
    if model is None:
        return SeenBeliefs([], [])
    quarters = round((heading - model.frame.angle) / 90) % 4
    x, y = Frame(quarters, 0, 0).square(*(math.floor(v) for v in model.place))
    frames = [Frame(quarters, east - x, north - y) for east, north in _beside(now)]
    drift, frame = min(
        (max(abs(frame.east - math.floor(origin[0])), abs(frame.north - math.floor(origin[1]))), frame)
        for frame in frames
    )
    objects = [(_class(node.shape), frame.polygon(_outline(node))) for node in model.objects]
    rows, columns = np.nonzero(model.certain)
    full = model.view.state[rows, columns] == FULL
    west, south = model.view.west, model.view.south
    certain = [
        (*frame.square(column + west, row + south), bool(occupied))
        for row, column, occupied in zip(rows.tolist(), columns.tolist(), full.tolist(), strict=True)
    ]
    return SeenBeliefs(objects, certain, drift)


def _beside(place: tuple[float, float]) -> Iterable[tuple[int, int]]:
    """The square of a point; right on a line those to either side, for he may be believed to stand on any of them."""
    return product(*({math.floor(v - HAIR), math.floor(v + HAIR)} for v in place))


def _class(shape: Mapping[str, int]) -> str:
    """The class believed most; of equals the first by name. Rectangle and polygon stand in for none."""
    narrow = {name: sure for name, sure in shape.items() if name in SHAPES} or shape
    return min(narrow, key=lambda name: (-narrow[name], name)) if narrow else "unknown"


def _outline(node: Any) -> Any:
    if node.polygon is not None:
        return node.polygon
    return union_all([box(x, y, x + 1, y + 1) for x, y in sorted(node.patch.squares())])


def under_fovea(track: Iterable[tuple[float, float]], heading: int) -> set[tuple[int, int]]:
    """The table's squares that were ever under the 8 x 8 squares of the fovea."""
    c, s = math.cos(math.radians(heading)), math.sin(math.radians(heading))
    offsets = [(e, n) for e in range(-FOVEA, FOVEA) for n in range(-FOVEA, FOVEA)]
    turned = {(round(e * c - n * s), round(e * s + n * c)) for e, n in offsets}
    halts = {(math.floor(x), math.floor(y)) for x, y in track}
    return {(x + dx, y + dy) for x, y in halts for dx, dy in turned}


def squares_of(grid: NDArray[np.bool_]) -> set[tuple[int, int]]:
    """The squares (x, y) of a digital representation."""
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
    """The class of the believed object that covers the true one best; "nothing" where none does."""
    best, name = NEAR, "nothing"
    for kind, shape in held.objects:
        common = shape.intersection(polygon).area
        part = common / (shape.area + polygon.area - common)
        if part > best:
            best, name = part, kind
    return name
