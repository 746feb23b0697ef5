"""The time of the robot's thinking: the time of its steps without the time that the world takes.

Both clocks are read: the clock on the wall, which a user feels, and the processor's, which other work on the machine
does not affect.
"""

import time
from typing import Any, NamedTuple

from utak.kb.body import Body, Command, Impression


class Seconds(NamedTuple):
    """Seconds by the clock on the wall and by the processor's (this process alone)."""

    wall: float
    processor: float

    def __sub__(self, other: "Seconds") -> "Seconds":
        return Seconds(self.wall - other.wall, self.processor - other.processor)

    def plus(self, other: "Seconds") -> "Seconds":
        """Return the sum of two times."""
        return Seconds(self.wall + other.wall, self.processor + other.processor)


def now() -> Seconds:
    """Return the time by both clocks."""
    return Seconds(time.perf_counter(), time.process_time())


class TimedBody:
    """A body that adds up the seconds spent in the world."""

    def __init__(self, body: Body) -> None:
        self._body = body
        self.seconds = Seconds(0.0, 0.0)

    def wake(self) -> Impression:
        """Wake the body, as kb.body.Body.wake."""
        begun = now()
        impression = self._body.wake()
        self.seconds = self.seconds.plus(now() - begun)
        return impression

    def act(self, command: Command) -> Impression:
        """Execute a command, as kb.body.Body.act."""
        begun = now()
        impression = self._body.act(command)
        self.seconds = self.seconds.plus(now() - begun)
        return impression


class TimedRobot:
    """A robot whose cycles are timed: `cycles` holds the times of waking and of each step, without the world's."""

    def __init__(self, robot: Any, body: TimedBody) -> None:
        self.robot, self._body = robot, body
        self.cycles: list[Seconds] = []

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
        begun, world = now(), self._body.seconds
        report = act()
        self.cycles.append(now() - begun - (self._body.seconds - world))
        return report
