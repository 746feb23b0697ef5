"""The state lattice of a body among squares: where it can lie, what each push costs, and where the robot can walk.

A pose on the lattice is a quarter turn 0..3 and a place, the square of the body's centroid. Squares are numbered row by
row on a table that is padded all round with solid squares, so that no step or turn leads out of the arrays.
"""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from geometry.kernels.arrays import Bools, Longs
from geometry.kernels.jit import compiled
from geometry.state_lattice.footprints import PUSH_DIRECTIONS, Footprints, quarter

Costs = npt.NDArray[np.int32]
# Costs are whole numbers. COMMAND_COST is a convention, the others are tuned on random worlds (benchmarks.campaign).
COMMAND_COST = 500  # one command: a push or a turn
PUSH_SIDE_COST, PUSH_DIAGONAL_COST = 5, 7  # a push by one square; 7 / 5 approximates sqrt(2)
TIGHT_PUSH_COST, TIGHT_TURN_COST = 25, 600  # added to a push by one square, and to a turn, with less than the margin
WALK_COST = COMMAND_COST // 12  # a square walked
REGRASP_COST = 2 * COMMAND_COST  # letting go and grasping again, without the walk between
CORNER_GRASP_COST = COMMAND_COST // 5  # added to a grasp across a corner of the robot's square


class OffsetLists(NamedTuple):
    """Lists of numbers one after another: list n is items[first[n] : first[n + 1]].

    Attributes
    ----------
    items : (k,) int64.
    first : (lists + 1,) int64.
    """

    items: Longs
    first: Longs


class StateLattice(NamedTuple):
    """All that the search asks of table and body, in arrays for numba. Offsets are differences of square numbers.

    Squares are numbered as in Grid, padding included. A hold is a square from which the robot grasps the body. Quarter
    turns 0..3 are those of the body, counter-clockwise from how it lies; its place is the number of the square of its
    centroid. Directions are those of PUSH_DIRECTIONS. Costs are whole numbers, COMMAND_COST for a command.

    Attributes
    ----------
    solid : (squares,) bool, whether a square stops the body.
    walkable : (squares,) bool, whether the robot may walk there while the body is not in its way.
    holds : (4, n) by quarter turn, the offset of each hold from the body's place.
    grasp_cost : (n,) cost of a grasp at each hold; -1 where the hold is not to be used.
    push_cost : (4, 8, squares) by quarter turn and direction, the cost of a push by one square from a place; 0 where it
        is blocked.
    robot_can_step : (8, squares) bool, whether the robot itself can make the step from a square.
    lies : (4, squares) bool, whether the body can lie at a place.
    covered : by quarter turn, offsets of the squares of the body from its place.
    turns : by hold * 4 + quarter turn, offsets of the squares that the body meets in a turn counter-clockwise about the
        hold, from its place before the turn.
    wide : the same for the body with its margin.
    push_allowed : (4, n, 8) bool, whether the robot may push in a direction from a hold.
    steps : (8,) the offset of each direction.
    turn_price : cost of a turn where there is room for it.
    """

    solid: Bools
    walkable: Bools
    holds: Longs
    grasp_cost: Costs
    push_cost: Costs
    robot_can_step: Bools
    lies: Bools
    covered: OffsetLists
    turns: OffsetLists
    wide: OffsetLists
    push_allowed: Bools
    steps: Longs
    turn_price: int


class Grid(NamedTuple):
    """The numbering of the squares of a table: padded by `pad` squares all round, row by row.

    A number is (row + pad) * stride + column + pad; row 0 of the table is in the south.

    Attributes
    ----------
    columns, rows : size of the table in squares, without padding.
    pad : width of the padding in squares.
    """

    columns: int
    rows: int
    pad: int

    @property
    def stride(self) -> int:
        """Return the number of squares in a padded row."""
        return self.columns + 2 * self.pad

    def number(self, column: int, row: int) -> int:
        """Return the number of the square (column, row) of the table; not checked.

        Columns and rows up to `pad` beyond the table give squares of the padding.
        """
        return (row + self.pad) * self.stride + column + self.pad

    def square(self, number: int) -> tuple[int, int]:
        """Return the (column, row) in the table of a square's number; outside the table if it is in the padding.

        Row 0 of the table is in the south.
        """
        return number % self.stride - self.pad, number // self.stride - self.pad

    def padded(self, squares: Bools, value: bool) -> Bools:
        """Return a (rows, columns) bool array as (squares,) by number of square, with `value` in the padding.

        `squares` : that array, for the table without padding. A copy; row 0 of the array is row 0 of the table.
        """
        return np.pad(squares, self.pad, constant_values=value).ravel()

    def offsets(self, offsets: Longs) -> Longs:
        """Return offsets (n, 2) of columns and rows as differences of square numbers (n,) int64.

        That is rows * stride + columns, in the same order.
        """
        flat: Longs = offsets[:, 1] * self.stride + offsets[:, 0]
        return flat

    def table_squares(self) -> Longs:
        """Return the numbers of all squares of the table, without the padding: (rows * columns,) int64, row by row."""
        row, column = np.divmod(np.arange(self.rows * self.columns), self.columns)
        return (row + self.pad) * self.stride + column + self.pad

    def clear(self, solid: Bools, offsets: Longs) -> Bools:
        """Return at which squares of the table none of the offsets (n, 2) is solid: (squares,), False off the table.

        Parameters
        ----------
        solid : (squares,) bool by number of square.
        offsets : (n, 2) columns and rows from the square that is asked for.
        """
        return _mark_clear(solid, self.table_squares(), self.offsets(offsets))


