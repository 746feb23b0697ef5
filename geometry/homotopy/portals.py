"""The portals that a polyline through free space crosses."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from geometry.homotopy.strips import Strips, extend, run_at
from geometry.kernels.arrays import XY, Ints

SLACK = 1e-9  # squares by which a corner may miss a wall's corner that it rounds


def word_of_line(runs: Strips, points: Sequence[Sequence[float]]) -> Ints:
    """The reduced word of a polyline; it may touch walls and their corners.

    Raises
    ------
    ValueError
        When the line leaves free space.
    """
    line = [(float(x), float(y)) for x, y in points]
    run, row = first_run(runs, line[0])
    symbols: list[int] = []
    for p, q in pairwise(line):
        while True:
            here = leave_point(runs, run, row, p, q)
            if here is None:
                break
            symbol = best_portal(runs, run, row, here, q)
            run, row = (runs.upper, runs.lower)[symbol < 0][abs(symbol) - 1], row + (1 if symbol > 0 else -1)
            if symbols and symbols[-1] == -symbol:
                symbols.pop()
            else:
                symbols.append(symbol)
            p = here
    last = symbol_into_square(runs, run, row, line[-1])
    if last:
        symbols = symbols[:-1] if symbols and symbols[-1] == -last else [*symbols, last]
    return np.array(symbols, np.int32)


def first_run(runs: Strips, point: XY) -> tuple[int, int]:
    """The run and row of a line's first point."""
    row = min(int(point[1]), len(runs.row) - 2)
    run = int(run_at(runs.row, runs.low, row, int(point[0])))
    if runs.row[row] == runs.row[row + 1] or not runs.low[run] <= point[0] <= runs.high[run] + 1:
        raise ValueError(f"the line starts in a blocked square, at {point}")
    return run, row


def symbol_into_square(runs: Strips, run: int, row: int, point: XY) -> int:
    """Return the portal from the run in which a line ends to that of its last point's square, 0 if they are the same.

    A point on a line between two rows belongs to the upper one, from whichever side the line comes: words between the
    same ends must end in the same run. In a blocked square, with a wall above, the line ends where it is.

    Raises
    ------
    ValueError
        When the last point is a corner between two blocked squares and the line comes from the wrong side.
    """
    column, line = int(point[0]), min(int(point[1]), len(runs.row) - 2)
    if runs.row[line] == runs.row[line + 1]:
        return 0
    own = int(run_at(runs.row, runs.low, line, column))
    if own == run or not runs.low[own] <= column <= runs.high[own]:
        return 0
    for sign, bounds, beyond in ((1, runs.up, runs.upper), (-1, runs.down, runs.lower)):
        for portal in range(bounds[run], bounds[run + 1]):
            touches = runs.left[portal] - SLACK <= point[0] <= runs.right[portal] + 1 + SLACK
            if line == row + sign and beyond[portal] == own and touches:
                return sign * (portal + 1)
    raise ValueError(f"the line leaves free space at {point}")


def leave_point(runs: Strips, run: int, row: int, p: XY, q: XY) -> XY | None:
    """Where the segment from p, in a run, leaves it; None when it ends in it."""
    low, high = float(runs.low[run]), float(runs.high[run] + 1)
    last = 1.0
    for at, by, least, most in ((p[0], q[0] - p[0], low, high), (p[1], q[1] - p[1], float(row), row + 1.0)):
        if at + by > most + SLACK:
            last = min(last, (most - at) / by)
        elif at + by < least - SLACK:
            last = min(last, (least - at) / by)
    if last >= 1.0:
        return None
    last = max(last, 0.0)
    return p[0] + last * (q[0] - p[0]), p[1] + last * (q[1] - p[1])


def best_portal(runs: Strips, run: int, row: int, p: XY, q: XY) -> int:
    """The signed portal at p on the edge of a run through which one gets furthest towards q."""
    choices: list[tuple[float, int]] = []
    for sign, bounds, next_run, step in ((1, runs.up, runs.upper, 1), (-1, runs.down, runs.lower, -1)):
        if abs(p[1] - (row + (sign > 0))) > SLACK:
            continue
        for portal in range(bounds[run], bounds[run + 1]):
            if runs.left[portal] - SLACK <= p[0] <= runs.right[portal] + 1 + SLACK:
                out = leave_point(runs, int(next_run[portal]), row + step, p, q) or q
                gain = abs(out[0] - p[0]) + abs(out[1] - p[1])
                choices.append((gain, sign * (portal + 1)))
    gain, symbol = max(choices, default=(0.0, 0))
    if gain <= 0.0:
        raise ValueError(f"the line leaves free space at {p}")
    return symbol


def join_words(*words: Ints) -> Ints:
    """The words one after the other, reduced."""
    whole = np.empty(sum(len(word) for word in words) + 1, np.int32)
    size = 0
    for word in words:
        for symbol in word.tolist():
            size = extend(whole, size, symbol)
    return whole[:size]


def crossings_of(runs: Strips, word: Ints) -> tuple[int, ...]:
    """The signed crossing numbers of a reduced word."""
    numbers = runs.crossing[np.abs(word) - 1] * np.sign(word)
    return tuple(numbers[numbers != 0].tolist())
