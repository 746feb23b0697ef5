"""The plan of a sweep: its runs in order, and the name of each."""

import hashlib
import json
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property
from itertools import islice
from typing import Any, NamedTuple

from utak.simulator.scenario.settings import MAX_SEED, USUAL_RISK, Settings
from utak.simulator.sweep.contents import ScenarioContents
from utak.simulator.sweep.executors.code_identity import code_identity
from utak.simulator.sweep.executors.tasks import WorkerTask

RUN_FUNCTION = "utak.simulator.sweep.one_run:run_one"  # what a worker does for a run
PREPARATION_FUNCTION = "utak.simulator.sweep.one_run:prepare"  # what each worker process does first
MAX_RUNS = 200_000  # of a sweep; each takes about 2 kB of memory
RUN_ID_LENGTH = 16  # hexadecimal digits: two of `MAX_RUNS` runs agree in them once in a billion sweeps


class SweepRun(NamedTuple):
    """One run of a sweep: the name of the scenario, noise and seed."""

    scenario: str
    noise: float
    seed: int


@dataclass(frozen=True)
class SweepPlan:
    """A sweep: every scenario with every noise and every seed."""

    scenarios: tuple[ScenarioContents, ...]  # their contents; the names differ
    seeds: tuple[tuple[int, int], ...]  # half-open ranges (first, end) of seeds, in order; no seed is in two of them
    noises: tuple[float, ...]  # the noises, each once
    # The other options of the runs; seed, noise and files of rules in it have no meaning
    settings: Settings = field(default_factory=Settings)
    rules: tuple[tuple[str, str], ...] = ()  # (name, text) of each file of users' rules
    seconds: float | None = None  # the limit of wall-clock time of a run; None for no limit
    certificates: str | None = None  # the folder in which episodes and certificates are kept; None to keep none
    risk: float = USUAL_RISK  # of certificates of runs with noise, percent
    shard: tuple[int, int] = (1, 1)  # (i, n): only every n-th run, from the i-th on

    @property
    def size(self) -> int:
        """The number of runs of all shards."""
        return len(self.scenarios) * len(self.noises) * sum(end - first for first, end in self.seeds)

    @cached_property
    def runs(self) -> tuple[SweepRun, ...]:
        """The runs of the shard in order: by scenario, then noise, then seed."""
        which, of = self.shard
        return tuple(islice(self._runs(), which - 1, None, of))

    def run_id(self, run: SweepRun) -> str:
        """Return the name of a run: a digest of all that decides its result, hexadecimal."""
        rules = [text for _, text in self.rules]
        options = (run.seed, run.noise, self.settings.paths, self.settings.max_steps, self.settings.pull, self.seconds)
        whole = json.dumps([self._digests[run.scenario], rules, options, code_identity()])
        return hashlib.sha256(whole.encode()).hexdigest()[:RUN_ID_LENGTH]

    def task(self, run: SweepRun) -> WorkerTask:
        """Return the task of a run, with the texts of all files that it needs."""
        argument: dict[str, Any] = {
            "files": [list(file) for file in self._contents[run.scenario].files],
            "rules": [list(file) for file in self.rules],
            "options": self.settings.options | {"noise": run.noise, "seed": run.seed},
            "certificates": self.certificates is not None,
            "risk": self.risk,
        }
        return WorkerTask(RUN_FUNCTION, argument, self.seconds)

    @cached_property
    def _digests(self) -> dict[str, str]:
        return {one.name: one.digest for one in self.scenarios}

    @cached_property
    def _contents(self) -> dict[str, ScenarioContents]:
        return {one.name: one for one in self.scenarios}

    def _runs(self) -> Iterator[SweepRun]:
        for contents in self.scenarios:
            for noise in self.noises:
                for first, end in self.seeds:
                    yield from (SweepRun(contents.name, noise, seed) for seed in range(first, end))


def parse_seeds(text: str) -> tuple[tuple[int, int], ...]:
    """Return the ranges of seeds that a text denotes: `A:B` for A to B - 1, `A` for A alone, with commas between.

    >>> parse_seeds("0:10,12,10")
    ((0, 10), (12, 13), (10, 11))
    """
    # Raises ValueError, with a message for users, for any other text.
    ranges: list[tuple[int, int]] = []
    for part in text.split(","):
        first, end = _range(part)
        if any(first < known_end and known_first < end for known_first, known_end in ranges):
            raise ValueError(f"a seed occurs twice in {text[:40]!r}")
        if ranges and ranges[-1][1] == first:
            ranges[-1] = (ranges[-1][0], end)
        else:
            ranges.append((first, end))
    return tuple(ranges)


def _range(part: str) -> tuple[int, int]:
    numbers = part.split(":")
    if len(numbers) > 2 or not all(1 <= len(n) <= 19 and n.isascii() and n.isdigit() for n in numbers):
        raise ValueError(f"must be A:B (seeds A to B - 1) or A, with commas between, not {part[:40]!r}")
    first = int(numbers[0])
    end = int(numbers[-1]) if len(numbers) == 2 else first + 1
    if end <= first:
        raise ValueError(f"there is no seed in {part[:40]!r}: A:B is the seeds A to B - 1")
    if end > MAX_SEED + 1:
        raise ValueError(f"seeds are below {MAX_SEED + 1}, unlike those in {part[:40]!r}")
    return first, end
