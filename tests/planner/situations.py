"""Situations for tests: those of a world model with its rooms and corners, and a drawn room."""

from collections.abc import Mapping

from kb.task.task import Task
from kb.world.corners import corners
from kb.world.model import WorldModel
from kb.world.rooms import rooms_of
from planner.screen.projection import CostMaps
from planner.situation import Situation

NO_TASK = Task({}, (), ())
BESIDE_A_THING = [  # a room, with the robot right beside the only object
    "b" * 20,
    *["b" + "." * 18 + "b"] * 6,
    "b....ggg" + "." * 11 + "b",
    "b...Uggg" + "." * 11 + "b",
    "b....ggg" + "." * 11 + "b",
    *["b" + "." * 18 + "b"] * 6,
    "b" * 20,
]


def situation_of(model: WorldModel, bound: Mapping[str, str] | None = None, task: Task = NO_TASK) -> Situation:
    """Return the situation of a world model. bound : the names of the nodes that the task's parameters mean."""
    return Situation(model, CostMaps(model), bound or {}, rooms_of(model), corners(model), task)
