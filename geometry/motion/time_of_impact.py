"""Times of impact: when corners of a moving body meet edges, along straight lines or arcs. Plain loops for numba.

Rows of edges are x0, y0, x1, y1, outward unit normal x and y, length (see first_contact.with_normals). The time of a
push counts from 0 to 1 over its vector. The time of a turn is the angle turned in radians, always positive.
"""

import math
from typing import NamedTuple

import numpy as np

from utak.geometry.kernels.arrays import Floats
from utak.geometry.kernels.jit import bare, compiled
from utak.geometry.motion.cell_clearance import squared_distance_to_edge


class Surface(NamedTuple):
    """The boundary that a moving body must not cross. Squares, table frame."""

    hull: Floats  # (n, 7) edges of closed rings
    # (n, 7) the same rings drawn inward by the skin's depth, row for row. A motion is stopped by the skin, at the edge
    # above it.
    skin: Floats
    # (k, 6) rows first, stop, x0, y0, x1, y1: ranges of rows of `hull` and their bounding boxes, for the broad phase
    chunks: Floats
    edges: Floats  # (m, 7) true edges of the obstacles. They equal `hull` but for points (see first_contact.Obstacles).


SkinHit = tuple[float, int, int, int]
"""Time of impact; 0 for none, 1 for a corner of the body on an edge, 2 for an edge of the body on a corner; index of
that corner or edge of the body; index of the edge of the skin (of the corner: the edge that begins there)."""

NO_IMPACT = 1e9  # a time or angle later than the end of any motion
EDGE_END_TOLERANCE = 1e-9  # squares: an edge reaches this far beyond its ends, so that nothing slips between two edges
ENTRY_DEPTH_TOLERANCE = 1e-11  # squares: a point at most this deep behind an edge meets it at once; bounds rounding
BROAD_PHASE_MARGIN = 1e-6  # squares: by how much the boxes of the broad phase are enlarged; bounds skin and rounding
MAX_SKIN_OFFSET = 1e-6  # squares from an edge to its skin, at most: mitred corners are 45 skin depths away, 4.5e-7
MIN_APPROACH = 1e-12  # squares: a component of motion towards an edge below this is taken for rounding
COSINE_TOLERANCE = 1e-9  # squares squared: by how much the cosine test must be surpassed; bounds rounding
FULL_TURN = 2 * math.pi  # radians


@bare
def push_impact_time(x: float, y: float, dx: float, dy: float, edges: Floats, j: int) -> float:
    """Return when the point (x, y), pushed by (dx, dy), enters through edge j: 0 to 1, or NO_IMPACT (1e9)."""
    nx, ny = edges[j, 4], edges[j, 5]
    ahead = nx * dx + ny * dy
    if ahead >= 0.0:
        return NO_IMPACT
    px, py = x - edges[j, 0], y - edges[j, 1]
    above = nx * px + ny * py
    if above + ahead > 0.0:
        return NO_IMPACT
    time = -above / ahead
    if above < 0.0:
        if above < -ENTRY_DEPTH_TOLERANCE or ahead > -MIN_APPROACH:
            return NO_IMPACT
        time = 0.0
    along = nx * (py + time * dy) - ny * (px + time * dx)
    if along < -EDGE_END_TOLERANCE or along > edges[j, 6] + EDGE_END_TOLERANCE:
        return NO_IMPACT
    return float(time)


@bare
def turn_impact_angle(
    x: float, y: float, cx: float, cy: float, sign: float, edges: Floats, j: int, until: float, cosine: float
) -> float:
    """Return after how many radians the point (x, y), turning about (cx, cy), enters through edge j, or NO_IMPACT."""
    nx, ny = edges[j, 4], edges[j, 5]
    hx, hy = cx - edges[j, 0], cy - edges[j, 1]
    h = nx * hx + ny * hy
    qx, qy = x - cx, y - cy
    half2 = qx * qx + qy * qy - h * h
    if half2 <= 0.0:
        return NO_IMPACT
    up, across = nx * qx + ny * qy, nx * qy - ny * qx
    foot = nx * hy - ny * hx
    if -ENTRY_DEPTH_TOLERANCE < h + up < 1e-13 and sign * across > MIN_APPROACH:
        at_once = foot + across
        return 0.0 if -EDGE_END_TOLERANCE <= at_once <= edges[j, 6] + EDGE_END_TOLERANCE else NO_IMPACT
    half = sign * math.sqrt(half2)
    along = foot + half
    if along < -EDGE_END_TOLERANCE or along > edges[j, 6] + EDGE_END_TOLERANCE:
        return NO_IMPACT
    high, wide = sign * (up * half + across * h), across * half - up * h
    late = wide - cosine * (qx * qx + qy * qy)
    if (high < 0.0 or late < -COSINE_TOLERANCE) if until <= math.pi else (high < 0.0 and late > COSINE_TOLERANCE):
        return NO_IMPACT
    time = math.atan2(high, wide)
    return time if time >= 0.0 else time + FULL_TURN


