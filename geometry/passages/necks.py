"""Passages: the necks of the floor, each with the walls that form it and the width of the floor on either side.

# Strategy: cut along all necks (see walls.py), the floor falls apart. From the widest down the necks are opened again,
all of one width at once. So the floor on both sides of a neck, before any neck that is as narrow, depends on the shape
alone and not on the order of squares. Where that floor is not wide enough on one side, it goes on there through necks
just as narrow, or ends. Necks that hang together so are one doorway: a wall of some depth, a passage with a bend or a
niche. A doorway's mouths are the outermost of its necks, behind which the floor is wide.
"""

from collections import defaultdict
from collections.abc import Iterable, Iterator
from itertools import groupby
from math import sqrt
from typing import NamedTuple

import numpy as np

from utak.geometry.kernels.arrays import XY, Bools, Longs
from utak.geometry.kernels.jit import compiled
from utak.geometry.passages.walls import Walls

Segment = tuple[XY, XY]
DOOR_RATIO = 2.0  # ratio; convention: the floor on both sides of a door is at least so many times as wide as the door
GATE_OFFSET = 1e-6  # share of a mouth's length; convention: the step across the mouth that tells its two sides apart
SQUARED_WIDTH_TOLERANCE = 1e-9  # square units; rounding by which squared widths may differ


class Passage(NamedTuple):
    """A neck of the floor, or a doorway of several equally narrow necks; all measures in squares.

    A neck is a straight line from wall to wall that is shorter than all beside it. Points are (x, y) in squares from
    the south-west corner of the screen, or of the frame into which it was shifted. The first side is that whose gate
    lies further south, or further west if both are in one row; it comes first in every pair. Left and right are those
    of a robot that goes from the first side to the second.

    Attributes
    ----------
    width : from wall to wall at its narrowest.
    sides : the greatest clearance (half the width of the floor) on either side, before any neck that is as narrow.
    mouths : the two straight lines on the floor, from wall to wall, where it opens to either side; the same line twice
        where it has no depth. Each begins with its left end.
    gates : the centres of free squares just beyond the mouths, (x, y).
    between : the squares (column, row) whose centres lie between the mouths, or on them; by row, then by column.
    """

    width: float
    sides: tuple[float, float]
    mouths: tuple[Segment, Segment]
    gates: tuple[XY, XY]
    between: tuple[tuple[int, int], ...]

    @property
    def a(self) -> XY:
        """Return its left end, halfway between the left ends of the mouths, (x, y) in squares.

        Left as seen by a robot that goes from the first side to the second.
        """
        return halfway(self.mouths[0][0], self.mouths[1][0])

    @property
    def b(self) -> XY:
        """Return its right end, halfway between the right ends of the mouths, (x, y) in squares.

        Right as seen by a robot that goes from the first side to the second.
        """
        return halfway(self.mouths[0][1], self.mouths[1][1])

    @property
    def place(self) -> XY:
        """Return the midpoint between its left and its right end, (x, y) in squares."""
        return halfway(self.a, self.b)

    def shifted(self, columns: int, rows: int) -> "Passage":
        """Return the same passage in a frame whose origin lies that many squares further west and south; a new one.

        Its width and its sides stay; mouths, gates and the squares between are moved. `columns` is added to every x and
        column, `rows` to every y and row.
        """

        def there(point: XY) -> XY:
            """Return a point (x, y) in that frame."""
            return point[0] + columns, point[1] + rows

        (a, b), (c, d) = self.mouths
        mouths = (there(a), there(b)), (there(c), there(d))
        between = tuple((column + columns, row + rows) for column, row in self.between)
        return self._replace(mouths=mouths, gates=(there(self.gates[0]), there(self.gates[1])), between=between)


def halfway(one: XY, other: XY) -> XY:
    """Return the midpoint of two points, `one` and `other`, (x, y), in their unit and frame."""
    return (one[0] + other[0]) / 2, (one[1] + other[1]) / 2


class _Mouth(NamedTuple):
    """An end of a doorway."""

    edge: int  # the number of the neck, an edge of the triangulation (`Walls.edges`).
    side: int  # the side of the neck on which the floor is wide, 0 or 1: an index in `Walls.sides`.
    room: float  # the squared width of that floor, in square squares
    floor: tuple[int, ...]  # the numbers of the triangles of that floor (`Walls.triangles`).


class _Doorway(NamedTuple):
    """Two mouths, and the squares (column, row) whose centres lie between them."""

    one: _Mouth  # the mouths, in no particular order
    two: _Mouth
    between: tuple[tuple[int, int], ...]  # the squares (column, row), by row


