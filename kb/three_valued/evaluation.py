"""Three-valued evaluation of rule bodies over the believed facts (docs/files.md, Questions, defines the meaning).

A body is searched in one of two modes. The *certain* mode yields the bindings for which the body holds by the facts as
they are believed now. The *possible* mode yields those for which it may hold once more is known; only this mode reads
the facts that `Beliefs` leaves open. `not A` is certain when A is not possible, and possible when A is not
certain.
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
    AggregateElement,
    Atom,
    BooleanLiteral,
    ClauseError,
    ClauseTerm,
    Comparison,
    Compound,
    ConditionalLiteral,
    Constant,
    Literal,
    Operation,
    Variable,
    variables_of,
)
from kb.three_valued.join_order import assigned_variable, assignment, order_literals, unsafe_variable_error
from kb.three_valued.open_world import Beliefs
from kb.three_valued.uncertain_values import (
    MIRRORED_SIGNS,
    TruthValue,
    Unknown,
    Value,
    as_clingo,
    bounds,
    calculate_uncertain,
    compare,
    narrow,
)

Bindings = Mapping[str, Value]
NO_VARIABLES: frozenset[str] = frozenset()


def find_bindings(
    body: tuple[Literal, ...],
    given: Bindings,
    beliefs: Beliefs,
    possible: bool,
    fixed_confidences: frozenset[str] = NO_VARIABLES,
) -> Iterator[Bindings]:
    """Yield the bindings of variables with which all literals of a body hold, or may hold.

    Parameters
    ----------
    body : the literals.
    given : the values of variables that are bound already.
    beliefs : the believed facts.
    possible : whether to use the possible mode.
    fixed_confidences : variables for confidences that are read as they are believed now, and not as they may turn out.

    Yields
    ------
    The values of all variables, those of `given` included.

    Raises
    ------
    ClauseError : nothing binds a variable, or arithmetic has no result.
    """
    key = id(body), frozenset(given)
    if key not in beliefs.join_orders:
        # The body is kept, too: as long as it exists, no other body has its id.
        beliefs.join_orders[key] = body, order_literals(body, given)
    order = beliefs.join_orders[key][1]
    return _Search(beliefs, possible, fixed_confidences).search(order, 0, given)


class _Search:
    """A search through the literals of a body, one after the other."""

    def __init__(self, beliefs: Beliefs, possible: bool, fixed_confidences: frozenset[str]) -> None:
        self.beliefs, self.possible, self.fixed_confidences = beliefs, possible, fixed_confidences

    def search(self, order: Sequence[Literal], at: int, given: Bindings) -> Iterator[Bindings]:
        """Yield the bindings with which the literals from index `at` on hold or may hold."""
        if at == len(order):
            yield given
            return
        for found in self.satisfy(order[at], given):
            yield from self.search(order, at + 1, found)

    def satisfy(self, literal: Literal, given: Bindings) -> Iterator[Bindings]:
        """Yield the bindings with which one literal holds or may hold."""
        if isinstance(literal, Atom):
            if literal.negations == 0:
                yield from self.matches(literal, given, self.possible)
            elif self.passes(self.truth_of_negated(literal, given)):
                yield given
        elif isinstance(literal, Comparison):
            yield from self.satisfy_comparison(literal, given)
        elif isinstance(literal, Aggregate):
            yield from self.satisfy_aggregate(literal, given)
        elif isinstance(literal, ConditionalLiteral):
            if self.passes(self.truth_of_conditional(literal, given)):
                yield given
        elif isinstance(literal, BooleanLiteral) and literal.value:
            yield given

    def passes(self, truth: TruthValue) -> bool:
        """Return whether a truth value suffices in this mode."""
        return truth is True or (self.possible and truth is None)

    # ---- atoms ----

    def matches(self, atom: Atom, given: Bindings, possible: bool) -> Iterator[Bindings]:
        """Yield the bindings with which an atom without negation holds, or may hold."""
        fixed = [self.settled_value(part, given) for part in atom.parts]
        for row in self.beliefs.rows(atom.signature, fixed, possible, self.reads_fixed_confidence(atom)):
            found = self.unify_all(atom.parts, row, given, possible)
            if found is not None:
                yield found

    def unify_all(
        self, terms: Sequence[ClauseTerm], row: Sequence[Value], given: Bindings, possible: bool
    ) -> Bindings | None:
        """Return the bindings with which all terms have the values of a row; None when there are none."""
        found: Bindings | None = given
        for term, value in zip(terms, row, strict=True):
            if found is not None:
                found = self.unify(term, value, found, possible)
        return found

    def reads_fixed_confidence(self, atom: Atom) -> bool:
        """Return whether the last argument is a variable for a confidence that is read as it is believed now."""
        return (
            bool(atom.parts) and isinstance(atom.parts[-1], Variable) and atom.parts[-1].name in self.fixed_confidences
        )

    def truth_of_negated(self, atom: Atom, given: Bindings) -> TruthValue:
        """Return the truth of an atom with `not` before it. A variable `_` in it matches anything."""
        held = self.truth_of_atom(atom, given)
        return held if held is None or atom.negations == 2 else not held

    def truth_of_atom(self, atom: Atom, given: Bindings) -> TruthValue:
        """Return whether an atom holds for some values of its unbound variables; None when that is not known."""
        if next(self.matches(atom, given, False), None) is not None:
            return True
        return None if next(self.matches(atom, given, True), None) is not None else False

    def settled_value(self, term: ClauseTerm, given: Bindings) -> Value:
        """Return the value of an argument; None when it is unbound or not known."""
        if set(variables_of(term)) <= given.keys():
            value = self.value(term, given)
            return None if isinstance(value, Unknown) else value
        return None

    def unify(self, term: ClauseTerm, value: Value, given: Bindings, possible: bool) -> Bindings | None:
        """Return the bindings with which a term has a value; None when there are none.

        A value that is not known matches in the possible mode only.
        """
        if isinstance(term, Variable):
            before = given.get(term.name)
            if before is None:
                return {**given, term.name: value}
            if not self.may_equal(before, value, possible):
                return None
            if isinstance(before, Unknown) and not isinstance(value, Unknown):
                return {**given, term.name: value}
            return given
        if isinstance(term, Compound):
            return self.unify_compound(term, value, given, possible)
        if isinstance(term, Operation) and not set(variables_of(term)) <= given.keys():
            return self.unify_inverse(term, value, given, possible)
        return given if self.may_equal(self.value(term, given), value, possible) else None

    def may_equal(self, a: Value, b: Value, possible: bool) -> bool:
        """Return whether two values are equal; in the possible mode, whether they may be equal."""
        truth = compare("=", a, b, self.beliefs.known_names)
        return truth is True or (possible and truth is None)

    def unify_compound(self, term: Compound, value: Value, given: Bindings, possible: bool) -> Bindings | None:
        """Return the bindings with which a term with arguments has a value; None when there are none."""
        if isinstance(value, Unknown):
            return given if possible and value.low is None and not value.new else None
        if isinstance(value, int) or value.type != clingo.SymbolType.Function:
            return None
        if value.name != term.name or len(value.arguments) != len(term.parts):
            return None
        return self.unify_all(term.parts, [from_clingo(inner) for inner in value.arguments], given, possible)

    def unify_inverse(self, term: Operation, value: Value, given: Bindings, possible: bool) -> Bindings | None:
        """Return the bindings with which arithmetic with one unbound variable has a value; None when there are none.

        The arithmetic is inverted: X in `X + 1` is computed from the sum.
        """
        if not isinstance(value, int | Unknown) or (isinstance(value, Unknown) and value.low is None):
            return None
        if len(term.parts) == 1:
            return self.unify(term.parts[0], calculate_uncertain("-", value), given, possible)
        left, right = term.parts
        first = set(variables_of(left)) <= given.keys()
        other, pattern = (self.number(left, given), right) if first else (self.number(right, given), left)
        try:
            if term.sign == "+":
                return self.unify(pattern, calculate_uncertain("-", value, other), given, possible)
            if term.sign == "-":
                back = calculate_uncertain("-", other, value) if first else calculate_uncertain("+", value, other)
                return self.unify(pattern, back, given, possible)
            if isinstance(value, Unknown) or isinstance(other, Unknown):
                return (
                    self.unify(pattern, calculate_uncertain("?", value, other), given, possible) if possible else None
                )
            if other == 0 or value % other:
                return None
            return self.unify(pattern, calculate("/", value, other), given, possible)
        except CalculationError:
            return None  # no 32-bit integer solves the equation

    # ---- terms ----

    def value(self, term: ClauseTerm, given: Bindings) -> Value:
        """Return the value of a term whose variables are all bound."""
        if isinstance(term, Constant):
            return term.value
        if isinstance(term, Variable):
            if term.name not in given:
                raise unsafe_variable_error(term.name, term.at)
            return given[term.name]
        if isinstance(term, Compound):
            parts = [self.value(part, given) for part in term.parts]
            if any(isinstance(part, Unknown) for part in parts):
                return Unknown()
            return clingo.Function(term.name, [as_clingo(part) for part in parts])
        numbers = [self.number(part, given) for part in term.parts]
        try:
            return calculate_uncertain(term.sign, *numbers)
        except CalculationError as error:
            raise ClauseError(f"{error}, in {_calculation_text(term.sign, numbers)}", term.at) from None

    def number(self, term: ClauseTerm, given: Bindings) -> Value:
        """Return the value of a term that must be a number, known or not."""
        value = self.value(term, given)
        if isinstance(value, int | Unknown):
            return value
        raise ClauseError(f"operation undefined: {value} is no number", term.at)

    def interval(self, term: Operation, given: Bindings) -> range | None:
        """Return the numbers of an interval; None when an end is not known."""
        low, high = (self.number(part, given) for part in term.parts)
        if isinstance(low, Unknown) or isinstance(high, Unknown):
            return None
        return range(low, high + 1)

    # ---- comparisons ----

    def satisfy_comparison(self, literal: Comparison, given: Bindings) -> Iterator[Bindings]:
        """Yield the bindings with which a comparison holds or may hold; `X = term` binds X."""
        found = assignment(literal, set(given))
        if found is not None:
            pattern, source = found
            for value in self.values(source, given):
                bound = self.unify(pattern, value, given, self.possible)
                if bound is not None:
                    yield from self.satisfy_comparison(literal, bound)
            return
        truth = self.truth_of_comparison(literal, given)
        if self.passes(truth):
            yield self.narrow_bindings(literal, given) if truth is None else given

    def values(self, term: ClauseTerm, given: Bindings) -> Iterable[Value]:
        """Return the values of a term: all numbers of an interval, or one value."""
        if isinstance(term, Operation) and term.sign == "..":
            among = self.interval(term, given)
            return [Unknown(*_ends(term, given, self))] if among is None else among
        return [self.value(term, given)]

    def truth_of_comparison(self, literal: Comparison, given: Bindings) -> TruthValue:
        """Return whether all comparisons of a chain hold; when the chain is negated, whether one does not."""
        truth: TruthValue = True
        left = literal.first
        for sign, right in literal.rest:
            held = self.truth_of_pair(sign, left, right, given)
            truth = False if held is False else None if held is None and truth is not False else truth
            left = right
        return truth if not literal.negated or truth is None else not truth

    def truth_of_pair(self, sign: str, left: ClauseTerm, right: ClauseTerm, given: Bindings) -> TruthValue:
        """Return the truth of one comparison; between intervals, whether it holds for some of their numbers."""
        names = self.beliefs.known_names
        firsts, seconds = self.values(left, given), self.values(right, given)
        pairs = product(_telling(firsts, seconds), _telling(seconds, firsts))
        truths = {compare(sign, a, b, names) for a, b in pairs}
        return True if True in truths else None if None in truths else False

    def narrow_bindings(self, literal: Comparison, given: Bindings) -> Bindings:
        """Return the bindings with unknown values narrowed to those for which a comparison may hold."""
        if literal.negated or len(literal.rest) != 1:
            return given
        ((sign, right),) = literal.rest
        found = dict(given)
        for one, way, other in ((literal.first, sign, right), (right, MIRRORED_SIGNS[sign], literal.first)):
            if isinstance(one, Variable) and isinstance(found[one.name], Unknown) and not _is_interval(other):
                found[one.name] = narrow(found[one.name], way, self.value(other, found))
        return found

    # ---- aggregates and conditions ----

    def truth_of_conditional(self, literal: ConditionalLiteral, given: Bindings) -> TruthValue:
        """Return whether the literal holds wherever the condition holds."""
        fixed_confidences = self.fixed_confidences | fixed_confidence_variables(literal.condition, (literal.literal,))
        truth: TruthValue = True
        for possible in (False, True):
            for found in find_bindings(literal.condition, given, self.beliefs, possible, fixed_confidences):
                held, perhaps = (
                    next(_Search(self.beliefs, way, fixed_confidences).satisfy(literal.literal, found), None)
                    for way in (False, True)
                )
                if held is not None:
                    continue
                if not possible and perhaps is None:
                    return False
                truth = None
        return truth

    def satisfy_aggregate(self, literal: Aggregate, given: Bindings) -> Iterator[Bindings]:
        """Yield the bindings with which an aggregate holds or may hold; a guard `X = ...` binds X."""
        outer = set(given)
        tally = Tally(literal.function)
        for element in literal.elements:
            self.count_element(element, given, tally)
        variable = None if literal.negated else assigned_variable(literal.guards, outer)
        try:
            value = tally.value()
        except CalculationError as error:
            raise ClauseError(f"{error}, in {literal.function}", literal.at) from None
        if variable is not None and isinstance(value, Unknown) and not self.possible:
            return
        found = given if variable is None else {**given, variable.name: value}
        truth: TruthValue = True
        for sign, term in literal.guards:
            held = compare(sign, self.value(term, found), value, self.beliefs.known_names)
            truth = False if held is False else None if held is None and truth is not False else truth
        if self.passes(truth if not literal.negated or truth is None else not truth):
            yield found

    def count_element(self, element: AggregateElement, given: Bindings, tally: Tally) -> None:
        """Add to a tally the tuples of one element, certain and possible ones."""
        fixed_confidences = self.fixed_confidences | fixed_confidence_variables(element.condition, element.terms)
        for possible in (False, True):
            for found in find_bindings(element.condition, given, self.beliefs, possible, fixed_confidences):
                tally.add(tuple(self.value(term, found) for term in element.terms), possible)


def value_of(term: ClauseTerm, given: Bindings, beliefs: Beliefs) -> Value:
    """Return the value of a term whose variables are all bound; raise ClauseError when it has none."""
    return _Search(beliefs, True, NO_VARIABLES).value(term, given)


def fixed_confidence_variables(body: Sequence[Literal], given_out: Any) -> frozenset[str]:
    """Return the variables that are passed on, or compared with other variables.

    A confidence in such a variable is read as it is believed now: it is a value to report, not a condition that may
    change.

    body : the literals. given_out : terms whose values are reported.
    """
    found = set(variables_of(given_out))
    for literal in body:
        if isinstance(literal, Comparison):
            names = set(variables_of(literal))
            found |= names if len(names) > 1 else set()
    return frozenset(found)


def from_clingo(value: clingo.Symbol) -> Value:
    """Return a clingo symbol as a value: numbers become Python integers."""
    return value.number if value.type == clingo.SymbolType.Number else value


def _telling(values: Iterable[Value], others: Iterable[Value]) -> Iterable[Value]:
    """Return those numbers of an interval that decide how it compares with other values.

    These are its ends, and the ends of the other values that lie within it. Other values are returned as they are.
    """
    if not isinstance(values, range) or not values:
        return values
    if isinstance(others, range):
        edges: list[int] = [others[0], others[-1]] if others else []
    else:
        edges = [edge for other in others for edge in _edges(other)]
    return sorted({values[0], values[-1], *(edge for edge in edges if edge in values)})


def _edges(value: Value) -> list[int]:
    """Return a number, or the bounds of a number that is not known, in a list."""
    if isinstance(value, Unknown):
        return [edge for edge in (value.low, value.high) if edge is not None]
    return [value] if isinstance(value, int) else []


def _is_interval(term: ClauseTerm) -> bool:
    """Return whether a term is an interval."""
    return isinstance(term, Operation) and term.sign == ".."


def _ends(term: Operation, given: Bindings, search: _Search) -> tuple[int, int]:
    """Return the least and the greatest number of an interval whose ends are not both known."""
    low, high = (bounds(search.number(part, given)) or (MIN_INT32, MAX_INT32) for part in term.parts)
    return low[0], high[1]


def _calculation_text(sign: str, numbers: Sequence[Value]) -> str:
    """Return a calculation as messages show it."""
    shown = ["?" if isinstance(number, Unknown) else str(number) for number in numbers]
    return f" {sign} ".join(shown) if len(shown) == 2 else f"|{shown[0]}|" if sign == "|" else f"{sign}{shown[0]}"
