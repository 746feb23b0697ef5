"""The confidence of facts about places: rooms of things, what touches what, doors, their widths, and corners.

Percent. 100 is stated only of what no completion of the map can change, 0 only of what cannot be: whatever lies between
them is at least 1 and at most 99. Arrays are [row, column] on those of the model's view; points are (x, y) in squares.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from utak.geometry import Screen
from utak.geometry.kernels.arrays import XY, Bools, Floats
from utak.geometry.raster.components import components, with_edge_neighbours
from utak.kb.language.vocabulary import MAX_TABLE_SIDE
from utak.kb.mapping.occupancy import FREE, OCCUPIED, OPEN
from utak.kb.perception.interpretation import LONGEST_OBJECT, counted_percent
from utak.kb.perception.regions import extents
from utak.kb.world.corners import Corner
from utak.kb.world.doors import ENCODED_DOOR_RATIO, MAX_UNWALLED, jamb
from utak.kb.world.model import ROOT_NODE, VERGE_NODE, Node, WorldModel
from utak.kb.world.rooms import NO_ROOM, Door, Rooms

MIDDLE_MARGIN = 1.0  # squares: each side of an outline lies less than that within its squares, so its middle does, too
MAX_DOOR_WIDTH = math.hypot(MAX_TABLE_SIDE, MAX_TABLE_SIDE)  # squares: no line on a table is longer; derived


class Widths(NamedTuple):
    """Between what bounds the width of a door lies."""

    least: float  # in squares
    most: float


def measured(chance: float) -> int:
    """Return a chance as it was measured, 0 to 1, in percent: neither 0 nor 100."""
    return min(max(int(100 * chance), 1), 99)


class _Spread(NamedTuple):
    """The shares that squares of a part of the view have of where a point may be."""

    south: int  # the row and the column of the part's square [0, 0]
    west: int
    weights: Floats  # 1 together, or less: the rest is outside of the view

    @property
    def mean(self) -> XY:
        """The mean of where it may be, in squares, frame of the view's arrays."""
        rows, columns = np.indices(self.weights.shape)
        total = max(float(self.weights.sum()), 1e-9)
        x, y = (float((at * self.weights).sum()) / total + 0.5 for at in (columns, rows))
        return self.west + x, self.south + y


class _Body(NamedTuple):
    """A thing, the verge or the robot: the squares that it may cover, on a part of the view."""

    south: int  # the row and the column of the part's square [0, 0]; may be negative
    west: int
    chance: Floats  # that it covers a square, 0 to 1
    sure: Bools  # whether it covers a square beyond doubt

    def about(self) -> "_Body":
        """Return the same of the squares on which it is, or next to which it is, one square further to each side."""
        return _Body(self.south - 1, self.west - 1, _greatest_beside(self.chance), _greatest_beside(self.sure))


def _greatest_beside(values: NDArray[Any]) -> NDArray[Any]:
    """Return the greatest value in the 3 x 3 squares about each square, one square further to each side."""
    rows, columns = values.shape
    padded = np.pad(values, 2)
    parts = [padded[i : i + rows + 2, j : j + columns + 2] for i in range(3) for j in range(3)]
    greatest: NDArray[Any] = np.maximum.reduce(parts)
    return greatest


