"""Parts of an outline: the legs of an L, T or U, cut off at its inner corners."""

import math
from collections.abc import Iterator
from functools import lru_cache
from itertools import pairwise
from typing import NamedTuple

from shapely import LinearRing, Polygon

from utak.geometry.kernels.arrays import XY

MAX_INNER_CORNERS = 4  # an outline with more has no few parts that a person would name; a convention
TINY = 1e-7  # squares: points so near are one


class _Cut(NamedTuple):
    """A straight cut through a ring of points, from an inner corner to the first side that it meets."""

    length: float
    corner: int  # the index of the inner corner
    side: int  # the index of the point at which the side that it meets begins
    end: XY


@lru_cache(maxsize=1024)  # an outline stays the same over many steps
def parts_of(outline: Polygon) -> tuple[Polygon, ...]:
    """Return the convex parts of an outline, cut along lines that go on from its sides; () for one.

    A line from inner corner to inner corner comes first, then the shortest.
    """
    ring = _ring(outline)
    if outline.interiors or not 1 <= sum(1 for _ in _inner_corners(ring)) <= MAX_INNER_CORNERS:
        return ()
    return tuple(Polygon(part) for part in sorted(_convex(ring), key=min))


def _ring(outline: Polygon) -> list[XY]:
    """Return the corners of an outline counter-clockwise, without those on a straight side."""
    points = [(float(x), float(y)) for x, y in outline.exterior.coords][:-1]
    if not LinearRing(points).is_ccw:
        points.reverse()
    return _without_straight(points)


def _without_straight(points: list[XY]) -> list[XY]:
    """Return the points of a ring at which it turns."""
    return [point for n, point in enumerate(points) if abs(_turn(points, n)) > TINY]


def _turn(ring: list[XY], n: int) -> float:
    """Return twice the signed area of a corner and its neighbours: negative at inner corners."""
    (ax, ay), (bx, by), (cx, cy) = ring[n - 1], ring[n], ring[(n + 1) % len(ring)]
    return (bx - ax) * (cy - by) - (by - ay) * (cx - bx)


def _inner_corners(ring: list[XY]) -> Iterator[int]:
    """Yield the indices of the inner corners of a ring."""
    return (n for n in range(len(ring)) if _turn(ring, n) < -TINY)


def _convex(ring: list[XY]) -> list[list[XY]]:
    """Return a ring cut into convex ones."""
    cuts = [cut for n in _inner_corners(ring) for before in (-1, 1) if (cut := _cut(ring, n, before)) is not None]
    if not cuts:
        return [ring]
    inner = [ring[n] for n in _inner_corners(ring)]

    def cost(cut: _Cut) -> tuple[bool, float, XY]:
        """Return what makes a cut worse: it leads to no other inner corner, and is long."""
        return not any(math.dist(cut.end, corner) < TINY for corner in inner), round(cut.length, 6), ring[cut.corner]

    best = min(cuts, key=cost)
    return [part for half in _halves(ring, best) for part in _convex(half)]


def _cut(ring: list[XY], n: int, before: int) -> _Cut | None:
    """Return the cut that goes on from the side before (-1) or behind (1) an inner corner; None where none ends."""
    (x, y), (px, py) = ring[n], ring[(n + before) % len(ring)]
    size = math.hypot(x - px, y - py)
    dx, dy = (x - px) / size, (y - py) / size
    found = []
    for side, ((ax, ay), (bx, by)) in enumerate(pairwise([*ring, ring[0]])):
        ex, ey = bx - ax, by - ay
        across = dx * ey - dy * ex
        if n in (side, (side + 1) % len(ring)) or abs(across) < TINY:
            continue
        along = ((ax - x) * ey - (ay - y) * ex) / across
        share = ((ax - x) * dy - (ay - y) * dx) / across
        if along > TINY and -TINY <= share <= 1 + TINY:
            found.append(_Cut(along, n, side, (x + along * dx, y + along * dy)))
    return min(found, key=lambda cut: cut.length, default=None)


def _halves(ring: list[XY], cut: _Cut) -> Iterator[list[XY]]:
    """Yield the two rings into which a cut divides a ring."""
    turned = [*ring[cut.corner :], *ring[: cut.corner]]
    side = (cut.side - cut.corner) % len(ring)
    for part in ([*turned[: side + 1], cut.end], [cut.end, *turned[side + 1 :], turned[0]]):
        apart = [point for point, other in zip(part, [part[-1], *part], strict=False) if math.dist(point, other) > TINY]
        yield _without_straight(apart)
