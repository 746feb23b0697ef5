"""Statements of belief that may be otherwise, compared with the truth: the table of predicates, a row for each form.

A new predicate, or a new form with a confidence, is one more row of STATEMENTS.
"""

import math
from collections.abc import Callable, Iterator, Mapping
from typing import Any, NamedTuple

import numpy as np
import shapely
from shapely import LineString, Point

from benchmarks.calibration.figures import RECTANGLE
from benchmarks.calibration.truth import FLOOR, VERGE, NodeTruth, TableTruth
from benchmarks.calibration.whereabouts import TrueAlternatives
from benchmarks.worlds.furniture import OUTLINE_SHAPES
from benchmarks.worlds.odd.houses import COMPASS
from utak.geometry.kernels.arrays import XY, Square
from utak.kb.language.atoms import atom_parts

CERTAIN = 100  # percent: of a form without confidence, which says that it is known
HUNDREDTHS = 100  # of a square: the unit of lengths in facts
DOOR_DISTANCE = 1.0  # squares from the narrowest line of a believed door to the true one
WIDTH_TOLERANCE = 1.0  # squares: a width stated as one number is right within so much, as an end lies in some square
FURTHEST_CORNER_DISTANCE = 1.0  # squares in each axis of the table, as DESIGN says when the robot is at a corner
CORNERLESS = ("disc",)


class Moment(NamedTuple):
    """One moment of a run: what is believed, and what is true."""

    facts: tuple[str, ...]  # without full stops
    nodes: Mapping[str, NodeTruth]  # what each believed object is
    squares: Mapping[str, frozenset[Square]]  # of each node, table frame
    truth: TableTruth
    alternatives: TrueAlternatives

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


class HeldStatement(NamedTuple):
    """One statement of belief, with its confidence in percent and whether it is true."""

    predicate: str  # name/arity
    fact: str
    confidence: int
    true: bool
    alternatives: str = ""  # statements with the same text exclude each other; "" for those that exclude none


# Whether a fact with these arguments is true; None where the truth does not say.
IsTrue = Callable[[Moment, tuple[str, ...]], bool | None]


class Row(NamedTuple):
    """The meaning of a form of a predicate."""

    is_true: IsTrue
    confidence: int | None = None  # which argument it is; None: the form says that it is known
    exclusive: bool = False  # whether statements about one thing exclude each other


def statements(moment: Moment) -> Iterator[HeldStatement]:
    """Yield the statements of a moment that the truth decides."""
    for fact in moment.facts:
        name, arguments = atom_parts(fact)
        row = STATEMENTS.get((name, len(arguments)))
        true = None if row is None else row.is_true(moment, arguments)
        if row is None or true is None:
            continue
        sure = CERTAIN if row.confidence is None else int(arguments[row.confidence])
        excludes = f"{name}({arguments[0]})" if row.exclusive and arguments[1] not in ("rectangle", "polygon") else ""
        yield HeldStatement(f"{name}/{len(arguments)}", fact, sure, true, excludes)


def _kind(moment: Moment, arguments: tuple[str, ...]) -> bool | None:
    found = moment.nodes.get(arguments[0])  # None for the robot, the floor and the verge: each is what its name says
    return None if found is None else found.kind == arguments[1]


def _shape(moment: Moment, arguments: tuple[str, ...]) -> bool | None:
    node, shape = arguments[:2]
    true = moment.nodes[node].shape if node in moment.nodes else None
    if true is None:  # what is no object has no class
        return None
    if shape == "polygon":
        return true not in CORNERLESS
    if shape == RECTANGLE:
        return true in ("square", "brick", RECTANGLE)
    return None if true == RECTANGLE and shape in ("square", "brick") else true == shape


def _colour(moment: Moment, arguments: tuple[str, ...]) -> bool | None:
    found = moment.nodes.get(arguments[0])
    if found is None or found.kind == FLOOR:
        return None
    return arguments[1] == ("b" if found.thing is None else moment.truth.things[found.thing].colour)


def _movable(moment: Moment, arguments: tuple[str, ...]) -> bool | None:
    found = moment.nodes.get(arguments[0])
    if found is None:
        return None
    return found.thing is not None and not moment.truth.things[found.thing].fixed


def _adjacent(moment: Moment, arguments: tuple[str, ...]) -> bool | None:
    first, second = (_true_squares(moment, node) for node in arguments[:2])
    if first is None or second is None:
        return None
    return any((x + i, y + j) in second for x, y in first for i in (-1, 0, 1) for j in (-1, 0, 1))


