"""The table of a campaign about claims: one row for each kind, and one for all."""

from collections.abc import Sequence

from benchmarks.claims.row import ClaimRow, percentile

VERDICTS = ("done", "impossible", "possible_if", "limit")


def table(rows: Sequence[ClaimRow]) -> str:
    """Return the results of the worlds by kind, as aligned text; unusual verdicts have columns of their own."""
    others = sorted({row.verdict for row in rows} - set(VERDICTS) - {"error"})
    verdicts = [*VERDICTS, *others, "error"]
    kinds = sorted({row.kind for row in rows})
    groups = [*((kind, [row for row in rows if row.kind == kind]) for kind in kinds), ("all", list(rows))]
    lines = [_line(name, group, verdicts) for name, group in groups]
    cells = [list(lines[0]), *(list(line.values()) for line in lines)]
    widths = [max(len(cell) for cell in column) for column in zip(*cells, strict=True)]
    return "".join("  ".join(c.rjust(w) for c, w in zip(cell, widths, strict=True)) + "\n" for cell in cells)


def _line(name: str, rows: Sequence[ClaimRow], verdicts: Sequence[str]) -> dict[str, str]:
    cycles = [seconds for row in rows for seconds in row.cycles]
    judged = [row for row in rows if row.judged is not None]
    return {
        "kind": name,
        "worlds": str(len(rows)),
        **{verdict: str(sum(row.verdict == verdict for row in rows)) for verdict in verdicts},
        "false done": str(sum(row.false_done for row in rows)),
        "false impossible": str(sum(row.false_impossible for row in rows)),
        "judge": str(sum(bool(row.broken_laws) for row in judged)) if judged or not rows else "none!",
        "95th s": f"{percentile(cycles):.2f}",
        "worst s": f"{max(cycles, default=0.0):.2f}",
    }
