"""The plan of a sweep: its runs in order, and the header of its results."""

import hashlib
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, NamedTuple

from utak.simulator.scenario.settings import Settings
from utak.simulator.sweep.contents import ScenarioContents
from utak.simulator.sweep.executors.code_identity import code_identity
from utak.simulator.sweep.executors.tasks import WorkerTask

SWEEP_VERSION = 1  # of the form of results; docs/sweeps.md
RUN_FUNCTION = "utak.simulator.sweep.one_run:run_one"  # what a worker does for a run
PREPARATION_FUNCTION = "utak.simulator.sweep.one_run:prepare"  # what each worker process does first
SEED_LIMIT = 2**63  # seeds are below it
MAX_RUNS = 200_000  # of a sweep; each takes about 2 kB of memory


class SweepRun(NamedTuple):
    """One run of a sweep: the name of the scenario, noise and seed. It is the key of its line in the results."""

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

    @property
    def size(self) -> int:
        """The number of runs."""
        return len(self.scenarios) * len(self.noises) * sum(end - first for first, end in self.seeds)

    @cached_property
    def runs(self) -> tuple[SweepRun, ...]:
        """All runs in the order of their lines in the results: by scenario, then noise, then seed."""
        return tuple(self._runs())

    @cached_property
    def header(self) -> dict[str, Any]:
        """The first line of the results: what determines them, and with which code and libraries."""
        return {
            "utak": "sweep",
            "version": SWEEP_VERSION,
            "runs": self.size,
            "plan": {
                "scenarios": {one.name: one.digest for one in self.scenarios},
                "seeds": written_seeds(self.seeds),
                "noise": list(self.noises),
                "paths": self.settings.paths,
                "max_steps": self.settings.max_steps,
                "pull": self.settings.pull,
                "kb": [hashlib.sha256(text.encode("utf-8", "surrogateescape")).hexdigest() for _, text in self.rules],
                "seconds": self.seconds,
            },
            "made_with": code_identity(),
        }

    def task(self, run: SweepRun) -> WorkerTask:
        """Return the task of a run, with the texts of all files that it needs."""
        contents = next(one for one in self.scenarios if one.name == run.scenario)
        argument = {
            "files": [list(file) for file in contents.files],
            "rules": [list(file) for file in self.rules],
            "seed": run.seed,
            "noise": run.noise,
            "paths": self.settings.paths,
            "max_steps": self.settings.max_steps,
            "pull": self.settings.pull,
        }
        return WorkerTask(RUN_FUNCTION, argument, self.seconds)

    def _runs(self) -> Iterator[SweepRun]:
        for contents in self.scenarios:
            for noise in self.noises:
                for first, end in self.seeds:
                    yield from (SweepRun(contents.name, noise, seed) for seed in range(first, end))


def written_seeds(ranges: tuple[tuple[int, int], ...]) -> str:
    """Return ranges of seeds as `--seeds` takes them.

    >>> written_seeds(((0, 10), (12, 13)))
    '0:10,12'
    """
    return ",".join(str(first) if end == first + 1 else f"{first}:{end}" for first, end in ranges)


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
    """Return the range (first, end) of `A:B` or `A`; raise ValueError for any other text."""
    numbers = part.split(":")
    if len(numbers) > 2 or not all(1 <= len(n) <= 19 and n.isascii() and n.isdigit() for n in numbers):
        raise ValueError(f"must be A:B (seeds A to B - 1) or A, with commas between, not {part[:40]!r}")
    first = int(numbers[0])
    end = int(numbers[-1]) if len(numbers) == 2 else first + 1
    if end <= first:
        raise ValueError(f"there is no seed in {part[:40]!r}: A:B is the seeds A to B - 1")
    if end > SEED_LIMIT:
        raise ValueError(f"seeds are below {SEED_LIMIT}, unlike those in {part[:40]!r}")
    return first, end
