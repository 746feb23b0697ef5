"""A limit of wall-clock time for a run, looked at between two steps; it also cuts a step off."""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from utak.kb.language.operating_system import alarms

ALARM_INTERVAL = (
    0.1  # seconds between two alarms: the one that falls where errors are ignored is repeated; a convention
)


class TimeOver(BaseException):
    """Raised in a step when the time of the run is over."""


class TimeLimit:
    """The time that a run may take."""

    def __init__(self, seconds: float, clock: Callable[[], float] = time.monotonic) -> None:
        self.seconds, self._clock = seconds, clock
        self._begun = clock()

    def begin(self) -> None:
        """Count the seconds from now on."""
        self._begun = self._clock()

    @property
    def is_over(self) -> bool:
        """Whether so many seconds have passed."""
        return self._clock() - self._begun >= self.seconds

    @contextmanager
    def cutting(self) -> Iterator[None]:
        """Raise TimeOver in a `with` block as soon as the time is over."""
        if self._clock is not time.monotonic:
            yield
            return

        def cut() -> None:
            """End the block."""
            raise TimeOver

        with alarms(self.seconds - (self._clock() - self._begun), ALARM_INTERVAL, cut):
            yield
