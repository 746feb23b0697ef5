"""Doorways that movable things fill: how many of the possible worlds are achieved, and which claims are false.

    python -m benchmarks.plugs --count 10 [--kind flush,two] [--task next] [--jobs J] [-o results.jsonl] [--keep FOLDER]

Worlds of benchmarks.worlds.filled.doorplugs are run with and without pulling. A world counts as possible when it was
achieved, or when a search that knows the true world finds a plan (benchmarks.claims.refute). The table goes to stdout,
progress to stderr; the exit code is 0 when no claim was false and the judge found nothing.
"""

import argparse
import json
import shutil
import statistics
import sys
import tempfile
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass, replace
from itertools import product
from pathlib import Path

from benchmarks.claims import child
from benchmarks.claims.refute import searched
from benchmarks.claims.run import Limits, judged, run_child, warm_up
from benchmarks.worlds.filled.doorplugs import PLUG_KINDS, PLUG_TASKS, PULL_KINDS, plugged_world
from benchmarks.worlds.odd.tasks import NO
from benchmarks.worlds.scenes import write


@dataclass(frozen=True)
class PlugRow:
    """The result of one world.

    Attributes
    ----------
    kind, task, seed, pull : which world it was, and whether pulling was allowed.
    possible : whether the task can be done: True, False, or None when no search found a way.
    verdict, reason, achieved, commands : of the run.
    seconds : of the processor, all commands together.
    false_claim : whether a done was not so, or an impossible was possible.
    broken_laws : what the judge found.
    """

    kind: str
    task: str
    seed: int
    pull: bool
    possible: bool | None
    verdict: str
    reason: str
    achieved: bool
    commands: int
    seconds: float
    false_claim: bool
    broken_laws: tuple[str, ...]

    @property
    def name(self) -> str:
        """The world's name, as a folder."""
        return f"{self.kind}-{self.task}-{self.seed:04d}" + ("" if self.pull else "-no-pull")


def run_one(kind: str, task: str, seed: int, limits: Limits, folder: Path, keep: Path | None = None) -> PlugRow:
    """Run one world in a process of its own and return its row; a copy of its folder stays in `keep`."""
    world = plugged_world(kind, task, seed)
    place = write(world, folder / f"{kind}-{task}-{seed}-{limits.pull}")
    ended = run_child(place, limits)
    path, cycles = place / child.RESULT_FILE, place / child.CYCLES_FILE
    told = json.loads(path.read_text()) if path.exists() else {}
    achieved, verdict = bool(told.get("achieved")), str(told.get("verdict", ended))
    cannot = world.possible == NO or (not limits.pull and kind in PULL_KINDS)
    possible: bool | None = False if cannot else True if achieved else None
    if possible is None and limits.search and searched(place, limits.search, limits.pull).answer == "solvable":
        possible = True
    false_done = verdict == "done" and (not achieved or cannot)
    laws = [] if not told else [found for found in judged(place) or [] if "expected" not in found]
    row = PlugRow(
        kind=kind,
        task=task,
        seed=seed,
        pull=limits.pull,
        possible=possible,
        verdict=verdict,
        reason=str(told.get("reason", "")),
        achieved=achieved,
        commands=int(told.get("steps", 0)),
        seconds=sum(map(float, cycles.read_text().split())) if cycles.exists() else 0.0,
        false_claim=false_done or (verdict == "impossible" and bool(possible)),
        broken_laws=tuple(law for law in laws if "should have failed" not in law),
    )
    if keep is not None:
        shutil.copytree(place, keep / row.name, dirs_exist_ok=True)
    shutil.rmtree(place)
    return row


