"""Misfit: how badly a shape laid over a digital image agrees with it. Plain loops for numba.

A shape is a class (its row in geometry.shapes.classes) and seven numbers, in squares of the image and radians
counter-clockwise. Of a union of rectangles: angle, centre x and y of the rectangle that holds the shape, its width,
its height, the thickness, and that of the stem where it differs, else 0. Of a triangle: three corners x, y. Of a disc:
centre x and y, radius.

An image is an array of IMAGE_OCCUPIED, IMAGE_FREE and IMAGE_UNKNOWN squares, with row 0 in the south. A shape and a
square overlap when no line separates them: their gap is the widest such separation, negative when there is none. Every
class is a union of convex pieces, so the gap to a shape is the least of the gaps to its pieces.
"""

import math

import numpy as np
import numpy.typing as npt

from utak.geometry.kernels.arrays import Floats
from utak.geometry.kernels.jit import compiled
from utak.geometry.shapes.classes import CLASSES, DISC, TRIANGLE

Image = npt.NDArray[np.int8]
IMAGE_FREE, IMAGE_OCCUPIED, IMAGE_UNKNOWN = 0, 1, 2  # states of a square of an image
PARAMETER_COUNT = 7  # numbers of a shape, of whatever class
AGREEMENT_MARGIN = 0.02  # squares; a gap with the right sign still costs below this; chosen
MIN_FEATURE = 0.7  # squares; convention: arms, gaps and notches of a proper shape are at least so long

# The table of classes as arrays, a row a class.
FORM = np.array([one.form for one in CLASSES])
MIN_RATIO = np.array([one.min_ratio for one in CLASSES])
PIECE_COUNT = np.array([len(one.pieces) for one in CLASSES])
PIECES = np.zeros((len(CLASSES), PIECE_COUNT.max(), 4, 4))
FEATURE_COUNT = np.array([len(one.features) for one in CLASSES])
FEATURES = np.zeros((len(CLASSES), FEATURE_COUNT.max(), 4))
for _kind, _one in enumerate(CLASSES):
    PIECES[_kind, : len(_one.pieces)] = np.reshape(_one.pieces, (-1, 4, 4))
    FEATURES[_kind, : len(_one.features)] = np.reshape(_one.features, (-1, 4))


@compiled
def disagreement(kind: int, shape: Floats, image: Image) -> float:
    """Return how far a shape would have to move for every known square to agree: the sum of all wrong gaps."""
    loss = 10.0 * class_violation(kind, shape)
    pieces = convex_pieces(kind, shape)
    for row in range(image.shape[0]):
        for column in range(image.shape[1]):
            if image[row, column] == IMAGE_UNKNOWN:
                continue
            gap = gap_to_square(pieces, column + 0.5, row + 0.5)
            if image[row, column] == IMAGE_OCCUPIED:
                loss += max(0.0, gap + AGREEMENT_MARGIN)
            else:
                loss += max(0.0, AGREEMENT_MARGIN - gap)
    return float(loss)


@compiled
def count_wrong_squares(kind: int, shape: Floats, image: Image, most: float = math.inf) -> int:
    """Return the number of known squares that a shape gets wrong, or some number not below `most`."""
    wrong: int = 0
    pieces = convex_pieces(kind, shape)
    for row in range(image.shape[0]):
        for column in range(image.shape[1]):
            if image[row, column] != IMAGE_UNKNOWN:
                covered = gap_to_square(pieces, column + 0.5, row + 0.5) < -1e-9
                wrong += covered != (image[row, column] == IMAGE_OCCUPIED)
        if wrong >= most:
            break
    return wrong


@compiled
def class_violation(kind: int, shape: Floats) -> float:
    """Return by how much a shape fails to be a proper one of its class, in squares; 0 for a proper shape."""
    if FORM[kind] == DISC:
        return float(max(0.0, MIN_FEATURE - shape[2]))
    if FORM[kind] == TRIANGLE:
        return max(0.0, MIN_FEATURE - _smallest_height(shape))
    bad = 0.0
    for k in range(FEATURE_COUNT[kind]):
        bad += max(0.0, MIN_FEATURE - length(FEATURES[kind, k], shape))
    if MIN_RATIO[kind] > 0.0:
        bad += max(0.0, MIN_RATIO[kind] * min(shape[3], shape[4]) - max(shape[3], shape[4]))
    return float(bad)