def find_passages(walls: Walls, pinch: float = DOOR_RATIO) -> list[Passage]:
    """Return all passages, ordered by place: row (from the south), then column; an empty list when there are none."""
    floor = _Floor(walls)
    found: list[_Doorway] = []
    for edges in _necks_by_width(walls):
        least = pinch**2 * int(walls.length[edges[0]]) - SQUARED_WIDTH_TOLERANCE
        if least <= floor.widest:
            for mouths, inner in _clusters(walls, floor, edges, least):
                between = _squares_of(walls, [t for node in inner for t in floor.members[node]])
                found += _doorways(walls, mouths, between)
        for edge in edges:
            floor.join(*walls.sides[edge].tolist())
    taken = np.array([square for doorway in found for square in doorway.between], np.int64).reshape(-1, 2)
    passages = [_passage(walls, doorway, taken) for doorway in found]
    return sorted(passages, key=lambda passage: (passage.place[::-1], passage.width, passage.mouths))


class _Floor:
    """The parts of the floor between necks that are still closed: a union-find over triangles."""

    def __init__(self, walls: Walls) -> None:
        """Join the triangles of `walls` over all edges that are no necks."""
        number = len(walls.triangles)
        self._parent = list(range(number))
        self.members = [[k] for k in range(number)]
        self.room: list[float] = walls.room.tolist()
        """By part, the squared width of the floor in it."""
        self.widest = max(self.room)
        for one, other in walls.sides[~walls.neck].tolist():
            self.join(one, other)

    def of(self, triangle: int) -> int:
        """Return the representative of the part in which a triangle lies: the number of a triangle."""
        parent = self._parent
        while parent[triangle] != triangle:
            parent[triangle] = triangle = parent[parent[triangle]]
        return triangle

    def join(self, one: int, other: int) -> None:
        """Join the parts in which two triangles lie, given by number; no change when they are one part already."""
        a, b = self.of(one), self.of(other)
        if a == b:
            return
        if len(self.members[a]) < len(self.members[b]):
            a, b = b, a
        self._parent[b] = a
        self.members[a] += self.members[b]
        self.members[b] = []
        self.room[a] = max(self.room[a], self.room[b])


def _necks_by_width(walls: Walls) -> Iterator[list[int]]:
    """Yield the necks in groups of equal width, widest first; each is a list of numbers of edges of `walls`."""
    necks = np.flatnonzero(walls.neck)
    order = necks[np.argsort(-walls.length[necks], kind="stable")].tolist()
    for _, group in groupby(order, key=lambda edge: int(walls.length[edge])):
        yield list(group)


def _clusters(walls: Walls, floor: _Floor, edges: list[int], least: float) -> Iterator[tuple[list[_Mouth], set[int]]]:
    """Yield the necks of one width that hang together through narrower floor: mouths, and parts of that floor."""
    ends = {edge: [floor.of(triangle) for triangle in walls.sides[edge].tolist()] for edge in edges}
    meeting: dict[int, list[int]] = defaultdict(list)
    for edge in edges:
        for node in set(ends[edge]):
            if floor.room[node] < least:
                meeting[node].append(edge)
    left = dict.fromkeys(edges)
    while left:
        queue, inner, mouths = [next(iter(left))], set(), []
        del left[queue[0]]
        while queue:
            edge = queue.pop()
            for side, node in enumerate(ends[edge]):
                if floor.room[node] >= least:
                    mouths.append((edge, side, node))
                else:
                    inner.add(node)
                for other in meeting[node] if node in inner else ():
                    if other in left:
                        del left[other]
                        queue.append(other)
        if len(mouths) > 1:
            yield [_Mouth(e, side, floor.room[node], tuple(floor.members[node])) for e, side, node in mouths], inner


def _doorways(walls: Walls, mouths: list[_Mouth], between: tuple[tuple[int, int], ...]) -> Iterator[_Doorway]:
    """Yield the doorway of two mouths; of more mouths, a doorway of no depth in each, in the order of `mouths`."""
    if len(mouths) == 2:
        one, two = mouths
        yield _Doorway(one, two, between if one.edge != two.edge else _squares_on(walls, one.edge))
        return
    for mouth in mouths:
        room = max(other.room for other in mouths if other is not mouth)
        inner = _Mouth(mouth.edge, 1 - mouth.side, room, (int(walls.sides[mouth.edge, 1 - mouth.side]),))
        yield _Doorway(mouth, inner, _squares_on(walls, mouth.edge))