class Chances:
    """The confidence of the facts about places of one world model.

    What is not certain has a case and a measure: by `rate` it becomes a confidence, as it was counted. The measure is a
    chance in percent; of doors, by case: the squares known of the smaller of their two rooms, where what is as long as
    a wall bounds them (door_walled) or not (door_unwalled), or on a map that was begun anew (door_anew); the width in
    squares, where one room is known (door_alone).
    """

    def __init__(self, model: WorldModel, rooms: Rooms, rate: Callable[[str, int], int] = counted_percent) -> None:
        self.model, self.rooms, self._rate = model, rooms, rate
        view = model.view
        self.is_sure = model.beyond_doubt
        self._open = view.state == OPEN
        self._surely_free, self._surely_occupied = (model.certain & (view.state == state) for state in (FREE, OCCUPIED))

    # ---- Rooms ----

    def rooms_of(self, node: Node | None) -> list[tuple[int, int]]:
        """Return the rooms in which the middle of an object may lie, or the robot (None), with percent, by number."""
        # The room with the greatest share has what was counted for such shares; the others share what that leaves.
        middle, exact = self._robot_middle() if node is None else self._middle(node)
        shares, is_clear = self._shares(middle)
        shares.pop(NO_ROOM, None)
        if not shares:
            return []
        if exact and self.is_sure and is_clear and len(shares) == 1 and all(map(self._is_settled, shares)):
            return [(room, self._persisting(100, node)) for room in shares]
        whole, first = sum(shares.values()), min(shares, key=lambda room: (-shares[room], room))
        sure = self._rate("in_robot" if node is None else "in_thing", measured(shares[first] / whole))
        left = whole - shares[first]
        found = {room: int((100 - sure) * share / left) for room, share in shares.items() if room != first}
        now = ((room, self._persisting(share, node)) for room, share in (*found.items(), (first, sure)))
        return sorted((room, share) for room, share in now if share > 0)

    @staticmethod
    def _persisting(percent: int, *nodes: Node | None) -> int:
        """Return the percent of what was so when things were last in sight, as far as they still lie there."""
        for node in nodes:
            percent = percent if node is None else percent * node.persists // 100
        return percent

    def _is_settled(self, room: int) -> bool:
        """Return whether no door can part a room: none is in it, nothing about it is open, and no thing may be wall."""
        inside = self.rooms.labels == room
        about = with_edge_neighbours(inside)
        unsure = (self.model.mask(node.patch) for node in self.model.objects if node.confidence < 100)
        if any((mask & about).any() for mask in unsure):
            return False
        at_edge = bool(inside[[0, -1]].any() or inside[:, [0, -1]].any())
        settled = self._surely_free | self._surely_occupied
        return not at_edge and bool(settled[about].all()) and all(d.sides != (room, room) for d in self.rooms.doors)

    def _robot_middle(self) -> tuple[_Spread, bool]:
        """Return in which squares the robot may stand, and whether it is surely there."""
        height, width = self.rooms.labels.shape
        if self.model.lost:
            return _Spread(0, 0, np.full((height, width), 1 / (height * width))), False
        placed = {self.model.view.locate(x, y): share for (x, y), share in self.model.robot_squares.items()}
        rows, columns = zip(*placed, strict=True)
        south, west = max(min(rows), 0), max(min(columns), 0)
        weights = np.zeros((max(min(max(rows) + 1, height) - south, 0), max(min(max(columns) + 1, width) - west, 0)))
        for (row, column), share in placed.items():
            if 0 <= row < height and 0 <= column < width:
                weights[row - south, column - west] = share
        return _Spread(south, west, weights), True

    def _middle(self, node: Node) -> tuple[_Spread, bool]:
        """Return where the middle of an object may be, whatever open squares it covers."""
        body = self._body(node)
        sides = [_ends_of_mean(body, axis) for axis in (1, 0)]
        (west, east), (south, north) = (
            (start + low, start + high) for start, (low, high) in zip((body.west, body.south), sides, strict=True)
        )
        height, width = self.rooms.labels.shape
        columns, along = _overlaps(west - MIDDLE_MARGIN, east + MIDDLE_MARGIN, width)
        rows, up = _overlaps(south - MIDDLE_MARGIN, north + MIDDLE_MARGIN, height)
        return _Spread(rows.start, columns.start, up[:, None] * along[None, :]), bool(body.sure.any())

    def _shares(self, middle: _Spread) -> tuple[dict[int, float], bool]:
        """Return the share that each room has of where something may be, and whether that is surely within rooms."""
        labels, (south, west, weights) = self.rooms.labels, middle
        rows, columns = (slice(at, at + size) for at, size in zip((south, west), weights.shape, strict=True))
        inside, near = labels[rows, columns], self.rooms.doorways[rows, columns]
        counts = np.bincount(inside.ravel(), (weights * np.where(near, 0.5, 1.0)).ravel())
        shares = {room: float(share) for room, share in enumerate(counts.tolist()) if share > 0}
        for room, share in enumerate(np.bincount(inside[near], weights[near]).tolist()):
            other = self._behind_door(room, middle.mean)
            shares[other] = shares.get(other, 0.0) + share / 2  # near a door: as likely on its other side
        outside = 1.0 - sum(shares.values())
        return {room: share for room, share in shares.items() if share > 0}, not near.any() and outside < 1e-9

    def _behind_door(self, room: int, middle: XY) -> int:
        """Return the room on the other side of the nearest door of a room; the room itself for none."""
        doors = [door for door in self.rooms.doors if room in door.sides]
        if not doors:
            return room
        nearest = min(doors, key=lambda door: math.dist(door.place, middle))
        return nearest.sides[1] if nearest.sides[0] == room else nearest.sides[0]

    # ---- What touches what ----

    def adjacencies(self) -> Iterator[tuple[str, str, int]]:
        """Yield pairs of things that may touch, each once, with percent: objects, the verge and the robot."""
        bodies = {node.name: self._body(node) for node in self.model.objects}
        about = {name: body.about() for name, body in bodies.items()}
        robot, verge = self._robot().about(), _Body(0, 0, self._verge_chances, self._sure_verge)
        names = list(bodies)
        for number, name in enumerate(names):
            yield from self._touching(ROOT_NODE, robot, name, bodies[name])
            without = self._without(verge, self.model.object(name), about[name])
            yield from self._touching(name, about[name], VERGE_NODE, without)
            for other in names[number + 1 :]:
                yield from self._touching(name, about[name], other, bodies[other])
        yield from self._touching(ROOT_NODE, robot, VERGE_NODE, verge)

    def _touching(self, name: str, about: _Body, other: str, body: _Body) -> Iterator[tuple[str, str, int]]:
        """Yield two things with the percent of belief that they touch, unless that cannot be; `about` is of one."""
        chance, certain = _meeting(about, body)
        if chance > 0:
            between = "robot" if name == ROOT_NODE else "verge" if other == VERGE_NODE else "things"
            case = f"adjacent_{between}{'' if self.is_sure else '_unsure'}"
            share = 100 if certain else self._rate(case, measured(chance))
            yield name, other, self._persisting(share, self.model.object(name), self.model.object(other))

    def _body(self, node: Node) -> _Body:
        """Return where an object may be: its squares, and open ones beside them."""
        view = self.model.view
        south, west = node.patch.south - view.south - 1, node.patch.west - view.west - 1
        mask = np.pad(node.patch.mask, 1)
        own = mask & (self._part(self.model.labels, south, west, mask.shape) == int(node.region[len("part") :]))
        ring = _greatest_beside(node.patch.mask) & ~mask & self._part(self._open, south, west, mask.shape, True)
        chance = self._part(view.probability, south, west, mask.shape, 0.5)
        sure = own & self._part(self._surely_occupied, south, west, mask.shape)
        return _Body(south, west, np.where(mask | ring, chance, 0.0), sure)

    def _part(
        self, values: NDArray[Any], south: int, west: int, shape: tuple[int, ...], beyond: float = 0
    ) -> NDArray[Any]:
        """Return the part of an array at a row and a column; squares outside of the array have the value `beyond`."""
        found = np.full(shape, beyond, values.dtype)
        rows, columns = (
            slice(max(at, 0), min(at + n, end)) for at, n, end in zip((south, west), shape, values.shape, strict=True)
        )
        if rows.start < rows.stop and columns.start < columns.stop:
            inner = values[rows, columns]
            row, column = rows.start - south, columns.start - west
            found[row : row + inner.shape[0], column : column + inner.shape[1]] = inner
        return found

    def _robot(self) -> _Body:
        """Return the square of the robot: what is beside it was felt from there, wherever the frame lies."""
        row, column = self.model.view.locate(*self.model.place)
        return _Body(row, column, np.ones((1, 1)), np.full((1, 1), self.is_sure))

    @cached_property
    def _verge_chances(self) -> Floats:
        """The chance that each square is one of the verge."""
        labels, kinds = self.model.labels, self.model.kinds
        shares = np.array([kinds.of(f"part{n}", "verge") / 100 for n in range(int(labels.max()) + 1)])
        chance = self.model.view.probability * shares[labels]
        beside = with_edge_neighbours(chance > 0) & (shares[labels] == 0) & self._open
        return np.where(beside, self.model.view.probability, chance)

    @cached_property
    def _sure_verge(self) -> Bools:
        """Squares that are verge beyond doubt: almost surely verge, and no piece that may be of a thing."""
        sure = self.model.walls & self._surely_occupied
        if sure.any():
            for piece in self.model.unfelt_pieces:
                sure &= ~piece
            pieces = components(sure)  # what is settled to be longer than any thing is no part of one
            sure = (extents(pieces.labels, pieces.number) > LONGEST_OBJECT)[pieces.labels] & sure
        found: Bools = sure | (self.model.felt_verge & self._surely_occupied)
        return found

    def _without(self, verge: _Body, node: Node | None, about: _Body) -> _Body:
        """Return the part of the verge about a thing, without the squares of the thing itself."""
        chance, sure = (self._part(one, about.south, about.west, about.chance.shape) for one in verge[2:])
        if node is not None:
            own = self._part(self.model.mask(node.patch), about.south, about.west, about.chance.shape)
            chance, sure = np.where(own, 0.0, chance), sure & ~own
        return _Body(about.south, about.west, chance, sure)

    # ---- Doors and corners ----

    def of_door(self, door: Door, widths: Widths) -> int:
        """Return the percent of belief in a door; 100 only when what is seen of both sides leaves no doubt."""
        certain = self.is_sure and self._is_open(door) and self._is_wide(door, widths.most) and self._is_walled(door)
        if door.confidence == 100 and certain:
            return 100
        if not door.joins:
            return self._rate("door_alone", int(door.width))
        smaller = min(int(np.count_nonzero(self.rooms.labels == side)) for side in door.sides)
        walled = "door_walled" if door.confidence > MAX_UNWALLED else "door_unwalled"
        return self._rate("door_anew" if self.model.anew else walled, smaller)

    def _is_open(self, door: Door) -> bool:
        """Return whether all squares along the line of a door are free beyond doubt."""
        return all(self._is(self._surely_free, x, y) for x, y in _places_along(door.a, door.b))

    def _is_wide(self, door: Door, width: float) -> bool:
        """Return whether the floor seen on both sides of a door is wide enough for a door of some width."""
        one, other = (float(self._clearance[self.rooms.labels == side].max(initial=0.0)) for side in door.sides)
        return door.joins and 2 * min(one, other) >= ENCODED_DOOR_RATIO * width

    def _is_walled(self, door: Door) -> bool:
        """Return whether verge bounds a door on both ends beyond doubt."""
        return all(len(jamb(self._sure_verge, end)[0]) > 0 for end in (door.a, door.b))

    @cached_property
    def _clearance(self) -> Floats:
        """The distance of each square that is free beyond doubt to the nearest one that is not."""
        clearance: Floats = Screen(self._surely_free).clearance
        return clearance

    def widths(self, door: Door) -> Widths:
        """Return between what bounds the width of a door lies, wherever in their squares its walls end."""
        a, b = np.array(door.a), np.array(door.b)
        along = (b - a) / max(door.width, 1e-9)
        least, most = 0.0, door.width
        for x, y in _places_along(door.a, door.b):
            if not self._is(self._surely_free, x, y):  # it may be wall: up to which end it reaches
                corners = [(math.floor(x) + i - a[0], math.floor(y) + j - a[1]) for i in (0, 1) for j in (0, 1)]
                reach = [float(corner @ along) for corner in np.array(corners)]
                if sum(reach) / 4 < door.width / 2:
                    least = max(least, *reach)
                else:
                    most = min(most, *reach)
        walls = self._wall_beyond(door.a, -along), self._wall_beyond(door.b, along)
        widest = max((math.dist(p, q) for p in walls[0] for q in walls[1]), default=MAX_DOOR_WIDTH)
        return Widths(max(0.0, most - least), max(widest, door.width))

    def _wall_beyond(self, end: XY, outward: Floats) -> Sequence[XY]:
        """Return the corners of the nearest square that is surely wall beyond an end of a door; () for none."""
        rows, columns = self._walls
        away = np.stack([columns + 0.5 - end[0], rows + 0.5 - end[1]])
        ahead, aside = outward @ away, np.abs(outward[0] * away[1] - outward[1] * away[0])
        beyond = np.flatnonzero((ahead > 0) & (aside <= ahead + 1))  # so that a line from wall to wall crosses the door
        if not len(beyond):
            return ()
        nearest = beyond[np.hypot(*away[:, beyond]).argmin()]
        return [(int(columns[nearest]) + i, int(rows[nearest]) + j) for i in (0, 1) for j in (0, 1)]

    @cached_property
    def _walls(self) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """The rows and the columns of the squares that are occupied beyond doubt and taken for verge."""
        rows, columns = np.nonzero(self._surely_occupied & self.model.verge)
        return rows, columns

    def of_corner(self, corner: Corner) -> int:
        """Return the percent of belief in a corner: that the squares about it are floor and wall as they seem."""
        x, y = (round(value) for value in corner.point)
        chance, certain = 1.0, self.is_sure
        for column, row in ((i, j) for i in (x - 1, x) for j in (y - 1, y)):
            is_floor = (column, row) == corner.square
            known = self._surely_free if is_floor else self._surely_occupied
            occupied = float(self._part(self.model.view.probability, row, column, (1, 1), 0.5)[0, 0])
            if not is_floor:
                chance *= occupied
            elif self.model.view.state[row, column] != OCCUPIED:  # else it is known floor beneath a thing put there
                chance *= 1 - occupied
            certain = certain and self._is(known, column + 0.5, row + 0.5)
        if chance <= 0:
            return 0
        return 100 if certain else self._rate("corner" if self.is_sure else "corner_unsure", measured(chance))

    def _is(self, mask: Bools, x: float, y: float) -> bool:
        """Return whether the square at a point is in a mask; False for one outside of it."""
        row, column = math.floor(y), math.floor(x)
        return 0 <= row < mask.shape[0] and 0 <= column < mask.shape[1] and bool(mask[row, column])


