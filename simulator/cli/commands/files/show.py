"""`utak show`: print a scenario's world as a picture."""

import argparse
import sys
from pathlib import Path
from typing import Any

from simulator.scenario.untrusted import add_untrusted_option, refuse_links
from simulator.terminal import exits


def add(parts: Any) -> None:
    """Declare the subcommand."""
    part = parts.add_parser("show", help="print a scenario's world as a picture (the form of world.txt)")
    part.add_argument("scenario", metavar="SCENARIO", help="a scenario folder")
    add_untrusted_option(part)
    part.set_defaults(execute=execute)


def execute(options: argparse.Namespace) -> int:
    """Print the world; what a picture cannot show goes to the standard error."""
    from simulator.scenario.picture import draw
    from simulator.scenario.scenario import read_any_world

    refuse_links(options, options.scenario)
    world = read_any_world(Path(options.scenario))
    sys.stdout.write(draw(world))
    if world.heading:
        print(f"Utak faces {world.heading} degrees from the table's north", file=sys.stderr)
    return exits.SUCCESS