def _passage(walls: Walls, doorway: _Doorway, taken: Longs) -> Passage:
    """Return the passage of a doorway, with the side whose gate is further south, then west, as the first."""
    gates = [(_gate(walls, mouth, taken), mouth) for mouth in (doorway.one, doorway.two)]
    (here, one), (there, two) = sorted(gates, key=lambda way: way[0][::-1])
    return Passage(
        sqrt(float(walls.length[one.edge])),
        (sqrt(one.room) / 2, sqrt(two.room) / 2),
        (_mouth_ends(walls, one), _mouth_ends(walls, two)[::-1]),
        (here, there),
        doorway.between,
    )


def _mouth_ends(walls: Walls, mouth: _Mouth) -> Segment:
    """Return the ends of a mouth, first that on the left, then that on the right of a robot that enters by it."""
    p, q = walls.corners[walls.edges[mouth.edge]].tolist()
    x, y = walls.opposite(mouth.edge, mouth.side).tolist()
    leftward = (q[0] - p[0]) * (y - p[1]) - (q[1] - p[1]) * (x - p[0]) > 0
    left, right = (q, p) if leftward else (p, q)
    return (float(left[0]), float(left[1])), (float(right[0]), float(right[1]))


def _gate(walls: Walls, mouth: _Mouth, taken: Longs) -> XY:
    """Return the centre of the square beyond a mouth that is nearest to its midpoint, in the floor it opens to."""
    (ax, ay), (bx, by) = _mouth_ends(walls, mouth)
    x, y = (ax + bx) / 2, (ay + by) / 2
    mask, west, south = _centre_mask(walls.corners[walls.triangles[list(mouth.floor)]])
    at = taken[:, ::-1] - (south, west)
    at = at[((at >= 0) & (at < mask.shape)).all(axis=1)]
    mask[at[:, 0], at[:, 1]] = False
    rows, columns = np.nonzero(mask)
    across, up = columns + (west + 0.5), rows + (south + 0.5)
    beyond = (bx - ax) * (up - ay) - (by - ay) * (across - ax) < 0
    across, up = across[beyond], up[beyond]
    if not len(across):  # no centre lies in so small a piece of floor: take the square that begins at the midpoint
        return np.floor(x + GATE_OFFSET * (by - ay)) + 0.5, np.floor(y - GATE_OFFSET * (bx - ax)) + 0.5
    nearest = int(np.argmin((across - x) ** 2 + (up - y) ** 2))  # of several the one first by row, then by column
    return float(across[nearest]), float(up[nearest])


def _squares_of(walls: Walls, triangles: Iterable[int]) -> tuple[tuple[int, int], ...]:
    """Return the squares (column, row) whose centres lie in some triangles, or on their edges; by row."""
    return _centres(walls.corners[walls.triangles[list(triangles)]])


def _squares_on(walls: Walls, edge: int) -> tuple[tuple[int, int], ...]:
    """Return the squares (column, row) whose centres lie on an edge, given by its number in `walls`; by row."""
    return _centres(walls.corners[walls.edges[edge][[0, 1, 1]]][None])


def _centres(triangles: Longs) -> tuple[tuple[int, int], ...]:
    """Return the squares (column, row) whose centres lie in triangles, or on their edges; by row."""
    mask, west, south = _centre_mask(triangles)
    rows, columns = np.nonzero(mask)
    return tuple(zip((columns + west).tolist(), (rows + south).tolist(), strict=True))


def _centre_mask(triangles: Longs) -> tuple[Bools, int, int]:
    """Return a mask of the squares whose centres lie in triangles, or on their edges, and its corner."""
    if not len(triangles):
        return np.zeros((0, 0), np.bool_), 0, 0
    (west, south), (east, north) = triangles.min(axis=(0, 1)).tolist(), triangles.max(axis=(0, 1)).tolist()
    mask = np.zeros((north - south, east - west), np.bool_)
    mark_centres(2 * (triangles - np.array([west, south])), mask)
    return mask, west, south


@compiled
def mark_centres(triangles: Longs, mask: Bools) -> None:
    """Set `mask` at the squares whose centres lie in triangles, or on their edges."""
    for n in range(triangles.shape[0]):
        (ax, ay), (bx, by), (cx, cy) = triangles[n, 0], triangles[n, 1], triangles[n, 2]
        for row in range(min(ay, by, cy) // 2, max(ay, by, cy) // 2):
            for column in range(min(ax, bx, cx) // 2, max(ax, bx, cx) // 2):
                x, y = 2 * column + 1, 2 * row + 1
                one = (bx - ax) * (y - ay) - (by - ay) * (x - ax)
                two = (cx - bx) * (y - by) - (cy - by) * (x - bx)
                three = (ax - cx) * (y - cy) - (ay - cy) * (x - cx)
                left = one >= 0 and two >= 0 and three >= 0
                mask[row, column] |= left or (one <= 0 and two <= 0 and three <= 0)
