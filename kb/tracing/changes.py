"""The smallest changes of the input facts with which a wanted atom holds: facts given besides, and facts taken away.

Where no choice is involved, clingo itself finds a change of least size. Where costs decide what is chosen, all changes
of a size are tried while they are few: the atom holds after a change when the best answer with it costs no more than
the best one. Beyond that, changes of what the wanted atom is about are tried, and then facts are taken away one after
the other, each time the one that brings the atom nearest to being chosen.
"""

from collections.abc import Iterable, Iterator, Sequence
from itertools import combinations, islice
from math import comb
from typing import NamedTuple

import clingo

from utak.kb.tracing.candidates import CandidateFacts
from utak.kb.tracing.switches import MAX_CHANGE_SIZE, FactChange, SwitchedProgram
from utak.kb.tracing.syntax import ParsedProgram

MAX_CHECKS = 400  # changes that are tried size by size; a convention, about a second
MAX_NEAR_CHECKS = 100  # changes of what the wanted atom is about, of each size; a convention
MAX_GREEDY_CHECKS = 300  # changes that are tried while facts are taken away one after the other; a convention


class FoundChange(NamedTuple):
    """A change of the input facts after which the wanted atom holds, or none."""

    missing: tuple[str, ...]  # facts that must be given besides
    in_way: tuple[str, ...]  # given facts that must be taken away
    found: bool  # whether there is such a change; else both are ()
    least: bool  # whether no change of fewer facts among the candidates would do


def least_change(
    program: ParsedProgram, facts: Sequence[str], candidates: CandidateFacts, wanted: clingo.Symbol
) -> FoundChange:
    """Return a change of least size with which the wanted atom holds, as far as the limits of the search allow."""
    switched = SwitchedProgram(program, facts, candidates, wanted)
    if not candidates.by_choice:
        return _as_found(switched, switched.least_of_one_answer(), True)
    possible = switched.least_possible()
    if possible is None:
        return _as_found(switched, None, True)
    return _ChoiceSearch(switched, wanted, possible).least_change()


class _ChoiceSearch:
    """A search for changes where costs decide."""

    def __init__(self, switched: SwitchedProgram, wanted: clingo.Symbol, possible: FactChange) -> None:
        self.switched, self.wanted, self.possible = switched, wanted, possible
        self._about = self._switches_about()

    def least_change(self) -> FoundChange:
        """Return a change of least size, or a small one when the search is cut off."""
        size = len(self.possible)
        count = len(self.switched.removable) + len(self.switched.addable)
        while size <= MAX_CHANGE_SIZE and self.switched.checks + comb(count, size) <= MAX_CHECKS:
            found = self._first_that_holds(self._changes_of_size(size, count))
            if found is not None:
                return _as_found(self.switched, found, True)
            size += 1
        for options in (self._extensions(), self._replacements()):
            found = self._first_that_holds(islice(options, MAX_NEAR_CHECKS))
            if found is not None:
                found = self._without_idle_parts(found)
                return _as_found(self.switched, found, len(found) <= size)
        found = self._greedy()
        return _as_found(self.switched, found, found is not None and len(found) <= size, gave_up=True)

    def _first_that_holds(self, options: Iterable[FactChange]) -> FactChange | None:
        """Return the first change after which the wanted atom is part of a best answer; None when none is."""
        return next((change for change in options if self._holds(change)), None)

    def _holds(self, change: FactChange) -> bool:
        """Return whether the wanted atom is part of some best answer after a change."""
        excess = self.switched.excess(change)
        return excess is not None and not any(excess)

    def _changes_of_size(self, size: int, count: int) -> Iterator[FactChange]:
        """Yield the changes of a size: those that only take facts away, and for two those that replace one, first."""
        seen = dict.fromkeys(combinations(range(len(self.switched.removable)), size))
        yield from seen
        if size == 2:
            near = [pair for pair in self._pairs() if pair not in seen]
            yield from near
            seen |= dict.fromkeys(near)
        yield from (change for change in combinations(range(count), size) if change not in seen)

    def _switches_about(self) -> list[int]:
        """Return the switches of facts that name an argument of the wanted atom, or have no arguments."""
        about = set(self.wanted.arguments)
        facts = [clingo.parse_term(fact) for fact in (*self.switched.removable, *self.switched.addable)]
        return [n for n, fact in enumerate(facts) if not fact.arguments or about.intersection(fact.arguments)]

    def _extensions(self) -> Iterator[FactChange]:
        """Yield the least possible change with one more switch: all removals, then candidates about the wanted atom."""
        removals = range(len(self.switched.removable))
        options = [*removals, *(index for index in self._about if index not in removals)]
        yield from (_joined(self.possible, (index,)) for index in options if index not in self.possible)

    def _replacements(self) -> Iterator[FactChange]:
        """Yield the least possible change with one more given fact about the wanted atom replaced."""
        about = set(self._about)
        for gone, added in self._pairs():
            if gone in about and added in about and not {gone, added} & set(self.possible):
                yield _joined(self.possible, (gone, added))

    def _pairs(self) -> Iterator[FactChange]:
        """Yield the pairs of a given fact and a candidate that differ in one argument."""
        gone = [clingo.parse_term(fact) for fact in self.switched.removable]
        for index, text in enumerate(self.switched.addable):
            added = clingo.parse_term(text)
            for number, fact in enumerate(gone):
                if fact.name == added.name and len(fact.arguments) == len(added.arguments):
                    pairs = zip(fact.arguments, added.arguments, strict=True)
                    if sum(one != other for one, other in pairs) == 1:
                        yield number, len(gone) + index

    def _greedy(self) -> FactChange | None:
        """Return a change found by taking away the fact that helps most, again and again; None when that fails."""
        change, limit = self.possible, self.switched.checks + MAX_GREEDY_CHECKS
        best = self.switched.excess(change)
        while best is not None and any(best):
            helped: tuple[tuple[int, ...], FactChange] | None = None
            for index in range(len(self.switched.removable)):
                if index in change:
                    continue
                if self.switched.checks >= limit:
                    return None
                longer = _joined(change, (index,))
                excess = self.switched.excess(longer)
                if excess is not None and (helped is None or excess < helped[0]):
                    helped = excess, longer
            if helped is None or helped[0] > best:
                return None
            best, change = helped
        return None if best is None else self._without_idle_parts(change)

    def _without_idle_parts(self, change: FactChange) -> FactChange:
        """Return a change of which no member can be left out."""
        for index in change:
            fewer = tuple(other for other in change if other != index)
            if self._holds(fewer):
                change = fewer
        return change


def _joined(change: FactChange, more: FactChange) -> FactChange:
    """Return two changes as one."""
    return tuple(sorted({*change, *more}))


def _as_found(switched: SwitchedProgram, change: FactChange | None, least: bool, gave_up: bool = False) -> FoundChange:
    """Return a change as facts; for None that there is none, or that the search gave up."""
    if change is None:
        return FoundChange((), (), False, not gave_up)
    count = len(switched.removable)
    in_way = tuple(sorted(switched.removable[index] for index in change if index < count))
    missing = tuple(sorted(switched.addable[index - count] for index in change if index >= count))
    return FoundChange(missing, in_way, True, least)
