"""The exit codes of the `utak` command, and which of several is the worst."""

from collections.abc import Iterable

SUCCESS = 0
NOT_REACHED = 1  # it ran, and the goal is not reached: the verdict says why
USAGE = 2
BAD_INPUT = 65
CANNOT_OPEN = 66
OUR_BUG = 70
LOST_OUTPUT = 74  # a standard stream cannot be read or written
LIMIT = 75
INTERRUPTED = 130
NO_READER = 141  # whoever read our output went away

SEVERITY_ORDER = (OUR_BUG, CANNOT_OPEN, BAD_INPUT, LIMIT, NOT_REACHED, SUCCESS)


def worst(codes: Iterable[int]) -> int:
    """Return the code that stands for several: a bug before an absent file before bad input before a failure."""
    return min(codes, key=SEVERITY_ORDER.index, default=SUCCESS)
