"""The command line of `utak`: its subcommands and their options."""

import argparse

from simulator.cli.commands import query, repl, replay, routes, run, test, warm
from simulator.cli.commands.files import check, new, show

COMMANDS = (run, test, check, show, new, query, repl, replay, routes, warm)  # in the order of the help text
# The end of the help text.
EXIT_CODES = (
    "exit codes: 0 done; 1 ran, goal not reached; 2 usage; 65 bad input; 66 cannot open; 70 our bug; "
    "74 a standard stream failed; 75 limit; 130 interrupted; 141 the reader of the output went away"
)


def build_parser() -> argparse.ArgumentParser:
    """Return the parser of the whole command line."""
    top = argparse.ArgumentParser(
        prog="utak",
        description="Utak, a simulated robot that sees coarsely, believes with confidence and solves spatial tasks.",
        epilog=EXIT_CODES,
    )
    parts = top.add_subparsers(title="commands", metavar="COMMAND", required=True)
    for command in COMMANDS:
        command.add(parts)
    return top