@bare
def first_push_contact(corners: Floats, body_edges: Floats, surface: Surface, dx: float, dy: float) -> float:
    """Return the part of a push by (dx, dy) that a body travels before its first contact, 0 to 1."""
    hull, skin, chunks, edges = surface
    time, kind, i, j = first_push_skin_hit(corners, body_edges, hull, skin, chunks, dx, dy)
    if kind == 0:
        return 1.0
    if kind == 1:
        return _last_push_entry(corners[i, 0], corners[i, 1], dx, dy, edges, time)
    return _last_push_entry(hull[j, 0], hull[j, 1], -dx, -dy, body_edges, time)


@bare
def first_push_skin_hit(
    corners: Floats, body_edges: Floats, hull: Floats, skin: Floats, chunks: Floats, dx: float, dy: float
) -> SkinHit:
    """Return the earliest impact of a body pushed by (dx, dy) on the skin, their boundary moved inwards."""
    low_x, low_y, high_x, high_y = _bounding_box(corners)
    low_x += min(dx, 0.0)
    low_y += min(dy, 0.0)
    high_x += max(dx, 0.0)
    high_y += max(dy, 0.0)
    best, kind, at, edge = NO_IMPACT, 0, 0, 0
    for chunk in range(len(chunks)):
        if (
            chunks[chunk, 2] > high_x
            or chunks[chunk, 3] > high_y
            or chunks[chunk, 4] < low_x
            or chunks[chunk, 5] < low_y
        ):
            continue
        for j in range(int(chunks[chunk, 0]), int(chunks[chunk, 1])):
            if max(hull[j, 0], hull[j, 2]) < low_x or min(hull[j, 0], hull[j, 2]) > high_x:
                continue
            if max(hull[j, 1], hull[j, 3]) < low_y or min(hull[j, 1], hull[j, 3]) > high_y:
                continue
            if hull[j, 4] * dx + hull[j, 5] * dy < 0.0:
                for i in range(len(corners)):
                    time = push_impact_time(corners[i, 0], corners[i, 1], dx, dy, skin, j)
                    if time < best:
                        best, kind, at, edge = time, 1, i, j
            x, y = skin[j, 0], skin[j, 1]
            if low_x <= x <= high_x and low_y <= y <= high_y:
                for i in range(len(body_edges)):
                    time = push_impact_time(x, y, -dx, -dy, body_edges, i)
                    if time < best:
                        best, kind, at, edge = time, 2, i, j
    return best, kind, at, edge


@bare
def is_push_clear(points: Floats, edges: Floats, dx: float, dy: float) -> bool:
    """Return whether all points, pushed by (dx, dy), keep further than MAX_SKIN_OFFSET from all edges."""
    near2 = MAX_SKIN_OFFSET**2
    length2 = max(dx * dx + dy * dy, near2)
    for i in range(len(points)):
        x, y = points[i, 0], points[i, 1]
        low_x, high_x = x + min(dx, 0.0) - MAX_SKIN_OFFSET, x + max(dx, 0.0) + MAX_SKIN_OFFSET
        low_y, high_y = y + min(dy, 0.0) - MAX_SKIN_OFFSET, y + max(dy, 0.0) + MAX_SKIN_OFFSET
        for j in range(len(edges)):
            if max(edges[j, 0], edges[j, 2]) < low_x or min(edges[j, 0], edges[j, 2]) > high_x:
                continue
            if max(edges[j, 1], edges[j, 3]) < low_y or min(edges[j, 1], edges[j, 3]) > high_y:
                continue
            x0, y0, x1, y1 = edges[j, 0] - x, edges[j, 1] - y, edges[j, 2] - x, edges[j, 3] - y
            before = edges[j, 4] * x0 + edges[j, 5] * y0
            after = before - edges[j, 4] * dx - edges[j, 5] * dy
            if (x0 * dy > y0 * dx) != (x1 * dy > y1 * dx) and (before > 0.0) != (after > 0.0):
                return False  # the two segments cross; else an end of one of them is nearest to the other
            first = min(max((x0 * dx + y0 * dy) / length2, 0.0), 1.0)
            last = min(max((x1 * dx + y1 * dy) / length2, 0.0), 1.0)
            if (
                (x0 - first * dx) ** 2 + (y0 - first * dy) ** 2 <= near2
                or (x1 - last * dx) ** 2 + (y1 - last * dy) ** 2 <= near2
                or squared_distance_to_edge(x, y, edges, j) <= near2
                or squared_distance_to_edge(x + dx, y + dy, edges, j) <= near2
            ):
                return False
    return True


