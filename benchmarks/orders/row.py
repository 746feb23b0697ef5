"""The result of one run, as a frozen value and as a JSON object."""

from dataclasses import asdict, dataclass
from typing import Any

from benchmarks.orders.asked import AskedRun
from utak.simulator.sweep.results import RowKey

RUN_OUT_OF_TIME, RUN_BROKE = "time", "error"  # in place of a verdict
CAN_BE_DONE, MAY_BE_DONE = "yes", "unknown"
KEY_NAMES = ("kind", "name", "pull", "max_steps", "seconds")
UNMET_WORDS = ("expected ", "should have failed")  # how the judge tells an expectation that is not met


@dataclass(frozen=True)
class RunBounds:
    """The conditions of a run.

    Attributes
    ----------
    pull : whether the robot may pull. max_steps : the limit of commands.
    seconds : the limit of the processor's seconds. search : the same for the search that knows the truth.
    """

    pull: bool = True
    max_steps: int = 300
    seconds: int = 120
    search: int = 20


@dataclass(frozen=True)
class OrderRow:
    """The result of one run.

    Attributes
    ----------
    kind, name : the task. variant : what it is within its kind.
    pull, max_steps, seconds : the conditions.
    possible : "yes" or "unknown". carries : the number of carries that do it, as the search found; 0 when unknown.
    verdict : the robot's, or "time" or "error". believed, reason : as it told.
    achieved : whether the truth is as the task wants it. met, wanted : of a random world: how many of the things that
        the task wants are so at the end; of a sequence: how many steps were reached in turn.
    commands : how many were given. took : processor seconds of the run.
    carried : how often the robot took something in hand and moved it.
    judged : the judge's findings; None without a judge or result.
    false_done, false_impossible, refutation : claims that are not so, and what refutes them.
    """

    kind: str
    name: str
    variant: str = ""
    pull: bool = True
    max_steps: int = 300
    seconds: int = 120
    possible: str = MAY_BE_DONE
    carries: int = 0
    verdict: str = RUN_BROKE
    reason: str = ""
    believed: bool = False
    achieved: bool = False
    met: int = 0
    wanted: int = 0
    commands: int = 0
    took: float = 0.0
    carried: int = 0
    judged: list[str] | None = None
    false_done: bool = False
    false_impossible: bool = False
    refutation: str = ""

    @property
    def broken_laws(self) -> list[str]:
        """The judge's findings without unmet expectations, against which the verdict is checked anyway."""
        return [finding for finding in self.judged or [] if not any(word in finding for word in UNMET_WORDS)]

    @property
    def faulty(self) -> bool:
        """Whether a claim is not so, the run broke, or the judge found something of the physics."""
        return self.false_done or self.false_impossible or self.verdict == RUN_BROKE or bool(self.broken_laws)

    def entry(self) -> dict[str, Any]:
        """Return the row as a JSON object."""
        return asdict(self)


def row_of_entry(entry: dict[str, Any]) -> OrderRow:
    """Return the row of a JSON object. Raises TypeError when a value has no place in a row."""
    return OrderRow(**entry)


def key_of_run(asked: AskedRun, bounds: RunBounds) -> RowKey:
    """Return the key of the row of a run."""
    return asked.kind, asked.name, bounds.pull, bounds.max_steps, bounds.seconds


def problem_of(entry: dict[str, Any]) -> str:
    """Return what is wrong with the JSON object of a row; "" for nothing."""
    try:
        row_of_entry(entry)
    except TypeError as error:
        return str(error)
    return ""
