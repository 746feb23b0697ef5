"""The squares on which something is carried: where it can lie, what each push costs, and where Utak can walk.

A pose on the board is a quarter turn 0..3 and a place, the square of the body's centroid (row * columns + column).
Costs are whole numbers: COMMAND for a command, SIDE and DIAGONAL for the squares travelled.
"""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from geometry.compiled import compiled
from geometry.stencil import DIRECTIONS, Ints, Mask, Stencil, quarter

Costs = npt.NDArray[np.int32]
COMMAND = 500
SIDE, DIAGONAL = 5, 7
TIGHT_PUSH, TIGHT_TURN = 25, 600  # a square pushed, a turn made with less than the margin wished for
WALK = COMMAND // 12  # a square walked
REGRASP = 2 * COMMAND  # to let go and take again, without the walk between
AWKWARD = COMMAND // 5  # a grasp of a square that is reached over a corner only


class Board(NamedTuple):
    """All that the search asks of table and body, in arrays for numba.

    frame : (5,) columns, rows, pad, stride of padded rows, least distance of the window of a walk.
    solid, walk : padded squares, flat: what stops a body; where Utak may walk when nothing is in his way.
    holds : (4, n, 2) the offsets of the holds in each quarter turn. grip : (n,) the cost of a grasp there, -1 unusable.
    push : (4, 8, places) the cost of a push by one square, 0 when it is blocked; utak : (8, places) whether he can go.
    lies : (4, places) whether the body can lie there; image, image_first : padded offsets of its squares, by quarter.
    turns, turns_first : padded offsets, from the body's place, of what a turn counter-clockwise about a hold meets, by
    hold * 4 + quarter; wide, wide_first : the same of the body with its margin.
    allowed : (4, n, 8) whether one may push in a direction from a hold.
    """

    frame: Ints
    solid: Mask
    walk: Mask
    holds: Ints
    grip: Costs
    push: Costs
    utak: Mask
    lies: Mask
    image: Ints
    image_first: Ints
    turns: Ints
    turns_first: Ints
    wide: Ints
    wide_first: Ints
    allowed: Mask


def new_board(free: Mask, walk: Mask, body: Stencil, wide: Stencil, grip: Costs, allowed: Mask) -> Board:
    """The board of free squares for a body, and for the same body with its margin around it."""
    rows, columns = free.shape
    pad = int(max(np.abs(part).max() for part in (*body.turns, *wide.turns, *wide.steps))) + 2
    stride = columns + 2 * pad
    solid = np.pad(~free, pad, constant_values=True).ravel()
    holds = np.array([quarter(body.holds, k) for k in range(4)], dtype=np.int64).reshape(4, -1, 2)
    places = _places(rows, columns, pad, stride)
    push = np.zeros((4, 8, rows * columns), np.int32)
    for k in range(4):
        for d in range(8):
            size = SIDE if d % 2 == 0 else DIAGONAL
            seen = _clear(solid, places, _flat(quarter(body.steps[(d - 2 * k) % 8], k), stride))
            roomy = _clear(solid, places, _flat(quarter(wide.steps[(d - 2 * k) % 8], k), stride))
            push[k, d] = np.where(seen, np.where(roomy, size, size + TIGHT_PUSH), 0)
    lying = [_flat(quarter(body.lying, k), stride) for k in range(4)]
    lies = np.array([_clear(solid, places, offsets) for offsets in lying])
    utak = np.array([_clear(solid, places, _flat(_corner(dx, dy), stride)) for dx, dy in DIRECTIONS])
    image, image_first = _listed(lying)
    turns, turns_first = _listed([_flat(quarter(turn, k), stride) for turn in body.turns for k in range(4)])
    fat, fat_first = _listed([_flat(quarter(turn, k), stride) for turn in wide.turns for k in range(4)])
    frame = np.array([columns, rows, pad, stride], np.int64)
    walking = np.pad(walk, pad, constant_values=False).ravel()
    return Board(
        frame, solid, walking, holds, grip, push, utak, lies,
        image, image_first, turns, turns_first, fat, fat_first, allowed,
    )  # fmt: skip


def _corner(dx: int, dy: int) -> Ints:
    """The squares that must be free for Utak to take a step: his own and the next, both sides of a diagonal too."""
    return np.array(sorted({(0, 0), (dx, 0), (0, dy), (dx, dy)}), dtype=np.int64)


def _flat(offsets: Ints, stride: int) -> Ints:
    """Offsets (columns, rows) as offsets in the padded, flat array."""
    flat: Ints = offsets[:, 1] * stride + offsets[:, 0]
    return flat


def _places(rows: int, columns: int, pad: int, stride: int) -> Ints:
    """The padded index of each place."""
    row, column = np.divmod(np.arange(rows * columns), columns)
    return (row + pad) * stride + column + pad


def _listed(lists: list[Ints]) -> tuple[Ints, Ints]:
    """Lists one after another, and where each begins."""
    first = np.concatenate([[0], np.cumsum([len(each) for each in lists])]).astype(np.int64)
    return np.concatenate([np.empty(0, np.int64), *lists]), first


def _clear(solid: Mask, places: Ints, offsets: Ints) -> Mask:
    """At which places none of the offsets is solid: (places,)."""
    clear: Mask = _unmet(solid, places, offsets)
    return clear


@compiled
def _unmet(solid: Mask, places: Ints, offsets: Ints) -> Mask:
    clear = np.ones(len(places), np.bool_)
    for n in range(len(places)):
        for offset in offsets:
            if solid[places[n] + offset]:
                clear[n] = False
                break
    return clear


@compiled
def fits(board: Board, offsets: Ints, first: int, stop: int, place: int) -> bool:
    """Whether none of the listed offsets from a place is solid."""
    columns, pad, stride = board.frame[0], board.frame[2], board.frame[3]
    at = (place // columns + pad) * stride + place % columns + pad
    for n in range(first, stop):  # noqa: SIM110 (numba)
        if board.solid[at + offsets[n]]:
            return False
    return True


@compiled
def shifted(board: Board, place: int, dx: int, dy: int) -> int:
    """The place so many squares away, or -1 beyond the board."""
    columns, rows = board.frame[0], board.frame[1]
    x, y = place % columns + dx, place // columns + dy
    return int(y * columns + x) if 0 <= x < columns and 0 <= y < rows else -1


@compiled
def turned_place(board: Board, hold: int, quarters: int, place: int, way: int) -> int:
    """Where the body's centroid comes to in a quarter turn about a hold: way 1 counter-clockwise, -1 clockwise."""
    here, there = board.holds[quarters, hold], board.holds[(quarters + way) % 4, hold]
    return shifted(board, place, here[0] - there[0], here[1] - there[1])


@compiled
def turn_cost(board: Board, hold: int, quarters: int, place: int, way: int) -> int:
    """The cost of a quarter turn about a hold without the command itself, -1 when it is blocked."""
    after = turned_place(board, hold, quarters, place, way)
    if after < 0:
        return -1
    if way < 0:
        quarters, place = (quarters + 3) % 4, after
    at = hold * 4 + quarters
    if not fits(board, board.turns, board.turns_first[at], board.turns_first[at + 1], place):
        return -1
    return 0 if fits(board, board.wide, board.wide_first[at], board.wide_first[at + 1], place) else TIGHT_TURN
