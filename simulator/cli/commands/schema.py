"""`utak schema`: print the JSON Schema of episodes and of what commands print under --json."""

import argparse
import json
from typing import Any

from utak.simulator.terminal import exits

SCHEMA_NAMES = (
    *("episode", "header", "step", "end"),
    *("run", "query", "plan", "routes", "test", "explain", "fix", "sweep", "sweep_row"),
)


def add(parts: Any) -> None:
    """Declare the subcommand."""
    part = parts.add_parser(
        "schema", help="print the JSON Schema of episodes, or of what a command prints under --json"
    )
    what = (
        "episode (a line of one; the default), header, step, end; the output of run, query, plan, routes, test, "
        "explain, fix (explain --fix), sweep; sweep_row (a line of a sweep's results)"
    )
    part.add_argument("name", nargs="?", choices=SCHEMA_NAMES, default="episode", metavar="NAME", help=what)
    part.set_defaults(execute=execute)


def execute(options: argparse.Namespace) -> int:
    """Print the schema, draft 2020-12."""
    from utak.simulator.episode.schema import EPISODE_LINES, document

    names = EPISODE_LINES if options.name == "episode" else (options.name,)
    title = "a line of an episode of utak" if options.name == "episode" else f"utak: {options.name}"
    print(json.dumps(document(names, title), indent=2))
    return exits.SUCCESS
