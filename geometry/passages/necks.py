"""Passages: the necks of the floor, each with the walls that form it and how wide the floor is on either side.

# Strategy: cut along all necks (see walls.py), the floor falls apart. From the widest down they are opened again, all
of one width at once: so it is a matter of shape alone, and of no order of squares, what the floor is like on both
sides of a neck before any that is as narrow. Where that is not wide enough on one side, the floor goes on there through
necks just as narrow, or ends. Necks that hang together so are one doorway: a wall of some depth, a passage with a bend
or a niche. What it leads to are its mouths: the outermost of its necks, behind which the floor is wide.
"""

from collections import defaultdict
from collections.abc import Iterable, Iterator
from itertools import groupby
from math import sqrt
from typing import NamedTuple

import numpy as np

from geometry.kernels.arrays import XY, Bools, Longs
from geometry.kernels.jit import compiled
from geometry.passages.walls import Walls

Segment = tuple[XY, XY]
DOOR = 2.0  # times as wide as a door the floor is at least on both sides of it: the definition
HAIR = 1e-6
TIE = 1e-9  # by which squared widths may differ for rounding


class Passage(NamedTuple):
    """A neck of the floor, or a doorway of several just as narrow; all measures in squares."""

    width: float
    """From wall to wall at its narrowest."""
    sides: tuple[float, float]
    """The greatest clearance on either side, before any neck that is narrower."""
    mouths: tuple[Segment, Segment]
    """Where it opens to either side: straight lines on the floor, from wall to wall. The same line twice where it
    has no depth. Of each first the end on the left of who goes from the first side to the second."""
    gates: tuple[XY, XY]
    """The centres of free squares just beyond the mouths."""
    between: tuple[tuple[int, int], ...]
    """The squares (column, row) whose centres lie between the mouths, or on them."""

    @property
    def a(self) -> XY:
        """Its end on the left, halfway between the mouths."""
        return _halfway(self.mouths[0][0], self.mouths[1][0])

    @property
    def b(self) -> XY:
        """Its end on the right, halfway between the mouths."""
        return _halfway(self.mouths[0][1], self.mouths[1][1])

    @property
    def place(self) -> XY:
        """The middle between both ends."""
        return _halfway(self.a, self.b)

    def shifted(self, columns: int, rows: int) -> "Passage":
        """The same passage where the origin lies so many squares further west and south."""

        def there(point: XY) -> XY:
            return point[0] + columns, point[1] + rows

        (a, b), (c, d) = self.mouths
        mouths = (there(a), there(b)), (there(c), there(d))
        between = tuple((column + columns, row + rows) for column, row in self.between)
        return self._replace(mouths=mouths, gates=(there(self.gates[0]), there(self.gates[1])), between=between)


def _halfway(one: XY, other: XY) -> XY:
    return (one[0] + other[0]) / 2, (one[1] + other[1]) / 2


class _Mouth(NamedTuple):
    """An end of a doorway: a neck, on which side of it the floor is wide, the squared width of that floor, and the
    triangles that make it up."""

    edge: int
    side: int
    room: float
    floor: tuple[int, ...]


class _Doorway(NamedTuple):
    """Two mouths, and the squares between them."""

    one: _Mouth
    two: _Mouth
    between: tuple[tuple[int, int], ...]


def find_passages(walls: Walls, pinch: float = DOOR) -> list[Passage]:
    """All passages, by place.

    pinch : how many times as wide as the neck the floor must be on both sides of it, more than 1.
    """
    floor = _Floor(walls)
    found: list[_Doorway] = []
    for edges in _by_width(walls):
        least = pinch**2 * int(walls.length[edges[0]]) - TIE
        if least <= floor.widest:
            for mouths, inner in _clusters(walls, floor, edges, least):
                between = _squares_of(walls, [t for node in inner for t in floor.members[node]])
                found += _doorways(walls, mouths, between)
        for edge in edges:
            floor.join(*walls.sides[edge].tolist())
    taken = {square for doorway in found for square in doorway.between}
    passages = [_passage(walls, doorway, taken) for doorway in found]
    return sorted(passages, key=lambda passage: (passage.place[::-1], passage.width, passage.mouths))


class _Floor:
    """The parts of the floor between necks that are still shut: triangles, joined step by step."""

    def __init__(self, walls: Walls) -> None:
        number = len(walls.triangles)
        self._parent = list(range(number))
        self.members = [[k] for k in range(number)]
        self.room: list[float] = walls.room.tolist()
        """By part, the squared width of the floor in it."""
        self.widest = max(self.room)
        for one, other in walls.sides[~walls.neck].tolist():
            self.join(one, other)

    def of(self, triangle: int) -> int:
        """The part in which a triangle lies."""
        parent = self._parent
        while parent[triangle] != triangle:
            parent[triangle] = triangle = parent[parent[triangle]]
        return triangle

    def join(self, one: int, other: int) -> None:
        """Join the parts of two triangles."""
        a, b = self.of(one), self.of(other)
        if a == b:
            return
        if len(self.members[a]) < len(self.members[b]):
            a, b = b, a
        self._parent[b] = a
        self.members[a] += self.members[b]
        self.members[b] = []
        self.room[a] = max(self.room[a], self.room[b])


def _by_width(walls: Walls) -> Iterator[list[int]]:
    """The necks in groups of one width, the widest first."""
    necks = np.flatnonzero(walls.neck)
    order = necks[np.argsort(-walls.length[necks], kind="stable")].tolist()
    for _, group in groupby(order, key=lambda edge: int(walls.length[edge])):
        yield list(group)


