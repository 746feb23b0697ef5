"""Words of portals: the word of a polyline through free space, and the crossing numbers of a word."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from utak.geometry.homotopy.strips import Strips, strip_at
from utak.geometry.kernels.arrays import XY, Ints

WALL_TOLERANCE = 1e-9  # squares; rounding by which a line's corner may miss the wall corner that it touches


def word_of_line(strips: Strips, points: Sequence[Sequence[float]]) -> Ints:
    """Return the reduced word of a polyline: the signed portals that it crosses, (n,) int32, in order."""
    line = [(float(x), float(y)) for x, y in points]
    strip, row = first_strip(strips, line[0])
    symbols: list[int] = []
    for p, q in pairwise(line):
        while True:
            here = leave_point(strips, strip, row, p, q)
            if here is None:
                break
            symbol = best_portal(strips, strip, row, here, q)
            strip, row = (strips.upper, strips.lower)[symbol < 0][abs(symbol) - 1], row + (1 if symbol > 0 else -1)
            if symbols and symbols[-1] == -symbol:
                symbols.pop()
            else:
                symbols.append(symbol)
            p = here
    last = symbol_into_square(strips, strip, row, line[-1])
    if last:
        symbols = symbols[:-1] if symbols and symbols[-1] == -last else [*symbols, last]
    return np.array(symbols, np.int32)


def first_strip(strips: Strips, point: XY) -> tuple[int, int]:
    """Return the strip and the row of a line's first point."""
    row = min(int(point[1]), len(strips.row) - 2)
    strip = int(strip_at(strips.row, strips.low, row, int(point[0])))
    if strips.row[row] == strips.row[row + 1] or not strips.low[strip] <= point[0] <= strips.high[strip] + 1:
        raise ValueError(f"the line starts in a blocked square, at {point}")
    return strip, row


def symbol_into_square(strips: Strips, strip: int, row: int, point: XY) -> int:
    """Return the signed portal from the strip in which a line ends to that of its end's square, 0 if the same."""
    column, line = int(point[0]), min(int(point[1]), len(strips.row) - 2)
    if strips.row[line] == strips.row[line + 1]:
        return 0
    own = int(strip_at(strips.row, strips.low, line, column))
    if own == strip or not strips.low[own] <= column <= strips.high[own]:
        return 0
    for sign, bounds, beyond in ((1, strips.up, strips.upper), (-1, strips.down, strips.lower)):
        for portal in range(bounds[strip], bounds[strip + 1]):
            touches = strips.left[portal] - WALL_TOLERANCE <= point[0] <= strips.right[portal] + 1 + WALL_TOLERANCE
            if line == row + sign and beyond[portal] == own and touches:
                return sign * (portal + 1)
    raise ValueError(f"the line leaves free space at {point}")


def leave_point(strips: Strips, strip: int, row: int, p: XY, q: XY) -> XY | None:
    """Return the point at which the segment p-q leaves the strip of p; None when it ends in the strip."""
    low, high = float(strips.low[strip]), float(strips.high[strip] + 1)
    last = 1.0
    for at, by, least, most in ((p[0], q[0] - p[0], low, high), (p[1], q[1] - p[1], float(row), row + 1.0)):
        if at + by > most + WALL_TOLERANCE:
            last = min(last, (most - at) / by)
        elif at + by < least - WALL_TOLERANCE:
            last = min(last, (least - at) / by)
    if last >= 1.0:
        return None
    last = max(last, 0.0)
    return p[0] + last * (q[0] - p[0]), p[1] + last * (q[1] - p[1])


def best_portal(strips: Strips, strip: int, row: int, p: XY, q: XY) -> int:
    """Return the signed portal at p, on the edge of a strip, through which the segment p-q gets furthest."""
    choices: list[tuple[float, int]] = []
    for sign, bounds, next_strip, step in ((1, strips.up, strips.upper, 1), (-1, strips.down, strips.lower, -1)):
        if abs(p[1] - (row + (sign > 0))) > WALL_TOLERANCE:
            continue
        for portal in range(bounds[strip], bounds[strip + 1]):
            if strips.left[portal] - WALL_TOLERANCE <= p[0] <= strips.right[portal] + 1 + WALL_TOLERANCE:
                out = leave_point(strips, int(next_strip[portal]), row + step, p, q) or q
                gain = abs(out[0] - p[0]) + abs(out[1] - p[1])
                choices.append((gain, sign * (portal + 1)))
    gain, symbol = max(choices, default=(0.0, 0))
    if gain <= 0.0:
        raise ValueError(f"the line leaves free space at {p}")
    return symbol


def crossings_of(strips: Strips, word: Ints) -> tuple[int, ...]:
    """Return the signed crossing numbers of a reduced word, in its order: the signature of its class."""
    numbers = strips.crossing[np.abs(word) - 1] * np.sign(word)
    return tuple(numbers[numbers != 0].tolist())
