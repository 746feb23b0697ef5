"""A task, its outcome, and what an executor is. Tasks and outcomes are JSON values, so they can travel."""

import json
import time
import traceback
from collections.abc import Callable, Generator, Sequence
from pathlib import Path
from pkgutil import resolve_name
from typing import Any, NamedTuple

from utak.kb.language.diagnostics import BadInputError, CannotOpenError

# How a task can fail: it took too long, its process ended, or it raised an exception.
TOO_LONG, DIED, RAISED = "time", "died", "error"
TRYING_FUNCTION = "utak.simulator.testing.suite:tried"  # what a worker does for a scenario that is tested
MAX_REASON_LENGTH = 500  # characters of a failure's reason; a convention


class WorkerTask(NamedTuple):
    """A call of a function by its name."""

    # "module:name"; the function takes one JSON value and returns one. Lists arrive as lists, not as tuples.
    function: str
    argument: Any  # that JSON value
    seconds: float | None = None  # the limit of wall-clock time; None for no limit


class TaskOutcome(NamedTuple):
    """The end of a task."""

    value: Any  # what the function returned; None when the task failed
    failure: str = ""  # "" or how it failed: `TOO_LONG`, `DIED` or `RAISED`
    reason: str = ""  # why it failed, in words; "" when it did not
    seconds: float = 0.0  # the wall-clock time that it took


def bug_of(outcome: TaskOutcome) -> str:
    """Return the message about a process that did not tell how the scenario came out that it tried."""
    return f"this is a bug of ours: {outcome.reason.replace('its process', 'the process that runs the scenario', 1)}"


# Carries tasks out and yields (index of the task, outcome) as they end, in any order, each task once. Closing the
# iterator ends what is under way.
Executor = Callable[[Sequence[WorkerTask]], Generator[tuple[int, TaskOutcome], None, None]]


def carry_out(task: WorkerTask) -> TaskOutcome:
    """Call the function of a task in this process, without a limit of time, and return the outcome."""
    begun = time.monotonic()
    try:
        value = resolve_name(task.function)(task.argument)
        json.dumps(value)
    except Exception as error:
        return TaskOutcome(None, RAISED, reason_of(error), time.monotonic() - begun)
    return TaskOutcome(value, seconds=time.monotonic() - begun)


def reason_of(error: Exception) -> str:
    """Return an exception in words, with the file and line where it was raised."""
    if isinstance(error, BadInputError | CannotOpenError):
        return str(error)[:MAX_REASON_LENGTH]
    frames = traceback.extract_tb(error.__traceback__)
    where = f" ({Path(frames[-1].filename).name}:{frames[-1].lineno})" if frames else ""
    return f"{type(error).__name__}: {error}"[:MAX_REASON_LENGTH] + where
