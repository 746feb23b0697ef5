"""Doors and rooms. Geometry measures the necks of the floor; kb/asp/rooms.lp says which are doors; the parts between
doors are rooms.

Isolated objects do not count: rooms are made by the verge. What was never seen counts as floor, so that a door is
known by its two jambs, before all is seen of the room behind it.
"""

import math
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from geometry import Passage, Screen
from geometry.raster.winding import crossings
from kb.reasoning.solver import KB, solve
from kb.world.doors import DoorwayNeck, Segment, find_necks
from kb.world.model import WorldModel

Mask = NDArray[np.bool_]
Floats = NDArray[np.float64]
Labels = NDArray[np.int32]
Longs = NDArray[np.int64]
SURE = 60  # percent: a door is one from here on
LIKELY_DOOR = 25  # percent: what may be a door is tried from here on
BEYOND = 1.6  # squares: how far behind the wall a room surely begins
AT_MOUTH = 1.5  # squares from a mouth within which the room behind it begins, where that is seen
HALF = 0.5  # probability of being occupied from which a piece of verge bounds a door
HUNDREDTHS = 100
DOORWAY = 0  # the label of floor that is part of no room


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


class Opening(NamedTuple):
    """A neck that is no door, for the floor is not twice as wide on both sides; in the frame of the view's arrays.

    a, b : its ends, on the walls. least : how wide the floor is on the narrower side, in squares. narrow, wide : the
    centres of squares just beyond it on that side, and on the other.
    """

    a: tuple[float, float]
    b: tuple[float, float]
    least: float
    narrow: tuple[float, float]
    wide: tuple[float, float]

    @property
    def width(self) -> float:
        """From wall to wall, in squares."""
        return math.dist(self.a, self.b)

    @property
    def place(self) -> tuple[float, float]:
        """The middle of it."""
        return (self.a[0] + self.b[0]) / 2, (self.a[1] + self.b[1]) / 2


@dataclass(frozen=True)
class Rooms:
    """The floor's rooms.

    doors : all that may be doors; rooms end at each of them. labels : (rows, columns) the room of each square of known
    floor, 0 for none; the one in which Utak woke is 1. doorways : (rows, columns) squares between the walls of a door,
    and those close to it: they belong to no room for certain. opening : the neck that comes nearest to be a door, of
    those that are none.
    """

    doors: tuple[Door, ...]
    labels: NDArray[np.int32]
    doorways: Mask
    opening: Opening | None = None

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
    found = find_necks(model, verge, doubtful)
    possible, opening = _judged(found.necks, rules)
    floor = ~verge & model.view.seen
    if not floor.any():
        return Rooms((), np.zeros(verge.shape, np.int32), np.zeros(verge.shape, np.bool_))
    labels = np.where(floor, Screen(floor).parts([neck.passage for neck, _ in possible]), -1)
    sides = [_sides(neck.passage, labels) for neck, _ in possible]
    labels = np.maximum(labels, 0)
    doorways = np.zeros(verge.shape, np.bool_)
    for neck, _ in possible:
        doorways |= _doorway(neck.passage, verge.shape) | found.narrow(neck)
    order = _first(int(labels.max()), int(labels[model.view.locate(*model.frame.origin)]))
    doors = tuple(
        Door(f"d{number}", *neck.line, (int(order[one]), int(order[other])), confidence)
        for number, ((neck, confidence), (one, other)) in enumerate(zip(possible, sides, strict=True), 1)
    )
    return Rooms(doors, np.where(doubtful, 0, order[labels]).astype(np.int32), doorways & floor, opening)


def _judged(found: list[DoorwayNeck], rules: tuple[Path, ...]) -> tuple[list[tuple[DoorwayNeck, int]], Opening | None]:
    """Those necks that kb/asp takes for doors, with its confidence, and the one that comes nearest to be a door."""
    known = [neck for neck in found if neck.certainty > 0]
    facts = []
    for number, (passage, _, certainty) in enumerate(known):
        sizes = (passage.width, 2 * passage.sides[0], 2 * passage.sides[1])
        width, one, other = (math.floor(HUNDREDTHS * size + 1e-6) for size in sizes)
        facts.append(f"neck({number},{width},{one},{other},{certainty})")
    answer = (solve([KB / "rooms.lp", *rules], facts) if facts else None) or ()
    chosen = {a.arguments[0].number: a.arguments[1].number for a in answer if a.match("door", 2)}
    nearest = [known[a.arguments[0].number] for a in answer if a.match("opening", 1)]
    opening = _opening(nearest[0]) if nearest else None
    return [(known[number], confidence) for number, confidence in sorted(chosen.items())], opening


