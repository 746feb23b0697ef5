"""How far apart a placed body and the obstacles are, and whether they overlap wherever in a cell the body is.

Plain loops for numba. The body is drawn about a centre, as a rule that of its enclosing circle; a pose
is a place (x, y) of that centre and an angle as (cosine, sine). Obstacle edges that may matter near a place are found
in the ground's blocks.
"""

import math
from typing import NamedTuple

from geometry.kernels.arrays import Floats, Longs
from geometry.kernels.jit import bare

FREE, OPEN, SHUT, FULL, DEAD = 0, 1, 2, 3, 4


class MovingBody(NamedTuple):
    """A body about a centre.

    edges: (m, 7) rows x0, y0, x1, y1, outward normal, length. probes: (k, 4) rows x, y, r, distance from the centre:
    the body covers the disc of radius r about (x, y); r is 0 at its corners. radius: of the circle about the centre
    that encloses it. reference: the (x, y) of the body's own origin. seeds: (parts, 2) a corner of each part of it.
    """

    edges: Floats
    probes: Floats
    radius: float
    reference: Floats
    seeds: Floats


class NearbyEdges(NamedTuple):
    """Where a body moves.

    edges: (n, 7) of the united obstacles. raster: (rows, columns) signed distance to the obstacles at pixel centres,
    negative inside. frame: x, y of the raster's corner and its pixel. first, near: for each block of pixels which edges
    are within reach of a body there. blocks: columns of blocks, pixels a block. reach: edges further than this from the
    body are not in the block's list. bounds: x0, y0, x1, y1 of the body's reference point.
    """

    edges: Floats
    raster: Floats
    frame: Floats
    first: Longs
    near: Longs
    blocks: Longs
    reach: float
    bounds: Floats


@bare
def rough_distance(ground: NearbyEdges, x: float, y: float) -> tuple[float, float]:
    """The signed distance to the obstacles at the nearest pixel, and how far that is from (x, y)."""
    rows, columns = ground.raster.shape
    pixel = ground.frame[2]
    column = min(max(int((x - ground.frame[0]) / pixel), 0), columns - 1)
    row = min(max(int((y - ground.frame[1]) / pixel), 0), rows - 1)
    dx = x - ground.frame[0] - (column + 0.5) * pixel
    dy = y - ground.frame[1] - (row + 0.5) * pixel
    return ground.raster[row, column], math.sqrt(dx * dx + dy * dy)


@bare
def block_at(ground: NearbyEdges, x: float, y: float) -> int:
    """The block of a place."""
    size = ground.frame[2] * ground.blocks[1]
    columns = ground.blocks[0]
    rows = (len(ground.first) - 1) // columns
    column = min(max(int((x - ground.frame[0]) / size), 0), columns - 1)
    row = min(max(int((y - ground.frame[1]) / size), 0), rows - 1)
    return int(row * columns + column)


@bare
def point_to_edge(x: float, y: float, edges: Floats, j: int) -> float:
    """The squared distance from a point to an edge."""
    px, py = x - edges[j, 0], y - edges[j, 1]
    nx, ny = edges[j, 4], edges[j, 5]
    along = nx * py - ny * px
    beyond = along - min(max(along, 0.0), edges[j, 6])
    across = nx * px + ny * py
    return float(beyond * beyond + across * across)


@bare
def inside(x: float, y: float, edges: Floats) -> bool:
    """Whether a point is inside closed rings, by counting crossings; either answer on the boundary."""
    odd = False
    for j in range(len(edges)):
        y0, y1 = edges[j, 1], edges[j, 3]
        if (y0 > y) != (y1 > y) and x < edges[j, 0] + (y - y0) / (y1 - y0) * (edges[j, 2] - edges[j, 0]):
            odd = not odd
    return odd


@bare
def signed_distance(x: float, y: float, ground: NearbyEdges, block: int) -> float:
    """The distance from a point of the body to the obstacles, negative inside them; at most the ground's reach."""
    edges = ground.edges
    best, side = ground.reach * ground.reach, 1e9
    for k in range(ground.first[block], ground.first[block + 1]):
        j = ground.near[k]
        d2 = point_to_edge(x, y, edges, j)
        if d2 > best * (1.0 + 1e-12) + 1e-24:
            continue
        across = edges[j, 4] * (x - edges[j, 0]) + edges[j, 5] * (y - edges[j, 1])
        if d2 < best * (1.0 - 1e-12) - 1e-24 or abs(across) > abs(side) or side == 1e9:
            side = across
        best = min(best, d2)
    return math.copysign(math.sqrt(best), side)


