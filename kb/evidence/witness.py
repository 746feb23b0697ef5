"""Reasons that are cells of impressions, colours that were felt, and commands that were given."""

import math
from collections.abc import Iterable, Sequence
from functools import lru_cache
from typing import Any

import numpy as np
import shapely

from utak.geometry.kernels.arrays import XY, Square
from utak.geometry.raster.rasterize import squares as covered_squares
from utak.kb.body import DIRECTIONS
from utak.kb.evidence.reason import Reason, ReasonKind
from utak.kb.evidence.record import Record, RecordedStep
from utak.kb.evidence.sightings import most_telling, sightings
from utak.kb.language.vocabulary import MAX_TABLE_SIDE
from utak.kb.perception.frame import ADJACENT_OFFSETS, Frame
from utak.kb.world.model import FACT_UNITS_PER_SQUARE, VERGE_NODE

SHOWN_CELLS = 4  # cells that one reason names at most, the most telling ones; a convention
SAMPLED_SQUARES = 12  # squares of an outline or a line at which cells are looked up, at most; a convention
MAX_OUTLINE_SIDE = 2 * MAX_TABLE_SIDE  # squares: a map may reach as far beyond the table as it is long; a convention
OUTLINE_ROUNDING = 0.02  # squares: an outline in facts, in a turned frame, may reach over its squares by so much


def seen_reason(record: Record, step: int, squares: Sequence[Square], occupied: bool, what: str) -> Reason:
    """Return the reason why some squares are believed to be occupied, or to be free: the cells that show them."""
    chosen = _some(squares, SAMPLED_SQUARES)
    found = sightings(record, step, chosen)
    telling = most_telling(found, occupied, SHOWN_CELLS)
    claim = f"{what}: {'occupied' if occupied else 'free'}"
    because = "; ".join(map(str, telling))
    if not telling and found:
        telling = sorted(found, key=lambda one: (one.side, -one.impression))[:SHOWN_CELLS]
        because = f"no cell alone shows it, the counts of several together do, such as {'; '.join(map(str, telling))}"
    data = {"squares": [list(square) for square in chosen], "occupied": occupied}
    if not telling:
        return Reason(
            claim, "nothing was seen there yet, so it is assumed", ReasonKind.CELLS, "", (), {**data, "cells": []}
        )
    numbers = sorted({one.impression for one in telling})
    source = f"impression{'s' * (len(numbers) > 1)} {', '.join(map(str, numbers))}"
    cells = [[one.impression, one.cell, one.level, list(one.square)] for one in telling]
    return Reason(claim, because, ReasonKind.CELLS, source, (), {**data, "cells": cells})


def _some(squares: Sequence[Square], most: int) -> list[Square]:
    """Return at most `most` of some squares, at equal distances in their order."""
    if len(squares) <= most:
        return list(squares)
    return [squares[round(i * (len(squares) - 1) / (most - 1))] for i in range(most)]


def felt_reason(record: Record, step: int, squares: Iterable[Square], colour: str, what: str) -> Reason | None:
    """Return the reason why a colour is believed of some squares: the newest touch there."""
    # None when none is recorded.
    now, wanted = record.steps[step], set(squares)
    anywhere = None
    for number in range(step, now.first_impression - 1, -1):
        x, y = now.square_of(now.places[number])
        for direction, felt, offset in zip(DIRECTIONS, record.steps[number].touch, ADJACENT_OFFSETS, strict=True):
            if felt != colour:
                continue
            named = {(x + column, y + row) for column, row in _beside(now, offset)}
            if named & (wanted | set(node_squares(record.steps[number], what))):  # it may have been moved since
                return _touch_reason(what, colour, direction, number)
            anywhere = anywhere or _touch_reason(what, colour, direction, number, ", as it was believed to lie then")
    return anywhere


def touch_reasons(record: Record, step: int, node: str) -> list[Reason]:
    """Return what the robot feels of a node from where it stands at a step."""
    now = record.steps[step]
    (x, y), squares = now.square_of(now.places[step]), set(node_squares(now, node))
    touched = zip(DIRECTIONS, now.touch, ADJACENT_OFFSETS, strict=True)
    return [
        _touch_reason(node, colour, direction, step)
        for direction, colour, offset in touched
        if colour is not None and squares & {(x + column, y + row) for column, row in _beside(now, offset)}
    ]


def beside_reason(record: Record, step: int, node: str) -> Reason:
    """Return the cells that show the verge beside a node."""
    now = record.steps[step]
    around = {(x + i, y + j) for x, y in node_squares(now, node) for i in (-1, 0, 1) for j in (-1, 0, 1)}
    beside = [square for square in node_squares(now, VERGE_NODE) if square in around]
    return seen_reason(record, step, beside, True, f"the squares of the verge beside {node}")


