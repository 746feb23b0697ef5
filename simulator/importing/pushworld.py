"""PushWorld puzzles (.pwp): movable shapes on cells, some of which must be pushed to goals.

    puzzle = row { row }                     the first row is the north; each has the same number of cells
    row    = cell { blanks cell }
    cell   = part { "+" part }
    part   = "." | "W" | "AW" | "A" | "M" id | "G" id       in letters of either case

All cells of one part are one thing. `G` id is the goal of `M` id: the western and northern edges of both must meet.
"""

import re
from collections import defaultdict
from fractions import Fraction
from itertools import islice
from pathlib import Path

import numpy as np
import shapely

from utak.kb.language.diagnostics import MAX_PROBLEMS_PER_FILE, BadInputError, Problem, SourceSpan
from utak.kb.language.source_text import MAX_FILE_BYTES, Source
from utak.simulator.importing.imported import Imported, ImportOptions, ObjectGoal, task_of_objects
from utak.simulator.importing.raster import CellWorld, RasterCell, RasterError, world_text
from utak.simulator.importing.text_file import read_raw, text_source
from utak.simulator.scenario.picture import outline_of_cells

SQUARES_A_CELL = 3  # squares a cell: the robot sees an object of one cell as a square of 3 x 3; a convention
BORDER_SQUARES = 1  # the walls that a puzzle has around it without naming them
MAX_PUZZLE_CELLS = 65_536  # cells of a puzzle; a convention
MAX_PUZZLE_OBJECTS = 500  # objects of a puzzle; a convention
THING_PART = re.compile(r"[mg][0-9a-z_]+")  # an object or a goal
CELL_WORD = re.compile(r"[^ \t]+")
PART_HINT = "cells are . W A M0 G0, and several of them joined by +, such as A+G1"

# By part, in lower case: its cells, each with its place in the text.
PuzzlePlaces = dict[str, dict[RasterCell, SourceSpan]]


def read(path: Path | str, options: ImportOptions) -> Imported:
    """Return the scenario of a PushWorld puzzle."""
    source = text_source(path, read_raw(path, MAX_FILE_BYTES, "a PushWorld puzzle", options.untrusted))
    places, rows, columns = _places(source)
    problems = list(_problems(source, places))
    if problems:
        raise BadInputError(problems[:MAX_PROBLEMS_PER_FILE])
    movable = sorted((part for part in places if part[0] == "m"), key=_natural)
    walls = np.zeros((rows, columns), bool)
    for column, row in places["w"]:
        walls[row, column] = True
    world = CellWorld(walls, tuple(frozenset(places[part]) for part in movable), next(iter(places["a"])))
    scale = int(options.scale or Fraction(SQUARES_A_CELL))
    try:
        drawn = world_text(world, scale, BORDER_SQUARES)
    except RasterError as error:
        raise BadInputError([source.problem(source.start(), str(error))]) from None
    goals, notes = [], []
    for goal in sorted((part for part in places if part[0] == "g"), key=_natural):
        index = movable.index(f"m{goal[1:]}")
        cells, there = places[movable[index]], places[goal]
        east = min(i for i, _ in there) - min(i for i, _ in cells)
        north = max(j for _, j in there) - max(j for _, j in cells)
        if {(i + east, j + north) for i, j in cells} != set(there):
            notes.append(
                f"Goal {goal.upper()} has another form than {movable[index].upper()}: their west and north edges meet."
            )
        thing = drawn.objects[index]
        goals.append(ObjectGoal(f"x{goal[1:]}", thing, (float(east * scale), float(north * scale))))
        if not thing.unique:
            notes.append(f"There are more objects than colours: nothing tells {movable[index].upper()} from another.")
    task = task_of_objects(goals, drawn.utak)
    return Imported("PushWorld puzzle", drawn.file, drawn.text, *task, tuple(notes))


