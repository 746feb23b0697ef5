"""Explanations of recorded episodes, confirmed node by node by checks that share no code with what makes them.

    python -m benchmarks.unchanged write FOLDER --count 100
    python -m benchmarks.episodes.explanations FOLDER [--stride N] [--jobs J]

Every command, every verdict, every N-th fact of every step (a different one in each step) and all 160 cells of every
impression are explained. Reported are how many trees and nodes were confirmed, what is wrong with the others, and how
long an explanation takes in an episode that is read already.
"""

import argparse
import multiprocessing
import os
import statistics
import sys
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from benchmarks.harness.reasons import complaints
from utak.simulator.episode.episode import read_episode
from utak.simulator.explaining.questions import Questions, questions_of_episode

CELLS = 160  # cells of an impression


@dataclass
class Findings:
    """The findings in one episode."""

    name: str
    steps: int = 0
    trees: int = 0
    nodes: int = 0
    cells: Counter[str] = field(default_factory=Counter)
    wrong: list[str] = field(default_factory=list)
    seconds: list[float] = field(default_factory=list)


def questions_asked(questions: Questions, lines: Sequence[dict[str, Any]], stride: int) -> Iterator[tuple[str, Any]]:
    """Yield each question in words, with a function that answers it."""
    for line in lines:
        step = line["step"]
        for fact in line["belief"]["facts"][step % stride :: stride]:
            yield f"step {step}: {fact}", lambda fact=fact, step=step: questions.why(fact, step)
        if step:
            yield f"step {step}: command", lambda step=step: questions.why_step(step)
    yield "verdict", lambda: questions.why("verdict(V)")


def confirmed(job: tuple[Path, int]) -> Findings:
    """Explain one episode and check every tree."""
    path, stride = job
    found = Findings(path.name)
    episode = read_episode(path)
    lines, questions = list(episode.steps), questions_of_episode(episode)
    found.steps = len(lines)
    for words, ask in questions_asked(questions, lines, stride):
        begun = time.perf_counter()
        try:
            reason = ask()
        except Exception as error:  # whatever it is, it is a finding
            found.wrong.append(f"{words}: {type(error).__name__}: {str(error)[:300]}")
            continue
        found.seconds.append(time.perf_counter() - begun)
        found.trees += 1
        found.nodes += sum(1 for _ in reason.walk())
        found.wrong += [f"{words}: {one}" for one in complaints(lines, reason.as_dict())]
    for line in lines:
        for cell in range(CELLS):
            reason = questions.why_cell(cell, line["step"])
            found.cells[reason.because.split(" ")[0].rstrip(":")] += 1
            found.wrong += [f"step {line['step']}: {one}" for one in complaints(lines, reason.as_dict())]
    return found


def main(arguments: Sequence[str] | None = None) -> int:
    """Execute the command line; return 1 when something is wrong."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.episodes.explanations", description=(__doc__ or "").split("\n")[0]
    )
    parser.add_argument("folder", type=Path, help="a folder of episodes")
    parser.add_argument("--stride", type=int, default=7, help="explain each N-th fact of a step (default %(default)s)")
    parser.add_argument("--jobs", type=int, default=2, help="processes (default %(default)s)")
    given = parser.parse_args(arguments)
    jobs = [(path, given.stride) for path in sorted(given.folder.glob("*.jsonl"))]
    os.environ["PYTHONSAFEPATH"] = "1"  # the pool's processes get this one's path, and no other folder on it
    results = []
    with multiprocessing.get_context("spawn").Pool(given.jobs) as pool:
        for found in pool.imap(confirmed, jobs):
            results.append(found)
            for one in found.wrong[:5]:
                print(f"{found.name}: {one}")
            print(f"{len(results)} of {len(jobs)}", file=sys.stderr)
    seconds = sorted(second for found in results for second in found.seconds)
    cells = sum((found.cells for found in results), Counter[str]())
    wrong = sum(len(found.wrong) for found in results)
    print(f"{len(results)} episodes, {sum(found.steps for found in results)} impressions")
    print(f"{sum(f.trees for f in results)} trees of {sum(f.nodes for f in results)} nodes, {wrong} complaints")
    print(f"cells: {dict(sorted(cells.items()))}, in all {sum(cells.values())}")
    if seconds:
        median, late = statistics.median(seconds), seconds[int(0.95 * len(seconds))]
        print(
            f"an explanation takes {median * 1e3:.1f} ms (median), {late * 1e3:.1f} ms (95 in 100), "
            f"{seconds[-1] * 1e3:.0f} ms (most)"
        )
    return 1 if wrong or not results else 0


if __name__ == "__main__":
    sys.exit(main())
