"""Episodes: the record of a run as JSON lines (docs/files.md): a header, step 0, one line a command, and the result.

Every line is written and flushed before the next command is given. So a killed run leaves a readable episode.
"""

import json
from collections import Counter
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from types import TracebackType
from typing import Any

from utak.kb.language.diagnostics import MAX_PROBLEMS_PER_FILE, BadInputError, CannotOpenError, Problem, SourceSpan
from utak.kb.language.source_text import Source, lies_outside, read_bytes
from utak.simulator.episode.output_files import GrowingFile, is_episode
from utak.simulator.episode.schema import EPISODE_VERSION, KeyPath, complaints

STANDARD_OUTPUT = "-"  # the value of --log for the standard output
MAX_EPISODE_BYTES = 500_000_000  # bytes; a convention

EpisodeLine = dict[str, Any]  # the JSON object of one line


@dataclass(frozen=True)
class Episode:
    """An episode that was read."""

    header: EpisodeLine  # the options, the world and the task
    steps: tuple[EpisodeLine, ...]  # step 0, and one line for each command, in order
    result: EpisodeLine | None  # the end; None when the run was cut short


def encode(line: EpisodeLine) -> str:
    """Return one line of an episode as text, with its line end."""
    # Raises ValueError for NaN and infinite numbers.
    return json.dumps(line, separators=(",", ":"), allow_nan=False) + "\n"


def read_episode(path: Path | str) -> Episode:
    """Return an episode, complete or cut short."""
    name = str(path)
    *lines, rest = _split(path)
    if _object_in(rest):  # an editor took the last line end away
        lines.append(rest)
    rows = [_decoded(name, number, row) for number, row in enumerate(lines, 1)]
    if not rows or rows[0].get("utak") != "episode":
        raise _damaged(name, 1, "this is no episode: the first line is no header")
    if rows[0].get("version") != EPISODE_VERSION:
        raise _damaged(
            name, 1, f"an episode of version {rows[0].get('version')}; this utak reads version {EPISODE_VERSION}"
        )
    result = rows.pop()["result"] if len(rows) > 1 and "result" in rows[-1] else None
    for number, row in enumerate(rows[1:]):
        if row.get("step") != number:
            raise _damaged(name, number + 2, f"step {number} is missing")
    problems: list[Problem] = []
    for number, raw in enumerate(lines):
        form = "header" if number == 0 else "step" if number < len(rows) else "end"
        row = rows[number] if number < len(rows) else {"result": result}
        problems += (
            _located(name, number + 1, raw, *complaint)
            for complaint in islice(complaints(form, row), MAX_PROBLEMS_PER_FILE)
        )
        if problems:
            raise BadInputError(problems)
    return Episode(rows[0], tuple(rows[1:]), result)


def read_begun_episode(path: Path | str) -> Episode:
    """Return an episode of at least one step, complete or cut short."""
    episode = read_episode(path)
    if not episode.steps:
        raise _damaged(str(path), 1, "the episode ends before its first step")
    return episode


def lines_to_resume(path: Path | str) -> list[bytes]:
    """Return the complete lines of an episode whose run shall go on; raises when its header is cut."""
    *lines, rest = _split(path)
    if not lines and rest and not _object_in(rest):
        what = "the episode ends within its header, which states the options of the run: it cannot go on"
        raise _damaged(str(path), 1, f"{what}; leave out --resume to begin anew")
    return lines


def _split(path: Path | str) -> list[bytes]:
    """Return the lines of an episode with their line ends, and last what follows the last line end; raises as above."""
    whole = read_bytes(str(path), MAX_EPISODE_BYTES)
    if len(whole) > MAX_EPISODE_BYTES:
        raise _damaged(str(path), 1, f"the file is larger than {MAX_EPISODE_BYTES} bytes")
    *lines, rest = whole.split(b"\n")
    return [*(line + b"\n" for line in lines), rest]


def _object_in(raw: bytes) -> EpisodeLine:
    """Return the JSON object that bytes state; {} when they are none, as those of a line that was cut short."""
    with suppress(ValueError, RecursionError):
        value = json.loads(raw)
        return value if isinstance(value, dict) else {}
    return {}


def without_limit(lines: list[bytes]) -> list[bytes]:
    """Return the lines of an episode without its result, if a limit of time ended the run; then the run can go on."""
    result = _object_in(lines[-1]).get("result") if len(lines) > 1 else None
    return lines[:-1] if isinstance(result, dict) and "seconds" in result else lines


class _InvalidJsonError(ValueError):
    """A value that Python's JSON reader accepts, but no episode has."""


