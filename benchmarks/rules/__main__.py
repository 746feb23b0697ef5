"""Rules as users of answer set programming try them, each in runs of several examples: bound, or refused with a reason.

    python -m benchmarks.rules [NAME ...] [--jobs J] [-o rows.jsonl]

Whether a rule was kept is told from the true tracks of the episode alone. A row is right when the rule was kept, and
the task was done or the verdict names the rule; a rule that is refused is right when the message says why. The table
goes to stdout, progress to stderr; the exit code is the number of rows that are not right, one at most.
"""

import argparse
import json
import sys
import tempfile
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from benchmarks.bounded import EXAMPLES_FOLDER
from benchmarks.rules.track import WALL_AT, TrueTrack
from benchmarks.rules.tried import TRIED_RULES, WALKS
from utak.kb.language.diagnostics import BadInputError
from utak.simulator.episode.episode import EpisodeLog
from utak.simulator.run.robots import make_robot
from utak.simulator.run.session import Session
from utak.simulator.scenario.scenario import read_scenario
from utak.simulator.scenario.settings import Settings

MAX_RULED_COMMANDS = 120  # of a run; each of the examples is done within half of it


@dataclass(frozen=True)
class RuleRow:
    """The result of one rule in one scenario.

    Attributes
    ----------
    rule, kind, example : which run it was.
    verdict : of the run, or `refused`.
    kept : whether the rule was kept by the true track, or the refusal says why.
    named : whether the verdict's reason names the rule.
    idle : whether the run's end says that the rule never applied.
    reason : of the verdict, or the message.
    """

    rule: str
    kind: str
    example: str
    verdict: str
    kept: bool
    named: bool
    idle: bool
    reason: str

    @property
    def right(self) -> bool:
        """Whether the rule was kept, and what it came to is said: none that leaves no plan is called idle."""
        return self.kept and (self.verdict in ("done", "refused") or (self.named and not self.idle))


def tried(name: str, example: str) -> RuleRow:
    """Return the row of a rule in a scenario."""
    rule = TRIED_RULES[name]
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"{name}.lp"
        path.write_text(f"{rule.text}\n", encoding="utf-8")
        lines: list[dict[str, Any]] = []
        scenario = read_scenario(EXAMPLES_FOLDER / example)
        settings = Settings(kb_files=(str(path),), max_steps=MAX_RULED_COMMANDS)
        try:
            session = Session(scenario, settings, make_robot, EpisodeLog(None, listeners=[lines.append]))
            result = session.run()
        except BadInputError as error:
            message = "; ".join(f"{one.what} {one.hint}" for one in error.problems)
            said = bool(rule.refused) and rule.refused in message
            return RuleRow(name, rule.kind, example, "refused", said, True, False, message)
        track = TrueTrack([line for line in lines if "step" in line], WALL_AT[example])
        unattained = rule.kind == "end states" and result.verdict != "done"  # a rule on an end that is not claimed
        kept = unattained or (rule.kept is not None and rule.kept(track))
        named = str(path) in result.reason or (bool(rule.said) and rule.said in result.reason)
        idle = any(str(path) in one for one in result.idle_rules)
        return RuleRow(name, rule.kind, example, result.verdict, kept, named, idle, result.reason)


def table(rows: Sequence[RuleRow]) -> str:
    """Return the rows as aligned text."""
    head = ["rule", "kind", "example", "verdict", "kept", "named", "idle", "right"]
    cells = [
        [r.rule, r.kind, r.example, r.verdict, *("yes" if one else "no" for one in (r.kept, r.named, r.idle, r.right))]
        for r in rows
    ]
    widths = [max(map(len, column)) for column in zip(head, *cells, strict=True)]
    return "".join(
        "  ".join(cell.ljust(w) for cell, w in zip(row, widths, strict=True)).rstrip() + "\n" for row in (head, *cells)
    )


def main(arguments: Sequence[str] | None = None) -> int:
    """Try the rules, print the table, and return 0 when all rows are right, else 1."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", choices=[*TRIED_RULES, []], metavar="NAME", help="rules; all without any")
    parser.add_argument("--jobs", type=int, default=1, help="processes at a time (default 1)")
    parser.add_argument("-o", dest="output", type=Path, help="write the rows as JSON lines to this file")
    options = parser.parse_args(arguments)
    names = options.names or list(TRIED_RULES)
    jobs = [(name, example) for name in names for example in TRIED_RULES[name].examples or WALKS]
    rows: list[RuleRow] = []
    with ProcessPoolExecutor(options.jobs) as pool:
        for row in pool.map(tried, *zip(*jobs, strict=True)):
            rows.append(row)
            print(f"{row.rule} {row.example}: {row.verdict}: {row.reason}", file=sys.stderr)
    if options.output is not None:
        options.output.write_text("".join(json.dumps(asdict(row)) + "\n" for row in rows), encoding="utf-8")
    print(table(rows), end="")
    return int(not all(row.right for row in rows))


if __name__ == "__main__":
    raise SystemExit(main())
