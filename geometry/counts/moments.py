"""The parts of a picture, and their moments.

A picture is a raster of which some squares are occupied; a part is what of them is joined by edges.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from geometry.counts.gibbs import UNSEEN
from geometry.kernels.jit import compiled


class Blobs(NamedTuple):
    """The edge-connected occupied parts of a picture.

    labels : (rows, columns) int32, 0 for none, n for the part at [n - 1] of the others. area : squares. outward : sides
    of its squares beyond which nothing was seen. spread : sum of its principal moments, by the square of the area (a
    square has 1/6, a disc 1/2 pi). lengthy : the difference of the principal moments, by their sum (0: as wide
    as long).
    """

    labels: NDArray[np.int32]
    area: NDArray[np.int64]
    outward: NDArray[np.int64]
    spread: NDArray[np.float64]
    lengthy: NDArray[np.float64]


def blobs(image: NDArray[np.int8], ground: NDArray[np.int8]) -> Blobs:
    """The parts of one picture.

    >>> from geometry.counts.gibbs import DRAWN
    >>> found = blobs(np.pad(np.ones((3, 3), np.int8), 2), np.full((7, 7), DRAWN, np.int8))
    >>> found.area.tolist(), found.outward.tolist(), (6 * found.spread).round(6).tolist(), found.lengthy.tolist()
    ([9], [0], [1.0], [0.0])
    """
    labels = np.zeros(image.shape, np.int32)
    sums = np.zeros((image.size // 2 + 2, 7))
    number = _parts(np.ascontiguousarray(image), np.ascontiguousarray(ground), labels, sums)
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
def _parts(image, ground, labels, sums):  # type: ignore[no-untyped-def]
    rows, columns = image.shape
    waiting = np.empty((rows * columns, 2), np.int64)
    number = 0
    for row in range(rows):
        for column in range(columns):
            if image[row, column] != 1 or labels[row, column] != 0:
                continue
            number += 1
            labels[row, column] = number
            waiting[0, 0], waiting[0, 1] = row, column
            left = 1
            while left > 0:
                left -= 1
                r, c = waiting[left, 0], waiting[left, 1]
                sums[number, 0] += 1
                sums[number, 1] += c
                sums[number, 2] += r
                sums[number, 3] += c * c
                sums[number, 4] += r * r
                sums[number, 5] += c * r
                for p, q in ((r + 1, c), (r - 1, c), (r, c + 1), (r, c - 1)):
                    if p < 0 or q < 0 or p >= rows or q >= columns or ground[p, q] == UNSEEN:
                        sums[number, 6] += 1
                    elif image[p, q] == 1 and labels[p, q] == 0:
                        labels[p, q] = number
                        waiting[left, 0], waiting[left, 1] = p, q
                        left += 1
    return number
