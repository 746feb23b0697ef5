"""Runs that others disturb: random worlds, run once as they are, and again with a random disturbance at a random step.

    python -m benchmarks.disturbed [--act move,lift,appear,vanish] [--count N] [--seed S] [--snug] [-o rows.jsonl]
    python -m benchmarks.disturbed --only move:6:17 --keep FOLDER       (one world; its files and episodes stay)

A row says whether the first look that contradicts what was seen before was noticed, whether the thing is believed
where it is at the end, whether a lifted robot knew within three looks where it is, and how the run ended. A thing is
put elsewhere in its room, where there is room about it. A world whose undisturbed run is not achieved is left out.
"""

import argparse
import json
import sys
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path

from benchmarks.disturbed.run import TASKS, DisturbedRow, run, summary
from benchmarks.worlds.makers import add_kinds


def main(arguments: Sequence[str] | None = None) -> int:
    """Print rows and a summary; return 1 when anything was claimed falsely."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--act", default="move,lift", help="kinds of disturbances (%(default)s)")
    parser.add_argument("--count", type=int, default=20, help="worlds of each (%(default)s)")
    parser.add_argument("--seed", type=int, default=0, help="the first seed (%(default)s)")
    parser.add_argument("--only", metavar="ACT:TASK:SEED", help="one world")
    parser.add_argument("--keep", type=Path, help="folder in which scenarios and episodes stay")
    parser.add_argument("-o", "--output", type=Path, help="a JSON line for each row")
    add_kinds(parser)
    given = parser.parse_args(arguments)
    rows: list[DisturbedRow] = []
    with tempfile.TemporaryDirectory() as made:
        folder = given.keep or Path(made)
        for row in _rows(given, folder):
            rows.append(row)
            print(json.dumps(vars(row)), file=sys.stderr, flush=True)
    if given.output is not None:
        given.output.write_text("".join(f"{json.dumps(vars(row))}\n" for row in rows))
    print(*summary(rows), sep="\n")
    return int(any(row.believed and not row.achieved for row in rows))


def _rows(given: argparse.Namespace, folder: Path) -> Iterator[DisturbedRow]:
    """Yield the rows that are asked for; worlds in which there is nothing to disturb are passed over."""
    if given.only:
        act, task, seed = given.only.split(":")
        yield from filter(None, [run(act, int(task), int(seed), given.kind, folder)])
        return
    for act in given.act.split(","):
        found, number = 0, 0
        while found < given.count:
            tasks = TASKS[act]
            row = run(act, tasks[number % len(tasks)], given.seed + number // len(tasks), given.kind, folder)
            number += 1
            if row is not None:
                found += 1
                yield row


if __name__ == "__main__":
    sys.exit(main())
