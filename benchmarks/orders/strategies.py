"""Strategies of clingo for the best answer, compared on decisions of the encoding `task`.

    python -m benchmarks.orders.strategies [--count 6] [--seed S] [--only NAME,...] [EPISODE.jsonl ...]

The decisions are the last ones of plans in the worlds of `benchmarks.orders.planning` (optimum, and rooms with one,
two, three and six goals), and all decisions `task` that the given episodes record. Each is grounded for each strategy
and solved by itself in a new solver. The table tells for each strategy the decisions whose optimum was proved within
MAX_SEARCH_CONFLICTS, how many of these answers were cheaper, dearer or another one of the same cost than that of the
first strategy, and the sums of conflicts and of processor seconds of solving. Grounding is the same for all, told once.
"""

import argparse
import json
import sys
import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import clingo
import numpy as np

from benchmarks.orders.planning import GOALS, THINGS, house, small_world
from benchmarks.worlds.drawn import drawn_problem, drawn_situation
from utak.geometry.manipulation.goals import End
from utak.kb.reasoning.encodings import encoding_text
from utak.kb.tracing.decisions import record_decisions
from utak.planner.oracles.carry import CarryOracle
from utak.planner.tasking.search import TASK_ENCODING, make_plan

MAX_SEARCH_CONFLICTS = 200_000  # of one search; ten times the limit of a plan, so that slow strategies are told apart
Facts = tuple[str, ...]
# By name: the options of clingo. The planner uses `usc,oll strat.`, and the first one where that does not end.
STRATEGIES: dict[str, tuple[str, ...]] = {
    "bb,lin": ("--opt-strategy=bb,lin",),
    "bb,hier": ("--opt-strategy=bb,hier",),
    "bb,inc": ("--opt-strategy=bb,inc",),
    "bb,dec": ("--opt-strategy=bb,dec",),
    "bb,lin sign": ("--opt-strategy=bb,lin", "--opt-heuristic=sign"),
    "bb,lin model": ("--opt-strategy=bb,lin", "--opt-heuristic=sign,model"),
    "bb,hier model": ("--opt-strategy=bb,hier", "--opt-heuristic=sign,model"),
    "usc,oll": ("--opt-strategy=usc,oll",),
    "usc,oll strat.": ("--opt-strategy=usc,oll,stratify",),
    "usc,one": ("--opt-strategy=usc,one",),
    "usc,k": ("--opt-strategy=usc,k",),
    "usc,pmres": ("--opt-strategy=usc,pmres",),
    "usc,oll shrink": ("--opt-strategy=usc,oll,stratify", "--opt-usc-shrink=lin"),
}


class Solved(NamedTuple):
    """The answer of a strategy to a decision.

    Attributes
    ----------
    cost : of the best answer that was found, by level; () for none.
    atoms : its shown atoms, sorted.
    proved : whether the search ended.
    conflicts : of the search.
    seconds : of the processor, for solving.
    grounding : of the processor, for grounding.
    """

    cost: tuple[int, ...]
    atoms: tuple[str, ...]
    proved: bool
    conflicts: int
    seconds: float
    grounding: float


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("episodes", nargs="*", type=Path, help="episodes whose decisions are solved, too")
    parser.add_argument("--count", type=int, default=6, help="worlds of each kind (%(default)s)")
    parser.add_argument("--seed", type=int, default=0, help="the first world's seed (%(default)s)")
    parser.add_argument("--only", default="", help="strategies, separated by semicolons (all)")
    given = parser.parse_args(arguments)
    decisions = list(dict.fromkeys([*planned(given.count, given.seed), *recorded(given.episodes)]))
    names = [name for name in STRATEGIES if not given.only or name in given.only.split(";")]
    first: list[Solved] = []
    for name in names:
        answers = [solved(facts, STRATEGIES[name]) for facts in decisions]
        if not first:
            first = answers
            print(heading(first))
        print(row(name, answers, first), flush=True)
    return 0


def planned(count: int, seed: int) -> Iterator[Facts]:
    """Yield the facts of the last decision of each plan in the worlds of benchmarks.orders.planning."""
    for number in range(seed, seed + count):
        yield from _decisions(*small_world(np.random.default_rng([number, 5])))
        for goals in (*GOALS, THINGS):
            yield from _decisions(*house(np.random.default_rng([number, goals, 6]), goals))


def _decisions(rows: list[str], ends: dict[str, End]) -> Iterator[Facts]:
    """Yield the facts of the last decision of the plan in one world."""
    situation = drawn_situation(rows)
    problem = drawn_problem(situation, ends)
    with record_decisions() as record:
        make_plan(problem, situation, CarryOracle(problem, situation, on_lattice=True))
    yield from (call.facts for call in record if call.encoding == TASK_ENCODING.stem)


def recorded(episodes: Sequence[Path]) -> Iterator[Facts]:
    """Yield the facts of all decisions `task` that some episodes record."""
    for path in episodes:
        for line in map(json.loads, path.read_text().splitlines()):
            for entry in line.get("belief", {}).get("solved", ()):
                if entry[0] == TASK_ENCODING.stem and len(entry) > 2:
                    yield tuple(entry[1])


def solved(facts: Facts, options: Sequence[str]) -> Solved:
    """Return the answer to a decision with some options of clingo."""
    control = clingo.Control([*options, "--stats=1", f"--solve-limit={MAX_SEARCH_CONFLICTS}"])
    control.add("base", [], encoding_text(TASK_ENCODING) + "".join(f"\n{fact}." for fact in facts))
    begin = time.process_time()
    control.ground([("base", [])])
    ground = time.process_time()
    best: list[tuple[tuple[int, ...], tuple[str, ...]]] = [((), ())]

    def keep(model: clingo.Model) -> None:
        """Keep a model as the best one so far."""
        best.append((tuple(model.cost), tuple(sorted(map(str, model.symbols(shown=True))))))

    result = control.solve(on_model=keep)
    took = time.process_time() - ground
    conflicts = int(control.statistics["solving"]["solvers"]["conflicts"])
    return Solved(*best[-1], bool(result.exhausted), conflicts, took, ground - begin)


def heading(first: list[Solved]) -> str:
    """Return the lines above the table, from the answers of the first strategy."""
    grounding = 1000 * sum(one.grounding for one in first) / max(1, len(first))
    columns = "proved  cheaper  dearer  other answer  conflicts  most conflicts  seconds  most seconds"
    return f"{len(first)} decisions; grounding takes {grounding:.0f} ms in the mean\nstrategy        {columns}"


def row(name: str, answers: list[Solved], first: list[Solved]) -> str:
    """Return the line of a strategy, from its answers and those of the first strategy."""
    pairs = list(zip(answers, first, strict=True))
    cheaper, dearer = sum(a.cost < b.cost for a, b in pairs), sum(a.cost > b.cost for a, b in pairs)
    other = sum(a.cost == b.cost and a.atoms != b.atoms for a, b in pairs)
    conflicts, seconds = [one.conflicts for one in answers], [one.seconds for one in answers]
    return (
        f"{name:<14}  {sum(one.proved for one in answers):>6}  {cheaper:>7}  {dearer:>6}  {other:>12}"
        f"  {sum(conflicts):>9}  {max(conflicts, default=0):>14}"
        f"  {sum(seconds):>7.2f}  {max(seconds, default=0.0):>12.2f}"
    )


if __name__ == "__main__":
    sys.exit(main())
