"""TABLETOP, the physics: what lies on the table, where Utak is, and how the five commands change that.

Utak is a point. A held object moves with it as one rigid body. A motion ends exactly at the first contact; only Utak's
hand moves things, and what others do, as the world states it, between two commands.
"""

import math
from typing import Any, NamedTuple

import numpy as np
import shapely

from utak.geometry.kernels.arrays import Floats
from utak.geometry.motion.first_contact import MIN_EDGE_LENGTH, ContactBody, Obstacles, obstacle_part
from utak.geometry.motion.se2 import Motion, Rotate, Translate, direction
from utak.geometry.raster.rasterize import outline_edges
from utak.simulator.world.placing import robot_misplaced, standing, thing_misplaced
from utak.simulator.world.senses import ImpressionCodes, Senses, felt_colours, gray_levels
from utak.simulator.world.table import Table, TableColours
from utak.simulator.world.world import Disturbance, World

TABLE_EDGE_WIDTH = 1.0  # squares; any width above 0 stops motions, because contacts are exact


class Tabletop:
    """A world that changes by commands."""

    def __init__(self, world: World, noise: float = 0.0, seed: int = 0) -> None:
        self.world = world
        self._senses = Senses(world.heading)
        self._north = direction(world.heading)  # cosine and sine of Utak's heading
        immovable = [world.verge, table_edge(world.width, world.height), *(thing.polygon for thing in world.fixed)]
        self._immovable = [obstacle_part(polygon) for polygon in immovable]
        self._parts_at_start = {thing.name: obstacle_part(thing.polygon) for thing in world.movable}
        self._obstacles_at_start: dict[str | None, Obstacles] = {}
        self._table_at_start = Table(world)
        self.restart(seed)
        self.disturb(noise, None)

    def restart(self, seed: int) -> None:
        """Put everything back to where it was at the start, and begin randomness anew with a seed."""
        self.utak = self.world.utak
        self.held: str | None = None
        self.polygons: dict[str, Any] = {thing.name: thing.polygon for thing in self.world.movable}
        self.motion: Motion | None = None
        self._random = np.random.default_rng(seed)
        self._table = self._table_at_start.copy()
        self._parts = dict(self._parts_at_start)  # the movable things where they lie now
        # What stands in the way of the thing held, by name, or of Utak alone (None); kept until another thing moves.
        self._obstacles = dict(self._obstacles_at_start)
        self._moved: set[str] = set()  # the names of things that are not known to lie as at the start
        self._carried: CarriedThing | None = None  # the held thing where it lies now; None until it moves
        self._commands = 0
        # What others did before the newest command, by the name of what they put elsewhere, and what they could not do.
        self.disturbed: dict[str, Any] = {}
        self.refused: dict[str, str] = {}  # why not, in words, by the fact that states it

    def disturb(self, noise: float, seed: int | None) -> None:
        """Disturb motions by another noise from now on."""
        if not 0.0 <= noise <= 1.0:
            raise ValueError(f"noise must be from 0 to 1, not {noise}")
        self.noise = noise
        if seed is not None:
            self._random = np.random.default_rng(seed)

    def move(self, east: float, north: float) -> None:
        """Walk straight by (east, north) squares in Utak's frame; no effect while an object is held."""
        self._begin_command()
        if self.held is None:
            self._move_until_contact(self._disturbed_translation(east, north))

    def push(self, east: float, north: float) -> None:
        """Walk straight by (east, north) squares in Utak's frame, with the held object; no effect without one."""
        self._begin_command()
        if self.held is not None:
            self._move_until_contact(self._disturbed_translation(east, north))

    def turn(self, degrees: float) -> None:
        """Turn the held object about Utak by `degrees`, counter-clockwise positive; no effect when nothing is held."""
        self._begin_command()
        if self.held is None:
            return
        _require_finite(degrees)
        if self.noise:
            degrees *= 1.0 + self.noise * float(self._random.standard_normal())
        self._move_until_contact(Rotate(degrees, self.utak))

    def grasp(self, direction: str) -> None:
        """Grasp the movable thing on an adjacent square; no effect while an object is held."""
        self._begin_command()
        square = self._senses.adjacent(self.utak, direction)
        if self.held is not None:
            return
        slips = self.noise > 0.0 and float(self._random.random()) < self.noise
        if not slips:
            self.held = self._table.movable_at(*square)

    def release(self) -> None:
        """Release the held object."""
        self._begin_command()
        self._let_go()

    def look(self) -> tuple[tuple[int, ...], tuple[str | None, ...]]:
        """Return the impression at Utak's place: 160 gray levels and 8 touches. Changes nothing."""
        sensed = self.sense()
        return gray_levels(sensed), felt_colours(sensed)

    def sense(self, sensed: ImpressionCodes | None = None) -> ImpressionCodes:
        """Return the impression at Utak's place in numbers: (168,) uint8. Changes nothing."""
        return self._senses.impression(self._table, self.utak, sensed)

    @property
    def now(self) -> World:
        """The world as it is now."""
        return self.world.moved(self.polygons, self.utak)

    @property
    def colours(self) -> TableColours:
        """The colours of the table's squares, as `Table.colours`; Utak is not in it."""
        return self._table.colours

    def _begin_command(self) -> None:
        """Count a command; before it is carried out, others do what the world states for it."""
        self.motion = None
        self._commands += 1
        self.disturbed, self.refused = {}, {}
        for other in self.world.disturbances:
            if other.step == self._commands:
                self._be_disturbed(other)

    def _be_disturbed(self, other: Disturbance) -> None:
        """Put a thing or Utak elsewhere, unless something is in the way there."""
        if other.name == "utak":
            hindrance = robot_misplaced(self.world, other.place, [*standing(self.world), *self.polygons.items()])
        else:
            outline = other.outline(self.polygons[other.name], self.world.width)
            hindrance = "" if other.place is None else self._thing_hindered(other.name, outline)
        if hindrance:
            self.refused[other.fact] = hindrance
            return
        if other.name in ("utak", self.held):
            self._let_go()
        if other.name == "utak":
            self.utak = self.disturbed["utak"] = (float(other.place.x), float(other.place.y))
            return
        self.polygons[other.name] = self.disturbed[other.name] = outline
        self._table.update(other.name, outline_edges(outline))
        self._parts.pop(other.name, None)
        self._moved.add(other.name)
        self._obstacles = {held: around for held, around in self._obstacles.items() if held == other.name}

    def _thing_hindered(self, name: str, outline: Any) -> str:
        """Return what is in the way of a thing that others put elsewhere, in words; "" for nothing."""
        lying = [(other, polygon) for other, polygon in self.polygons.items() if other != name]
        covers = outline.contains(shapely.Point(self.utak))
        hindrance = thing_misplaced(self.world, name, outline, [*standing(self.world), *lying])
        return hindrance or (f"{name} would lie over Utak" if covers else "")

    def _let_go(self) -> None:
        self.held = None
        self._carried = None

    def _disturbed_translation(self, east: float, north: float) -> Translate:
        """Return a translation in the table frame, disturbed by noise; east and north are in Utak's frame."""
        _require_finite(east, north)
        cosine, sine = self._north
        dx, dy = east * cosine - north * sine, east * sine + north * cosine
        if self.noise:
            length = 1.0 + self.noise * float(self._random.standard_normal())
            angle = self.noise * float(self._random.standard_normal())
            cosine, sine = length * math.cos(angle), length * math.sin(angle)
            dx, dy = dx * cosine - dy * sine, dx * sine + dy * cosine
        return Translate(dx, dy)

    def _move_until_contact(self, wanted: Motion) -> None:
        """Move Utak and the held object as far as nothing blocks them."""
        if not any(wanted[:2]) if isinstance(wanted, Translate) else not wanted.degrees:
            return
        carried = self._held_thing()
        body = ContactBody(None, [self.utak]) if carried is None else carried.body
        fraction = self._standing_obstacles().first_contact(body, wanted)
        if fraction <= 0.0:
            return
        motion = wanted.part(fraction)
        if isinstance(motion, Translate):
            self.utak = (self.utak[0] + motion.dx, self.utak[1] + motion.dy)
        if carried is not None:
            self._carry(carried.after(motion))
        self.motion = motion

    def _held_thing(self) -> "CarriedThing | None":
        """Return the held thing, ready to be moved with Utak; None with empty hands."""
        if self.held is not None and self._carried is None:
            self._carried = carried_thing(self.polygons[self.held], self.utak)
        return self._carried

    def _carry(self, carried: "CarriedThing") -> None:
        assert self.held is not None
        self._carried = carried
        self.polygons[self.held] = carried.polygon
        self._table.update(self.held, carried.outline)
        self._parts.pop(self.held, None)
        self._moved.add(self.held)
        if self._obstacles.keys() - {self.held}:
            self._obstacles = {self.held: self._obstacles[self.held]}

    def _standing_obstacles(self) -> Obstacles:
        """Return all that stands in the way of Utak and of what is held."""
        if self.held not in self._obstacles:
            for name in self.polygons.keys() - self._parts.keys():
                self._parts[name] = obstacle_part(self.polygons[name])
            others = [self._parts[name] for name in self.polygons if name != self.held]
            self._obstacles[self.held] = Obstacles([*self._immovable, *others])
            if self._moved <= {self.held}:
                self._obstacles_at_start[self.held] = self._obstacles[self.held]
        return self._obstacles[self.held]