def plug_table(rows: Sequence[PlugRow]) -> str:
    """Return the results by kind, task and pulling, and of all, as aligned text."""
    groups = sorted({(row.kind, row.task, row.pull) for row in rows}, key=lambda g: (PLUG_KINDS.index(g[0]), *g[1:]))
    lines = [
        _line(k, t, "yes" if p else "no", [r for r in rows if (r.kind, r.task, r.pull) == (k, t, p)])
        for k, t, p in groups
    ]
    lines.append(_line("all", "", "", rows))
    cells = [list(lines[0]), *(list(line.values()) for line in lines)]
    widths = [max(len(cell) for cell in column) for column in zip(*cells, strict=True)]
    return "".join("  ".join(c.rjust(w) for c, w in zip(cell, widths, strict=True)) + "\n" for cell in cells)


def _line(kind: str, task: str, pull: str, rows: Sequence[PlugRow]) -> dict[str, str]:
    able = [row for row in rows if row.possible]
    commands = [row.commands for row in rows] or [0]
    counts = {v: str(sum(row.verdict == v for row in rows)) for v in ("done", "impossible", "possible_if", "limit")}
    return {
        "kind": kind,
        "task": task,
        "pull": pull,
        "worlds": str(len(rows)),
        "possible": str(len(able)),
        "achieved": str(sum(row.achieved for row in able)),
        **counts,
        "other": str(len(rows) - sum(map(int, counts.values()))),
        "false": str(sum(row.false_claim for row in rows)),
        "judge": str(sum(bool(row.broken_laws) for row in rows)),
        "commands": f"{statistics.median(commands):.0f}",
        "most": str(max(commands)),
        "s": f"{statistics.median([row.seconds for row in rows] or [0.0]):.1f}",
        "most s": f"{max([row.seconds for row in rows] or [0.0]):.1f}",
    }


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the worlds and print the table; return 0 when no claim was false and the judge found nothing, else 1."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.plugs", description="Run worlds whose doorways movable things fill."
    )
    parser.add_argument("--kind", default=",".join(PLUG_KINDS), help="kinds with commas between (all)")
    parser.add_argument("--task", default=",".join(PLUG_TASKS), help="tasks with commas between (all)")
    parser.add_argument("--pull", default="yes,no", help="with pulling, without, or both (%(default)s)")
    parser.add_argument("--seed", type=int, default=0, help="the first seed (%(default)s)")
    parser.add_argument("--count", type=int, default=10, help="worlds of each kind and task (%(default)s)")
    parser.add_argument("--jobs", type=int, default=1, help="processes at a time (%(default)s)")
    parser.add_argument("--max-steps", type=int, default=200, help="commands (%(default)s)")
    parser.add_argument("--search", type=int, default=30, help="seconds of the search for a plan (%(default)s)")
    parser.add_argument("--keep", type=Path, help="folder in which scenarios and episodes stay")
    parser.add_argument("-o", "--output", type=Path, help="file of results, a line of JSON each")
    given = parser.parse_args(arguments)
    seeds = range(given.seed, given.seed + given.count)
    asked = list(product(given.kind.split(","), given.task.split(","), seeds, given.pull.split(",")))
    limits, rows = Limits(max_steps=given.max_steps, search=given.search), []
    with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor(given.jobs) as pool:
        warm_up(Path(folder))
        waiting = [
            pool.submit(run_one, kind, task, seed, replace(limits, pull=pull == "yes"), Path(folder), given.keep)
            for kind, task, seed, pull in asked
        ]
        for future in waiting:
            row = future.result()
            rows.append(row)
            mark = "  <-- FALSE" * row.false_claim + "  <-- judge" * bool(row.broken_laws)
            mark += "  <-- not achieved" * bool(row.possible and not row.achieved)
            print(f"{row.name} {row.verdict} in {row.commands} commands, {row.seconds:.1f} s{mark}", file=sys.stderr)
            if given.output is not None:
                with given.output.open("a") as file:
                    file.write(json.dumps(asdict(row)) + "\n")
    print(plug_table(rows), end="")
    return int(any(row.false_claim or row.broken_laws for row in rows))


if __name__ == "__main__":
    sys.exit(main())