def _places(source: Source) -> tuple[PuzzlePlaces, int, int]:
    """Return the cells of each part, and the numbers of rows and columns; raise BadInputError for wrong parts."""
    lines = list(source.lines)
    while lines and not lines[-1].strip():
        lines.pop()
    words = [list(islice(CELL_WORD.finditer(line), MAX_PUZZLE_CELLS + 1)) for line in lines]
    if not words:
        raise BadInputError([source.problem(source.start(), "the puzzle is empty")])
    if len(words) > MAX_PUZZLE_CELLS or sum(map(len, words)) > MAX_PUZZLE_CELLS:
        raise BadInputError([source.problem(source.start(), f"a puzzle has at most {MAX_PUZZLE_CELLS} cells here")])
    places: PuzzlePlaces = defaultdict(dict)
    problems: list[Problem] = []
    for number, (line, row) in enumerate(zip(lines, words, strict=True), 1):
        if len(row) != len(words[0]) or not row:
            what = f"{len(row)} cells in this row, {len(words[0])} in the first"
            problems.append(source.problem(SourceSpan(number, 1, max(1, len(line))), what))
            break
        for column, word in enumerate(row):
            at = word.start()
            for part in word.group().lower().split("+"):
                span = SourceSpan(number, at + 1, at + max(1, len(part)))
                at += len(part) + 1
                if part in ("w", "a", "aw") or THING_PART.fullmatch(part):
                    places[part][column, len(words) - number] = span
                elif part != ".":
                    problems.append(source.problem(span, f"{part[:20]!r} is no part of a cell", PART_HINT))
    if problems:
        raise BadInputError(problems[:MAX_PROBLEMS_PER_FILE])
    places["w"].update({})
    return places, len(words), len(words[0])


def _problems(source: Source, places: PuzzlePlaces) -> "list[Problem]":
    """Return what makes a puzzle none, or none that TABLETOP can show; [] for nothing."""
    problems = []
    robot = sorted(places.get("a", {}).values())
    if not robot:
        problems.append(source.problem(source.start(), "the puzzle has no agent", "one cell is A"))
    if len(robot) > 1:
        what = f"the agent has {len(robot)} cells; Utak is a point and has one"
        problems.append(source.problem(robot[1], what))
    for span in sorted(places.get("aw", {}).values())[:1]:
        what = "a wall for the agent alone (AW): in TABLETOP a wall stops objects, too"
        problems.append(source.problem(span, what, "write W where it shall stop everything, or . for floor"))
    if sum(part[0] == "m" for part in places) > MAX_PUZZLE_OBJECTS:
        what = f"a puzzle has at most {MAX_PUZZLE_OBJECTS} objects here"
        return [*problems, source.problem(source.start(), what)]
    taken: dict[RasterCell, str] = {}
    for part, cells in sorted(places.items()):
        if part[0] == "g":
            if f"m{part[1:]}" not in places:
                what = f"{part.upper()} is the goal of M{part[1:].upper()}, which the puzzle does not have"
                problems.append(source.problem(min(cells.values()), what))
            continue
        for cell, span in sorted(cells.items(), key=lambda item: item[1]):
            if taken.setdefault(cell, part) != part:
                what = f"{part.upper()} and {taken[cell].upper()} are in the same cell"
                problems.append(source.problem(span, what, "only goals may lie under something"))
        if part[0] != "m":
            continue
        first = min(cells.values())
        outline = outline_of_cells(cells)
        if shapely.get_num_geometries(outline) > 1:
            what = f"{part.upper()} is in several parts, or hangs together by corners alone"
            problems.append(source.problem(first, what, "an object of TABLETOP is one polygon"))
        elif outline.interiors:
            what = f"{part.upper()} encloses a cell: an object that can be moved has no holes"
            problems.append(source.problem(first, what))
    if not problems and not any(part[0] == "g" for part in places):
        problems.append(source.problem(source.start(), "the puzzle has no goal", "the goal of M0 is G0"))
    return problems


def _natural(part: str) -> tuple[int, int | str]:
    """Return the key that sorts parts with numbers by their number, before the others by their text."""
    return (0, int(part[1:])) if part[1:].isdecimal() and len(part) < 10 else (1, part)
