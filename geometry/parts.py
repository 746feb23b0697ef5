"""Parts of the floor: what remains connected when free space is cut along the necks of some passages."""

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from geometry.bones import Ints
from geometry.compiled import bare, compiled
from geometry.distance import Bools, Squares
from geometry.passages import Passage

Labels = NDArray[np.int32]
Points = NDArray[np.float64]


def find_parts(square: Squares, state: NDArray[np.uint8], passages: Iterable[Passage]) -> Labels:
    """(rows, columns) int: 0 blocked, else the number of the part, from 1 in the order of the parts' first squares.

    A part cut off between a wall and a neck, without any of the skeleton, belongs to the part across that neck.
    """
    return cut_floor(square, 1, state, passages)[0][1:-1, 1:-1]


def cut_floor(
    square: Squares, level: int, state: NDArray[np.uint8], passages: Iterable[Passage]
) -> tuple[Labels, Bools]:
    """Return the parts of the cells of at least that level, and the steps between cells that are cut.

    Returns
    -------
    label : (rows + 2, columns + 2) int, as ``find_parts`` numbers them.
    shut : (2, rows + 2, columns + 2) bool, the steps from each cell to the east (0) and to the north (1). Two cells
        have one label exactly when steps that are not shut lead from one to the other.
    """
    shut = np.zeros((2, *square.shape), np.bool_)
    for passage in passages:
        cut(shut, passage)
    label = np.zeros(square.shape, np.int32)
    count = number_parts(square >= level, shut, label, np.empty(square.size, np.int32))
    joined = np.arange(count + 1, dtype=np.int32)
    if count > 1:
        join_slivers(shut, label, np.bincount(label[state > 0], minlength=count + 1).astype(np.int32), joined)
    _, compact = np.unique(joined, return_inverse=True)
    return compact.astype(np.int32)[label], shut


def cut(shut: Bools, passage: Passage) -> None:
    """Mark the steps to the east (0) and to the north (1) that cross a passage's neck.

    The cut runs a little off its squares' centres.
    """
    (x, y), (u, v) = passage.place, passage.towards
    aside = 1e-4 * (u - x) - 3e-5 * (v - y), 1e-4 * (v - y) + 3e-5 * (u - x)
    mark_crossed(shut, np.array(passage.cut) + aside)


@compiled
def mark_crossed(shut: Bools, line: Points) -> None:
    """Mark the steps between centres of squares that a line crosses an odd number of times.

    line : (n, 2) points (x, y), each in a square next to that of the one before.
    """
    low_x = high_x = line[0, 0]
    low_y = high_y = line[0, 1]
    for k in range(1, len(line)):
        low_x, high_x = min(low_x, line[k, 0]), max(high_x, line[k, 0])
        low_y, high_y = min(low_y, line[k, 1]), max(high_y, line[k, 1])
    west, south = int(np.floor(low_x)) - 1, int(np.floor(low_y)) - 1
    wide, high = int(np.floor(high_x)) + 2 - west, int(np.floor(high_y)) + 2 - south
    odd = np.zeros((2, high, wide), np.bool_)
    for k in range(len(line) - 1):
        (ax, ay), (bx, by) = line[k], line[k + 1]
        for row in range(int(np.floor(min(ay, by))) - 1, int(np.floor(max(ay, by))) + 2):
            for column in range(int(np.floor(min(ax, bx))) - 1, int(np.floor(max(ax, bx))) + 2):
                x, y = column + 0.5, row + 0.5
                odd[0, row - south, column - west] ^= meets(ax, ay, bx, by, x, y, x + 1.0, y)
                odd[1, row - south, column - west] ^= meets(ax, ay, bx, by, x, y, x, y + 1.0)
    for row in range(max(south, 0), min(south + high, shut.shape[1] - 2)):
        for column in range(max(west, 0), min(west + wide, shut.shape[2] - 2)):
            for k in range(2):
                shut[k, row + 1, column + 1] |= odd[k, row - south, column - west]


@compiled
def meets(ax: float, ay: float, bx: float, by: float, px: float, py: float, qx: float, qy: float) -> bool:
    """Whether the segments a-b and p-q cross."""
    apart = (turn(ax, ay, bx, by, px, py) > 0) != (turn(ax, ay, bx, by, qx, qy) > 0)
    return apart and (turn(px, py, qx, qy, ax, ay) > 0) != (turn(px, py, qx, qy, bx, by) > 0)


@compiled
def turn(ax: float, ay: float, bx: float, by: float, cx: float, cy: float) -> float:
    """Positive when c lies left of the ray from a through b."""
    return (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)


@bare
def number_parts(free: Bools, shut: Bools, label: Labels, stack: Ints) -> int:
    """Number the parts of the padded free cells; returns how many there are."""
    width = free.shape[1]
    open_cells, labels = free.reshape(-1), label.reshape(-1)
    east, north = shut[0].reshape(-1), shut[1].reshape(-1)
    count = 0
    for seed in range(open_cells.shape[0]):
        if not open_cells[seed] or labels[seed] > 0:
            continue
        count += 1
        labels[seed] = count
        stack[0] = seed
        size = 1
        while size > 0:
            size -= 1
            cell = stack[size]
            for k in range(4):
                other = cell + (1 if k == 0 else width if k == 1 else -1 if k == 2 else -width)
                low = min(cell, other)
                closed = north[low] if k % 2 == 1 else east[low]
                if open_cells[other] and labels[other] == 0 and not closed:
                    labels[other] = count
                    stack[size] = other
                    size += 1
    return count


@bare
def join_slivers(shut: Bools, label: Labels, bones: Ints, joined: Ints) -> None:
    """Join each part without skeleton to the first part with some across a neck, by opening that step."""
    rows, width = label.shape
    for i in range(1, rows - 1):
        for j in range(1, width - 1):
            for k in range(2):
                if not shut[k, i, j]:
                    continue
                a, b = label[i, j], label[i + k, j + 1 - k]
                if a == 0 or b == 0:
                    continue
                if bones[a] == 0 and bones[b] > 0 and joined[a] == a:
                    joined[a], shut[k, i, j] = b, False
                elif bones[b] == 0 and bones[a] > 0 and joined[b] == b:
                    joined[b], shut[k, i, j] = a, False