@compiled
def length(size: Floats, shape: Floats) -> float:
    """Return a length that the table of classes gives by its coefficients, in squares."""
    stem = shape[6] if shape[6] != 0.0 else shape[5]
    return float(size[0] * shape[3] + size[1] * shape[4] + size[2] * shape[5] + size[3] * stem)


@compiled
def _smallest_height(shape: Floats) -> float:
    """Return the least of a triangle's three heights, in squares."""
    area = (shape[2] - shape[0]) * (shape[5] - shape[1]) - (shape[3] - shape[1]) * (shape[4] - shape[0])
    longest = 1e-9
    for k in range(3):
        n = (k + 1) % 3
        longest = max(longest, math.hypot(shape[2 * n] - shape[2 * k], shape[2 * n + 1] - shape[2 * k + 1]))
    return float(abs(area) / longest)


@compiled
def convex_pieces(kind: int, shape: Floats) -> Floats:
    """Return a shape's convex pieces as separating lines (n, 3): rows (normal x, y, offset), eight a piece."""
    if FORM[kind] == DISC:
        return shape[:3].copy().reshape(1, 3)
    if FORM[kind] == TRIANGLE:
        return _triangle_lines(shape)
    lines = np.empty((8 * PIECE_COUNT[kind], 3))
    for k in range(PIECE_COUNT[kind]):
        west, south = length(PIECES[kind, k, 0], shape), length(PIECES[kind, k, 1], shape)
        east, north = length(PIECES[kind, k, 2], shape), length(PIECES[kind, k, 3], shape)
        _rectangle_lines(shape, west, south, east, north, lines, 8 * k)
    return lines


@compiled
def _rectangle_lines(
    shape: Floats, west: float, south: float, east: float, north: float, lines: Floats, first: int
) -> None:
    """Write the eight lines of a rectangle given in the shape's own frame: its four sides, then its bounding box."""
    c, s = math.cos(shape[0]), math.sin(shape[0])
    u, v = (west + east) / 2, (south + north) / 2
    x, y = shape[1] + c * u - s * v, shape[2] + s * u + c * v
    half_u, half_v = (east - west) / 2, (north - south) / 2
    square = (abs(c) + abs(s)) / 2
    _two_lines(lines, first, c, s, x, y, half_u + square)
    _two_lines(lines, first + 2, -s, c, x, y, half_v + square)
    _two_lines(lines, first + 4, 1.0, 0.0, x, y, half_u * abs(c) + half_v * abs(s) + 0.5)
    _two_lines(lines, first + 6, 0.0, 1.0, x, y, half_u * abs(s) + half_v * abs(c) + 0.5)


@compiled
def _two_lines(lines: Floats, row: int, nx: float, ny: float, x: float, y: float, half: float) -> None:
    """Write the two lines across a normal at distance `half` from a centre to rows `row` and `row` + 1 of `lines`."""
    middle = nx * x + ny * y
    lines[row, 0], lines[row, 1], lines[row, 2] = nx, ny, middle + half
    lines[row + 1, 0], lines[row + 1, 1], lines[row + 1, 2] = -nx, -ny, half - middle


@compiled
def _triangle_lines(shape: Floats) -> Floats:
    """Return the lines of a triangle: three sides, its bounding box, and one more that never separates."""
    lines = np.zeros((8, 3))
    area = (shape[2] - shape[0]) * (shape[5] - shape[1]) - (shape[3] - shape[1]) * (shape[4] - shape[0])
    sign = 1.0 if area >= 0 else -1.0
    for k in range(3):
        n = (k + 1) % 3
        dx, dy = shape[2 * n] - shape[2 * k], shape[2 * n + 1] - shape[2 * k + 1]
        length = max(math.hypot(dx, dy), 1e-9)
        nx, ny = sign * dy / length, -sign * dx / length
        lines[k, 0], lines[k, 1] = nx, ny
        lines[k, 2] = nx * shape[2 * k] + ny * shape[2 * k + 1] + (abs(nx) + abs(ny)) / 2
    x0, x1 = min(shape[0], shape[2], shape[4]), max(shape[0], shape[2], shape[4])
    y0, y1 = min(shape[1], shape[3], shape[5]), max(shape[1], shape[3], shape[5])
    _two_lines(lines, 3, 1.0, 0.0, (x0 + x1) / 2, 0.0, (x1 - x0) / 2 + 0.5)
    _two_lines(lines, 5, 0.0, 1.0, 0.0, (y0 + y1) / 2, (y1 - y0) / 2 + 0.5)
    lines[7, 2] = 1e9
    return lines


