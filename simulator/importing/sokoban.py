"""Sokoban levels (.xsb): boxes that must be brought to storages.

    #  wall    @  robot    +  robot on a storage    $  box    *  box on a storage    .  storage    blank - _  floor

A level is a run of rows; other lines (titles, comments that begin with `;` or `::`, `Author: ...`) stand between
levels. A row may be run-length encoded: a number repeats the next character or the next group in brackets, `|` ends a
row.
"""

import re
from collections import deque
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path

import numpy as np
import numpy.typing as npt

from utak.geometry.kernels.arrays import Bools
from utak.geometry.raster.components import components
from utak.kb.language.diagnostics import BadInputError, SourceSpan
from utak.kb.language.source_text import MAX_FILE_BYTES, Source
from utak.kb.language.vocabulary import MAX_TABLE_SIDE
from utak.simulator.importing.imported import Imported, ImportOptions, ObjectGoal, task_of_objects
from utak.simulator.importing.raster import CellWorld, RasterCell, RasterError, world_text
from utak.simulator.importing.text_file import read_raw, text_source

SQUARES_A_BOX = 3  # squares a cell: the robot sees a box as a square of 3 x 3; a convention
SQUARE_MARKS = "#@+$*. -_"  # the characters of a row
RUN_MARKS = "0123456789|()"  # the characters of run-length encoding besides
WALL_FIRST = re.compile(r"[ \t_-]*#")  # the begin of a line that must be a row
TITLE = re.compile(r"[ \t]*[A-Za-z][\w ]*:")  # the begin of a line about the level, such as `Author: ...`
# A line between levels: a number, a ruler, or a heading that begins with # and does not end so.
HEADING = re.compile(r"#?[0-9]+|([*=_.+-])\1{2,}|#+[ \t]*[A-Za-z].*[^#]")
COMMENT_MARKS = (";", "::", "%", "'", '"')  # the begins of lines that are none
MAX_RUN_DIGITS = 4  # digits of a number in a run; derived: no row has more cells than `MAX_TABLE_SIDE`
MAX_GROUP_DEPTH = 8  # brackets within brackets; a convention
MAX_LEVEL_CELLS = 16_384  # cells of a level: 128 x 128; a convention
MAX_LEVEL_BOXES = 256  # boxes, and storages, of a level: each is paired with each; a convention
NO_WAY_CELLS = 100_000  # the distance of a box to a storage that no way leads to, in cells; above every true one


@dataclass(frozen=True)
class Level:
    """A level of a file."""

    first: SourceSpan  # the place of its first row in the file
    # Its rows from the north; each with the place of every character
    rows: tuple[tuple[tuple[str, SourceSpan], ...], ...]


def read(path: Path | str, options: ImportOptions) -> Imported:
    """Return the scenario of a level."""
    # Goals of TABLETOP name objects: each box gets a storage of its own, so that the ways of all boxes are the shortest
    # in sum, other boxes left out.
    source = text_source(path, read_raw(path, MAX_FILE_BYTES, "a file of Sokoban levels", options.untrusted))
    levels, wanted = 0, None
    for lines in _levels(source):
        levels += 1
        wanted = lines if levels == options.level else wanted
    if wanted is None:
        what = f"there is no level {options.level}: the file has {levels}" if levels else "no Sokoban level is in it"
        hint = "" if levels else "a level is drawn with # wall, @ robot, $ box, . storage"
        raise BadInputError([source.problem(source.start(), what, hint)])
    notes = [f"This is level {options.level} of {levels}; --level N imports another."] if levels > 1 else []
    scale = int(options.scale or Fraction(SQUARES_A_BOX))
    return _scenario(source, _level_of(source, wanted), scale, notes, f"Sokoban level {options.level}")


def _scenario(source: Source, level: Level, scale: int, notes: list[str], title: str) -> Imported:
    """Return the scenario of a level. scale : squares a cell. notes : those so far. title : what it is."""
    cells = len(level.rows) * max(len(row) for row in level.rows)
    if cells > MAX_LEVEL_CELLS:
        what = f"a level has at most {MAX_LEVEL_CELLS} cells here, this one {cells}"
        raise BadInputError([source.problem(level.first, what)])
    marks = _cells(level)
    robot, boxes, storages = (
        sorted(cell for cell, mark in marks.items() if mark in kind) for kind in ("@+", "$*", ".*+")
    )
    _check(source, level, robot, boxes, storages)
    walls = _walls(marks)
    pairs = _assigned(walls, boxes, storages)
    try:
        drawn = world_text(CellWorld(walls, tuple(frozenset([box]) for box in boxes), robot[0]), scale)
    except RasterError as error:
        raise BadInputError([source.problem(level.first, str(error))]) from None
    goals = []
    for number, (index, storage) in enumerate(pairs):
        (i, j), (to_i, to_j) = boxes[index], storages[storage]
        shift = float((to_i - i) * scale), float((to_j - j) * scale)
        goals.append(ObjectGoal(f"x{number}", drawn.objects[index], shift))
    notes.append("In Sokoban any box may go to any storage; here each has its own, for goals name objects.")
    notes.append("Sokoban forbids to pull: run it with --no-pull.")
    if any(not goal.thing.unique for goal in goals):
        notes.append("There are more boxes than colours: nothing tells boxes of one colour apart.")
    if len(boxes) > len(storages):
        notes.append(f"{len(boxes) - len(storages)} boxes have no storage, and no goal.")
    return Imported(title, drawn.file, drawn.text, *task_of_objects(goals, drawn.utak), tuple(notes))


