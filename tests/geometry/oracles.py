"""Oracles for tests: slow and simple answers to compare with. Nothing here uses the code under test."""

from itertools import product

import numpy as np
from hypothesis import strategies as st


@st.composite
def screens(draw, most=12, fullest=0.6):
    """Draw random masks (rows, columns) with at least one free square: sparse, dense, and entirely free ones."""
    rows, columns = draw(st.integers(1, most)), draw(st.integers(1, most))
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    free = rng.random((rows, columns)) >= draw(st.sampled_from([0.0, 0.08, 0.25, 0.4, fullest]))
    free[rng.integers(rows), rng.integers(columns)] = True
    return free


def clearance(free):
    """Return the distance, in squares, from each square's centre to the nearest point of one that is not free."""
    padded = np.pad(free, 1)
    blocked = np.argwhere(~padded)
    out = np.zeros(padded.shape)
    for i, j in np.argwhere(padded):
        gap = np.maximum(np.abs(blocked - (i, j)) - 0.5, 0.0)
        out[i, j] = np.sqrt((gap**2).sum(axis=1).min())
    return out[1:-1, 1:-1]


def to_blocked(free):
    """Return the distance from each square's centre to that of the nearest blocked one; blocked beyond the border."""
    framed = np.pad(free, 1)
    rows, columns = framed.shape
    across = np.where(framed, np.inf, 0.0)
    for j in range(1, columns):
        across[:, j] = np.minimum(across[:, j], across[:, j - 1] + 1)
        across[:, -1 - j] = np.minimum(across[:, -1 - j], across[:, -j] + 1)
    away = np.subtract.outer(np.arange(rows), np.arange(rows)) ** 2
    least = np.min([across[k] ** 2 + away[:, k, None] for k in range(rows)], axis=0)
    return np.sqrt(least)[1:-1, 1:-1]


def label(mask, corners):
    """Return the number of parts of a mask that are connected by edges, or also by corners."""
    steps = [s for s in product((-1, 0, 1), repeat=2) if s != (0, 0) and (corners or 0 in s)]
    left = {(int(i), int(j)) for i, j in np.argwhere(mask)}
    count = 0
    while left:
        stack = [left.pop()]
        count += 1
        while stack:
            i, j = stack.pop()
            for a, b in steps:
                if (i + a, j + b) in left:
                    left.remove((i + a, j + b))
                    stack.append((i + a, j + b))
    return count


def components_and_holes(free):
    """Return the numbers of free parts (by edges) and of bounded blocked parts (by edges and corners)."""
    padded = np.pad(free, 1)
    return label(padded, corners=False), label(~padded, corners=True) - 1


def corners_of(free):
    """Return the corners (x, y) of the blocked squares and of the screen: (n, 2)."""
    padded = np.pad(free, 1)
    rows, columns = free.shape
    out = [(x, y) for y in range(rows + 1) for x in range(columns + 1) if not padded[y : y + 2, x : x + 2].all()]
    return np.array(out, float).reshape(-1, 2)


def rubber_band(points, free):
    """Return the polyline that a rope through these points shrinks to, corner by corner."""
    line, corners = [tuple(map(float, p)) for p in points], corners_of(free)
    k = 1
    while k < len(line) - 1:
        a, v, b = line[k - 1 : k + 2]
        detour = hull_between(a, v, b, corners, np.pad(free, 1))
        if detour == [v]:
            k += 1
            continue
        line[k : k + 1] = detour
        k = max(1, k - 1)
    return line


def hull_between(a, v, b, corners, padded):
    """Return the corners that a rope from a over v to b catches on when it is released at v."""
    turn = cross(a, v, b)
    if abs(turn) < 1e-12:
        return []
    sign = 1.0 if turn > 0 else -1.0
    inside = {
        tuple(c)
        for c in corners.tolist()
        if sign * cross(a, v, c) >= -1e-9
        and sign * cross(v, b, c) >= -1e-9
        and sign * cross(b, a, c) > 1e-9
        and catches(a, b, c, padded)
    }
    inside = sorted(inside - {a, b}, key=lambda c: (along(a, b, c), sign * cross(a, b, c)))
    chain = [a]
    for c in [*inside, b]:
        while len(chain) > 1 and sign * cross(chain[-2], chain[-1], c) <= 0:
            chain.pop()
        chain.append(c)
    return chain[1:-1]


def catches(a, b, c, padded):
    """Return whether there is a wall between a corner and the line from a to b, right at the corner."""
    t = np.linspace(0, 1, 203)[1:-1, None]
    towards = np.array(a) + t * (np.array(b) - np.array(a)) - c
    near = c + 1e-4 * towards / np.hypot(*towards.T)[:, None]
    cells = np.floor(near).astype(int) + 1
    return bool((~padded[cells[:, 1], cells[:, 0]]).any())


def along(a, b, c):
    """Return the dot product of b - a and c - a."""
    return (c[0] - a[0]) * (b[0] - a[0]) + (c[1] - a[1]) * (b[1] - a[1])


def cross(a, b, c):
    """Return the cross product of b - a and c - a, positive if c lies to the left."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def length(points):
    """Return the length of a polyline (n, 2)."""
    return float(np.hypot(*np.diff(np.array(points), axis=0).T).sum())
