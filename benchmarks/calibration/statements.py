"""Statements of belief that may be otherwise, compared with the truth: the table of predicates, a row for each form.

A new predicate, or a new form with a confidence, is one more row of STATEMENTS.
"""

from collections.abc import Callable, Collection, Iterator, Mapping
from typing import NamedTuple

import numpy as np

from benchmarks.calibration.figures import RECTANGLE
from benchmarks.calibration.moments import Moment
from benchmarks.calibration.places import does_connect, is_corner, is_door, is_in, is_width
from benchmarks.calibration.truth import FLOOR, VERGE
from utak.geometry.kernels.arrays import Square
from utak.kb.language.atoms import atom_parts
from utak.kb.world.facts import SEGMENT_SAMPLES

CERTAIN = 100  # percent: of a form without confidence, which says that it is known
CORNERLESS = ("disc",)
CLASS_GROUPS = ("rectangle", "polygon")  # of classes: they exclude none of their own
WHOLES = (FLOOR, VERGE)  # nodes that are shares of many squares


class HeldStatement(NamedTuple):
    """One statement of belief, with its confidence in percent and whether it is true."""

    predicate: str  # name/arity
    fact: str
    confidence: int
    true: float  # 1 or 0; the share of squares that are so for what speaks of many
    alternatives: str = ""  # statements with the same text exclude each other; "" for those that exclude none


# Whether a fact with these arguments is true, or to what share; None where the truth does not say.
IsTrue = Callable[[Moment, tuple[str, ...]], float | None]


class Row(NamedTuple):
    """The meaning of a form of a predicate."""

    is_true: IsTrue
    confidence: int | None = None  # which argument it is; None: the form says that it is known
    exclusive: bool = False  # whether statements about one thing exclude each other
    known_alone: bool = False  # whether only those at 100 are compared: less is a share of evidence, not a chance


def statements(moment: Moment, names: Collection[str] = ()) -> Iterator[HeldStatement]:
    """Yield the statements of a moment that the truth decides. names : of predicates, if not of all."""
    for fact in moment.facts:
        name, arguments = atom_parts(fact)
        if names and name not in names:
            continue
        row = STATEMENTS.get((name, len(arguments)))
        if row is None:
            continue
        sure = CERTAIN if row.confidence is None else int(arguments[row.confidence])
        true = row.is_true(moment, arguments) if sure == CERTAIN or not row.known_alone else None
        if true is None:
            continue
        exclusive = row.exclusive and arguments[0] not in WHOLES and arguments[1] not in CLASS_GROUPS
        excludes = f"{name}({arguments[0]})" if exclusive else ""
        yield HeldStatement(f"{name}/{len(arguments)}", fact, sure, float(true), excludes)


def _kind(moment: Moment, arguments: tuple[str, ...]) -> float | None:
    """Return whether a node is of a kind; for the floor and the verge the share of their squares that are."""
    node, kind = arguments[:2]
    if node in WHOLES:
        squares = moment.squares.get(node)
        return sum(moment.truth.is_kind(square, kind) for square in squares) / len(squares) if squares else None
    found = moment.nodes.get(node)  # None for the robot, which is what its name says
    return None if found is None else found.kind == kind


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
    if found is None or found.several:
        return None
    if found.thing is not None:
        return moment.truth.about(found.thing)
    return moment.truth.about(VERGE) if found.kind == VERGE else set()


def _region(moment: Moment, arguments: tuple[str, ...]) -> float | None:
    """Return the share of a region's squares that are as it says."""
    squares = moment.regions.get(arguments[0])
    if not squares:
        return None
    return sum(moment.truth.seems(square, arguments[1] == "nonzero") for square in squares) / len(squares)


def _segment(moment: Moment, arguments: tuple[str, ...]) -> float | None:
    """Return the share of the squares on both sides of a line that are as they seem, free or occupied."""
    ends = np.array([moment.on_grid(*map(int, arguments[i : i + 2])) for i in (2, 4)])
    step = ends[1] - ends[0]
    length = float(np.hypot(*step))
    if length < 1e-9:
        return None
    across = np.array([-step[1], step[0]]) / (2 * length)
    along = ends[0] + (np.arange(SEGMENT_SAMPLES)[:, None] + 0.5) / SEGMENT_SAMPLES * step
    squares = [(x, y) for x, y in np.floor(np.concatenate([along + across, along - across])).astype(int).tolist()]
    return sum(moment.truth.seems(one, one in moment.solid) for one in squares) / len(squares)


def _may_be(moment: Moment, arguments: tuple[str, ...]) -> bool | None:
    place = moment.alternatives and moment.alternatives.place(arguments[0])
    return None if place is None else place == arguments[1]


def _joined(moment: Moment, arguments: tuple[str, ...]) -> bool | None:
    return moment.alternatives and moment.alternatives.is_one_thing(*arguments[:2])


def _hidden(moment: Moment, arguments: tuple[str, ...]) -> bool | None:
    return moment.alternatives and moment.alternatives.led_to(arguments[0]) == arguments[1]


def _plug(moment: Moment, arguments: tuple[str, ...]) -> bool | None:
    return moment.alternatives and moment.alternatives.is_plug(arguments[0])


def _loc(moment: Moment, arguments: tuple[str, ...]) -> bool | None:
    return moment.alternatives and moment.alternatives.stands(*map(int, arguments[:2]))


STATEMENTS: Mapping[tuple[str, int], Row] = {
    ("kind", 3): Row(_kind, 2, True),
    ("shape", 3): Row(_shape, 2, True),
    ("colour", 3): Row(_colour, 2),
    ("movable", 2): Row(_movable, 1),
    ("adjacent", 3): Row(_adjacent, 2),
    ("may_be", 3): Row(_may_be, 2, True),
    ("joined", 3): Row(_joined, 2),
    ("hidden", 3): Row(_hidden, 2, True),
    ("plug", 2): Row(_plug, 1),
    ("loc", 3): Row(_loc, 2),
    ("region", 3): Row(_region, 2),
    ("door", 2): Row(is_door, 1),
    ("connects", 4): Row(does_connect, 3),
    ("width", 3): Row(is_width),
    ("in", 3): Row(is_in, 2, True),
    ("corner", 4): Row(is_corner, 3),
    ("segment", 7): Row(_segment, 6, known_alone=True),
}
