"""A robot that knows the table from the start: what its planner would do if nothing had to be found out.

It is the same mind as any other, but its map is filled in before it wakes, and it knows the orientation of the table.
The campaign compares the commands of both, to measure what finding out costs (`--knowing`).
"""

import math
from dataclasses import replace
from typing import Any

import numpy as np

from benchmarks.worlds.placing import digital
from benchmarks.worlds.scenes import RandomScenario
from utak.kb.body import Body, Impression
from utak.kb.knowledge import Knowledge
from utak.kb.localisation.field_account import Accommodation
from utak.kb.localisation.hypotheses.frames import Hypothesis
from utak.kb.mapping.occupancy import FREE, OCCUPIED
from utak.kb.perception.frame import Frame, turned
from utak.kb.task.task import Task
from utak.kb.world.model import WorldModel
from utak.planner.cycle import Options, Robot
from utak.simulator.run.session import RobotMaker
from utak.simulator.scenario.settings import Settings

KNOWN_VERGE = 3  # squares of verge known around the table


class Informed(Knowledge):
    """The knowledge of a robot that was told everything about a world."""

    def __init__(self, world: RandomScenario) -> None:
        super().__init__()
        self._truth = world

    def wake(self, impression: Impression) -> tuple[WorldModel, Accommodation]:
        """As of Knowledge, after the whole table was settled."""
        self.learn()
        return super().wake(impression)

    def learn(self) -> None:
        """Settle every square of the table, as it is."""
        world, memory = self._truth, self.memory
        quarters = round(world.heading / 90 - 1e-9)
        angle = world.heading - 90 * quarters
        x, y = math.floor(world.utak.x), math.floor(world.utak.y)
        within = turned(world.utak.x - x - 0.5, world.utak.y - y - 0.5, -90 * quarters)
        origin = (within[0] + 0.5, within[1] + 0.5)
        hypotheses = (Hypothesis(angle, origin + origin),)
        self.tracker.state = replace(memory, frame=Frame(angle, origin), place=origin, hypotheses=hypotheses)
        width, height = world.plan.width, world.plan.height
        occupied = np.logical_or.reduce(
            [digital(shape, width, height) for shape in (world.plan.verge, *(thing.polygon for thing in world.things))]
        )
        occupied = np.pad(occupied, KNOWN_VERGE, constant_values=True)
        rows, columns = np.indices(occupied.shape).reshape(2, -1)
        offsets = [
            turned(c - KNOWN_VERGE - x, r - KNOWN_VERGE - y, -90 * quarters) for r, c in zip(rows, columns, strict=True)
        ]
        squares = np.rint(offsets).astype(int)
        occupancy = memory.occupancy
        for corner in (squares.min(0), squares.max(0)):
            occupancy.make_room(*corner.tolist())
        where = squares[:, 1] - occupancy.south, squares[:, 0] - occupancy.west
        occupancy.state[where] = np.where(occupied.ravel(), OCCUPIED, FREE)
        occupancy.seen[where], occupancy.settled_by[where] = True, 0


def knowing(world: RandomScenario) -> RobotMaker:
    """Return a maker of robots that know a world."""

    def make(body: Body, task: Task, settings: Settings) -> Any:
        robot = Robot(body, task, Options(settings.paths, settings.kb_files, settings.max_steps, settings.pull))
        robot.knowledge = Informed(world)
        return robot

    return make
