"""Screens that resemble the benchmark maps of Moving AI (Sturtevant 2012) but are none of them, by kind and seed.

    python tests/geometry/lookalikes.py FOLDER

writes a set of them as .map files, for ``python -m benchmarks.screens FOLDER``.
"""

import sys
from pathlib import Path

import numpy as np

from utak.geometry.raster.components import components

KINDS = ("city", "maze", "rooms", "noise", "warehouse", "caves", "plain", "islands", "diagonals")


def lookalike(kind, size, seed=0, scale=8):
    """Return a screen (size, size) bool, True where it is free.

    ``scale``: width of rooms and corridors, in squares; of noise the percentage of blocked squares.

    >>> lookalike("rooms", 17, scale=7).shape
    (17, 17)
    """
    free = MAKERS[kind](size, np.random.default_rng([seed, size, KINDS.index(kind)]), scale)
    assert free.shape == (size, size) and free.any()
    return free


def city(size, rng, _):
    """Return houses of all sizes in blocks between streets, some rotated."""
    free = np.ones((size, size), bool)
    y, x = np.mgrid[:size, :size]
    for _ in range(max(4, size * size // 900)):
        a, b = rng.integers(4, 24, 2)
        cx, cy = rng.integers(0, size, 2)
        angle = rng.choice([0.0, 0.0, 0.3, 0.8])
        reach = int(a + b)
        box = slice(max(0, cy - reach), cy + reach), slice(max(0, cx - reach), cx + reach)
        u, v = x[box] - cx, y[box] - cy
        c, s = np.cos(angle), np.sin(angle)
        free[box] &= ~((abs(c * u + s * v) < a / 2) & (abs(c * v - s * u) < b / 2))
    for _ in range(3 + size // 128):  # streets through everything
        k, w = int(rng.integers(0, size)), int(rng.integers(2, 8))
        free[k : k + w] = True
        k = int(rng.integers(0, size))
        free[:, k : k + w] = True
    return free


def maze(size, rng, scale):
    """Return a spanning tree of corridors ``scale`` squares wide."""
    pitch = scale + 1
    n = max(1, (size - 1) // pitch)
    free = np.zeros((size, size), bool)
    seen = np.zeros((n, n), bool)
    stack = [(0, 0)]
    seen[0, 0] = True
    free[1 : 1 + scale, 1 : 1 + scale] = True
    while stack:
        i, j = stack[-1]
        steps = [(a, b) for a, b in ((i + 1, j), (i - 1, j), (i, j + 1), (i, j - 1)) if 0 <= a < n and 0 <= b < n]
        steps = [step for step in steps if not seen[step]]
        if not steps:
            stack.pop()
            continue
        a, b = steps[rng.integers(len(steps))]
        seen[a, b] = True
        stack.append((a, b))
        low, left = 1 + pitch * min(i, a), 1 + pitch * min(j, b)
        free[low : 1 + pitch * max(i, a) + scale, left : 1 + pitch * max(j, b) + scale] = True
    return free


def rooms(size, rng, scale):
    """Return square rooms with a door of one square in most walls."""
    free = np.ones((size, size), bool)
    pitch = scale + 1
    free[::pitch] = free[:, ::pitch] = False
    for i in range(0, size, pitch):
        for j in range(0, size, pitch):
            if rng.random() < 0.9 and j + scale < size and i:
                free[i, j + 1 + rng.integers(scale)] = True
            if rng.random() < 0.9 and i + scale < size and j:
                free[i + 1 + rng.integers(scale), j] = True
    return free


def noise(size, rng, scale):
    """Return a floor with ``scale`` per cent of its squares blocked at random."""
    free = rng.random((size, size)) * 100.0 >= scale
    free[0, 0] = True
    return free


def warehouse(size, rng, scale):
    """Return rows of shelves, ``scale`` squares long and two deep, with aisles one or two wide."""
    free = np.ones((size, size), bool)
    for i in range(5, size - 4, int(rng.integers(3, 5))):
        for j in range(8, size - scale - 4, scale + 2):
            free[i : i + 2, j : j + scale] = False
    return free


def caves(size, rng, scale):
    """Return winding floors with ragged walls, as in games."""
    height = smooth(rng.normal(size=(size, size)), scale) * scale
    height += 0.4 * smooth(rng.normal(size=(size, size)), 2) * 2
    free = height > -0.02
    free[size // 2, size // 2] = True
    return free


def smooth(field, sigma):
    """Return a field blurred by a Gaussian of ``sigma`` squares, periodic at its borders."""
    rows, columns = (np.fft.fftfreq(n) for n in field.shape)
    blur = np.exp(-2 * (np.pi * sigma) ** 2 * (rows[:, None] ** 2 + columns**2))
    return np.fft.ifft2(np.fft.fft2(field) * blur).real


def plain(size, rng, scale):
    """Return a wide open floor with few things on it."""
    free = np.ones((size, size), bool)
    for _ in range(max(1, size // 32)):
        a, b = rng.integers(0, size, 2)
        free[a : a + rng.integers(1, scale + 1), b : b + rng.integers(1, scale + 1)] = False
    free[0, 0] = True
    return free


def islands(size, rng, scale):
    """Return caves with the small parts filled and ponds in the large ones, as in strategy games."""
    free = caves(size, rng, 2 * scale)
    parts = components(free).labels
    sizes = np.bincount(parts.ravel())
    keep = sizes >= min(64, sizes[1:].max())
    keep[0] = False
    free = keep[parts]
    spots = rng.integers(0, size, (size // 8, 2))
    for a, b in spots:
        free[a : a + 3, b : b + 2] = False
    free[size // 2, size // 2] = True
    return free


def diagonals(size, rng, scale):
    """Return slanting walls, with gaps, of squares that touch at corners alone."""
    y, x = np.mgrid[:size, :size]
    free = ((x + y) % (2 * scale) != 0) | (rng.random((size, size)) < 0.1)
    free &= ((x - y) % (3 * scale) != 0) | (rng.random((size, size)) < 0.2)
    return free


MAKERS = dict(zip(KINDS, (city, maze, rooms, noise, warehouse, caves, plain, islands, diagonals), strict=True))
SET = (
    ("city", 256, 8),
    ("city", 512, 8),
    ("city", 1024, 8),
    ("maze", 32, 2),
    ("maze", 128, 10),
    ("maze", 512, 1),
    ("maze", 512, 8),
    ("maze", 512, 16),
    ("rooms", 32, 4),
    ("rooms", 512, 16),
    ("rooms", 512, 32),
    ("rooms", 1024, 8),
    ("noise", 32, 10),
    ("noise", 32, 20),
    ("noise", 64, 20),
    ("noise", 512, 15),
    ("noise", 512, 35),
    ("noise", 512, 40),
    ("warehouse", 160, 10),
    ("warehouse", 400, 20),
    ("caves", 194, 4),
    ("caves", 512, 6),
    ("caves", 1024, 10),
    ("plain", 8, 1),
    ("plain", 48, 1),
    ("plain", 512, 12),
    ("islands", 512, 8),
    ("islands", 768, 10),
    ("islands", 1024, 12),
    ("diagonals", 256, 9),
)


def write_map(path, free):
    """Write a .map file: the first row of text is the north edge."""
    rows, columns = free.shape
    lines = ["".join(".@"[int(not square)] for square in row) for row in free[::-1]]
    path.write_text("\n".join(["type octile", f"height {rows}", f"width {columns}", "map", *lines]) + "\n")


def main(folder):
    """Write the set of screens as .map files to a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    for kind, size, scale in SET:
        write_map(folder / f"{kind}-{size}-{scale}.map", lookalike(kind, size, 1, scale))


if __name__ == "__main__":
    main(Path(sys.argv[1]))
