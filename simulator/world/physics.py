"""TABLETOP, the physics: what lies on the table, where Utak is, and how the five commands change that.

Utak is a point. A held object moves with it as one rigid body. A motion ends exactly at the first contact; only Utak's
hand moves things.
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

TABLE_EDGE_WIDTH = 1.0  # squares; any width above 0 stops motions, because contacts are exact


class Tabletop:
    """A world that changes by commands.

    Commands are in Utak's frame: north is the direction that Utak faces on waking, and stays so. A command that cannot
    act changes nothing. The true motion is in `motion`, which Utak never sees.

    Parameters
    ----------
    world : the table at the start.
    noise : the S of `--noise`, 0 to 1. The length of a motion has a relative standard deviation of S, its direction a
        standard deviation of S radians, the angle of a turn a relative standard deviation of S. A grasp fails with
        probability S.
    seed : the seed of the random generator.

    Attributes
    ----------
    utak : the point (x, y) where Utak is, squares, table frame.
    held : the name of the held object, or None.
    polygons : the outlines of the movable things by name, squares, table frame.
    motion : the true motion of the last command, table frame; None when nothing moved.

    Raises
    ------
    ValueError : the noise is not from 0 to 1.
    """

    def __init__(self, world: World, noise: float = 0.0, seed: int = 0) -> None:
        if not 0.0 <= noise <= 1.0:
            raise ValueError(f"noise must be from 0 to 1, not {noise}")
        self.world, self.noise = world, noise
        self.utak = world.utak
        self.held: str | None = None
        self.polygons: dict[str, Any] = {thing.name: thing.polygon for thing in world.movable}
        self.motion: Motion | None = None
        self._random = np.random.default_rng(seed)
        self._table = Table(world)
        self._senses = Senses(world.heading)
        # Kept as long as the held object stays the same: nothing else moves meanwhile.
        self._obstacles: Obstacles | None = None
        self._immovable = [
            world.verge,
            table_edge(world.width, world.height),
            *(thing.polygon for thing in world.fixed),
        ]

    def move(self, east: float, north: float) -> None:
        """Walk straight by (east, north) squares in Utak's frame; no effect while an object is held."""
        self.motion = None
        if self.held is None:
            self._move_until_contact(self._disturbed_translation(east, north))

    def push(self, east: float, north: float) -> None:
        """Walk straight by (east, north) squares in Utak's frame, with the held object; no effect without one."""
        self.motion = None
        if self.held is not None:
            self._move_until_contact(self._disturbed_translation(east, north))

    def turn(self, degrees: float) -> None:
        """Turn the held object about Utak by `degrees`, counter-clockwise positive; no effect when nothing is held."""
        self.motion = None
        if self.held is None or not _require_finite(degrees):
            return
        if self.noise:
            degrees *= 1.0 + self.noise * float(self._random.standard_normal())
        self._move_until_contact(Rotate(degrees, self.utak))

    def grasp(self, direction: str) -> None:
        """Grasp the movable thing on an adjacent square; no effect while an object is held.

        direction : the square in Utak's frame: "north", "northeast", ... Of several things on it, the first by name is
        taken.
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
        """Release the held object."""
        self.motion = None
        self.held = None
        self._obstacles = None

    def look(self) -> tuple[tuple[int, ...], tuple[str | None, ...]]:
        """Return the impression at Utak's place: 160 gray levels and 8 touches. Changes nothing."""
        return self._senses.retina(self._table, self.utak), self._senses.touch(self._table, self.utak)

    def _disturbed_translation(self, east: float, north: float) -> Translate:
        """Return a translation in the table frame, disturbed by noise; east and north are in Utak's frame."""
        if not (_require_finite(east) and _require_finite(north)):
            return Translate(0.0, 0.0)
        cosine, sine = direction(self.world.heading)
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
        carried = None if self.held is None else self.polygons[self.held]
        if self._obstacles is None:
            others = [self.polygons[name] for name in self.polygons if name != self.held]
            self._obstacles = Obstacles([*self._immovable, *others])
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


def _require_finite(*values: float) -> bool:
    """Return True; raise ValueError when a value is infinite or no number."""
    if not all(math.isfinite(value) for value in values):
        raise ValueError(f"a command with {values}: not a finite number")
    return True


def table_edge(width: int, height: int) -> Any:
    """Return the frame around the table, in squares."""
    table = shapely.box(0, 0, width, height)
    return shapely.box(
        -TABLE_EDGE_WIDTH, -TABLE_EDGE_WIDTH, width + TABLE_EDGE_WIDTH, height + TABLE_EDGE_WIDTH
    ).difference(table)
