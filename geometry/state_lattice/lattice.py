"""The state lattice of a body among squares: where it can lie, what each push costs, and where the robot can walk.

A pose on the lattice is a quarter turn 0..3 and a place, the square of the body's centroid. Squares are numbered row by
row on a table that is padded all round with solid squares, so that no step or turn leads out of the arrays.
"""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from utak.geometry.kernels.arrays import Bools, Longs
from utak.geometry.kernels.jit import compiled
from utak.geometry.state_lattice.footprints import PUSH_DIRECTIONS, Footprints, quarter

Costs = npt.NDArray[np.int32]
# Costs are whole numbers. COMMAND_COST is a convention, the others are tuned on random worlds (benchmarks.campaign).
COMMAND_COST = 500  # one command: a push or a turn
PUSH_SIDE_COST, PUSH_DIAGONAL_COST = 5, 7  # a push by one square; 7 / 5 approximates sqrt(2)
TIGHT_PUSH_COST, TIGHT_TURN_COST = 25, 600  # added to a push by one square, and to a turn, with less than the margin
WALK_COST = COMMAND_COST // 12  # a square walked
REGRASP_COST = 2 * COMMAND_COST  # letting go and grasping again, without the walk between
CORNER_GRASP_COST = COMMAND_COST // 5  # added to a grasp across a corner of the robot's square


class OffsetLists(NamedTuple):
    """Lists of numbers one after another: list n is items[first[n] : first[n + 1]]."""

    items: Longs  # (k,) int64
    first: Longs  # (lists + 1,) int64


class OffsetRuns(NamedTuple):
    """Lists of offsets as runs of consecutive ones: list n is the runs from first[n] on, up to first[n + 1]."""

    start: Longs  # (k,) int64, the first offset of each run
    after: Longs  # (k,) int64, the offset after its last one
    first: Longs  # (lists + 1,) int64


class StateLattice(NamedTuple):
    """All that the search asks of table and body, in arrays for numba. Offsets are differences of square numbers."""

    solid: Bools  # (squares,) bool, whether a square stops the body
    solid_before: Costs  # (squares + 1,) int32, how many squares of lesser numbers are solid
    walkable: Bools  # (squares,) bool, whether the robot may walk there while the body is not in its way
    holds: Longs  # (4, n) by quarter turn, the offset of each hold from the body's place
    grasp_cost: Costs  # (n,) cost of a grasp at each hold; -1 where the hold is not to be used
    # (4, 8, squares) by quarter turn and direction, the cost of a push by one square from a place; 0 where it is
    # blocked
    push_cost: Costs
    robot_can_step: Bools  # (8, squares) bool, whether the robot itself can make the step from a square
    lies: Bools  # (4, squares) bool, whether the body can lie at a place
    covered: OffsetLists  # by quarter turn, offsets of the squares of the body from its place
    # By hold * 4 + quarter turn, offsets of the squares that the body meets in a turn counter-clockwise about the hold,
    # from its place before the turn
    turns: OffsetRuns
    wide: OffsetRuns  # the same for the body with its margin
    push_allowed: Bools  # (4, n, 8) bool, whether the robot may push in a direction from a hold
    steps: Longs  # (8,) the offset of each direction
    turn_price: int  # cost of a turn where there is room for it


class Grid(NamedTuple):
    """The numbering of the squares of a table: padded by `pad` squares all round, row by row."""

    columns: int  # size of the table in squares, without padding
    rows: int
    pad: int  # width of the padding in squares

    @property
    def stride(self) -> int:
        """Return the number of squares in a padded row."""
        return self.columns + 2 * self.pad

    def number(self, column: int, row: int) -> int:
        """Return the number of the square (column, row) of the table; not checked."""
        return (row + self.pad) * self.stride + column + self.pad

    def square(self, number: int) -> tuple[int, int]:
        """Return the (column, row) in the table of a square's number; outside the table if it is in the padding."""
        return number % self.stride - self.pad, number // self.stride - self.pad

    def padded(self, squares: Bools, value: bool) -> Bools:
        """Return a (rows, columns) bool array as (squares,) by number of square, with `value` in the padding."""
        return np.pad(squares, self.pad, constant_values=value).ravel()

    def offsets(self, offsets: Longs) -> Longs:
        """Return offsets (n, 2) of columns and rows as differences of square numbers (n,) int64."""
        flat: Longs = offsets[:, 1] * self.stride + offsets[:, 0]
        return flat

    def table_squares(self) -> Longs:
        """Return the numbers of all squares of the table, without the padding: (rows * columns,) int64, row by row."""
        row, column = np.divmod(np.arange(self.rows * self.columns), self.columns)
        return (row + self.pad) * self.stride + column + self.pad

    def clear(self, solid: Bools, offsets: Longs) -> Bools:
        """Return at which squares of the table none of the offsets (n,) is solid."""
        found, clear, size = self.padded(np.ones((self.rows, self.columns), np.bool_), False), ~solid, len(solid)
        for offset in offsets.tolist():  # what lies off the ends of the array is further off the table
            here, there = slice(max(0, -offset), size - max(0, offset)), slice(max(0, offset), size + min(0, offset))
            found[here] &= clear[there]
        return found