class CarriedThing(NamedTuple):
    """A held thing where it lies, in the forms that its next motion needs."""

    polygon: Any  # its outline, shapely Polygon, squares, table frame
    outline: Floats  # (n, 4) its edges, for its projection onto squares
    body: ContactBody  # itself and Utak as one rigid body
    # Whether all of them are made anew after each motion, not moved: a polygon has holes, or edges so small that
    # rounding could decide which of them `body` has
    is_made_anew: bool

    def after(self, motion: Motion) -> "CarriedThing":
        """Return the thing as it lies after a motion, to the last digit as if it were made from its new polygon."""
        body = self.body.after(motion)
        if self.is_made_anew:
            polygon = motion.carry(self.polygon)
            return CarriedThing(polygon, outline_edges(polygon), ContactBody(polygon, body.points.tolist()), True)
        corners = shapely.get_coordinates(self.polygon)
        points = motion.points(np.concatenate([corners, self.outline.reshape(-1, 2)]))
        polygon = shapely.polygons(points[: len(corners)])
        return CarriedThing(polygon, points[len(corners) :].reshape(-1, 4), body, False)


def carried_thing(polygon: Any, utak: tuple[float, float]) -> CarriedThing:
    """Return a thing that was just grasped by Utak; squares, table frame."""
    outline = outline_edges(polygon)
    lengths = np.hypot(outline[:, 2] - outline[:, 0], outline[:, 3] - outline[:, 1])
    is_made_anew = len(polygon.interiors) > 0 or bool((lengths <= 2 * MIN_EDGE_LENGTH).any())
    return CarriedThing(polygon, outline, ContactBody(polygon, [utak]), is_made_anew)


def _require_finite(*values: float) -> None:
    """Raise ValueError when a value is infinite or no number."""
    for value in values:
        if not math.isfinite(value):
            raise ValueError(f"a command with {values}: not a finite number")


def table_edge(width: int, height: int) -> Any:
    """Return the frame around the table, in squares."""
    table = shapely.box(0, 0, width, height)
    return shapely.box(
        -TABLE_EDGE_WIDTH, -TABLE_EDGE_WIDTH, width + TABLE_EDGE_WIDTH, height + TABLE_EDGE_WIDTH
    ).difference(table)
