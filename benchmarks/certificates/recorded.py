"""Episodes of given commands in given worlds, as far as certificates read them, with the true places of the robot."""

import json
import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import shapely

from utak.geometry.kernels.arrays import XY
from utak.kb.body import Command
from utak.simulator.certificates.courses import TOUCH_OFFSETS
from utak.simulator.episode.record import action_entry
from utak.simulator.run.embodiment import Embodiment
from utak.simulator.world.physics import Tabletop
from utak.simulator.world.table import project
from utak.simulator.world.world import World


class TrueRooms(NamedTuple):
    """The rooms of a table, table frame."""

    parts: tuple[shapely.Geometry, ...] = ()
    doors: frozenset[tuple[int, int]] = frozenset()  # numbers of rooms that a door joins, the lesser first
    are_parted: bool = True  # no door has one room on both sides


ROOMLESS = TrueRooms()


@dataclass(frozen=True)
class RecordedWalk:
    """A walk and its goals."""

    world: World
    text: str  # the episode
    goals: tuple[str, ...]
    places: tuple[XY, ...] = field(repr=False)  # of the robot at each step, squares, table frame
    things: tuple[dict[str, Any], ...] = field(repr=False)  # the outlines of the movable things at each step
    held: tuple[str | None, ...]  # the name of what is held at each step
    touches: tuple[tuple[str | None, ...], ...] = field(repr=False)
    rooms: TrueRooms = ROOMLESS

    def felt(self, step: int, touch: int) -> str | None:
        """Return the name of the thing that a touch felt."""
        square = self.felt_square(step, touch)
        letter = self.touches[step][touch]
        things = (one for one in self.world.movable if one.colour == letter)
        return next((one.name for one in things if project(self.things[step][one.name]).covers(*square)), None)

    def felt_square(self, step: int, touch: int) -> tuple[int, int]:
        """Return the square of a touch, table frame."""
        (x, y), (e, n), heading = self.places[step], TOUCH_OFFSETS[touch], math.radians(self.world.heading)
        i = math.floor(x) + round(e * math.cos(heading) - n * math.sin(heading))
        return i, math.floor(y) + round(e * math.sin(heading) + n * math.cos(heading))


def recorded_walk(
    world: World,
    commands: Sequence[Command],
    goals: Sequence[str],
    claims: Sequence[str] = (),
    parameters: Sequence[str] = ("x",),
    doors: Sequence[str] = (),
) -> RecordedWalk:
    """Return the episode of some commands; all `parameters` are objects, and there may be `doors` besides."""
    table = Tabletop(world)
    body = Embodiment(table)
    task = {
        "goals": list(goals),
        "claims": [[claim, 100] for claim in claims],
        "parameters": dict.fromkeys(parameters, "object") | dict.fromkeys(doors, "door"),
    }
    rows = [{"utak": "episode", "version": 1, "options": {"noise": 0.0, "kb": []}, "task": task}]
    places, things, held, touches = [], [], [], []
    for step, command in enumerate([None, *commands]):
        seen = body.wake() if command is None else body.act(command)
        places.append(table.utak)
        things.append(dict(table.polygons))
        held.append(table.held)
        touches.append(tuple(seen.touch))
        rows.append(
            {"step": step, "action": action_entry(command), "retina": list(seen.retina), "touch": list(seen.touch)}
        )
    text = "".join(json.dumps(row) + "\n" for row in rows)
    return RecordedWalk(world, text, tuple(goals), tuple(places), tuple(things), tuple(held), tuple(touches))
