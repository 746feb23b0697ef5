"""How badly a shape laid over a digital image agrees with it. Plain loops for numba.

A shape is a class and seven numbers. SQUARE, BRICK, ELL, TEE and HORSESHOE: radians turned, centre x and y of the
rectangle that holds it, its width, its height, its thickness, and of an ELL the thickness of its stem where that is
another one, else 0. TRIANGLE: three corners x, y. DISC: centre x and y, radius.

An image is an array of WANTED, UNWANTED and UNKNOWN squares. A shape and a square overlap when no line separates them:
their gap is the widest such separation, negative when there is none. Every class is a union of convex pieces, so the
gap to a shape is the least of the gaps to its pieces.
"""

import math

import numpy as np
import numpy.typing as npt

from geometry.kernels.arrays import Floats
from geometry.kernels.jit import compiled

Image = npt.NDArray[np.int8]
UNWANTED, WANTED, UNKNOWN = 0, 1, 2
SQUARE, BRICK, ELL, TEE, HORSESHOE, TRIANGLE, DISC = 0, 1, 2, 3, 4, 5, 6
MARGIN = 0.02  # squares: agreement by less than this still costs
NUMBERS = 7  # of a shape
LEAST = 0.7  # squares: arms, gaps and notches are at least so long
OBLONG = 1.15  # a brick is at least so much longer than wide


@compiled
def disagreement(kind: int, shape: Floats, image: Image) -> float:
    """How much a shape would have to move for every known square to agree: the sum of all wrong gaps, 0 at best."""
    loss = 10.0 * impropriety(kind, shape)
    pieces = convex_pieces(kind, shape)
    for row in range(image.shape[0]):
        for column in range(image.shape[1]):
            if image[row, column] == UNKNOWN:
                continue
            gap = gap_to(pieces, column + 0.5, row + 0.5)
            if image[row, column] == WANTED:
                loss += max(0.0, gap + MARGIN)
            else:
                loss += max(0.0, MARGIN - gap)
    return float(loss)


@compiled
def misfit(kind: int, shape: Floats, image: Image, most: float = math.inf) -> int:
    """The number of known squares that a shape gets wrong, or one that is not below `most`.

    Touching is not overlapping.
    """
    wrong: int = 0
    pieces = convex_pieces(kind, shape)
    for row in range(image.shape[0]):
        for column in range(image.shape[1]):
            if image[row, column] != UNKNOWN:
                covered = gap_to(pieces, column + 0.5, row + 0.5) < -1e-9
                wrong += covered != (image[row, column] == WANTED)
        if wrong >= most:
            break
    return wrong


@compiled
def impropriety(kind: int, shape: Floats) -> float:
    """By how much a shape fails to be a proper one of its class."""
    if kind == DISC:
        return float(max(0.0, LEAST - shape[2]))
    if kind == TRIANGLE:
        return max(0.0, LEAST - _least_height(shape))
    wide, high, thick = shape[3], shape[4], shape[5]
    stem = stem_of(shape)
    bad = max(0.0, LEAST - wide)
    if kind >= BRICK:
        bad += max(0.0, LEAST - high)
    if kind == BRICK:
        bad += max(0.0, OBLONG * min(wide, high) - max(wide, high))
    if kind >= ELL:
        across = stem if kind == ELL else 2 * thick if kind == HORSESHOE else thick + LEAST
        bad += max(0.0, LEAST - thick) + max(0.0, thick + LEAST - high) + max(0.0, across + LEAST - wide)
        bad += max(0.0, LEAST - stem)
    return float(bad)


@compiled
def stem_of(shape: Floats) -> float:
    """How thick the stem of a shape is: as its other arms, but for an ELL with arms of two widths."""
    return float(shape[6] if shape[6] != 0.0 else shape[5])


@compiled
def _least_height(shape: Floats) -> float:
    """The least of a triangle's three heights."""
    area = (shape[2] - shape[0]) * (shape[5] - shape[1]) - (shape[3] - shape[1]) * (shape[4] - shape[0])
    longest = 1e-9
    for k in range(3):
        n = (k + 1) % 3
        longest = max(longest, math.hypot(shape[2 * n] - shape[2 * k], shape[2 * n + 1] - shape[2 * k + 1]))
    return float(abs(area) / longest)


