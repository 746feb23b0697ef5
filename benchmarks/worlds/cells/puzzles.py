"""Random puzzles of cells, each of which can be done: breadth-first search shows it.

    python -m benchmarks.worlds.cells.puzzles --kinds door,touching --seed 0 --count 8 -o FOLDER
    python -m benchmarks.orders --count 0 --pushworld FOLDER --seconds 60 -o results.jsonl

A puzzle is a rectangle of cells with a wall across it that has one opening, and some walls more.
"""

import argparse
import zlib
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from benchmarks.orders.asked import SOLVABLE_FILE, SOLVABLE_WORD
from benchmarks.worlds.cells.pushing import CELL_STEPS, PushPuzzle, fewest_pushes, moved_cell, moved_cells
from utak.simulator.cli.commands.files.import_scenario import scenario_files
from utak.simulator.importing.imported import Imported, ObjectGoal, task_of_objects
from utak.simulator.importing.pushworld import BORDER_SQUARES, SQUARES_A_CELL
from utak.simulator.importing.raster import CellWorld, RasterCell, world_text
from utak.simulator.scenario.folder_writer import write_folder

# one: a single thing. two: two things with a goal each. door: a thing fills the opening, and has to be moved.
# blocks: other things have to be moved. touching: the same, and what has a goal touches another thing.
PUZZLE_KINDS = ("one", "two", "door", "blocks", "touching")
SIDES = (5, 9)  # cells, the least and one more than the most; conventions, like all numbers here
WALL_SHARE = 0.08  # of the cells beside the wall across
FORMS: tuple[frozenset[RasterCell], ...] = (
    frozenset({(0, 0)}),
    frozenset({(0, 0), (1, 0)}),
    frozenset({(0, 0), (0, 1)}),
    frozenset({(0, 0), (1, 0), (0, 1)}),
)
SINGLE_CELL_SHARE = 0.6  # of the things that have one cell
LEAST_PUSHES = 4  # cells by which things are moved in all, at least
MAX_PUZZLE_TRIES = 20_000


def random_puzzle(kind: str, seed: int) -> PushPuzzle:
    """Return the puzzle of a kind and a seed from 0 on; the same two give the same puzzle.

    Raises ValueError when there is no such kind or seed.
    """
    if kind not in PUZZLE_KINDS or seed < 0:
        raise ValueError(f"no puzzle {kind}, {seed}: kinds are {', '.join(PUZZLE_KINDS)}, seeds from 0")
    rng = np.random.default_rng([zlib.crc32(kind.encode()), seed])
    for _ in range(MAX_PUZZLE_TRIES):
        puzzle = _drawn(rng, kind)
        if puzzle is not None and _is_wanted(puzzle, kind):
            return puzzle
    raise RuntimeError(f"no puzzle found of kind {kind}, seed {seed}")


def _drawn(rng: np.random.Generator, kind: str) -> PushPuzzle | None:
    """Return a random puzzle that may be of a kind; None where things do not fit."""
    columns, rows = (int(side) for side in rng.integers(*SIDES, 2))
    across, opening = int(rng.integers(2, columns - 2)), (0, int(rng.integers(rows)))
    opening = across, opening[1]
    cells = [(column, row) for column in range(columns) for row in range(rows)]
    walls = {(column, row) for column, row in cells if column == across} - {opening}
    walls |= {cell for cell in cells if rng.random() < WALL_SHARE} - {opening}
    free = [cell for cell in cells if cell not in walls]
    wanted = 2 if kind == "two" else 1
    others = {"one": 0, "two": 0, "door": int(rng.integers(2))}.get(kind, int(rng.integers(1, 3)))
    things = [frozenset({opening})] if kind == "door" else []
    taken = set[RasterCell]().union(*things, walls)
    meant = list[frozenset[RasterCell]]()
    for number in range(wanted + others):
        form = FORMS[0] if rng.random() < SINGLE_CELL_SHARE else FORMS[int(rng.integers(1, len(FORMS)))]
        cells_of = moved_cells(form, free[int(rng.integers(len(free)))])
        if not cells_of <= set(free) or cells_of & taken:
            return None
        taken |= cells_of
        (meant if number < wanted else things).append(cells_of)
    left = [cell for cell in free if cell not in taken]
    robot = left[int(rng.integers(len(left)))]
    goals = dict[int, RasterCell]()
    there = set[RasterCell]()
    for number, cells_of in enumerate(meant):
        to, least = free[int(rng.integers(len(free)))], min(cells_of)
        goals[number] = to[0] - least[0], to[1] - least[1]
        ends = moved_cells(cells_of, goals[number])
        if not ends <= set(free) or ends & there:
            return None
        there |= ends
    return PushPuzzle((columns, rows), frozenset(walls), (*meant, *things), robot, goals)


def _is_wanted(puzzle: PushPuzzle, kind: str) -> bool:
    """Return whether a puzzle is of a kind and can be done."""
    if kind == "touching" and not _touches_another(puzzle):
        return False
    others = range(len(puzzle.goals), len(puzzle.things))
    if others and fewest_pushes(puzzle, others) is not None:
        return False  # nothing else has to be moved
    pushes = fewest_pushes(puzzle)
    return pushes is not None and pushes >= LEAST_PUSHES


def _touches_another(puzzle: PushPuzzle) -> bool:
    """Return whether the first thing, which has a goal, touches another one along a side."""
    beside = {moved_cell(cell, step) for cell in puzzle.things[0] for step in CELL_STEPS}
    return any(beside & other for other in puzzle.things[1:])


def puzzle_files(puzzle: PushPuzzle, name: str) -> dict[str, str]:
    """Return the texts of the files of a puzzle's scenario by their names."""
    columns, rows = puzzle.size
    walls = np.zeros((rows, columns), np.bool_)
    for column, row in puzzle.walls:
        walls[row, column] = True
    drawn = world_text(CellWorld(walls, puzzle.things, puzzle.robot), SQUARES_A_CELL, BORDER_SQUARES)
    goals = [
        ObjectGoal(f"x{number}", drawn.objects[number], (float(east * SQUARES_A_CELL), float(north * SQUARES_A_CELL)))
        for number, (east, north) in puzzle.goals.items()
    ]
    imported = Imported("random puzzle of cells", drawn.file, drawn.text, *task_of_objects(goals, drawn.utak))
    return scenario_files(imported, name)


def main(arguments: Sequence[str] | None = None) -> None:
    """Write scenario folders and SOLVABLE.tsv, and print the names of the folders."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.worlds.cells.puzzles", description="Write random puzzles of cells as scenarios."
    )
    parser.add_argument("--kinds", default=",".join(PUZZLE_KINDS), help="with commas between (all)")
    parser.add_argument("--seed", type=int, default=0, help="the first seed (%(default)s)")
    parser.add_argument("--count", type=int, default=1, help="how many of each kind (%(default)s)")
    parser.add_argument("-o", "--output", type=Path, default=Path("puzzles"), help="folder (%(default)s)")
    given = parser.parse_args(arguments)
    lines = ["name\tverdict"]
    for kind in given.kinds.split(","):
        for seed in range(given.seed, given.seed + given.count):
            name = f"{kind}-{seed:04d}"
            write_folder(given.output / name, puzzle_files(random_puzzle(kind, seed), name))
            lines.append(f"{name}\t{SOLVABLE_WORD}")
            print(given.output / name)
    (given.output / SOLVABLE_FILE).write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
