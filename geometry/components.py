"""Connected components of a raster, by maximal runs along rows joined where they overlap (edge adjacency).

Source: the run-based two-pass labelling of Rosenfeld and Pfaltz (1966), with union-find over runs in place of squares.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


class Components(NamedTuple):
    """labels: (rows, columns) int32, 0 outside the mask, 1..number inside, by first square in raster order."""

    labels: NDArray[np.int32]
    number: int


def components(mask: NDArray[np.bool_]) -> Components:
    """Label the 4-connected components of a (rows, columns) mask.

    >>> components(np.array([[1, 0, 1], [1, 0, 1], [0, 1, 1]], bool)).labels.tolist()
    [[1, 0, 2], [1, 0, 2], [0, 2, 2]]
    """
    rows, columns = mask.shape
    if not mask.any():
        return Components(np.zeros(mask.shape, np.int32), 0)
    row, start, stop = _runs(mask)
    root = np.arange(len(row))
    for a, b in zip(*_overlaps(row, start, stop), strict=True):
        p, q = _find(root, a), _find(root, b)
        root[max(p, q)] = min(p, q)
    roots = np.array([_find(root, run) for run in range(len(root))])
    names, number = np.unique(roots, return_inverse=True)
    steps = np.zeros(rows * (columns + 1) + 1, np.int32)
    np.add.at(steps, row * (columns + 1) + start, number + 1)
    np.add.at(steps, row * (columns + 1) + stop, -(number + 1))
    labels = np.cumsum(steps[:-1]).reshape(rows, columns + 1)[:, :columns]
    return Components(np.ascontiguousarray(labels.astype(np.int32)), len(names))


def _runs(mask: NDArray[np.bool_]) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]:
    """Row, first column and column behind the last of every maximal run, in raster order."""
    edges = np.diff(np.pad(mask, ((0, 0), (1, 1))).astype(np.int8), axis=1)
    row, start = np.nonzero(edges == 1)
    return row, start, np.nonzero(edges == -1)[1]


def _overlaps(row: NDArray[np.int64], start: NDArray[np.int64], stop: NDArray[np.int64]) -> tuple[list[int], list[int]]:
    """Pairs of runs of neighbouring rows that share a column."""
    width = int(stop.max()) + 2
    first = np.searchsorted(row * width + stop, (row - 1) * width + start, side="right")
    last = np.searchsorted(row * width + start, (row - 1) * width + stop, side="left")
    number = np.maximum(last - first, 0)
    upper = np.repeat(np.arange(len(row)), number)
    within = np.arange(int(number.sum())) - np.repeat(np.cumsum(number) - number, number)
    return upper.tolist(), (np.repeat(first, number) + within).tolist()


def _find(root: NDArray[np.int64], run: int) -> int:
    while root[run] != run:
        root[run] = root[root[run]]
        run = int(root[run])
    return run
