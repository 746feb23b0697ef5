"""Shape candidates for an image: all with whole corners, and turned ones that descend. Plain loops for numba."""

import math

import numpy as np

from utak.geometry.kernels.arrays import Floats
from utak.geometry.kernels.jit import compiled
from utak.geometry.shapes.classes import CLASSES, DISC, TRIANGLE, F, H, S
from utak.geometry.shapes.misfit import (
    FORM,
    IMAGE_OCCUPIED,
    IMAGE_UNKNOWN,
    PARAMETER_COUNT,
    Image,
    class_violation,
    count_wrong_squares,
    descend,
    disagreement,
)

TURNS = np.array([one.turns for one in CLASSES])  # quarter turns that look different
# Whether the rectangles of a class need a height, arms, a stem that may be of another thickness
HAS_HEIGHT, HAS_ARMS, HAS_STEM = (np.array([one.depends_on(size) for one in CLASSES]) for size in (H, F, S))

# Chosen; no measurement on record. tests/geometry/shapes tells how often the class is right.
DESCENT_STEPS = 150  # steps of a descent, at most
DESCENT_STARTS = 4  # candidates from which a descent begins
FAN_ANGLES = 24  # angles of candidates in a whole turn
UNEVEN_CREDIT = 1  # squares; arms of two widths must explain more than so many more than arms of one
MIN_NOTCH = 2  # squares; the least length and width of the notch of an L with arms of two widths
DISC_STEP = 0.03  # squares; step of the place and radius of a disc that is refined
DISC_STEP_COUNT = 5  # such steps in each direction
MAX_UNKNOWN_RIM = 2  # squares; how far a whole shape may reach into unknown squares beyond the known ones


@compiled
def best_whole_shape(kind: int, image: Image) -> tuple[Floats, float]:
    """Return the best shape of a class with whole corners and sides along the axes, and how many squares are wrong."""
    best, at = math.inf, np.zeros(PARAMETER_COUNT)
    if FORM[kind] == DISC:
        return at, best
    s0, n1, w0, e1 = _extent(image, IMAGE_OCCUPIED)
    s1, n0, w1, e0 = _extent(image, IMAGE_UNKNOWN)
    for south in range(max(min(s0, s1), s0 - MAX_UNKNOWN_RIM), s0 + 1):
        for north in range(n1, min(max(n1, n0), n1 + MAX_UNKNOWN_RIM) + 1):
            for west in range(max(min(w0, w1), w0 - MAX_UNKNOWN_RIM), w0 + 1):
                for east in range(e1, min(max(e1, e0), e1 + MAX_UNKNOWN_RIM) + 1):
                    if FORM[kind] == TRIANGLE:
                        shape, wrong = _whole_triangle(kind, image, west, south, east, north, best)
                    else:
                        shape, wrong = _whole_rectangles(kind, image, west, south, east, north, best)
                    if wrong < best:
                        best, at = wrong, shape
    return at, best


@compiled
def _extent(image: Image, state: int) -> tuple[int, int, int, int]:
    """Return south, north, west, east of the squares of one state: first, and one beyond the last."""
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
    """Return the best union of rectangles that just fits in a rectangle, and how many squares are wrong."""
    # If none gets fewer than `limit` squares wrong: zeros, and infinity or, with a stem, `limit`.
    best, at = limit, np.zeros(PARAMETER_COUNT)
    width, height = east - west, north - south
    if not HAS_HEIGHT[kind] and width != height:
        return at, math.inf
    for quarter in range(TURNS[kind]):
        a, b = (width, height) if quarter % 2 == 0 else (height, width)
        for thickness in range(1, min(a, b) if HAS_ARMS[kind] else 2):
            angle = quarter * math.pi / 2
            shape = np.array([angle, (west + east) / 2, (south + north) / 2, a, b, thickness, 0.0])
            if class_violation(kind, shape) == 0.0:
                wrong = count_wrong_squares(kind, shape, image, best)
                if wrong < best:
                    best, at = float(wrong), shape
    if HAS_STEM[kind] and best > 0.0:
        return _whole_uneven(kind, image, west, south, east, north, best, at)
    return at, best if best < limit else math.inf


