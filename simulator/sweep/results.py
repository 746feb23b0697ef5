"""The file of results: a header, then a JSON line a run. It is resumed, appended to, and at the end put in order.

A line is written and flushed as soon as a run has ended. So a process that is killed loses only the runs under way. The
lines stand in the order in which runs ended; `finish` puts them in the order of the plan, by replacing the file whole.
"""

import json
import os
import re
import stat
import sys
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import Any, BinaryIO, NamedTuple, Protocol

from utak.kb.language.diagnostics import BadInputError, CannotOpenError, SourceSpan
from utak.kb.language.source_text import Source, lies_outside, read_bytes
from utak.simulator.episode.output_files import keep_first, open_for_writing, replace_whole

STDOUT_NAME = "-"  # the name of a file that stands for the standard output
MAX_RESULTS_BYTES = 2_000_000_000  # bytes; a convention
FORCE_HINT = "give another file, or --force to begin anew"
MAX_SHOWN_VALUE = 60  # characters of a value in a message; a convention

ResultRow = dict[str, Any]  # the JSON object of one run
RowKey = tuple[Any, ...]  # the values that tell which run a row is of


class RowForm(NamedTuple):
    """The form of a file of results."""

    # The first line; its key `utak` names the kind of file. None for no header, and then no file is resumed.
    header: dict[str, Any] | None
    names: tuple[str, ...]  # the names of the values in a row that are its key
    keys: Sequence[RowKey]  # the keys of all rows, in order
    check: Callable[[ResultRow], str] = lambda row: ""  # returns what is wrong with a row, "" for nothing

    def key_of(self, row: ResultRow) -> RowKey:
        """Return the key of a row."""
        return tuple(row.get(name) for name in self.names)


class ResultsProtocol(Protocol):
    """Takes the results of a sweep, one run at a time."""

    @property
    def known(self) -> dict[RowKey, ResultRow]:
        """The rows so far, by key."""

    def append(self, row: ResultRow) -> None:
        """Add the row of a run that has ended."""

    def finish(self) -> None:
        """Put the rows in order, as far as they are there, and close."""


def encode_row(row: ResultRow) -> bytes:
    """Return a row or a header as a line, with its line end; equal values give equal bytes."""
    return json.dumps(row, separators=(",", ":")).encode("ascii") + b"\n"


def open_results(path: Path | str | None, form: RowForm, force: bool = False) -> "ResultsProtocol":
    """Return where results go: a file, which may hold some of them already, or the standard output."""
    if path is None:
        return PassingResults(form, None)
    if path == STDOUT_NAME:
        return PassingResults(form, sys.stdout)
    stream = open_for_writing(path, partial(_is_ours, form), "file of results", force)
    try:
        if form.header is None or not stat.S_ISREG(os.fstat(stream.fileno()).st_mode):
            keep_first(stream, 0)
            return PassingResults(form, stream)
        if not os.path.samestat(os.fstat(stream.fileno()), os.stat(path)):  # noqa: PTH116
            raise CannotOpenError(str(path), "another process has just replaced it")
        return ResultsFile(Path(path), stream, form, form.header, force)
    except BaseException:
        stream.close()
        raise


def _is_ours(form: RowForm, head: bytes) -> bool:
    """Return whether a file with these first bytes is of a form, even when its first line was cut short."""
    if form.header is None:
        return holds_rows(head, form.names)
    kind = form.header["utak"].encode()
    start = encode_row({"utak": form.header["utak"]})[:-2]  # the first bytes of every such file
    return re.match(rb'\s*\{\s*"utak"\s*:\s*"' + re.escape(kind) + b'"', head) is not None or start.startswith(head)


def holds_rows(head: bytes, names: Sequence[str]) -> bool:
    """Return whether the first line of a file with these first bytes is a JSON object that has these keys."""
    try:
        first = json.loads(head.split(b"\n")[0])
    except (ValueError, RecursionError):
        return encode_row({names[0]: ""})[:-4].startswith(head)  # a first line that was cut short at once
    return isinstance(first, dict) and first.keys() >= set(names)


