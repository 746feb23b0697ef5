"""Records of tried scenarios as text: lines, summaries and reports of failures."""

from collections import Counter
from collections.abc import Iterator, Sequence
from typing import Any

from utak.simulator.scenario.points import PointScore
from utak.simulator.terminal import exits
from utak.simulator.terminal.streams import escape_controls, one_line
from utak.simulator.testing.record import OUTCOMES, TrialRecord


def outcome_line(record: TrialRecord) -> str:
    """Return the line about one scenario: the outcome, the points where its author weighed them, and the reasons."""
    word, folder = OUTCOMES[record["exit_code"]][1], one_line(record["scenario"])
    points = f"{_points(record)}: " if record["weighed"] else ""
    if record["verdict"] is None:
        return f"{word} {folder}: {points}see above"
    end = f"{record['verdict']} in {record['steps']} steps: {record['reason']}"
    return f"{word} {folder}: {points}{one_line('; '.join([*record['faults'], end]))}"


def _points(record: TrialRecord) -> PointScore:
    return PointScore(**record["points"])


def summary_line(records: Sequence[TrialRecord]) -> str:
    """Return how many scenarios passed, what became of the others, and the points where authors weighed them."""
    counts = Counter(record["exit_code"] for record in records)
    others = "".join(
        f", {counts[code]} {word}" for code, (_, _, word) in OUTCOMES.items() if code != exits.SUCCESS and counts[code]
    )
    total = total_score(records)
    points = f"; {total}" if any(record["weighed"] for record in records) else ""
    return f"{counts[exits.SUCCESS]} of {counts.total()} passed{others}{points}"


def total_score(records: Sequence[TrialRecord]) -> PointScore:
    """Return the points of all scenarios together. One whose expect.lp cannot be read has none that are known."""
    scores = [_points(record) for record in records if record["points"] is not None]
    return PointScore(sum(one.earned for one in scores), sum(one.possible for one in scores))


def as_object(records: Sequence[TrialRecord]) -> dict[str, Any]:
    """Return the one object of `utak test --json`: all records, counts of outcomes, all points, exit code."""
    counts = Counter(record["outcome"] for record in records)
    return {
        "scenarios": list(records),
        "counts": {name: counts[name] for name, _, _ in OUTCOMES.values()},
        "points": total_score(records)._asdict(),
        "exit_code": exits.worst(record["exit_code"] for record in records),
    }


def failure_report(record: TrialRecord) -> str:
    """Return why a scenario failed: what was expected, what came, the last steps and the command that repeats it."""
    return escape_controls("\n".join(_report_lines(record)))


def _report_lines(record: TrialRecord) -> Iterator[str]:
    if record["error"]:
        yield record["error"]
    if record["verdict"] is not None:
        points = f", {_points(record)}" if record["weighed"] else ""
        yield f"the scenario did not end as expected{points}"
        for one in record["expectations"]:
            worth = f"  ({one['points']} point{'s' * (one['points'] != 1)})" if record["weighed"] else ""
            yield f"  {'met' if one['met'] else 'NOT MET'}: {one['expected']}{worth}"
            if not one["met"]:
                yield f"    what came: {one['came']}"
        for fault in record["faults"]:
            if not fault.startswith("not met: "):
                yield f"  {fault}"
        yield f"the robot's verdict: {record['verdict']} after {record['steps']} steps: {one_line(record['reason'])}"
        if record["last_steps"]:
            yield "its last steps:"
        for step in record["last_steps"]:
            yield f"  step {step['step']}: {step['action']}: {one_line(step['why'])}"
    yield f"repeat it: {record['command']}"
