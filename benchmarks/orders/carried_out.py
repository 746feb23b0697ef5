"""The carries that a search has found as commands, carried out in the simulated world: whether they do the task."""

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from shapely import Point

from benchmarks.orders.search import Carry
from benchmarks.worlds.placing import digital
from benchmarks.worlds.several.tasks import SeveralWorld, stages_reached
from utak.geometry.kernels.arrays import XY
from utak.geometry.manipulation.legs import Leg
from utak.geometry.motion.se2 import Translate
from utak.geometry.screen import Screen
from utak.kb.body import DIRECTIONS, Command, Grasp, Move, Push, Release, Turn
from utak.kb.language.goal_words import ROBOT
from utak.simulator.run.embodiment import Embodiment
from utak.simulator.world.physics import Tabletop
from utak.simulator.world.world import Thing, World


def does_task(world: SeveralWorld, way: Sequence[Carry | XY]) -> bool:
    """Return whether a way, as benchmarks.orders.search finds it, does the task in the simulated world."""
    performer = _Performer(world)
    performer.go(way)
    return stages_reached(world.stages, performer.track) == len(world.stages)


def commands_of(world: SeveralWorld, way: Sequence[Carry | XY]) -> list[Command]:
    """Return the commands by which the robot goes a way."""
    performer = _Performer(world)
    performer.go(way)
    return performer.commands


def simulated(world: SeveralWorld) -> World:
    """Return a world as the simulator has it."""
    movable, fixed = (
        tuple(Thing(thing.name, thing.colour, thing.polygon) for thing in world.things if thing.fixed == still)
        for still in (False, True)
    )
    plan, utak = world.plan, (world.utak.x, world.utak.y)
    return World(plan.width, plan.height, plan.verge, movable, fixed, utak, world.heading)


class _Performer:
    """Carries commands out in a simulated world without noise.

    Attributes
    ----------
    commands : those given. track : how everything lay at first and after each, by name, squares, table frame.
    """

    def __init__(self, world: SeveralWorld) -> None:
        self._world, self._table = world, Tabletop(simulated(world))
        self._body = Embodiment(self._table)
        self.commands: list[Command] = []
        self.track: list[dict[str, Any]] = [self._state()]

    def go(self, way: Sequence[Carry | XY]) -> None:
        """Give the commands of a way."""
        for part in way:
            if isinstance(part, Carry):
                for leg in part.legs:
                    self._carry(leg)
            else:
                self._walk(part)

    def _carry(self, leg: Leg) -> None:
        self._walk(leg.place)
        self._give(Grasp(self._direction(*leg.direction_square)))
        for motion in leg.motions:
            if isinstance(motion, Translate):
                self._give(Push(*self._turned(motion.dx, motion.dy)))
            else:
                self._give(Turn(motion.degrees))
        self._give(Release())

    def _walk(self, place: XY) -> None:
        """Walk to a place by the shortest way; stay where no way leads there."""
        world, here = self._world, self._table.utak
        shapes = [world.plan.verge, *self._table.polygons.values(), *(t.polygon for t in world.things if t.fixed)]
        taken = np.logical_or.reduce([digital(shape, world.plan.width, world.plan.height) for shape in shapes])
        taken[math.floor(here[1]), math.floor(here[0])] = False  # a thing off the grid may cover a part of it
        if not taken[math.floor(place[1]), math.floor(place[0])]:
            route = Screen(~taken).shortest(here, place)
            for (x, y), (u, v) in pairwise(route.points.tolist() if route is not None else ()):
                self._give(Move(*self._turned(u - x, v - y)))

    def _give(self, command: Command) -> None:
        self._body.act(command)
        self.commands.append(command)
        self.track.append(self._state())

    def _state(self) -> dict[str, Any]:
        return {ROBOT: Point(self._table.utak), **self._table.polygons}

    def _turned(self, dx: float, dy: float) -> tuple[float, float]:
        """Return a way of the table frame in the robot's frame."""
        c, s = math.cos(math.radians(-self._world.heading)), math.sin(math.radians(-self._world.heading))
        return dx * c - dy * s, dx * s + dy * c

    def _direction(self, columns: int, rows: int) -> str:
        """Return the name of a neighbouring square's direction in the robot's frame; headings are quarter turns."""
        east, north = self._turned(columns, rows)
        return DIRECTIONS[round(math.degrees(math.atan2(east, north)) / 45) % len(DIRECTIONS)]
