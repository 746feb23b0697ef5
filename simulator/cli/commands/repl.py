"""`utak repl`: go through a run or an episode step by step, and ask what Utak believes."""

import argparse

from utak.kb.reasoning.query import QueryEngine
from utak.simulator.cli.commands.given import given_certificate, given_story
from utak.simulator.repl.loop import converse
from utak.simulator.terminal import exits


def execute(options: argparse.Namespace) -> int:
    """Execute lines of the standard input until it ends or `quit`."""
    story, certificate = given_story(options), given_certificate(options)
    with QueryEngine(rules=options.kb) as engine:
        converse(story, engine, certificate)
    return exits.SUCCESS
