"""Progress of long work: how much is done, and about how long the rest takes; on a terminal only."""

import sys
import threading
import time
from collections import defaultdict
from collections.abc import Hashable, Mapping
from statistics import fmean

from utak.planner.under_way import UNDER_WAY

REPORT_SECONDS = 2.0  # between two reports; a convention


class Progress:
    """Reports on a terminal (standard error), at most every few seconds, how many pieces of work are done."""

    def __init__(self, left: Mapping[Hashable, int], unit: str, interval: float = REPORT_SECONDS) -> None:
        self._left, self._unit, self._interval = dict(left), unit, interval
        self._total, self._done = sum(left.values()), 0
        self._seconds: dict[Hashable, list[float]] = defaultdict(list)
        self._begun = self._reported = time.monotonic()

    def note(self, kind: Hashable, seconds: float) -> None:
        """Note that a piece of a kind is done and took some seconds; report when it is time to."""
        self._done += 1
        self._left[kind] -= 1
        self._seconds[kind].append(seconds)
        now = time.monotonic()
        is_last = self._done == self._total
        if (now - self._reported >= self._interval or is_last) and sys.stderr.isatty():
            self._reported = now
            print(self.line(now - self._begun), file=sys.stderr, flush=True)

    def line(self, elapsed: float) -> str:
        """Return the report after some seconds."""
        if self._done == self._total:
            return f"{self._done} of {self._total} {self._unit} done in {duration(elapsed)}"
        rest = duration(self.remaining_seconds(elapsed))
        return f"{self._done} of {self._total} {self._unit} done, about {rest} left"

    def remaining_seconds(self, elapsed: float) -> float:
        """Return about how many seconds the rest takes, after some seconds and at least one piece."""
        spent = [value for values in self._seconds.values() for value in values]
        at_once = max(1.0, sum(spent) / elapsed) if elapsed > 0 else 1.0
        rest = sum(number * fmean(self._seconds[kind] or spent) for kind, number in self._left.items())
        return rest / at_once


class StepProgress:
    """Reports on a terminal (standard error) that a step of a run is planned, after 2, 6, 14 ... seconds of it."""

    def __init__(self, most: int | None = None, interval: float = REPORT_SECONDS) -> None:
        self._most, self._interval = most, interval
        self._step, self._begun = 0, 0.0
        self._changed, self._ended = threading.Event(), False
        self._thread = threading.Thread(target=self._report, daemon=True)

    def __enter__(self) -> "StepProgress":
        if sys.stderr.isatty():
            self._thread.start()
        return self

    def __exit__(self, *raised: object) -> None:
        self._ended = True
        self._changed.set()
        if self._thread.is_alive():
            self._thread.join()

    def begin(self, step: int) -> None:
        """Note that a step begins, whose number is given."""
        self._step, self._begun, UNDER_WAY.words = step, time.monotonic(), ""
        self._changed.set()

    def line(self, elapsed: float) -> str:
        """Return the report after some seconds of the step."""
        most = "" if self._most is None else f" of at most {self._most}"
        doing = UNDER_WAY.words and f", {UNDER_WAY.words}"
        return f"step {self._step}{most}: planning for {duration(elapsed)}{doing} ..."

    def _report(self) -> None:
        """Print reports until the block ends."""
        wait = self._interval
        while not self._ended:
            if self._changed.wait(wait):
                self._changed.clear()
                wait = self._interval
            elif self._step:
                print(self.line(time.monotonic() - self._begun), file=sys.stderr, flush=True)
                wait *= 2


def duration(seconds: float) -> str:
    """Return some seconds in words.

    >>> duration(7), duration(150), duration(5400)
    ('7 s', '2 min 30 s', '1 h 30 min')
    """
    whole = round(seconds)
    if whole < 60:
        return f"{whole} s"
    if whole < 3600:
        return f"{whole // 60} min {whole % 60} s"
    return f"{whole // 3600} h {whole % 3600 // 60} min"