def _beside(now: RecordedStep, offset: tuple[int, int]) -> Iterable[Square]:
    """Return the offsets of the squares beside the robot that a touch may be about, map frame."""
    column, row = now.frame.to_map(*offset)
    return {(math.floor(column + dx + 0.5), math.floor(row + dy + 0.5)) for dx in (-0.01, 0.01) for dy in (-0.01, 0.01)}


def _touch_reason(what: str, colour: str, direction: str, number: int, how: str = "") -> Reason:
    """Return the reason of one touch."""
    data = {"impression": number, "direction": direction, "colour": colour}
    because = f"colour {colour} was felt in the {direction}{how}"
    return Reason(f"{what} has colour {colour}", because, ReasonKind.TOUCH, f"impression {number}", (), data)


def command_reason(step: RecordedStep) -> Reason:
    """Return the reason that is the command before an impression."""
    if step.action is None:
        return Reason("the robot woke", "", ReasonKind.COMMAND, "step 0", (), {"step": 0})
    values = ", ".join(
        f"{value:g}" if isinstance(value, float) else str(value) for value in list(step.action.values())[1:]
    )
    claim = f"the command was {step.action['do']}({values})" if values else f"the command was {step.action['do']}"
    return Reason(claim, step.why, ReasonKind.COMMAND, f"step {step.number}", (), {"step": step.number})


def line_squares(step: RecordedStep, start: XY, end: XY, aside: float) -> list[Square]:
    """Return the squares along a line, map frame, in order, without repeats."""
    (x0, y0), (x1, y1) = (step.frame.place_from_utak(*point) for point in (start, end))
    length = math.hypot(x1 - x0, y1 - y0)
    if length == 0:
        return [(math.floor(x0), math.floor(y0))]
    left = -(y1 - y0) / length * aside, (x1 - x0) / length * aside
    count = max(1, math.ceil(min(length, MAX_OUTLINE_SIDE)))
    parts = [(number + 0.5) / count for number in range(count)]
    points = [(x0 + part * (x1 - x0) + left[0], y0 + part * (y1 - y0) + left[1]) for part in parts]
    return list(dict.fromkeys((math.floor(x), math.floor(y)) for x, y in points))


def node_squares(step: RecordedStep, node: str) -> list[Square]:
    """Return the squares that a node covers by its outline, (column, row), map frame; [] when none is recorded."""
    return list(_node_squares(step.facts, step.frame.angle, step.frame.origin, node))


@lru_cache(maxsize=64)
def _node_squares(facts: tuple[str, ...], angle: int, origin: XY, node: str) -> tuple[Square, ...]:
    """Return the squares of a node by the segments among some facts."""
    frame = Frame(angle, origin)
    rings: list[list[XY]] = []
    last: Any = None
    for east, north, further_east, further_north in _segments(facts, node):
        if last != (east, north):
            rings.append([])
        rings[-1].append(frame.place_from_utak(east / FACT_UNITS_PER_SQUARE, north / FACT_UNITS_PER_SQUARE))
        last = (further_east, further_north)
    parts = [shapely.Polygon(ring) for ring in rings if len(ring) >= 3]
    if not parts:
        return ()
    shape = parts[0]
    for part in parts[1:]:
        shape = shape.symmetric_difference(part)
    shape = shape.buffer(-OUTLINE_ROUNDING, join_style="mitre")
    if shape.is_empty:
        return ()
    west, south = math.floor(shape.bounds[0] + 1e-6), math.floor(shape.bounds[1] + 1e-6)
    east, north = math.ceil(shape.bounds[2] - 1e-6), math.ceil(shape.bounds[3] - 1e-6)
    if max(east - west, north - south) > MAX_OUTLINE_SIDE:
        raise ValueError(f"the outline of {node} is longer than {MAX_OUTLINE_SIDE} squares")
    moved = shapely.affinity.translate(shape, -west, -south)
    rows, columns = np.nonzero(covered_squares(moved, max(1, east - west), max(1, north - south)))
    return tuple((west + int(column), south + int(row)) for row, column in zip(rows, columns, strict=True))


def _segments(facts: Iterable[str], node: str) -> list[tuple[int, int, int, int]]:
    """Return the segments of a node, (east, north, east, north) in hundredths of squares, in the order of numbers."""
    start = f"segment({node},"
    rows = [tuple(map(int, fact[len(start) : -1].split(","))) for fact in facts if fact.startswith(start)]
    return [(row[1], row[2], row[3], row[4]) for row in sorted(rows)]
