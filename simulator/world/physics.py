"""TABLETOP: the physics. What lies on the table, where Utak is, and how the five commands change it.

Utak is a point; what he holds moves with him as one rigid body. A motion ends at the first contact, exactly; nothing is
pushed by anything but Utak's hand.
"""

import math
from typing import Any

import numpy as np
import shapely

from geometry.motion.first_contact import ContactBody, Obstacles
from geometry.motion.se2 import Motion, Rotate, Translate, direction
from simulator.world.senses import Senses
from simulator.world.table import Table
from simulator.world.world import World

EDGE = 1.0  # squares: how thick the table's edge is drawn; nothing passes it however thin


class Tabletop:
    """A world that runs.

    Commands are in Utak's frame: his north is the way he faces when he wakes, and stays so. A command that cannot act
    changes nothing; only `motion` tells, and Utak never sees that.

    Parameters
    ----------
    world : what stands on the table at the start.
    noise : S of `--noise`. A motion's length is disturbed by the relative sigma S and its direction by S radians, a
        turn's angle by the relative sigma S; a grasp slips with probability S.
    seed : of the one random Generator.
    """

    def __init__(self, world: World, noise: float = 0.0, seed: int = 0) -> None:
        if not 0.0 <= noise <= 1.0:
            raise ValueError(f"noise must be from 0 to 1, not {noise}")
        self.world, self.noise = world, noise
        self.utak = world.utak
        self.held: str | None = None
        self.polygons: dict[str, Any] = {thing.name: thing.polygon for thing in world.movable}
        self.motion: Motion | None = None  # what really happened at the last command, table frame
        self._random = np.random.default_rng(seed)
        self._table = Table(world)
        self._senses = Senses(world.heading)
        self._obstacles: Obstacles | None = None  # as long as the same is held; nothing else moves meanwhile
        self._still = [world.verge, _edge(world.width, world.height), *(thing.polygon for thing in world.fixed)]

    def move(self, east: float, north: float) -> None:
        """Walk straight, when nothing is held."""
        self.motion = None
        if self.held is None:
            self._go(self._straight(east, north))

    def push(self, east: float, north: float) -> None:
        """Walk straight together with what is held."""
        self.motion = None
        if self.held is not None:
            self._go(self._straight(east, north))

    def turn(self, degrees: float) -> None:
        """Turn what is held about Utak, counter-clockwise positive."""
        self.motion = None
        if self.held is None or not _finite(degrees):
            return
        if self.noise:
            degrees *= 1.0 + self.noise * float(self._random.standard_normal())
        self._go(Rotate(degrees, self.utak))

    def grasp(self, direction: str) -> None:
        """Take the movable thing on the adjacent square named (`north`, `northeast`, ...), when nothing is held.

        Of several on that square it is the first by name.
        """
        self.motion = None
        square = self._senses.adjacent(self.utak, direction)
        if self.held is not None:
            return
        slips = self.noise > 0.0 and float(self._random.random()) < self.noise
        if not slips:
            self.held = self._table.movable_at(*square)
            self._obstacles = None

    def release(self) -> None:
        """Let go of what is held."""
        self.motion = None
        self.held = None
        self._obstacles = None

    def look(self) -> tuple[tuple[int, ...], tuple[str | None, ...]]:
        """Return the impression that Utak receives here: 160 gray levels and 8 touches. Changes nothing."""
        return self._senses.retina(self._table, self.utak), self._senses.touch(self._table, self.utak)

    def _straight(self, east: float, north: float) -> Translate:
        """A straight motion in the table frame, disturbed."""
        if not (_finite(east) and _finite(north)):
            return Translate(0.0, 0.0)
        cosine, sine = direction(self.world.heading)
        dx, dy = east * cosine - north * sine, east * sine + north * cosine
        if self.noise:
            length = 1.0 + self.noise * float(self._random.standard_normal())
            angle = self.noise * float(self._random.standard_normal())
            cosine, sine = length * math.cos(angle), length * math.sin(angle)
            dx, dy = dx * cosine - dy * sine, dx * sine + dy * cosine
        return Translate(dx, dy)

    def _go(self, wanted: Motion) -> None:
        """Carry Utak, and what he holds, as far as nothing is in the way."""
        if not any(wanted[:2]) if isinstance(wanted, Translate) else not wanted.degrees:
            return
        carried = None if self.held is None else self.polygons[self.held]
        if self._obstacles is None:
            others = [self.polygons[name] for name in self.polygons if name != self.held]
            self._obstacles = Obstacles([*self._still, *others])
        fraction = self._obstacles.first_contact(ContactBody(carried, [self.utak]), wanted).fraction
        if fraction <= 0.0:
            return
        motion = wanted.part(fraction)
        if isinstance(motion, Translate):
            self.utak = (self.utak[0] + motion.dx, self.utak[1] + motion.dy)
        if self.held is not None:
            self.polygons[self.held] = motion.carry(carried)
            self._table.update(self.held, self.polygons[self.held])
        self.motion = motion


def _finite(*values: float) -> bool:
    if not all(math.isfinite(value) for value in values):
        raise ValueError(f"a command with {values}: not a finite number")
    return True


def _edge(width: int, height: int) -> Any:
    """What lies around the table."""
    table = shapely.box(0, 0, width, height)
    return shapely.box(-EDGE, -EDGE, width + EDGE, height + EDGE).difference(table)