@compiled
def _whole_uneven(
    kind: int, image: Image, west: int, south: int, east: int, north: int, limit: float, shape: Floats
) -> tuple[Floats, float]:
    """Return the best shape with arms of two widths that just fits in a rectangle, if it is better than a shape."""
    # The result is (numbers, wrong squares); otherwise `shape` and `limit` are returned.
    best, at = limit, shape
    for quarter in range(TURNS[kind]):
        a, b = (east - west, north - south) if quarter % 2 == 0 else (north - south, east - west)
        for foot in range(1, b - MIN_NOTCH + 1):
            for stem in range(1, a - MIN_NOTCH + 1):
                angle = quarter * math.pi / 2
                other = np.array([angle, (west + east) / 2, (south + north) / 2, a, b, foot, stem])
                if foot != stem and class_violation(kind, other) == 0.0:
                    wrong = count_wrong_squares(kind, other, image, best)
                    if wrong < best:
                        best, at = float(wrong), other
    return at, best


@compiled
def _whole_triangle(
    kind: int, image: Image, west: int, south: int, east: int, north: int, limit: float
) -> tuple[Floats, float]:
    """Return the best triangle with a side on a rectangle's side and a whole corner on the opposite one."""
    best, at = limit, np.zeros(PARAMETER_COUNT)
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
                wrong = count_wrong_squares(kind, shape, image)
                if wrong < best:
                    best, at = float(wrong), shape
    return at, best if best < limit else math.inf


@compiled
def best_turned_shape(kind: int, image: Image) -> tuple[Floats, float]:
    """Return the best shape of a class at any place and angle that descents find, and how many squares are wrong."""
    free, starts = initial_steps(kind), _starts(kind, image)
    at, best = _best_descended(kind, starts, free, image)
    if HAS_STEM[kind] and best > 0.0:  # perhaps with arms of two widths
        starts[:, 6] = starts[:, 5]
        free[6] = free[5]
        other, wrong = _best_descended(kind, starts, free, image)
        if wrong + UNEVEN_CREDIT < best:
            return other, wrong
    return at, best


@compiled
def _best_descended(kind: int, starts: Floats, free: Floats, image: Image) -> tuple[Floats, float]:
    """Return the best shape that descents from the best starts reach, and how many squares are wrong."""
    losses = np.empty(len(starts))
    for k in range(len(starts)):
        losses[k] = disagreement(kind, starts[k], image)
    best, at, least = math.inf, starts[0], math.inf
    for _ in range(min(DESCENT_STARTS, len(losses))):
        next_best = np.argmin(losses)
        losses[next_best] = math.inf
        shape = starts[next_best].copy()
        loss = descend(kind, shape, free, image, DESCENT_STEPS)
        wrong = float(count_wrong_squares(kind, shape, image))
        if class_violation(kind, shape) > 0.01:
            wrong += 1.0
        if wrong < best or (wrong == best and loss < least):
            best, at, least = wrong, shape, loss
        if least == 0.0:
            break
    if FORM[kind] == DISC and best > 0.0:
        return _refined_disc(kind, at, best, image)
    return at, best


@compiled
def _refined_disc(kind: int, disc: Floats, wrong: float, image: Image) -> tuple[Floats, float]:
    """Return the disc near one, at places and radii in fine steps, with the fewest wrong squares, and their number."""
    # The disc of least disagreement may get several squares wrong by very little, because the rim of a wide disc passes
    # many corners of squares.
    best, at, least = wrong, disc, disagreement(kind, disc, image)
    for i in range(-DISC_STEP_COUNT, DISC_STEP_COUNT + 1):
        for j in range(-DISC_STEP_COUNT, DISC_STEP_COUNT + 1):
            for k in range(-DISC_STEP_COUNT, DISC_STEP_COUNT + 1):
                other = disc.copy()
                other[0] += i * DISC_STEP
                other[1] += j * DISC_STEP
                other[2] += k * DISC_STEP
                fewer = float(count_wrong_squares(kind, other, image))
                if fewer <= best and class_violation(kind, other) == 0.0:
                    loss = disagreement(kind, other, image)
                    if fewer < best or loss < least:
                        best, at, least = fewer, other, loss
    return at, best