class ResultsFile:
    """A file of results that this process alone writes to."""

    def __init__(self, path: Path, stream: BinaryIO, form: RowForm, header: ResultRow, force: bool) -> None:
        self._path, self._stream, self._form, self._header = path, stream, form, header
        self.known: dict[RowKey, ResultRow] = {}
        self._keys = frozenset(form.keys)
        lines = [] if force else complete_result_lines(path)
        if lines:
            _compare_headers(str(path), _decoded(str(path), 1, lines[0]), header)
            for number, line in enumerate(lines[1:], 2):
                self._take(number, _decoded(str(path), number, line))
        keep_first(stream, sum(map(len, lines)))
        if not lines:
            self._write(encode_row(header))

    def append(self, row: ResultRow) -> None:
        """Write the row of a run that has ended, at once. Raises CannotOpenError when it cannot be written."""
        self._write(encode_row(row))
        self.known[self._form.key_of(row)] = row

    def finish(self) -> None:
        """Put the rows into the order of the plan and close the file. It is replaced whole, or not at all."""
        # Raises CannotOpenError when it cannot be replaced; the rows are kept then.
        with self._stream:
            ordered = [key for key in self._form.keys if key in self.known]
            if ordered == list(self.known):
                return
            try:
                if os.name == "nt":  # elsewhere it stays locked until it is replaced
                    self._stream.close()
                rows = [self._header, *(self.known[key] for key in ordered)]
                replace_whole(self._path, b"".join(map(encode_row, rows)))
            except OSError as error:
                why = f"its lines cannot be put in order: {error.strerror}"
                raise CannotOpenError(str(self._path), why) from None

    def _take(self, number: int, row: ResultRow) -> None:
        """Keep a row of an existing file."""
        key = self._form.key_of(row)
        problem = self._form.check(row)
        try:
            wanted = key in self._keys
        except TypeError:  # a list or an object
            wanted = False
        if not wanted or key in self.known:
            problem = "it is of a run that occurs twice" if wanted else "it is of no run of this sweep"
        if problem:
            raise _damaged(str(self._path), number, f"this line is no result: {problem}")
        self.known[key] = row

    def _write(self, line: bytes) -> None:
        """Write a line at once."""
        try:
            self._stream.write(line)
            self._stream.flush()
        except OSError as error:
            raise CannotOpenError(str(self._path), f"it cannot be written: {error.strerror}") from None


class PassingResults:
    """Results that go to a stream in the order of the plan, each as soon as those before it are there."""

    def __init__(self, form: RowForm, stream: Any) -> None:
        self._form, self._stream = form, stream
        self.known: dict[RowKey, ResultRow] = {}
        self._left: Iterator[RowKey] = iter(form.keys)
        self._next = next(self._left, None)
        if form.header is not None:
            self._pass(form.header)

    def append(self, row: ResultRow) -> None:
        """Add a row, and write those whose turn it is."""
        self.known[self._form.key_of(row)] = row
        while self._next is not None and self._next in self.known:
            self._pass(self.known[self._next])
            self._next = next(self._left, None)

    def finish(self) -> None:
        """Write the rows that wait for others, which will not come any more."""
        for key in [self._next, *self._left]:
            if key is not None and key in self.known:
                self._pass(self.known[key])
        if self._stream is not None and self._stream is not sys.stdout:
            self._stream.close()

    def _pass(self, row: ResultRow) -> None:
        """Write a row."""
        if self._stream is None:
            return
        line = encode_row(row)
        self._stream.write(line.decode("ascii") if self._stream is sys.stdout else line)
        self._stream.flush()


def complete_result_lines(path: Path | str) -> list[bytes]:
    """Return the lines of a file with their line ends; a last line without a line end is left out."""
    # Raises CannotOpenError when the file cannot be read or is too large.
    whole = read_bytes(str(path), MAX_RESULTS_BYTES)
    if len(whole) > MAX_RESULTS_BYTES:
        raise CannotOpenError(str(path), f"it is larger than {MAX_RESULTS_BYTES} bytes")
    return [line + b"\n" for line in whole.split(b"\n")[:-1]]


def _decoded(path: str, number: int, line: bytes) -> ResultRow:
    """Return the JSON object in a line; raise BadInputError when there is none."""
    try:
        value = json.loads(line)
    except (ValueError, RecursionError):
        raise _damaged(path, number, "this line is no JSON: the file of results is damaged") from None
    if not isinstance(value, dict):
        raise _damaged(path, number, "a line of results is a JSON object")
    return value


def _compare_headers(path: str, found: dict[str, Any], wanted: dict[str, Any]) -> None:
    """Raise BadInputError when the headers of two files differ; the message names the first difference."""
    for name, there, here in _differences(found, wanted):
        what = f"these are results of another {wanted['utak']}: {name} is {_shown(there)} there and {_shown(here)} here"
        raise _damaged(path, 1, what, FORCE_HINT)


def _differences(found: Any, wanted: Any, name: str = "the header") -> Iterator[tuple[str, Any, Any]]:
    """Yield (name, value there, value here) of what differs in two headers."""
    if isinstance(found, dict) and isinstance(wanted, dict):
        for key in {**wanted, **found}:
            yield from _differences(found.get(key), wanted.get(key), key)
    elif found != wanted:
        yield name, found, wanted


def _shown(value: Any) -> str:
    """Return a value of a header as a message shows it."""
    return "absent" if value is None else json.dumps(value)[:MAX_SHOWN_VALUE]


def _damaged(path: str, number: int, what: str, hint: str = "") -> BadInputError:
    """Return the error `what` at a line of a file of results; behind a link out of its folder, the place alone."""
    return BadInputError([Source(path, "", lies_outside(path)).problem(SourceSpan(number, 1, 1), what, hint)])
