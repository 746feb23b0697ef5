"""Situations of world models: with their rooms and corners, and no task unless one is given."""

from collections.abc import Mapping

from kb.corners import corners
from kb.rooms import rooms_of
from kb.task import Task
from kb.worldmodel import WorldModel
from planner.destinations import Situation
from planner.screen import Screens

NO_TASK = Task({}, (), ())


def situation_of(model: WorldModel, bound: Mapping[str, str] | None = None, task: Task = NO_TASK) -> Situation:
    """What a planner is told of a world model. bound : what the task's parameters mean."""
    return Situation(model, Screens(model), bound or {}, rooms_of(model), corners(model), task)
