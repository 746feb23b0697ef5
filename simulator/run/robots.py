"""The robot that the command line runs: here simulator and planner are wired together."""

from typing import TYPE_CHECKING, cast

from kb.body import Body
from kb.task.task import Task
from planner.stages import stages
from simulator.run.session import RobotProtocol
from simulator.run.warming import warm
from simulator.scenario.settings import Settings

if TYPE_CHECKING:
    from planner.cycle import Options, Robot


def make_robot(body: Body, task: Task, settings: Settings) -> RobotProtocol:
    """Return the robot of `planner.cycle` for a body and a task; compile the geometry kernels that it needs first."""
    from planner.cycle import Robot as Mind

    _warm(task, settings)
    return Mind(body, task, _options(settings))


def redirect_robot(robot: RobotProtocol, task: Task, settings: Settings) -> None:
    """Let a robot that `make_robot` made go on with another task or other options, from all that it knows."""
    _warm(task, settings)
    cast("Robot", robot).redirect(task, _options(settings))


def _warm(task: Task, settings: Settings) -> None:
    """Compile the geometry kernels that a task needs."""
    warm(carrying=any(stage.carried for stage in stages(task)), paths=settings.paths)


def _options(settings: Settings) -> "Options":
    """Return the robot's options for the options of a run."""
    from planner.cycle import Options

    return Options(paths=settings.paths, kb_files=settings.kb_files, max_steps=settings.max_steps, pull=settings.pull)
