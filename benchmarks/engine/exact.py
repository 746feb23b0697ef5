"""Exact answers about small floors, by brute force and in whole numbers; nothing here uses the code under test.

Points are (x, y) in squares and multiples of a quarter. A point on a line between squares belongs to the square north-
east of it. Two blocked squares that touch at a corner block the way between them.
"""

from collections import deque
from collections.abc import Sequence
from functools import cached_property
from itertools import pairwise, product

import numpy as np
from numpy.typing import NDArray

Bools = NDArray[np.bool_]
Floats = NDArray[np.float64]
Whole = NDArray[np.int64]
XY = tuple[float, float]
PARTS = 4  # of a square: the points' grid


class Exact:
    """A floor with an exact visibility graph. free : (rows, columns) bool."""

    def __init__(self, free: Bools) -> None:
        self.free = free
        self.padded = np.pad(free, 1)

    @cached_property
    def blocked(self) -> Whole:
        """(n, 2) lower corners of the blocked squares and of those around the floor, in parts."""
        return PARTS * (np.argwhere(~self.padded)[:, ::-1] - 1)

    def _corners(self, blocked: int, diagonal: bool) -> Whole:
        """Corners with so many blocked squares about them; two of them only where they lie across."""
        p = self.padded
        about = np.stack([p[:-1, :-1], p[1:, 1:], p[1:, :-1], p[:-1, 1:]])
        chosen = (~about).sum(axis=0) == blocked
        if diagonal:
            chosen &= (about[0] == about[1]) & (about[2] == about[3])
        return PARTS * np.argwhere(chosen)[:, ::-1]

    @cached_property
    def corners(self) -> Whole:
        """(n, 2) where the shortest ways may bend, in parts."""
        return self._corners(1, False)

    @cached_property
    def pinches(self) -> Whole:
        """(n, 2) where two blocked squares touch at a corner, in parts."""
        return self._corners(2, True)

    @cached_property
    def seams(self) -> tuple[Whole, Whole]:
        """The lower ends of the upright and of the level edges between two blocked squares, in parts."""
        wall = ~self.padded
        upright = np.argwhere(wall[:, 1:] & wall[:, :-1])[:, ::-1] - (0, 1)
        level = np.argwhere(wall[1:] & wall[:-1])[:, ::-1] - (1, 0)
        return PARTS * upright, PARTS * level

    def sees(self, p: Whole, q: Whole) -> Bools:
        """(n, m) whether the segments between points (n, 2) and (m, 2), in parts, stay in free space."""
        a, b = p[:, None, None, :], q[None, :, None, :]
        d = b - a
        low, high = np.minimum(a, b), np.maximum(a, b)
        box = self.blocked[None, None]
        apart = ((high <= box) | (low >= box + PARTS)).any(axis=3)
        sides = [cross(d, box + PARTS * np.array(side) - a) for side in ((0, 0), (0, 1), (1, 0), (1, 1))]
        apart |= (np.min(sides, axis=0) >= 0) | (np.max(sides, axis=0) <= 0)
        open_ = apart.all(axis=2)
        for axis, seam in enumerate(self.seams):
            ends = seam[None, None]
            along = (a[..., axis] == b[..., axis]) & (a[..., axis] == ends[..., axis])
            other = 1 - axis
            over = (low[..., other] < ends[..., other] + PARTS) & (high[..., other] > ends[..., other])
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
        """(n, n) lengths of the segments between corners; infinite where they do not see each other."""
        return lengths(self.corners, self.corners, self.sees(self.corners, self.corners))

    def distances(self, start: XY, goals: Sequence[XY]) -> Floats:
        """(n,) exact lengths of the shortest ways from a point to others; infinite where there is none."""
        p, q = parts([start]), parts(goals)
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
        """Whether a polyline, all of whose points are corners or multiples of a quarter, stays in free space."""
        q = parts(points.tolist())
        return all(bool(self.sees(q[k : k + 1], q[k + 1 : k + 2])[0, 0]) for k in range(len(q) - 1))

    @cached_property
    def _rays(self) -> list[XY]:
        """A point in each bounded group of blocked squares, from which a ray runs north."""
        number = labels(~self.padded, corners=True)
        outer = number[0, 0]
        found = []
        for k in range(1, int(number.max()) + 1):
            if k != outer:
                row, column = np.argwhere(number == k)[0] - 1
                found.append((float(column) + 0.51 + 0.0001 * k, float(row) + 0.5))
        return found

    def word(self, points: Floats) -> tuple[int, ...]:
        """The homotopy class of a polyline between its ends: the rays that it crosses, without what cancels."""
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


def parts(points: Sequence[Sequence[float]]) -> Whole:
    """Points in whole parts of a square."""
    scaled = PARTS * np.array(points, np.float64).reshape(-1, 2)
    rounded = np.round(scaled).astype(np.int64)
    if (rounded != scaled).any():
        raise ValueError("points must be multiples of a quarter")
    return rounded


def cross(a: Whole, b: Whole) -> Whole:
    """The cross products of vectors along the last axis."""
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def lengths(p: Whole, q: Whole, seen: Bools) -> Floats:
    """(n, m) distances in squares where the points see each other; else infinite."""
    d = (p[:, None] - q[None]) / PARTS
    return np.where(seen, np.hypot(d[..., 0], d[..., 1]), np.inf)


def labels(mask: Bools, corners: bool) -> NDArray[np.int32]:
    """Numbers from 1 of the parts connected by edges, or also by corners; 0 outside the mask."""
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
    """Distance from each centre to the nearest point of a square that is not free."""
    padded = np.pad(free, 1)
    blocked = np.argwhere(~padded)
    gap = np.maximum(np.abs(np.argwhere(padded)[:, None] - blocked[None]) - 0.5, 0.0)
    out = np.zeros(padded.shape)
    out[padded] = np.sqrt((gap**2).sum(axis=2).min(axis=1))
    return out[1:-1, 1:-1]