def _clusters(walls: Walls, floor: _Floor, edges: list[int], least: float) -> Iterator[tuple[list[_Mouth], set[int]]]:
    """Necks of one width that hang together through floor that is not so wide: their mouths, and that floor."""
    ends = {edge: [floor.of(triangle) for triangle in walls.sides[edge].tolist()] for edge in edges}
    meeting: dict[int, list[int]] = defaultdict(list)
    for edge in edges:
        for node in set(ends[edge]):
            if floor.room[node] < least:
                meeting[node].append(edge)
    left = dict.fromkeys(edges)
    while left:
        todo, inner, mouths = [next(iter(left))], set(), []
        del left[todo[0]]
        while todo:
            edge = todo.pop()
            for side, node in enumerate(ends[edge]):
                if floor.room[node] >= least:
                    mouths.append((edge, side, node))
                else:
                    inner.add(node)
                for other in meeting[node] if node in inner else ():
                    if other in left:
                        del left[other]
                        todo.append(other)
        if len(mouths) > 1:
            yield [_Mouth(e, side, floor.room[node], tuple(floor.members[node])) for e, side, node in mouths], inner


def _doorways(walls: Walls, mouths: list[_Mouth], between: tuple[tuple[int, int], ...]) -> Iterator[_Doorway]:
    """The doorway of two mouths; or one of no depth in each, where they are more.

    Where three or more meet, what lies between them is floor like other floor.
    """
    if len(mouths) == 2:
        one, two = mouths
        yield _Doorway(one, two, between if one.edge != two.edge else _squares_on(walls, one.edge))
        return
    for mouth in mouths:
        room = max(other.room for other in mouths if other is not mouth)
        inner = _Mouth(mouth.edge, 1 - mouth.side, room, (int(walls.sides[mouth.edge, 1 - mouth.side]),))
        yield _Doorway(mouth, inner, _squares_on(walls, mouth.edge))


def _passage(walls: Walls, doorway: _Doorway, taken: set[tuple[int, int]]) -> Passage:
    """The passage of a doorway. taken : the squares (column, row) between the mouths of any."""
    ways = [(_gate(walls, mouth, taken), mouth) for mouth in (doorway.one, doorway.two)]
    (here, one), (there, two) = sorted(ways, key=lambda way: way[0][::-1])
    return Passage(
        sqrt(float(walls.length[one.edge])),
        (sqrt(one.room) / 2, sqrt(two.room) / 2),
        (_ends(walls, one), _ends(walls, two)[::-1]),
        (here, there),
        doorway.between,
    )


def _ends(walls: Walls, mouth: _Mouth) -> Segment:
    """The ends of a mouth, on the left and right of who comes in by it."""
    p, q = walls.corners[walls.edges[mouth.edge]].tolist()
    x, y = walls.opposite(mouth.edge, mouth.side).tolist()
    leftward = (q[0] - p[0]) * (y - p[1]) - (q[1] - p[1]) * (x - p[0]) > 0
    left, right = (q, p) if leftward else (p, q)
    return (float(left[0]), float(left[1])), (float(right[0]), float(right[1]))


def _gate(walls: Walls, mouth: _Mouth, taken: set[tuple[int, int]]) -> XY:
    """The centre of the square beyond a mouth that is nearest to its middle, in the floor to which it opens."""
    (ax, ay), (bx, by) = _ends(walls, mouth)
    x, y = (ax + bx) / 2, (ay + by) / 2
    found = [
        ((column + 0.5 - x) ** 2 + (row + 0.5 - y) ** 2, row, column)
        for column, row in _squares_of(walls, mouth.floor)
        if (bx - ax) * (row + 0.5 - ay) - (by - ay) * (column + 0.5 - ax) < 0 and (column, row) not in taken
    ]
    if not found:  # in so small a piece of floor no centre lies: the square that begins at the middle
        return np.floor(x + HAIR * (by - ay)) + 0.5, np.floor(y - HAIR * (bx - ax)) + 0.5
    _, row, column = min(found)
    return column + 0.5, row + 0.5


def _squares_of(walls: Walls, triangles: Iterable[int]) -> tuple[tuple[int, int], ...]:
    """The squares whose centres lie in some triangles, or on their edges."""
    return _centres(walls.corners[walls.triangles[list(triangles)]])


def _squares_on(walls: Walls, edge: int) -> tuple[tuple[int, int], ...]:
    """The squares whose centres lie on an edge."""
    return _centres(walls.corners[walls.edges[edge][[0, 1, 1]]][None])


def _centres(triangles: Longs) -> tuple[tuple[int, int], ...]:
    """The squares (column, row) whose centres lie in triangles (n, 3, 2), or on their edges; by row."""
    if not len(triangles):
        return ()
    (west, south), (east, north) = triangles.min(axis=(0, 1)).tolist(), triangles.max(axis=(0, 1)).tolist()
    mask = np.zeros((north - south, east - west), np.bool_)
    mark_centres(2 * (triangles - np.array([west, south])), mask)
    rows, columns = np.nonzero(mask)
    return tuple(zip((columns + west).tolist(), (rows + south).tolist(), strict=True))


@compiled
def mark_centres(triangles: Longs, mask: Bools) -> None:
    """Mark the squares whose centres lie in triangles (n, 3, 2), in half squares, or on their edges."""
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
