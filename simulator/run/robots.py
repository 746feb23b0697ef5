"""The robot that the command line runs: here simulator and planner are wired together."""

from typing import TYPE_CHECKING

from utak.kb.body import Body
from utak.kb.task.task import Task
from utak.planner.stages import stages
from utak.simulator.run.session import RobotMaker, RobotProtocol
from utak.simulator.run.warming import warm
from utak.simulator.scenario.settings import Settings

if TYPE_CHECKING:
    from utak.planner.cycle import Options


def make_robot(body: Body, task: Task, settings: Settings) -> RobotProtocol:
    """Return our robot for a body and a task; compile the geometry kernels that it needs first."""
    from utak.planner.cycle import Robot as Mind

    warm_for(make_robot, task, settings)
    return Mind(body, task, _options(settings))


def warm_for(make: RobotMaker, task: Task, settings: Settings) -> None:
    """Compile the geometry kernels that a robot made by `make` needs for a task; other robots need none."""
    if make is make_robot:
        warm(carrying=any(stage.carried for stage in stages(task)), paths=settings.paths)


def _options(settings: Settings) -> "Options":
    """Return the robot's options for the options of a run."""
    from utak.planner.cycle import Options

    return Options(paths=settings.paths, kb_files=settings.kb_files, max_steps=settings.max_steps, pull=settings.pull)