def _meeting(about: _Body, body: _Body) -> tuple[float, bool]:
    """Return how likely two things meet in their likeliest square, and whether they surely do; `about` is of one."""
    south, west = max(about.south, body.south), max(about.west, body.west)
    north = min(about.south + about.chance.shape[0], body.south + body.chance.shape[0])
    east = min(about.west + about.chance.shape[1], body.west + body.chance.shape[1])
    if south >= north or west >= east:
        return 0.0, False
    parts = [
        (slice(south - one.south, north - one.south), slice(west - one.west, east - one.west)) for one in (about, body)
    ]
    chance = float((about.chance[parts[0]] * body.chance[parts[1]]).max())
    return chance, bool((about.sure[parts[0]] & body.sure[parts[1]]).any())


def _overlaps(low: float, high: float, size: int) -> tuple[slice, Floats]:
    """Return the squares of a row of some size that a stretch meets, and which share of the stretch each takes up."""
    first, last = math.floor(low), max(math.ceil(high), math.floor(low) + 1)
    starts = np.arange(first, last)
    length = high - low
    inner = np.minimum(starts + 1, high) - np.maximum(starts, low)
    shares: Floats = inner / length if length > 1e-9 else np.ones(len(starts))
    begin = min(max(first, 0), size)
    return slice(begin, max(begin, min(last, size))), shares[(starts >= 0) & (starts < size)]


