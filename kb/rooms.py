"""Doors and rooms. Geometry measures the necks of the floor; kb/asp/rooms.lp says which are doors; the parts between
doors are rooms.

Isolated objects do not count: rooms are made by the verge. What was never seen counts as floor, so that a door is
known by its two jambs, before all is seen of the room behind it.
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from geometry import Screen
from geometry.components import components
from geometry.passages import Passage
from geometry.winding import crossings
from kb.encodings import KB, solve
from kb.protruding import VERGE
from kb.regions import extents
from kb.worldmodel import SMALLEST_WALL, WorldModel

Mask = NDArray[np.bool_]
Floats = NDArray[np.float64]
Indices = tuple[NDArray[np.int64], NDArray[np.int64]]
Window = tuple[slice, slice]
LIKELY = 0.75  # that squares are occupied which are taken for parts of one thing
SURE = 60  # percent: a door is one from here on
LIKELY_DOOR = 25  # percent: what may be a door is tried from here on
BEHIND = 10  # squares that the floor is supposed to go on where it is not seen
DEEPEST = 12.0  # squares: how far a doorway is followed into the wall
STEP = 0.5
PINCHED = 1.9  # times as wide as a neck must the floor be on both sides, for kb/asp to be asked whether it is a door
BEYOND = 1.6  # squares: how far behind the wall a room surely begins
UNCLEAR = 2.0  # squares by which it may be unclear on either side how wide a door is
HALF = 0.5  # probability of being occupied from which a piece of verge bounds a door
JAMB = 0.6  # squares beside a doorway at which its wall is looked for


@dataclass(frozen=True)
class Door:
    """A door, in the frame of the view's arrays.

    a, b : the ends of its neck, on the walls. sides : the rooms on its two sides. confidence : percent.
    """

    name: str
    a: tuple[float, float]
    b: tuple[float, float]
    sides: tuple[int, int]
    confidence: int

    @property
    def sure(self) -> bool:
        """Is it a door beyond reasonable doubt?"""
        return self.confidence >= SURE

    @property
    def likely(self) -> bool:
        """Is it likely enough to be tried?"""
        return self.confidence >= LIKELY_DOOR

    @property
    def width(self) -> float:
        """From wall to wall, in squares."""
        return math.dist(self.a, self.b)

    @property
    def place(self) -> tuple[float, float]:
        """The middle of the neck."""
        return (self.a[0] + self.b[0]) / 2, (self.a[1] + self.b[1]) / 2


@dataclass(frozen=True)
class Rooms:
    """The floor's rooms.

    doors : all that may be doors; rooms end at each of them. labels : (rows, columns) the room of each square of known
    floor, 0 for none; the one in which Utak woke is 1. doorways : (rows, columns) squares between the walls of a door:
    part of no room.
    """

    doors: tuple[Door, ...]
    labels: NDArray[np.int32]
    doorways: Mask

    @property
    def sure(self) -> tuple[Door, ...]:
        """The doors beyond reasonable doubt."""
        return tuple(door for door in self.doors if door.sure)

    def leading(self, room: int, least: int = SURE) -> list[Door]:
        """The doors of a room. least : percent of belief in them."""
        return [door for door in self.doors if door.confidence >= least and room in door.sides]

    def beyond(self, room: int, least: int = SURE) -> Mask:
        """(rows, columns): squares of the rooms that share a door with a room, but for the doorways.

        least : percent of belief in that door.
        """
        others = {side for door in self.leading(room, least) for side in door.sides} - {room}
        mask: Mask = np.isin(self.labels, sorted(others)) & ~self.doorways
        return mask


NOTHING = Rooms((), np.zeros((0, 0), np.int32), np.zeros((0, 0), np.bool_))


def rooms_of(model: WorldModel, rules: tuple[Path, ...] = (), verge: Mask | None = None) -> Rooms:
    """The rooms of a world model. verge : (rows, columns) what bounds them; None for all that is taken for verge."""
    verge = model.verge if verge is None else verge
    if not verge.any():
        return Rooms((), np.ones(verge.shape, np.int32), np.zeros(verge.shape, np.bool_))
    doubtful = verge & (model.view.probability < HALF)  # part of no room, but no bound of a door either
    verge = verge & ~doubtful
    walls, seen_verge = _walls(model), verge & model.view.seen
    necks = [(passage, _known(passage, model, seen_verge, doubtful, walls)) for passage in _passages(verge)]
    possible = _doors(necks, rules)
    floor = ~verge & model.view.seen
    if not floor.any():
        return Rooms((), np.zeros(verge.shape, np.int32), np.zeros(verge.shape, np.bool_))
    labels = Screen(floor).parts([passage for passage, _ in possible])
    sides = [_sides(passage, labels) for passage, _ in possible]
    doorways = np.zeros(verge.shape, np.bool_)
    for (passage, _), (one, other) in zip(possible, sides, strict=True):
        window, doorway = _doorway(passage, verge)
        doorways[window] |= doorway
        ahead, parted = _ahead(passage, window), labels.copy()
        there = parted[window]
        within = doorway & np.isin(there, (one, other)) & (ahead != 0)
        there[within] = np.where(ahead > 0, one, other)[within]
        if np.isin((one, other), parted).all():  # nothing but the doorway is seen of some rooms
            labels = parted
    order = _first(int(labels.max()), int(labels[model.view.locate(*model.lattice.woke)]))
    doors = tuple(
        Door(f"d{number}", passage.a, passage.b, (int(order[one]), int(order[other])), confidence)
        for number, ((passage, confidence), (one, other)) in enumerate(zip(possible, sides, strict=True), 1)
    )
    return Rooms(doors, np.where(doubtful, 0, order[labels]).astype(np.int32), doorways)


def _passages(verge: Mask) -> list[Passage]:
    """The necks of the floor, those at the edge of what is seen too: it may go on behind them."""
    screen = Screen(np.pad(~verge, BEHIND, constant_values=True))
    found = (passage.shifted(-BEHIND, -BEHIND) for passage in screen.passages(PINCHED))
    height, width = verge.shape

    def within(passage: Passage) -> bool:
        return all(0 <= x < width and 0 <= y < height for x, y in (*passage.cut, *passage.gates))

    return [passage for passage in found if within(passage)]


def _doors(necks: Iterable[tuple[Passage, int]], rules: tuple[Path, ...]) -> list[tuple[Passage, int]]:
    """Those necks that kb/asp takes for doors, with its confidence."""
    known = [(passage, certainty) for passage, certainty in necks if certainty > 0]
    facts = []
    for number, (passage, certainty) in enumerate(known):
        width, *sides = (round(10 * size) for size in (passage.width, 2 * passage.sides[0], 2 * passage.sides[1]))
        facts.append(f"neck({number},{width},{sides[0]},{sides[1]},{certainty})")
    answer = solve([KB / "rooms.lp", *rules], facts) if facts else None
    chosen = {a.arguments[0].number: a.arguments[1].number for a in answer or () if a.match("door", 2)}
    return [(known[number][0], confidence) for number, confidence in sorted(chosen.items())]


class _Walls(NamedTuple):
    """What is very likely one thing: (rows, columns) labels, 0 for none, and by label how long it is, in squares.

    What was felt to be verge counts for as long as a wall is at least.
    """

    labels: NDArray[np.int32]
    extents: NDArray[np.int64]


def _walls(model: WorldModel) -> _Walls:
    found = components(model.view.seen & (model.view.probability >= LIKELY))
    long = extents(found.labels, found.number)
    height, width = found.labels.shape
    for row, column in (model.view.locate(*square) for square, colour in model.felt.items() if colour == VERGE):
        label = found.labels[row, column] if 0 <= row < height and 0 <= column < width else 0
        if label:  # verge, however short it is
            long[label] = max(long[label], SMALLEST_WALL)
    return _Walls(found.labels, long)


def _known(passage: Passage, model: WorldModel, verge: Mask, doubtful: Mask, walls: _Walls) -> int:
    """Percent of belief that a neck is open from wall to wall and that its walls are verge.

    Just how wide it is need not be clear: the squares beside its walls tell that, but not whether it is a door.

    verge : (rows, columns) what bounds the floor; doubtful : what may, but rather does not.
    """
    (ax, ay), (bx, by) = passage.a, passage.b
    count = max(2, round(2 * math.dist(passage.a, passage.b)))
    parts = (np.arange(count) + 0.5) / count
    across = _squares(ax + (bx - ax) * parts, ay + (by - ay) * parts, verge.shape)
    inner = np.minimum(parts, 1 - parts) * passage.width >= min(UNCLEAR, passage.width / 4) - 1e-9
    if not (model.view.seen[across] & ~verge[across] & ~(doubtful[across] & inner)).all():
        return 0
    jambs = [jamb(verge, end) for end in (passage.a, passage.b)]
    if not all(len(rows) for rows, _ in jambs):
        return 0
    walled = min(int(walls.extents[walls.labels[jamb]].max()) for jamb in jambs)
    if walled < SMALLEST_WALL:
        return min(50, round(50 * walled / SMALLEST_WALL))
    spare = (min(passage.sides) - passage.width) / 2  # squares: as much wider on both sides it still were a door
    told = verge & model.told
    shares = [
        _share_told(jamb, np.subtract(end, passage.place), min(UNCLEAR, spare), told)
        for end, jamb in zip((passage.a, passage.b), jambs, strict=True)
    ]
    return round(50 + 50 * min(float(model.told[across][inner].mean()), *shares))


def _share_told(jamb: Indices, outward: Floats, furthest: float, told: Mask) -> float:
    """How much of a jamb is surely wall, or of what lies behind it, at most so many squares further outward."""
    ahead = outward / max(float(np.hypot(*outward)), 1e-9)
    shares = []
    for deeper in range(max(math.floor(furthest), 0) + 1):
        dx, dy = np.rint(ahead * deeper).astype(int)
        rows, columns = np.clip(jamb[0] + dy, 0, told.shape[0] - 1), np.clip(jamb[1] + dx, 0, told.shape[1] - 1)
        shares.append(float(told[rows, columns].mean()))
    return max(shares)


def jamb(wall: Mask, end: tuple[float, float]) -> Indices:
    """The squares of a wall that an end of a neck touches, as rows and columns."""
    columns, rows = (sorted({math.floor(v - 0.5), math.floor(v + 0.5)}) for v in end)
    touched = [
        (row, column)
        for row in rows
        for column in columns
        if 0 <= row < wall.shape[0] and 0 <= column < wall.shape[1] and wall[row, column]
    ]
    pairs = np.array(touched, np.int64).reshape(-1, 2)
    return pairs[:, 0], pairs[:, 1]


def _squares(x: Floats, y: Floats, shape: tuple[int, ...]) -> Indices:
    rows = np.clip(np.floor(y).astype(int), 0, shape[0] - 1)
    return rows, np.clip(np.floor(x).astype(int), 0, shape[1] - 1)


def _first(number: int, start: int) -> NDArray[np.int32]:
    """New numbers for so many parts and for 0, so that one of the parts is number 1."""
    order = np.arange(number + 1, dtype=np.int32)
    if start > 0:
        order[[1, start]] = order[[start, 1]]
    return order


def _sides(passage: Passage, labels: NDArray[np.int32]) -> tuple[int, int]:
    one, two = (int(labels[math.floor(y), math.floor(x)]) for x, y in passage.gates)
    return one, two


def _ahead(passage: Passage, window: Window) -> Floats:
    """(rows, columns) of a window: how far each square lies from the line along a neck, positive on its first side.

    The parts of the floor are cut from each other somewhere between the jambs; a room ends at the neck itself.
    """
    neck = np.subtract(passage.b, passage.a)
    normal = np.array([-neck[1], neck[0]]) / max(float(np.hypot(*neck)), 1e-9)
    if np.subtract(passage.towards, passage.place) @ normal < 0:
        normal = -normal
    rows, columns = np.ogrid[window]
    ahead: Floats = (columns + 0.5 - passage.a[0]) * normal[0] + (rows + 0.5 - passage.a[1]) * normal[1]
    return ahead.round(6)


def _doorway(passage: Passage, verge: Mask) -> tuple[Window, Mask]:
    """The squares between the jambs of a neck, and BEYOND squares further on both sides: a window, and which there.

    A neck may lie askew between two thick walls; the doorway is taken along the lattice.
    """
    middle, neck = np.add(passage.a, passage.b) / 2, np.abs(np.subtract(passage.b, passage.a))
    along = np.array([1.0, 0.0]) if neck[0] > neck[1] else np.array([0.0, 1.0])
    across = np.array([-along[1], along[0]])
    half = float(neck @ along) / 2
    jambs = [middle + side * (half + JAMB) * along for side in (-1, 1)]
    depth = [_depth(jambs, sign * across, verge) + BEYOND for sign in (-1, 1)]
    reach = math.ceil(max(half, *depth)) + 2
    row, column = math.floor(middle[1]), math.floor(middle[0])
    height, width = verge.shape
    window = (
        slice(max(row - reach, 0), min(row + reach, height)),
        slice(max(column - reach, 0), min(column + reach, width)),
    )
    rows, columns = np.ogrid[window]
    x, y = columns + 0.5 - middle[0], rows + 0.5 - middle[1]
    sideways, forward = x * along[0] + y * along[1], x * across[0] + y * across[1]
    return window, (np.abs(sideways) <= half + 1) & (-depth[0] < forward) & (forward < depth[1])


def _depth(jambs: list[Floats], ahead: Floats, verge: Mask) -> float:
    """How deep the wall is from the neck in one direction, in squares."""
    depth = 0.0
    while depth < DEEPEST:
        places = [jamb + ahead * (depth + STEP / 2) for jamb in jambs]
        if not all(verge[_squares(np.array([x]), np.array([y]), verge.shape)][0] for x, y in places):
            break
        depth += STEP
    return depth


def crosses(points: Floats, door: Door) -> int:
    """Return how often a line crosses the neck of a door, there and back counted as none.

    points : (n, 2) in the frame of the view's arrays, as for `went_through`.
    """
    a, along = np.array(door.a), np.subtract(door.b, door.a)
    turned = np.column_stack([(points - a) @ along, (points - a) @ np.array([-along[1], along[0]])])
    whole = float(along @ along)
    return abs(crossings(turned, (0.0, 0.0)) - crossings(turned, (whole, 0.0)))


def went_through(track: Floats, door: Door) -> bool:
    """Return whether a track was ever on the other side of a door than it began."""
    return any(crosses(track[: end + 1], door) for end in range(1, len(track)))
