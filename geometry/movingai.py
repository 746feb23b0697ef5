"""The map format of the Moving AI benchmarks (Sturtevant 2012), and their scenario files.

A map's first row of text is its north edge; screens have row 0 in the south, so rows are turned over.
"""

from pathlib import Path
from typing import NamedTuple

import numpy as np

from geometry.distance import Bools

PASSABLE = ".GS"
KNOWN = PASSABLE + "@OTW"


class Trip(NamedTuple):
    """One problem of a scenario file, in the coordinates of the turned-over screen."""

    start: tuple[float, float]
    """Centre of the first square."""
    goal: tuple[float, float]
    """Centre of the last square."""
    octile: float
    """The optimum for eight directions, as the file says."""


def read_map(path: str | Path) -> Bools:
    """(rows, columns) bool: where one may be.

    Raises
    ------
    ValueError
        When the file is no such map; the message has file and line.
    OSError
        When it cannot be read.
    """
    lines = Path(path).read_text(encoding="ascii", errors="replace").splitlines()
    height, width = (header(path, lines, word) for word in ("height", "width"))
    if "map" not in lines[:5]:
        raise ValueError(f"{path}:4: error: a line that says 'map' is missing")
    first = lines.index("map") + 1
    rows = lines[first : first + height]
    if len(rows) < height:
        raise ValueError(f"{path}:{len(lines)}: error: the map has {len(rows)} rows, not {height}")
    for number, row in enumerate(rows, first + 1):
        if len(row) != width:
            raise ValueError(f"{path}:{number}: error: the row has {len(row)} squares, not {width}")
        if strange := set(row) - set(KNOWN):
            raise ValueError(f"{path}:{number}: error: unknown square {min(strange)!r}; known are {' '.join(KNOWN)}")
    return np.array([[square in PASSABLE for square in row] for row in reversed(rows)], np.bool_).reshape(height, width)


def header(path: str | Path, lines: list[str], word: str) -> int:
    """A number from the head of the file."""
    for number, line in enumerate(lines[:4], 1):
        if line.startswith(word + " "):
            try:
                return int(line.split()[1])
            except ValueError:
                raise ValueError(f"{path}:{number}: error: {word} is not a whole number") from None
    raise ValueError(f"{path}:1: error: a line that says '{word} N' is missing")


def read_trips(path: str | Path) -> list[Trip]:
    """The problems of a scenario file."""
    trips = []
    for line in Path(path).read_text(encoding="ascii").splitlines():
        words = line.split()
        if len(words) == 9:
            height, a, b, c, d = (int(word) for word in words[3:8])
            start, goal = (a + 0.5, height - b - 0.5), (c + 0.5, height - d - 0.5)
            trips.append(Trip(start, goal, float(words[8])))
    return trips
