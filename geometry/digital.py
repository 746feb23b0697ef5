"""The digital representation of a shape: the squares whose open interior meets the shape's interior.

# Strategy: no square is ever intersected with the shape. Each boundary edge is cut where it crosses a grid line, so
# that every piece lies in one square. A piece that climbs by dy covers, in its own square, the area to its right, and
# in every square further right the whole height dy. Summing the signed areas along each row gives the exact area of
# the shape in every square (the accumulation buffer of font renderers: Levien, font-rs, 2016). Edges that run along a
# grid line add nothing beyond it, as the definition wants.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
import shapely

from geometry.rigid import Motion

Floats = npt.NDArray[np.float64]
TOUCH = 1e-9  # squares^2: a smaller common area is mere touching


def squares(shape: Any, width: int, height: int) -> npt.NDArray[np.bool_]:
    """The squares of a table that a shape occupies.

    Parameters
    ----------
    shape : shapely geometry
        Polygon or MultiPolygon (holes allowed), in squares, table frame. Other geometries have no area: nothing.
    width, height : int
        Size of the table in squares.

    Returns
    -------
    (height, width) bool array, row 0 in the south: True where the shape covers an area of the square above 1e-9.

    Examples
    --------
    >>> squares(shapely.box(1, 0, 2.5, 1), 4, 2).astype(int)
    array([[0, 1, 1, 0],
           [0, 0, 0, 0]])
    """
    return areas(shape, width, height) > TOUCH


def squares_after(shape: Any, motions: Sequence[Motion], width: int, height: int) -> npt.NDArray[np.bool_]:
    """The squares of a table that a shape occupies after one or another of some motions of it.

    As `squares` of the shape after each, all together: (height, width) bool, row 0 in the south.
    """
    edges, found = _edges(shape), np.zeros((height, width), np.bool_)
    if not len(edges) or not len(motions):
        return found
    moved = np.array([motion.points(edges.reshape(-1, 2)) for motion in motions])
    corner = np.floor(moved.min(1)).astype(np.intp)
    moved -= corner[:, None]
    wide, high = (np.ceil(moved.max((0, 1))).astype(np.intp) + 1).tolist()
    moved[:, :, 1] += high * np.arange(len(motions))[:, None]  # one above the other, each in a window of its own
    occupied = _areas(moved.reshape(-1, 4), wide, high * len(motions)) > TOUCH
    number, row, column = np.nonzero(occupied.reshape(len(motions), high, wide))
    column, row = column + corner[number, 0], row + corner[number, 1]
    seen = (column >= 0) & (column < width) & (row >= 0) & (row < height)
    found[row[seen], column[seen]] = True
    return found


def areas(shape: Any, width: int, height: int) -> Floats:
    """The area that a shape covers in every square: (height, width) floats, exact but for rounding (about 1e-12)."""
    return _areas(_edges(shape), width, height)


def _areas(edges: Floats, width: int, height: int) -> Floats:
    """The area to the left of closed rings of edges, (n, 4), in every square."""
    sums = np.zeros((height, width + 1))
    pieces = _cut(edges, height)
    x0, y0, x1, y1 = pieces[:, 0], pieces[:, 1], pieces[:, 2], pieces[:, 3]
    row = np.floor((y0 + y1) / 2).astype(np.intp)
    middle = (x0 + x1) / 2
    column = np.floor(middle).astype(np.intp)
    seen = (row >= 0) & (row < height) & (column < width)
    row, column, middle, rise = row[seen], column[seen], middle[seen], (y0 - y1)[seen]
    share = np.where(column < 0, 1.0, 1.0 - (middle - column))
    column = np.maximum(column, 0)
    flat = row * (width + 1) + column
    size = sums.size
    own = np.bincount(flat, rise * share, size) + np.bincount(flat + 1, rise * (1.0 - share), size)
    sums += own.reshape(sums.shape)
    return np.cumsum(sums, axis=1)[:, :width]


def _edges(shape: Any) -> Floats:
    """All boundary edges as (n, 4) x0, y0, x1, y1, the interior on their left."""
    rings = []
    for part in shapely.get_parts(shapely.orient_polygons(shape)):
        if part.geom_type == "Polygon" and not part.is_empty:
            rings += [shapely.get_coordinates(ring) for ring in (part.exterior, *part.interiors)]
    if not rings:
        return np.empty((0, 4))
    return np.concatenate([np.hstack([ring[:-1], ring[1:]]) for ring in rings])


def _cut(edges: Floats, height: int) -> Floats:
    """Cut edges at every grid line: first at the rows of the table, then at all columns."""
    rising = edges[edges[:, 1] != edges[:, 3]]
    reach = np.clip(rising[:, [1, 3]], -1, height + 1)
    rising = rising[(reach[:, 0] > 0) | (reach[:, 1] > 0)]
    return _cut_along(_cut_along(rising, 1), 0)


def _cut_along(edges: Floats, axis: int) -> Floats:
    """Cut every edge at the whole values of one coordinate that lie strictly between its ends."""
    start, stop = edges[:, axis], edges[:, axis + 2]
    low, high = np.minimum(start, stop), np.maximum(start, stop)
    first = np.floor(low) + 1
    count = np.maximum(np.ceil(high) - first, 0).astype(np.intp)  # grid lines inside
    parts = count + 1
    edge = np.repeat(np.arange(len(edges)), parts)
    nth = np.arange(parts.sum()) - np.repeat(np.cumsum(parts) - parts, parts)
    lines = np.where(stop > start, 0.0, 1.0)[edge]
    k = np.where(lines == 0.0, first[edge] + nth - 1, first[edge] + count[edge] - nth)
    span = (stop - start)[edge]
    step = np.where(lines == 0.0, 1.0, -1.0)
    before = np.divide(k - start[edge], span, out=np.zeros(len(edge)), where=nth > 0)
    after = np.divide(k + step - start[edge], span, out=np.ones(len(edge)), where=nth < count[edge])
    return np.hstack([_point(edges, edge, before), _point(edges, edge, after)])


def _point(edges: Floats, edge: npt.NDArray[np.intp], t: Floats) -> Floats:
    """The points at parameters t on the given edges, ends exact."""
    here, there = edges[edge, :2], edges[edge, 2:]
    return np.where(t[:, None] == 1.0, there, here + t[:, None] * (there - here))
