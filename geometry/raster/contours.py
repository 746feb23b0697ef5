"""The outline of a region of squares: rings of straight segments along grid lines."""

import numpy as np
from numpy.typing import NDArray

Corner = tuple[int, int]
Ring = tuple[Corner, ...]


def outline(mask: NDArray[np.bool_]) -> list[Ring]:
    """The boundary rings of the True squares of a (rows, columns) mask.

    Returns
    -------
    Rings of corners (x, y) in grid units, without repeating the first; the region lies on their left, so that outer
    rings run counter-clockwise and
    holes clockwise. Regions are edge-connected: where squares touch at a corner only, their rings stay apart. Rings
    start at their least corner and come in the order of it.

    >>> outline(np.array([[True, True]]))
    [((0, 0), (2, 0), (2, 1), (0, 1))]
    """
    ahead = _edges(mask)
    return sorted(_canonical(_ring(corner, ahead)) for corner in sorted(ahead) for _ in ahead.get(corner, [])[:1])


def _ring(start: Corner, ahead: dict[Corner, list[Corner]]) -> list[Corner]:
    """Follow the boundary from a corner until it closes, and take its edges away."""
    ring, here, direction = [start], start, min(ahead[start])
    while True:
        ahead[here].remove(direction)
        here = (here[0] + direction[0], here[1] + direction[1])
        turned = _leftmost(direction, ahead[here])
        if turned is None:
            return ring
        if turned != direction:
            ring.append(here)
        direction = turned


def _edges(mask: NDArray[np.bool_]) -> dict[Corner, list[Corner]]:
    """From each corner the directions of the boundary edges that leave it, with the region on their left."""
    framed = np.pad(mask, 1)
    inner = framed[1:-1, 1:-1]
    sides = (
        (inner & ~framed[:-2, 1:-1], (0, 0), (1, 0)),
        (inner & ~framed[1:-1, 2:], (1, 0), (0, 1)),
        (inner & ~framed[2:, 1:-1], (1, 1), (-1, 0)),
        (inner & ~framed[1:-1, :-2], (0, 1), (0, -1)),
    )
    ahead: dict[Corner, list[Corner]] = {}
    for bare, (dx, dy), direction in sides:
        rows, columns = np.nonzero(bare)
        for x, y in zip((columns + dx).tolist(), (rows + dy).tolist(), strict=True):
            ahead.setdefault((x, y), []).append(direction)
    return ahead


def _leftmost(direction: Corner, choices: list[Corner]) -> Corner | None:
    """Of the directions that leave a corner, the one furthest to the left: it stays with the same square."""
    dx, dy = direction
    for turned in ((-dy, dx), (dx, dy), (dy, -dx)):
        if turned in choices:
            return turned
    return None


def _canonical(ring: list[Corner]) -> Ring:
    """Without corners on straight stretches, from the least corner on."""
    count = len(ring)
    kept = [
        corner
        for i, corner in enumerate(ring)
        if not (ring[i - 1][0] == corner[0] == ring[(i + 1) % count][0])
        and not (ring[i - 1][1] == corner[1] == ring[(i + 1) % count][1])
    ]
    first = kept.index(min(kept))
    return tuple(kept[first:] + kept[:first])
