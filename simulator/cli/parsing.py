"""The command line of `utak`: its subcommands and their options."""

import argparse
import re
import sys
from collections.abc import Sequence
from itertools import pairwise
from typing import Any

from utak.kb.language.diagnostics import did_you_mean
from utak.simulator.cli.table import SUBCOMMANDS

NEGATIVE_POINT = re.compile(r"-[\d.][^,]*,.*")  # a point whose first coordinate has a minus, such as -1,2
# The end of the help text.
EXIT_CODES = (
    "exit codes: 0 done; 1 ran, goal not reached; 2 usage; 65 bad input; 66 cannot open; 70 our bug; "
    "74 a standard stream failed; 75 limit; 130 interrupted; 141 the reader of the output went away"
)


class HintingParser(argparse.ArgumentParser):
    """A parser that names the most similar word or option where it knows none."""

    intermixed = False  # whether options are taken between positional arguments, too
    _within = False  # whether parse_known_intermixed_args is at work, which calls parse_known_args itself

    def _check_value(self, action: argparse.Action, value: Any) -> None:
        """Raise ArgumentError when a value is not among the choices of an action."""
        try:
            super()._check_value(action, value)
        except argparse.ArgumentError:
            hint = did_you_mean(str(value), map(str, action.choices or ()))
            if not hint:
                raise
            raise argparse.ArgumentError(action, f"invalid choice: {value!r}: {hint}") from None

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> Any:
        """Return the options and the arguments that are left, as argparse does; a misspelt option ends the program."""
        if self.intermixed and not self._within:
            self._within = True
            try:
                given = points_joined(sys.argv[1:] if args is None else args)
                return super().parse_known_intermixed_args(given, namespace)
            finally:
                self._within = False
        found, left = super().parse_known_args(args, namespace)
        for option in (word.split("=")[0] for word in left if word.startswith("--")):
            if hint := did_you_mean(option, self._option_string_actions):
                self.error(f"unrecognized arguments: {option}: {hint}")
        return found, left


class VersionAction(argparse.Action):
    """Prints the version of the installed program, which is looked up only then, and ends it."""

    def __call__(self, parser: argparse.ArgumentParser, *_: Any) -> None:
        """Print the version and exit."""
        from importlib.metadata import version

        print(f"utak {version('utak')}")
        parser.exit()


def points_joined(arguments: Sequence[str]) -> list[str]:
    """Return arguments of a command line with each point that begins with a minus joined to the option before it.

    >>> points_joined(["a.yaml", "--start", "-1,2", "--scale", "2"])
    ['a.yaml', '--start=-1,2', '--scale', '2']
    """
    joined = list(arguments[:1])
    for before, argument in pairwise(arguments):
        if before.startswith("--") and "=" not in before and NEGATIVE_POINT.fullmatch(argument):
            joined[-1] += f"={argument}"
        else:
            joined.append(argument)
    return joined


def build_parser() -> argparse.ArgumentParser:
    """Return the parser of the whole command line."""
    top = HintingParser(
        prog="utak",
        description="Utak, a simulated robot that sees coarsely, believes with confidence and solves spatial tasks.",
        epilog=EXIT_CODES,
    )
    top.add_argument("--version", action=VersionAction, nargs=0, help="print the version and exit")
    parts = top.add_subparsers(title="commands", metavar="COMMAND", required=True, parser_class=HintingParser)
    for command in SUBCOMMANDS:
        part = parts.add_parser(
            command.name, help=command.summary, description=command.description, epilog=command.epilog
        )
        for argument in command.arguments:
            argument.declare(part)
        part.set_defaults(command=command)
        part.intermixed = True
    return top