def new_lattice_grid(free: Bools, body: Footprints, wide: Footprints) -> Grid:
    """Return a grid for a table of free squares (rows, columns), padded enough for every step and turn of a body.

    A Grid holds the columns and rows of the table and the width of the padding, in squares; a square's number is (row +
    pad) * (columns + 2 pad) + column + pad, row 0 in the south. `free` : only its shape is read.

    `body`, `wide` : footprints of the body without and with its margin.
    """
    reach = max(int(np.abs(part).max()) for part in (*body.turns, *wide.turns, *wide.steps))
    return Grid(free.shape[1], free.shape[0], max(reach, 2 * int(np.abs(body.holds).max())) + 2)


def new_state_lattice(
    grid: Grid,
    free: Bools,
    walkable: Bools,
    body: Footprints,
    wide: Footprints,
    grasp_cost: Costs,
    push_allowed: Bools,
    turn_price: int,
) -> StateLattice:
    """Return the state lattice of a body on a table: arrays by number of square, quarter turn, hold and direction.

    They say where the body can lie, what a push by one square costs (0 where blocked), where the robot can walk and
    step, what a grasp costs, and which squares a turn meets.

    Parameters
    ----------
    grid : the numbering of squares.
    free : (rows, columns) bool, row 0 in the south: squares that do not stop the body.
    walkable : (rows, columns) bool: where the robot may walk.
    body : footprints of the body.
    wide : those of the body with its margin, or the same object without a margin.
    grasp_cost : (holds,) cost of a grasp at each of body.holds; -1 where the hold is not to be used.
    push_allowed : (4, holds, 8) bool by quarter turn, hold and direction: whether the robot may push.
    turn_price : cost of a turn where there is room for it; COMMAND_COST stands for a command.
    """
    solid = grid.padded(~free, True)
    table_squares, quarters = grid.table_squares(), [quarter(body.lying, k) for k in range(4)]
    push_cost = _push_costs(
        solid, table_squares, _push_footprints(grid, body), _push_footprints(grid, wide), wide is not body
    )
    covered, turns = _joined([grid.offsets(lying) for lying in quarters]), _turn_footprints(grid, body)
    return StateLattice(
        solid,
        grid.padded(walkable, False),
        np.array([grid.offsets(quarter(body.holds, k)) for k in range(4)]),
        grasp_cost,
        push_cost,
        np.array(
            [
                _mark_clear(solid, table_squares, grid.offsets(_squares_of_robot_step(dx, dy)))
                for dx, dy in PUSH_DIRECTIONS
            ]
        ),
        np.array([_mark_clear(solid, table_squares, grid.offsets(lying)) for lying in quarters]),
        covered,
        turns,
        turns if wide is body else _turn_footprints(grid, wide),
        push_allowed,
        grid.offsets(np.array(PUSH_DIRECTIONS)),
        turn_price,
    )


def _push_footprints(grid: Grid, body: Footprints) -> OffsetLists:
    """Return the squares met by a push of one square, list number quarter turn * 8 + direction.

    `grid` : the numbering of squares. `body` : its footprints, unturned. List n is items[first[n] : first[n + 1]]. As
        offsets of square numbers from the body's place before the push.
    """
    return _joined([grid.offsets(quarter(body.steps[(d - 2 * k) % 8], k)) for k in range(4) for d in range(8)])


def _turn_footprints(grid: Grid, body: Footprints) -> OffsetLists:
    """Return the squares met by a quarter turn counter-clockwise, list number hold * 4 + quarter turn before it.

    `grid` : the numbering of squares. `body` : its footprints, unturned. List n is items[first[n] : first[n + 1]]. As
        offsets of square numbers from the body's place before the turn.
    """
    return _joined([grid.offsets(quarter(turn, k)) for turn in body.turns for k in range(4)])


