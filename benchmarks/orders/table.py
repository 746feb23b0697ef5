"""The table of results, one row for each kind and one for all, and the reasons why runs failed."""

import re
from collections import Counter
from collections.abc import Iterator, Sequence
from statistics import median

from benchmarks.orders.asked import AT_WALL_VARIANT
from benchmarks.orders.row import CAN_BE_DONE, RUN_BROKE, RUN_OUT_OF_TIME, OrderRow

PUSH_ONLY_MARK = " --no-pull"  # after the kind of runs in which the robot might not pull
MAX_REASON_CHARACTERS = 110  # of a reason that is counted
MAX_REASONS_SHOWN = 6  # of a kind
NO_RUNS = "-"


def table(rows: Sequence[OrderRow]) -> str:
    """Return the results by kind as aligned text."""
    groups = [*grouped(rows), ("all", list(rows))]
    lines = [_line(name, group) for name, group in groups]
    cells = [list(lines[0]), *(list(line.values()) for line in lines)]
    widths = [max(len(cell) for cell in column) for column in zip(*cells, strict=True)]
    return "".join("  ".join(c.rjust(w) for c, w in zip(cell, widths, strict=True)) + "\n" for cell in cells)


def failures(rows: Sequence[OrderRow]) -> str:
    """Return why runs of tasks that can be done, or may be, did not do them: by kind, how often, verdict and reason."""
    return "".join(line + "\n" for name, group in grouped(rows) for line in _failures(name, group))


def grouped(rows: Sequence[OrderRow]) -> list[tuple[str, list[OrderRow]]]:
    """Return (name, rows) of each kind, in the order in which they first occur.

    Puzzles with things at walls are apart, and runs without pulling.
    """
    groups: dict[str, list[OrderRow]] = {}
    for row in rows:
        name = row.kind + f" {row.variant}" * (row.variant == AT_WALL_VARIANT)
        groups.setdefault(name + PUSH_ONLY_MARK * (not row.pull), []).append(row)
    return list(groups.items())


def _line(name: str, rows: Sequence[OrderRow]) -> dict[str, str]:
    possible = [row for row in rows if row.possible == CAN_BE_DONE]
    judged = [row for row in rows if row.judged is not None]
    return {
        "kind": name,
        "tasks": str(len(rows)),
        "possible": str(len(possible)),
        "achieved": str(sum(row.achieved for row in rows)),
        "false done": str(sum(row.false_done for row in rows)),
        "false impossible": str(sum(row.false_impossible for row in rows)),
        "impossible": str(sum(row.verdict == "impossible" for row in rows)),
        "limit": str(sum(row.verdict in ("limit", "possible_if") for row in rows)),
        "time": str(sum(row.verdict == RUN_OUT_OF_TIME for row in rows)),
        "error": str(sum(row.verdict == RUN_BROKE for row in rows)),
        "judge": f"{sum(bool(row.broken_laws) for row in judged)}/{len(judged)}",
        "commands": _middle([row.commands for row in rows if row.achieved]),
        "carries": _carries(rows),
        "seconds": _middle([row.took for row in rows if row.verdict != RUN_BROKE]),
    }


def _carries(rows: Sequence[OrderRow]) -> str:
    """Return how many carries the robot made where it achieved the task, and how many the search that knows all."""
    known = [row for row in rows if row.achieved and row.carries]
    return f"{sum(row.carried for row in known)}/{sum(row.carries for row in known)}" if known else NO_RUNS


def _middle(values: Sequence[float]) -> str:
    return f"{median(values):g}" if values else NO_RUNS


def _failures(name: str, rows: Sequence[OrderRow]) -> Iterator[str]:
    failed = [row for row in rows if not row.achieved]
    counted = Counter(f"{row.verdict}: {_without_numbers(row.reason)}" for row in failed)
    if failed:
        wanted, met = sum(row.wanted for row in failed), sum(row.met for row in failed)
        part = f"; {met} of the {wanted} things that they want are so" if wanted else ""
        yield f"{name}: {len(failed)} of {len(rows)} failed{part}"
    for reason, count in counted.most_common(MAX_REASONS_SHOWN):
        yield f"  {count} x {reason}"
    for row in failed:
        if row.false_done or row.false_impossible:
            yield f"  FALSE {row.verdict}, {row.name}: {row.refutation.splitlines()[0] if row.refutation else ''}"


def _without_numbers(reason: str) -> str:
    """Return a reason on one line without its numbers, so that like reasons are counted together."""
    words = " ".join(re.sub(r"-?\d+(\.\d+)?", "#", reason).split())
    return words if len(words) <= MAX_REASON_CHARACTERS else words[:MAX_REASON_CHARACTERS] + " ..."
