"""Rooms: the parts of the known floor between its doors.

Geometry measures the necks of the floor, and kb/asp/rooms.lp decides which of them are doors. Rooms are bounded by the
verge: isolated objects do not count. Squares that were never seen count as floor, so that a door is known by its two
jambs before the room behind it was seen.

Coordinates are (x, y) in squares in the view frame: origin at the south-west corner of the map view's square [0, 0].
"""

import math
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np

from utak.geometry import Passage, Screen
from utak.geometry.kernels.arrays import XY, Bools, Floats, Ints, Labels, Longs
from utak.geometry.passages.necks import Segment
from utak.geometry.raster.winding import crossings_by_step
from utak.kb.reasoning.encodings import KB_ENCODINGS
from utak.kb.reasoning.solver import solve
from utak.kb.world.doors import DoorwayNeck, find_necks
from utak.kb.world.model import FACT_UNITS_PER_SQUARE, WorldModel

# Percent: confidence from which a neck counts as a door; tuned on random worlds (benchmarks.campaign)
MIN_DOOR_CONFIDENCE = 60
# Percent: confidence from which a neck that may be a door is tried; tuned on random worlds
MIN_TRIED_DOOR_CONFIDENCE = 25
DOORWAY_REACH = 1.6  # squares: how far beyond a mouth the doorway may reach, and a room is not sure to begin; tuned
MAX_MOUTH_DISTANCE = 1.5  # squares from a mouth within which the room behind it begins, where that is seen; tuned
MIN_BOUND_PROBABILITY = 0.5  # verge occupied with at least this probability bounds doors: more likely than not
SAME_DOOR = 1.5  # squares between the middle of a door's neck, as it was or is believed now, and the other neck
NO_ROOM = 0  # the label of floor that is part of no room


@dataclass(frozen=True)
class Door:
    """A door: a neck of the floor at most half as wide as the floor on both sides of it."""

    name: str  # d1, d2, ... in the order of `Rooms.doors`; kb.world.place_names keeps the names in a run.
    # The ends of its neck, on the walls, in squares, view frame (origin at the south-west corner of the map view's
    # square [0, 0]): the left and the right one as seen by a robot that goes from the first of `sides` to the second
    a: XY
    b: XY
    sides: tuple[int, int]  # The numbers of the rooms on its two sides; the same twice when both sides are one room
    confidence: int  # Percent of belief that it is a door

    @property
    def sure(self) -> bool:
        """Whether it counts as a door: a confidence of at least MIN_DOOR_CONFIDENCE percent."""
        return self.confidence >= MIN_DOOR_CONFIDENCE

    @property
    def likely(self) -> bool:
        """Whether it is likely enough to be a door to be tried: at least MIN_TRIED_DOOR_CONFIDENCE percent."""
        return self.confidence >= MIN_TRIED_DOOR_CONFIDENCE

    @property
    def joins(self) -> bool:
        """Whether two rooms are known on its sides; else nothing was seen behind it, or a way round it."""
        return NO_ROOM not in self.sides and self.sides[0] != self.sides[1]

    @property
    def width(self) -> float:
        """The width of its neck from wall to wall, in squares: the least that there may be."""
        return math.dist(self.a, self.b)

    @property
    def width_bound(self) -> float:
        """An upper bound on the width of its neck, in squares: walls may end anywhere in their squares."""
        return self.width + 2 * sum(abs(a - b) for a, b in zip(self.a, self.b, strict=True)) / max(self.width, 1e-9)

    @property
    def place(self) -> XY:
        """The middle of its neck, (x, y) in squares, view frame."""
        return (self.a[0] + self.b[0]) / 2, (self.a[1] + self.b[1]) / 2


class Opening(NamedTuple):
    """A neck that is no door, since the floor is not twice as wide on both sides."""

    # Its ends, on the walls, in squares, view frame (origin at the south-west corner of the map view's square [0, 0])
    a: XY
    b: XY
    least: float  # The width of the floor on the narrower side, in squares
    # The centres of squares just beyond it, on the narrower side and on the wider one; (x, y) in squares, view frame
    narrow: XY
    wide: XY

    @property
    def width(self) -> float:
        """The width of the neck from wall to wall, in squares."""
        return math.dist(self.a, self.b)

    @property
    def place(self) -> XY:
        """The middle of the neck, (x, y) in squares, view frame."""
        return (self.a[0] + self.b[0]) / 2, (self.a[1] + self.b[1]) / 2


