"""A limit of wall-clock time for a run, looked at between two steps."""

import time
from collections.abc import Callable


class TimeLimit:
    """The time that a run may take.

    Parameters
    ----------
    seconds : the limit, in seconds of wall-clock time.
    clock : returns seconds that have passed since whenever.

    Attributes
    ----------
    seconds : as given.
    """

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
