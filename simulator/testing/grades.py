"""Records of tried scenarios as a table of grades, comma-separated values as spreadsheets read them (RFC 4180)."""

import csv
import io
from collections.abc import Sequence

from utak.simulator.terminal.streams import one_line
from utak.simulator.testing.record import TrialRecord

COLUMNS = ("scenario", "outcome", "earned", "possible", "verdict", "steps", "why")
FORMULA_MARKS = ("=", "+", "-", "@")  # a spreadsheet takes a text that begins so for a formula


def as_csv(records: Sequence[TrialRecord]) -> str:
    """Return a line for each record, below a line with the names of the columns; points that nobody knows are empty."""
    text = io.StringIO()
    rows = csv.writer(text)
    rows.writerow(COLUMNS)
    for record in records:
        points = record["points"] or {"earned": "", "possible": ""}
        why = "; ".join(record["faults"] or record["error"].splitlines())
        cells = {**record, **points, "why": why}
        rows.writerow([_cell(cells[name]) for name in COLUMNS])
    return text.getvalue()


def is_csv(head: bytes) -> bool:
    """Return whether a file with these first bytes is a table of grades."""
    return head.startswith(",".join(COLUMNS).encode())


def _cell(value: object) -> object:
    """Return a value as a spreadsheet shall show it: a text that would be a formula begins with an apostrophe."""
    if not isinstance(value, str):
        return value
    shown = one_line(value)
    return f"'{shown}" if shown.startswith(FORMULA_MARKS) else shown
