"""Clearance of a placed body, and the classification of cells of poses: free, blocked or undecided.

Plain loops for numba. The body is drawn about a centre, as a rule that of its smallest enclosing circle. A pose is
a place (x, y) of that centre in squares, table frame, and an angle, often given as (cosine, sine) = (c, s). Obstacle
edges that may matter near a place are looked up by blocks of raster pixels. Rows of edges are x0, y0, x1, y1, outward
unit normal x and y, length; the interior lies on their left.
"""

import math
from typing import NamedTuple

from utak.geometry.kernels.arrays import Floats, Longs
from utak.geometry.kernels.jit import bare

# The kinds of cells (see classify_cell). Their order is compared. The search sets CELL_GIVEN_UP.
CELL_FREE, CELL_CENTRE_FREE, CELL_UNDECIDED, CELL_BLOCKED, CELL_GIVEN_UP = 0, 1, 2, 3, 4


class MovingBody(NamedTuple):
    """A body drawn about the centre that it is turned about. Lengths in squares, body frame from that centre."""

    # (m, 7) float64 rows x0, y0, x1, y1, outward unit normal x and y, length; ring after ring, interior on the left
    edges: Floats
    # (k, 4) float64 rows x, y, r, distance of (x, y) from the centre. The body covers the disc of radius r about (x,
    # y); first come the inscribed discs, the largest first, then the corners with r = 0.
    probes: Floats
    radius: float  # radius of the circle about the centre that encloses the body
    # (2,) x, y of the body's reference point (the origin that its shape was given about), relative to the centre
    reference: Floats
    seeds: Floats  # (parts, 2) x, y of one corner of each connected part


class NearbyEdges(NamedTuple):
    """Obstacle edges looked up by place, and the bounds within which a body moves. Squares, table frame."""

    edges: Floats  # (n, 7) edges of the united obstacles, as in MovingBody
    raster: Floats  # (rows, columns) signed distance from pixel centres to the obstacles, negative inside
    frame: Floats  # (3,) x, y of the raster's lower left corner, side of a pixel
    block_start: Longs  # (blocks + 1,) where the list of each block begins in `block_edges`
    block_edges: Longs  # for each block of pixels the indices of the edges within reach of a body whose centre is there
    blocks: Longs  # (2,) number of blocks in a row of blocks, number of pixels along the side of a block
    # Edges further than this from the body may be missing in the block's list; distances are known up to it
    reach: float
    bounds: Floats  # (4,) x0, y0, x1, y1 that the body's reference point must not leave


@bare
def raster_distance(nearby: NearbyEdges, x: float, y: float) -> tuple[float, float]:
    """Return (signed distance to the obstacles at the pixel of (x, y), how far its centre is from there)."""
    rows, columns = nearby.raster.shape
    pixel = nearby.frame[2]
    column = min(max(int((x - nearby.frame[0]) / pixel), 0), columns - 1)
    row = min(max(int((y - nearby.frame[1]) / pixel), 0), rows - 1)
    dx = x - nearby.frame[0] - (column + 0.5) * pixel
    dy = y - nearby.frame[1] - (row + 0.5) * pixel
    return nearby.raster[row, column], math.sqrt(dx * dx + dy * dy)


@bare
def block_at(nearby: NearbyEdges, x: float, y: float) -> int:
    """Return the number of the block of pixels that (x, y) lies in, or of the nearest one outside the raster."""
    size = nearby.frame[2] * nearby.blocks[1]
    columns = nearby.blocks[0]
    rows = (len(nearby.block_start) - 1) // columns
    column = min(max(int((x - nearby.frame[0]) / size), 0), columns - 1)
    row = min(max(int((y - nearby.frame[1]) / size), 0), rows - 1)
    return int(row * columns + column)


@bare
def squared_distance_to_edge(x: float, y: float, edges: Floats, j: int) -> float:
    """Return the squared distance from the point (x, y) to the segment that is row `j` of `edges`."""
    px, py = x - edges[j, 0], y - edges[j, 1]
    nx, ny = edges[j, 4], edges[j, 5]
    along = nx * py - ny * px
    beyond = along - min(max(along, 0.0), edges[j, 6])
    across = nx * px + ny * py
    return float(beyond * beyond + across * across)


@bare
def is_inside(x: float, y: float, edges: Floats) -> bool:
    """Return whether (x, y) is inside closed rings, by the even-odd rule. On the boundary either answer may come."""
    odd = False
    for j in range(len(edges)):
        y0, y1 = edges[j, 1], edges[j, 3]
        if (y0 > y) != (y1 > y) and x < edges[j, 0] + (y - y0) / (y1 - y0) * (edges[j, 2] - edges[j, 0]):
            odd = not odd
    return odd


