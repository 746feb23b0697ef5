"""The connected parts of a raster, and their moments.

A raster has occupied squares; a part is a set of them that edges join.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from utak.geometry.counts.gibbs import UNSEEN_SQUARE
from utak.geometry.kernels.jit import compiled


class Blobs(NamedTuple):
    """The n edge-connected occupied parts of a raster."""

    # (rows, columns) int32, 0 for none, k for the part at [k - 1] of the other arrays; numbered by first square, row by
    # row from row 0
    labels: NDArray[np.int32]
    area: NDArray[np.int64]  # (n,) int64, in squares
    outward: NDArray[np.int64]  # (n,) int64, number of sides of its squares beyond which nothing was seen
    # (n,) float64, sum of its principal moments (the second moments of its area, of squares with sides), divided by the
    # square of the area; no unit (a square has 1/6, a disc 1 / (2 pi))
    spread: NDArray[np.float64]
    # (n,) float64, the difference of the principal moments, divided by their sum; no unit (0: as wide as long, near 1:
    # a line)
    lengthy: NDArray[np.float64]


def blobs(image: NDArray[np.int8], ground: NDArray[np.int8]) -> Blobs:
    """Return the edge-connected occupied parts of one raster, in the order of their first squares, row by row.

    Examples
    --------
    >>> from utak.geometry.counts.gibbs import DRAWN
    >>> found = blobs(np.pad(np.ones((3, 3), np.int8), 2), np.full((7, 7), DRAWN, np.int8))
    >>> found.area.tolist(), found.outward.tolist(), (6 * found.spread).round(6).tolist(), found.lengthy.tolist()
    ([9], [0], [1.0], [0.0])
    """
    labels = np.zeros(image.shape, np.int32)
    sums = np.zeros((image.size // 2 + 2, 7))
    number = _label_parts(np.ascontiguousarray(image), np.ascontiguousarray(ground), labels, sums)
    n, x, y, xx, yy, xy, outward = sums[1 : number + 1].T
    east, north, cross = xx / n - (x / n) ** 2 + 1 / 12, yy / n - (y / n) ** 2 + 1 / 12, xy / n - x * y / n**2
    return Blobs(
        labels,
        n.astype(np.int64),
        outward.astype(np.int64),
        (east + north) / n,
        np.hypot(east - north, 2 * cross) / (east + north),
    )


@compiled
def _label_parts(image, ground, labels, sums) -> int:  # type: ignore[no-untyped-def]
    """Write the number of each square's edge-connected occupied part, sum up, and return how many there are."""
    rows, columns = image.shape
    stack = np.empty((rows * columns, 2), np.int64)
    number = 0
    for row in range(rows):
        for column in range(columns):
            if image[row, column] != 1 or labels[row, column] != 0:
                continue
            number += 1
            labels[row, column] = number
            stack[0, 0], stack[0, 1] = row, column
            size = 1
            while size > 0:
                size -= 1
                r, c = stack[size, 0], stack[size, 1]
                sums[number, 0] += 1
                sums[number, 1] += c
                sums[number, 2] += r
                sums[number, 3] += c * c
                sums[number, 4] += r * r
                sums[number, 5] += c * r
                for p, q in ((r + 1, c), (r - 1, c), (r, c + 1), (r, c - 1)):
                    if p < 0 or q < 0 or p >= rows or q >= columns or ground[p, q] == UNSEEN_SQUARE:
                        sums[number, 6] += 1
                    elif image[p, q] == 1 and labels[p, q] == 0:
                        labels[p, q] = number
                        stack[size, 0], stack[size, 1] = p, q
                        size += 1
    return number
