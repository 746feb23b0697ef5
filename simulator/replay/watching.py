"""The table in a terminal while a run goes on: drawn in place where that is possible, else picture after picture."""

import os
import sys
from typing import TYPE_CHECKING

from utak.simulator.scenario.picture import draw
from utak.simulator.terminal.action_in_words import describe
from utak.simulator.terminal.streams import escape_controls

if TYPE_CHECKING:
    from utak.simulator.run.session import Session

TRUE_TABLE = "the true table, which the robot may believe to be otherwise:"


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
        picture = draw(table.world, table.polygons, table.utak).splitlines()
        rows = [TRUE_TABLE, *picture, step_in_words(line)]
        width, height = _room()
        if len(rows) >= height or max(map(len, picture)) >= width:
            print("\n".join(rows), file=sys.stderr)
            return
        if self._rows:
            _erase(self._rows)
        rows = [row if len(row) < width else row[: width - 4] + "..." for row in rows]
        print("\n".join(rows), file=sys.stderr, flush=True)
        self._rows = len(rows)


def step_in_words(line: dict[str, object]) -> str:
    """Return a step of an episode in one line: its number, its action and its reason."""
    why = escape_controls(str(line["why"]), lines=False)
    return f"step {line['step']}: {describe(line['action'])}: {why}"  # type: ignore[arg-type]


def _room() -> tuple[int, int]:
    """Return columns and rows of the terminal on the standard error; (0, 0) where nothing can be drawn in place."""
    if not sys.stderr.isatty() or os.environ.get("TERM", "") in ("", "dumb"):
        return 0, 0
    try:
        size = os.get_terminal_size(sys.stderr.fileno())
    except (OSError, ValueError):
        return 0, 0
    return size.columns, size.lines


def _erase(rows: int) -> None:
    """Move the cursor up by some rows and erase what is below."""
    erase = getattr(sys.stderr, "erase_rows", None)
    if erase is not None:
        erase(rows)
