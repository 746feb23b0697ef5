"""The exit codes of the `utak` command, and the order of their severity."""

from collections.abc import Iterable

SUCCESS = 0
NOT_REACHED = 1  # the run ended without reaching the goal; the verdict gives the reason
USAGE = 2
BAD_INPUT = 65
CANNOT_OPEN = 66
OUR_BUG = 70
LOST_OUTPUT = 74  # a standard stream cannot be read or written
LIMIT = 75
INTERRUPTED = 130
NO_READER = 141  # the reader of the output ended (SIGPIPE)

# From the most severe code on; docs/files.md.
SEVERITY_ORDER = (OUR_BUG, CANNOT_OPEN, BAD_INPUT, LIMIT, NOT_REACHED, SUCCESS)


def worst(codes: Iterable[int]) -> int:
    """Return the most severe of several codes; `SUCCESS` for none."""
    return min(codes, key=SEVERITY_ORDER.index, default=SUCCESS)
