"""Which clearances a change of a few squares can alter.

# Strategy: a clearance can change only where the changed squares are not further off than the nearest wall was. About
one box of squares that part of the plane is star-shaped, so looking on in a direction may end at the first row without
any of it. And since neither of the two distances grows by more than the way between two cells, their difference says
how many cells can be skipped, and one cell of nine, with a margin, speaks for all.
"""

import numpy as np

from geometry.kernels.arrays import Ints, SquaredDistances
from geometry.kernels.jit import bare

TILE = 32  # changed squares in one tile of so many squares a side are taken together
STEP = 3  # rows and columns, the middle ones of which are looked at
MARGIN = (
    3.1  # squares; within a step aslant (2.83), or to half way between two such cells (3), no difference grows more
)


def boxes_of(cells: Ints, shape: tuple[int, ...]) -> Ints:
    """(n, 4) first and last row, first and last column of the boxes about changed cells, tile by tile."""
    rows, width = shape
    boxes = np.empty((len(cells), 4), np.int32)
    slot = np.full((rows // TILE + 1) * (width // TILE + 1), -1, np.int32)
    return boxes[: fill_boxes(cells, width, slot, boxes)]


@bare
def fill_boxes(cells: Ints, width: int, slot: Ints, boxes: Ints) -> int:
    """Fill the boxes; returns how many. ``slot`` has, per tile, the number of its box, -1 for none."""
    found = 0
    for k in range(cells.shape[0]):
        row, column = cells[k] // width, cells[k] % width
        tile = row // TILE * (width // TILE + 1) + column // TILE
        box = slot[tile]
        if box < 0:
            slot[tile] = box = found
            boxes[box, 0], boxes[box, 1], boxes[box, 2], boxes[box, 3] = row, row, column, column
            found += 1
        boxes[box, 0] = row if row < boxes[box, 0] else boxes[box, 0]
        boxes[box, 1] = row if row > boxes[box, 1] else boxes[box, 1]
        boxes[box, 2] = column if column < boxes[box, 2] else boxes[box, 2]
        boxes[box, 3] = column if column > boxes[box, 3] else boxes[box, 3]
    return found


@bare
def find_affected(square: SquaredDistances, boxes: Ints, bounds: Ints) -> None:
    """Fill the first two columns of ``bounds`` (rows, 2 or more), per row the first and last cell that may change."""
    last = square.shape[0] - 2
    for row in range(bounds.shape[0]):
        bounds[row, 0], bounds[row, 1] = square.shape[1], -1
    for k in range(boxes.shape[0]):
        row = boxes[k, 0] + 0
        while widen(square, boxes, k, row, bounds) and row > 1:
            row = row - STEP if row > STEP else 1
        row = boxes[k, 0] + 0
        while row < last:
            row = row + STEP if row + STEP < last else last
            if not widen(square, boxes, k, row, bounds) and row > boxes[k, 1]:
                break


@bare
def widen(square: SquaredDistances, boxes: Ints, k: int, row: int, bounds: Ints) -> bool:
    """Include the cells of a row and of the two beside it that a box may change; returns whether there may be any
    further off.
    """
    left, right = boxes[k, 2], boxes[k, 3]
    off = boxes[k, 0] - row if row < boxes[k, 0] else row - boxes[k, 1]
    tall = (2 * off - 1) ** 2 if off > 0 else 0
    first, last = square.shape[1], -1
    for side in range(2):
        column, step = (left, 1) if side == 0 else (left - 1, -1)
        while 0 < column < square.shape[1] - 1:
            gap = left - column if column < left else column - right
            here = square[row, column]
            if gap > 0 and here == 0:
                break  # what is further on is nearer to this wall
            far = tall + ((2 * gap - 1) ** 2 if gap > 0 else 0)
            spare = 0.5 * (np.sqrt(float(here)) - np.sqrt(float(far)))
            if spare >= -MARGIN:
                first = column if column < first else first
                last = column if column > last else last
            skip = int(0.5 * (abs(spare) - MARGIN))
            if skip <= STEP:
                skip = STEP
                if side == 0 and column < right:
                    skip = STEP if right - column > STEP else right - column  # the box is not stepped over
                elif square[row, column + step] == 0 or square[row, column + 2 * step] == 0:
                    break
            column += skip * step
    if last < 0:
        return False
    first = first - 1 if first > 1 else 1
    last = last + 1 if last < square.shape[1] - 2 else last
    for near in range(row - 1 if row > 1 else 1, row + 2 if row < square.shape[0] - 2 else square.shape[0] - 1):
        bounds[near, 0] = first if first < bounds[near, 0] else bounds[near, 0]
        bounds[near, 1] = last if last > bounds[near, 1] else bounds[near, 1]
    return True