@dataclass(frozen=True)
class Rooms:
    """The rooms of the floor."""

    doors: tuple[Door, ...]  # All necks that may be doors, likely or not; rooms end at each of them
    # The number of the room of each square of known floor, 0 for none; the room in which the robot woke is 1. On the
    # arrays of the map view: row 0 in the south, column 0 in the west.
    labels: Labels
    doorways: Bools  # Squares between the walls of a door, and those close to it: they belong to no room for certain
    # Of the necks that are no doors the one that comes nearest to being one; None when there is none
    opening: Opening | None = None

    @property
    def sure(self) -> tuple[Door, ...]:
        """The doors that count as such: with a confidence of at least MIN_DOOR_CONFIDENCE percent; in order."""
        return tuple(door for door in self.doors if door.sure)

    def leading(self, room: int, least: int = MIN_DOOR_CONFIDENCE) -> list[Door]:
        """Return the doors of a room, in the order of `doors`; [] when it has none."""
        return [door for door in self.doors if door.confidence >= least and room in door.sides]

    def far_side(self, place: XY, room: int) -> list[int]:
        """Return the rooms on the other side of the door at a place than a room; [] where no door is there."""
        door = min(self.doors, key=lambda door: math.dist(door.place, place), default=None)
        if door is None or math.dist(door.place, place) > SAME_DOOR:
            return []
        near: set[int] = set() if room in door.sides else {room}
        while (
            more := {side for other in self.doors if other != door and near & {*other.sides} for side in other.sides}
            - near
        ):
            near |= more
        return sorted(set(door.sides) - (near or {room}))

    def most_of(self, squares: Bools, other_than: int = NO_ROOM) -> list[int]:
        """Return the room that holds most of some squares; [] for none, or where it is the one that it may not be."""
        counts = np.bincount(self.labels[squares], minlength=2)
        counts[NO_ROOM] = 0
        most = int(counts.argmax())
        return [] if not counts.any() or most == other_than else [most]

    def beyond(self, room: int, least: int = MIN_DOOR_CONFIDENCE) -> Bools:
        """Return the squares of all rooms that share a door with a room, doorways left out."""
        others = {side for door in self.leading(room, least) for side in door.sides} - {room}
        mask: Bools = np.isin(self.labels, sorted(others)) & ~self.doorways
        return mask


NO_ROOMS = Rooms((), np.zeros((0, 0), np.int32), np.zeros((0, 0), np.bool_))


def rooms_of(model: WorldModel, rules: tuple[Path, ...] = (), verge: Bools | None = None) -> Rooms:
    """Divide the known floor into rooms, and find the doors between them."""
    verge = model.verge if verge is None else verge
    if not verge.any():
        return Rooms((), np.ones(verge.shape, np.int32), np.zeros(verge.shape, np.bool_))
    doubtful = verge & (model.view.probability < MIN_BOUND_PROBABILITY)  # part of no room, but bounds no door
    verge = verge & ~doubtful
    found = find_necks(model, verge, doubtful)
    possible, opening = _judge_necks(found.necks, model, rules)
    floor = ~verge & model.view.seen
    if not floor.any():
        return Rooms((), np.zeros(verge.shape, np.int32), np.zeros(verge.shape, np.bool_))
    labels = np.where(floor, Screen(floor).parts([neck.passage for neck, _ in possible]), -1)
    sides = [_divide_doorway(neck.passage, labels) for neck, _ in possible]
    labels = np.maximum(labels, 0)
    doorways = np.zeros(verge.shape, np.bool_)
    for neck, _ in possible:
        doorways |= _doorway(neck.passage, verge.shape) | found.narrow(neck)
    order = _numbers_from(int(labels.max()), int(labels[model.view.locate(*model.frame.origin)]))
    doors = tuple(
        Door(f"d{number}", *neck.line, (int(order[one]), int(order[other])), confidence)
        for number, ((neck, confidence), (one, other)) in enumerate(zip(possible, sides, strict=True), 1)
    )
    return Rooms(doors, np.where(doubtful, 0, order[labels]).astype(np.int32), doorways & floor, opening)


def _judge_necks(
    necks: list[DoorwayNeck], model: WorldModel, rules: tuple[Path, ...]
) -> tuple[list[tuple[DoorwayNeck, int]], Opening | None]:
    """Return the necks that kb/asp/rooms.lp takes for doors, with its confidence, and the neck nearest to be a door."""
    known = [neck for neck in necks if neck.certainty > 0]
    facts = []
    for number, (passage, _, certainty) in enumerate(known):
        sizes = (passage.width, 2 * passage.sides[0], 2 * passage.sides[1])
        width, one, other = (math.floor(FACT_UNITS_PER_SQUARE * size + 1e-6) for size in sizes)
        facts.append(f"neck({number},{width},{one},{other},{certainty})")
    about = [[[round(v, 3) for v in model.place_to_utak(*end)] for end in neck.line] for neck in known]
    answer = (solve([KB_ENCODINGS / "rooms.lp", *rules], facts, about=about) if facts else None) or ()
    chosen = {a.arguments[0].number: a.arguments[1].number for a in answer if a.match("door", 2)}
    nearest = [known[a.arguments[0].number] for a in answer if a.match("opening", 1)]
    opening = _opening(nearest[0]) if nearest else None
    return [(known[number], confidence) for number, confidence in sorted(chosen.items())], opening


def _opening(neck: DoorwayNeck) -> Opening:
    """Return a neck that is no door as an Opening: the width and the square of its narrower side come first."""
    (least, narrow), (_, wide) = sorted(zip(neck.passage.sides, neck.passage.gates, strict=True))
    return Opening(*neck.line, 2 * least, narrow, wide)


