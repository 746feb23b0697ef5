"""`utak explain`: why a fact is believed, why a command was given, what a cell is laid to."""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from simulator.terminal import exits
from simulator.terminal.numbers import parse_whole
from simulator.terminal.printing import as_json
from simulator.terminal.streams import escape_controls

if TYPE_CHECKING:
    from kb.evidence.reason import Reason
    from simulator.explaining.questions import Questions


def add(parts: Any) -> None:
    """Declare the subcommand."""
    part = parts.add_parser("explain", help="tell why: a fact, a command, a verdict, a cell of an impression")
    part.add_argument("episode", metavar="EP.jsonl", help="an episode")
    part.add_argument(
        "fact", metavar="FACT", nargs="?", help="a fact, a goal or verdict(V); without it the command of the step"
    )
    part.add_argument(
        "--whynot", metavar="FACT", help="tell why a fact is not believed, and what is missing or in the way"
    )
    part.add_argument("--cell", type=_cell, metavar="N", help="a cell of the impression of the step, 0 to 159")
    part.add_argument("--at", type=_step, metavar="STEP", help="the step (default: the last)")
    part.add_argument(
        "--depth", choices=("short", "mid", "long"), default="mid", help="how much of the tree is printed (default mid)"
    )
    part.add_argument("--json", action="store_true", help="print the whole tree as one JSON object")
    part.add_argument(
        "--kb", action="append", metavar="FILE", default=[], help="a file of rules of the run; repeatable"
    )
    part.set_defaults(execute=execute)


def execute(options: argparse.Namespace) -> int:
    """Answer the question and print the tree of reasons."""
    from simulator.episode.episode import read_episode
    from simulator.explaining.questions import questions_of_episode

    questions = questions_of_episode(read_episode(options.episode), [str(Path(path).absolute()) for path in options.kb])
    reason = _answer(questions, options)
    if options.json:
        print(as_json(reason.as_dict()))
    else:
        print(escape_controls(_text(reason, options.depth)))
    return exits.SUCCESS


def _answer(questions: "Questions", options: argparse.Namespace) -> "Reason":
    """Return the answer to the question of the command line."""
    if options.cell is not None:
        return questions.why_cell(options.cell, options.at)
    if options.whynot is not None:
        return questions.why_not(options.whynot, options.at)
    if options.fact is not None:
        return questions.why(options.fact, options.at)
    return questions.why_step(options.at)


def _text(reason: "Reason", depth: str) -> str:
    """Return a tree of reasons as text."""
    from kb.evidence.reason import Depth

    return reason.text(Depth(depth))


def _cell(text: str) -> int:
    """Return the number for `--cell`."""
    return parse_whole(text, 0, 159)


def _step(text: str) -> int:
    """Return the step for `--at`."""
    return parse_whole(text, 0, 1_000_000)
