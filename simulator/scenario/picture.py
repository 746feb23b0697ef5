"""world.txt: a world drawn as a picture, one character a square; and the picture of any world.

`.` is floor, `b` verge, another lower-case letter an object of that colour, `U` Utak, which faces north. The last line
is the south. Edge-connected equal letters are one object. Objects are named by colour and number: g1, g2, ...
"""

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
import shapely

from utak.geometry.raster.rasterize import squares
from utak.kb.language.diagnostics import MAX_PROBLEMS_PER_FILE, BadInputError, Problem, SourceSpan
from utak.kb.language.source_text import Source, read_source
from utak.simulator.world.world import VERGE_COLOUR, Thing, World

FLOOR_MARK, UTAK_MARK = ".", "U"  # the characters for floor and for Utak in pictures
MAX_PICTURE_SIDE = 512  # squares along each side of a picture (docs/files.md); world.lp can state greater tables
LABEL_EVERY = 5  # rows of a picture between two labels of its axes; columns between two have twice as many
_Square = tuple[int, int]


def read_picture(path: Path | str) -> World:
    """Return the world that a picture shows."""
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
    if len(rows) > MAX_PICTURE_SIDE or len(rows[0]) > MAX_PICTURE_SIDE:
        yield source.problem(source.start(), f"a picture has at most {MAX_PICTURE_SIDE} squares a side")
    for number, row in enumerate(rows, 1):
        if len(row) != len(rows[0]) or not row:
            what = f"{len(row)} squares in this row, {len(rows[0])} in the first"
            yield source.problem(
                SourceSpan(number, 1, max(1, len(row))), what, "one character a square: write . for floor"
            )
            return


def _bad_marks(source: Source, rows: list[str]) -> Iterator[Problem]:
    found = []
    for number, row in enumerate(rows, 1):
        for match in re.finditer("[^a-z.]", row):
            span = SourceSpan(number, match.start() + 1, match.start() + 1)
            if match[0] == UTAK_MARK:
                found.append(span)
            else:
                hint = "U is Utak, . floor, b verge, other lower-case letters are objects"
                yield source.problem(span, f"{match[0]!r} is nothing that a picture knows", hint)
    if not found:
        yield source.problem(source.start(), "the picture has no Utak", "put a U where Utak wakes")
    for span in found[1:]:
        yield source.problem(span, "a second Utak", f"the first is on line {found[0].line}")


def _world(rows: list[str]) -> World:
    """Return the world of a valid picture; the rows run from north to south."""
    marks = {(i, j): mark for j, row in enumerate(reversed(rows)) for i, mark in enumerate(row) if mark != FLOOR_MARK}
    utak = next(square for square, mark in marks.items() if mark == UTAK_MARK)
    things = _things(marks)
    return World(
        width=len(rows[0]),
        height=len(rows),
        verge=outline_of_cells({square for square, mark in marks.items() if mark == VERGE_COLOUR}),
        movable=tuple(thing for thing in things if not thing.polygon.interiors),
        fixed=tuple(thing for thing in things if thing.polygon.interiors),
        utak=(utak[0] + 0.5, utak[1] + 0.5),
        heading=0,
    )


def _things(marks: Mapping[_Square, str]) -> list[Thing]:
    """Return the objects of a picture in the order of their names."""
    lettered = {square: mark for square, mark in sorted(marks.items()) if mark not in (UTAK_MARK, VERGE_COLOUR)}
    done: set[_Square] = set()
    numbers: dict[str, int] = {}
    things = []
    for first, colour in lettered.items():
        if first in done:
            continue
        part = _connected(first, lettered)
        done |= part
        numbers[colour] = numbers.get(colour, 0) + 1
        things.append(Thing(f"{colour}{numbers[colour]}", colour, outline_of_cells(part)))
    return sorted(things, key=lambda thing: thing.name)


def _connected(first: _Square, marks: Mapping[_Square, str]) -> set[_Square]:
    """Return the squares with the same letter that are edge-connected with the first square."""
    part, waiting = {first}, [first]
    while waiting:
        i, j = waiting.pop()
        for neighbour in ((i + 1, j), (i - 1, j), (i, j + 1), (i, j - 1)):
            if neighbour not in part and marks.get(neighbour) == marks[first]:
                part.add(neighbour)
                waiting.append(neighbour)
    return part


def outline_of_cells(cells: Iterable[tuple[int, int]], scale: int = 1, border: int = 0) -> Any:
    """Return the outline of cells (column, row), a shapely Polygon where they are edge-connected, else a MultiPolygon.

    scale : squares along a cell. border : squares that lie to the south and west of the cells.
    """
    corners = np.array(sorted(cells), float).reshape(-1, 2) * scale + border
    whole = shapely.coverage_union_all(shapely.box(*corners.T, *(corners + scale).T))
    return shapely.normalize(whole).simplify(0) if len(corners) else shapely.MultiPolygon()


def labelled(rows: Sequence[str], west: float, south: float, unit: float = 1.0) -> Iterator[str]:
    """Yield the lines of a picture with labels on the left, the north row first, and an axis with labels below."""
    for row in reversed(range(len(rows))):
        label = f"{south + unit * row:6.10g} " if row % LABEL_EVERY == 0 else ""
        yield f"{label[:7]:7}{rows[row]}".rstrip()
    columns = max(map(len, rows), default=0)
    ticks = [" "] * (columns + 12)
    for column in range(0, columns, 2 * LABEL_EVERY):
        text = f"|{west + unit * column:.10g}"[: 2 * LABEL_EVERY - 1]
        ticks[column : column + len(text)] = text
    yield (" " * 7 + "".join(ticks)).rstrip()


def names_and_places(world: World, tells_heading: bool = True) -> Iterator[str]:
    """Yield a line about each thing and about Utak: the name, the colour and the squares between which it lies."""
    facing = f", facing {world.heading} degrees from the table's north" if tells_heading and world.heading else ""
    x, y = world.utak
    yield f"{UTAK_MARK} utak: POINT ({x:.10g} {y:.10g}){facing}"
    for thing in (*world.movable, *world.fixed):
        west, south, east, north = (f"{value:.6g}" for value in thing.polygon.bounds)
        fixed = ", fixed" if thing in world.fixed else ""
        yield f"{thing.colour} {thing.name}: x {west} to {east}, y {south} to {north}{fixed}"


def draw(world: World) -> str:
    """Return a world as a picture, one line a row, the north row first."""
    rows = [[FLOOR_MARK] * world.width for _ in range(world.height)]
    things = [(thing.colour, thing.polygon) for thing in (*world.fixed, *world.movable)]
    for colour, shape in [(VERGE_COLOUR, world.verge), *things]:
        for j, i in zip(*squares(shape, world.width, world.height).nonzero(), strict=True):
            rows[j][i] = colour
    x, y = world.utak
    rows[min(int(y), world.height - 1)][min(int(x), world.width - 1)] = UTAK_MARK
    return "\n".join("".join(row) for row in reversed(rows)) + "\n"
