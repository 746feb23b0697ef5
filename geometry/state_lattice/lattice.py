"""The squares on which something is carried: where it can lie, what each push costs, and where Utak can walk.

A pose on the board is a quarter turn 0..3 and a place, the square of the body's centroid. Squares are counted row by
row on a table that is padded all round with solid squares, so that no step or turn leads out of the arrays.
Costs are whole numbers: COMMAND for a command, SIDE and DIAGONAL for the squares travelled.
"""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from geometry.kernels.arrays import Bools, Longs
from geometry.kernels.jit import compiled
from geometry.state_lattice.footprints import DIRECTIONS, Footprints, quarter

Costs = npt.NDArray[np.int32]
COMMAND = 500
SIDE, DIAGONAL = 5, 7
TIGHT_PUSH, TIGHT_TURN = 25, 600  # a square pushed, a turn made with less than the margin wished for
WALK = COMMAND // 12  # a square walked
REGRASP = 2 * COMMAND  # to let go and take again, without the walk between
AWKWARD = COMMAND // 5  # a grasp of a square that is reached over a corner only


class Lists(NamedTuple):
    """Lists of numbers one after another: list n is items[first[n] : first[n + 1]]."""

    items: Longs
    first: Longs


class StateLattice(NamedTuple):
    """All that the search asks of table and body, in arrays for numba. Offsets are differences of square numbers.

    solid, walk : (squares,) what stops a body; where Utak may walk when nothing is in his way.
    holds : (4, n) the offset of each hold from the body's place, by quarter turn. grip : (n,) the price of a grasp
    there, -1 where it is not to be used.
    push : (4, 8, squares) the price of a push by one square, 0 when it is blocked. utak : (8, squares) whether he can
    make the step himself. lies : (4, squares) whether the body can lie at a place.
    image : by quarter turn, the squares of the body. turns : by hold * 4 + quarter turn, those that it meets in a turn
    counter-clockwise about the hold. wide : the same of the body with its margin.
    allowed : (4, n, 8) whether one may push in a direction from a hold.
    steps : (8,) the offset of each direction. turn : the price of a turn where there is room for it.
    """

    solid: Bools
    walk: Bools
    holds: Longs
    grip: Costs
    push: Costs
    utak: Bools
    lies: Bools
    image: Lists
    turns: Lists
    wide: Lists
    allowed: Bools
    steps: Longs
    turn: int


class Grid(NamedTuple):
    """How the squares of a table of columns x rows are counted: padded by `pad` all round, row by row."""

    columns: int
    rows: int
    pad: int

    @property
    def stride(self) -> int:
        """How many squares there are in a padded row."""
        return self.columns + 2 * self.pad

    def number(self, column: int, row: int) -> int:
        """The number of a square."""
        return (row + self.pad) * self.stride + column + self.pad

    def square(self, number: int) -> tuple[int, int]:
        """The (column, row) of a number."""
        return number % self.stride - self.pad, number // self.stride - self.pad

    def padded(self, squares: Bools, value: bool) -> Bools:
        """A (rows, columns) array as (squares,)."""
        return np.pad(squares, self.pad, constant_values=value).ravel()

    def offsets(self, offsets: Longs) -> Longs:
        """Offsets (n, 2) of columns and rows as differences of numbers."""
        flat: Longs = offsets[:, 1] * self.stride + offsets[:, 0]
        return flat

    def places(self) -> Longs:
        """The numbers of all squares of the table."""
        row, column = np.divmod(np.arange(self.rows * self.columns), self.columns)
        return (row + self.pad) * self.stride + column + self.pad

    def clear(self, solid: Bools, offsets: Longs) -> Bools:
        """At which squares of the table none of the offsets (n, 2) is solid: (squares,), False off the table."""
        return _clear(solid, self.places(), self.offsets(offsets))


def new_grid(free: Bools, body: Footprints, wide: Footprints) -> Grid:
    """A grid padded widely enough for every step and turn of a body."""
    reach = max(int(np.abs(part).max()) for part in (*body.turns, *wide.turns, *wide.steps))
    return Grid(free.shape[1], free.shape[0], max(reach, 2 * int(np.abs(body.holds).max())) + 2)


