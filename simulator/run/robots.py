"""The robot that the command line runs: here simulator and planner are wired together."""

from utak.kb.body import Body
from utak.kb.task.task import Task
from utak.planner.stages import stages
from utak.simulator.run.session import RobotMaker, RobotProtocol
from utak.simulator.run.warming import warm
from utak.simulator.scenario.settings import Settings


def make_robot(body: Body, task: Task, settings: Settings) -> RobotProtocol:
    """Return our robot for a body and a task; compile the geometry kernels that it needs first."""
    from utak.planner.cycle import Options, Robot

    warm_for(make_robot, task, settings)
    return Robot(body, task, Options(settings.paths, settings.kb_files, settings.max_steps, settings.pull))


def warm_for(make: RobotMaker, task: Task, settings: Settings) -> None:
    """Compile the geometry kernels that a robot made by `make` needs for a task; other robots need none."""
    if make is make_robot:
        warm(carrying=any(stage.carried for stage in stages(task)), paths=settings.paths)
