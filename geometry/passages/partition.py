"""Parts of the floor: what remains connected when free space is cut along the mouths of some passages."""

from collections.abc import Iterable

import numpy as np

from utak.geometry.kernels.arrays import Bools, Floats, Ints, Labels
from utak.geometry.kernels.jit import bare, compiled
from utak.geometry.passages.necks import Passage


def find_parts(free: Bools, passages: Iterable[Passage]) -> Labels:
    """Return the number of each square's part, from 1 in the order of the parts' first squares."""
    some = list(passages)
    label = cut_floor(np.pad(free, 1), some)
    rows, columns = free.shape  # passages of a larger floor may reach beyond
    squares = [(column, row) for passage in some for column, row in passage.between]
    gates = [(int(np.floor(x)), int(np.floor(y))) for passage in some for x, y in passage.gates]
    inner, outer = (
        {int(label[row + 1, column + 1]) for column, row in those if 0 <= column < columns and 0 <= row < rows}
        for those in (squares, gates)
    )
    kept = np.ones(int(label.max()) + 1, np.int32)
    kept[[0, *sorted(inner - outer)]] = 0
    numbers = np.cumsum(kept, dtype=np.int32) * kept
    answer: Labels = numbers[label[1:-1, 1:-1]]
    return answer


def cut_floor(floor: Bools, passages: Iterable[Passage]) -> Labels:
    """Return the pieces of a framed floor that is cut along all mouths of passages."""
    closed, whole = np.zeros((2, *floor.shape), np.bool_), floor.copy()
    for mouth in dict.fromkeys(mouth for passage in passages for mouth in passage.mouths):
        close_crossed_steps(closed, np.array(mouth))
        block_centres(whole, *mouth)
    barred = floor & ~whole
    closed[:, barred] = True
    closed[0, :, :-1] |= barred[:, 1:]
    closed[1, :-1] |= barred[1:]
    label = np.zeros(floor.shape, np.int32)
    number_parts(whole, closed, label, np.empty(floor.size, np.int32))
    return label


def block_centres(floor: Bools, a: tuple[float, float], b: tuple[float, float]) -> None:
    """Block the squares of a framed floor whose centres lie on a line a-b between corners of squares."""
    (ax, ay), (bx, by) = a, b
    west, south, east, north = (int(v) for v in (min(ax, bx), min(ay, by), max(ax, bx), max(ay, by)))
    rows, columns = np.mgrid[south:north, west:east]
    on = (bx - ax) * (rows + 0.5 - ay) == (by - ay) * (columns + 0.5 - ax)
    floor[rows[on] + 1, columns[on] + 1] = False


@compiled
def close_crossed_steps(closed: Bools, line: Floats) -> None:
    """Close the steps between centres of squares that a line crosses an odd number of times."""
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
                odd[0, row - south, column - west] ^= segments_cross(ax, ay, bx, by, x, y, x + 1.0, y)
                odd[1, row - south, column - west] ^= segments_cross(ax, ay, bx, by, x, y, x, y + 1.0)
    for row in range(max(south, 0), min(south + high, closed.shape[1] - 2)):
        for column in range(max(west, 0), min(west + wide, closed.shape[2] - 2)):
            for k in range(2):
                closed[k, row + 1, column + 1] |= odd[k, row - south, column - west]


@compiled
def segments_cross(ax: float, ay: float, bx: float, by: float, px: float, py: float, qx: float, qy: float) -> bool:
    """Return whether the segments a-b and p-q cross; an end that lies on the other's line counts as right of it."""
    apart = (orientation(ax, ay, bx, by, px, py) > 0) != (orientation(ax, ay, bx, by, qx, qy) > 0)
    return apart and (orientation(px, py, qx, qy, ax, ay) > 0) != (orientation(px, py, qx, qy, bx, by) > 0)


@compiled
def orientation(ax: float, ay: float, bx: float, by: float, cx: float, cy: float) -> float:
    """Return a positive number when c lies left of the ray from a through b, negative when right, 0 on its line."""
    return (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)


@bare
def number_parts(free: Bools, closed: Bools, label: Labels, stack: Ints) -> int:
    """Write the number of each padded free cell's part to `label`, from 1, and return how many parts there are."""
    width = free.shape[1]
    open_cells, labels = free.reshape(-1), label.reshape(-1)
    east, north = closed[0].reshape(-1), closed[1].reshape(-1)
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
                is_closed = north[low] if k % 2 == 1 else east[low]
                if open_cells[other] and labels[other] == 0 and not is_closed:
                    labels[other] = count
                    stack[size] = other
                    size += 1
    return count