def _opening(neck: DoorwayNeck) -> Opening:
    """A neck that is no door, as it is told."""
    (least, narrow), (_, wide) = sorted(zip(neck.passage.sides, neck.passage.gates, strict=True))
    return Opening(*neck.line, 2 * least, narrow, wide)


def _first(number: int, start: int) -> NDArray[np.int32]:
    """New numbers for so many parts and for 0, so that one of the parts is number 1."""
    order = np.arange(number + 1, dtype=np.int32)
    if start > 0:
        order[[1, start]] = order[[start, 1]]
    return order


def _sides(passage: Passage, labels: Labels) -> tuple[int, int]:
    """The rooms on both sides of a passage; the doorway is divided between them, in place.

    Where nothing is seen behind it but the doorway, that is a room of its own.
    """
    columns, rows = np.array(passage.between, np.int64).reshape(-1, 2).T
    away = [_from_line(mouth, columns, rows) for mouth in passage.mouths]
    sides = [_label_beyond(passage, number, labels) for number in (0, 1)]
    for number in (0, 1):
        own = (away[number] < away[1 - number]) | ((away[number] == away[1 - number]) & (number == 0))
        inside = own & _within(labels, columns, rows)
        inside[inside] = labels[rows[inside], columns[inside]] == DOORWAY
        sides[number] = sides[number] or (int(labels.max()) + 1 if inside.any() else 0)
        labels[rows[inside], columns[inside]] = sides[number]
    return sides[0] or sides[1], sides[1] or sides[0]


def _within(labels: Labels, columns: Longs, rows: Longs) -> Mask:
    """Which squares lie in an array."""
    inside: Mask = (rows >= 0) & (columns >= 0) & (rows < labels.shape[0]) & (columns < labels.shape[1])
    return inside


def _label_beyond(passage: Passage, number: int, labels: Labels) -> int:
    """The room that begins behind one of the mouths of a passage; 0 where none is seen."""
    (x, y), mouth = passage.gates[number], passage.mouths[number]
    rows, columns = np.nonzero(labels > 0)
    (ax, ay), (bx, by) = mouth if number == 0 else mouth[::-1]
    beyond = (bx - ax) * (rows + 0.5 - ay) - (by - ay) * (columns + 0.5 - ax) < 0
    near = beyond & (_from_line(mouth, columns, rows) <= AT_MOUTH)
    if not near.any():
        return 0
    rows, columns = rows[near], columns[near]
    first = np.hypot(columns + 0.5 - x, rows + 0.5 - y).argmin()
    return int(labels[rows[first], columns[first]])


def _from_line(line: Segment, columns: Longs, rows: Longs) -> Floats:
    """How far the centres of squares lie from a line, in squares."""
    a, along = np.array(line[0]), np.subtract(line[1], line[0])
    points = np.stack([columns + 0.5, rows + 0.5], axis=-1) - a
    part = np.clip(points @ along / (along @ along), 0.0, 1.0)
    away: Floats = np.hypot(*(points - part[..., None] * along).T).round(9)
    return away


def _doorway(passage: Passage, shape: tuple[int, int]) -> Mask:
    """(rows, columns): the squares just before the mouths of a passage, as far as BEYOND."""
    mask = np.zeros(shape, np.bool_)
    for mouth, outward in zip(passage.mouths, (-1, 1), strict=True):
        middle, along = np.add(*mouth) / 2, np.subtract(mouth[1], mouth[0])
        wide = float(np.hypot(*along))
        reach = math.ceil(wide / 2 + BEYOND) + 1
        row, column = math.floor(middle[1]), math.floor(middle[0])
        window = slice(max(row - reach, 0), row + reach + 1), slice(max(column - reach, 0), column + reach + 1)
        rows, columns = np.ogrid[: shape[0], : shape[1]]
        x, y = columns[:, window[1]] + 0.5 - middle[0], rows[window[0]] + 0.5 - middle[1]
        sideways, forward = (x * along[0] + y * along[1]) / wide, outward * (y * along[0] - x * along[1]) / wide
        mask[window] |= (np.abs(sideways) <= wide / 2 + 1) & (forward > 0) & (forward < BEYOND)
    return mask


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