def new_lattice_grid(columns: int, rows: int, body: Footprints, wide: Footprints) -> Grid:
    """Return a grid for a table, padded enough for every step and turn of a body."""
    reach = max(int(np.abs(part).max()) for part in (*body.turns, *wide.turns, *wide.steps))
    return Grid(columns, rows, max(reach, 2 * int(np.abs(body.holds).max())) + 2)


class LatticeBody(NamedTuple):
    """A body on a grid, wherever it lies among whatever squares: its footprints as differences of square numbers."""

    grid: Grid  # the numbering of squares
    holds: Longs  # as in StateLattice
    covered: OffsetLists
    turns: OffsetRuns
    wide: OffsetRuns
    lying: tuple[Longs, ...]  # by quarter turn, the squares that the body covers, from its place: four (m,) arrays
    # The squares met by a push of one square, without and with the margin, list number quarter turn * 8 + direction
    pushes: OffsetRuns
    wide_pushes: OffsetRuns
    has_margin: bool  # whether there is a margin


def new_lattice_body(grid: Grid, body: Footprints, wide: Footprints) -> LatticeBody:
    """Return a body on a grid: its footprints by quarter turn, hold and direction, as differences of square numbers."""
    lying = tuple(grid.offsets(quarter(body.lying, k)) for k in range(4))
    holds = np.array([grid.offsets(quarter(body.holds, k)) for k in range(4)])
    turns, pushes = _turn_footprints(grid, body), _push_footprints(grid, body)
    if wide is body:
        return LatticeBody(grid, holds, _joined([*lying]), turns, turns, lying, pushes, pushes, False)
    wide_turns, wide_pushes = _turn_footprints(grid, wide), _push_footprints(grid, wide)
    return LatticeBody(grid, holds, _joined([*lying]), turns, wide_turns, lying, pushes, wide_pushes, True)


class LatticeFloor(NamedTuple):
    """The poses and pushes of a body among some squares, and the steps of the robot: as in StateLattice."""

    solid: Bools  # as in StateLattice
    solid_before: Costs
    lies: Bools
    push_cost: Costs
    robot_can_step: Bools


def new_lattice_floor(free: Bools, body: LatticeBody) -> LatticeFloor:
    """Return where a body can lie and be pushed among some squares, and where the robot can step."""
    grid = body.grid
    solid, table_squares = grid.padded(~free, True), grid.table_squares()
    lies = np.array([grid.clear(solid, lying) for lying in body.lying])
    steps = grid.offsets(np.array(PUSH_DIRECTIONS))
    before = np.append(0, np.cumsum(solid)).astype(np.int32)
    push_cost = _push_costs(before, table_squares, lies, steps, body.pushes, body.wide_pushes, body.has_margin)
    can_step = [grid.clear(solid, grid.offsets(_squares_of_robot_step(*way))) for way in PUSH_DIRECTIONS]
    return LatticeFloor(solid, before, lies, push_cost, np.array(can_step))