@bare
def _last_push_entry(x: float, y: float, dx: float, dy: float, edges: Floats, until: float) -> float:
    """Return the time of the last entry through the true edges up to the time `until`; 0 for none."""
    last = -1.0
    x1, y1 = x + until * dx, y + until * dy
    low_x, low_y, high_x, high_y = (
        min(x, x1) - EDGE_END_TOLERANCE,
        min(y, y1) - EDGE_END_TOLERANCE,
        max(x, x1) + EDGE_END_TOLERANCE,
        max(y, y1) + EDGE_END_TOLERANCE,
    )
    for k in range(len(edges)):
        if max(edges[k, 0], edges[k, 2]) < low_x or min(edges[k, 0], edges[k, 2]) > high_x:
            continue
        if max(edges[k, 1], edges[k, 3]) < low_y or min(edges[k, 1], edges[k, 3]) > high_y:
            continue
        time = push_impact_time(x, y, dx, dy, edges, k)
        if last < time <= until:
            last = time
    return last if last >= 0.0 else 0.0


@bare
def first_turn_contact(
    corners: Floats, body_edges: Floats, surface: Surface, turn: float, cx: float, cy: float
) -> float:
    """Return the part of a turn about (cx, cy), in radians, that a body travels before its first contact, 0 to 1."""
    hull, skin, chunks, edges = surface
    sign = 1.0 if turn >= 0.0 else -1.0
    time, kind, i, j = first_turn_skin_hit(corners, body_edges, hull, skin, chunks, cx, cy, sign, abs(turn))
    if kind == 0:
        return 1.0
    if kind == 1:
        return _last_turn_entry(corners[i, 0], corners[i, 1], cx, cy, sign, edges, time) / abs(turn)
    return _last_turn_entry(hull[j, 0], hull[j, 1], cx, cy, -sign, body_edges, time) / abs(turn)


@bare
def first_turn_skin_hit(
    corners: Floats,
    body_edges: Floats,
    hull: Floats,
    skin: Floats,
    chunks: Floats,
    cx: float,
    cy: float,
    sign: float,
    limit: float,
) -> SkinHit:
    """Return the earliest impact on the skin of a body that turns about (cx, cy) by at most `limit` radians."""
    low, high = _squared_annulus(corners, body_edges, cx, cy)
    low_x, low_y, high_x, high_y = _turn_bounds(corners, cx, cy, sign, limit)
    best, kind, at, edge = limit, 0, 0, 0
    cosine = math.cos(limit) if limit < FULL_TURN else 1.0
    for chunk in range(len(chunks)):
        x0, y0, x1, y1 = chunks[chunk, 2] - cx, chunks[chunk, 3] - cy, chunks[chunk, 4] - cx, chunks[chunk, 5] - cy
        if x0 > high_x or y0 > high_y or x1 < low_x or y1 < low_y:
            continue
        off_x, off_y = max(x0, -x1, 0.0), max(y0, -y1, 0.0)
        far_x, far_y = max(-x0, x1), max(-y0, y1)
        if off_x * off_x + off_y * off_y > high or far_x * far_x + far_y * far_y < low:
            continue
        for j in range(int(chunks[chunk, 0]), int(chunks[chunk, 1])):
            x0, y0, x1, y1 = skin[j, 0] - cx, skin[j, 1] - cy, skin[j, 2] - cx, skin[j, 3] - cy
            if min(x0, x1) > high_x or min(y0, y1) > high_y or max(x0, x1) < low_x or max(y0, y1) < low_y:
                continue
            here, there = x0 * x0 + y0 * y0, x1 * x1 + y1 * y1
            if max(here, there) >= low and squared_distance_to_edge(cx, cy, skin, j) <= high:
                for i in range(len(corners)):
                    time = turn_impact_angle(corners[i, 0], corners[i, 1], cx, cy, sign, skin, j, best, cosine)
                    if time < best:
                        best, kind, at, edge = time, 1, i, j
                        cosine = math.cos(best)
            if low <= here <= high:
                for i in range(len(body_edges)):
                    time = turn_impact_angle(skin[j, 0], skin[j, 1], cx, cy, -sign, body_edges, i, best, cosine)
                    if time < best:
                        best, kind, at, edge = time, 2, i, j
                        cosine = math.cos(best)
    return best, kind, at, edge


