"""The times of impact behind first contact: corners that run into edges, straight or on arcs. Plain loops for numba.

Rows of edges are x0, y0, x1, y1, outward normal x and y, length (see contact.with_normals). A time counts from 0 to 1
over a push and in radians turned, always positive, over a turn. NEVER is later than any motion's end.
"""

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from geometry.kernels.arrays import Floats
from geometry.kernels.jit import bare, compiled
from geometry.motion.cell_clearance import point_to_edge


class Surface(NamedTuple):
    """What a body runs against.

    hull: the edges of closed rings; skin: the same drawn in, row for row; chunks: (k, 6) rows first, stop, x0, y0, x1,
    y1: runs of a few of these edges and the box around them; edges: the true edges of the obstacles, and owner: whose
    they are. Hull and true edges are the same but for points (see contact.Obstacles).
    """

    hull: Floats
    skin: Floats
    chunks: Floats
    edges: Floats
    owner: npt.NDArray[np.intp]


Found = tuple[float, float, float, int, float, float]  # fraction, place x, y, obstacle or -1, normal x, y
Met = tuple[float, int, int, int]  # time, 0 nothing or 1 corner on edge or 2 edge on corner, index in body, edge

NEVER = 1e9
BESIDE = 1e-9  # an edge reaches this far beyond its ends, so that nothing slips between two edges
BEHIND = 1e-11  # a point up to this deep behind an edge, going in, meets it at once: rounding put it there
MARGIN = 1e-6  # squares: by how much the broad phase looks further than the motion goes
STILL = 1e-12  # going in by less than this is rounding
LATE = 1e-9  # squares^2 by which a cosine must tell that a turn goes on too long
WHOLE_TURN = 2 * math.pi


@bare
def push_impact(x: float, y: float, dx: float, dy: float, edges: Floats, j: int) -> float:
    """When the point (x, y), pushed by (dx, dy), enters through edge j; NEVER when it does not, or not yet by 1."""
    nx, ny = edges[j, 4], edges[j, 5]
    ahead = nx * dx + ny * dy
    if ahead >= 0.0:
        return NEVER
    px, py = x - edges[j, 0], y - edges[j, 1]
    above = nx * px + ny * py
    if above + ahead > 0.0:
        return NEVER
    time = -above / ahead
    if above < 0.0:
        if above < -BEHIND or ahead > -STILL:
            return NEVER
        time = 0.0
    along = nx * (py + time * dy) - ny * (px + time * dx)
    if along < -BESIDE or along > edges[j, 6] + BESIDE:
        return NEVER
    return float(time)


@bare
def turn_impact(
    x: float, y: float, cx: float, cy: float, sign: float, edges: Floats, j: int, until: float, cosine: float
) -> float:
    """When the point (x, y), turning about (cx, cy) with the sign's sense, enters through edge j, in radians turned.

    NEVER when that is not before `until`, whose cosine is given. The circle cuts the edge's line twice and enters at
    one of them: no angle is needed to know where, and only its cosine to know whether it is soon enough.
    """
    nx, ny = edges[j, 4], edges[j, 5]
    hx, hy = cx - edges[j, 0], cy - edges[j, 1]
    h = nx * hx + ny * hy
    qx, qy = x - cx, y - cy
    half2 = qx * qx + qy * qy - h * h
    if half2 <= 0.0:
        return NEVER
    up, across = nx * qx + ny * qy, nx * qy - ny * qx
    foot = nx * hy - ny * hx
    if -BEHIND < h + up < 1e-13 and sign * across > STILL:
        at_once = foot + across
        return 0.0 if -BESIDE <= at_once <= edges[j, 6] + BESIDE else NEVER
    half = sign * math.sqrt(half2)
    along = foot + half
    if along < -BESIDE or along > edges[j, 6] + BESIDE:
        return NEVER
    high, wide = sign * (up * half + across * h), across * half - up * h
    late = wide - cosine * (qx * qx + qy * qy)
    if (high < 0.0 or late < -LATE) if until <= math.pi else (high < 0.0 and late > LATE):
        return NEVER
    time = math.atan2(high, wide)
    return time if time >= 0.0 else time + WHOLE_TURN


@bare
def first_push(corners: Floats, body: Floats, surface: Surface, dx: float, dy: float) -> Found:
    """First contact of a pushed body."""
    hull, skin, chunks, edges, owner = surface
    time, kind, i, j = push_through_skin(corners, body, hull, skin, chunks, dx, dy)
    if kind == 0:
        return 1.0, 0.0, 0.0, -1, 0.0, 0.0
    if kind == 1:
        x, y = corners[i, 0], corners[i, 1]
        at, k = _last_push(x, y, dx, dy, edges, time)
        return float(at), float(x + at * dx), float(y + at * dy), int(owner[k]), float(edges[k, 4]), float(edges[k, 5])
    x, y = hull[j, 0], hull[j, 1]
    at, k = _last_push(x, y, -dx, -dy, body, time)
    return float(at), float(x), float(y), int(owner[j]), float(-body[k, 4]), float(-body[k, 5])


