"""The robot that the command line runs: here simulator and planner are wired together."""

from kb.body import Body
from kb.task.task import Task
from planner.stages import stages
from simulator.run.session import RobotProtocol
from simulator.run.warming import warm
from simulator.scenario.settings import Settings


def make_robot(body: Body, task: Task, settings: Settings) -> RobotProtocol:
    """Return the robot of `planner.cycle` for a body and a task; compile the geometry kernels that it needs first."""
    from planner.cycle import Options
    from planner.cycle import Robot as Mind

    warm(carrying=any(stage.carried for stage in stages(task)), paths=settings.paths)
    options = Options(
        paths=settings.paths, kb_files=settings.kb_files, max_steps=settings.max_steps, pull=settings.pull
    )
    return Mind(body, task, options)
