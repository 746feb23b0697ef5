"""Episodes: what happened, as JSON lines. A header, step 0, one line a command, and the result (docs/files.md).

Every line is written and flushed before the next command is given, so that a killed run leaves a readable episode.
"""

import json
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Any, BinaryIO

from kb.problems import BadInputError, CannotOpenError, Problem, Span
from kb.source import read_bytes
from simulator.outputs import is_episode, keep_first, opened

VERSION = 1
STANDARD_OUTPUT = "-"
LARGEST = 2_000_000_000  # bytes

Line = dict[str, Any]


@dataclass(frozen=True)
class Episode:
    """An episode read back.

    Attributes
    ----------
    header : the options, the world and the task.
    steps : step 0 and one entry a command, in order.
    result : how it ended, or None when the run was cut short.
    """

    header: Line
    steps: tuple[Line, ...]
    result: Line | None


def encode(line: Line) -> str:
    """Return one line of an episode, with its line end. Floats are written in full; equal values give equal bytes."""
    return json.dumps(line, separators=(",", ":"), allow_nan=False) + "\n"


def read_episode(path: Path | str) -> Episode:
    """Read an episode, whole or cut short; raises CannotOpenError, or BadInputError when it is none."""
    rows = [_decoded(str(path), number, row) for number, row in enumerate(complete_lines(path), 1)]
    if not rows or rows[0].get("utak") != "episode":
        raise _none(str(path), 1, "this is no episode: the first line is no header")
    if rows[0].get("version") != VERSION:
        raise _none(str(path), 1, f"an episode of version {rows[0].get('version')}; this utak reads version {VERSION}")
    steps = [row for row in rows if "step" in row]
    for number, row in enumerate(steps):
        if row["step"] != number:
            raise _none(str(path), number + 2, f"step {number} is missing")
    results = [row["result"] for row in rows if isinstance(row.get("result"), dict)]
    return Episode(rows[0], tuple(steps), results[-1] if results else None)


def complete_lines(path: Path | str) -> list[bytes]:
    """Return the lines of an episode that were written to their ends; a last line cut short is left out."""
    return [row + b"\n" for row in read_bytes(str(path), LARGEST).split(b"\n")[:-1]]


def _decoded(path: str, number: int, row: bytes) -> Line:
    try:
        value = json.loads(row)
    except (ValueError, RecursionError):
        raise _none(path, number, "this line is no JSON: the episode is damaged") from None
    if not isinstance(value, dict):
        raise _none(path, number, "a line of an episode is a JSON object")
    return value


def _none(path: str, number: int, what: str) -> BadInputError:
    return BadInputError([Problem(path, Span(number, 1, 1), what)])


class EpisodeLog:
    """Writes an episode to a file, a line at a time; nobody else can write to it meanwhile.

    Parameters
    ----------
    path : the file; `-` is the standard output; None writes nowhere.
    resume : go on from what the file holds already. The run is repeated from the start, and every line that the file
        holds must come out again byte for byte; a last line cut short is dropped.
    force : overwrite a file that is no episode.

    Raises CannotOpenError: when there is nothing to resume, or as `simulator.outputs.opened` does.
    """

    def __init__(self, path: Path | str | None, resume: bool = False, force: bool = False) -> None:
        self._path = path
        self._number = 0
        self._recorded: Sequence[bytes] = ()
        self._stream: BinaryIO | None = None
        if path is None or path == STANDARD_OUTPUT:
            return
        if resume and not Path(path).exists():
            raise CannotOpenError(str(path), "there is no such episode to go on from")
        self._stream = opened(path, is_episode, "episode", force)
        try:
            if resume:
                self._recorded = complete_lines(path)
            keep_first(self._stream, sum(map(len, self._recorded)))
        except OSError as error:
            self._stream.close()
            raise CannotOpenError(str(path), error.strerror or str(error)) from None
        except CannotOpenError:
            self._stream.close()
            raise

    def __enter__(self) -> "EpisodeLog":
        return self

    def __exit__(self, kind: type[BaseException] | None, value: BaseException | None, at: TracebackType | None) -> None:
        if self._stream is not None:
            with suppress(OSError):  # what could not be written was reported then
                self._stream.close()

    def write(self, line: Line) -> None:
        """Write one line at once; while resuming, check that it is the one recorded (BadInputError when not)."""
        text = encode(line)
        self._number += 1
        if self._number <= len(self._recorded):
            if text.encode("ascii") != self._recorded[self._number - 1]:
                what = "the run does not repeat this line: another scenario, other options or another version of utak"
                raise _none(str(self._path), self._number, what)
        elif self._stream is not None:
            try:
                self._stream.write(text.encode("ascii"))
                self._stream.flush()
            except OSError as error:
                raise CannotOpenError(str(self._path), f"it cannot be written: {error.strerror}") from None
        elif self._path == STANDARD_OUTPUT:
            print(text, end="", flush=True)
