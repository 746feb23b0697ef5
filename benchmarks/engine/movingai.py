"""Files of the Moving AI benchmarks (Sturtevant 2012): maps with their problems."""

from pathlib import Path
from typing import NamedTuple

from utak.geometry.io.movingai import MapError, parse_map
from utak.geometry.kernels.arrays import Bools


class Trip(NamedTuple):
    """One problem of a scenario file, in squares (row 0 in the south, (0, 0) at its south-west corner)."""

    start: tuple[float, float]  # (x, y), the centre of the first square
    goal: tuple[float, float]  # (x, y), the centre of the last square
    # The length in squares of the optimal path over eight directions, as the file says; a diagonal step counts sqrt(2)
    octile: float


def read_map(path: Path) -> Bools:
    """Return the free squares of a map file, row 0 in the south; raise ValueError with file and line for a bad one."""
    try:
        return parse_map(path.read_bytes())
    except MapError as error:
        raise ValueError(f"{path}:{error.line}: error: {error.what}") from None


def read_trips(path: Path) -> list[Trip]:
    """Return the problems of a scenario file, in order; lines that do not have nine words are skipped."""
    # The file counts rows from the north: words 4 to 9 are the height, column and row of start and goal, the length.
    trips = []
    for line in Path(path).read_text(encoding="ascii").splitlines():
        words = line.split()
        if len(words) == 9:
            height, a, b, c, d = (int(word) for word in words[3:8])
            start, goal = (a + 0.5, height - b - 0.5), (c + 0.5, height - d - 0.5)
            trips.append(Trip(start, goal, float(words[8])))
    return trips
