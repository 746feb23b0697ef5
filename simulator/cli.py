"""The `utak` command: declares the subcommands, runs one, and turns what goes wrong into messages and exit codes."""

import argparse
import os
import sys
from collections.abc import Sequence

from kb.problems import BadInputError, CannotOpenError
from simulator import exits
from simulator.commands import check, new, query, repl, routes, run, show, test

COMMANDS = (run, test, check, show, new, query, repl, routes)
EXIT_CODES = (
    "exit codes: 0 done; 1 ran, goal not reached; 2 usage; 65 bad input; 66 cannot open; 70 our bug; 75 limit; "
    "130 interrupted"
)


def parser() -> argparse.ArgumentParser:
    """Return the parser of the whole command line."""
    top = argparse.ArgumentParser(
        prog="utak",
        description="Utak, a robot who sees coarsely, believes with confidence and solves spatial tasks.",
        epilog=EXIT_CODES,
    )
    parts = top.add_subparsers(title="commands", metavar="COMMAND", required=True)
    for command in COMMANDS:
        command.add(parts)
    return top


def main(arguments: Sequence[str] | None = None) -> int:
    """Run `utak` with arguments (those of the process by default) and return its exit code."""
    try:
        options = parser().parse_args(arguments)
    except SystemExit as stop:  # argparse has said what is wrong, or has printed the help
        return stop.code if isinstance(stop.code, int) else exits.USAGE
    try:
        code: int = options.execute(options)
        sys.stdout.flush()
    except BadInputError as bad:
        return _say(exits.BAD_INPUT, str(bad))
    except CannotOpenError as absent:
        return _say(exits.CANNOT_OPEN, f"utak: {absent}")
    except KeyboardInterrupt:
        return _say(exits.INTERRUPTED, "utak: interrupted")
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # so that nothing complains at exit
        return exits.NO_READER
    except Exception as bug:
        if os.environ.get("UTAK_DEBUG"):
            raise
        what = f"utak: this is a bug of ours: {type(bug).__name__}: {str(bug)[:500]}\n"
        return _say(exits.OUR_BUG, what + "Please report it with the command and its files; UTAK_DEBUG=1 shows where.")
    return code


def _say(code: int, message: str) -> int:
    print(message, file=sys.stderr)
    return code


if __name__ == "__main__":
    sys.exit(main())
