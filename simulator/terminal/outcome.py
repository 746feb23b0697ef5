"""One of several things to do: what goes wrong in it is told at once, and is no reason to leave out the others."""

import os
import sys
from collections.abc import Callable
from typing import ParamSpec

from kb.language.diagnostics import BadInputError, CannotOpenError
from simulator.terminal import exits
from simulator.terminal.streams import StreamError

_Parameters = ParamSpec("_Parameters")


def attempt(do: Callable[_Parameters, int], *args: _Parameters.args, **kwargs: _Parameters.kwargs) -> int:
    """Do something and return its exit code, or that of what went wrong, which is told on the standard error.

    A broken stream and Ctrl-C end everything. With UTAK_DEBUG set a bug does, too.
    """
    try:
        return do(*args, **kwargs)
    except BadInputError as bad:
        print(bad, file=sys.stderr)
        return exits.BAD_INPUT
    except CannotOpenError as absent:
        print(f"utak: {absent}", file=sys.stderr)
        return exits.CANNOT_OPEN
    except (StreamError, BrokenPipeError):
        raise
    except Exception as bug:
        if os.environ.get("UTAK_DEBUG"):
            raise
        print(bug_message(bug), file=sys.stderr)
        return exits.OUR_BUG


def bug_message(bug: Exception) -> str:
    """Return what to say of an exception that nothing here expects."""
    what = f"utak: this is a bug of ours: {type(bug).__name__}: {str(bug)[:500]}\n"
    return what + "Please report it with the command and its files; UTAK_DEBUG=1 shows where."