@compiled
def convex_pieces(kind: int, shape: Floats) -> Floats:
    """A shape's convex pieces as separating lines: rows (normal x, y, offset), six a piece.

    A square with its centre at p is apart from a piece by at least normal . p - offset, for each of its rows.
    """
    if kind == DISC:
        return shape[:3].copy().reshape(1, 3)
    if kind == TRIANGLE:
        return _triangle_lines(shape)
    wide, high, thick = shape[3], shape[4], shape[5]
    high = wide if kind == SQUARE else high
    west, south, east, north = -wide / 2, -high / 2, wide / 2, high / 2
    if kind <= BRICK:
        lines = np.empty((8, 3))
    elif kind <= TEE:
        lines = np.empty((16, 3))
    else:
        lines = np.empty((24, 3))
    if kind <= BRICK:
        _rectangle_lines(shape, west, south, east, north, lines, 0)
        return lines
    _rectangle_lines(shape, west, south, east, south + thick, lines, 0)
    if kind == TEE:
        _rectangle_lines(shape, -thick / 2, south, thick / 2, north, lines, 8)
        return lines
    stem = stem_of(shape)
    _rectangle_lines(shape, west, south, west + stem, north, lines, 8)
    if kind == HORSESHOE:
        _rectangle_lines(shape, east - thick, south, east, north, lines, 16)
    return lines


@compiled
def _rectangle_lines(
    shape: Floats, west: float, south: float, east: float, north: float, lines: Floats, first: int
) -> None:
    """The eight lines of a turned rectangle given in the shape's own frame: its four sides, then its bounding box."""
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
    """The two lines across a normal at a distance from a centre."""
    middle = nx * x + ny * y
    lines[row, 0], lines[row, 1], lines[row, 2] = nx, ny, middle + half
    lines[row + 1, 0], lines[row + 1, 1], lines[row + 1, 2] = -nx, -ny, half - middle


@compiled
def _triangle_lines(shape: Floats) -> Floats:
    """The lines of a triangle: three sides, its bounding box, and one more that never separates."""
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
def gap_to(pieces: Floats, x: float, y: float) -> float:
    """The gap between the square centred at (x, y) and a shape; negative when they overlap."""
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
def settle(kind: int, shape: Floats, free: Floats, image: Image, steps: int) -> float:
    """Move a shape to where it disagrees least nearby, in place (Nelder and Mead 1965); its disagreement there.

    free: how far each of the numbers is moved at first; 0 for those that stay.
    """
    simplex = np.empty((NUMBERS + 1, NUMBERS))
    losses = np.empty(NUMBERS + 1)
    middle, trial, further = np.empty(NUMBERS), np.empty(NUMBERS), np.empty(NUMBERS)
    _mix(1.0, shape, 0.0, shape, simplex[0])
    n = 0
    for k in range(NUMBERS):
        if free[k] > 0.0:
            n += 1
            _mix(1.0, shape, 0.0, shape, simplex[n])
            simplex[n, k] += free[k]
    for k in range(n + 1):
        losses[k] = disagreement(kind, simplex[k], image)
    low = 0
    for _ in range(steps):
        low, high, second = _ends(losses, n + 1)
        if losses[low] <= 0.0 or losses[high] - losses[low] < 1e-4:
            break
        for m in range(NUMBERS):
            middle[m] = 0.0
            for k in range(n + 1):
                if k != high:
                    middle[m] += simplex[k, m] / n
        _mix(2.0, middle, -1.0, simplex[high], trial)
        loss = disagreement(kind, trial, image)
        if loss < losses[low]:
            _mix(3.0, middle, -2.0, simplex[high], further)
            other = disagreement(kind, further, image)
            if other < loss:
                trial, further, loss = further, trial, other
        elif loss >= losses[second]:
            _mix(0.5, middle, 0.5, trial if loss < losses[high] else simplex[high], further)
            other = disagreement(kind, further, image)
            if other < min(loss, losses[high]):
                trial, further, loss = further, trial, other
            else:
                for k in range(n + 1):
                    if k != low:
                        _mix(0.5, simplex[k], 0.5, simplex[low], simplex[k])
                        losses[k] = disagreement(kind, simplex[k], image)
                continue
        _mix(1.0, trial, 0.0, trial, simplex[high])
        losses[high] = loss
    low, high, second = _ends(losses, n + 1)
    _mix(1.0, simplex[low], 0.0, shape, shape)
    return float(losses[low])


@compiled
def _mix(p: float, one: Floats, q: float, other: Floats, out: Floats) -> None:
    """Write p one + q other into out, which may be one of them."""
    for k in range(NUMBERS):
        out[k] = p * one[k] + q * other[k]


@compiled
def _ends(losses: Floats, n: int) -> tuple[int, int, int]:
    """Which of the first n numbers is the least, the greatest and the second greatest."""
    low, high = 0, 0
    for k in range(1, n):
        if losses[k] < losses[low]:
            low = k
        if losses[k] >= losses[high]:
            high = k
    second = 1 if high == 0 else 0
    for k in range(n):
        if k != high and losses[k] >= losses[second]:
            second = k
    return low, high, second
