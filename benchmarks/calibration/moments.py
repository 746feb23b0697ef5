"""One moment of a run: what is believed, and what is true of the nodes, rooms and regions that belief speaks of."""

import math
from collections.abc import Iterable, Iterator, Mapping
from typing import Any, NamedTuple

import numpy as np

from benchmarks.calibration.truth import NodeTruth, TableTruth
from benchmarks.calibration.whereabouts import TrueAlternatives
from benchmarks.harness.beliefs import TableFrame
from utak.geometry.kernels.arrays import XY, Bools, Labels, Square
from utak.kb.language.atoms import atom_parts
from utak.kb.mapping.patch import patch_of_polygon
from utak.kb.perception.frame import Frame
from utak.kb.task.task import Task
from utak.kb.world.rooms import Rooms

HUNDREDTHS = 100  # of a square: the unit of lengths in facts
MIDDLE = 0.5  # squares: the middle of square (0, 0)
HELD_CONFIDENCE = 100  # percent: of an object that was held, and of no other
SOLID = 0.5  # the chance to be occupied from which a square seems so: more likely than not


class Alignment(NamedTuple):
    """The place of the table in what is believed."""

    frame: Frame  # of the robot, in its map
    table: TableFrame  # of the map, on the table

    def point(self, east: float, north: float) -> XY:
        """Return a point of the robot frame, in squares, as a point of the table: corners of squares are such again."""
        x, y = self.frame.place_from_utak(east, north)
        (ax, ay), (bx, by), (cx, cy) = (self.table.square(*square) for square in ((0, 0), (1, 0), (0, 1)))
        right, up = x - MIDDLE, y - MIDDLE
        return (
            ax + MIDDLE + right * (bx - ax) + up * (cx - ax),
            ay + MIDDLE + right * (by - ay) + up * (cy - ay),
        )


class Moment(NamedTuple):
    """One moment of a run: what is believed, and what is true."""

    facts: tuple[str, ...]  # without full stops
    nodes: Mapping[str, NodeTruth]  # what each believed object is
    squares: Mapping[str, frozenset[Square]]  # of each node, table frame
    truth: TableTruth
    rooms: Mapping[str, frozenset[Square]] = {}  # the floor of each believed room, table frame
    regions: Mapping[str, frozenset[Square]] = {}  # the squares of each region of the map, table frame
    solid: frozenset[Square] = frozenset()  # squares that seem occupied, being so with 50 percent or more; table frame
    alignment: Alignment | None = None  # None: places are told from the robot's alone
    alternatives: TrueAlternatives | None = None  # None: what may be is not compared

    def place(self, east: int, north: int) -> XY:
        """Return a point, hundredths of squares in the robot frame, as a point of the table, in squares.

        The robot is where it is in truth: an error of its place alone makes no statement false.
        """
        here = next(
            arguments for name, arguments in map(atom_parts, self.facts) if name == "offset" and arguments[0] == "org"
        )
        x, y = ((value - int(own)) / HUNDREDTHS for value, own in zip((east, north), here[1:], strict=True))
        c, s = math.cos(math.radians(self.truth.heading)), math.sin(math.radians(self.truth.heading))
        return x * c - y * s + self.truth.utak[0], x * s + y * c + self.truth.utak[1]

    def on_grid(self, east: int, north: int) -> XY:
        """Return the same, as the squares of the map lie on those of the table: what is a whole number stays one."""
        return (
            self.alignment.point(east / HUNDREDTHS, north / HUNDREDTHS) if self.alignment else self.place(east, north)
        )

    def rows(self, name: str, arity: int) -> Iterator[tuple[str, ...]]:
        """Yield the arguments of the facts of a predicate."""
        for told, arguments in map(atom_parts, self.facts):
            if told == name and len(arguments) == arity:
                yield arguments


def moment_of(
    task: Task, model: Any, facts: tuple[str, ...], truth: TableTruth, table: TableFrame, rooms: Rooms
) -> Moment:
    """Return a moment. model : kb.world.model.WorldModel. table : where the table lies in its map."""
    squares = {node.name: frozenset(table.square(*square) for square in _lies_on(node)) for node in model.objects}
    nodes = {name: truth.of(there) for name, there in squares.items()}
    view = model.view
    wholes = {"floor": model.floor, "verge": model.verge}
    squares |= {name: squares_of(mask, view.south, view.west, table) for name, mask in wholes.items()}
    return Moment(
        facts,
        nodes,
        squares,
        truth,
        dict(labelled(rooms.labels, "r", view.south, view.west, table)),
        dict(labelled(model.labels, "part", view.south, view.west, table)),
        squares_of(view.probability >= SOLID, view.south, view.west, table),
        Alignment(model.frame, table),
        TrueAlternatives(task, model, rooms, table, truth, nodes),
    )


def _lies_on(node: Any) -> Iterable[Square]:
    """Return the squares of a node, map frame: of what was held those of its outline, not all that it may cover."""
    was_held = node.confidence == HELD_CONFIDENCE and node.polygon is not None
    return (patch_of_polygon(node.polygon) if was_held else node.patch).squares()


def labelled(
    labels: Labels, prefix: str, south: int, west: int, table: TableFrame
) -> Iterator[tuple[str, frozenset[Square]]]:
    """Yield the names of the parts of a map that have a label above 0, with their squares, table frame."""
    for number in np.unique(labels[labels > 0]).tolist():
        yield f"{prefix}{number}", squares_of(labels == number, south, west, table)


def squares_of(mask: Bools, south: int, west: int, table: TableFrame) -> frozenset[Square]:
    """Return the squares of a mask, table frame. south, west : the map's square of its row 0, column 0."""
    rows, columns = np.nonzero(mask)
    pairs = zip(rows.tolist(), columns.tolist(), strict=True)
    return frozenset(table.square(column + west, row + south) for row, column in pairs)
