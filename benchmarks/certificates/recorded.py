"""Episodes of given commands in given worlds, as far as certificates read them, with the true places of the robot."""

import json
from collections.abc import Sequence
from dataclasses import dataclass, field

from utak.geometry.kernels.arrays import XY
from utak.kb.body import Command
from utak.simulator.episode.record import action_entry
from utak.simulator.run.embodiment import Embodiment
from utak.simulator.world.physics import Tabletop
from utak.simulator.world.world import World


@dataclass(frozen=True)
class RecordedWalk:
    """A walk and its goals."""

    world: World
    text: str  # the episode
    goals: tuple[str, ...]
    places: tuple[XY, ...] = field(repr=False)  # of the robot at each step, squares, table frame


def recorded_walk(
    world: World,
    commands: Sequence[Command],
    goals: Sequence[str],
    claims: Sequence[str] = (),
    parameters: Sequence[str] = ("x",),
) -> RecordedWalk:
    """Return the episode of some commands; all `parameters` are objects."""
    table = Tabletop(world)
    body = Embodiment(table)
    task = {
        "goals": list(goals),
        "claims": [[claim, 100] for claim in claims],
        "parameters": dict.fromkeys(parameters, "object"),
    }
    rows = [{"utak": "episode", "version": 1, "options": {"noise": 0.0, "kb": []}, "task": task}]
    places = []
    for step, command in enumerate([None, *commands]):
        seen = body.wake() if command is None else body.act(command)
        places.append(table.utak)
        rows.append(
            {"step": step, "action": action_entry(command), "retina": list(seen.retina), "touch": list(seen.touch)}
        )
    return RecordedWalk(world, "".join(json.dumps(row) + "\n" for row in rows), tuple(goals), tuple(places))
