"""Where to lay shapes on an image: all whole ones, and a fan of turned ones that then settle. Plain loops for numba."""

import math

import numpy as np

from geometry.kernels.arrays import Floats
from geometry.kernels.jit import compiled
from geometry.shapes.misfit import (
    BRICK,
    DISC,
    ELL,
    HORSESHOE,
    NUMBERS,
    SQUARE,
    TRIANGLE,
    UNKNOWN,
    WANTED,
    Image,
    disagreement,
    impropriety,
    misfit,
    settle,
)

STEPS = 150  # of settling
ANGLES = 24  # in the fan, a whole turn
CREDIT = 1  # squares more that arms of two widths must explain than arms of one
NOTCH = 2  # squares that the notch of an L with arms of two widths is long and wide, at least
STARTS = 4  # that settle
FINE, ROUNDS = 0.03, 5  # squares by which a disc is moved, and how often, for fewer squares to be wrong
SLACK = 2  # unknown squares by which a whole shape may reach beyond what is known of it


@compiled
def whole_best(kind: int, image: Image) -> tuple[Floats, float]:
    """The best shape of a class with whole corners and sides along the axes, and its misfit (infinite: none)."""
    best, at = math.inf, np.zeros(NUMBERS)
    if kind == DISC:
        return at, best
    s0, n1, w0, e1 = _extent(image, WANTED)
    s1, n0, w1, e0 = _extent(image, UNKNOWN)
    for south in range(max(min(s0, s1), s0 - SLACK), s0 + 1):
        for north in range(n1, min(max(n1, n0), n1 + SLACK) + 1):
            for west in range(max(min(w0, w1), w0 - SLACK), w0 + 1):
                for east in range(e1, min(max(e1, e0), e1 + SLACK) + 1):
                    if kind == TRIANGLE:
                        shape, wrong = _whole_triangle(image, west, south, east, north, best)
                    else:
                        shape, wrong = _whole_rectangles(kind, image, west, south, east, north, best)
                    if wrong < best:
                        best, at = wrong, shape
    return at, best


@compiled
def _extent(image: Image, state: int) -> tuple[int, int, int, int]:
    """South, north, west, east of the squares of one state: first and one beyond the last."""
    south, north, west, east = 10**6, -(10**6), 10**6, -(10**6)
    for row in range(image.shape[0]):
        for column in range(image.shape[1]):
            if image[row, column] == state:
                south, north = min(south, row), max(north, row + 1)
                west, east = min(west, column), max(east, column + 1)
    return south, north, west, east


@compiled
def _whole_rectangles(
    kind: int, image: Image, west: int, south: int, east: int, north: int, limit: float
) -> tuple[Floats, float]:
    """The best square, brick, L, T or U that just fits in a rectangle, in all four directions."""
    best, at = limit, np.zeros(NUMBERS)
    wide, high = east - west, north - south
    if kind == SQUARE and wide != high:
        return at, math.inf
    for quarter in range(1 if kind <= BRICK else 4):
        a, b = (wide, high) if quarter % 2 == 0 else (high, wide)
        for thick in range(1, 2 if kind <= BRICK else min(a, b)):
            angle = quarter * math.pi / 2
            shape = np.array([angle, (west + east) / 2, (south + north) / 2, a, b, thick, 0.0])
            if impropriety(kind, shape) == 0.0:
                wrong = misfit(kind, shape, image, best)
                if wrong < best:
                    best, at = float(wrong), shape
    if kind == ELL and best > 0.0:
        return _whole_uneven(image, west, south, east, north, best, at)
    return at, best if best < limit else math.inf


@compiled
def _whole_uneven(
    image: Image, west: int, south: int, east: int, north: int, limit: float, shape: Floats
) -> tuple[Floats, float]:
    """The best L with arms of two widths that just fits in a rectangle, if it is better than a shape.

    Its notch is at least NOTCH squares long and wide: a turned rectangle may lack a square or two of a row at a corner.
    """
    best, at = limit, shape
    for quarter in range(4):
        a, b = (east - west, north - south) if quarter % 2 == 0 else (north - south, east - west)
        for foot in range(1, b - NOTCH + 1):
            for stem in range(1, a - NOTCH + 1):
                angle = quarter * math.pi / 2
                other = np.array([angle, (west + east) / 2, (south + north) / 2, a, b, foot, stem])
                if foot != stem and impropriety(ELL, other) == 0.0:
                    wrong = misfit(ELL, other, image, best)
                    if wrong < best:
                        best, at = float(wrong), other
    return at, best


@compiled
def _whole_triangle(image: Image, west: int, south: int, east: int, north: int, limit: float) -> tuple[Floats, float]:
    """The best triangle with a side on a rectangle's and a whole corner on the opposite one.

    Right-angled ones are tried first, then those with two equal sides, then the rest.
    """
    best, at = limit, np.zeros(NUMBERS)
    for turn in range(3):
        for side in range(4):
            length = east - west if side < 2 else north - south
            for tip in range(length + 1):
                rank = 0 if tip == 0 or tip == length else 1 if 2 * tip == length else 2
                if rank != turn:
                    continue
                if side < 2:
                    y0, y1 = (south, north) if side == 0 else (north, south)
                    shape = np.array([west, y0, east, y0, west + tip, y1, 0.0], np.float64)
                else:
                    x0, x1 = (west, east) if side == 2 else (east, west)
                    shape = np.array([x0, south, x0, north, x1, south + tip, 0.0], np.float64)
                wrong = misfit(TRIANGLE, shape, image)
                if wrong < best:
                    best, at = float(wrong), shape
    return at, best if best < limit else math.inf


