"""The truth of one moment of a run, by square of the table: what lies where, and what a believed node is."""

import math
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from shapely import Polygon

from benchmarks.calibration.dealt import DealtWorld
from benchmarks.calibration.figures import NO_CLASS, class_of
from benchmarks.calibration.necks import door_necks
from benchmarks.harness.beliefs import TableFrame, table_frame
from benchmarks.worlds.placing import digital
from utak.geometry.kernels.arrays import XY, Bools, Square

VERGE, FLOOR = "verge", "floor"
# Other things cover at least so great a part of the squares that the first one covers: then a node is several things.
SEVERAL_SHARE = 0.25
TRACK_STEP = 0.05  # squares from sample to sample of a track


TrueDoor = tuple[Polygon, float]  # its shape, table frame, and its width, both in squares


class NodeTruth(NamedTuple):
    """The truth about a believed node, or a region."""

    kind: str  # object, verge or floor: what covers most of its squares; floor only where nothing else covers any
    thing: str | None  # the thing that covers most of its squares, if its kind is object
    shape: str | None  # the class of the thing; NO_CLASS for several things together; None where there is none
    several: bool = False  # whether other things cover a good part of it, too


class TableTruth:
    """The truth of one moment."""

    def __init__(self, dealt: DealtWorld, polygons: dict[str, Polygon], utak: XY, track: Sequence[XY] = ()) -> None:
        """Take the movable things as they lie now, and where the robot stands, both in the table frame.

        track : where it stood so far. Squares that it crossed are floor and verge where verge covers them in part.
        """
        world = dealt.world
        self.utak, self.woke = utak, (world.utak.x, world.utak.y)
        self.width, self.height = world.plan.width, world.plan.height
        self.heading = float(world.heading)
        self.floor = world.plan.floor
        self.doors = dealt.doors if dealt.doors is not None else door_necks(self.floor, self.width, self.height)
        self.things = {thing.name: thing for thing in world.things}
        self.polygons = {name: polygons.get(name, thing.polygon) for name, thing in self.things.items()}
        self._verge = _digital(world.plan.verge, self.width, self.height)
        self._covers = {name: _digital(shape, self.width, self.height) for name, shape in self.polygons.items()}
        self._crossed = set(_crossed(track))
        self._solid: Bools = np.logical_or.reduce([self._verge, *self._covers.values()])

    def of(self, squares: Iterable[Square]) -> NodeTruth:
        """Return what a node with some squares of the table is."""
        there = list(squares)
        count = Counter({name: self._covered(cover, there) for name, cover in self._covers.items()})
        verge = sum(1 for square in there if self._is_verge(square))
        (first, most), *others = [*count.most_common(), ("", 0)]
        if max(most, verge) == 0:
            return NodeTruth(FLOOR, None, None)
        if sum(count.values()) <= verge:
            return NodeTruth(VERGE, None, None)
        several = sum(number for _, number in others) >= SEVERAL_SHARE * most
        return NodeTruth("object", first, NO_CLASS if several else class_of(self.polygons[first]), several)

    def about(self, name: str) -> set[Square]:
        """Return the squares of a thing, or of the verge, within the table."""
        rows, columns = np.nonzero(self._verge if name == VERGE else self._covers[name])
        return set(zip(columns.tolist(), rows.tolist(), strict=True))

    def is_kind(self, square: Square, kind: str) -> bool:
        """Return whether a square is floor, verge or object, whatever covers it in part or wholly."""
        if self._is_either(square):
            return kind in (FLOOR, VERGE)
        return kind == (VERGE if self._is_verge(square) else "object" if self._is_solid(square) else FLOOR)

    def seems(self, square: Square, occupied: bool) -> bool:
        """Return whether a square is occupied, or free, as it seems: what is crossed and covered in part is both."""
        return self._is_either(square) or self._is_solid(square) == occupied

    def is_floor(self, square: Square) -> bool:
        """Return whether a square is floor as it seems, also beneath a thing that can be moved."""
        x, y = square
        return self.seems(square, False) or any(cover[y, x] for cover in self._covers.values())

    def _is_solid(self, square: Square) -> bool:
        x, y = square
        return not (0 <= x < self.width and 0 <= y < self.height) or bool(self._solid[y, x])

    def _is_either(self, square: Square) -> bool:
        """Return whether verge covers a square in part that the robot crossed."""
        x, y = square
        return square in self._crossed and self._is_verge(square) and not any(c[y, x] for c in self._covers.values())

    @property
    def robot_squares(self) -> set[Square]:
        """The squares on which the robot may be said to stand: two or four on a line of the grid."""
        columns, rows = ({math.floor(v - 1e-6), math.floor(v + 1e-6)} for v in self.utak)
        return {(column, row) for column in columns for row in rows}

    def _covered(self, cover: Bools, squares: list[Square]) -> int:
        return sum(1 for x, y in squares if 0 <= x < self.width and 0 <= y < self.height and cover[y, x])

    def _is_verge(self, square: Square) -> bool:
        x, y = square
        return not (0 <= x < self.width and 0 <= y < self.height) or bool(self._verge[y, x])


def _crossed(track: Sequence[XY]) -> Iterator[Square]:
    """Yield the squares that a track crosses, sampled finely."""
    for (x, y), (u, v) in pairwise(track):
        parts = np.linspace(0, 1, max(2, math.ceil(math.dist((x, y), (u, v)) / TRACK_STEP)))
        yield from {(math.floor(x + part * (u - x)), math.floor(y + part * (v - y))) for part in parts.tolist()}


_DIGITAL: dict[bytes, Bools] = {}


def _digital(shape: Any, width: int, height: int) -> Bools:
    """Return the squares of a shape, (height, width) bool; those of a shape seen before are remembered."""
    key = shape.wkb + bytes([width % 256, height % 256])
    if key not in _DIGITAL:
        if len(_DIGITAL) > 4096:
            _DIGITAL.clear()
        _DIGITAL[key] = np.asarray(digital(shape, width, height))
    return _DIGITAL[key]


def frame_of(model: Any, truth: TableTruth, origin: tuple[float, float]) -> TableFrame:
    """Return where the table's squares lie in the map of a model. origin : where the robot woke, table frame."""
    return table_frame(model, origin, truth.utak, truth.heading)[0]
