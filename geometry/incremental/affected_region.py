"""The cells whose clearance a change of a few squares can alter, as an interval of columns for each row.

# Strategy: a clearance can change only where the changed squares are no further away than the nearest wall was. For one
box of squares that part of the plane is star-shaped, so a scan in one direction may end at the first row without any of
it. Neither of the two distances grows by more than the distance between two cells. So their difference says how many
cells can be skipped, and one cell of nine, with a margin, stands for all nine.
"""

import numpy as np

from geometry.kernels.arrays import Ints, SquaredDistances
from geometry.kernels.jit import bare

CHANGE_TILE = 32  # squares a side: changed squares in one tile share a box (tuned by benchmarks.screens --only change)
SCAN_STEP = 3  # rows and columns in a block of cells of which the middle one is looked at
SCAN_MARGIN = 3.1
"""Squares by which no difference of distances grows further: within a diagonal step of SCAN_STEP (2.83), or to halfway
between two cells that are looked at (3); derived."""


def boxes_of(cells: Ints, shape: tuple[int, ...]) -> Ints:
    """Return the boxes around changed cells, one for each tile of 32 x 32 cells with such cells.

    Parameters
    ----------
    cells : (k,) int32
        Flat indices of changed cells in the padded screen.
    shape : (int, int)
        Padded shape of the screen.

    Returns
    -------
    (n, 4) int32
        First and last row, first and last column of each box, both included, padded; in the order in which ``cells``
        first meet the tiles.
    """
    rows, width = shape
    boxes = np.empty((len(cells), 4), np.int32)
    slot = np.full((rows // CHANGE_TILE + 1) * (width // CHANGE_TILE + 1), -1, np.int32)
    return boxes[: fill_boxes(cells, width, slot, boxes)]


@bare
def fill_boxes(cells: Ints, width: int, slot: Ints, boxes: Ints) -> int:
    """Fill the boxes around changed cells, one for each tile with such cells, and return their number.

    Flat indices are row * width + column in the screen padded by one blocked cell on each side.

    Parameters
    ----------
    cells : (k,) int32, flat indices of changed cells in the padded screen.
    width : width of the padded screen.
    slot : (tiles,) int32, all -1 at first; filled with the number of each tile's box, -1 for none.
    boxes : (k, 4) int32, filled from row 0 on: first and last row, first and last column, included, padded.
    """
    found = 0
    for k in range(cells.shape[0]):
        row, column = cells[k] // width, cells[k] % width
        tile = row // CHANGE_TILE * (width // CHANGE_TILE + 1) + column // CHANGE_TILE
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
    """Fill ``bounds`` with the first and last column of each row whose clearance may change.

    Parameters
    ----------
    square : (rows + 2, columns + 2) int16 or int32
        Squared clearances in squared half squares before the change.
    boxes : (n, 4) int32
        First and last row, first and last column of the boxes around changed cells, padded.
    bounds : (rows + 2, 2 or more) int32
        Filled, by padded rows, with the first and the last such column, included, padded. Where none may change the
        first is the width of the padded screen and the last -1.
    """
    last = square.shape[0] - 2
    for row in range(bounds.shape[0]):
        bounds[row, 0], bounds[row, 1] = square.shape[1], -1
    for k in range(boxes.shape[0]):
        row = boxes[k, 0] + 0
        while widen(square, boxes, k, row, bounds) and row > 1:
            row = row - SCAN_STEP if row > SCAN_STEP else 1
        row = boxes[k, 0] + 0
        while row < last:
            row = row + SCAN_STEP if row + SCAN_STEP < last else last
            if not widen(square, boxes, k, row, bounds) and row > boxes[k, 1]:
                break


@bare
def widen(square: SquaredDistances, boxes: Ints, k: int, row: int, bounds: Ints) -> bool:
    """Widen the bounds of a row and of the rows next to it by the cells whose clearance the k-th box may change.

    Returns False when there are none in this row, and so none in rows further from the box; else True.

    Parameters
    ----------
    square : (rows + 2, columns + 2) int16 or int32
        Squared clearances in squared half squares before the change.
    boxes : (n, 4) int32
        First and last row, first and last column of each box, padded.
    k, row : int
        Number of the box, and the padded row that is looked at.
    bounds : (rows + 2, 2 or more) int32
        First and last column of each row, padded; changed.
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
            if spare >= -SCAN_MARGIN:
                first = column if column < first else first
                last = column if column > last else last
            skip = int(0.5 * (abs(spare) - SCAN_MARGIN))
            if skip <= SCAN_STEP:
                skip = SCAN_STEP
                if side == 0 and column < right:
                    skip = SCAN_STEP if right - column > SCAN_STEP else right - column  # the box is not stepped over
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