@compiled
def settled_best(kind: int, image: Image) -> tuple[Floats, float]:
    """The best shape of a class at any place and angle that settling finds, and its misfit."""
    free, starts = freedom(kind), _fan(kind, image)
    at, best = _settled(kind, starts, free, image)
    if kind == ELL and best > 0.0:  # perhaps with arms of two widths
        starts[:, 6] = starts[:, 5]
        free[6] = free[5]
        other, wrong = _settled(kind, starts, free, image)
        if wrong + CREDIT < best:
            return other, wrong
    return at, best


@compiled
def _settled(kind: int, starts: Floats, free: Floats, image: Image) -> tuple[Floats, float]:
    """The best of shapes that settle, and its misfit."""
    losses = np.empty(len(starts))
    for k in range(len(starts)):
        losses[k] = disagreement(kind, starts[k], image)
    best, at, least = math.inf, starts[0], math.inf
    for _ in range(min(STARTS, len(losses))):
        next_best = np.argmin(losses)
        losses[next_best] = math.inf
        shape = starts[next_best].copy()
        loss = settle(kind, shape, free, image, STEPS)
        wrong = float(misfit(kind, shape, image))
        if impropriety(kind, shape) > 0.01:
            wrong += 1.0
        if wrong < best or (wrong == best and loss < least):
            best, at, least = wrong, shape, loss
        if least == 0.0:
            break
    if kind == DISC and best > 0.0:
        return _round_best(at, best, image)
    return at, best


@compiled
def _round_best(disc: Floats, wrong: float, image: Image) -> tuple[Floats, float]:
    """The disc near one, at places and of radii in fine steps, that gets the fewest squares wrong.

    What disagrees least in sum may get several squares wrong by a hair: of a wide disc the rim passes many corners.
    """
    best, at, least = wrong, disc, disagreement(DISC, disc, image)
    for i in range(-ROUNDS, ROUNDS + 1):
        for j in range(-ROUNDS, ROUNDS + 1):
            for k in range(-ROUNDS, ROUNDS + 1):
                other = disc.copy()
                other[0] += i * FINE
                other[1] += j * FINE
                other[2] += k * FINE
                fewer = float(misfit(DISC, other, image))
                if fewer <= best and impropriety(DISC, other) == 0.0:
                    loss = disagreement(DISC, other, image)
                    if fewer < best or loss < least:
                        best, at, least = fewer, other, loss
    return at, best


@compiled
def freedom(kind: int) -> Floats:
    """How far each number of a class is moved at first when it settles; 0 where it stays."""
    if kind == DISC:
        return np.array([0.3, 0.3, 0.3, 0.0, 0.0, 0.0, 0.0])
    if kind == TRIANGLE:
        return np.array([0.4, 0.4, 0.4, 0.4, 0.4, 0.4, 0.0])
    free = np.array([0.1, 0.3, 0.3, 0.4, 0.4, 0.3, 0.0])
    if kind <= BRICK:
        free[5] = 0.0
    if kind == SQUARE:
        free[4] = 0.0
    return free


@compiled
def _fan(kind: int, image: Image) -> Floats:
    """Shapes to start from: (n, NUMBERS)."""
    if kind == DISC:
        return _round_start(image)
    thicknesses = 3 if kind >= ELL and kind <= HORSESHOE else 1
    angles = ANGLES if kind >= ELL else ANGLES // 4
    starts = np.zeros((angles * thicknesses, NUMBERS))
    for k in range(angles):
        angle = 2 * math.pi * k / ANGLES
        for t in range(thicknesses):
            _start(kind, image, angle, 1.5 + t * 0.9, starts[k * thicknesses + t])
    return starts


@compiled
def _round_start(image: Image) -> Floats:
    """A disc about the middle of the squares, of nearly their area."""
    x = y = 0.0
    count = 0
    for row in range(image.shape[0]):
        for column in range(image.shape[1]):
            if image[row, column] == WANTED:
                x += column + 0.5
                y += row + 0.5
                count += 1
    start = np.zeros((1, NUMBERS))
    start[0, 0], start[0, 1] = x / count, y / count
    start[0, 2] = max(math.sqrt(count / math.pi) - 0.5, 0.7)
    return start


@compiled
def _start(kind: int, image: Image, angle: float, thick: float, out: Floats) -> None:
    """Write a shape in one direction to out (NUMBERS,), its sizes read off the extent of the squares.

    A shape reaches into its outermost squares by less than half of what a square measures across that direction; a
    little less than that is taken off.
    """
    c, s = math.cos(angle), math.sin(angle)
    u0, u1, v0, v1, tip = 1e9, -1e9, 1e9, -1e9, 0.0
    for row in range(image.shape[0]):
        for column in range(image.shape[1]):
            if image[row, column] == WANTED:
                u = c * (column + 0.5) + s * (row + 0.5)
                v = -s * (column + 0.5) + c * (row + 0.5)
                if v > v1:
                    v1, tip = v, u
                u0, u1, v0 = min(u0, u), max(u1, u), min(v0, v)
    off = (abs(c) + abs(s)) / 2 - 0.3
    u0, u1, v0, v1 = u0 + off, u1 - off, v0 + off, v1 - off
    if kind == TRIANGLE:
        out[0], out[1] = c * u0 - s * v0, s * u0 + c * v0
        out[2], out[3] = c * u1 - s * v0, s * u1 + c * v0
        out[4], out[5] = c * tip - s * v1, s * tip + c * v1
        return
    mid_u, mid_v = (u0 + u1) / 2, (v0 + v1) / 2
    wide, high = max(u1 - u0, 1.0), max(v1 - v0, 1.0)
    if kind == SQUARE:
        wide = (wide + high) / 2
    out[0], out[1], out[2] = angle, c * mid_u - s * mid_v, s * mid_u + c * mid_v
    out[3], out[4], out[5] = wide, high, thick
