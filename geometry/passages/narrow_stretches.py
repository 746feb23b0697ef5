"""Narrow stretches about a passage: where its narrowest line may lie if its walls are less thick than they seem."""

import numpy as np
import shapely

from utak.geometry.passages.necks import Passage, Segment
from utak.geometry.passages.walls import Walls

TOUCH_TOLERANCE = 1e-6  # squares; convention: what an area loses at its edge, so that mere contact does not count


def narrow_squares(walls: Walls, passage: Passage, spare: float) -> set[tuple[int, int]]:
    """Return the squares (column, row) between lines from wall to wall nearly as short as a passage is wide."""
    # The set is empty when the passage is none of this floor.
    edges = np.flatnonzero(walls.length <= (passage.width + spare) ** 2)
    ends = map(tuple, walls.corners[walls.edges[edges]].reshape(-1, 4).tolist())
    edge_of = dict(zip(ends, edges.tolist(), strict=True))
    short_edges_of: dict[int, list[int]] = {}
    for edge, sides in zip(edges.tolist(), walls.sides[edges].tolist(), strict=True):
        for triangle in sides:
            short_edges_of.setdefault(triangle, []).append(edge)
    queue = [edge_of[key] for mouth in passage.mouths for key in _edge_keys(mouth) if key in edge_of]
    seen, inner = set(queue), set()
    while queue:
        for triangle in walls.sides[queue.pop()].tolist():
            short = short_edges_of.get(triangle, [])
            if len(short) > 1:
                inner.add(triangle)
                queue += [edge for edge in short if edge not in seen]
                seen.update(short)
    return _touched_squares(shapely.union_all(shapely.polygons(walls.corners[walls.triangles[sorted(inner)]])))


def _edge_keys(mouth: Segment) -> list[tuple[int, ...]]:
    """Return a mouth as the corners of an edge, in both directions: two tuples x, y, x, y of whole numbers."""
    (a, b), (c, d) = mouth
    return [(int(a), int(b), int(c), int(d)), (int(c), int(d), int(a), int(b))]


def _touched_squares(area: shapely.Geometry) -> set[tuple[int, int]]:
    """Return the squares (column, row) of which a part lies in an area between corners of squares."""
    if area.is_empty:
        return set()
    x0, y0, x1, y1 = (int(v) for v in area.bounds)
    columns, rows = (v.ravel() for v in np.meshgrid(np.arange(x0, x1), np.arange(y0, y1)))
    shapely.prepare(area)
    touched = shapely.intersects(area.buffer(-TOUCH_TOLERANCE), shapely.box(columns, rows, columns + 1, rows + 1))
    return set(zip(columns[touched].tolist(), rows[touched].tolist(), strict=True))
