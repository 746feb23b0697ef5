"""`utak replay`: show a recorded episode, as a page, as a moving picture or as text."""

import argparse
import sys
from pathlib import Path
from typing import Any

from utak.simulator.terminal import exits


def add(parts: Any) -> None:
    """Declare the subcommand."""
    part = parts.add_parser(
        "replay",
        help="show a recorded episode step by step",
        description="Show a recorded episode step by step: as text on the standard output, or in a file.",
    )
    part.add_argument("episode", metavar="EP.jsonl", help="an episode that `utak run --log` wrote")
    form = part.add_mutually_exclusive_group()
    form.add_argument("--html", metavar="FILE", help="write one page of HTML that plays it in any browser")
    form.add_argument("--gif", metavar="FILE", help="write a moving picture (needs pillow: pip install pillow)")
    form.add_argument("--text", action="store_true", help="print actions, reasons, tables and changed facts (default)")
    part.add_argument(
        "--kb", action="append", metavar="FILE", default=[], help="with --html: a file of rules of the run; repeatable"
    )
    part.add_argument("--force", action="store_true", help="overwrite a file that is no page or picture")
    part.set_defaults(execute=execute)


def execute(options: argparse.Namespace) -> int:
    """Read the episode and show it."""
    from utak.simulator.replay.output import read_replayable, write_gif, write_page

    if options.kb and options.html is None:
        print("utak replay: --kb needs --html: only pages give reasons", file=sys.stderr)
        return exits.USAGE
    episode = read_replayable(options.episode)
    if options.html is not None:
        from utak.simulator.explaining.questions import rule_paths

        name = Path(options.episode).stem
        if lacking := write_page(options.html, episode, options.force, rule_paths(options.kb), name):
            print(f"utak: {lacking}; give rules with --kb FILE", file=sys.stderr)
    elif options.gif is not None:
        write_gif(options.gif, episode, options.force)
    else:
        from utak.simulator.replay.transcript import transcript

        for text in transcript(options.episode, episode):
            sys.stdout.write(text)
    return exits.SUCCESS
