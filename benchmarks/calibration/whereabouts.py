"""The truth about what may be besides what was seen: where things are, what is one thing, what joins floors."""

import math
from collections import deque
from collections.abc import Iterable, Iterator, Mapping
from typing import Any, NamedTuple

import numpy as np
import shapely
from shapely import Point

from benchmarks.calibration.figures import class_of
from benchmarks.calibration.truth import VERGE, NodeTruth, TableTruth
from benchmarks.harness.beliefs import TableFrame
from utak.geometry.kernels.arrays import Square
from utak.kb.objects.parts import parts_of
from utak.kb.task.apart import NO_PART, floor_parts
from utak.kb.task.stretches import stretches
from utak.kb.task.task import SHAPE_SUBCLASSES, Task
from utak.kb.world.model import FACT_UNITS_PER_SQUARE
from utak.kb.world.rooms import Rooms

CELLS_TO_A_SIDE = 4  # of a square: cells in which the true floor is followed, for a passage may fill no whole square
TAKEN_SHARE = 0.5  # of the squares of a thing: where so many were taken for verge, it was


class TrueAlternatives(NamedTuple):
    """One moment of a run, as far as what may be is compared with the truth."""

    task: Task
    model: Any  # kb.world.model.WorldModel
    rooms: Rooms
    frame: TableFrame
    truth: TableTruth
    nodes: Mapping[str, NodeTruth]

    def thing_meant(self, parameter: str) -> str | None:
        """Return the only thing that is as the task claims; None where none or several are."""
        fitting = [name for name in self.truth.things if self._is_as_claimed(parameter, name)]
        return fitting[0] if len(fitting) == 1 else None

    def _is_as_claimed(self, parameter: str, thing: str) -> bool:
        """Return whether a thing has the shape and the colour that are claimed."""
        true = {"shape": class_of(self.truth.polygons[thing]), "colour": self.truth.things[thing].colour}
        for claim in self.task.claims:
            name, (x, *values) = claim.fact.name, map(str, claim.fact.args)
            if x == parameter and name in true and true[name] not in {values[0], *SHAPE_SUBCLASSES.get(values[0], ())}:
                return False
        return True

    def place(self, parameter: str) -> str | None:
        """Return where the thing is that a parameter means; None where nobody says which thing that is."""
        # A node; the verge that it was taken for; else the room, or the door, that leads to it last.
        thing = self.thing_meant(parameter)
        if thing is None:
            return None
        node = next((name for name, one in self.nodes.items() if one.thing == thing), None)
        if node is not None:
            return node
        squares = self.truth.about(thing)
        if len(squares & self._squares(self.model.verge).keys()) >= TAKEN_SHARE * len(squares):
            return VERGE
        return self._leading_to(squares)

    def _squares(self, mask: Any) -> dict[Square, tuple[int, int]]:
        """Return the squares of the table under a mask of the map view, with row and column."""
        view = self.model.view
        return {self.frame.square(c + view.west, r + view.south): (r, c) for r, c in np.argwhere(mask).tolist()}

    def _leading_to(self, squares: set[Square]) -> str:
        """Return the last room on the way to some squares, or the door behind which nothing was seen; "" for none."""
        view, labels = self.model.view, self.rooms.labels
        known = {square: int(labels[at]) for square, at in self._squares(labels > 0).items()}
        doors = {
            self.frame.square(int(door.place[0] // 1) + view.west, int(door.place[1] // 1) + view.south): door.name
            for door in self.rooms.doors
            if door.sides[0] == door.sides[1]
        }
        for x, y in self._way(squares):
            near = [(x + i, y + j) for i in (-1, 0, 1) for j in (-1, 0, 1)]
            door = next((doors[other] for other in near if other in doors), None)
            if door is not None:
                return door
            if (x, y) in known:
                return f"r{known[x, y]}"
        return ""

    def _way(self, goal: set[Square]) -> list[Square]:
        """Return the squares of a shortest way over the true floor, from a goal to the robot; [] for none."""
        before: dict[Square, Square | None] = dict.fromkeys(self.truth.robot_squares)
        todo, verge = deque(before), self.truth.about(VERGE)
        while todo:
            square = todo.popleft()
            if square in goal:
                way, at = [square], before[square]
                while at is not None:
                    way.append(at)
                    at = before[at]
                return way
            x, y = square
            for other in ((x + 1, y), (x - 1, y), (x, y + 1), (x, y - 1)):
                inside = 0 <= other[0] < self.truth.width and 0 <= other[1] < self.truth.height
                if inside and other not in before and other not in verge:
                    before[other] = square
                    todo.append(other)
        return []

    def stands(self, east: int, north: int) -> bool:
        """Return whether the robot is in the square with a middle, hundredths of squares, if its map did not slip."""
        standing = self.model.standing
        x, y = standing.frame.place_from_utak(east / FACT_UNITS_PER_SQUARE, north / FACT_UNITS_PER_SQUARE)
        quarters = round((self.truth.heading - standing.frame.angle) / 90) % 4
        frame = TableFrame(quarters, *(math.floor(v) for v in self.truth.woke))
        return frame.square(math.floor(x), math.floor(y)) in self.truth.robot_squares

    def is_plug(self, name: str) -> bool:
        """Return whether things cover most of a stretch of what bounds the floor."""
        mask = next(stretch.mask for stretch in stretches(self.model) if stretch.name == name)
        squares = {(row, column) for row, column in np.argwhere(mask).tolist()}
        return 2 * len(squares & self.thing_squares()) > len(squares)

    def thing_squares(self) -> set[tuple[int, int]]:
        """Return the squares that things cover, and no verge: row and column on the arrays of the view."""
        things = {square for thing in self.truth.things for square in self.truth.about(thing)}
        there = self._squares(self.model.view.seen)
        return {there[square] for square in things - self.truth.about(VERGE) if square in there}

    def led_to(self, apart: str) -> str:
        """Return the part of the floor to which a way over the true floor leads first from another one."""
        # NO_PART where it is no floor, or where no way leads to a part that was seen.
        parts = {name: self._squares(mask).keys() for name, mask in floor_parts(self.model).items()}
        shape = CELLS_TO_A_SIDE * self.truth.height, CELLS_TO_A_SIDE * self.truth.width
        rows, columns = (np.indices(shape) + 0.5) / CELLS_TO_A_SIDE
        floor = shapely.contains_xy(self.truth.floor, columns, rows)
        goals = {at: name for name, squares in parts.items() if name != apart for at in self._fine(squares)}
        before = {at for at in self._fine(parts[apart]) if floor[at]}
        todo = deque(sorted(before))
        while todo:
            at = todo.popleft()
            if at in goals:
                return goals[at]
            for step in ((1, 0), (-1, 0), (0, 1), (0, -1)):
                other = at[0] + step[0], at[1] + step[1]
                inside = 0 <= other[0] < shape[0] and 0 <= other[1] < shape[1]
                if inside and other not in before and floor[other]:
                    before.add(other)
                    todo.append(other)
        return NO_PART

    def _fine(self, squares: Iterable[Square]) -> Iterator[tuple[int, int]]:
        """Yield the cells of CELLS_TO_A_SIDE a side into which squares of the table fall: rows and columns."""
        within = range(CELLS_TO_A_SIDE)
        for x, y in squares:
            if 0 <= x < self.truth.width and 0 <= y < self.truth.height:
                yield from ((CELLS_TO_A_SIDE * y + i, CELLS_TO_A_SIDE * x + j) for i in within for j in within)

    def is_one_thing(self, one: str, other: str) -> bool | None:
        """Return whether two pieces are one thing; None where one of them is none."""
        first, second = (self.truth.of(self._piece(name)).thing for name in (one, other))
        return None if first is None or second is None else first == second

    def _piece(self, name: str) -> set[Square]:
        """Return the squares of an object, or those that are nearest to a part of its outline."""
        node, _, number = name.partition("_")
        found = self.model.object(node)
        squares = found.patch.squares()
        if number:
            parts = parts_of(found.polygon)
            middles = {square: Point(square[0] + 0.5, square[1] + 0.5) for square in squares}
            squares = {
                square
                for square, middle in middles.items()
                if int(np.argmin([part.distance(middle) for part in parts])) == int(number) - 1
            }
        return {self.frame.square(*square) for square in squares}