@compiled
def initial_steps(kind: int) -> Floats:
    """Return how far each number of a class is moved at first in a descent, (PARAMETER_COUNT,); 0 where it stays."""
    if FORM[kind] == DISC:
        return np.array([0.3, 0.3, 0.3, 0.0, 0.0, 0.0, 0.0])
    if FORM[kind] == TRIANGLE:
        return np.array([0.4, 0.4, 0.4, 0.4, 0.4, 0.4, 0.0])
    return np.array([0.1, 0.3, 0.3, 0.4, 0.4 * HAS_HEIGHT[kind], 0.3 * HAS_ARMS[kind], 0.0])


@compiled
def _starts(kind: int, image: Image) -> Floats:
    """Return the shapes of a class from which descents may begin: (n, PARAMETER_COUNT), float64."""
    if FORM[kind] == DISC:
        return _start_disc(image)
    thickness_count = 3 if HAS_ARMS[kind] else 1
    angles = FAN_ANGLES * TURNS[kind] // 4
    starts = np.zeros((angles * thickness_count, PARAMETER_COUNT))
    for k in range(angles):
        angle = 2 * math.pi * k / FAN_ANGLES
        for t in range(thickness_count):
            _write_start(kind, image, angle, 1.5 + t * 0.9, starts[k * thickness_count + t])
    return starts


@compiled
def _start_disc(image: Image) -> Floats:
    """Return a disc about the mean of the occupied squares, of nearly their area, (1, PARAMETER_COUNT)."""
    x = y = 0.0
    count = 0
    for row in range(image.shape[0]):
        for column in range(image.shape[1]):
            if image[row, column] == IMAGE_OCCUPIED:
                x += column + 0.5
                y += row + 0.5
                count += 1
    start = np.zeros((1, PARAMETER_COUNT))
    start[0, 0], start[0, 1] = x / count, y / count
    start[0, 2] = max(math.sqrt(count / math.pi) - 0.5, 0.7)
    return start


@compiled
def _write_start(kind: int, image: Image, angle: float, thickness: float, out: Floats) -> None:
    """Write a shape in one direction to `out`, (PARAMETER_COUNT,), its sizes read off the extent of the squares."""
    c, s = math.cos(angle), math.sin(angle)
    u0, u1, v0, v1, tip = 1e9, -1e9, 1e9, -1e9, 0.0
    for row in range(image.shape[0]):
        for column in range(image.shape[1]):
            if image[row, column] == IMAGE_OCCUPIED:
                u = c * (column + 0.5) + s * (row + 0.5)
                v = -s * (column + 0.5) + c * (row + 0.5)
                if v > v1:
                    v1, tip = v, u
                u0, u1, v0 = min(u0, u), max(u1, u), min(v0, v)
    off = (abs(c) + abs(s)) / 2 - 0.3
    u0, u1, v0, v1 = u0 + off, u1 - off, v0 + off, v1 - off
    if FORM[kind] == TRIANGLE:
        out[0], out[1] = c * u0 - s * v0, s * u0 + c * v0
        out[2], out[3] = c * u1 - s * v0, s * u1 + c * v0
        out[4], out[5] = c * tip - s * v1, s * tip + c * v1
        return
    mid_u, mid_v = (u0 + u1) / 2, (v0 + v1) / 2
    width, height = max(u1 - u0, 1.0), max(v1 - v0, 1.0)
    if not HAS_HEIGHT[kind]:
        width = (width + height) / 2
    out[0], out[1], out[2] = angle, c * mid_u - s * mid_v, s * mid_u + c * mid_v
    out[3], out[4], out[5] = width, height, thickness
