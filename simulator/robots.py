"""Where simulator and planner are wired together: the one robot that the command line runs."""

import importlib
from typing import cast

from kb.body import Body
from kb.task import Task
from simulator.session import Robot
from simulator.settings import Settings


def make_robot(body: Body, task: Task, settings: Settings) -> Robot:
    """Return the robot of `planner.cycle` with a body and a task."""
    cycle = importlib.import_module("planner.cycle")
    options = cycle.Options(paths=settings.paths, kb_files=settings.kb_files, max_steps=settings.max_steps)
    return cast(Robot, cycle.Robot(body, task, options))