@bare
def distance_at(mover: MovingBody, ground: NearbyEdges, x: float, y: float, c: float, s: float) -> float:
    """The distance between the placed body and the obstacles, at most the ground's reach; -1 when they overlap."""
    edges, body = ground.edges, mover.edges
    best = ground.reach * ground.reach
    block = block_at(ground, x, y)
    for k in range(ground.first[block], ground.first[block + 1]):
        j = ground.near[k]
        if point_to_edge(x, y, edges, j) > (mover.radius + math.sqrt(best)) ** 2:
            continue
        ax, ay = edges[j, 0] - x, edges[j, 1] - y
        ax, ay = c * ax + s * ay, c * ay - s * ax
        bx, by = edges[j, 2] - x, edges[j, 3] - y
        bx, by = c * bx + s * by, c * by - s * bx
        best = min(best, _edge_to_body(ax, ay, bx, by, edges[j, 6], body))
        if best < 0.0:
            return -1.0
    for k in range(len(mover.seeds)):
        px, py = mover.seeds[k, 0], mover.seeds[k, 1]
        if inside(x + c * px - s * py, y + s * px + c * py, edges):
            return -1.0
    return math.sqrt(best)


@bare
def _edge_to_body(ax: float, ay: float, bx: float, by: float, length: float, body: Floats) -> float:
    """The squared distance from an edge to the body, both in the body's frame; negative when they overlap."""
    ux, uy = (bx - ax) / length, (by - ay) / length
    best, odd = 1e18, False
    before = ux * (body[0, 1] - ay) - uy * (body[0, 0] - ax)
    for i in range(len(body)):
        px, py, qx, qy = body[i, 0], body[i, 1], body[i, 2], body[i, 3]
        nx, ny = body[i, 4], body[i, 5]
        before = ux * (py - ay) - uy * (px - ax)
        after = ux * (qy - ay) - uy * (qx - ax)
        side_a = nx * (ax - px) + ny * (ay - py)
        side_b = nx * (bx - px) + ny * (by - py)
        if before * after < 0.0 and side_a * side_b < 0.0:
            return -1.0
        if (py > ay) != (qy > ay) and ax < px + (ay - py) / (qy - py) * (qx - px):
            odd = not odd
        best = min(best, point_to_edge(ax, ay, body, i))
        along = ux * (px - ax) + uy * (py - ay)
        along -= min(max(along, 0.0), length)
        best = min(best, along * along + before * before)
    return -1.0 if odd else best


@bare
def classify(
    mover: MovingBody, ground: NearbyEdges, x: float, y: float, angle: float, spread: float, half: float
) -> int:
    """What a cell of poses is: about (x, y, angle), places at most `spread` away, angles at most `half`.

    FREE: the body overlaps nothing in any of them. FULL: it overlaps an obstacle in all. OPEN: neither is known, and at
    the centre it overlaps nothing. SHUT: neither is known, and at the centre it does, or nobody has looked yet.
    """
    c, s = math.cos(angle), math.sin(angle)
    swing = 2.0 * math.sin(min(half, math.pi) / 2)
    where = _in_bounds(mover, ground, x, y, c, s, spread, swing)
    if where == FULL:
        return FULL
    rough, off = rough_distance(ground, x, y)
    if rough - off > mover.radius + spread:
        return where
    for k in range(len(mover.probes)):
        px, py, r = mover.probes[k, 0], mover.probes[k, 1], mover.probes[k, 2]
        rough, off = rough_distance(ground, x + c * px - s * py, y + s * px + c * py)
        if rough + off + spread + swing * mover.probes[k, 3] < r:
            return FULL
    slack = spread + swing * mover.radius
    if slack > ground.reach:
        return SHUT
    distance = distance_at(mover, ground, x, y, c, s)
    if distance > slack:
        return where
    if distance >= 0.0:
        return OPEN if where == FREE else where
    return FULL if _always_overlaps(mover, ground, x, y, c, s, spread, swing) else SHUT