def _levels(source: Source) -> Iterator[list[int]]:
    """Yield the numbers of the lines of each level of a file, in order."""
    rows: list[int] = []
    for number, line in enumerate([*source.lines, ""], 1):
        if _is_row(line, bool(rows)):
            rows.append(number)
        elif rows:
            yield rows
            rows = []


def _level_of(source: Source, lines: Sequence[int]) -> Level:
    """Return the level that some lines draw; raise BadInputError at the first that is no row."""
    if len(lines) > MAX_LEVEL_CELLS:
        what = f"a level has at most {MAX_LEVEL_CELLS} cells here, this one {len(lines)} rows"
        raise BadInputError([source.problem(SourceSpan(lines[0], 1, 1), what)])
    rows = [row for number in lines for row in _decoded(source, number, source.lines[number - 1])]
    first = next((span for row in rows for _, span in row), SourceSpan(lines[0], 1, 1))
    return Level(first, tuple(rows))


def _is_row(line: str, within: bool) -> bool:
    """Return whether a line is a row of a level. within : whether the line before it is one."""
    if not line.strip() or line.startswith(COMMENT_MARKS) or TITLE.match(line) or HEADING.fullmatch(line.strip()):
        return False
    if all(mark in SQUARE_MARKS + RUN_MARKS for mark in line.rstrip()):
        return within or "#" in line
    return WALL_FIRST.match(line) is not None or (within and "#" in line)


def _decoded(source: Source, number: int, line: str) -> list[tuple[tuple[str, SourceSpan], ...]]:
    """Return the rows in a line, run lengths carried out; raise BadInputError for what is no row."""

    def wrong(at: int, what: str, hint: str = "") -> BadInputError:
        return BadInputError([source.problem(SourceSpan(number, at + 1, at + 1), what, hint)])

    open_groups: list[tuple[int, list[tuple[str, SourceSpan]]]] = []  # each: how often, and what came before it
    found: list[tuple[str, SourceSpan]] = []
    digits = ""
    most = MAX_TABLE_SIDE * (1 + line.count("|"))  # marks of a line; a longer one is refused below
    for at, mark in enumerate(line.rstrip()):
        count = int(digits) if digits else 1
        if mark.isdecimal() and mark.isascii():
            digits += mark
            if len(digits) > MAX_RUN_DIGITS:
                raise wrong(at, "a number too long for a row")
            continue
        if mark == "(":
            open_groups.append((count, found))
            found = []
            if len(open_groups) > MAX_GROUP_DEPTH:
                raise wrong(at, f"more than {MAX_GROUP_DEPTH} brackets within each other")
        elif mark == ")":
            if not open_groups or digits:
                raise wrong(at, "a bracket that nothing opens" if not digits else "a number before a closing bracket")
            times, before = open_groups.pop()
            if len(found) * times > most:
                raise wrong(at, f"a row of more than {MAX_TABLE_SIDE} squares")
            found = before + found * times
        elif mark in SQUARE_MARKS + "|":
            found += [(mark, SourceSpan(number, at + 1, at + 1))] * count
        else:
            raise wrong(at, f"{mark!r} is no square of a level", "# wall, @ robot, $ box, . storage, blank - _ floor")
        digits = ""
        if len(found) > most:
            raise wrong(at, f"a row of more than {MAX_TABLE_SIDE} squares")
    if digits or open_groups:
        raise wrong(len(line.rstrip()) - 1, "a number before nothing" if digits else "a bracket that nothing closes")
    return _split(found)


def _split(found: Sequence[tuple[str, SourceSpan]]) -> list[tuple[tuple[str, SourceSpan], ...]]:
    """Return the rows that `|` parts; an empty one at the end is left out."""
    rows: list[list[tuple[str, SourceSpan]]] = [[]]
    for mark in found:
        if mark[0] == "|":
            rows.append([])
        else:
            rows[-1].append(mark)
    return [tuple(row) for row in rows if row or row is not rows[-1]]


