"""How far the floor stays narrow about a passage: where its narrowest line may lie if its walls are less thick."""

import numpy as np
import shapely

from geometry.passages.necks import Passage, Segment
from geometry.passages.walls import Walls

HAIR = 1e-6  # squares


def narrow_squares(walls: Walls, passage: Passage, spare: float) -> set[tuple[int, int]]:
    """The squares (column, row) of which a part lies between two lines from wall to wall that are nearly as short.

    The floor is followed from the mouths of the passage on, both ways, for as long as such lines are not longer than
    the passage is wide and so many squares more.
    """
    most = (passage.width + spare) ** 2
    number = {edge: k for k, edge in enumerate(map(tuple, walls.corners[walls.edges].reshape(-1, 4).tolist()))}
    beside: dict[int, list[int]] = {}
    for edge, sides in enumerate(walls.sides.tolist()):
        if walls.length[edge] <= most:
            for triangle in sides:
                beside.setdefault(triangle, []).append(edge)
    todo = [number[key] for mouth in passage.mouths for key in _keys(mouth) if key in number]
    seen, inner = set(todo), set()
    while todo:
        for triangle in walls.sides[todo.pop()].tolist():
            short = beside.get(triangle, [])
            if len(short) > 1:
                inner.add(triangle)
                todo += [edge for edge in short if edge not in seen]
                seen.update(short)
    return _touched(shapely.union_all(shapely.polygons(walls.corners[walls.triangles[sorted(inner)]])))


def _keys(mouth: Segment) -> list[tuple[int, ...]]:
    """A mouth as the corners of an edge, one way and the other."""
    (a, b), (c, d) = mouth
    return [(int(a), int(b), int(c), int(d)), (int(c), int(d), int(a), int(b))]


def _touched(area: shapely.Geometry) -> set[tuple[int, int]]:
    """The squares of which a part lies in an area between corners of squares."""
    if area.is_empty:
        return set()
    x0, y0, x1, y1 = (int(v) for v in area.bounds)
    columns, rows = (v.ravel() for v in np.meshgrid(np.arange(x0, x1), np.arange(y0, y1)))
    shapely.prepare(area)
    some = shapely.intersects(area.buffer(-HAIR), shapely.box(columns, rows, columns + 1, rows + 1))
    return set(zip(columns[some].tolist(), rows[some].tolist(), strict=True))
