"""One of several things to do: an error is reported at once, and the other things are still done."""

import os
from collections.abc import Callable
from typing import ParamSpec

from utak.kb.language.diagnostics import BadInputError, CannotOpenError
from utak.simulator.terminal import exits
from utak.simulator.terminal.streams import StreamError

_Parameters = ParamSpec("_Parameters")


class UsageError(Exception):
    """The command line is wrong; the message says what is."""


def outcome_of(
    do: Callable[_Parameters, int], *args: _Parameters.args, **kwargs: _Parameters.kwargs
) -> tuple[int, str]:
    """Call a function and return its exit code with ''; for an error, the code for it and its message."""
    try:
        return do(*args, **kwargs), ""
    except BadInputError as bad:
        return exits.BAD_INPUT, str(bad)
    except CannotOpenError as absent:
        return exits.CANNOT_OPEN, f"utak: {absent}"
    except (StreamError, BrokenPipeError):
        raise
    except Exception as bug:
        if os.environ.get("UTAK_DEBUG"):
            raise
        what = f"utak: this is a bug of ours: {type(bug).__name__}: {str(bug)[:500]}\n"
        return exits.OUR_BUG, what + "Please report it with the command and its files; UTAK_DEBUG=1 shows where."
