"""Exact clearance of a disc between the centres of squares, where the distance transform alone does not decide."""

from math import ceil, hypot

import numpy as np

from utak.geometry.kernels.arrays import XY, Floats, SquaredDistances

CLEARANCE_TOLERANCE = 1e-9  # squares: a disc may be this much too near to a wall; bounds rounding


def disc_stays_clear(square: SquaredDistances, start: XY, goal: XY, radius: float) -> bool:
    """Return whether a disc moved straight between two points of one square stays clear of blocked squares."""
    row, column = int(start[1]) + 1, int(start[0]) + 1
    centre, height = (column - 0.5, row - 0.5), 0.5 * float(square[row, column]) ** 0.5
    if height - max(hypot(x - centre[0], y - centre[1]) for x, y in (start, goal)) >= radius:
        return True
    margin = ceil(radius) + 1
    first_row, first_column = max(row - margin, 0), max(column - margin, 0)
    window = square[first_row : row + margin + 1, first_column : column + margin + 1]
    rows, columns = np.nonzero(window == 0)
    corner = np.stack([columns + (first_column - 1.0), rows + (first_row - 1.0)], axis=1)
    return bool((distance_to_boxes(np.array(start), np.array(goal), corner) >= radius - CLEARANCE_TOLERANCE).all())


def distance_to_boxes(p: Floats, q: Floats, corner: Floats) -> Floats:
    """Return the distances (n,) float64, in squares, from the segment p to q to unit squares that it does not cross."""
    ends = [np.hypot(*np.maximum(np.maximum(corner - end, end - corner - 1.0), 0.0).T) for end in (p, q)]
    along = q - p
    square = float(along @ along) or 1.0
    for x in (0.0, 1.0):
        for y in (0.0, 1.0):
            away = corner + np.array((x, y)) - p
            foot = np.clip(away @ along / square, 0.0, 1.0)
            ends.append(np.hypot(*(away - foot[:, None] * along).T))
    out: Floats = np.min(ends, axis=0)
    return out
