"""The believed facts, and the facts that may hold besides, as far as the vocabulary leaves a predicate open."""

from collections.abc import Iterable, Iterator, Sequence
from typing import Any

import clingo

from utak.kb.language.vocabulary import (
    BELIEF_PREDICATES,
    PLAN_PREDICATES,
    BeliefPredicate,
    Openness,
    Signature,
    may_be_otherwise,
)
from utak.kb.three_valued.uncertain_values import Unknown, Value, compare

FactRow = tuple[Value, ...]  # the arguments of one fact
CHANCE_SIGNATURE, OPEN_SIGNATURE = ("chance", 2), ("open", 2)
OBJECT_SIGNATURE = ("object", 1)  # object(N) stands for kind(N, object, C)
PARAMETER_SIGNATURE = ("parameter", 1)  # the parameters of the task
# These are about parameters, the plan and squares, not about things.
TASK_SIGNATURES = frozenset(
    {PARAMETER_SIGNATURE, ("bound", 2), ("may_be", 3), ("loc", 3), ("loc", 2), *PLAN_PREDICATES}
)


class Beliefs:
    """The facts of a world model, with the atoms that rules derive."""

    def __init__(self, facts: Iterable[tuple[str, FactRow]]) -> None:
        self.join_orders: dict[tuple[int, frozenset[str]], Any] = {}  # written by kb.three_valued.evaluation
        self._rows: dict[Signature, dict[FactRow, None]] = {}
        self._possible: dict[Signature, dict[FactRow, None]] = {}
        self._index: dict[tuple[Signature, int], dict[Value, list[FactRow]]] = {}
        for name, row in facts:
            self._rows.setdefault((name, len(row)), {})[row] = None
            for other, said in _also_said((name, len(row)), row):
                self._rows.setdefault(other, {})[said] = None
        self.known_names = frozenset(
            str(row[declared.subject])
            for signature, declared in BELIEF_PREDICATES.items()
            if signature not in TASK_SIGNATURES
            for row in self._rows.get(signature, ())
        )
        counts = [row[1] for row in self._rows.get(("unseen", 2), ())]
        self.everything_seen = not any(isinstance(count, int) and count > 0 for count in counts)
        self._state_chances()
        self._objects = sorted(row[0] for row in self._rows.get(OBJECT_SIGNATURE, ()))
        self._parameters = sorted(row[0] for row in self._rows.get(PARAMETER_SIGNATURE, ()))

    def _state_chances(self) -> None:
        """State chance/2, open/2, known/1 and possible/1 of the facts, each as a term without its confidence."""
        for (name, arity), rows in list(self._rows.items()):
            declared = BELIEF_PREDICATES.get((name, arity))
            is_unsure = declared is not None and declared.confident
            for row in rows:
                if is_unsure and not may_be_otherwise(name, row[0]):
                    continue
                chance = row[-1] if is_unsure else 100
                fact = clingo.Function(name, [_as_symbol(value) for value in (row[:-1] if is_unsure else row)])
                self._rows.setdefault(CHANCE_SIGNATURE, {})[fact, chance] = None
                for modal, holds in (("known", chance == 100), ("possible", chance > 0)):
                    self._rows.setdefault((modal, 1), {}).update({(fact,): None} if holds else {})
                if 0 < chance < 100:
                    self._rows.setdefault(OPEN_SIGNATURE, {})[fact, chance] = None

    def signatures(self) -> dict[Signature, list[FactRow]]:
        """Return the predicates (name, number of arguments) that certainly hold of something, each with its rows."""
        return {signature: list(rows) for signature, rows in self._rows.items()}

    def add_derived(self, signature: Signature, row: FactRow, possible: bool) -> bool:
        """Add a row of a predicate that rules define. Return whether it is new."""
        rows = (self._possible if possible else self._rows).setdefault(signature, {})
        if row in rows or (
            possible and (row in self._rows.get(signature, {}) or self._already_possible(signature, row))
        ):
            return False
        rows[row] = None
        if not possible:
            self._index = {key: index for key, index in self._index.items() if key[0] != signature}
        return True

    def _already_possible(self, signature: Signature, row: FactRow) -> bool:
        """Return whether a row that may hold is covered by one, perhaps with unknown values, that may hold already."""
        return any(
            all(_includes(a, b) for a, b in zip(other, row, strict=True)) for other in self._possible.get(signature, ())
        )

    def rows(
        self, signature: Signature, fixed: Sequence[Value], possible: bool, confidence_fixed: bool
    ) -> Iterator[FactRow]:
        """Yield the rows of a predicate that hold; with `possible`, also those that may hold."""
        stated = list(self._stated(signature, fixed))
        yield from stated
        if not possible:
            return
        yield from list(self._possible.get(signature, ()))
        declared = BELIEF_PREDICATES.get(signature)
        if declared is None:
            return
        if declared.confident and not confidence_fixed:
            for row in self._stated(signature, [*fixed[:-1], None]):
                if 0 < row[-1] < 100:
                    yield (*row[:-1], Unknown(0, 100))
        if declared.long is not None:
            yield from (row[:-1] for row in self._stated(declared.long, [*fixed, None]) if 0 < row[-1] < 100)
        if declared.symmetric:
            yield from self._open_pairs(declared, fixed)
        else:
            yield from self._open_rows(declared.long or signature, declared, fixed[declared.subject])

    def _stated(self, signature: Signature, fixed: Sequence[Value]) -> Iterable[FactRow]:
        """Return the certain rows that agree with the first known argument; all of them when none is known."""
        rows = self._rows.get(signature, {})
        at = next((number for number, value in enumerate(fixed) if value is not None), None)
        if at is None:
            return list(rows)
        index = self._index.get((signature, at))
        if index is None:
            index = self._index[signature, at] = {}
            for row in rows:
                index.setdefault(row[at], []).append(row)
        return index.get(fixed[at], [])

    def _open_pairs(self, declared: BeliefPredicate, fixed: Sequence[Value]) -> Iterator[FactRow]:
        """Yield the rows of a symmetric predicate that may hold for things not seen yet, in either place."""
        for at, other in ((0, 1), (1, 0)):
            is_new = fixed[at] is None or str(fixed[at]) not in self.known_names
            if is_new and not self.everything_seen and str(fixed[other]) not in declared.settled:
                values: list[Value] = [Unknown(*(slot.limits or ())) for slot in declared.arguments]
                values[at] = Unknown(new=True) if fixed[at] is None else fixed[at]
                values[other] = Unknown() if fixed[other] is None else fixed[other]
                yield tuple(values)

    def _open_rows(self, signature: Signature, declared: BeliefPredicate, subject: Value) -> Iterator[FactRow]:
        """Yield the rows that may hold for things not seen yet, and for known things without such a fact."""
        # signature : that of the facts, which have a confidence where the predicate is a short form.
        # subject : None when it is open.
        if declared.open is Openness.NEVER:
            return
        if declared.open is Openness.UNBOUND:
            for name in self._parameters:
                if subject in (None, name) and not self._stated(signature, [name, None]):
                    yield self._row(declared, name)
            return
        if not self.everything_seen and (subject is None or str(subject) not in self.known_names):
            yield self._row(declared, Unknown(new=True))
        if declared.exclusive:
            shares: dict[Value, int] = {}
            for row in self._stated(signature, [subject, *[None] * (signature[1] - 1)]):
                shares[row[declared.subject]] = shares.get(row[declared.subject], 0) + row[-1]
            yield from (self._row(declared, thing) for thing, share in shares.items() if share < 100)
        if declared.open is Openness.UNTOLD:
            for thing in self._objects if subject is None else [subject]:
                known = str(thing) in self.known_names and str(thing) not in declared.settled
                if known and not self._stated(signature, [thing] + [None] * (signature[1] - 1)):
                    yield self._row(declared, thing)

    def _row(self, declared: BeliefPredicate, subject: Value) -> FactRow:
        """Return a row of which only the subject is known; all other values are `Unknown`."""
        values: list[Value] = [Unknown(*(slot.limits or ())) for slot in declared.arguments]
        values[declared.subject] = subject
        return tuple(values)


