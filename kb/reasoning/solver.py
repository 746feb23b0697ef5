"""The single place where encodings meet clingo: encodings by absolute path, facts as text, every message an error.

Facts come from our own values, never as raw text of a user. With rules of a user (`--kb`) everything is solved in a
separate process, by kb.reasoning.user_rules.
"""

from collections.abc import Iterable, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any

import clingo

from utak.kb.reasoning.encodings import CORE_GUIDED, ENCODING_FOLDERS, BoundedAnswer, encoding_files
from utak.kb.tracing.decisions import note_answer, note_applied_rules

MAX_BOUNDED_SECONDS = 600.0  # of wall-clock time; against a search that hangs, never reached within the conflicts


class EncodingError(Exception):
    """An encoding is wrong, or it contradicts the facts: an error in our encodings or in a user's rules."""


def solve(
    files: Sequence[Path], facts: Iterable[str], seconds: float = 20.0, about: Sequence[Any] = ()
) -> list[clingo.Symbol] | None:
    """Return the shown atoms of the best answer set found."""
    given = tuple(facts)
    answer = _answer(tuple(files), given, seconds, None, _versions(files))
    note_answer(files, given, answer.atoms, about)
    note_applied_rules(answer.applied)
    return None if answer.atoms is None else list(answer.atoms)


def solve_within(
    files: Sequence[Path],
    facts: Iterable[str],
    conflicts: int,
    about: Sequence[Any] = (),
    without: tuple[str, ...] = (),
) -> BoundedAnswer:
    """Return the best answer set that is found within a number of conflicts, which is the same on every machine."""
    given = tuple(facts)
    answer = _answer(tuple(files), given, MAX_BOUNDED_SECONDS, conflicts, _versions(files), without)
    note_answer(files, given, answer.atoms, about)
    note_applied_rules(answer.applied)
    return answer


def _users_files(files: Sequence[Path]) -> list[Path]:
    """Return those of some files that hold users' rules, in order."""
    others = (path for path in files if not _is_ours(path))
    return [path for path in others if not _is_ours(path.resolve())]


def _is_ours(path: Path) -> bool:
    """Return whether a file or folder is one of our encodings, or a part of one."""
    return path.parent in ENCODING_FOLDERS or path.parent.parent in ENCODING_FOLDERS


def _versions(files: Sequence[Path]) -> tuple[tuple[int, int], ...]:
    """Return when each file with users' rules was changed last, in nanoseconds, and its size in bytes."""
    found = (path.stat() for path in _users_files(files) if path.exists())
    return tuple((state.st_mtime_ns, state.st_size) for state in found)


@lru_cache(maxsize=256)
def _answer(
    files: tuple[Path, ...],
    facts: tuple[str, ...],
    seconds: float,
    conflicts: int | None,
    _files_as_of: tuple[tuple[int, int], ...],
    without: tuple[str, ...] = (),
) -> BoundedAnswer:
    """Return the answer of `solve` or `solve_within`; cached while the files stay as they are."""
    users = _users_files(files)
    if users:
        from utak.kb.reasoning.user_rules import solve_with_user_rules  # imported only when needed: it takes time

        files = tuple(path for path in files if path not in users)
        found = solve_with_user_rules(files, users, facts, conflicts, without=without)
        if found is not None:
            return found
    if conflicts is not None:
        by_cores = _searched(files, facts, seconds, conflicts, CORE_GUIDED)
        if by_cores.proved and by_cores.atoms is not None:
            return by_cores
    return _searched(files, facts, seconds, conflicts, ())


def _searched(
    files: tuple[Path, ...], facts: tuple[str, ...], seconds: float, conflicts: int | None, options: tuple[str, ...]
) -> BoundedAnswer:
    """Return the answer of one search with some options of clingo; the others as for `_answer`."""
    messages: list[str] = []
    control = clingo.Control(
        ["--stats=0", *options], logger=lambda _code, text: messages.append(text), message_limit=20
    )
    try:
        for path in files:
            for file in encoding_files(path) or (path,):
                control.load(str(file.resolve()))
        control.add("base", [], "".join(f"{fact}.\n" for fact in facts))
        control.ground([("base", [])])
    except RuntimeError as error:
        raise EncodingError("\n".join([*messages, str(error)])) from error
    if messages:
        raise EncodingError("\n".join(messages))
    best: BoundedAnswer = BoundedAnswer(None, False)

    def keep(model: clingo.Model) -> None:
        """Keep the shown atoms of a model as the best ones so far."""
        nonlocal best
        cost = tuple(zip(model.priority, model.cost, strict=True))
        best = BoundedAnswer(tuple(sorted(model.symbols(shown=True), key=str)), False, cost)

    if conflicts is not None:
        settings: Any = control.configuration.solve
        settings.solve_limit = f"{conflicts},umax"
    with control.solve(on_model=keep, async_=True) as handle:
        if not handle.wait(seconds):
            handle.cancel()
        exhausted = bool(handle.get().exhausted)
    return best._replace(proved=exhausted)
