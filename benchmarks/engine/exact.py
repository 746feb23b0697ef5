"""Exact answers about small floors, by brute force and in whole numbers.

Nothing here uses the code under test but the names of its array types. Points are (x, y) in squares and multiples of a
quarter; inside they are whole numbers of quarters. A point on a line between squares belongs to the square northeast of
it. Two blocked squares that touch at a corner block the passage between them.
"""

from collections import deque
from collections.abc import Sequence
from functools import cached_property
from itertools import pairwise, product

import numpy as np

from utak.geometry.kernels.arrays import XY, Bools, Floats, Labels, Longs

QUARTERS = 4  # of a square: the grid of points


class Exact:
    """A floor with an exact visibility graph between the corners of its blocked squares.

    Parameters
    ----------
    free : (rows, columns) bool
        Free squares; everything outside is blocked.

    Attributes
    ----------
    padded : (rows + 2, columns + 2) bool
        The same with a blocked frame.
    """

    def __init__(self, free: Bools) -> None:
        self.free = free
        self.padded = np.pad(free, 1)

    @cached_property
    def blocked(self) -> Longs:
        """Southwest corners (n, 2) of the blocked squares, those of the frame included, in quarters."""
        return QUARTERS * (np.argwhere(~self.padded)[:, ::-1] - 1)

    def _corners(self, blocked: int, diagonal: bool) -> Longs:
        """Return the corners (n, 2) around which so many squares are blocked; ``diagonal``: only opposite ones."""
        p = self.padded
        about = np.stack([p[:-1, :-1], p[1:, 1:], p[1:, :-1], p[:-1, 1:]])
        chosen = (~about).sum(axis=0) == blocked
        if diagonal:
            chosen &= (about[0] == about[1]) & (about[2] == about[3])
        return QUARTERS * np.argwhere(chosen)[:, ::-1]

    @cached_property
    def corners(self) -> Longs:
        """Points (n, 2) where shortest paths may bend, in quarters."""
        return self._corners(1, False)

    @cached_property
    def pinches(self) -> Longs:
        """Points (n, 2) where two blocked squares touch only at a corner, in quarters."""
        return self._corners(2, True)

    @cached_property
    def seams(self) -> tuple[Longs, Longs]:
        """Lower ends (n, 2) of the vertical, and of the horizontal, edges between two blocked squares, in quarters."""
        wall = ~self.padded
        upright = np.argwhere(wall[:, 1:] & wall[:, :-1])[:, ::-1] - (0, 1)
        level = np.argwhere(wall[1:] & wall[:-1])[:, ::-1] - (1, 0)
        return QUARTERS * upright, QUARTERS * level

    def sees(self, p: Longs, q: Longs) -> Bools:
        """Return (n, m) whether the segments between points (n, 2) and (m, 2), in quarters, stay in free space."""
        a, b = p[:, None, None, :], q[None, :, None, :]
        d = b - a
        low, high = np.minimum(a, b), np.maximum(a, b)
        box = self.blocked[None, None]
        apart = ((high <= box) | (low >= box + QUARTERS)).any(axis=3)
        sides = [cross(d, box + QUARTERS * np.array(side) - a) for side in ((0, 0), (0, 1), (1, 0), (1, 1))]
        apart |= (np.min(sides, axis=0) >= 0) | (np.max(sides, axis=0) <= 0)
        open_ = apart.all(axis=2)
        for axis, seam in enumerate(self.seams):
            ends = seam[None, None]
            along = (a[..., axis] == b[..., axis]) & (a[..., axis] == ends[..., axis])
            other = 1 - axis
            over = (low[..., other] < ends[..., other] + QUARTERS) & (high[..., other] > ends[..., other])
            open_ &= ~(along & over).any(axis=2)
        pinch = self.pinches[None, None]
        on = (cross(d, pinch - a) == 0) & ((pinch - a) * (pinch - b)).sum(axis=3).__lt__(0)
        open_ &= ~on.any(axis=2)
        for one, two in ((a, b), (b, a)):
            at = (one == pinch).all(axis=3) & (two < one).any(axis=3)
            open_ &= ~at.any(axis=2)
        return open_

    @cached_property
    def _between_corners(self) -> Floats:
        """Lengths (n, n) of the segments between corners, in squares; infinite where they leave free space."""
        return lengths(self.corners, self.corners, self.sees(self.corners, self.corners))

    def distances(self, start: XY, goals: Sequence[XY]) -> Floats:
        """Return the exact lengths (n,) of the shortest paths from a point to others, in squares; inf where none is."""
        p, q = in_quarters([start]), in_quarters(goals)
        best = lengths(p, self.corners, self.sees(p, self.corners))[0]
        done = np.zeros(len(best), np.bool_)
        while (~done & (best < np.inf)).any():
            at = int(np.argmin(np.where(done, np.inf, best)))
            done[at] = True
            best = np.minimum(best, best[at] + self._between_corners[at])
        direct = lengths(p, q, self.sees(p, q))[0]
        if not len(best):
            return direct
        last = lengths(self.corners, q, self.sees(self.corners, q))
        return np.minimum(direct, (best[:, None] + last).min(axis=0))

    def is_free(self, points: Floats) -> bool:
        """Return whether a polyline whose points are multiples of a quarter stays in free space."""
        q = in_quarters(points.tolist())
        return all(bool(self.sees(q[k : k + 1], q[k + 1 : k + 2])[0, 0]) for k in range(len(q) - 1))

    @cached_property
    def _rays(self) -> list[XY]:
        """A point in each bounded group of blocked squares, from which a ray runs to the north."""
        number = labels(~self.padded, corners=True)
        outer = number[0, 0]
        found = []
        for k in range(1, int(number.max()) + 1):
            if k != outer:
                row, column = np.argwhere(number == k)[0] - 1
                found.append((float(column) + 0.51 + 0.0001 * k, float(row) + 0.5))
        return found

    def word(self, points: Floats) -> tuple[int, ...]:
        """Return the homotopy class of a polyline with fixed ends: the signed rays that it crosses, reduced."""
        symbols: list[int] = []
        for p, q in pairwise(points.tolist()):
            crossed = []
            for number, (x, y) in enumerate(self._rays, 1):
                if (p[0] < x) != (q[0] < x):
                    t = (x - p[0]) / (q[0] - p[0])
                    if p[1] + t * (q[1] - p[1]) > y:
                        crossed.append((t, number if q[0] > p[0] else -number))
            for _, symbol in sorted(crossed):
                if symbols and symbols[-1] == -symbol:
                    symbols.pop()
                else:
                    symbols.append(symbol)
        return tuple(symbols)


