"""How long the robot thinks: the time of his steps without the time that the world takes."""

import time
from typing import Any

from kb.body import Body, Command, Impression


class TimedBody:
    """A body that adds up the seconds spent in the world."""

    def __init__(self, body: Body) -> None:
        self._body = body
        self.seconds = 0.0

    def wake(self) -> Impression:
        """As kb.body.Body."""
        begun = time.perf_counter()
        impression = self._body.wake()
        self.seconds += time.perf_counter() - begun
        return impression

    def act(self, command: Command) -> Impression:
        """As kb.body.Body."""
        begun = time.perf_counter()
        impression = self._body.act(command)
        self.seconds += time.perf_counter() - begun
        return impression


class TimedRobot:
    """A robot whose cycles are timed: `cycles` holds the seconds of waking and of each step, without the world's."""

    def __init__(self, robot: Any, body: TimedBody) -> None:
        self.robot, self._body = robot, body
        self.cycles: list[float] = []

    def wake(self) -> Any:
        """Wake the robot."""
        return self._timed(self.robot.wake)

    def step(self) -> Any:
        """Let the robot take a step."""
        return self._timed(self.robot.step)

    @property
    def finished(self) -> bool:
        """Whether the robot has come to a verdict."""
        return bool(self.robot.finished)

    @property
    def verdict(self) -> Any:
        """The robot's verdict."""
        return self.robot.verdict

    def _timed(self, act: Any) -> Any:
        begun, world = time.perf_counter(), self._body.seconds
        report = act()
        self.cycles.append(time.perf_counter() - begun - (self._body.seconds - world))
        return report