@bare
def _squared_annulus(corners: Floats, body_edges: Floats, cx: float, cy: float) -> tuple[float, float]:
    """Return the squares of the least and greatest distance of a body's boundary from (cx, cy), with a margin."""
    low, high = 1e18, 0.0
    for i in range(len(corners)):
        away = (corners[i, 0] - cx) ** 2 + (corners[i, 1] - cy) ** 2
        low, high = min(low, away), max(high, away)
    for i in range(len(body_edges)):
        low = min(low, squared_distance_to_edge(cx, cy, body_edges, i))
    return (max(math.sqrt(low) - BROAD_PHASE_MARGIN, 0.0)) ** 2, (math.sqrt(high) + BROAD_PHASE_MARGIN) ** 2


@bare
def _turn_bounds(corners: Floats, cx: float, cy: float, sign: float, limit: float) -> tuple[float, float, float, float]:
    """Return x0, y0, x1, y1, relative to (cx, cy) and with a margin, of the box that a turn keeps the corners in."""
    c, s = math.cos(limit), sign * math.sin(limit)
    low_x = low_y = high_x = high_y = 0.0
    for i in range(len(corners)):
        x, y = corners[i, 0] - cx, corners[i, 1] - cy
        u, v = c * x - s * y, s * x + c * y
        x0, y0, x1, y1 = min(x, u), min(y, v), max(x, u), max(y, v)
        away = math.sqrt(x * x + y * y)
        if _passes_direction(x, -sign * y, away, c, limit):
            x1 = away
        if _passes_direction(-x, sign * y, away, c, limit):
            x0 = -away
        if _passes_direction(y, sign * x, away, c, limit):
            y1 = away
        if _passes_direction(-y, -sign * x, away, c, limit):
            y0 = -away
        if i == 0:
            low_x, low_y, high_x, high_y = x0, y0, x1, y1
        low_x, low_y, high_x, high_y = min(low_x, x0), min(low_y, y0), max(high_x, x1), max(high_y, y1)
    return (
        low_x - BROAD_PHASE_MARGIN,
        low_y - BROAD_PHASE_MARGIN,
        high_x + BROAD_PHASE_MARGIN,
        high_y + BROAD_PHASE_MARGIN,
    )


@bare
def _passes_direction(along: float, across: float, away: float, cosine: float, limit: float) -> bool:
    """Return whether a turn by `limit` radians, positive whatever its sense, passes over a direction."""
    if limit >= FULL_TURN:
        return True
    if limit <= math.pi:
        return across >= 0.0 and along >= away * cosine
    return across >= 0.0 or along <= away * cosine


@bare
def _last_turn_entry(x: float, y: float, cx: float, cy: float, sign: float, edges: Floats, until: float) -> float:
    """Return the angle of the last entry through the true edges within `until` radians; 0 for none."""
    last = -1.0
    cosine = math.cos(until) if until < FULL_TURN else 1.0
    for k in range(len(edges)):
        time = turn_impact_angle(x, y, cx, cy, sign, edges, k, until, cosine)
        if last < time <= until:
            last = time
    return last if last >= 0.0 else 0.0


@bare
def _bounding_box(points: Floats) -> tuple[float, float, float, float]:
    """Return x0, y0, x1, y1 of points with a margin: a corner may lie a skin's depth behind an edge."""
    low_x = high_x = points[0, 0]
    low_y = high_y = points[0, 1]
    for i in range(1, len(points)):
        low_x = min(low_x, points[i, 0])
        high_x = max(high_x, points[i, 0])
        low_y = min(low_y, points[i, 1])
        high_y = max(high_y, points[i, 1])
    return (
        low_x - BROAD_PHASE_MARGIN,
        low_y - BROAD_PHASE_MARGIN,
        high_x + BROAD_PHASE_MARGIN,
        high_y + BROAD_PHASE_MARGIN,
    )


@compiled
def push_fractions(corners: Floats, body_edges: Floats, surface: Surface, vectors: Floats) -> Floats:
    """Return the fractions travelled, 0 to 1, for many translations of one body from where it stands."""
    fractions = np.empty(len(vectors))
    for n in range(len(vectors)):
        dx, dy = vectors[n, 0], vectors[n, 1]
        fractions[n] = first_push_contact(corners, body_edges, surface, dx, dy)
    return fractions