def _ends_of_mean(body: _Body, axis: int) -> tuple[float, float]:
    """Return the least and the greatest mean place of a body's squares along an axis, whatever it covers."""
    sure = body.sure.sum(axis=1 - axis).astype(float)
    may = (body.chance > 0).sum(axis=1 - axis) - sure
    places = np.arange(len(sure)) + 0.5
    count, total = sure.sum(), float(sure @ places)
    ends = []
    for way in (1, -1):
        counts = count + np.cumsum(may[::way])
        totals = total + np.cumsum((may * places)[::way])
        means = totals[counts > 0] / counts[counts > 0] if counts[-1] else places
        if count:
            means = np.append(means, total / count)
        ends.append(float(means.min() if way == 1 else means.max()))
    return ends[0], ends[1]


def _places_along(a: XY, b: XY) -> list[XY]:
    """Return points on both sides of a line, two for each square of its length, as close to it as can be told."""
    (ax, ay), (bx, by) = a, b
    count = max(2, round(2 * math.dist(a, b)))
    parts = [(number + 0.5) / count for number in range(count)]
    x, y = 1e-6 * (ay - by), 1e-6 * (bx - ax)
    return [(ax + side * x + part * (bx - ax), ay + side * y + part * (by - ay)) for side in (-1, 1) for part in parts]