def _squares_of_robot_step(dx: int, dy: int) -> Longs:
    """Return the squares that must be free for a robot's step: its own, the next, and both beside a diagonal step.

    Two of them for a step along an axis, four for a diagonal one. Offsets (n, 2) column, row from its own square. `dx`,
    `dy` : -1, 0 or 1, to the east and to the north.
    """
    return np.array(sorted({(0, 0), (dx, 0), (0, dy), (dx, dy)}), dtype=np.int64)


def _joined(lists: list[Longs]) -> OffsetLists:
    """Return lists of int64 as one OffsetLists, in the same order: list n is items[first[n] : first[n + 1]]."""
    first = np.concatenate([[0], np.cumsum([len(each) for each in lists])]).astype(np.int64)
    return OffsetLists(np.concatenate([np.empty(0, np.int64), *lists]), first)


@compiled
def _mark_clear(solid: Bools, table_squares: Longs, offsets: Longs) -> Bools:
    """Return at which of the places none of the offsets is solid: (squares,) bool, False elsewhere.

    Parameters
    ----------
    solid : (squares,) bool by number of square.
    table_squares : numbers of the places that are looked at.
    offsets : (n,) differences of square numbers.
    """
    clear = np.zeros(len(solid), np.bool_)
    for place in table_squares:
        clear[place] = True
        for offset in offsets:
            if solid[place + offset]:
                clear[place] = False
                break
    return clear


@compiled
def _push_costs(solid: Bools, table_squares: Longs, body: OffsetLists, wide: OffsetLists, with_margin: bool) -> Costs:
    """Return StateLattice.push_cost: (4, 8, squares) int32, the cost of a push by one square; 0 where it is blocked.

    Parameters
    ----------
    solid : (squares,) bool by number of square.
    table_squares : numbers of the squares of the table; off it pushes are blocked.
    body, wide : squares met by a push, without and with the margin, list number quarter turn * 8 + direction.
    with_margin : whether there is a margin; pushes for which it is too tight cost TIGHT_PUSH_COST more.
    """
    push_cost = np.zeros((4, 8, len(solid)), np.int32)
    for k in range(4):
        for d in range(8):
            for place in table_squares:
                if _is_clear(solid, body, k * 8 + d, place):
                    tight = with_margin and not _is_clear(solid, wide, k * 8 + d, place)
                    push_cost[k, d, place] = (PUSH_SIDE_COST if d % 2 == 0 else PUSH_DIAGONAL_COST) + (
                        TIGHT_PUSH_COST if tight else 0
                    )
    return push_cost


@compiled
def place_after_turn(lattice: StateLattice, hold: int, quarters: int, place: int, quarters_turned: int) -> int:
    """Return the place of the body, the number of its centroid's square, after a turn about a hold.

    Parameters
    ----------
    lattice : the state lattice, of which the offsets of the holds are read.
    hold : index of the hold; the robot stands there.
    quarters, place : the body's quarter turn and place before.
    quarters_turned : quarter turns made, counter-clockwise positive.
    """
    return int(place + lattice.holds[quarters, hold] - lattice.holds[(quarters + quarters_turned) % 4, hold])


@compiled
def turn_cost(lattice: StateLattice, hold: int, quarters: int, place: int, quarters_turned: int) -> int:
    """Return the cost of a quarter turn about a hold in addition to the price of every turn; -1 if it is blocked.

    A whole number, COMMAND_COST for a command.

    0 where the margin has room, TIGHT_TURN_COST where only the body has. The robot's own square is not looked at.

    Parameters
    ----------
    lattice : the state lattice.
    hold : index of the hold; the robot stands there.
    quarters, place : the pose before: quarter turn, number of the square of the centroid.
    quarters_turned : 1 for counter-clockwise, -1 for clockwise.
    """
    if quarters_turned < 0:
        place = place_after_turn(lattice, hold, quarters, place, quarters_turned)
        quarters = (quarters + 3) % 4
    if not lattice.lies[quarters, place]:
        return -1
    which = hold * 4 + quarters
    if not _is_clear(lattice.solid, lattice.turns, which, place):
        return -1
    return 0 if _is_clear(lattice.solid, lattice.wide, which, place) else TIGHT_TURN_COST


@compiled
def _is_clear(solid: Bools, lists: OffsetLists, which: int, place: int) -> bool:
    """Return whether none of the offsets in list number `which`, seen from a place, is solid.

    `solid` : (squares,) bool by number of square. `lists` : offsets of square numbers; list n is items[first[n] :
        first[n + 1]]. `place` : number of a square.
    """
    for n in range(lists.first[which], lists.first[which + 1]):  # noqa: SIM110 (numba)
        if solid[place + lists.items[n]]:
            return False
    return True
