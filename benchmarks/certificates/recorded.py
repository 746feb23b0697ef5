"""Episodes of given commands in given worlds, as far as certificates read them, with the true places of the robot."""

import json
import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import shapely

from utak.geometry.kernels.arrays import XY
from utak.geometry.motion.se2 import Translate
from utak.kb.body import Command
from utak.simulator.certificates.courses import TOUCH_OFFSETS, Evidence
from utak.simulator.episode.record import action_entry
from utak.simulator.run.embodiment import Embodiment
from utak.simulator.world.physics import Tabletop
from utak.simulator.world.table import project
from utak.simulator.world.world import World

SLACK = 1e-5  # squares; what the checker allows for rounding


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
    astray: tuple[float, ...]  # squares: how far beside its end noise would have led each command
    rooms: TrueRooms = ROOMLESS

    def evidence(self, risk: int) -> Evidence:
        """Return the episode as the checker reads it. risk : in millionths, taken where there is noise."""
        evidence = Evidence(self.text)
        evidence.allow(risk if evidence.noise else 0)
        return evidence

    def is_beyond(self, risk: int) -> bool:
        """Return whether noise led further than the checker allows for."""
        evidence = self.evidence(risk)
        limits = [error / evidence.unit + SLACK for error in evidence.errors]
        return any(far > limit for far, limit in zip(self.astray, limits, strict=True))

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


class MeasuredTabletop(Tabletop):
    """A world of which it is known how far noise leads beside the end of a command."""

    astray = 0.0  # squares, of the newest command

    def _begin_command(self) -> None:
        super()._begin_command()
        self.astray = 0.0

    def _disturbed_translation(self, east: float, north: float) -> Translate:
        turn, way = math.radians(self.world.heading), super()._disturbed_translation(east, north)
        x, y = east * math.cos(turn) - north * math.sin(turn), east * math.sin(turn) + north * math.cos(turn)
        self.astray = math.dist((x, y), (way.dx, way.dy))
        return way


def recorded_walk(
    world: World,
    commands: Sequence[Command],
    goals: Sequence[str],
    claims: Sequence[str] = (),
    parameters: Sequence[str] = ("x",),
    doors: Sequence[str] = (),
    noise: tuple[float, int] = (0.0, 0),
) -> RecordedWalk:
    """Return the episode of some commands; all `parameters` are objects, and there may be `doors` besides.

    noise : how much, and its seed.
    """
    table = MeasuredTabletop(world, *noise)
    body = Embodiment(table)
    task = {
        "goals": list(goals),
        "claims": [[claim, 100] for claim in claims],
        "parameters": dict.fromkeys(parameters, "object") | dict.fromkeys(doors, "door"),
    }
    rows = [{"utak": "episode", "version": 1, "options": {"noise": noise[0], "kb": []}, "task": task}]
    places, things, held, touches, astray = [], [], [], [], []
    for step, command in enumerate([None, *commands]):
        seen = body.wake() if command is None else body.act(command)
        places.append(table.utak)
        things.append(dict(table.polygons))
        held.append(table.held)
        touches.append(tuple(seen.touch))
        astray.append(table.astray)
        rows.append(
            {"step": step, "action": action_entry(command), "retina": list(seen.retina), "touch": list(seen.touch)}
        )
    text = "".join(json.dumps(row) + "\n" for row in rows)
    rows_of = map(tuple, (goals, places, things, held, touches, astray))
    return RecordedWalk(world, text, *rows_of)
