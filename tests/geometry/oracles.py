"""Slow and simple answers to compare with. Nothing here uses the code under test."""

from itertools import product

import numpy as np
from hypothesis import strategies as st


@st.composite
def screens(draw, most=12, fullest=0.6):
    """Random screens with at least one free square; sparse, dense, and empty ones."""
    rows, columns = draw(st.integers(1, most)), draw(st.integers(1, most))
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    free = rng.random((rows, columns)) >= draw(st.sampled_from([0.0, 0.08, 0.25, 0.4, fullest]))
    free[rng.integers(rows), rng.integers(columns)] = True
    return free


def clearance(free):
    """Distance from each centre to the nearest point of a square that is not free."""
    padded = np.pad(free, 1)
    blocked = np.argwhere(~padded)
    out = np.zeros(padded.shape)
    for i, j in np.argwhere(padded):
        gap = np.maximum(np.abs(blocked - (i, j)) - 0.5, 0.0)
        out[i, j] = np.sqrt((gap**2).sum(axis=1).min())
    return out[1:-1, 1:-1]


def to_blocked(free):
    """(rows, columns): how far each square's centre lies from that of the nearest blocked one, or beyond the border."""
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
    """Number of parts connected by edges, or also by corners."""
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
    """Parts of free space (by edges) and bounded parts of the blocked squares (by edges and corners)."""
    padded = np.pad(free, 1)
    return label(padded, corners=False), label(~padded, corners=True) - 1


def corners_of(free):
    """(n, 2) corners (x, y) of the blocked squares and of the screen."""
    padded = np.pad(free, 1)
    rows, columns = free.shape
    out = [(x, y) for y in range(rows + 1) for x in range(columns + 1) if not padded[y : y + 2, x : x + 2].all()]
    return np.array(out, float).reshape(-1, 2)


def rubber_band(points, free):
    """The shortest polyline that a rope through these points shrinks to, corner by corner."""
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
    """The corners that a rope from a over v to b catches on when v lets go."""
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
    """Whether a wall stands between a corner and the line from a to b, right at the corner."""
    t = np.linspace(0, 1, 203)[1:-1, None]
    towards = np.array(a) + t * (np.array(b) - np.array(a)) - c
    near = c + 1e-4 * towards / np.hypot(*towards.T)[:, None]
    cells = np.floor(near).astype(int) + 1
    return bool((~padded[cells[:, 1], cells[:, 0]]).any())


def along(a, b, c):
    return (c[0] - a[0]) * (b[0] - a[0]) + (c[1] - a[1]) * (b[1] - a[1])


def cross(a, b, c):
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def length(points):
    return float(np.hypot(*np.diff(np.array(points), axis=0).T).sum())
