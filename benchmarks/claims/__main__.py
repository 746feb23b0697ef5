"""The campaign that refutes claims.

    python -m benchmarks.claims --count 6 --seed 0 [--kind plugged,round] [--noise S] [--jobs J] [-o results.jsonl]
    python -m benchmarks.claims --own 3 -o results.jsonl          (also plain and wide worlds of
    benchmarks.worlds.makers)
    python -m benchmarks.claims --only plugged:3 --keep FOLDER    (one world)

With -o worlds that the file already has are not run again. The table goes to stdout, progress to stderr; the exit code
is 0 when no claim was false, nothing broke and the judge found nothing. docs/results/worlds.md explains the columns.
"""

import argparse
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from pathlib import Path

from benchmarks.claims.asked import OWN_ASKED, OWN_PREFIX, Asked, all_kinds, named, worlds_of
from benchmarks.claims.report import report
from benchmarks.claims.row import ClaimRow, read_rows
from benchmarks.claims.run import Limits, run_world, warm_up
from benchmarks.claims.table import table
from benchmarks.harness.judging import judge_path
from benchmarks.worlds.odd.kinds import ODD_KINDS


def run_all(asked: list[Asked], limits: Limits, folder: Path, keep: Path | None, jobs: int) -> Iterator[ClaimRow]:
    """Yield the rows of worlds, which are run in `jobs` child processes at a time. keep : see `run_world`."""
    if not asked:
        return
    warm_up(folder)
    with ThreadPoolExecutor(jobs) as pool:
        yield from pool.map(lambda world: run_world(world, limits, folder, keep), asked)


WorldsRunner = Callable[[list[Asked], Limits, Path, Path | None, int], Iterator[ClaimRow]]


def main(arguments: Sequence[str] | None = None, run_worlds: WorldsRunner = run_all) -> int:
    """Run a campaign; 0 when nothing was wrong, 1 otherwise.

    run_worlds : runs the worlds that the results do not have yet, as `run_all` does.
    """
    given = _parser().parse_args(arguments)
    if judge_path() is None:
        print("claims: no judge: set UTAK_JUDGE; neither judged nor searched for ways", file=sys.stderr)
    limits = Limits(given.noise, given.noise_seed, given.max_steps, given.seconds, given.megabytes, given.search)
    known = read_rows(given.output) if given.output and given.output.exists() else []
    rows = {(row.asked, row.noise): row for row in known}
    asked = [world for world in _asked(given) if (world, limits.noise) not in rows]
    with ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="utak-claims-")))
        output = stack.enter_context(given.output.open("a")) if given.output else None
        for number, row in enumerate(run_worlds(asked, limits, folder, given.keep, given.jobs), 1):
            rows[row.asked, row.noise] = row
            if output is not None:
                output.write(row.line() + "\n")
                output.flush()
            if given.report:
                given.report.write_text(report(list(rows.values())))
            print(f"{number}/{len(asked)} {_told(row)}", file=sys.stderr, flush=True)
    print(table(list(rows.values())), end="")
    return 1 if any(row.faulty for row in rows.values()) else 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.claims", description="Refute what the robot claims.")
    parser.add_argument("--count", type=int, default=0, help="worlds of each odd kind (%(default)s)")
    parser.add_argument(
        "--own", type=int, default=0, help="worlds of each task of benchmarks.worlds.makers (%(default)s)"
    )
    parser.add_argument("--seed", type=int, default=0, help="the first world's seed (%(default)s)")
    parser.add_argument("--kind", type=_kinds, default=list(ODD_KINDS), help=f"of {', '.join(all_kinds())} (odd ones)")
    parser.add_argument("--only", type=named, metavar="WORLD", help="one world: KIND:SEED or own_KIND:TASK:SEED")
    parser.add_argument("--noise", type=float, default=0.0, help="noise of motions and grasps (%(default)s)")
    parser.add_argument("--noise-seed", type=int, default=0, help="seed of the noise (%(default)s)")
    parser.add_argument("--jobs", type=int, default=1, help="worlds at a time (%(default)s)")
    parser.add_argument("--max-steps", type=int, default=Limits.max_steps, help="most commands (%(default)s)")
    parser.add_argument("--seconds", type=int, default=Limits.seconds, help="processor seconds a run (%(default)s)")
    parser.add_argument("--megabytes", type=int, default=Limits.megabytes, help="address space a run (%(default)s)")
    parser.add_argument("--search", type=int, default=Limits.search, help="seconds to look for a way (%(default)s)")
    parser.add_argument("-o", "--output", type=Path, help="a JSON line for each world; gone on with when it is there")
    parser.add_argument("--keep", type=Path, help="folder in which scenarios and episodes that went wrong stay")
    parser.add_argument("--report", type=Path, help="a page in Markdown about what went wrong, written as runs end")
    return parser


def _kinds(text: str) -> list[str]:
    kinds = text.split(",")
    unknown = sorted(set(kinds) - set(all_kinds()))
    if unknown:
        raise argparse.ArgumentTypeError(f"no kind {', '.join(unknown)}: kinds are {', '.join(all_kinds())}")
    return kinds


def _asked(given: argparse.Namespace) -> list[Asked]:
    if given.only:
        return [given.only]
    own = worlds_of([OWN_PREFIX + kind for kind in OWN_ASKED], given.seed, given.own)
    return worlds_of(given.kind, given.seed, given.count) + own


def _told(row: ClaimRow) -> str:
    marks = [
        "FALSE DONE" * row.false_done,
        "FALSE IMPOSSIBLE" * row.false_impossible,
        row.error,
        "judge" * bool(row.broken_laws),
    ]
    mark = ", ".join(mark for mark in marks if mark)
    said = f"{row.asked.name} {row.verdict} in {row.commands} commands, longest {max(row.cycles, default=0.0):.1f} s"
    return said + (f"  <-- {mark}" if mark else "")


if __name__ == "__main__":
    sys.exit(main())