def _decoded(path: str, number: int, row: bytes) -> EpisodeLine:
    """Return the object in a line; raise BadInputError when there is none."""
    try:
        value = _JSON.decode(row.decode("utf-8"))
    except UnicodeDecodeError as error:
        raise _damaged(path, number, "this line is no text: the episode is damaged", error.start + 1) from None
    except json.JSONDecodeError as error:
        raise _damaged(
            path, number, f"this line is no JSON: the episode is damaged: {error.msg}", error.colno
        ) from None
    except (ValueError, RecursionError) as error:
        what = str(error) if isinstance(error, _InvalidJsonError) else "a number too long or too many brackets"
        raise _damaged(path, number, f"this line is no JSON: the episode is damaged: {what}") from None
    if not isinstance(value, dict):
        raise _damaged(path, number, "a line of an episode is a JSON object")
    return value


def _object_without_duplicates(pairs: list[tuple[str, Any]]) -> EpisodeLine:
    """Return a JSON object; raise _InvalidJsonError when a key occurs twice."""
    found = dict(pairs)
    if len(found) < len(pairs):
        twice = next(key for key, count in Counter(key for key, _ in pairs).items() if count > 1)
        raise _InvalidJsonError(f"the key {twice[:40]} occurs twice")
    return found


def _refuse_constant(word: str) -> Any:
    """Raise _InvalidJsonError for NaN and Infinity."""
    raise _InvalidJsonError(f"{word} is no number")


_JSON = json.JSONDecoder(object_pairs_hook=_object_without_duplicates, parse_constant=_refuse_constant)


def _damaged(path: str, number: int, what: str, column: int = 1) -> BadInputError:
    """Return the error `what` at a line and a column of an episode."""
    return BadInputError([_problem(path, SourceSpan(number, column, column), what)])


def _problem(path: str, span: SourceSpan, what: str) -> Problem:
    """Return a problem of an episode; of one behind a link out of its folder it gives the place alone."""
    return Source(path, "", lies_outside(path)).problem(span, what)


def _located(path: str, number: int, raw: bytes, where: KeyPath, what: str) -> Problem:
    """Return the problem of a value, placed at the key that leads to it."""
    at = _column(raw.decode("utf-8"), where)
    key = ".".join(where)[:80]
    return _problem(path, SourceSpan(number, at, at), f"{key}: {what}: the episode is damaged" if key else what)


def _column(row: str, where: KeyPath) -> int:
    """Return the column, from 1, of the last of some nested keys in a line; 1 for no keys."""
    at = 0
    for key in where:
        found = row.find(f'"{key}"', at)
        at = found if found >= 0 else at
    return at + 1


class EpisodeLog:
    """Writes an episode to a file, line by line; no other process can write to the file meanwhile."""

    def __init__(
        self,
        path: Path | str | None,
        resume: bool = False,
        force: bool = False,
        listeners: Sequence[Callable[[EpisodeLine], None]] = (),
    ) -> None:
        self._path, self._listeners = path, listeners
        self._number = 0
        self._recorded: Sequence[bytes] = ()
        self._stream: GrowingFile | None = None
        if path is None or path == STANDARD_OUTPUT:
            return
        if resume and not Path(path).exists():
            raise CannotOpenError(str(path), "there is no such episode to go on from")
        self._stream = GrowingFile(path, is_episode, "episode", force)
        try:
            if resume:
                self._recorded = without_limit(lines_to_resume(path))
            self._stream.keep_first(sum(map(len, self._recorded)))
        except BaseException:
            self._stream.close()
            raise

    def __enter__(self) -> "EpisodeLog":
        return self

    def __exit__(self, kind: type[BaseException] | None, value: BaseException | None, at: TracebackType | None) -> None:
        if self._stream is not None:
            self._stream.close()

    @property
    def is_repeating(self) -> bool:
        """Whether the next line stands in the file already, because the episode is resumed."""
        return self._number < len(self._recorded)

    def write(self, line: EpisodeLine) -> None:
        """Write one line at once; while resuming, compare it with the recorded line."""
        # Raises BadInputError when it differs, CannotOpenError when it cannot be written.
        text = encode(line)
        self._number += 1
        if self._number <= len(self._recorded):
            if text.encode("ascii") != self._recorded[self._number - 1]:
                what = "the run does not repeat this line: another scenario, other options or another version of utak"
                if self._number == 1 and _object_in(self._recorded[0]).get("changes"):
                    what = "this run was changed at the prompt, so `utak run` cannot repeat it: `utak repl` can"
                raise _damaged(str(self._path), self._number, what)
        elif self._stream is not None:
            self._stream.write(text.encode("ascii"))
        elif self._path == STANDARD_OUTPUT:
            print(text, end="", flush=True)
        for listen in self._listeners:
            listen(line)
