"""The summary of a sweep: counts, rates with intervals, and steps, by scenario and noise."""

import math
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from statistics import NormalDist, median
from typing import Any

from utak.simulator.sweep.executors.tasks import DIED, RAISED, TOO_LONG
from utak.simulator.sweep.results import ResultRow

CONFIDENCE_LEVEL = 0.95  # of the intervals of rates; a convention
UPPER_PERCENTILE = 0.95  # of the steps; a convention
FAILURE_WORDS = {TOO_LONG: "took too long", DIED: "died", RAISED: "raised an error"}
MAX_LISTED_RUNS = 10  # of each kind, below the table; a convention


@dataclass(frozen=True)
class SweepCount:
    """Counts what came out of the runs of one scenario at one noise, or of several."""

    scenario: str  # the name; "all" for all scenarios
    noise: float | None  # the noise; None for all noises
    rows: tuple[ResultRow, ...]  # the rows of the results

    @property
    def runs(self) -> int:
        """The number of runs."""
        return len(self.rows)

    @property
    def done(self) -> int:
        """The number of runs in which the robot believes that the task is done."""
        return sum(row["result"]["believed"] for row in self._ended)

    @property
    def achieved(self) -> int | None:
        """The number of runs in which the task is done by expect.lp; None when no scenario has one."""
        return sum(row["result"]["achieved"] is True for row in self._ended) if self.judged else None

    @property
    def false_claims(self) -> tuple[ResultRow, ...]:
        """The runs in which the robot believes that the task is done, and it is not."""
        return tuple(row for row in self._ended if row["result"]["believed"] and row["result"]["achieved"] is False)

    @property
    def failed(self) -> tuple[ResultRow, ...]:
        """The runs without a result."""
        return tuple(row for row in self.rows if row["failed"] is not None)

    @property
    def judged(self) -> int:
        """The number of runs of scenarios with an expect.lp."""
        return sum(row["passed"] is not None for row in self.rows)

    @property
    def passed(self) -> int:
        """The number of runs that end as expect.lp expects, in the sense of `utak test`."""
        return sum(row["passed"] is True for row in self.rows)

    @property
    def success_rate(self) -> float | None:
        """The part of the judged runs that passed, 0 to 1; None without such runs."""
        return self.passed / self.judged if self.judged else None

    @property
    def success_interval(self) -> tuple[float, float] | None:
        """The Wilson interval of the success rate."""
        return wilson_interval(self.passed, self.judged) if self.judged else None

    @property
    def steps(self) -> list[int]:
        """The numbers of commands of the runs that have a result, in increasing order."""
        return sorted(row["result"]["steps"] for row in self._ended)

    @property
    def as_values(self) -> dict[str, Any]:
        """The count as JSON values."""
        steps = self.steps
        return {
            "scenario": self.scenario,
            "noise": self.noise,
            "runs": self.runs,
            "done": self.done,
            "achieved": self.achieved,
            "false_claims": len(self.false_claims),
            "failed": dict(Counter(row["failed"]["how"] for row in self.failed)),
            "judged": self.judged,
            "passed": self.passed,
            "success_rate": self.success_rate,
            "success_interval": None if self.success_interval is None else list(self.success_interval),
            "verdicts": dict(sorted(Counter(row["result"]["verdict"] for row in self._ended).items())),
            "steps_median": median(steps) if steps else None,
            "steps_95_percentile": upper_percentile(steps) if steps else None,
        }

    @property
    def _ended(self) -> list[ResultRow]:
        return [row for row in self.rows if row["result"] is not None]


def wilson_interval(successes: int, trials: int, level: float = CONFIDENCE_LEVEL) -> tuple[float, float]:
    """Return the Wilson score interval of a rate: its lower and upper end, 0 to 1.

    Examples
    --------
    >>> "{:.3f} to {:.3f}".format(*wilson_interval(9, 10))
    '0.596 to 0.982'
    """
    z = NormalDist().inv_cdf((1 + level) / 2)
    rate, weight = successes / trials, z * z / trials
    middle = (rate + weight / 2) / (1 + weight)
    half = z * math.sqrt(rate * (1 - rate) / trials + weight / (4 * trials)) / (1 + weight)
    return (0.0 if successes == 0 else middle - half), (1.0 if successes == trials else middle + half)


def upper_percentile(ordered: Sequence[int], part: float = UPPER_PERCENTILE) -> int:
    """Return the least value of an increasing sequence that at least a part of all values do not exceed.

    >>> upper_percentile([1, 2, 3, 40])
    40
    """
    return ordered[math.ceil(part * len(ordered)) - 1]


def counts_of(rows: Iterable[ResultRow]) -> list[SweepCount]:
    """Return a count for each scenario and noise, in the order in which they occur first."""
    groups: dict[tuple[str, float], list[ResultRow]] = {}
    for row in rows:
        groups.setdefault((row["scenario"], row["noise"]), []).append(row)
    return [SweepCount(scenario, noise, tuple(group)) for (scenario, noise), group in groups.items()]


def total_of(counts: Iterable[SweepCount]) -> SweepCount:
    """Return the count of all runs."""
    return SweepCount("all", None, tuple(row for count in counts for row in count.rows))


def table_of(counts: Sequence[SweepCount]) -> str:
    """Return the counts as an aligned table with a row for all runs, and below it the runs to look at."""
    every = total_of(counts)
    shown = [*counts, every] if len(counts) != 1 else list(counts)
    lines = [list(_cells(shown[0]))] + [list(_cells(count).values()) for count in shown]
    widths = [max(map(len, column)) for column in zip(*lines, strict=True)]
    text = ["  ".join([line[0].ljust(widths[0]), *map(str.rjust, line[1:], widths[1:])]) for line in lines]
    text += _listed("believed done, but not achieved", every.false_claims)
    for how, words in FAILURE_WORDS.items():
        text += _listed(words, [row for row in every.failed if row["failed"]["how"] == how])
    return "\n".join(line.rstrip() for line in text) + "\n"


def _cells(count: SweepCount) -> dict[str, str]:
    """Return a row of the table by the heads of its columns."""
    interval, steps = count.success_interval, count.steps
    percent = "-"
    if interval is not None:
        percent = f"{100 * count.passed / count.judged:.0f} ({100 * interval[0]:.0f} to {100 * interval[1]:.0f})"
    return {
        "scenario": count.scenario,
        "noise": "" if count.noise is None else f"{count.noise:g}",
        "runs": str(count.runs),
        "done": str(count.done),
        "achieved": "-" if count.achieved is None else str(count.achieved),
        "false": str(len(count.false_claims)),
        "failed": str(len(count.failed)),
        "success %": percent,
        "steps": f"{median(steps):g}" if steps else "-",
        "95 %": str(upper_percentile(steps)) if steps else "-",
    }


def _listed(what: str, rows: Sequence[ResultRow]) -> list[str]:
    """Return lines that name some runs; none for no runs."""
    lines = []
    for row in rows[:MAX_LISTED_RUNS]:
        reason = f": {row['failed']['reason']}" if row["failed"] else ""
        lines.append(f"{what}: {row['scenario']} --seed {row['seed']} --noise {row['noise']:g}{reason}")
    if len(rows) > MAX_LISTED_RUNS:
        lines.append(f"{what}: {len(rows) - MAX_LISTED_RUNS} more")
    return lines
