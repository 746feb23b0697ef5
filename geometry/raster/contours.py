"""Contours: the boundary of a region of squares as rings of straight segments along grid lines."""

import numpy as np
from numpy.typing import NDArray

GridCorner = tuple[int, int]  # (x, y) of a corner of squares, in grid units; also a unit step between two of them
Ring = tuple[GridCorner, ...]  # a closed polyline, its first corner not repeated


def outline(mask: NDArray[np.bool_]) -> list[Ring]:
    """Return the boundary rings of the True squares of a mask.

    Examples
    --------
    >>> outline(np.array([[True, True]]))
    [((0, 0), (2, 0), (2, 1), (0, 1))]
    """
    outgoing = _outgoing_edges(mask)
    return sorted(
        _normalise(_pop_ring(corner, outgoing)) for corner in sorted(outgoing) for _ in outgoing.get(corner, [])[:1]
    )


def _pop_ring(start: GridCorner, outgoing: dict[GridCorner, list[GridCorner]]) -> list[GridCorner]:
    """Follow the boundary from a corner until it closes, and return the corners (x, y) of its turns, with the start."""
    ring, here, direction = [start], start, min(outgoing[start])
    while True:
        outgoing[here].remove(direction)
        here = (here[0] + direction[0], here[1] + direction[1])
        turn = _leftmost(direction, outgoing[here])
        if turn is None:
            return ring
        if turn != direction:
            ring.append(here)
        direction = turn


def _outgoing_edges(mask: NDArray[np.bool_]) -> dict[GridCorner, list[GridCorner]]:
    """Return for each corner the directions of the boundary edges that leave it, with the region on their left."""
    framed = np.pad(mask, 1)
    inner = framed[1:-1, 1:-1]
    sides = (
        (inner & ~framed[:-2, 1:-1], (0, 0), (1, 0)),
        (inner & ~framed[1:-1, 2:], (1, 0), (0, 1)),
        (inner & ~framed[2:, 1:-1], (1, 1), (-1, 0)),
        (inner & ~framed[1:-1, :-2], (0, 1), (0, -1)),
    )
    outgoing: dict[GridCorner, list[GridCorner]] = {}
    for boundary, (dx, dy), direction in sides:
        rows, columns = np.nonzero(boundary)
        for x, y in zip((columns + dx).tolist(), (rows + dy).tolist(), strict=True):
            outgoing.setdefault((x, y), []).append(direction)
    return outgoing


def _leftmost(direction: GridCorner, choices: list[GridCorner]) -> GridCorner | None:
    """Return the one of `choices` that turns furthest to the left, which stays with the same square; None if empty."""
    dx, dy = direction
    for turn in ((-dy, dx), (dx, dy), (dy, -dx)):
        if turn in choices:
            return turn
    return None


def _normalise(ring: list[GridCorner]) -> Ring:
    """Return the ring as a tuple, without corners on straight stretches, rotated to begin at its least corner."""
    count = len(ring)
    kept = [
        corner
        for i, corner in enumerate(ring)
        if not (ring[i - 1][0] == corner[0] == ring[(i + 1) % count][0])
        and not (ring[i - 1][1] == corner[1] == ring[(i + 1) % count][1])
    ]
    first = kept.index(min(kept))
    return tuple(kept[first:] + kept[:first])
