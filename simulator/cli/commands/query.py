"""`utak query`: ask what Utak believes at a step of a run or of an episode."""

import argparse
import sys
from pathlib import Path

from utak.kb.reasoning.query import MAX_ANSWER_ROWS, QueryEngine, QueryLimitError
from utak.simulator.cli.commands.given import given_story, go_to
from utak.simulator.episode.episode import read_episode
from utak.simulator.episode.program_dump import dump_episode
from utak.simulator.terminal import exits
from utak.simulator.terminal.outcome import UsageError
from utak.simulator.terminal.printing import as_json


def execute(options: argparse.Namespace) -> int:
    """Go to the step, answer the query and print the answer."""
    if options.dump_asp is not None and Path(options.story).is_dir():
        raise UsageError("--dump-asp is for episodes here; utak run SCENARIO --dump-asp DIR is for runs")
    story = given_story(options)
    go_to(story, options.story, options.at)
    step = story.line["step"]
    if options.dump_asp is not None:
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
