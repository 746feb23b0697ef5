"""world.txt: a world drawn as a picture, one character a square, and the picture of any world.

`.` is floor, `b` verge, another lower-case letter an object of that colour, `U` Utak, who faces north. The last line is
the south. Edge-connected equal letters are one object; objects are named by colour and number: g1, g2, ...
"""

import re
from collections.abc import Iterator, Mapping
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import shapely

from geometry.raster.rasterize import squares
from kb.language.diagnostics import MAX_PROBLEMS_PER_FILE, BadInputError, Problem, Span
from kb.language.source_text import Source, read_source
from simulator.world.world import VERGE_COLOUR, Thing, World

FLOOR, UTAK = ".", "U"
MOST_SQUARES = 512  # along either side of a picture; greater tables are for world.lp
Square = tuple[int, int]


def read_picture(path: Path | str) -> World:
    """Read a world from its picture; raises CannotOpenError, or BadInputError with every problem.

    Every square of the picture is whole. An object that encloses floor has a hole, so it counts as fixed.
    """
    source = read_source(path)
    rows = [line.rstrip() for line in source.lines]
    while rows and not rows[-1]:
        rows.pop()
    problems = list(_bad_rows(source, rows)) or list(islice(_bad_marks(source, rows), MAX_PROBLEMS_PER_FILE))
    if problems:
        raise BadInputError(problems)
    return _world(rows)


def _bad_rows(source: Source, rows: list[str]) -> Iterator[Problem]:
    if not rows:
        yield source.problem(source.start(), "the picture is empty")
        return
    if len(rows) > MOST_SQUARES or len(rows[0]) > MOST_SQUARES:
        yield source.problem(source.start(), f"a picture has at most {MOST_SQUARES} squares a side")
    for number, row in enumerate(rows, 1):
        if len(row) != len(rows[0]) or not row:
            what = f"{len(row)} squares in this row, {len(rows[0])} in the first"
            yield source.problem(Span(number, 1, max(1, len(row))), what, "one character a square: write . for floor")
            return


def _bad_marks(source: Source, rows: list[str]) -> Iterator[Problem]:
    found = []
    for number, row in enumerate(rows, 1):
        for match in re.finditer("[^a-z.]", row):
            span = Span(number, match.start() + 1, match.start() + 1)
            if match[0] == UTAK:
                found.append(span)
            else:
                hint = "U is Utak, . floor, b verge, other small letters objects"
                yield source.problem(span, f"{match[0]!r} is nothing that a picture knows", hint)
    if not found:
        yield source.problem(source.start(), "the picture has no Utak", "put a U where he stands")
    for span in found[1:]:
        yield source.problem(span, "a second Utak", f"the first is on line {found[0].line}")


def _world(rows: list[str]) -> World:
    marks = {(i, j): mark for j, row in enumerate(reversed(rows)) for i, mark in enumerate(row) if mark != FLOOR}
    utak = next(square for square, mark in marks.items() if mark == UTAK)
    things = _things(marks)
    return World(
        width=len(rows[0]),
        height=len(rows),
        verge=_outline({square for square, mark in marks.items() if mark == VERGE_COLOUR}),
        movable=tuple(thing for thing in things if not thing.polygon.interiors),
        fixed=tuple(thing for thing in things if thing.polygon.interiors),
        utak=(utak[0] + 0.5, utak[1] + 0.5),
        heading=0,
    )


def _things(marks: Mapping[Square, str]) -> list[Thing]:
    """The objects of a picture, in the order of their names."""
    lettered = {square: mark for square, mark in sorted(marks.items()) if mark not in (UTAK, VERGE_COLOUR)}
    done: set[Square] = set()
    numbers: dict[str, int] = {}
    things = []
    for first, colour in lettered.items():
        if first in done:
            continue
        part = _connected(first, lettered)
        done |= part
        numbers[colour] = numbers.get(colour, 0) + 1
        things.append(Thing(f"{colour}{numbers[colour]}", colour, _outline(part)))
    return sorted(things, key=lambda thing: thing.name)


def _connected(first: Square, marks: Mapping[Square, str]) -> set[Square]:
    """The squares of one letter that hang together by edges with the first."""
    part, waiting = {first}, [first]
    while waiting:
        i, j = waiting.pop()
        for near in ((i + 1, j), (i - 1, j), (i, j + 1), (i, j - 1)):
            if near not in part and marks.get(near) == marks[first]:
                part.add(near)
                waiting.append(near)
    return part


def _outline(part: set[Square]) -> Any:
    """The outline of squares, holes kept, without corners on straight lines."""
    corners = np.array(sorted(part), dtype=float).reshape(-1, 2)
    whole = shapely.coverage_union_all(shapely.box(*corners.T, *(corners + 1).T))
    parts = [
        shapely.Polygon(_straight(polygon.exterior), [_straight(hole) for hole in polygon.interiors])
        for polygon in shapely.get_parts(shapely.normalize(whole))
        if not polygon.is_empty
    ]
    return parts[0] if len(parts) == 1 else shapely.MultiPolygon(parts)


def _straight(ring: Any) -> npt.NDArray[np.float64]:
    """The points of a ring of unit steps at which it turns."""
    points = shapely.get_coordinates(ring)[:-1]
    turns = np.any(points - np.roll(points, 1, axis=0) != np.roll(points, -1, axis=0) - points, axis=1)
    corners: npt.NDArray[np.float64] = points[turns]
    return corners


def draw(world: World, polygons: Mapping[str, Any] | None = None, utak: tuple[float, float] | None = None) -> str:
    """Return a world as a picture, one line a row, the north row first.

    Parameters
    ----------
    world : what stands on the table.
    polygons : where the movable things are now, by name; as in the world by default.
    utak : where Utak is now, (x, y); as in the world by default.
    """
    now = {thing.name: thing.polygon for thing in world.movable} | dict(polygons or {})
    rows = [[FLOOR] * world.width for _ in range(world.height)]
    layers = [(VERGE_COLOUR, world.verge), *((thing.colour, thing.polygon) for thing in world.fixed)]
    layers += [(thing.colour, now[thing.name]) for thing in world.movable]
    for colour, shape in layers:
        for j, i in zip(*squares(shape, world.width, world.height).nonzero(), strict=True):
            rows[j][i] = colour
    x, y = utak or world.utak
    rows[min(int(y), world.height - 1)][min(int(x), world.width - 1)] = UTAK
    return "\n".join("".join(row) for row in reversed(rows)) + "\n"
