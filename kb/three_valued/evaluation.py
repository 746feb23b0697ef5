"""Three-valued evaluation of bodies of rules over what is believed (docs/files.md, Questions, says what it means).

There are two ways to go through a body. The *certain* one yields the bindings for which it holds as things stand, the
*possible* one those for which it may hold besides, once more is known. What `Beliefs` says may still hold is met by
the possible way alone; `not A` is certain when A is not possible, and possible when A is not certain.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import product
from typing import Any

import clingo

from kb.language.integers import MAX_INT32, MIN_INT32
from kb.three_valued.aggregates import Tally
from kb.three_valued.arithmetic import CalculationError, calculate
from kb.three_valued.clauses import (
    Aggregate,
    Always,
    Atom,
    ClauseError,
    Comparison,
    Compound,
    Constant,
    Element,
    Every,
    Literal,
    Operation,
    Term,
    Variable,
    variables_of,
)
from kb.three_valued.join_order import assigned, assignment, planned, unsafe
from kb.three_valued.open_world import Beliefs
from kb.three_valued.uncertain_values import (
    TURNED,
    Truth,
    Unknown,
    Value,
    bounds,
    calculated,
    compare,
    narrowed,
    symbol,
)

Bindings = Mapping[str, Value]
NONE: frozenset[str] = frozenset()


def bindings(
    body: tuple[Literal, ...],
    given: Bindings,
    beliefs: Beliefs,
    possible: bool,
    now: frozenset[str] = NONE,
) -> Iterator[Bindings]:
    """Yield the bindings of variables, those given included, with which all literals of a body hold or may hold.

    now : confidences in these variables are read as they stand, and do not turn out otherwise.
    """
    key = id(body), frozenset(given)
    if key not in beliefs.plans:
        beliefs.plans[key] = body, planned(body, given)  # the body is kept, so that no other one has its number
    order = beliefs.plans[key][1]
    return _Search(beliefs, possible, now).through(order, 0, given)


class _Search:
    """Goes through the literals of a body one after the other."""

    def __init__(self, beliefs: Beliefs, possible: bool, now: frozenset[str]) -> None:
        self.beliefs, self.possible, self.now = beliefs, possible, now

    def through(self, order: Sequence[Literal], at: int, given: Bindings) -> Iterator[Bindings]:
        if at == len(order):
            yield given
            return
        for found in self.meet(order[at], given):
            yield from self.through(order, at + 1, found)

    def meet(self, literal: Literal, given: Bindings) -> Iterator[Bindings]:
        """The bindings with which one literal holds or may hold."""
        if isinstance(literal, Atom):
            if literal.negations == 0:
                yield from self.matches(literal, given, self.possible)
            elif self.passes(self.believed(literal, given)):
                yield given
        elif isinstance(literal, Comparison):
            yield from self.compared(literal, given)
        elif isinstance(literal, Aggregate):
            yield from self.aggregated(literal, given)
        elif isinstance(literal, Every):
            if self.passes(self.every(literal, given)):
                yield given
        elif isinstance(literal, Always) and literal.value:
            yield given

    def passes(self, truth: Truth) -> bool:
        return truth is True or (self.possible and truth is None)

    # ---- atoms ----

    def matches(self, atom: Atom, given: Bindings, possible: bool) -> Iterator[Bindings]:
        """The bindings with which an atom holds, or may hold."""
        fixed = [self.known(part, given) for part in atom.parts]
        for row in self.beliefs.rows(atom.signature, fixed, possible, self.read_now(atom)):
            found = self.unify_all(atom.parts, row, given, possible)
            if found is not None:
                yield found

    def unify_all(
        self, terms: Sequence[Term], row: Sequence[Value], given: Bindings, possible: bool
    ) -> Bindings | None:
        found: Bindings | None = given
        for term, value in zip(terms, row, strict=True):
            if found is not None:
                found = self.unify(term, value, found, possible)
        return found

    def read_now(self, atom: Atom) -> bool:
        return bool(atom.parts) and isinstance(atom.parts[-1], Variable) and atom.parts[-1].name in self.now

    def believed(self, atom: Atom, given: Bindings) -> Truth:
        """Whether an atom with `not` before it holds. A variable `_` in it stands for anything."""
        held = self.holds(atom, given)
        return held if held is None or atom.negations == 2 else not held

    def holds(self, atom: Atom, given: Bindings) -> Truth:
        if next(self.matches(atom, given, False), None) is not None:
            return True
        return None if next(self.matches(atom, given, True), None) is not None else False

    def known(self, term: Term, given: Bindings) -> Value:
        """The value of an argument where it is settled, else None."""
        if set(variables_of(term)) <= given.keys():
            value = self.value(term, given)
            return None if isinstance(value, Unknown) else value
        return None

    def unify(self, term: Term, value: Value, given: Bindings, possible: bool) -> Bindings | None:
        """The bindings with which a term has a value; None when it has not. Unknown values need the possible way."""
        if isinstance(term, Variable):
            before = given.get(term.name)
            if before is None:
                return {**given, term.name: value}
            if not self.same(before, value, possible):
                return None
            if isinstance(before, Unknown) and not isinstance(value, Unknown):
                return {**given, term.name: value}
            return given
        if isinstance(term, Compound):
            return self.unify_compound(term, value, given, possible)
        if isinstance(term, Operation) and not set(variables_of(term)) <= given.keys():
            return self.inverted(term, value, given, possible)
        return given if self.same(self.value(term, given), value, possible) else None

    def same(self, a: Value, b: Value, possible: bool) -> bool:
        truth = compare("=", a, b, self.beliefs.names)
        return truth is True or (possible and truth is None)

    def unify_compound(self, term: Compound, value: Value, given: Bindings, possible: bool) -> Bindings | None:
        if isinstance(value, Unknown):
            return given if possible and value.low is None and not value.new else None
        if isinstance(value, int) or value.type != clingo.SymbolType.Function:
            return None
        if value.name != term.name or len(value.arguments) != len(term.parts):
            return None
        return self.unify_all(term.parts, [plain(inner) for inner in value.arguments], given, possible)

    def inverted(self, term: Operation, value: Value, given: Bindings, possible: bool) -> Bindings | None:
        """Arithmetic with one variable that is not bound, turned round: X in X + 1 from the sum."""
        if not isinstance(value, int | Unknown) or (isinstance(value, Unknown) and value.low is None):
            return None
        if len(term.parts) == 1:
            return self.unify(term.parts[0], calculated("-", value), given, possible)
        left, right = term.parts
        first = set(variables_of(left)) <= given.keys()
        other, pattern = (self.number(left, given), right) if first else (self.number(right, given), left)
        try:
            if term.sign == "+":
                return self.unify(pattern, calculated("-", value, other), given, possible)
            if term.sign == "-":
                back = calculated("-", other, value) if first else calculated("+", value, other)
                return self.unify(pattern, back, given, possible)
            if isinstance(value, Unknown) or isinstance(other, Unknown):
                return self.unify(pattern, calculated("?", value, other), given, possible) if possible else None
            if other == 0 or value % other:
                return None
            return self.unify(pattern, calculate("/", value, other), given, possible)
        except CalculationError:
            return None  # no number of 32 bits gives this value

    # ---- terms ----

    def value(self, term: Term, given: Bindings) -> Value:
        """The value of a term of which all variables are bound."""
        if isinstance(term, Constant):
            return term.value
        if isinstance(term, Variable):
            if term.name not in given:
                raise unsafe(term.name, term.at)
            return given[term.name]
        if isinstance(term, Compound):
            parts = [self.value(part, given) for part in term.parts]
            if any(isinstance(part, Unknown) for part in parts):
                return Unknown()
            return clingo.Function(term.name, [symbol(part) for part in parts])
        numbers = [self.number(part, given) for part in term.parts]
        try:
            return calculated(term.sign, *numbers)
        except CalculationError as error:
            raise ClauseError(f"{error}, in {_told(term.sign, numbers)}", term.at) from None

    def number(self, term: Term, given: Bindings) -> Value:
        value = self.value(term, given)
        if isinstance(value, int | Unknown):
            return value
        raise ClauseError(f"operation undefined: {value} is no number", term.at)

    def interval(self, term: Operation, given: Bindings) -> range | None:
        """The numbers of an interval; None where an end is not known."""
        low, high = (self.number(part, given) for part in term.parts)
        if isinstance(low, Unknown) or isinstance(high, Unknown):
            return None
        return range(low, high + 1)

    # ---- comparisons ----

    def compared(self, literal: Comparison, given: Bindings) -> Iterator[Bindings]:
        found = assignment(literal, set(given))
        if found is not None:
            pattern, source = found
            for value in self.values(source, given):
                bound = self.unify(pattern, value, given, self.possible)
                if bound is not None:
                    yield from self.compared(literal, bound)
            return
        truth = self.comparison(literal, given)
        if self.passes(truth):
            yield self.narrowed(literal, given) if truth is None else given

    def values(self, term: Term, given: Bindings) -> Iterable[Value]:
        if isinstance(term, Operation) and term.sign == "..":
            among = self.interval(term, given)
            return [Unknown(*_ends(term, given, self))] if among is None else among
        return [self.value(term, given)]

    def comparison(self, literal: Comparison, given: Bindings) -> Truth:
        """Whether all pairs of a chain hold; or, negated, whether one does not."""
        truth: Truth = True
        left = literal.first
        for sign, right in literal.rest:
            held = self.pair(sign, left, right, given)
            truth = False if held is False else None if held is None and truth is not False else truth
            left = right
        return truth if not literal.negated or truth is None else not truth

    def pair(self, sign: str, left: Term, right: Term, given: Bindings) -> Truth:
        """Whether an order holds; between intervals, whether it does for some of their numbers."""
        names = self.beliefs.names
        firsts, seconds = self.values(left, given), self.values(right, given)
        pairs = product(_telling(firsts, seconds), _telling(seconds, firsts))
        truths = {compare(sign, a, b, names) for a, b in pairs}
        return True if True in truths else None if None in truths else False

    def narrowed(self, literal: Comparison, given: Bindings) -> Bindings:
        """The bindings, with unknown values narrowed to those with which a comparison may hold."""
        if literal.negated or len(literal.rest) != 1:
            return given
        ((sign, right),) = literal.rest
        found = dict(given)
        for one, way, other in ((literal.first, sign, right), (right, TURNED[sign], literal.first)):
            if isinstance(one, Variable) and isinstance(found[one.name], Unknown) and not _is_interval(other):
                found[one.name] = narrowed(found[one.name], way, self.value(other, found))
        return found

    # ---- aggregates and conditions ----

    def every(self, literal: Every, given: Bindings) -> Truth:
        now = self.now | confidences_read(literal.condition, (literal.literal,))
        truth: Truth = True
        for possible in (False, True):
            for found in bindings(literal.condition, given, self.beliefs, possible, now):
                held, perhaps = (
                    next(_Search(self.beliefs, way, now).meet(literal.literal, found), None) for way in (False, True)
                )
                if held is not None:
                    continue
                if not possible and perhaps is None:
                    return False
                truth = None
        return truth

    def aggregated(self, literal: Aggregate, given: Bindings) -> Iterator[Bindings]:
        outer = set(given)
        tally = Tally(literal.function)
        for element in literal.elements:
            self.counted(element, given, tally)
        variable = None if literal.negated else assigned(literal.guards, outer)
        try:
            value = tally.value()
        except CalculationError as error:
            raise ClauseError(f"{error}, in {literal.function}", literal.at) from None
        if variable is not None and isinstance(value, Unknown) and not self.possible:
            return
        found = given if variable is None else {**given, variable.name: value}
        truth: Truth = True
        for sign, term in literal.guards:
            held = compare(sign, self.value(term, found), value, self.beliefs.names)
            truth = False if held is False else None if held is None and truth is not False else truth
        if self.passes(truth if not literal.negated or truth is None else not truth):
            yield found

    def counted(self, element: Element, given: Bindings, tally: Tally) -> None:
        now = self.now | confidences_read(element.condition, element.terms)
        for possible in (False, True):
            for found in bindings(element.condition, given, self.beliefs, possible, now):
                tally.add(tuple(self.value(term, found) for term in element.terms), possible)


def value_of(term: Term, given: Bindings, beliefs: Beliefs) -> Value:
    """Return the value of a term of which all variables are bound; raises ClauseError where it has none."""
    return _Search(beliefs, True, NONE).value(term, given)


def confidences_read(body: Sequence[Literal], given_out: Any) -> frozenset[str]:
    """Return the variables whose values are given out or held against others: confidences in them are those of now."""
    found = set(variables_of(given_out))
    for literal in body:
        if isinstance(literal, Comparison):
            names = set(variables_of(literal))
            found |= names if len(names) > 1 else set()
    return frozenset(found)


def plain(value: clingo.Symbol) -> Value:
    """Return a value of clingo's as it is held here: numbers are integers."""
    return value.number if value.type == clingo.SymbolType.Number else value


