"""Rasterization of shapes: the squares whose interior meets the shape's interior.

# Strategy: no square is ever intersected with the shape. Each boundary edge is cut where it crosses a grid line, so
# that every piece lies in one square. A piece that climbs by dy covers, in its own square, the area to its right, and
# in every square further right the whole height dy. Summing the signed parts along each row gives the exact area of
# the shape in every square (the accumulation buffer of font renderers: Levien, font-rs, 2016). Edges that run along a
# grid line add nothing beyond it, as the definition demands.
"""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
import shapely

from utak.geometry.kernels.arrays import Floats
from utak.geometry.kernels.jit import compiled
from utak.geometry.motion.se2 import Motion

MIN_COVERED_AREA = 1e-9  # squares squared: a square covered by less is only touched; a convention, above rounding


def squares(shape: Any, width: int, height: int) -> npt.NDArray[np.bool_]:
    """Return the squares of a table that a shape covers.

    Parameters
    ----------
    shape : shapely geometry
        Polygon or MultiPolygon (holes allowed), in squares, table frame: x to the east, y to the north, (0, 0) at the
        table's south-west corner. Other geometries have no area and cover nothing.
    width, height : int
        Size of the table in squares.

    Returns
    -------
    (height, width) bool array, row 0 in the south: True where the shape covers an area of the square above 1e-9 squares
    squared, so that mere contact does not count. What lies off the table is left out.

    Examples
    --------
    >>> squares(shapely.box(1, 0, 2.5, 1), 4, 2).astype(int)
    array([[0, 1, 1, 0],
           [0, 0, 0, 0]])
    """
    return covered_areas(shape, width, height) > MIN_COVERED_AREA


def squares_after(shape: Any, motions: Sequence[Motion], width: int, height: int) -> npt.NDArray[np.bool_]:
    """Return the squares of a table that a shape covers after at least one of some motions."""
    edges, covered = outline_edges(shape), np.zeros((height, width), np.bool_)
    if not len(edges) or not len(motions):
        return covered
    moved = np.array([motion.points(edges.reshape(-1, 2)) for motion in motions])
    corner = np.floor(moved.min(1)).astype(np.intp)
    moved -= corner[:, None]
    columns_needed, rows_needed = (np.ceil(moved.max((0, 1))).astype(np.intp) + 1).tolist()
    moved[:, :, 1] += rows_needed * np.arange(len(motions))[:, None]  # one above the other, each in a window of its own
    occupied = _covered_areas(moved.reshape(-1, 4), columns_needed, rows_needed * len(motions)) > MIN_COVERED_AREA
    number, row, column = np.nonzero(occupied.reshape(len(motions), rows_needed, columns_needed))
    column, row = column + corner[number, 0], row + corner[number, 1]
    on_table = (column >= 0) & (column < width) & (row >= 0) & (row < height)
    covered[row[on_table], column[on_table]] = True
    return covered


def covered_areas(shape: Any, width: int, height: int) -> Floats:
    """Return the area that a shape covers in every square of a table: (height, width) float64, from 0 to 1 square."""
    return _covered_areas(outline_edges(shape), width, height)


def window_of(edges: Floats) -> tuple[int, int, npt.NDArray[np.bool_]]:
    """Return the squares that a shape with some edges covers, within its containing rectangle."""
    return _window_of(edges)


def _covered_areas(edges: Floats, width: int, height: int) -> Floats:
    """Return the area to the left of closed rings of edges in every square."""
    sums = np.zeros((2, height, width + 2))
    _accumulate(edges, sums)
    return np.cumsum(sums[0] + sums[1], axis=1)[:, :width]


def outline_edges(shape: Any) -> Floats:
    """Return all boundary edges of a shape, the interior on their left: (n, 4) float64, rows x0, y0, x1, y1."""
    rings = []
    for part in shapely.get_parts(shapely.orient_polygons(shape)):
        if part.geom_type == "Polygon" and not part.is_empty:
            rings += [shapely.get_coordinates(ring) for ring in (part.exterior, *part.interiors)]
    if not rings:
        return np.empty((0, 4))
    return np.concatenate([np.hstack([ring[:-1], ring[1:]]) for ring in rings])