def new_state_lattice(
    floor: LatticeFloor,
    body: LatticeBody,
    walkable: Bools,
    grasp_cost: Costs,
    push_allowed: Bools,
    turn_price: int,
) -> StateLattice:
    """Return the state lattice of a body on a table: arrays by number of square, quarter turn, hold and direction."""
    grid = body.grid
    return StateLattice(
        floor.solid,
        floor.solid_before,
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


def _push_footprints(grid: Grid, body: Footprints) -> OffsetRuns:
    """Return the squares met by a push of one square, list number quarter turn * 8 + direction."""
    return _offset_runs([grid.offsets(quarter(body.steps[(d - 2 * k) % 8], k)) for k in range(4) for d in range(8)])


def _turn_footprints(grid: Grid, body: Footprints) -> OffsetRuns:
    """Return the squares met by a quarter turn counter-clockwise, list number hold * 4 + quarter turn before it."""
    return _offset_runs([grid.offsets(quarter(turn, k)) for turn in body.turns for k in range(4)])


def _squares_of_robot_step(dx: int, dy: int) -> Longs:
    """Return the squares that must be free for a robot's step: its own, the next, and both beside a diagonal step."""
    return np.array(sorted({(0, 0), (dx, 0), (0, dy), (dx, dy)}), dtype=np.int64)


def _joined(lists: list[Longs]) -> OffsetLists:
    """Return lists of int64 as one OffsetLists, in the same order: list n is items[first[n] : first[n + 1]]."""
    first = np.concatenate([[0], np.cumsum([len(each) for each in lists])]).astype(np.int64)
    return OffsetLists(np.concatenate([np.empty(0, np.int64), *lists]), first)


def _offset_runs(lists: list[Longs]) -> OffsetRuns:
    """Return lists of offsets as runs."""
    ordered = [np.unique(each) for each in lists]
    gaps = [np.flatnonzero(np.diff(each) > 1) + 1 for each in ordered]
    start = _joined([each[np.append(0, gap)] for each, gap in zip(ordered, gaps, strict=True)])
    last = _joined([each[np.append(gap - 1, -1)] for each, gap in zip(ordered, gaps, strict=True)])
    return OffsetRuns(start.items, last.items + 1, start.first)


@compiled
def _push_costs(
    solid_before: Costs,
    table_squares: Longs,
    lies: Bools,
    steps: Longs,
    body: OffsetRuns,
    wide: OffsetRuns,
    with_margin: bool,
) -> Costs:
    """Return StateLattice.push_cost: (4, 8, squares) int32, the cost of a push by one square; 0 where it is blocked."""
    push_cost = np.zeros((4, 8, len(solid_before) - 1), np.int32)
    for k in range(4):
        for place in table_squares:
            if not lies[k, place]:
                continue
            for d in range(8):
                if not lies[k, place + steps[d]]:
                    continue
                if d % 2 == 0 or _is_clear(solid_before, body, k * 8 + d, place):
                    tight = with_margin and not _is_clear(solid_before, wide, k * 8 + d, place)
                    push_cost[k, d, place] = (PUSH_SIDE_COST if d % 2 == 0 else PUSH_DIAGONAL_COST) + (
                        TIGHT_PUSH_COST if tight else 0
                    )
    return push_cost


@compiled
def place_after_turn(lattice: StateLattice, hold: int, quarters: int, place: int, quarters_turned: int) -> int:
    """Return the place of the body, the number of its centroid's square, after a turn about a hold."""
    return int(place + lattice.holds[quarters, hold] - lattice.holds[(quarters + quarters_turned) % 4, hold])


@compiled
def turn_cost(lattice: StateLattice, hold: int, quarters: int, place: int, quarters_turned: int) -> int:
    """Return the cost of a quarter turn about a hold in addition to the price of every turn; -1 if it is blocked."""
    if quarters_turned < 0:
        place = place_after_turn(lattice, hold, quarters, place, quarters_turned)
        quarters = (quarters + 3) % 4
    if not lattice.lies[quarters, place]:
        return -1
    which = hold * 4 + quarters
    if not _is_clear(lattice.solid_before, lattice.turns, which, place):
        return -1
    return 0 if _is_clear(lattice.solid_before, lattice.wide, which, place) else TIGHT_TURN_COST


@compiled
def _is_clear(solid_before: Costs, lists: OffsetRuns, which: int, place: int) -> bool:
    """Return whether none of the offsets in list number `which`, seen from a place, is solid."""
    for n in range(lists.first[which], lists.first[which + 1]):
        if solid_before[place + lists.after[n]] != solid_before[place + lists.start[n]]:
            return False
    return True
