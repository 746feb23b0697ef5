"""Connected components of a raster (by shared edges), and the rectangles that contain them.

Source: the two-pass labelling of Rosenfeld and Pfaltz (1966), with union-find.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from utak.geometry.kernels.arrays import Bools, Labels
from utak.geometry.kernels.jit import compiled


class Components(NamedTuple):
    """The 4-connected components of a mask: sets of True squares that hang together by shared edges."""

    # (rows, columns) int32; 0 outside the mask, 1..number inside: the number of the component of each square. They are
    # numbered by first square in raster order (row by row from row 0 in the south, each from the west).
    labels: Labels
    number: int  # number of components; 0 for an empty mask


def components(mask: Bools) -> Components:
    """Label the 4-connected components of a mask: sets of True squares that hang together by shared edges.

    Examples
    --------
    >>> components(np.array([[1, 0, 1], [1, 0, 1], [0, 1, 1]], bool)).labels.tolist()
    [[1, 0, 2], [1, 0, 2], [0, 2, 2]]
    """
    labels = np.zeros(mask.shape, np.int32)
    return Components(
        labels, int(_label_components(np.ascontiguousarray(mask), labels, np.empty(mask.size // 2 + 2, np.int32)))
    )


def with_edge_neighbours(mask: Bools) -> Bools:
    """Return a mask dilated by one square: all its squares, and those that share an edge with one."""
    edges = mask.copy()
    edges[1:] |= mask[:-1]
    edges[:-1] |= mask[1:]
    edges[:, 1:] |= mask[:, :-1]
    edges[:, :-1] |= mask[:, 1:]
    return edges


def bounding_boxes(labels: Labels, number: int) -> NDArray[np.int64]:
    """Return the bounding rectangle of each label.

    Examples
    --------
    >>> bounding_boxes(np.array([[1, 0, 2], [1, 2, 2]], np.int32), 2)[1:].tolist()
    [[0, 0, 1, 0], [0, 1, 1, 2]]
    """
    box_of = np.empty((number + 1, 4), np.int64)
    box_of[:] = (*labels.shape, -1, -1)
    _extend(np.ascontiguousarray(labels), box_of)
    return box_of


@compiled
def _label_components(mask: Bools, labels: Labels, parent: Labels) -> int:
    """Fill in the labels of a mask; return the number of components."""
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
                root = min(west, south)
                parent[west], parent[south] = root, root
                labels[row, column] = root
    parent[0] = 0
    number = 0
    for label in range(1, count + 1):  # a root has a smaller label than all its descendants
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
def _extend(labels: Labels, box_of: NDArray[np.int64]) -> None:
    """Extend the rectangle of each label over all its squares, in place."""
    rows, columns = labels.shape
    for row in range(rows):
        for column in range(columns):
            box = box_of[labels[row, column]]
            box[0], box[1] = min(box[0], row), min(box[1], column)
            box[2], box[3] = max(box[2], row), max(box[3], column)
