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
PushCosts = npt.NDArray[np.int8]  # of single squares, which are small
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
    push_cost: PushCosts
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
        """Return at which squares of the table none of the offsets (n,) is solid: (squares,) bool, False off the table.

        Parameters
        ----------
        solid : (squares,) bool by number of square.
        offsets : (n,) differences of square numbers, from the square that is asked for.
        """
        found, clear, size = self.padded(np.ones((self.rows, self.columns), np.bool_), False), ~solid, len(solid)
        for offset in offsets.tolist():  # what lies off the ends of the array is further off the table
            here, there = slice(max(0, -offset), size - max(0, offset)), slice(max(0, offset), size + min(0, offset))
            found[here] &= clear[there]
        return found


def new_lattice_grid(columns: int, rows: int, body: Footprints, wide: Footprints) -> Grid:
    """Return a grid for a table, padded enough for every step and turn of a body.

    A Grid holds the columns and rows of the table and the width of the padding, in squares; a square's number is (row +
    pad) * (columns + 2 pad) + column + pad, row 0 in the south.

    Parameters
    ----------
    columns, rows : size of the table in squares.
    body, wide : footprints of the body without and with its margin.
    """
    reach = max(int(np.abs(part).max()) for part in (*body.turns, *wide.turns, *wide.steps))
    return Grid(columns, rows, max(reach, 2 * int(np.abs(body.holds).max())) + 2)


class LatticeBody(NamedTuple):
    """A body on a grid, wherever it lies among whatever squares: its footprints as differences of square numbers.

    Attributes
    ----------
    grid : the numbering of squares.
    holds, covered, turns, wide : as in StateLattice.
    lying : by quarter turn, the squares that the body covers, from its place: four (m,) arrays.
    pushes, wide_pushes : the squares met by a push of one square, without and with the margin, list number quarter turn
        * 8 + direction.
    has_margin : whether there is a margin.
    """

    grid: Grid
    holds: Longs
    covered: OffsetLists
    turns: OffsetLists
    wide: OffsetLists
    lying: tuple[Longs, ...]
    pushes: OffsetLists
    wide_pushes: OffsetLists
    has_margin: bool


def new_lattice_body(grid: Grid, body: Footprints, wide: Footprints) -> LatticeBody:
    """Return a body on a grid: its footprints by quarter turn, hold and direction, as differences of square numbers.

    Parameters
    ----------
    grid : the numbering of squares.
    body : footprints of the body.
    wide : those of the body with its margin, or the same object without a margin.
    """
    lying = tuple(grid.offsets(quarter(body.lying, k)) for k in range(4))
    holds = np.array([grid.offsets(quarter(body.holds, k)) for k in range(4)])
    turns, pushes = _turn_footprints(grid, body), _push_footprints(grid, body)
    if wide is body:
        return LatticeBody(grid, holds, _joined([*lying]), turns, turns, lying, pushes, pushes, False)
    wide_turns, wide_pushes = _turn_footprints(grid, wide), _push_footprints(grid, wide)
    return LatticeBody(grid, holds, _joined([*lying]), turns, wide_turns, lying, pushes, wide_pushes, True)


class LatticeFloor(NamedTuple):
    """The poses and pushes of a body among some squares, and the steps of the robot: as in StateLattice.

    Attributes
    ----------
    solid, lies, push_cost, robot_can_step : as in StateLattice.
    """

    solid: Bools
    lies: Bools
    push_cost: PushCosts
    robot_can_step: Bools


def new_lattice_floor(free: Bools, body: LatticeBody) -> LatticeFloor:
    """Return where a body can lie and be pushed among some squares, and where the robot can step.

    Parameters
    ----------
    free : (rows, columns) bool, row 0 in the south: squares that do not stop the body.
    body : the body on the grid of these squares.
    """
    grid = body.grid
    solid, table_squares = grid.padded(~free, True), grid.table_squares()
    lies = np.array([grid.clear(solid, lying) for lying in body.lying])
    steps = grid.offsets(np.array(PUSH_DIRECTIONS))
    push_cost = _push_costs(solid, table_squares, lies, steps, body.pushes, body.wide_pushes, body.has_margin)
    can_step = [grid.clear(solid, grid.offsets(_squares_of_robot_step(*way))) for way in PUSH_DIRECTIONS]
    return LatticeFloor(solid, lies, push_cost, np.array(can_step))


def new_state_lattice(
    floor: LatticeFloor,
    body: LatticeBody,
    walkable: Bools,
    grasp_cost: Costs,
    push_allowed: Bools,
    turn_price: int,
) -> StateLattice:
    """Return the state lattice of a body on a table: arrays by number of square, quarter turn, hold and direction.

    They say where the body can lie, what a push by one square costs (0 where blocked), where the robot can walk and
    step, what a grasp costs, and which squares a turn meets.

    Parameters
    ----------
    floor : where the body can lie and be pushed.
    body : the body on its grid.
    walkable : (rows, columns) bool, row 0 in the south: where the robot may walk.
    grasp_cost : (holds,) cost of a grasp at each of body.holds; -1 where the hold is not to be used.
    push_allowed : (4, holds, 8) bool by quarter turn, hold and direction: whether the robot may push.
    turn_price : cost of a turn where there is room for it; COMMAND_COST stands for a command.
    """
    grid = body.grid
    return StateLattice(
        floor.solid,
        grid.padded(walkable, False),
        body.holds,
        grasp_cost,
        floor.push_cost,
        floor.robot_can_step,
        floor.lies,
        body.covered,
        body.turns,
        body.wide,
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
def _push_costs(
    solid: Bools,
    table_squares: Longs,
    lies: Bools,
    steps: Longs,
    body: OffsetLists,
    wide: OffsetLists,
    with_margin: bool,
) -> PushCosts:
    """Return StateLattice.push_cost: (4, 8, squares) int8, the cost of a push by one square; 0 where it is blocked.

    A push along an axis meets the squares of its two ends alone; a diagonal one meets more.

    Parameters
    ----------
    solid : (squares,) bool by number of square.
    table_squares : numbers of the squares of the table; off it pushes are blocked.
    lies : (4, squares) bool, whether the body can lie at a place.
    steps : (8,) the offset of each direction.
    body, wide : squares met by a push, without and with the margin, list number quarter turn * 8 + direction.
    with_margin : whether there is a margin; pushes for which it is too tight cost TIGHT_PUSH_COST more.
    """
    push_cost = np.zeros((4, 8, len(solid)), np.int8)
    for k in range(4):
        for place in table_squares:
            if not lies[k, place]:
                continue
            for d in range(8):
                if not lies[k, place + steps[d]]:
                    continue
                if d % 2 == 0 or _is_clear(solid, body, k * 8 + d, place):
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
