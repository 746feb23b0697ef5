"""Connected components of a raster (edge adjacency), and the rectangles that contain them.

Source: the two-pass labelling of Rosenfeld and Pfaltz (1966), with union-find.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from geometry.kernels.arrays import Bools, Labels
from geometry.kernels.jit import compiled


class Components(NamedTuple):
    """labels: (rows, columns) int32, 0 outside the mask, 1..number inside, by first square in raster order."""

    labels: Labels
    number: int


def components(mask: Bools) -> Components:
    """Label the 4-connected components of a (rows, columns) mask.

    >>> components(np.array([[1, 0, 1], [1, 0, 1], [0, 1, 1]], bool)).labels.tolist()
    [[1, 0, 2], [1, 0, 2], [0, 2, 2]]
    """
    labels = np.zeros(mask.shape, np.int32)
    return Components(labels, int(_label(np.ascontiguousarray(mask), labels, np.empty(mask.size // 2 + 2, np.int32))))


def edged(mask: Bools) -> Bools:
    """A mask, and all squares that share an edge with one of it."""
    edges = mask.copy()
    edges[1:] |= mask[:-1]
    edges[:-1] |= mask[1:]
    edges[:, 1:] |= mask[:, :-1]
    edges[:, :-1] |= mask[:, 1:]
    return edges


def boxes(labels: Labels, number: int) -> NDArray[np.int64]:
    """(number + 1, 4) by label: its first row, first column, last row and last column; -1 as last ones of no square.

    >>> boxes(np.array([[1, 0, 2], [1, 2, 2]], np.int32), 2)[1:].tolist()
    [[0, 0, 1, 0], [0, 1, 1, 2]]
    """
    found = np.empty((number + 1, 4), np.int64)
    found[:] = (*labels.shape, -1, -1)
    _enclose(np.ascontiguousarray(labels), found)
    return found


@compiled
def _label(mask: Bools, labels: Labels, parent: Labels) -> int:
    """Fill in the labels; returns how many there are."""
    rows, columns = mask.shape
    count = 0
    for row in range(rows):
        for column in range(columns):
            if not mask[row, column]:
                continue
            west = labels[row, column - 1] if column > 0 else 0
            south = labels[row - 1, column] if row > 0 else 0
            if west == 0 and south == 0:
                count += 1
                parent[count] = count
                labels[row, column] = count
            elif west == 0 or south == 0 or west == south:
                labels[row, column] = max(west, south)
            else:
                while parent[west] != west:
                    west = parent[west]
                while parent[south] != south:
                    parent[south] = parent[parent[south]]
                    south = parent[south]
                least = min(west, south)
                parent[west], parent[south] = least, least
                labels[row, column] = least
    parent[0] = 0
    number = 0
    for label in range(1, count + 1):  # a root comes before all that hang on it
        if parent[label] == label:
            number += 1
            parent[label] = number
        else:
            parent[label] = parent[parent[label]]
    for row in range(rows):
        for column in range(columns):
            labels[row, column] = parent[labels[row, column]]
    return number


@compiled
def _enclose(labels: Labels, found: NDArray[np.int64]) -> None:
    rows, columns = labels.shape
    for row in range(rows):
        for column in range(columns):
            box = found[labels[row, column]]
            box[0], box[1] = min(box[0], row), min(box[1], column)
            box[2], box[3] = max(box[2], row), max(box[3], column)