def new_board(
    grid: Grid, free: Bools, walk: Bools, body: Footprints, wide: Footprints, grip: Costs, allowed: Bools, turn: int
) -> StateLattice:
    """The board of free squares (rows, columns) for a body, and for the same body with its margin."""
    solid = grid.padded(~free, True)
    places, quarters = grid.places(), [quarter(body.lying, k) for k in range(4)]
    push = _pushes(solid, places, _stepped(grid, body), _stepped(grid, wide), wide is not body)
    image, turns = _listed([grid.offsets(lying) for lying in quarters]), _turned(grid, body)
    return StateLattice(
        solid,
        grid.padded(walk, False),
        np.array([grid.offsets(quarter(body.holds, k)) for k in range(4)]),
        grip,
        push,
        np.array([_clear(solid, places, grid.offsets(_corner(dx, dy))) for dx, dy in DIRECTIONS]),
        np.array([_clear(solid, places, grid.offsets(lying)) for lying in quarters]),
        image,
        turns,
        turns if wide is body else _turned(grid, wide),
        allowed,
        grid.offsets(np.array(DIRECTIONS)),
        turn,
    )


def _stepped(grid: Grid, body: Footprints) -> Lists:
    """The squares met by a push, by quarter turn * 8 + direction."""
    return _listed([grid.offsets(quarter(body.steps[(d - 2 * k) % 8], k)) for k in range(4) for d in range(8)])


def _turned(grid: Grid, body: Footprints) -> Lists:
    """The squares met by a quarter turn counter-clockwise, by hold * 4 + quarter turn."""
    return _listed([grid.offsets(quarter(turn, k)) for turn in body.turns for k in range(4)])


def _corner(dx: int, dy: int) -> Longs:
    """The squares that must be free for Utak to take a step: his own and the next, both sides of a diagonal too."""
    return np.array(sorted({(0, 0), (dx, 0), (0, dy), (dx, dy)}), dtype=np.int64)


def _listed(lists: list[Longs]) -> Lists:
    """Lists one after another."""
    first = np.concatenate([[0], np.cumsum([len(each) for each in lists])]).astype(np.int64)
    return Lists(np.concatenate([np.empty(0, np.int64), *lists]), first)


@compiled
def _clear(solid: Bools, places: Longs, offsets: Longs) -> Bools:
    clear = np.zeros(len(solid), np.bool_)
    for place in places:
        clear[place] = True
        for offset in offsets:
            if solid[place + offset]:
                clear[place] = False
                break
    return clear


@compiled
def _pushes(solid: Bools, places: Longs, body: Lists, wide: Lists, with_margin: bool) -> Costs:
    """The prices of StateLattice.push."""
    push = np.zeros((4, 8, len(solid)), np.int32)
    for k in range(4):
        for d in range(8):
            for place in places:
                if _fits(solid, body, k * 8 + d, place):
                    tight = with_margin and not _fits(solid, wide, k * 8 + d, place)
                    push[k, d, place] = (SIDE if d % 2 == 0 else DIAGONAL) + (TIGHT_PUSH if tight else 0)
    return push


@compiled
def turned_place(board: StateLattice, hold: int, quarters: int, place: int, way: int) -> int:
    """Where the body's centroid comes to in so many quarter turns about a hold, counter-clockwise positive."""
    return int(place + board.holds[quarters, hold] - board.holds[(quarters + way) % 4, hold])


@compiled
def turn_cost(board: StateLattice, hold: int, quarters: int, place: int, way: int) -> int:
    """The cost of a quarter turn (way 1 or -1) about a hold without the command itself, -1 when it is blocked."""
    if way < 0:
        place = turned_place(board, hold, quarters, place, way)
        quarters = (quarters + 3) % 4
    if not board.lies[quarters, place]:
        return -1
    which = hold * 4 + quarters
    if not _fits(board.solid, board.turns, which, place):
        return -1
    return 0 if _fits(board.solid, board.wide, which, place) else TIGHT_TURN


@compiled
def _fits(solid: Bools, lists: Lists, which: int, place: int) -> bool:
    """Whether none of the offsets in a list, seen from a place, is solid."""
    for n in range(lists.first[which], lists.first[which + 1]):  # noqa: SIM110 (numba)
        if solid[place + lists.items[n]]:
            return False
    return True
