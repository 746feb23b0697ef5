"""`utak schema`: print the JSON Schema of episodes and of what commands print under --json."""

import argparse
import json

from utak.simulator.episode.schema import EPISODE_LINES, document
from utak.simulator.terminal import exits


def execute(options: argparse.Namespace) -> int:
    """Print the schema, draft 2020-12."""
    names = EPISODE_LINES if options.name == "episode" else (options.name,)
    title = "a line of an episode of utak" if options.name == "episode" else f"utak: {options.name}"
    print(json.dumps(document(names, title), indent=2))
    return exits.SUCCESS
