"""Reliability: how often statements were true, by the confidence with which they were held."""

import json
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from benchmarks.calibration.runs import Ended
from benchmarks.calibration.statements import CERTAIN, HeldStatement

BINS = 10  # of 10 percent each; 100 percent is in the last one. A convention


MAX_LISTED = 20  # wrong statements of a predicate in the table


class Held(NamedTuple):
    """A statement, with the world and the step in which it was held."""

    world: str
    step: int
    statement: HeldStatement


class ReliabilityRow(NamedTuple):
    """The statements in one bin of confidence."""

    number: int
    confidence: float  # mean, 0 to 1
    true: float  # share, 0 to 1


class Reliability(NamedTuple):
    """The statements of one predicate."""

    predicate: str
    number: int
    error: float  # the expected calibration error, 0 to 1
    rows: Mapping[int, ReliabilityRow]  # by bin from 0
    wrong: tuple[Held, ...]  # held with 100 percent, and false
    sums: Mapping[int, int]  # of alternatives that exclude each other: their sum, percent -> how often


def reliabilities(held: Iterable[Held]) -> list[Reliability]:
    """Return the reliability of each predicate, by name."""
    by_predicate: dict[str, list[Held]] = defaultdict(list)
    for one in held:
        by_predicate[one.statement.predicate].append(one)
    return [_reliability(predicate, found) for predicate, found in sorted(by_predicate.items())]


def _reliability(predicate: str, held: Sequence[Held]) -> Reliability:
    bins: dict[int, list[HeldStatement]] = defaultdict(list)
    sums: dict[tuple[str, int, str], int] = defaultdict(int)
    for world, step, statement in held:
        bins[min(BINS - 1, statement.confidence * BINS // 100)].append(statement)
        if statement.alternatives:
            sums[world, step, statement.alternatives] += statement.confidence
    rows = {
        number: ReliabilityRow(
            len(there),
            sum(one.confidence for one in there) / 100 / len(there),
            sum(one.true for one in there) / len(there),
        )
        for number, there in sorted(bins.items())
    }
    error = sum(row.number * abs(row.confidence - row.true) for row in rows.values()) / len(held)
    wrong = tuple(one for one in held if one.statement.confidence == CERTAIN and one.statement.true < 1)
    count: dict[int, int] = defaultdict(int)
    for total in sums.values():
        count[total] += 1
    return Reliability(predicate, len(held), error, rows, wrong, dict(sorted(count.items())))


def table(found: Sequence[Reliability]) -> str:
    """Return the reliability of predicates as Markdown: a row a predicate, then what is wrong at 100 percent."""
    columns = ("predicate", "statements", "error", "held with percent: true in percent (statements)", "wrong at 100")
    lines = [f"| {' | '.join(columns)} | alternatives add up to |", "|---|---|---|---|---|---|"]
    for one in found:
        rows = ", ".join(
            f"{100 * row.confidence:.0f}: {100 * row.true:.0f} ({row.number})" for row in one.rows.values()
        )
        lines.append(
            f"| `{one.predicate}` | {one.number} | {one.error:.3f} | {rows} | {len(one.wrong)} | {_sums(one.sums)} |"
        )
    for one in found:
        for world, step, statement in one.wrong[:MAX_LISTED]:
            lines.append(f"wrong at 100: {statement.fact} in {world}, step {step}")
        if len(one.wrong) > MAX_LISTED:
            lines.append(f"wrong at 100: {len(one.wrong) - MAX_LISTED} more of {one.predicate}; --json lists all")
    return "\n".join(lines) + "\n"


def _sums(sums: Mapping[int, int]) -> str:
    """Return sums of alternatives in words: the least, the greatest, and how many are 100."""
    if not sums:
        return ""
    number = sum(sums.values())
    return f"{min(sums)} to {max(sums)}; 100 in {sums.get(CERTAIN, 0)} of {number}"


def as_json(found: Sequence[Reliability]) -> list[dict[str, Any]]:
    """Return the same as values for JSON."""
    return [
        {
            "predicate": one.predicate,
            "statements": one.number,
            "error": round(one.error, 4),
            "rows": {str(number): row._asdict() for number, row in one.rows.items()},
            "wrong": [[world, step, statement.fact] for world, step, statement in one.wrong],
            "sums": {str(total): number for total, number in one.sums.items()},
        }
        for one in found
    ]


def run_line(ended: Ended, held: Sequence[Held]) -> str:
    """Return a run as a line of JSON: its name, how it ended, and its statements."""
    told = json.loads(ended.line()) | {"name": ended.name}
    return json.dumps(told | {"statements": [[step, *statement] for _, step, statement in held]})


def read_runs(path: Path) -> dict[str, list[Held]]:
    """Return the statements of the runs in a file by the names of their worlds."""
    found = map(json.loads, path.read_text().splitlines())
    return {
        run["name"]: [Held(run["name"], step, HeldStatement(*statement)) for step, *statement in run["statements"]]
        for run in found
    }
