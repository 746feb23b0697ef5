"""The exit codes of the `utak` command."""

DONE = 0
NOT_REACHED = 1  # it ran, and the goal is not reached: the verdict says why
USAGE = 2
BAD_INPUT = 65
CANNOT_OPEN = 66
OUR_BUG = 70
LIMIT = 75
INTERRUPTED = 130
NO_READER = 141  # whoever read our output went away