@bare
def _in_bounds(
    mover: MovingBody, ground: NearbyEdges, x: float, y: float, c: float, s: float, spread: float, swing: float
) -> int:
    """FREE, OPEN, SHUT or FULL by the bounds of the reference point alone."""
    ox, oy = mover.reference[0], mover.reference[1]
    rx, ry = x + c * ox - s * oy, y + s * ox + c * oy
    bounds = ground.bounds
    room = min(min(rx - bounds[0], bounds[2] - rx), min(ry - bounds[1], bounds[3] - ry))
    slack = spread + swing * math.sqrt(ox * ox + oy * oy)
    if room >= slack:
        return FREE
    if room < -slack:
        return FULL
    return OPEN if room >= 0.0 else SHUT


@bare
def _always_overlaps(
    mover: MovingBody, ground: NearbyEdges, x: float, y: float, c: float, s: float, spread: float, swing: float
) -> bool:
    """Whether an inscribed disc or a corner of either stays within the other, or two edges go on crossing."""
    block = block_at(ground, x, y)
    if _keeps_crossing(mover.edges, ground.edges, ground.near, ground.first, block, x, y, c, s, spread, swing):
        return True
    for k in range(len(mover.probes)):
        px, py, r = mover.probes[k, 0], mover.probes[k, 1], mover.probes[k, 2]
        depth = r - signed_distance(x + c * px - s * py, y + s * px + c * py, ground, block)
        if depth > spread + swing * mover.probes[k, 3]:
            return True
    for k in range(ground.first[block], ground.first[block + 1]):
        j = ground.near[k]
        wx, wy = ground.edges[j, 0] - x, ground.edges[j, 1] - y
        away = math.sqrt(wx * wx + wy * wy)
        slack = spread + swing * away
        if away + slack >= mover.radius:
            continue
        wx, wy = c * wx + s * wy, c * wy - s * wx
        if not inside(wx, wy, mover.edges):
            continue
        depth2 = 1e18
        for i in range(len(mover.edges)):
            depth2 = min(depth2, point_to_edge(wx, wy, mover.edges, i))
        if depth2 > slack * slack:
            return True
    return False


@bare
def _keeps_crossing(
    body: Floats,
    edges: Floats,
    near: Longs,
    first: Longs,
    block: int,
    x: float,
    y: float,
    c: float,
    s: float,
    spread: float,
    swing: float,
) -> bool:
    """Whether an edge of the body crosses one of an obstacle wherever in a cell the body is.

    They do while the ends of each stay on their sides of the other's line: no end is moved over it by the cell's slack.
    """
    for k in range(first[block], first[block + 1]):
        j = near[k]
        ax, ay, bx, by = edges[j, 0] - x, edges[j, 1] - y, edges[j, 2] - x, edges[j, 3] - y
        ax, ay, bx, by = c * ax + s * ay, c * ay - s * ax, c * bx + s * by, c * by - s * bx
        slack_a = spread + swing * math.sqrt(ax * ax + ay * ay)
        slack_b = spread + swing * math.sqrt(bx * bx + by * by)
        ux, uy = (bx - ax) / edges[j, 6], (by - ay) / edges[j, 6]
        for i in range(len(body)):
            px, py, qx, qy = body[i, 0], body[i, 1], body[i, 2], body[i, 3]
            side_p, side_q = ux * (py - ay) - uy * (px - ax), ux * (qy - ay) - uy * (qx - ax)
            if side_p * side_q >= 0.0:
                continue
            if abs(side_p) <= spread + swing * math.sqrt(px * px + py * py):
                continue
            if abs(side_q) <= spread + swing * math.sqrt(qx * qx + qy * qy):
                continue
            side_a = body[i, 4] * (ax - px) + body[i, 5] * (ay - py)
            side_b = body[i, 4] * (bx - px) + body[i, 5] * (by - py)
            if side_a * side_b < 0.0 and abs(side_a) > slack_a and abs(side_b) > slack_b:
                return True
    return False
