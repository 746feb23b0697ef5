"""Room for a round body beside the walls, exactly: what lies between the centres of squares."""

from math import ceil, hypot

import numpy as np

from geometry.kernels.arrays import XY, Floats, SquaredDistances

SLACK = 1e-9  # squares by which a body may be too near to a wall for rounding


def keeps_clear(square: SquaredDistances, start: XY, goal: XY, radius: float) -> bool:
    """Return whether a disc moved straight from one point to another of the same square keeps out of blocked squares.

    Parameters
    ----------
    square : (rows + 2, columns + 2) squared clearances in half squares, padded (see distance_transform.py).
    radius : of the disc, in squares.
    """
    row, column = int(start[1]) + 1, int(start[0]) + 1
    middle, height = (column - 0.5, row - 0.5), 0.5 * float(square[row, column]) ** 0.5
    if height - max(hypot(x - middle[0], y - middle[1]) for x, y in (start, goal)) >= radius:
        return True
    reach = ceil(radius) + 1
    low, first = max(row - reach, 0), max(column - reach, 0)
    window = square[low : row + reach + 1, first : column + reach + 1]
    rows, columns = np.nonzero(window == 0)
    corner = np.stack([columns + (first - 1.0), rows + (low - 1.0)], axis=1)
    return bool((distance_to_boxes(np.array(start), np.array(goal), corner) >= radius - SLACK).all())


def distance_to_boxes(p: Floats, q: Floats, corner: Floats) -> Floats:
    """Return the distances (n,) from a segment to unit squares that it does not cross.

    They are attained at an end of the segment or at a corner of a square. corner : (n, 2) their lower corners.
    """
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
