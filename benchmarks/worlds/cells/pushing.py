"""Whether things can be brought to places in a world of cells: breadth-first search over where everything lies.

The robot takes a cell, goes from cell to cell, and moves a thing beside it, with itself, by one cell. On the table it
takes less room and may turn things, so what is found can be done there; that nothing is found proves nothing there.
"""

from collections import deque
from collections.abc import Iterable, Iterator, Mapping
from typing import NamedTuple

from utak.simulator.importing.raster import RasterCell

CELL_STEPS: tuple[RasterCell, ...] = ((1, 0), (0, 1), (-1, 0), (0, -1))
MAX_LAYOUTS = 5_000  # layouts that are looked at; a bound on time


class PushPuzzle(NamedTuple):
    """A world of cells in which things shall be brought elsewhere."""

    size: tuple[int, int]  # columns, rows
    walls: frozenset[RasterCell]
    things: tuple[frozenset[RasterCell], ...]  # the cells of each thing as it lies at first
    robot: RasterCell
    goals: Mapping[int, RasterCell]  # by how far each thing shall be brought, by its number


class _Layout(NamedTuple):
    """The places of all things, by how far each was moved, and the part of the floor to which the robot can go."""

    moves: tuple[RasterCell, ...]
    robot: RasterCell


def fewest_pushes(puzzle: PushPuzzle, fixed: Iterable[int] = ()) -> int | None:
    """Return by how many cells things are moved at least until all goals hold; None where no way is found.

    fixed : the numbers of things that cannot be moved.
    """
    movable = [number for number in range(len(puzzle.things)) if number not in set(fixed)]
    start = _layout(puzzle, ((0, 0),) * len(puzzle.things), puzzle.robot)
    seen, waiting = {start}, deque([(start, 0)])
    while waiting:
        layout, pushes = waiting.popleft()
        if all(layout.moves[number] == move for number, move in puzzle.goals.items()):
            return pushes
        for after in _after(puzzle, layout, movable):
            if after not in seen and len(seen) < MAX_LAYOUTS:
                seen.add(after)
                waiting.append((after, pushes + 1))
    return None


def _after(puzzle: PushPuzzle, layout: _Layout, movable: Iterable[int]) -> Iterator[_Layout]:
    """Yield the layouts that one push or pull leads to."""
    places = [moved_cells(cells, move) for cells, move in zip(puzzle.things, layout.moves, strict=True)]
    reached = _reached(puzzle, frozenset().union(*places), layout.robot)
    for number in movable:
        others = frozenset().union(*(cells for other, cells in enumerate(places) if other != number))
        beside = {moved_cell(cell, step) for cell in places[number] for step in CELL_STEPS} & reached
        for robot in sorted(beside):
            for step in CELL_STEPS:
                both = {*moved_cells(places[number], step), moved_cell(robot, step)}
                if any(cell in others or not _is_floor(puzzle, cell) for cell in both):
                    continue
                moves = list(layout.moves)
                moves[number] = moved_cell(moves[number], step)
                yield _layout(puzzle, tuple(moves), moved_cell(robot, step))


def _layout(puzzle: PushPuzzle, moves: tuple[RasterCell, ...], robot: RasterCell) -> _Layout:
    """Return a layout with the robot anywhere that it can go to."""
    places = (moved_cells(cells, move) for cells, move in zip(puzzle.things, moves, strict=True))
    return _Layout(moves, min(_reached(puzzle, frozenset().union(*places), robot)))


def _reached(puzzle: PushPuzzle, taken: frozenset[RasterCell], robot: RasterCell) -> set[RasterCell]:
    """Return the cells that the robot can go to."""
    reached, waiting = {robot}, [robot]
    while waiting:
        cell = waiting.pop()
        for step in CELL_STEPS:
            to = moved_cell(cell, step)
            if to not in reached and to not in taken and _is_floor(puzzle, to):
                reached.add(to)
                waiting.append(to)
    return reached


def _is_floor(puzzle: PushPuzzle, cell: RasterCell) -> bool:
    columns, rows = puzzle.size
    return 0 <= cell[0] < columns and 0 <= cell[1] < rows and cell not in puzzle.walls


def moved_cell(cell: RasterCell, move: RasterCell) -> RasterCell:
    """Return a cell moved by (columns, rows)."""
    return cell[0] + move[0], cell[1] + move[1]


def moved_cells(cells: Iterable[RasterCell], move: RasterCell) -> frozenset[RasterCell]:
    """Return cells moved by (columns, rows)."""
    return frozenset(moved_cell(cell, move) for cell in cells)
