"""Contradictions among several observations, if each was received on a certain square."""

import math

import numpy as np
from numpy.typing import NDArray

from utak.geometry.kernels.jit import compiled

SIGHT_RADIUS = 24  # squares; how far can be seen from a place, at any angle of the frame
SAID_FREE, SAID_OCCUPIED = 1, 2  # bits: what some field says of a square


@compiled
def total_contradictions(
    columns: NDArray[np.int32],
    rows: NDArray[np.int32],
    weight: NDArray[np.int16],
    slack: NDArray[np.int16],
    corners: NDArray[np.int64],
    ranges: NDArray[np.int16],
    exempt: NDArray[np.float64],
) -> int:
    """Return the number of contradictions: squares said to be both free and occupied, and fields that others refute."""
    west, south = corners[:, 0].min() - SIGHT_RADIUS, corners[:, 1].min() - SIGHT_RADIUS
    width = corners[:, 0].max() - west + SIGHT_RADIUS + 1
    statements = np.zeros((corners[:, 1].max() - south + SIGHT_RADIUS + 1, width), np.uint8)
    fields, entries = weight.shape
    total = np.zeros(fields, np.int64)
    for n in range(fields):
        for k in range(entries):
            total[n] += weight[n, k]
    for observation in range(len(corners)):
        x, y = corners[observation, 0] - west, corners[observation, 1] - south
        for n in range(fields):
            statement = 0
            if ranges[observation, n, 0] - slack[n] >= total[n]:
                statement |= SAID_OCCUPIED
            if ranges[observation, n, 1] == 0:
                statement |= SAID_FREE
            for k in range(entries):
                if statement and weight[n, k] > 0:
                    statements[y + rows[n, k], x + columns[n, k]] |= statement
    for n in range(len(exempt)):
        _withdraw(statements, exempt[n, 0] - west, exempt[n, 1] - south, exempt[n, 2])
    wrong = 0
    for y in range(statements.shape[0]):
        for x in range(width):
            wrong += statements[y, x] == SAID_FREE | SAID_OCCUPIED
    for observation in range(len(corners)):
        x, y = corners[observation, 0] - west, corners[observation, 1] - south
        for n in range(fields):
            occupied, free = 0, 0
            for k in range(entries):
                statement = statements[y + rows[n, k], x + columns[n, k]]
                if statement & SAID_OCCUPIED:
                    occupied += weight[n, k]
                elif statement:
                    free += weight[n, k]
            wrong += occupied > ranges[observation, n, 1] or total[n] - free < ranges[observation, n, 0] - slack[n]
    return wrong


@compiled
def _withdraw(statements: NDArray[np.uint8], x: float, y: float, reach: float) -> None:
    """Withdraw in place what is said of the squares whose middles lie on a disc; its edge belongs to it."""
    for row in range(max(math.floor(y - reach), 0), min(math.floor(y + reach) + 1, statements.shape[0])):
        for column in range(max(math.floor(x - reach), 0), min(math.floor(x + reach) + 1, statements.shape[1])):
            if math.hypot(column + 0.5 - x, row + 0.5 - y) <= reach:
                statements[row, column] = 0