@compiled
def gap_to_square(pieces: Floats, x: float, y: float) -> float:
    """Return the gap in squares between the square centred at (x, y) and a shape's pieces; negative if they overlap."""
    if len(pieces) == 1:  # a disc
        dx = max(abs(x - pieces[0, 0]) - 0.5, 0.0)
        dy = max(abs(y - pieces[0, 1]) - 0.5, 0.0)
        return float(math.hypot(dx, dy) - pieces[0, 2])
    least = 1e9
    for first in range(0, len(pieces), 8):
        gap = -1e9
        for k in range(first, first + 8):
            gap = max(gap, pieces[k, 0] * x + pieces[k, 1] * y - pieces[k, 2])
            if gap >= least:
                break
        least = min(least, gap)
    return least


@compiled
def descend(kind: int, shape: Floats, free: Floats, image: Image, steps: int) -> float:
    """Move a shape, in place, to the least disagreement nearby, and return its disagreement there (in squares)."""
    simplex = np.empty((PARAMETER_COUNT + 1, PARAMETER_COUNT))
    losses = np.empty(PARAMETER_COUNT + 1)
    middle, trial, further = np.empty(PARAMETER_COUNT), np.empty(PARAMETER_COUNT), np.empty(PARAMETER_COUNT)
    _combine(1.0, shape, 0.0, shape, simplex[0])
    n = 0
    for k in range(PARAMETER_COUNT):
        if free[k] > 0.0:
            n += 1
            _combine(1.0, shape, 0.0, shape, simplex[n])
            simplex[n, k] += free[k]
    for k in range(n + 1):
        losses[k] = disagreement(kind, simplex[k], image)
    low = 0
    for _ in range(steps):
        low, height, second = _extremes(losses, n + 1)
        if losses[low] <= 0.0 or losses[height] - losses[low] < 1e-4:
            break
        for m in range(PARAMETER_COUNT):
            middle[m] = 0.0
            for k in range(n + 1):
                if k != height:
                    middle[m] += simplex[k, m] / n
        _combine(2.0, middle, -1.0, simplex[height], trial)
        loss = disagreement(kind, trial, image)
        if loss < losses[low]:
            _combine(3.0, middle, -2.0, simplex[height], further)
            other = disagreement(kind, further, image)
            if other < loss:
                trial, further, loss = further, trial, other
        elif loss >= losses[second]:
            _combine(0.5, middle, 0.5, trial if loss < losses[height] else simplex[height], further)
            other = disagreement(kind, further, image)
            if other < min(loss, losses[height]):
                trial, further, loss = further, trial, other
            else:
                for k in range(n + 1):
                    if k != low:
                        _combine(0.5, simplex[k], 0.5, simplex[low], simplex[k])
                        losses[k] = disagreement(kind, simplex[k], image)
                continue
        _combine(1.0, trial, 0.0, trial, simplex[height])
        losses[height] = loss
    low, height, second = _extremes(losses, n + 1)
    _combine(1.0, simplex[low], 0.0, shape, shape)
    return float(losses[low])


@compiled
def _combine(p: float, one: Floats, q: float, other: Floats, out: Floats) -> None:
    """Write p one + q other to `out`, which may be one of them; all three (PARAMETER_COUNT,)."""
    for k in range(PARAMETER_COUNT):
        out[k] = p * one[k] + q * other[k]


@compiled
def _extremes(losses: Floats, n: int) -> tuple[int, int, int]:
    """Return the indices of the least, the greatest and the second greatest of the first n numbers of `losses`."""
    low, height = 0, 0
    for k in range(1, n):
        if losses[k] < losses[low]:
            low = k
        if losses[k] >= losses[height]:
            height = k
    second = 1 if height == 0 else 0
    for k in range(n):
        if k != height and losses[k] >= losses[second]:
            second = k
    return low, height, second
