"""A page about the worlds that went wrong: false claims with what refutes them, errors, and undecided worlds."""

from collections.abc import Iterator, Sequence

from benchmarks.claims.row import ClaimRow
from benchmarks.claims.table import table


def report(rows: Sequence[ClaimRow]) -> str:
    """Return the page as Markdown, worlds sorted by kind and seed."""
    ordered = sorted(rows, key=lambda row: row.asked)
    return "\n".join(_lines(ordered)) + "\n"


def _lines(rows: Sequence[ClaimRow]) -> Iterator[str]:
    yield from ("# What came of the worlds", "", "```text", table(rows).rstrip(), "```")
    yield from ("", "## False claims", "")
    for row in rows:
        if row.false_claim:
            yield f"- {_head(row)}\n  - reason: {row.reason}\n  - {'; '.join(row.refutation.splitlines())}"
    yield from ("", "## Errors, and runs out of time", "")
    for row in rows:
        if row.error or row.verdict in ("time", "error"):
            yield f"- {_head(row)}: {row.error} (commands {row.commands}, longest {max(row.cycles, default=0.0):.1f} s)"
    yield from ("", "## What the judge found", "")
    for row in rows:
        if row.broken_laws:
            yield f"- {_head(row)}: {'; '.join(row.broken_laws[:3])}"
    yield from ("", "## Undecided where the truth is known", "")
    for row in rows:
        if row.verdict not in ("done", "impossible", "error", "time") and row.possible in ("yes", "no"):
            yield f"- {_head(row)} ({row.commands} commands): {row.reason}"


def _head(row: ClaimRow) -> str:
    what = f"{row.goal}, {row.variant}" if row.variant and row.variant != row.goal else row.goal
    return f"`{row.asked.name}` ({what}; can be done: {row.possible}) **{row.verdict}**"
