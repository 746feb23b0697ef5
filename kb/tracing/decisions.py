"""The record of decisions: what each encoding was given, and what it answered, in the order in which it was asked.

Whoever wants a record opens a block with `record_decisions`; `utak.kb.reasoning.solver.solve` notes every answer in it.
Explanations, episodes and dumps of programs are made from such records.
"""

from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path
from typing import Any, NamedTuple


class SolverCall(NamedTuple):
    """One answer of an encoding."""

    encoding: str  # the name of the encoding, without `.lp`.
    facts: tuple[str, ...]  # the atoms that it was given, as text without full stops
    answer: tuple[str, ...] | None  # the shown atoms of the answer, as text, sorted; None when there was no answer
    # What the candidates of the decision are, by their number in the facts: texts, or points of routes; () where
    # nothing is said of them. Ready for JSON.
    about: tuple[Any, ...] = ()


_applied_rules: ContextVar[set[str] | None] = ContextVar("applied_rules", default=None)
_open_record: ContextVar[list[SolverCall] | None] = ContextVar("open_record", default=None)


@contextmanager
def record_decisions() -> Iterator[list[SolverCall]]:
    """Record all answers of encodings in a `with` block."""
    record: list[SolverCall] = []
    token = _open_record.set(record)
    try:
        yield record
    finally:
        _open_record.reset(token)


@contextmanager
def record_applied_rules(applied: set[str]) -> Iterator[None]:
    """Add to a set which users' rules had an instance in any answer of a `with` block, as `RULES.lp:LINE:COLUMN`."""
    token = _applied_rules.set(applied)
    try:
        yield
    finally:
        _applied_rules.reset(token)


def note_applied_rules(places: Iterable[str]) -> None:
    """Add the places of users' rules that had an instance to the set that is open, if one is."""
    applied = _applied_rules.get()
    if applied is not None:
        applied.update(places)


def note_answer(
    files: Sequence[Path], facts: Sequence[str], answer: Sequence[Any] | None, about: Sequence[Any] = ()
) -> None:
    """Add an answer to the record that is open, if one is."""
    record = _open_record.get()
    if record is not None:
        atoms = None if answer is None else tuple(map(str, answer))
        record.append(SolverCall(files[0].stem, tuple(facts), atoms, tuple(about)))
