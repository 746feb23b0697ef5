"""Puzzles of cells: what the search says of small ones, and that random ones are what their kind says."""

from pathlib import Path

import pytest

from benchmarks.worlds.cells.pushing import PushPuzzle, fewest_pushes
from benchmarks.worlds.cells.puzzles import PUZZLE_KINDS, puzzle_files, random_puzzle
from utak.simulator.scenario.folder_writer import write_folder
from utak.simulator.scenario.scenario import read_scenario

SOON_FOUND = {"one": 1, "two": 1, "door": 0, "blocks": 0, "touching": 1}  # a seed of each kind, for time


def drawn(rows: list[str], goal: tuple[int, int], fixed: tuple[int, ...] = ()) -> int | None:
    """Return the fewest pushes in a drawing: `#` wall, `U` the robot, thing 0 (moved by `goal`) and the others."""
    cells = {(x, y): mark for y, row in enumerate(reversed(rows)) for x, mark in enumerate(row)}
    things = [frozenset(cell for cell, mark in cells.items() if mark == name) for name in "0123"]
    walls = frozenset(cell for cell, mark in cells.items() if mark == "#")
    robot = next(cell for cell, mark in cells.items() if mark == "U")
    puzzle = PushPuzzle((len(rows[0]), len(rows)), walls, tuple(filter(None, things)), robot, {0: goal})
    return fewest_pushes(puzzle, fixed)


def test_a_thing_is_pushed_along_a_corridor_as_far_as_it_shall() -> None:
    assert drawn(["U0..."], (3, 0)) == 3


def test_a_thing_is_pulled_where_nobody_comes_behind_it() -> None:
    assert drawn(["0U.."], (2, 0)) == 2
    assert drawn(["0U.."], (3, 0)) is None  # the robot would stand in the wall


def test_what_is_in_the_way_is_moved_first() -> None:
    rows = ["U....", ".01.#"]
    assert drawn(rows, (1, 0)) == 2
    assert drawn(rows, (1, 0), fixed=(1,)) is None


@pytest.mark.parametrize("kind", PUZZLE_KINDS)
def test_random_puzzles_are_of_their_kind_and_can_be_done(kind: str, tmp_path: Path) -> None:
    puzzle = random_puzzle(kind, SOON_FOUND[kind])
    assert puzzle == random_puzzle(kind, SOON_FOUND[kind])
    assert fewest_pushes(puzzle) is not None
    others = range(len(puzzle.goals), len(puzzle.things))
    assert not others or fewest_pushes(puzzle, others) is None
    write_folder(tmp_path / "it", puzzle_files(puzzle, "it"))
    assert len(read_scenario(tmp_path / "it").world.movable) == len(puzzle.things)