def in_quarters(points: Sequence[Sequence[float]]) -> Longs:
    """Return points as whole quarters of squares; raise ValueError when they are no multiples of a quarter."""
    scaled = QUARTERS * np.array(points, np.float64).reshape(-1, 2)
    rounded = np.round(scaled).astype(np.int64)
    if (rounded != scaled).any():
        raise ValueError("points must be multiples of a quarter")
    return rounded


def cross(a: Longs, b: Longs) -> Longs:
    """Return the cross products of vectors along the last axis."""
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def lengths(p: Longs, q: Longs, seen: Bools) -> Floats:
    """Return the distances (n, m) between points, in squares, where ``seen`` is True; else inf."""
    d = (p[:, None] - q[None]) / QUARTERS
    return np.where(seen, np.hypot(d[..., 0], d[..., 1]), np.inf)


def labels(mask: Bools, corners: bool) -> Labels:
    """Return the number of each square's part, from 1; parts connect by edges, or also by corners. 0 off the mask."""
    steps = [s for s in product((-1, 0, 1), repeat=2) if s != (0, 0) and (corners or 0 in s)]
    number = np.zeros(mask.shape, np.int32)
    count = 0
    for seed in map(tuple, np.argwhere(mask).tolist()):
        if number[seed]:
            continue
        count += 1
        number[seed] = count
        queue = deque([seed])
        while queue:
            i, j = queue.popleft()
            for a, b in steps:
                u, v = i + a, j + b
                if 0 <= u < mask.shape[0] and 0 <= v < mask.shape[1] and mask[u, v] and not number[u, v]:
                    number[u, v] = count
                    queue.append((u, v))
    return number


def clearances(free: Bools) -> Floats:
    """Return the distance (squares) from each centre to the nearest point of a square that is not free."""
    padded = np.pad(free, 1)
    blocked = np.argwhere(~padded)
    gap = np.maximum(np.abs(np.argwhere(padded)[:, None] - blocked[None]) - 0.5, 0.0)
    out = np.zeros(padded.shape)
    out[padded] = np.sqrt((gap**2).sum(axis=2).min(axis=1))
    return out[1:-1, 1:-1]
