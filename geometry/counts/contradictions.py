"""How many squares and fields of several looks contradict each other, if each was received on a certain square."""

import math

import numpy as np
from numpy.typing import NDArray

from geometry.kernels.jit import compiled

SIGHT = 24  # squares that can be seen from a place, at any angle
FREE, FULL = 1, 2  # bits: what some field says of a square


@compiled
def contradicting(
    columns: NDArray[np.int32],
    rows: NDArray[np.int32],
    weight: NDArray[np.int16],
    slack: NDArray[np.int16],
    corners: NDArray[np.int64],
    ranges: NDArray[np.int16],
    apart: NDArray[np.float64],
) -> int:
    """The number of squares of which fields say both, and of fields that cannot be right by what others say.

    columns, rows, weight : (fields, most), the squares that fields sample, relative to that of the look. slack :
    (fields,) samples that count for nothing. corners : (looks, 2) x and y of the squares of the looks. ranges : (looks,
    fields, 2) least and greatest counts. apart : (n, 3) x, y and reach of discs in which looks need not agree.
    """
    west, south = corners[:, 0].min() - SIGHT, corners[:, 1].min() - SIGHT
    width = corners[:, 0].max() - west + SIGHT + 1
    said = np.zeros((corners[:, 1].max() - south + SIGHT + 1, width), np.uint8)
    fields, most = weight.shape
    total = np.zeros(fields, np.int64)
    for n in range(fields):
        for k in range(most):
            total[n] += weight[n, k]
    for look in range(len(corners)):
        x, y = corners[look, 0] - west, corners[look, 1] - south
        for n in range(fields):
            saying = 0
            if ranges[look, n, 0] - slack[n] >= total[n]:
                saying |= FULL
            if ranges[look, n, 1] == 0:
                saying |= FREE
            for k in range(most):
                if saying and weight[n, k] > 0:
                    said[y + rows[n, k], x + columns[n, k]] |= saying
    wrong = 0
    for y in range(said.shape[0]):
        for x in range(width):
            if said[y, x] and _within(apart, x + 0.5 + west, y + 0.5 + south):
                said[y, x] = 0
            wrong += said[y, x] == FREE | FULL
    for look in range(len(corners)):
        x, y = corners[look, 0] - west, corners[look, 1] - south
        for n in range(fields):
            surely, never = 0, 0
            for k in range(most):
                saying = said[y + rows[n, k], x + columns[n, k]]
                if saying & FULL:
                    surely += weight[n, k]
                elif saying:
                    never += weight[n, k]
            wrong += surely > ranges[look, n, 1] or total[n] - never < ranges[look, n, 0] - slack[n]
    return wrong


@compiled
def _within(apart: NDArray[np.float64], x: float, y: float) -> bool:
    """Does a point lie on one of some discs?"""
    found = False
    for n in range(len(apart)):
        found = found or math.hypot(x - apart[n, 0], y - apart[n, 1]) <= apart[n, 2]
    return found