@bare
def push_through_skin(
    corners: Floats, body: Floats, hull: Floats, skin: Floats, chunks: Floats, dx: float, dy: float
) -> Met:
    """The earliest impact of a pushed body on the skins."""
    low_x, low_y, high_x, high_y = _bounds(corners)
    low_x += min(dx, 0.0)
    low_y += min(dy, 0.0)
    high_x += max(dx, 0.0)
    high_y += max(dy, 0.0)
    best, kind, at, edge = NEVER, 0, 0, 0
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
                    time = push_impact(corners[i, 0], corners[i, 1], dx, dy, skin, j)
                    if time < best:
                        best, kind, at, edge = time, 1, i, j
            x, y = skin[j, 0], skin[j, 1]
            if low_x <= x <= high_x and low_y <= y <= high_y:
                for i in range(len(body)):
                    time = push_impact(x, y, -dx, -dy, body, i)
                    if time < best:
                        best, kind, at, edge = time, 2, i, j
    return best, kind, at, edge


@bare
def _last_push(x: float, y: float, dx: float, dy: float, edges: Floats, until: float) -> tuple[float, int]:
    """The last entry through the true edges up to a time, and by which; at once by the nearest when there is none."""
    last, by = 0.0, -1
    x1, y1 = x + until * dx, y + until * dy
    low_x, low_y, high_x, high_y = min(x, x1) - BESIDE, min(y, y1) - BESIDE, max(x, x1) + BESIDE, max(y, y1) + BESIDE
    for k in range(len(edges)):
        if max(edges[k, 0], edges[k, 2]) < low_x or min(edges[k, 0], edges[k, 2]) > high_x:
            continue
        if max(edges[k, 1], edges[k, 3]) < low_y or min(edges[k, 1], edges[k, 3]) > high_y:
            continue
        time = push_impact(x, y, dx, dy, edges, k)
        if time <= until and (time > last or by < 0):
            last, by = time, k
    if by < 0:
        by = _nearest_ahead(x, y, dx, dy, 0.0, 0.0, edges)
    return last, by


@bare
def _nearest_ahead(x: float, y: float, dx: float, dy: float, bend_x: float, bend_y: float, edges: Floats) -> int:
    """The edge nearest to a point among those that face its velocity (dx, dy) or, along it, what bends its way."""
    best, at = math.inf, 0
    for k in range(len(edges)):
        nx, ny = edges[k, 4], edges[k, 5]
        ahead = nx * dx + ny * dy
        if ahead < 0.0 or (ahead < STILL and nx * bend_x + ny * bend_y < 0.0):
            px, py = x - edges[k, 0], y - edges[k, 1]
            along = nx * py - ny * px
            off = along - min(max(along, 0.0), edges[k, 6])
            d2 = (nx * px + ny * py) ** 2 + off * off
            if d2 < best:
                best, at = d2, k
    return at


@bare
def first_turn(corners: Floats, body: Floats, surface: Surface, turn: float, cx: float, cy: float) -> Found:
    """First contact of a body turned by some radians about (cx, cy)."""
    hull, skin, chunks, edges, owner = surface
    sign = 1.0 if turn >= 0.0 else -1.0
    time, kind, i, j = turn_through_skin(corners, body, hull, skin, chunks, cx, cy, sign, abs(turn))
    if kind == 0:
        return 1.0, 0.0, 0.0, -1, 0.0, 0.0
    if kind == 1:
        x, y = corners[i, 0], corners[i, 1]
        at, k = _last_turn(x, y, cx, cy, sign, edges, time)
        x, y = _turned(x - cx, y - cy, sign * at)
        return (
            float(at / abs(turn)),
            float(cx + x),
            float(cy + y),
            int(owner[k]),
            float(edges[k, 4]),
            float(edges[k, 5]),
        )
    x, y = hull[j, 0], hull[j, 1]
    at, k = _last_turn(x, y, cx, cy, -sign, body, time)
    nx, ny = _turned(-body[k, 4], -body[k, 5], sign * at)
    return float(at / abs(turn)), float(x), float(y), int(owner[j]), float(nx), float(ny)


@bare
def turn_through_skin(
    corners: Floats,
    body: Floats,
    hull: Floats,
    skin: Floats,
    chunks: Floats,
    cx: float,
    cy: float,
    sign: float,
    limit: float,
) -> Met:
    """The earliest impact on the skins within a turn of `limit` radians."""
    low, high = _ring(corners, body, cx, cy)
    low_x, low_y, high_x, high_y = _turn_bounds(corners, cx, cy, sign, limit)
    best, kind, at, edge = limit, 0, 0, 0
    cosine = math.cos(limit) if limit < WHOLE_TURN else 1.0
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
            if max(here, there) >= low and point_to_edge(cx, cy, skin, j) <= high:
                for i in range(len(corners)):
                    time = turn_impact(corners[i, 0], corners[i, 1], cx, cy, sign, skin, j, best, cosine)
                    if time < best:
                        best, kind, at, edge = time, 1, i, j
                        cosine = math.cos(best)
            if low <= here <= high:
                for i in range(len(body)):
                    time = turn_impact(skin[j, 0], skin[j, 1], cx, cy, -sign, body, i, best, cosine)
                    if time < best:
                        best, kind, at, edge = time, 2, i, j
                        cosine = math.cos(best)
    return best, kind, at, edge


