"""Whether confidences are probabilities: statements of belief, compared with the truth in random worlds of all kinds.

    python -m benchmarks.calibration --worlds 60 --seed 70000 [--noise 0,0.05] [--json] [--svg FILE] [--runs FILE]

At the first, a middle and the last step of each run every statement that the truth decides is compared with it. The
table goes to stdout, progress to stderr; docs/belief.md explains it. --runs keeps how each run ended and its
statements, a JSON line a world: worlds that it has already are not run again, so that a table can grow.
"""

import argparse
import json
import sys
from collections.abc import Sequence
from pathlib import Path

from benchmarks.calibration.dealt import dealt
from benchmarks.calibration.picture import picture
from benchmarks.calibration.runs import LookedAt, numbers, watched, world_name
from benchmarks.calibration.statements import HeldStatement, statements
from benchmarks.calibration.table import Held, as_json, read_runs, reliabilities, run_line, table
from utak.simulator.run.warming import warm_all

MOMENT_PARTS = 2  # of a run between the moments: first, middle, last
MomentStatements = tuple[int, tuple[HeldStatement, ...]]  # step, statements


def noted(look: LookedAt) -> MomentStatements:
    """Return the statements of a moment, with its step."""
    return look.step, tuple(statements(look.moment))


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the worlds and print the table; return 0 when nothing that is held with 100 percent is false, else 1."""
    given = _parser().parse_args(arguments)
    kept = read_runs(given.runs) if given.runs and given.runs.exists() else {}
    warm_all()
    held: list[Held] = []
    for number, (asked, noise) in enumerate(dealt(given.worlds, given.seed, given.noise), 1):
        name = world_name(asked, noise)
        if name not in kept:
            ended = watched(asked, noise, given.max_steps, given.seconds, noted, MOMENT_PARTS)
            kept[name] = [Held(name, step, one) for step, found in ended.looks for one in found]
            if given.runs:
                with given.runs.open("a") as file:
                    file.write(run_line(ended, kept[name]) + "\n")
            print(f"{number}/{given.worlds} {ended.line()}", file=sys.stderr, flush=True)
        held += kept[name]
    reliable = reliabilities(held)
    print(json.dumps(as_json(reliable)) if given.json else table(reliable), end="")
    if given.svg:
        given.svg.write_text(picture(reliable))
    return 1 if any(one.wrong for one in reliable) else 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.calibration", description="Compare belief with truth.")
    parser.add_argument("--worlds", type=int, default=60, help="how many (%(default)s)")
    parser.add_argument("--seed", type=int, default=70000, help="of the worlds (%(default)s)")
    parser.add_argument("--noise", type=numbers, default=[0.0, 0.05], help="with commas, in turn")
    parser.add_argument("--max-steps", type=int, default=80, help="most commands (%(default)s)")
    parser.add_argument("--seconds", type=int, default=600, help="most seconds a world, 0 for no limit (%(default)s)")
    parser.add_argument("--json", action="store_true", help="print one JSON value instead of the table")
    parser.add_argument("--svg", type=Path, help="a picture of the reliability")
    parser.add_argument("--runs", type=Path, help="how each run ended, with its statements; added to")
    return parser


if __name__ == "__main__":
    sys.exit(main())
