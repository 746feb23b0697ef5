"""The table in a terminal while a run goes on: drawn in place where that is possible, else picture after picture."""

import os
import sys
from typing import TYPE_CHECKING

from utak.simulator.scenario.picture import draw
from utak.simulator.terminal.action_in_words import TRUE_TABLE_NOTICE, step_in_words

if TYPE_CHECKING:
    from utak.simulator.run.session import Session


class TableWatch:
    """Draws the true table on the standard error after every step."""

    def __init__(self) -> None:
        self._rows = 0  # rows of the picture that stands in the terminal
        self._step: int | None = None

    def tell(self, session: "Session") -> None:
        """Draw the table after a step of a session, unless that step was drawn already."""
        line, table = session.line, session.table
        if line["step"] == self._step:
            return
        self._step = line["step"]
        picture = draw(table.now).splitlines()
        rows = [TRUE_TABLE_NOTICE, *picture, step_in_words(line)]
        width, height = _room()
        if len(rows) >= height or max(map(len, picture)) >= width:
            print("\n".join(rows), file=sys.stderr)
            return
        if self._rows and hasattr(sys.stderr, "erase_rows"):  # move up, and erase what is below
            sys.stderr.erase_rows(self._rows)
        rows = [row if len(row) < width else row[: width - 4] + "..." for row in rows]
        print("\n".join(rows), file=sys.stderr, flush=True)
        self._rows = len(rows)


def _room() -> tuple[int, int]:
    if not sys.stderr.isatty() or os.environ.get("TERM", "") in ("", "dumb"):
        return 0, 0
    try:
        size = os.get_terminal_size(sys.stderr.fileno())
    except (OSError, ValueError):
        return 0, 0
    return size.columns, size.lines
