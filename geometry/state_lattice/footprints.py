"""What a body covers on a lattice of squares: lying in its four quarter turns, pushed by a step, turned about a hold.

Wherever a shape lies, and at whatever angle: as long as Utak stands in the middle of a square when he takes it, pushes
by whole squares and quarter turns about him bring it only to the same place within the squares, seen from another side.
So all its poses are a quarter turn and the square in which its centroid lies, and what it covers is worked out once.

# Strategy: the squares met by a push of one square along an axis are those of its two ends. Those met by a diagonal
# push are the squares of the hexagon swept. Those met by a turn are found one by one with exact first contact.
"""

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
import shapely
from shapely import affinity

from geometry.kernels.arrays import Bools, Floats, Longs
from geometry.kernels.jit import compiled
from geometry.motion.first_contact import ContactBody, Obstacles
from geometry.motion.time_of_impact import first_turn_skin_hit
from geometry.raster.rasterize import squares

DIRECTIONS = ((1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1))  # a quarter turn is two further


@dataclass(frozen=True)
class Footprints:
    """A shape among squares, as (columns, rows) offsets from the square of its centroid.

    home : (column, row) of the centroid's square where the shape lies now.
    holds : (n, 2) the squares about its own squares, where Utak can stand to take it; unturned. Also the square where
        he stands who has it already, wherever that is.
    lying : the squares that it covers, unturned (m, 2). steps : those met by a push of one square in each direction.
    turns : for each hold those met by a quarter turn counter-clockwise about the middle of the hold.
    """

    home: tuple[int, int]
    holds: Longs
    lying: Longs
    steps: tuple[Longs, ...]
    turns: tuple[Longs, ...]


def new_stencil(near: Any, own: tuple[int, int] | None = None, holds: Longs | None = None) -> Footprints:
    """The stencil of a shape whose centroid lies in the square (0, 0).

    own : the square of the one who has hold of it. holds : those that it is about, None for all that there are.
    """
    lying = _offsets(near)
    holds = _ring(lying, own) if holds is None else holds
    body = ContactBody(near)
    steps = tuple(_step(near, lying, dx, dy) for dx, dy in DIRECTIONS)
    return Footprints((0, 0), holds, lying, steps, tuple(_turn(body, lying, hold) for hold in holds))


def quarter(offsets: Longs, count: int) -> Longs:
    """Offsets (n, 2) after so many quarter turns about the middle of the square (0, 0)."""
    for _ in range(count % 4):
        offsets = np.column_stack([-offsets[:, 1], offsets[:, 0]])
    return offsets


def _offsets(shape: Any) -> Longs:
    """The squares that a shape covers as offsets (n, 2), in order."""
    far = math.ceil(max(abs(v) for v in shape.bounds)) + 1
    rows, columns = np.nonzero(squares(affinity.translate(shape, far, far), 2 * far, 2 * far))
    offsets: Longs = np.column_stack([columns, rows]).astype(np.int64) - far
    return offsets


def _ring(lying: Longs, own: tuple[int, int] | None) -> Longs:
    """The squares that touch the given ones, by an edge or a corner, and one more: offsets (n, 2), in order."""
    covered = {(int(x), int(y)) for x, y in lying}
    about = {(x + dx, y + dy) for x, y in covered for dx, dy in DIRECTIONS} - covered
    return np.array(sorted(about | ({own} if own else set())), dtype=np.int64).reshape(-1, 2)


def _step(near: Any, lying: Longs, dx: int, dy: int) -> Longs:
    """The squares met by a push of one square."""
    moved = lying + np.array([dx, dy])
    if dx == 0 or dy == 0:
        return np.unique(np.vstack([lying, moved]), axis=0)
    return np.unique(np.vstack([lying, moved, _offsets(swept(near, dx, dy))]), axis=0)


def swept(shape: Any, dx: float, dy: float) -> Any:
    """The polygon that a shape sweeps in a push."""
    parts = [shape, affinity.translate(shape, dx, dy)]
    for (ax, ay), (bx, by) in pairwise(shape.exterior.coords):
        side = shapely.Polygon([(ax, ay), (bx, by), (bx + dx, by + dy), (ax + dx, ay + dy)])
        parts.append(side if side.is_valid else side.buffer(0))
    return shapely.union_all(parts)


def _turn(body: ContactBody, lying: Longs, hold: Longs) -> Longs:
    """The squares met by a quarter turn counter-clockwise about the middle of a square."""
    pivot = hold + 0.5
    far = math.ceil(float(np.hypot(*(body.edges[:, :2] - pivot).T).max())) + 1
    met = np.zeros((2 * far + 1, 2 * far + 1), np.bool_)
    for known in (lying - hold, quarter(lying - hold, 1)):
        met[known[:, 1] + far, known[:, 0] + far] = True
    _meet(body.edges, body.edges, met, float(pivot[0]), float(pivot[1]), *UNIT)
    rows, columns = np.nonzero(met)
    return np.column_stack([columns, rows]) - far + hold


def _unit() -> tuple[Floats, Floats, Floats]:
    """The edges, skin and chunks of the square (0, 0)."""
    surface = Obstacles([shapely.box(0, 0, 1, 1)]).surface
    return surface.hull, surface.skin, surface.chunks


UNIT = _unit()


@compiled
def _meet(
    corners: Floats, body: Floats, met: Bools, cx: float, cy: float, hull: Floats, skin: Floats, chunks: Floats
) -> None:
    """Mark the squares of a window about a place that a body runs into in a quarter turn about it."""
    far = len(met) // 2
    reach = 0.0
    for corner in corners:
        reach = max(reach, (corner[0] - cx) ** 2 + (corner[1] - cy) ** 2)
    shifted, inner, box = hull.copy(), skin.copy(), chunks.copy()
    for i in range(2 * far + 1):
        for j in range(2 * far + 1):
            u, v = max(abs(j - far) - 0.5, 0.0), max(abs(i - far) - 0.5, 0.0)
            if met[i, j] or u * u + v * v >= reach:
                continue
            dx, dy = cx - 0.5 + j - far, cy - 0.5 + i - far
            for k in range(4):
                for n in range(4):
                    step = dx if n % 2 == 0 else dy
                    shifted[k, n] = hull[k, n] + step
                    inner[k, n] = skin[k, n] + step
            for n in range(4):
                box[0, 2 + n] = chunks[0, 2 + n] + (dx if n % 2 == 0 else dy)
            turn = math.pi / 2
            met[i, j] = first_turn_skin_hit(corners, body, shifted, inner, box, cx, cy, 1.0, turn)[1] != 0
