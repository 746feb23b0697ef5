"""`utak repl`: go through a run or an episode step by step, and ask what Utak believes."""

import argparse
from typing import Any

from utak.simulator.cli.commands.run import add_settings, settings_of
from utak.simulator.scenario.untrusted import refuse_links
from utak.simulator.terminal import exits


def add(parts: Any) -> None:
    """Declare the subcommand."""
    part = parts.add_parser("repl", help="step through a run and ask what Utak believes")
    part.add_argument("story", metavar="SCENARIO|EP.jsonl", help="a scenario folder, which is run, or an episode")
    add_settings(part)
    part.set_defaults(execute=execute)


def execute(options: argparse.Namespace) -> int:
    """Execute lines of the standard input until it ends or `quit`."""
    from utak.kb.reasoning.query import QueryEngine
    from utak.simulator.repl.loop import converse
    from utak.simulator.run.story import open_story

    refuse_links(options, options.story)
    story = open_story(options.story, settings_of(options))
    with QueryEngine(rules=options.kb) as engine:
        converse(story, engine)
    return exits.SUCCESS
