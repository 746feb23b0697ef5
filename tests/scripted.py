"""A robot for tests that does not think: it gives the commands of a list, and then a verdict."""

from collections.abc import Sequence

from utak.kb.body import Body, Command
from utak.planner.cycle import StepReport, TaskEnd


class Scripted:
    """A robot that gives the commands of a list and then a verdict; with none it has its verdict once it is awake."""

    def __init__(self, body: Body, commands: Sequence[Command], verdict: TaskEnd) -> None:
        self._body, self._commands, self.verdict = body, list(commands), verdict

    def wake(self) -> StepReport:
        return StepReport(None, self._body.wake(), {}, "woke")

    def step(self) -> StepReport:
        command = self._commands.pop(0)
        return StepReport(command, self._body.act(command), {}, "as told")

    @property
    def finished(self) -> bool:
        return not self._commands