@bare
def signed_distance(x: float, y: float, nearby: NearbyEdges, block: int) -> float:
    """Return the distance in squares from (x, y) to the obstacles: negative inside them, capped at nearby.reach."""
    edges = nearby.edges
    best, side = nearby.reach * nearby.reach, 1e9
    for k in range(nearby.block_start[block], nearby.block_start[block + 1]):
        j = nearby.block_edges[k]
        d2 = squared_distance_to_edge(x, y, edges, j)
        if d2 > best * (1.0 + 1e-12) + 1e-24:
            continue
        across = edges[j, 4] * (x - edges[j, 0]) + edges[j, 5] * (y - edges[j, 1])
        if d2 < best * (1.0 - 1e-12) - 1e-24 or abs(across) > abs(side) or side == 1e9:
            side = across
        best = min(best, d2)
    return math.copysign(math.sqrt(best), side)


@bare
def clearance_at(body: MovingBody, nearby: NearbyEdges, x: float, y: float, c: float, s: float) -> float:
    """Return the distance in squares between the placed body and the obstacles; -1.0 if they overlap."""
    edges, body_edges = nearby.edges, body.edges
    best = nearby.reach * nearby.reach
    block = block_at(nearby, x, y)
    for k in range(nearby.block_start[block], nearby.block_start[block + 1]):
        j = nearby.block_edges[k]
        if squared_distance_to_edge(x, y, edges, j) > (body.radius + math.sqrt(best)) ** 2:
            continue
        ax, ay = edges[j, 0] - x, edges[j, 1] - y
        ax, ay = c * ax + s * ay, c * ay - s * ax
        bx, by = edges[j, 2] - x, edges[j, 3] - y
        bx, by = c * bx + s * by, c * by - s * bx
        best = min(best, _edge_to_body(ax, ay, bx, by, edges[j, 6], body_edges))
        if best < 0.0:
            return -1.0
    for k in range(len(body.seeds)):
        px, py = body.seeds[k, 0], body.seeds[k, 1]
        if is_inside(x + c * px - s * py, y + s * px + c * py, edges):
            return -1.0
    return math.sqrt(best)


@bare
def _edge_to_body(ax: float, ay: float, bx: float, by: float, length: float, body_edges: Floats) -> float:
    """Return the squared distance from an obstacle's edge to the body, in squares squared; -1.0 if they overlap."""
    ux, uy = (bx - ax) / length, (by - ay) / length
    best, odd = 1e18, False
    before = ux * (body_edges[0, 1] - ay) - uy * (body_edges[0, 0] - ax)
    for i in range(len(body_edges)):
        px, py, qx, qy = body_edges[i, 0], body_edges[i, 1], body_edges[i, 2], body_edges[i, 3]
        nx, ny = body_edges[i, 4], body_edges[i, 5]
        before = ux * (py - ay) - uy * (px - ax)
        after = ux * (qy - ay) - uy * (qx - ax)
        side_a = nx * (ax - px) + ny * (ay - py)
        side_b = nx * (bx - px) + ny * (by - py)
        if before * after < 0.0 and side_a * side_b < 0.0:
            return -1.0
        if (py > ay) != (qy > ay) and ax < px + (ay - py) / (qy - py) * (qx - px):
            odd = not odd
        best = min(best, squared_distance_to_edge(ax, ay, body_edges, i))
        along = ux * (px - ax) + uy * (py - ay)
        along -= min(max(along, 0.0), length)
        best = min(best, along * along + before * before)
    return -1.0 if odd else best


@bare
def classify_cell(
    body: MovingBody, nearby: NearbyEdges, x: float, y: float, angle: float, spread: float, half: float
) -> int:
    """Return the kind of a cell of poses: places at most `spread` from (x, y), angles at most `half` from `angle`."""
    c, s = math.cos(angle), math.sin(angle)
    swing = 2.0 * math.sin(min(half, math.pi) / 2)
    where = _in_bounds(body, nearby, x, y, c, s, spread, swing)
    if where == CELL_BLOCKED:
        return CELL_BLOCKED
    rough, off = raster_distance(nearby, x, y)
    if rough - off > body.radius + spread:
        return where
    for k in range(len(body.probes)):
        px, py, r = body.probes[k, 0], body.probes[k, 1], body.probes[k, 2]
        rough, off = raster_distance(nearby, x + c * px - s * py, y + s * px + c * py)
        if rough + off + spread + swing * body.probes[k, 3] < r:
            return CELL_BLOCKED
    slack = spread + swing * body.radius
    if slack > nearby.reach:
        return CELL_UNDECIDED
    distance = clearance_at(body, nearby, x, y, c, s)
    if distance > slack:
        return where
    if distance >= 0.0:
        return CELL_CENTRE_FREE if where == CELL_FREE else where
    return CELL_BLOCKED if _always_overlaps(body, nearby, x, y, c, s, spread, swing) else CELL_UNDECIDED