@compiled
def _accumulate(edges: Floats, sums: Floats) -> None:
    """Add to `sums` the signed areas between every edge and what lies east of it; edges to the south count positive."""
    # Each edge is cut at all grid lines that lie strictly between its ends, so that a piece lies in one square.
    height, width = sums.shape[1], sums.shape[2] - 2
    for n in range(len(edges)):
        x0, y0, x1, y1 = edges[n, 0], edges[n, 1], edges[n, 2], edges[n, 3]
        if y0 == y1 or max(y0, y1) <= 0 or min(y0, y1) >= height:
            continue
        rows = max(math.ceil(max(y0, y1)) - math.floor(min(y0, y1)) - 1, 0)
        for i in range(rows + 1):
            ax, ay = _cut_at(x0, y0, x1, y1, y0, y1, i, rows)
            bx, by = _cut_at(x0, y0, x1, y1, y0, y1, i + 1, rows)
            row = math.floor((ay + by) / 2)
            if row < 0 or row >= height:
                continue
            columns = 0 if ax == bx else max(math.ceil(max(ax, bx)) - math.floor(min(ax, bx)) - 1, 0)
            for k in range(columns + 1):
                cx, cy = _cut_at(ax, ay, bx, by, ax, bx, k, columns)
                dx, dy = _cut_at(ax, ay, bx, by, ax, bx, k + 1, columns)
                middle = (cx + dx) / 2
                column = math.floor(middle)
                if column < width:
                    share = 1.0 if column < 0 else 1.0 - (middle - column)
                    column = max(column, 0)
                    sums[0, row, column] += (cy - dy) * share
                    sums[1, row, column + 1] += (cy - dy) * (1.0 - share)


@compiled
def _covered_squares(edges: Floats, width: int, height: int) -> npt.NDArray[np.bool_]:
    """Return the squares of which the shape with some edges covers more than MIN_COVERED_AREA."""
    sums = np.zeros((2, height, width + 2))
    _accumulate(edges, sums)
    covered = np.empty((height, width), np.bool_)
    for row in range(height):
        area = 0.0
        for column in range(width):
            area += sums[0, row, column] + sums[1, row, column]
            covered[row, column] = area > MIN_COVERED_AREA
    return covered


@compiled
def _window_of(edges: Floats) -> tuple[int, int, npt.NDArray[np.bool_]]:
    """Return what `window_of` does, for (n, 4) edges in squares, table frame; n at least 1."""
    x0, y0 = edges[0, 0], edges[0, 1]
    x1, y1 = x0, y0
    for n in range(len(edges)):
        x0, y0 = min(x0, edges[n, 0]), min(y0, edges[n, 1])
        x1, y1 = max(x1, edges[n, 0]), max(y1, edges[n, 1])
    west, south = math.floor(x0), math.floor(y0)
    moved = np.empty((len(edges), 4))
    for n in range(len(edges)):
        moved[n, 0], moved[n, 1] = edges[n, 0] - west, edges[n, 1] - south
        moved[n, 2], moved[n, 3] = edges[n, 2] - west, edges[n, 3] - south
    return west, south, _covered_squares(moved, math.ceil(x1) - west, math.ceil(y1) - south)


@compiled
def _cut_at(
    x0: float, y0: float, x1: float, y1: float, start: float, stop: float, number: int, lines: int
) -> tuple[float, float]:
    """Return the point (x, y) where an edge meets `number` of the `lines` grid lines that it crosses in order."""
    if number == 0:
        return x0, y0
    if number > lines:
        return x1, y1
    line = math.floor(start) + number if stop > start else math.ceil(start) - number
    part = (line - start) / (stop - start)
    return x0 + part * (x1 - x0), y0 + part * (y1 - y0)
