"""Footprints: the squares that a body covers in its quarter turns, meets in a push by one square, meets in a turn.

Wherever a shape lies, and at whatever angle: as long as the robot stands in the middle of a square when it takes hold,
pushes by whole squares and quarter turns about the robot bring the shape only to the same place within the squares,
seen from another side. So all its poses are a quarter turn and the square in which its centroid lies, and what it
covers is computed once.

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

from utak.geometry.kernels.arrays import Bools, Floats, Longs
from utak.geometry.kernels.jit import compiled
from utak.geometry.motion.first_contact import ContactBody, Obstacles
from utak.geometry.motion.time_of_impact import first_turn_skin_hit
from utak.geometry.raster.rasterize import squares

PUSH_DIRECTIONS = ((1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1))
"""Steps (columns, rows) of a push, counter-clockwise from the east: a quarter turn is two further in this order."""


@dataclass(frozen=True)
class Footprints:
    """The squares of a shape as (columns, rows) offsets from the square of its centroid."""

    home: tuple[int, int]  # (column, row) of the centroid's square where the shape lies now, in the table
    # (n, 2) squares next to its own, by an edge or a corner, where the robot can stand to grasp it; sorted by column,
    # then row. If the robot already holds it, the robot's square is among them, wherever that is.
    holds: Longs
    lying: Longs  # (m, 2) squares that it covers
    # For each of the eight directions, as in PUSH_DIRECTIONS, (k, 2) squares met by a push of one square, those at both
    # ends included
    steps: tuple[Longs, ...]
    # For each hold, (k, 2) squares met by a quarter turn counter-clockwise about the middle of the hold, those at both
    # ends included
    turns: tuple[Longs, ...]


def new_footprints(shape: Any, own_square: tuple[int, int] | None = None, holds: Longs | None = None) -> Footprints:
    """Return the footprints of a shape whose centroid lies in the square (0, 0); `home` is (0, 0)."""
    lying = _covered_offsets(shape)
    holds = _squares_about(lying, own_square) if holds is None else holds
    body = ContactBody(shape)
    steps = tuple(_squares_of_push(shape, lying, dx, dy) for dx, dy in PUSH_DIRECTIONS)
    return Footprints((0, 0), holds, lying, steps, tuple(_squares_of_turn(body, lying, hold) for hold in holds))


def quarter(offsets: Longs, count: int) -> Longs:
    """Return offsets (n, 2) of columns, rows after `count` quarter turns counter-clockwise about the square (0, 0)."""
    for _ in range(count % 4):
        offsets = np.column_stack([-offsets[:, 1], offsets[:, 0]])
    return offsets


def _covered_offsets(shape: Any) -> Longs:
    """Return the squares that a shape covers as offsets (n, 2) column, row from the square (0, 0)."""
    reach = math.ceil(max(abs(v) for v in shape.bounds)) + 1
    rows, columns = np.nonzero(squares(affinity.translate(shape, reach, reach), 2 * reach, 2 * reach))
    offsets: Longs = np.column_stack([columns, rows]).astype(np.int64) - reach
    return offsets


def _squares_about(lying: Longs, own_square: tuple[int, int] | None) -> Longs:
    """Return the squares that touch the given ones by an edge or a corner, and `own_square`: offsets (n, 2)."""
    covered = {(int(x), int(y)) for x, y in lying}
    about = {(x + dx, y + dy) for x, y in covered for dx, dy in PUSH_DIRECTIONS} - covered
    return np.array(sorted(about | ({own_square} if own_square else set())), dtype=np.int64).reshape(-1, 2)


def _squares_of_push(shape: Any, lying: Longs, dx: int, dy: int) -> Longs:
    """Return the squares met by a push of a shape by (dx, dy), one square, both ends included: offsets (n, 2)."""
    moved = lying + np.array([dx, dy])
    if dx == 0 or dy == 0:
        return np.unique(np.vstack([lying, moved]), axis=0)
    return np.unique(np.vstack([lying, moved, _covered_offsets(swept_polygon(shape, dx, dy))]), axis=0)


def swept_polygon(shape: Any, dx: float, dy: float) -> Any:
    """Return the polygon that a shape sweeps in a push by (dx, dy) squares, both ends included."""
    parts = [shape, affinity.translate(shape, dx, dy)]
    for (ax, ay), (bx, by) in pairwise(shape.exterior.coords):
        side = shapely.Polygon([(ax, ay), (bx, by), (bx + dx, by + dy), (ax + dx, ay + dy)])
        parts.append(side if side.is_valid else side.buffer(0))
    return shapely.union_all(parts)


def _squares_of_turn(body: ContactBody, lying: Longs, hold: Longs) -> Longs:
    """Return the squares met by a quarter turn counter-clockwise about the middle of square `hold`: offsets (n, 2)."""
    pivot = hold + 0.5
    reach = math.ceil(float(np.hypot(*(body.edges[:, :2] - pivot).T).max())) + 1
    met = np.zeros((2 * reach + 1, 2 * reach + 1), np.bool_)
    for known in (lying - hold, quarter(lying - hold, 1)):
        met[known[:, 1] + reach, known[:, 0] + reach] = True
    _mark_met(body.edges, body.edges, met, float(pivot[0]), float(pivot[1]), *UNIT_SQUARE_SURFACE)
    rows, columns = np.nonzero(met)
    return np.column_stack([columns, rows]) - reach + hold


def _unit_square_surface() -> tuple[Floats, Floats, Floats]:
    """Return hull (4, 7), skin (4, 7) and chunks (1, 6) of the square (0, 0), from (0, 0) to (1, 1)."""
    surface = Obstacles([shapely.box(0, 0, 1, 1)]).surface
    return surface.hull, surface.skin, surface.chunks


UNIT_SQUARE_SURFACE = _unit_square_surface()


@compiled
def _mark_met(
    corners: Floats, body: Floats, met: Bools, cx: float, cy: float, hull: Floats, skin: Floats, chunks: Floats
) -> None:
    """Mark the squares of a window about (cx, cy) that a body runs into in a quarter turn counter-clockwise."""
    window = len(met) // 2
    squared_radius = 0.0
    for corner in corners:
        squared_radius = max(squared_radius, (corner[0] - cx) ** 2 + (corner[1] - cy) ** 2)
    shifted, inner, box = hull.copy(), skin.copy(), chunks.copy()
    for i in range(2 * window + 1):
        for j in range(2 * window + 1):
            u, v = max(abs(j - window) - 0.5, 0.0), max(abs(i - window) - 0.5, 0.0)
            if met[i, j] or u * u + v * v >= squared_radius:
                continue
            dx, dy = cx - 0.5 + j - window, cy - 0.5 + i - window
            for k in range(4):
                for n in range(4):
                    step = dx if n % 2 == 0 else dy
                    shifted[k, n] = hull[k, n] + step
                    inner[k, n] = skin[k, n] + step
            for n in range(4):
                box[0, 2 + n] = chunks[0, 2 + n] + (dx if n % 2 == 0 else dy)
            turn = math.pi / 2
            met[i, j] = first_turn_skin_hit(corners, body, shifted, inner, box, cx, cy, 1.0, turn)[1] != 0
