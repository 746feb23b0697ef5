"""The result of one world, as a frozen value and as a line of JSON."""

import json
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from benchmarks.claims.asked import Asked

UNMET = ("expected ", "should have failed")  # how the judge tells an expectation that is not met
TIME, ERROR = "time", "error"  # in place of a verdict: the run was ended by a limit of its process, or broke


@dataclass(frozen=True)
class ClaimRow:
    """The result of one world.

    Attributes
    ----------
    verdict : what the robot claimed; or "time" or "error".
    cycles : processor seconds of each command.
    judged : the judge's findings, None without a judge.
    countersearch : see benchmarks.claims.refute.
    error : the last line of a traceback.
    """

    kind: str
    seed: int
    task: int
    goal: str
    variant: str
    possible: str
    noise: float
    verdict: str
    reason: str = ""
    believed: bool = False
    achieved: bool = False
    commands: int = 0
    cycles: list[float] = field(default_factory=list)
    judged: list[str] | None = None
    countersearch: str = ""
    false_done: bool = False
    false_impossible: bool = False
    refutation: str = ""
    error: str = ""

    @property
    def asked(self) -> Asked:
        """The world of this row."""
        return Asked(self.kind, self.seed, self.task)

    @property
    def false_claim(self) -> bool:
        """Whether a claim of the run is refuted."""
        return self.false_done or self.false_impossible

    @property
    def faulty(self) -> bool:
        """Whether a claim is false, the run broke or ran out of time, or the judge found something of the physics."""
        return self.false_claim or self.verdict in (TIME, ERROR) or bool(self.broken_laws)

    @property
    def broken_laws(self) -> list[str]:
        """The judge's findings without unmet expectations, against which the verdict is checked anyway."""
        return [finding for finding in self.judged or [] if not any(told in finding for told in UNMET)]

    @property
    def percentile(self) -> float:
        """The 95th percentile of the commands' processor seconds; 0 without commands."""
        return percentile(self.cycles)

    def line(self) -> str:
        """Return the row as JSON, with the longest command and the 95th percentile."""
        told = {"longest": max(self.cycles, default=0.0), "percentile_95": self.percentile}
        return json.dumps(asdict(self) | told)


def percentile(seconds: list[float], share: float = 0.95) -> float:
    """Return the least value that the given share (0 to 1) of the values does not exceed; 0 when there are none."""
    ordered = sorted(seconds)
    return ordered[min(len(ordered) - 1, int(share * len(ordered)))] if ordered else 0.0


def read_rows(path: Path) -> list[ClaimRow]:
    """Return the rows of a file of results; an incomplete last line is left out."""
    rows = []
    for line in path.read_text().splitlines():
        try:
            told: dict[str, Any] = json.loads(line)
        except json.JSONDecodeError:
            continue
        rows.append(ClaimRow(**{name: told[name] for name in ClaimRow.__dataclass_fields__}))
    return rows