def _telling(values: Iterable[Value], others: Iterable[Value]) -> Iterable[Value]:
    """Of the numbers of an interval those that decide how it compares: its ends, and those of the others within it."""
    if not isinstance(values, range) or not values:
        return values
    if isinstance(others, range):
        edges: list[int] = [others[0], others[-1]] if others else []
    else:
        edges = [edge for other in others for edge in _edges(other)]
    return sorted({values[0], values[-1], *(edge for edge in edges if edge in values)})


def _edges(value: Value) -> list[int]:
    """A number, or the bounds of one that is not known."""
    if isinstance(value, Unknown):
        return [edge for edge in (value.low, value.high) if edge is not None]
    return [value] if isinstance(value, int) else []


def _is_interval(term: Term) -> bool:
    return isinstance(term, Operation) and term.sign == ".."


def _ends(term: Operation, given: Bindings, search: _Search) -> tuple[int, int]:
    """The bounds of the numbers of an interval of which an end is not known."""
    low, high = (bounds(search.number(part, given)) or (MIN_INT32, MAX_INT32) for part in term.parts)
    return low[0], high[1]


def _told(sign: str, numbers: Sequence[Value]) -> str:
    """A calculation as a message shows it."""
    shown = ["?" if isinstance(number, Unknown) else str(number) for number in numbers]
    return f" {sign} ".join(shown) if len(shown) == 2 else f"|{shown[0]}|" if sign == "|" else f"{sign}{shown[0]}"