def _as_symbol(value: Value) -> clingo.Symbol:
    """Return a value as a clingo symbol."""
    return clingo.Number(value) if isinstance(value, int) else value


def _also_said(signature: Signature, row: FactRow) -> Iterator[tuple[Signature, FactRow]]:
    """Yield what a fact says besides: object(N), its short or long form where it is known, itself the other way."""
    declared = BELIEF_PREDICATES.get(signature)
    if declared is None:
        return
    if signature == ("kind", 3) and str(row[1]) == "object":
        yield OBJECT_SIGNATURE, row[:1]
    rows = {signature: row}
    if declared.short and row[-1] == 100:
        rows[signature[0], signature[1] - 1] = row[:-1]
    if declared.long is not None:
        rows[declared.long] = (*row, 100)
    for one, said in rows.items():
        yield one, said
        if declared.symmetric:
            yield one, (said[1], said[0], *said[2:])


def _includes(a: Value, b: Value) -> bool:
    """Return whether the value `a` may be all that `b` may be; equal values include each other."""
    if not isinstance(a, Unknown):
        return not isinstance(b, Unknown) and a == b
    if a.anything:
        return True
    if not isinstance(b, Unknown):
        return compare("=", a, b, frozenset()) is not False
    if a.low is not None and a.high is not None:
        return b.low is not None and b.high is not None and a.low <= b.low and b.high <= a.high
    return b.low is None and not b.anything and (b.new or not a.new)