def _true_squares(moment: Moment, node: str) -> set[Square] | None:
    """Return the true squares of a node; none of what is floor, None of what is no single thing."""
    if node in ("org", "utak"):
        return moment.truth.robot_squares
    if node == VERGE:
        return moment.truth.about(VERGE)
    found = moment.nodes.get(node)
    if found is None:
        return None
    if found.thing is not None:
        return moment.truth.about(found.thing)
    return moment.truth.about(VERGE) if found.kind == VERGE else set()


def _true_door(moment: Moment, door: str) -> float | None:
    """Return the width of the true door where a believed one is, in squares; 0 for none, None where nobody says."""
    if moment.truth.doors is None:
        return None
    for name, arguments in map(atom_parts, moment.facts):
        if name == "threshold" and arguments[0] == door:
            a, b = (moment.place(*map(int, arguments[i : i + 2])) for i in (1, 3))
            middle = LineString([a, b]).interpolate(0.5, normalized=True)
            near = [width for shape, width in moment.truth.doors if shape.distance(middle) <= DOOR_DISTANCE]
            return near[0] if near else 0.0
    return None


def _door(moment: Moment, arguments: tuple[str, ...]) -> bool | None:
    width = _true_door(moment, arguments[0])
    return None if width is None else width > 0


def _width(moment: Moment, arguments: tuple[str, ...]) -> bool | None:
    width = _true_door(moment, arguments[0])
    if not width:  # what is no door has no width
        return None
    least, *most = (int(value) / HUNDREDTHS for value in arguments[1:3])
    return least - 1e-2 <= width <= most[0] + 1e-2 if most else abs(width - least) <= WIDTH_TOLERANCE


def _width_as_one(moment: Moment, arguments: tuple[str, ...]) -> bool | None:
    return _width(moment, arguments[:2])


def _corner(moment: Moment, arguments: tuple[str, ...]) -> bool | None:
    """Whether it is the furthest corner of the whole floor; corner/3 speaks of the known floor, and is left out."""
    side = COMPASS[arguments[0]]
    x, y = moment.place(*map(int, arguments[1:3]))
    c, s = math.cos(math.radians(moment.truth.heading)), math.sin(math.radians(moment.truth.heading))
    way = np.array([side[0] * c - side[1] * s, side[0] * s + side[1] * c])
    floor = next(
        (part for part in shapely.get_parts(moment.truth.floor) if part.distance(Point(moment.truth.utak)) < 1e-6), None
    )
    if floor is None:
        return None
    corners = shapely.get_coordinates(floor.exterior)
    best = corners[(corners @ way) >= (corners @ way).max() - 1e-6]
    return bool((np.abs(best - (x, y)).max(axis=1) <= FURTHEST_CORNER_DISTANCE).any())


def _may_be(moment: Moment, arguments: tuple[str, ...]) -> bool | None:
    place = moment.alternatives.place(arguments[0])
    return None if place is None else place == arguments[1]


def _joined(moment: Moment, arguments: tuple[str, ...]) -> bool | None:
    return moment.alternatives.is_one_thing(*arguments[:2])


STATEMENTS: Mapping[tuple[str, int], Row] = {
    ("kind", 3): Row(_kind, 2, True),
    ("shape", 3): Row(_shape, 2, True),
    ("colour", 3): Row(_colour, 2),
    ("movable", 2): Row(_movable, 1),
    ("adjacent", 2): Row(_adjacent),
    ("adjacent", 3): Row(_adjacent, 2),
    ("door", 1): Row(_door),
    ("door", 2): Row(_door, 1),
    ("width", 2): Row(_width_as_one),
    ("width", 4): Row(_width, 3),
    ("corner", 4): Row(_corner, 3),
    ("may_be", 3): Row(_may_be, 2, True),
    ("joined", 3): Row(_joined, 2),
}
CLASS_NAMES = OUTLINE_SHAPES


def moment_of(robot: Any, facts: tuple[str, ...], truth: TableTruth, frame: Any) -> Moment:
    """Return a moment. frame : where the table lies in the map of the model, as `benchmarks.harness.beliefs` says."""
    model, decider = robot.model, robot.decider
    squares = {node.name: frozenset(frame.square(*square) for square in node.patch.squares()) for node in model.objects}
    nodes = {name: truth.of(there) for name, there in squares.items()}
    alternatives = TrueAlternatives(decider.task, model, decider.rooms, frame, truth, nodes)
    return Moment(facts, nodes, squares, truth, alternatives)
