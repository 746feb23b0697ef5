"""The floor as triangles between the corners of its walls, and the widths that follow from them.

Points are (x, y) in squares from the screen's south-west corner; widths are in squares.

# Strategy: a circle among the walls is locally largest when corners of walls hold it on all sides: it is about the
circumcentre of a triangle of the Delaunay triangulation of these corners that is not obtuse. A line from wall to wall
is shorter than all lines beside it when no corner lies in the circle over it: it is an edge with acute angles on both
sides (Gabriel's condition). All of this is decided with whole numbers, so that it is the same however the floor is
turned, mirrored or moved. Where several corners lie on one circle, any triangulation of them gives the same.
"""

from typing import NamedTuple

import numpy as np
import shapely

from utak.geometry.kernels.arrays import Bools, Floats, Longs


class Walls(NamedTuple):
    """The floor as a triangulation of the corners of its walls."""

    # (n, 2) int64, the corners of blocked squares that touch free ones, (x, y) in squares from the screen's south-west
    # corner
    corners: Longs
    triangles: Longs  # (m, 3) int64, numbers of corners; together they are the free squares
    # (m,) float64, the squared width of the floor about each triangle (the diameter of the largest circle there), in
    # square squares: 0 where that is greatest elsewhere
    room: Floats
    # (k, 2) int64, numbers of the corners at the ends of each edge that two triangles share, the lower first
    edges: Longs
    sides: Longs  # (k, 2) int64, the numbers of these two triangles
    length: Longs  # (k,) int64, the squared length of each edge, in square squares
    neck: Bools  # (k,) bool, whether all lines from wall to wall beside the edge are longer

    def opposite(self, edge: int, side: int) -> Longs:
        """Return the corner of one of the two triangles of an edge that is not on the edge."""
        ends = self.edges[edge]
        (other,) = (c for c in self.triangles[self.sides[edge, side]].tolist() if c not in ends)
        point: Longs = self.corners[other]
        return point


def find_walls(free: Bools) -> Walls:
    """Return the triangulated free squares of a screen; everything outside it is blocked."""
    floor = np.pad(free, 1)
    corners, triangles = _triangulate(floor)
    middle = corners[triangles].sum(axis=1) // 3 + 1  # about the middle of a free triangle all squares are free
    triangles = triangles[floor[middle[:, 1], middle[:, 0]]]
    edges, sides, opposite = _shared(triangles)
    ends = corners[edges]
    acute = [_dot(ends[:, 0] - tip, ends[:, 1] - tip) > 0 for tip in (corners[opposite[:, n]] for n in (0, 1))]
    length = _dot(ends[:, 1] - ends[:, 0], ends[:, 1] - ends[:, 0])
    return Walls(corners, triangles, _widths(corners[triangles], floor), edges, sides, length, acute[0] & acute[1])


def _triangulate(floor: Bools) -> tuple[Longs, Longs]:
    """Return the corners of walls and the triangles between them, those over blocked squares included."""
    around = [floor[:-1, :-1], floor[:-1, 1:], floor[1:, :-1], floor[1:, 1:]]
    on_wall = np.logical_or.reduce(around) & ~np.logical_and.reduce(around)
    corners = np.argwhere(on_wall)[:, ::-1].astype(np.int64)
    number = np.zeros(on_wall.shape, np.int64)
    number[on_wall] = np.arange(len(corners))
    found = shapely.get_coordinates(shapely.delaunay_triangles(shapely.multipoints(corners.astype(np.float64))))
    points = np.rint(found).astype(np.int64).reshape(-1, 4, 2)[:, :3]
    return corners, number[points[..., 1], points[..., 0]]


def _shared(triangles: Longs) -> tuple[Longs, Longs, Longs]:
    """Return the edges that two triangles share: their ends, these triangles, and the corners opposite."""
    ends = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
    owner, tip = np.tile(np.arange(len(triangles)), 3), np.concatenate([triangles[:, k] for k in (2, 0, 1)])
    order = np.lexsort((owner, ends[:, 1], ends[:, 0]))
    ends, owner, tip = ends[order], owner[order], tip[order]
    first = np.flatnonzero((ends[1:] == ends[:-1]).all(axis=1))
    pair = np.stack([first, first + 1], axis=1)
    return ends[first], owner[pair], tip[pair]


def _widths(points: Longs, floor: Bools) -> Floats:
    """Return the squared width of the floor about triangles, (m,) float64, in square squares; 0 about obtuse ones."""
    # No corner of a wall lies in the circle through a triangle's corners, so only the side of a wall may come nearer to
    # its centre: straight to the west, east, south or north of it.
    a, b, c = (points[:, k] for k in range(3))
    u, v, w = b - a, c - b, a - c
    sharp = np.flatnonzero((_dot(u, -w) >= 0) & (_dot(v, -u) >= 0) & (_dot(w, -v) >= 0))
    a, u, v, w = a[sharp], u[sharp], v[sharp], w[sharp]
    uu, vv, ww = (_dot(side, side) for side in (u, v, w))
    twice = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]  # the area
    # Twice the way from a to the centre, times `twice`, so that x and y are whole numbers.
    to_centre = np.stack([-u[:, 1] * ww - w[:, 1] * uu, u[:, 0] * ww + w[:, 0] * uu], axis=1)
    column, row = (a + np.floor_divide(to_centre, 2 * twice[:, None])).T + 1  # of the centre's square, on `floor`
    west, east = (runs[row, column] for runs in _free_runs(floor))
    south, north = (runs[column, row] for runs in _free_runs(floor.T))
    found = uu.astype(np.float64) * vv * ww / twice.astype(np.float64) ** 2
    for axis, side in ((0, west), (0, east), (1, south), (1, north)):
        to_side = 2 * (side - 1 - a[:, axis]) * twice - to_centre[:, axis]
        found = np.minimum(found, (to_side / twice) ** 2)
    widths = np.zeros(len(points))
    widths[sharp] = found
    return widths


def _free_runs(floor: Bools) -> tuple[Longs, Longs]:
    """Return where the run of free squares begins and ends in which a square lies, along its row."""
    columns = np.broadcast_to(np.arange(floor.shape[1]), floor.shape)
    begin = np.maximum.accumulate(np.where(floor, 0, columns + 1), axis=1)
    end = np.minimum.accumulate(np.where(floor, floor.shape[1], columns)[:, ::-1], axis=1)[:, ::-1]
    return begin, end


def _dot(u: Longs, v: Longs) -> Longs:
    """Return the inner products of the (n, 2) vectors `u` and `v`, row by row, (n,) int64."""
    product: Longs = u[:, 0] * v[:, 0] + u[:, 1] * v[:, 1]
    return product