@bare
def _ring(corners: Floats, body: Floats, cx: float, cy: float) -> tuple[float, float]:
    """The squares of the least and the greatest distance of a body's boundary from a pivot, with a margin."""
    low, high = 1e18, 0.0
    for i in range(len(corners)):
        away = (corners[i, 0] - cx) ** 2 + (corners[i, 1] - cy) ** 2
        low, high = min(low, away), max(high, away)
    for i in range(len(body)):
        low = min(low, point_to_edge(cx, cy, body, i))
    return (max(math.sqrt(low) - MARGIN, 0.0)) ** 2, (math.sqrt(high) + MARGIN) ** 2


@bare
def _turn_bounds(corners: Floats, cx: float, cy: float, sign: float, limit: float) -> tuple[float, float, float, float]:
    """Least x, least y, greatest x, greatest y about (cx, cy), with a margin, of where a turn brings the corners."""
    c, s = math.cos(limit), sign * math.sin(limit)
    low_x = low_y = high_x = high_y = 0.0
    for i in range(len(corners)):
        x, y = corners[i, 0] - cx, corners[i, 1] - cy
        u, v = c * x - s * y, s * x + c * y
        x0, y0, x1, y1 = min(x, u), min(y, v), max(x, u), max(y, v)
        away = math.sqrt(x * x + y * y)
        if _sweeps(x, -sign * y, away, c, limit):
            x1 = away
        if _sweeps(-x, sign * y, away, c, limit):
            x0 = -away
        if _sweeps(y, sign * x, away, c, limit):
            y1 = away
        if _sweeps(-y, -sign * x, away, c, limit):
            y0 = -away
        if i == 0:
            low_x, low_y, high_x, high_y = x0, y0, x1, y1
        low_x, low_y, high_x, high_y = min(low_x, x0), min(low_y, y0), max(high_x, x1), max(high_y, y1)
    return low_x - MARGIN, low_y - MARGIN, high_x + MARGIN, high_y + MARGIN


@bare
def _sweeps(along: float, across: float, away: float, cosine: float, limit: float) -> bool:
    """Whether a turn by `limit` sweeps over a direction that lies `along` and `across`, ahead, of where it begins."""
    if limit >= WHOLE_TURN:
        return True
    if limit <= math.pi:
        return across >= 0.0 and along >= away * cosine
    return across >= 0.0 or along <= away * cosine


@bare
def _last_turn(x: float, y: float, cx: float, cy: float, sign: float, edges: Floats, until: float) -> tuple[float, int]:
    """The last entry through the true edges within a turn of `until` radians, told as by _last_push."""
    last, by = 0.0, -1
    cosine = math.cos(until) if until < WHOLE_TURN else 1.0
    for k in range(len(edges)):
        time = turn_impact(x, y, cx, cy, sign, edges, k, until, cosine)
        if time <= until and (time > last or by < 0):
            last, by = time, k
    if by < 0:
        by = _nearest_ahead(x, y, -sign * (y - cy), sign * (x - cx), cx - x, cy - y, edges)
    return last, by


@bare
def _turned(x: float, y: float, angle: float) -> tuple[float, float]:
    """The vector (x, y) turned by some radians."""
    cosine, sine = math.cos(angle), math.sin(angle)
    return cosine * x - sine * y, sine * x + cosine * y


@bare
def _bounds(points: Floats) -> tuple[float, float, float, float]:
    """Least x, least y, greatest x, greatest y, with a margin: a corner may lie a skin behind an edge."""
    low_x = high_x = points[0, 0]
    low_y = high_y = points[0, 1]
    for i in range(1, len(points)):
        low_x = min(low_x, points[i, 0])
        high_x = max(high_x, points[i, 0])
        low_y = min(low_y, points[i, 1])
        high_y = max(high_y, points[i, 1])
    return low_x - MARGIN, low_y - MARGIN, high_x + MARGIN, high_y + MARGIN


@compiled
def many_pushes(corners: Floats, body: Floats, surface: Surface, vectors: Floats) -> Floats:
    """The fraction travelled for each of many translations (n, 2)."""
    fractions = np.empty(len(vectors))
    for n in range(len(vectors)):
        dx, dy = vectors[n, 0], vectors[n, 1]
        fractions[n] = first_push(corners, body, surface, dx, dy)[0]
    return fractions


@compiled
def many_turns(corners: Floats, body: Floats, surface: Surface, turns: Floats, pivots: Floats) -> Floats:
    """The fraction travelled for each of many turns (n,) about pivots (n, 2)."""
    fractions = np.empty(len(turns))
    for n in range(len(turns)):
        x, y = pivots[n, 0], pivots[n, 1]
        fractions[n] = first_turn(corners, body, surface, turns[n], x, y)[0]
    return fractions
