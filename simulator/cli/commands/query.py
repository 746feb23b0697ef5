"""`utak query`: ask what Utak believes at a step of a run or of an episode."""

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from utak.simulator.cli.commands.run import DUMP_HELP, add_settings, settings_of
from utak.simulator.scenario.untrusted import refuse_links
from utak.simulator.terminal import exits
from utak.simulator.terminal.numbers import parse_whole
from utak.simulator.terminal.printing import as_json

if TYPE_CHECKING:
    from utak.simulator.run.story import Story

MAX_LIMIT_ROWS = 1_000_000  # the greatest --limit, in rows; a convention


def add(parts: Any) -> None:
    """Declare the subcommand."""
    part = parts.add_parser("query", help="ask what Utak believes")
    part.add_argument("story", metavar="SCENARIO|EP.jsonl", help="a scenario folder, which is run, or an episode")
    part.add_argument("query", metavar="QUERY", help='such as "object(X), shape(X, square, C)"')
    part.add_argument(
        "--at", type=step_number, metavar="STEP", help="the step to ask at (default: the last; 0: on waking)"
    )
    part.add_argument("--json", action="store_true", help="print the answer as one JSON object")
    part.add_argument("--limit", type=_limit, metavar="N", help="print so many rows at most (default 10000)")
    part.add_argument("--dump-asp", metavar="DIR", help=f"{DUMP_HELP}: those of an episode up to the step")
    part.add_argument("--force", action="store_true", help="let --dump-asp fill a folder that is not empty")
    add_settings(part)
    part.set_defaults(execute=execute)


def execute(options: argparse.Namespace) -> int:
    """Go to the step, answer the query and print the answer."""
    from utak.kb.reasoning.query import MAX_ANSWER_ROWS, QueryEngine, QueryLimitError
    from utak.simulator.run.story import open_story

    if options.dump_asp is not None and Path(options.story).is_dir():
        print(
            "utak query: --dump-asp is for episodes here; utak run SCENARIO --dump-asp DIR is for runs", file=sys.stderr
        )
        return exits.USAGE
    refuse_links(options, options.story)
    story = open_story(options.story, settings_of(options))
    go_to(story, options.story, options.at)
    step = story.line["step"]
    if options.dump_asp is not None:
        from utak.simulator.episode.episode import read_episode
        from utak.simulator.episode.program_dump import dump_episode

        episode = read_episode(options.story)
        dump_episode(options.dump_asp, options.story, episode, step, options.kb, options.force)
    try:
        with QueryEngine(rules=options.kb) as engine:
            answer = engine.ask(story.facts, options.query, options.limit or MAX_ANSWER_ROWS)
    except QueryLimitError as limit:
        print(f"utak: {limit}", file=sys.stderr)
        return exits.LIMIT
    if options.json:
        entry = {"step": step, "answer": answer.kind, "variables": list(answer.variables)}
        print(as_json({**entry, "rows": [list(row) for row in answer.rows], "more": answer.more}))
    else:
        print(answer)
    return exits.SUCCESS


def _limit(text: str) -> int:
    """Return the number of rows for `--limit`."""
    return parse_whole(text, 1, MAX_LIMIT_ROWS)


def go_to(story: "Story", name: str, step: int | None) -> None:
    """Advance to a step, or to the end for None; raise BadInputError when there is no such step."""
    from utak.kb.language.diagnostics import BadInputError, Problem, SourceSpan

    while story.line["step"] != step and story.advance():
        pass
    if step is not None and story.line["step"] != step:
        what = f"there is no step {step}: the last is {story.line['step']}"
        raise BadInputError([Problem(name, SourceSpan(1, 1, 1), what)])


def step_number(text: str) -> int:
    """Return the step for `--at`."""
    return parse_whole(text, 0, 1_000_000)
