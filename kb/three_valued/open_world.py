"""The believed facts, and the facts that may hold besides, as far as the vocabulary leaves a predicate open."""

from collections.abc import Iterable, Iterator

import clingo
from clingo import Number, Symbol

from utak.kb.language.arguments import ArgumentType
from utak.kb.language.vocabulary import (
    BELIEF_PREDICATES,
    PLAN_PREDICATES,
    BeliefPredicate,
    Openness,
    Signature,
    may_be_otherwise,
)
from utak.kb.three_valued.values import NEW, NO_NUMBER, numbers, to_clingo

FactRow = tuple[Symbol, ...]  # the arguments of one fact
# These are about parameters, the plan and squares, not about things.
TASK_SIGNATURES = frozenset({("parameter", 1), ("bound", 2), ("may_be", 3), ("loc", 3), ("loc", 2), *PLAN_PREDICATES})
NEW_THING, FULL_CONFIDENCE = to_clingo(NEW), Number(100)


class Beliefs:
    """The facts of a world model."""

    def __init__(self, facts: Iterable[tuple[str, FactRow]]) -> None:
        self._rows: dict[Signature, dict[FactRow, None]] = {}
        for name, row in facts:
            for signature, said in _all_said((name, len(row)), row):
                self._rows.setdefault(signature, {})[said] = None
        self.known_names = frozenset(
            str(row[declared.subject])
            for signature, declared in BELIEF_PREDICATES.items()
            if signature not in TASK_SIGNATURES
            for row in self.rows(signature)
        )
        self._everything_seen = not any(row[1] > Number(0) for row in self.rows(("unseen", 2)))
        self._things = dict.fromkeys(row[0] for one in ("node", "object") for row in self.rows((one, 1)))
        for (name, arity), rows in list(self._rows.items()):
            declared = BELIEF_PREDICATES.get((name, arity))
            is_unsure = declared is not None and declared.confident
            for row in rows:
                if not is_unsure or may_be_otherwise(name, row[0]):
                    self._state_chance(
                        clingo.Function(name, row[: arity - is_unsure]), row[-1] if is_unsure else FULL_CONFIDENCE
                    )

    def _state_chance(self, fact: Symbol, chance: Symbol) -> None:
        """State chance/2, open/2, known/1 and possible/1 of a fact."""
        share = chance.number
        modal = {"chance": True, "open": 0 < share < 100, "known": share == 100, "possible": share > 0}
        for name, row in zip(modal, ((fact, chance), (fact, chance), (fact,), (fact,)), strict=True):
            if modal[name]:
                self._rows.setdefault((name, len(row)), {})[row] = None

    @property
    def signatures(self) -> dict[Signature, dict[FactRow, None]]:
        """The predicates (name, number of arguments) that certainly hold of something, each with its rows."""
        return self._rows

    def rows(self, signature: Signature) -> Iterable[FactRow]:
        """Return the rows of a predicate that certainly hold."""
        return self._rows.get(signature, ())

    def possible_rows(self, signature: Signature, any_confidence: bool) -> Iterator[FactRow]:
        """Yield the rows of a predicate that may hold, those that do included."""
        # any_confidence : whether a confidence between 0 and 100 may turn out to be any other.
        yield from self.rows(signature)
        declared = BELIEF_PREDICATES.get(signature)
        if declared is None:
            return
        if any_confidence and declared.confident:
            unknown = to_clingo(numbers(0, 100))
            yield from ((*row[:-1], unknown) for row in self.rows(signature) if 0 < row[-1].number < 100)
        if declared.long is not None:
            yield from (row[:-1] for row in self.rows(declared.long) if 0 < row[-1].number < 100)
        if declared.symmetric:
            for other in (NEW_THING, *self._things) if not self._everything_seen else ():
                if str(other) not in declared.settled:
                    rest = [*map(_unknown, declared.arguments[2:])]
                    yield from ((*pair, *rest) for pair in ((NEW_THING, other), (other, NEW_THING)))
        else:
            yield from (
                tuple(thing if at == declared.subject else _unknown(slot) for at, slot in enumerate(declared.arguments))
                for thing in self._open_things(declared.long or signature, declared)
            )

    def _open_things(self, signature: Signature, declared: BeliefPredicate) -> Iterator[Symbol]:
        """Yield the things of which a predicate may hold with any values, one that was not seen yet among them."""
        # signature : that of the facts, which have a confidence where the predicate is a short form.
        told: dict[Symbol, int] = {}
        for row in self.rows(signature):
            thing = row[declared.subject]
            told[thing] = told.get(thing, 0) + (row[-1].number if declared.exclusive else 100)
        if declared.open is Openness.UNBOUND:
            yield from (name for (name,) in self.rows(("parameter", 1)) if name not in told)
        elif declared.open is not Openness.NEVER:
            yield from () if self._everything_seen else (NEW_THING,)
            yield from (thing for thing, share in told.items() if share < 100)
        if declared.open is Openness.UNTOLD:
            yield from (thing for thing in self._things if thing not in told and str(thing) not in declared.settled)


def _unknown(slot: ArgumentType) -> Symbol:
    """Return what stands for a value of a type that is not known."""
    return to_clingo(numbers(*slot.limits) if slot.limits else NO_NUMBER)


def _all_said(signature: Signature, row: FactRow) -> Iterator[tuple[Signature, FactRow]]:
    """Yield a fact and what it says besides: object(N), its short or long form where it is known, the other way."""
    rows = {signature: row}
    if signature == ("kind", 3) and str(row[1]) == "object":
        rows["object", 1] = row[:1]
    declared = BELIEF_PREDICATES.get(signature)
    if declared is not None and declared.short and row[-1] == FULL_CONFIDENCE:
        rows[signature[0], signature[1] - 1] = row[:-1]
    if declared is not None and declared.long is not None:
        rows[declared.long] = (*row, FULL_CONFIDENCE)
    for one, said in rows.items():
        yield one, said
        if declared is not None and declared.symmetric:
            yield one, (said[1], said[0], *said[2:])
