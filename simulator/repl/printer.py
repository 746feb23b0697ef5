"""Printing: answers on the standard output, messages on the standard error; tables and colours on a terminal.

Colours and framed tables need `rich`, and a terminal without NO_COLOR. Everything else is plain text.
"""

import os
import shutil
import sys
import textwrap
from collections.abc import Mapping, Sequence
from typing import Any

from utak.kb.reasoning.query import plain_table
from utak.simulator.terminal.streams import StreamError, escape_controls, one_line

MIN_PAGE_ROWS = 5  # rows shown at once on the lowest terminal; a convention
LINES_BESIDE_A_PAGE = 6  # lines of a terminal for the prompt, the frame of a table and what is said below it
# What is said of the values of a variable, by the name of its argument's type.
UNITS = {
    "a length in hundredths of squares": "hundredths of a square, in the robot's frame",
    "a confidence": "percent",
}


class Printer:
    """Prints answers and messages."""

    def __init__(self, is_terminal: bool = False, console: Any = None) -> None:
        self.is_terminal, self._console = is_terminal, console

    @property
    def page_rows(self) -> int | None:
        """The rows of a page; None when everything is printed at once."""
        if not self.is_terminal:
            return None
        return max(MIN_PAGE_ROWS, shutil.get_terminal_size().lines - LINES_BESIDE_A_PAGE)

    @property
    def width(self) -> int | None:
        """The characters in a line of the terminal; None for a pipe."""
        return shutil.get_terminal_size().columns if self.is_terminal else None

    def say(self, text: str) -> None:
        """Print an answer."""
        print(self._broken(text), flush=True)

    def tell(self, text: str) -> None:
        """Print a message: an error, or what is being done."""
        sys.stdout.flush()
        print(self._broken(text), file=sys.stderr, flush=True)

    def note(self, text: str) -> None:
        """Print what helps a person to read an answer; nothing on a pipe."""
        if self.is_terminal:
            self.styled(text, "dim")

    def styled(self, text: str, style: str) -> None:
        """Print a text in a style of `rich`, or plainly without colours."""
        if self._console is None:
            self.say(text)
            return
        from rich.text import Text

        self._on_console(Text(escape_controls(self._broken(text)), style))

    def table(self, columns: Sequence[str], rows: Sequence[Sequence[int | str]]) -> None:
        """Print a table of bindings."""
        if self._console is None:
            self.say(plain_table(columns, rows))
            return
        from rich import box
        from rich.table import Table
        from rich.text import Text

        table = Table(box=box.SIMPLE_HEAD, header_style="bold", pad_edge=False, show_edge=False)
        for at, column in enumerate(columns):
            numbers = bool(rows) and all(isinstance(row[at], int) for row in rows)
            table.add_column(Text(column), justify="right" if numbers else "left", overflow="fold")
        for row in rows:
            table.add_row(*(Text(one_line(str(v)), "cyan" if isinstance(v, int) else "") for v in row))
        self._on_console(table)

    def picture(self, lines: Sequence[str], styles: Mapping[str, str]) -> None:
        """Print the lines of a picture; on a terminal with colours each character in the style given for it."""
        if self._console is None:
            self.say("\n".join(lines))
            return
        from rich.text import Text

        text = Text("", no_wrap=True)
        for number, line in enumerate(lines):
            text.append("\n" if number else "")
            for char in one_line(line):
                text.append(char, styles.get(char, ""))
        self._on_console(text)

    def _broken(self, text: str) -> str:
        """Return a text whose lines are broken between words where the terminal ends; as it is for a pipe."""
        width = self.width
        return text if width is None else "\n".join(broken_line(line, width) for line in text.split("\n"))

    def _on_console(self, value: Any) -> None:
        """Print a value of rich on the console; raise StreamError when the terminal is gone."""
        sys.stdout.flush()
        try:
            self._console.print(value, soft_wrap=not hasattr(value, "columns"), highlight=False)
        except OSError as error:
            raise StreamError(f"the terminal cannot be written: {error.strerror}") from None


def broken_line(line: str, width: int) -> str:
    """Return a line broken between words so that its parts have at most `width` characters, where words do.

    >>> print(broken_line("  step 1: goes on", 12))
      step 1:
        goes on
    """
    if len(line) <= width:
        return line
    indent = line[: len(line) - len(line.lstrip(" "))] + "  "
    parts = textwrap.wrap(line, width, subsequent_indent=indent, break_long_words=False, break_on_hyphens=False)
    return "\n".join(parts) or line


def units_of(columns: Sequence[str], types: Sequence[str]) -> str:
    """Return what is said of the units of a table's columns; '' for nothing.

    >>> units_of(["X", "E", "C"], ["thing", "a length in hundredths of squares", "a confidence"])
    "E: hundredths of a square, in the robot's frame. C: percent."
    """
    named: dict[str, list[str]] = {}
    for column, type_ in zip(columns, types, strict=False):
        if type_ in UNITS:
            named.setdefault(UNITS[type_], []).append(column)
    return " ".join(f"{', '.join(group)}: {unit}." for unit, group in named.items())


def open_printer() -> Printer:
    """Return the printer of this process: a terminal when both standard input and output are one."""
    is_terminal = sys.stdin is not None and sys.stdin.isatty() and sys.stdout.isatty()
    return Printer(is_terminal, _console() if is_terminal else None)


def _console() -> Any:
    """Return a console of `rich` on the terminal; None without rich, without colours, or where it shall be plain."""
    if os.environ.get("NO_COLOR") or os.environ.get("TERM") in (None, "", "dumb"):
        return None
    try:
        from rich.console import Console
    except ImportError:
        return None
    return Console(file=sys.__stdout__, highlight=False, emoji=False, markup=False)
