"""Results as JSON lines that are appended: what is known already is a set, and what is missing a difference of sets.

A line is written and flushed as soon as a run has ended, in the order in which runs end. So a process that is killed
loses only the runs under way, and files of several machines are joined by putting one after the other.
"""

import json
import sys
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from utak.kb.language.diagnostics import BadInputError, CannotOpenError, SourceSpan
from utak.kb.language.source_text import Source, lies_outside, read_bytes
from utak.simulator.episode.output_files import keep_first, open_for_writing

STDOUT_NAME = "-"  # the name of a file that stands for the standard output
MAX_RESULTS_BYTES = 2_000_000_000  # bytes; a convention

ResultRow = dict[str, Any]  # the JSON object of one run
RowKey = tuple[Any, ...]  # the values that tell which run a row is of


class Results:
    """Rows of runs: those that a file has, and those appended to it; it is locked for this process until closed."""

    def __init__(
        self,
        path: Path | str | None,
        names: Sequence[str],
        force: bool = False,
        check: Callable[[ResultRow], str] = lambda row: "",
    ) -> None:
        """Open a file and read its rows.

        Parameters
        ----------
        path : the file; "-" for the standard output, None for none.
        names : the values of a row that tell which run it is of.
        force : begin anew, and overwrite whatever the file holds.
        check : returns what is wrong with a row, "" for nothing.

        Raises
        ------
        CannotOpenError
            When the file is of another kind, or cannot be read and written.
        BadInputError
            When a line is no row.
        """
        self.known: dict[RowKey, ResultRow] = {}  # by key; of several rows with one key the last
        self._path, self._names, self._stream = str(path), tuple(names), None if path is None else sys.stdout.buffer
        if path is not None and path != STDOUT_NAME:
            self._stream = open_for_writing(path, partial(holds_rows, names=self._names), "file of results", force)
            try:
                lines = [] if force or not Path(path).is_file() else complete_result_lines(path)
                for number, line in enumerate(lines, 1):
                    self._take(number, line, check)
                keep_first(self._stream, sum(map(len, lines)))
            except BaseException:
                self.close()
                raise

    def append(self, row: ResultRow) -> None:
        """Write the row of a run that has ended, at once. Raises CannotOpenError when it cannot be written."""
        self.known[tuple(row[name] for name in self._names)] = row
        if self._stream is not None:
            try:
                self._stream.write(json.dumps(row, separators=(",", ":")).encode("ascii") + b"\n")
                self._stream.flush()
            except OSError as error:
                raise CannotOpenError(self._path, f"it cannot be written: {error.strerror}") from None

    def close(self) -> None:
        """Close the file."""
        if self._stream is not None and self._stream is not sys.stdout.buffer:
            self._stream.close()

    def _take(self, number: int, line: bytes, check: Callable[[ResultRow], str]) -> None:
        try:
            row = json.loads(line)
            key = tuple(row[name] for name in self._names)
            problem = check(row) if all(isinstance(part, str | float | int) for part in key) else "its key is none"
        except (ValueError, TypeError, KeyError, RecursionError):
            problem = "it is no JSON object of a run"
        if problem:
            source = Source(self._path, "", lies_outside(self._path))
            raise BadInputError([source.problem(SourceSpan(number, 1, 1), f"this line is no result: {problem}")])
        self.known[key] = row


def holds_rows(head: bytes, names: Sequence[str]) -> bool:
    """Return whether the first line of a file with these first bytes is a JSON object that has these keys."""
    try:
        first = json.loads(head.split(b"\n")[0])
    except (ValueError, RecursionError):
        start = f'{{"{names[0]}":'.encode()
        was_cut = b"\n" not in head  # a first line, as a kill leaves it
        return was_cut and (head.startswith(start) or start.startswith(head))
    return isinstance(first, dict) and first.keys() >= set(names)


def complete_result_lines(path: Path | str) -> list[bytes]:
    """Return the lines of a file with their line ends; a last line without a line end is left out."""
    # Raises CannotOpenError when the file cannot be read or is too large.
    whole = read_bytes(str(path), MAX_RESULTS_BYTES)
    if len(whole) > MAX_RESULTS_BYTES:
        raise CannotOpenError(str(path), f"it is larger than {MAX_RESULTS_BYTES} bytes")
    return [line + b"\n" for line in whole.split(b"\n")[:-1]]