def _cells(level: Level) -> dict[RasterCell, str]:
    """Return the mark of each cell; rows are filled up with floor to the width of the longest."""
    width = max(len(row) for row in level.rows)
    return {
        (column, len(level.rows) - number): row[column][0] if column < len(row) else " "
        for number, row in enumerate(level.rows, 1)
        for column in range(width)
    }


def _check(source: Source, level: Level, *found: Sequence[RasterCell]) -> None:
    """Raise BadInputError unless a level has one robot, a box and a storage."""
    robot, boxes, storages = found
    problems = []
    if len(robot) > 1:
        places = [span for row in level.rows for mark, span in row if mark in "@+"]
        hint = f"the first is on line {places[0].line}, column {places[0].start}"
        problems.append(source.problem(places[1], "a second robot", hint))
    for cells, what in ((robot, "robot (@)"), (boxes, "box ($)"), (storages, "storage (.)")):
        if not cells:
            problems.append(source.problem(level.first, f"the level has no {what}"))
    if max(len(boxes), len(storages)) > MAX_LEVEL_BOXES:
        problems.append(source.problem(level.first, f"a level has at most {MAX_LEVEL_BOXES} boxes and storages here"))
    if problems:
        raise BadInputError(problems)


def _walls(marks: Mapping[RasterCell, str]) -> Bools:
    """Return the walls, (rows, columns) bool, row 0 in the south: floor that is open and bare, too."""
    columns, rows = (1 + max(cell[axis] for cell in marks) for axis in (0, 1))
    walls = np.array([[marks[i, j] == "#" for i in range(columns)] for j in range(rows)])
    labels = components(~walls).labels
    inside = {int(labels[j, i]) for (i, j), mark in marks.items() if mark not in " -_#"}
    open_parts = {int(label) for edge in (labels[0], labels[-1], labels[:, 0], labels[:, -1]) for label in edge}
    outside: Bools = walls | np.isin(labels, sorted(open_parts - inside - {0}))
    return outside


def _floor_from(start: RasterCell, marks: Mapping[RasterCell, str]) -> dict[RasterCell, int]:
    """Return the cells that are no walls to which a way leads, boxes left out, with the length of the way in cells."""
    found, waiting = {start: 0}, deque([start])
    while waiting:
        i, j = waiting.popleft()
        for other in ((i + 1, j), (i - 1, j), (i, j + 1), (i, j - 1)):
            if marks.get(other, "#") != "#" and other not in found:
                found[other] = found[i, j] + 1
                waiting.append(other)
    return found


def _assigned(walls: Bools, boxes: Sequence[RasterCell], storages: Sequence[RasterCell]) -> list[tuple[int, int]]:
    """Return pairs of a box and its storage, by their numbers, so that the ways in sum are the shortest."""
    marks = {(i, j): "#" if wall else " " for (j, i), wall in np.ndenumerate(walls)}
    ways = [_floor_from(box, marks) for box in boxes]
    cost = [[way.get(storage, NO_WAY_CELLS) for storage in storages] for way in ways]
    turned = len(boxes) > len(storages)
    if turned:
        cost = [list(column) for column in zip(*cost, strict=True)]
    owner = _cheapest_owners(cost)
    pairs = [(number, owned) for owned, number in owner.items()]
    return sorted((owned, number) if turned else (number, owned) for number, owned in pairs)


def _cheapest_owners(cost: npt.ArrayLike) -> dict[int, int]:
    """Return who owns which column, by column, one for every row, cheapest in sum. cost : rows <= columns."""
    # The Hungarian method with prices (Kuhn 1955); row and column 0 stand for none.
    table = np.pad(np.asarray(cost, float), ((1, 0), (1, 0)))
    row_price, column_price = np.zeros(len(table)), np.zeros(len(table[0]))
    owner, before = np.zeros((2, len(table[0])), int)
    for newcomer in range(1, len(table)):
        owner[0], column = newcomer, 0
        best, seen = np.full(len(owner), np.inf), np.zeros(len(owner), bool)
        while owner[column]:
            seen[column] = True
            row = owner[column]
            lengths = np.where(seen, np.inf, table[row] - row_price[row] - column_price)
            before[lengths < best] = column
            best = np.minimum(best, lengths)
            column = int(np.argmin(np.where(seen, np.inf, best)))
            step = best[column]
            row_price[owner[seen]] += step
            column_price[seen] -= step
            best[~seen] -= step
        while column:
            owner[column], column = owner[before[column]], before[column]
    return {int(column) - 1: int(owner[column]) - 1 for column in np.flatnonzero(owner) if column}
