"""Senses for tests: the impression of a drawn world, written from DESIGN section 4 and not from the code under test."""

import math
from collections.abc import Callable

import numpy as np

from utak.kb.body import Impression

Occupied = Callable[[int, int], bool]
Colours = Callable[[int, int], str]
ZONES = ((4, 1), (8, 2), (16, 4))
AROUND = ((0, 1), (1, 1), (1, 0), (1, -1), (0, -1), (-1, -1), (-1, 0), (-1, 1))


def world_of(rows: list[str]) -> Occupied:
    """Return whether squares of a drawing are occupied, as a function of column and row, row 0 in the south.

    rows : the north row first; `.` and `U` are free. Everything beyond the drawing is occupied.
    """
    high = len(rows)

    def occupied(i: int, j: int) -> bool:
        inside = 0 <= j < high and 0 <= i < len(rows[high - 1 - j])
        return not inside or rows[high - 1 - j][i] not in ".U"

    return occupied


def colours_of(rows: list[str]) -> Colours:
    """Return the colours of a drawing, as a function of column and row: its letters, and `b` beyond it."""
    high = len(rows)

    def colour(i: int, j: int) -> str:
        inside = 0 <= j < high and 0 <= i < len(rows[high - 1 - j])
        return rows[high - 1 - j][i] if inside else "b"

    return colour


def utak_in(rows: list[str]) -> tuple[int, int]:
    """Return the square (column, row) of the U in a drawing, row 0 in the south."""
    return next((row.index("U"), len(rows) - 1 - n) for n, row in enumerate(rows) if "U" in row)


def sampled(east: int, north: int, heading: float) -> tuple[int, int]:
    """Return the square under an offset at a heading (degrees), relative to Utak's square; halves round to even."""
    c, s = math.cos(math.radians(heading)), math.sin(math.radians(heading))
    return round(east * c - north * s), round(east * s + north * c)


def retina(occupied: Occupied, square: tuple[int, int], heading: float = 0.0) -> tuple[int, ...]:
    """Return the 160 gray levels seen from a square at a heading in degrees."""
    levels, inner = [], 0
    for reach, side in ZONES:
        for north in range(reach - side, -reach - 1, -side):
            for east in range(-reach, reach, side):
                if -inner <= east < inner and -inner <= north < inner:
                    continue
                count = 0
                for e in range(east, east + side):
                    for n in range(north, north + side):
                        i, j = sampled(e, n, heading)
                        count += (e, n) == (0, 0) or occupied(square[0] + i, square[1] + j)
                levels.append(math.floor(7 * count / side**2 + 0.5))
        inner = reach
    return tuple(levels)


def impression(
    occupied: Occupied, square: tuple[int, int], heading: float = 0.0, colour: str | Colours = "b"
) -> Impression:
    """Return the impression at a square. colour : of everything, or a function of column and row."""
    touch = []
    for east, north in AROUND:
        i, j = sampled(east, north, heading)
        there = square[0] + i, square[1] + j
        felt = colour if isinstance(colour, str) else colour(*there)
        touch.append(felt if occupied(*there) else None)
    return Impression(retina(occupied, square, heading), tuple(touch))


def random_room(rng: np.random.Generator, wide: int, high: int, things: int) -> list[str]:
    """Return a drawing of a walled room with some rectangles in it; its floor need not be connected."""
    grid = np.full((high, wide), ".")
    grid[[0, -1], :] = grid[:, [0, -1]] = "b"
    for _ in range(things):
        w, h = rng.integers(1, 5, 2)
        x, y = rng.integers(1, wide - 1), rng.integers(1, high - 1)
        grid[y : min(y + h, high - 1), x : min(x + w, wide - 1)] = "g"
    return ["".join(row) for row in grid]
