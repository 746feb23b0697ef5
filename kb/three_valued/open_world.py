"""What is believed, and what may hold besides: the rows of each predicate, as far as the vocabulary leaves it open."""

from collections.abc import Iterable, Iterator, Sequence
from typing import Any

from kb.language.vocabulary import BELIEF, BeliefPredicate, Open
from kb.three_valued.uncertain_values import Unknown, Value, compare

Signature = tuple[str, int]
Row = tuple[Value, ...]
OBJECT = ("object", 1)


class Beliefs:
    """The facts of a world model, and what may hold besides.

    names : all names that a fact gives to something. seen : nothing of the table is unseen, so that there is nothing
    new. Predicates that rules derive are added with `derive`.
    """

    def __init__(self, facts: Iterable[tuple[str, Row]]) -> None:
        self.plans: dict[tuple[int, frozenset[str]], Any] = {}  # bodies and their orders (kb.three_valued.evaluation)
        self._rows: dict[Signature, dict[Row, None]] = {}
        self._perhaps: dict[Signature, dict[Row, None]] = {}
        self._index: dict[tuple[Signature, int], dict[Value, list[Row]]] = {}
        for name, row in facts:
            self._rows.setdefault((name, len(row)), {})[row] = None
            if name == "kind" and len(row) == 3 and str(row[1]) == "object":
                self._rows.setdefault(OBJECT, {})[(row[0],)] = None
        self.names = frozenset(
            str(row[declared.subject])
            for signature, declared in BELIEF.items()
            for row in self._rows.get(signature, ())
        )
        counts = [row[1] for row in self._rows.get(("unseen", 2), ())]
        self.seen = not any(isinstance(count, int) and count > 0 for count in counts)
        self._things = sorted(row[0] for row in self._rows.get(OBJECT, ()))

    def signatures(self) -> dict[Signature, list[Row]]:
        """The predicates that facts state, with their rows."""
        return {signature: list(rows) for signature, rows in self._rows.items()}

    def derive(self, signature: Signature, row: Row, possible: bool) -> bool:
        """Add a row of a predicate that rules define; False when it is there already. possible : it only may hold."""
        rows = (self._perhaps if possible else self._rows).setdefault(signature, {})
        if row in rows or (possible and (row in self._rows.get(signature, {}) or self._covered(signature, row))):
            return False
        rows[row] = None
        if not possible:
            self._index = {key: index for key, index in self._index.items() if key[0] != signature}
        return True

    def _covered(self, signature: Signature, row: Row) -> bool:
        """Whether a row with unknown values says no more than one that is there."""
        return any(
            all(_as_wide(a, b) for a, b in zip(other, row, strict=True)) for other in self._perhaps.get(signature, ())
        )

    def rows(self, signature: Signature, fixed: Sequence[Value], possible: bool, now: bool) -> Iterator[Row]:
        """Yield the rows of a predicate that hold, and, where `possible`, those that may.

        fixed : the values of settled arguments, None for others; rows that differ in one of them may be left out.
        now : a confidence is read as it stands.
        """
        stated = list(self._stated(signature, fixed))
        yield from stated
        if not possible:
            return
        yield from list(self._perhaps.get(signature, ()))
        declared = BELIEF.get(signature)
        if declared is None:
            return
        if declared.confident and not now:
            for row in self._stated(signature, [*fixed[:-1], None]):
                if 0 < row[-1] < 100:
                    yield (*row[:-1], Unknown(0, 100))
        yield from self._besides(signature, declared, fixed[declared.subject])

    def _stated(self, signature: Signature, fixed: Sequence[Value]) -> Iterable[Row]:
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

    def _besides(self, signature: Signature, declared: BeliefPredicate, subject: Value) -> Iterator[Row]:
        """Rows that may hold of what was not seen, and of what nothing is told of."""
        if declared.open is Open.NEVER:
            return
        if not self.seen and (subject is None or str(subject) not in self.names):
            yield self._row(declared, Unknown(new=True))
        if declared.open is Open.UNTOLD:
            for thing in self._things if subject is None else [subject]:
                known = str(thing) in self.names and str(thing) not in declared.settled
                if known and not self._stated(signature, [thing] + [None] * (len(declared.arguments) - 1)):
                    yield self._row(declared, thing)

    def _row(self, declared: BeliefPredicate, subject: Value) -> Row:
        """A row of which only the subject is known."""
        values: list[Value] = [Unknown(*(slot.limits or ())) for slot in declared.arguments]
        values[declared.subject] = subject
        return tuple(values)


def _as_wide(a: Value, b: Value) -> bool:
    """Whether value `a` may be all that `b` may."""
    if not isinstance(a, Unknown):
        return not isinstance(b, Unknown) and a == b
    if a.anything:
        return True
    if not isinstance(b, Unknown):
        return compare("=", a, b, frozenset()) is not False
    if a.low is not None and a.high is not None:
        return b.low is not None and b.high is not None and a.low <= b.low and b.high <= a.high
    return b.low is None and not b.anything and (b.new or not a.new)