def _numbers_from(number: int, start: int) -> Ints:
    """Return new numbers for the parts 0 to `number`: `start` becomes 1, and 1 becomes `start`; 0 stays."""
    order = np.arange(number + 1, dtype=np.int32)
    if start > 0:
        order[[1, start]] = order[[start, 1]]
    return order


def _divide_doorway(passage: Passage, labels: Labels) -> tuple[int, int]:
    """Return the rooms on both sides of a passage, and divide the doorway between them in `labels`, in place."""
    columns, rows = np.array(passage.between, np.int64).reshape(-1, 2).T
    away = [_distances_to_line(mouth, columns, rows) for mouth in passage.mouths]
    sides = [_label_beyond(passage, number, labels) for number in (0, 1)]
    for number in (0, 1):
        own = (away[number] < away[1 - number]) | ((away[number] == away[1 - number]) & (number == 0))
        inside = own & _within(labels, columns, rows)
        inside[inside] = labels[rows[inside], columns[inside]] == NO_ROOM
        sides[number] = sides[number] or (int(labels.max()) + 1 if inside.any() else 0)
        labels[rows[inside], columns[inside]] = sides[number]
    return sides[0] or sides[1], sides[1] or sides[0]


def _within(labels: Labels, columns: Longs, rows: Longs) -> Bools:
    """Return which of some squares, given by index, lie within an array: (n,) bool."""
    inside: Bools = (rows >= 0) & (columns >= 0) & (rows < labels.shape[0]) & (columns < labels.shape[1])
    return inside


def _label_beyond(passage: Passage, number: int, labels: Labels) -> int:
    """Return the label of the room that begins beyond mouth `number` (0 or 1) of a passage; 0 where none is seen."""
    (x, y), mouth = passage.gates[number], passage.mouths[number]
    rows, columns = np.nonzero(labels > 0)
    (ax, ay), (bx, by) = mouth if number == 0 else mouth[::-1]
    beyond = (bx - ax) * (rows + 0.5 - ay) - (by - ay) * (columns + 0.5 - ax) < 0
    near = beyond & (_distances_to_line(mouth, columns, rows) <= MAX_MOUTH_DISTANCE)
    if not near.any():
        return 0
    rows, columns = rows[near], columns[near]
    first = np.hypot(columns + 0.5 - x, rows + 0.5 - y).argmin()
    return int(labels[rows[first], columns[first]])


def _distances_to_line(line: Segment, columns: Longs, rows: Longs) -> Floats:
    """Return the distances of the centres of squares from a line segment: (n,) float64, in squares."""
    a, along = np.array(line[0]), np.subtract(line[1], line[0])
    points = np.stack([columns + 0.5, rows + 0.5], axis=-1) - a
    part = np.clip(points @ along / (along @ along), 0.0, 1.0)
    away: Floats = np.hypot(*(points - part[..., None] * along).T).round(9)
    return away


def _doorway(passage: Passage, shape: tuple[int, int]) -> Bools:
    """Return the squares in front of both mouths of a passage, up to DOORWAY_REACH squares away."""
    mask = np.zeros(shape, np.bool_)
    for mouth, outward in zip(passage.mouths, (-1, 1), strict=True):
        middle, along = np.add(*mouth) / 2, np.subtract(mouth[1], mouth[0])
        wide = float(np.hypot(*along))
        reach = math.ceil(wide / 2 + DOORWAY_REACH) + 1
        row, column = math.floor(middle[1]), math.floor(middle[0])
        window = slice(max(row - reach, 0), row + reach + 1), slice(max(column - reach, 0), column + reach + 1)
        rows, columns = np.ogrid[: shape[0], : shape[1]]
        x, y = columns[:, window[1]] + 0.5 - middle[0], rows[window[0]] + 0.5 - middle[1]
        sideways, forward = (x * along[0] + y * along[1]) / wide, outward * (y * along[0] - x * along[1]) / wide
        mask[window] |= (np.abs(sideways) <= wide / 2 + 1) & (forward > 0) & (forward < DOORWAY_REACH)
    return mask


def count_crossings(points: Floats, door: Door) -> int:
    """Return the net number of passes of a track through the neck of a door; there and back counts as none."""
    return abs(int(_passes(points, door).sum()))


def went_through(track: Floats, door: Door) -> bool:
    """Return whether a track was ever on the other side of a door than it began; True also when it came back later."""
    return bool(_passes(track, door).cumsum().any())


def _passes(track: Floats, door: Door) -> Longs:
    """Return for each step of a track whether it passes the neck of a door: 1 one way, -1 the other way, else 0."""
    a, along = np.array(door.a), np.subtract(door.b, door.a)
    turned = np.column_stack([(track - a) @ along, (track - a) @ np.array([-along[1], along[0]])])
    near, far = crossings_by_step(turned, np.array([[0.0, 0.0], [float(along @ along), 0.0]]))
    passes: Longs = near - far
    return passes