@bare
def _in_bounds(
    body: MovingBody, nearby: NearbyEdges, x: float, y: float, c: float, s: float, spread: float, swing: float
) -> int:
    """Return the cell's kind, a number CELL_FREE ... CELL_BLOCKED, by the bounds of the reference point alone."""
    ox, oy = body.reference[0], body.reference[1]
    rx, ry = x + c * ox - s * oy, y + s * ox + c * oy
    bounds = nearby.bounds
    room = min(min(rx - bounds[0], bounds[2] - rx), min(ry - bounds[1], bounds[3] - ry))
    slack = spread + swing * math.sqrt(ox * ox + oy * oy)
    if room >= slack:
        return CELL_FREE
    if room < -slack:
        return CELL_BLOCKED
    return CELL_CENTRE_FREE if room >= 0.0 else CELL_UNDECIDED


@bare
def _always_overlaps(
    body: MovingBody, nearby: NearbyEdges, x: float, y: float, c: float, s: float, spread: float, swing: float
) -> bool:
    """Return whether the body surely overlaps an obstacle at every pose of a cell; False proves nothing."""
    block = block_at(nearby, x, y)
    if _keeps_crossing(
        body.edges, nearby.edges, nearby.block_edges, nearby.block_start, block, x, y, c, s, spread, swing
    ):
        return True
    for k in range(len(body.probes)):
        px, py, r = body.probes[k, 0], body.probes[k, 1], body.probes[k, 2]
        depth = r - signed_distance(x + c * px - s * py, y + s * px + c * py, nearby, block)
        if depth > spread + swing * body.probes[k, 3]:
            return True
    for k in range(nearby.block_start[block], nearby.block_start[block + 1]):
        j = nearby.block_edges[k]
        wx, wy = nearby.edges[j, 0] - x, nearby.edges[j, 1] - y
        away = math.sqrt(wx * wx + wy * wy)
        slack = spread + swing * away
        if away + slack >= body.radius:
            continue
        wx, wy = c * wx + s * wy, c * wy - s * wx
        if not is_inside(wx, wy, body.edges):
            continue
        depth2 = 1e18
        for i in range(len(body.edges)):
            depth2 = min(depth2, squared_distance_to_edge(wx, wy, body.edges, i))
        if depth2 > slack * slack:
            return True
    return False


@bare
def _keeps_crossing(
    body_edges: Floats,
    edges: Floats,
    block_edges: Longs,
    block_start: Longs,
    block: int,
    x: float,
    y: float,
    c: float,
    s: float,
    spread: float,
    swing: float,
) -> bool:
    """Return whether some edge of the body crosses one of an obstacle at every pose of a cell; False proves nothing."""
    for k in range(block_start[block], block_start[block + 1]):
        j = block_edges[k]
        ax, ay, bx, by = edges[j, 0] - x, edges[j, 1] - y, edges[j, 2] - x, edges[j, 3] - y
        ax, ay, bx, by = c * ax + s * ay, c * ay - s * ax, c * bx + s * by, c * by - s * bx
        slack_a = spread + swing * math.sqrt(ax * ax + ay * ay)
        slack_b = spread + swing * math.sqrt(bx * bx + by * by)
        ux, uy = (bx - ax) / edges[j, 6], (by - ay) / edges[j, 6]
        for i in range(len(body_edges)):
            px, py, qx, qy = body_edges[i, 0], body_edges[i, 1], body_edges[i, 2], body_edges[i, 3]
            side_p, side_q = ux * (py - ay) - uy * (px - ax), ux * (qy - ay) - uy * (qx - ax)
            if side_p * side_q >= 0.0:
                continue
            if abs(side_p) <= spread + swing * math.sqrt(px * px + py * py):
                continue
            if abs(side_q) <= spread + swing * math.sqrt(qx * qx + qy * qy):
                continue
            side_a = body_edges[i, 4] * (ax - px) + body_edges[i, 5] * (ay - py)
            side_b = body_edges[i, 4] * (bx - px) + body_edges[i, 5] * (by - py)
            if side_a * side_b < 0.0 and abs(side_a) > slack_a and abs(side_b) > slack_b:
                return True
    return False
