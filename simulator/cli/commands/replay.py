"""`utak replay`: show a recorded episode, as a page, as a moving picture or as text."""

import argparse
import sys
from pathlib import Path

from utak.simulator.cli.commands.given import given_certificate
from utak.simulator.explaining.missing_rules import rule_paths
from utak.simulator.replay.output import read_replayable, write_gif, write_page
from utak.simulator.replay.transcript import transcript
from utak.simulator.terminal import exits
from utak.simulator.terminal.outcome import UsageError


def execute(options: argparse.Namespace) -> int:
    """Read the episode and show it."""
    if options.html is None and (options.kb or options.certificate):
        raise UsageError("--kb and --certificate need --html: only pages give reasons")
    episode = read_replayable(options.episode)
    if options.html is not None:
        name = Path(options.episode).stem
        rules, certificate = rule_paths(options.kb), given_certificate(options)
        if lacking := write_page(options.html, episode, options.force, rules, name, certificate):
            print(f"utak: {lacking}; give rules with --kb FILE", file=sys.stderr)
    elif options.gif is not None:
        write_gif(options.gif, episode, options.force)
    else:
        for text in transcript(options.episode, episode):
            sys.stdout.write(text)
    return exits.SUCCESS
