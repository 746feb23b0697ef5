"""Three-valued evaluation of rule bodies over the believed facts (docs/files.md, Questions, defines the meaning).

A body is searched in one of two modes. The *certain* mode yields the bindings for which the body holds by the facts as
they are believed now. The *possible* mode yields those for which it may hold once more is known; only this mode reads
the facts that `Beliefs` leaves open. `not A` is certain when A is not possible, and possible when A is not
certain.
"""

from collections.abc import Iterator, Sequence
from itertools import product
from typing import Any

import clingo

from utak.kb.three_valued.aggregates import Tally
from utak.kb.three_valued.arithmetic import CalculationError, calculate
from utak.kb.three_valued.clauses import (
    Aggregate,
    AggregateElement,
    Atom,
    BooleanLiteral,
    ClauseError,
    ClauseTerm,
    Comparison,
    Compound,
    ConditionalLiteral,
    Literal,
    Operation,
    Variable,
    variables_of,
)
from utak.kb.three_valued.join_order import assigned_variable, assignment, order_literals
from utak.kb.three_valued.open_world import Beliefs
from utak.kb.three_valued.term_values import (
    Bindings,
    deciding_numbers,
    from_clingo,
    is_interval,
    number_of,
    value_of,
    values_of,
)
from utak.kb.three_valued.uncertain_values import (
    MIRRORED_SIGNS,
    TruthValue,
    Unknown,
    Value,
    calculate_uncertain,
    compare,
    narrow,
)

NO_VARIABLES: frozenset[str] = frozenset()  # no confidence is fixed


def find_bindings(
    body: tuple[Literal, ...],
    given: Bindings,
    beliefs: Beliefs,
    possible: bool,
    fixed_confidences: frozenset[str] = NO_VARIABLES,
) -> Iterator[Bindings]:
    """Yield the bindings of variables with which all literals of a body hold, or may hold."""
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
        """Yield the bindings, `given` included, with which the literals from index `at` on hold or may hold."""
        if at == len(order):
            yield given
            return
        for found in self.satisfy(order[at], given):
            yield from self.search(order, at + 1, found)

    def satisfy(self, literal: Literal, given: Bindings) -> Iterator[Bindings]:
        """Yield the bindings, `given` included, with which one literal holds or may hold."""
        # One for each way to satisfy an atom or an assignment `X = ...`; at most one, for any other literal.
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
        """Return whether a truth value suffices in this mode: True always, None (not known) in the possible mode."""
        return truth is True or (self.possible and truth is None)

    # ---- atoms ----

    def matches(self, atom: Atom, given: Bindings, possible: bool) -> Iterator[Bindings]:
        """Yield the bindings, `given` included, with which an atom without negation holds."""
        fixed = [self.settled_value(part, given) for part in atom.parts]
        for row in self.beliefs.rows(atom.signature, fixed, possible, self.reads_fixed_confidence(atom)):
            found = self.unify_all(atom.parts, row, given, possible)
            if found is not None:
                yield found

    def unify_all(
        self, terms: Sequence[ClauseTerm], row: Sequence[Value], given: Bindings, possible: bool
    ) -> Bindings | None:
        """Return the bindings, `given` included, with which all terms have the values of a row."""
        # None when there are none.
        found: Bindings | None = given
        for term, value in zip(terms, row, strict=True):
            if found is not None:
                found = self.unify(term, value, found, possible)
        return found

    def reads_fixed_confidence(self, atom: Atom) -> bool:
        """Return whether an atom's last argument is a variable for a confidence that is read as it is believed now."""
        return (
            bool(atom.parts) and isinstance(atom.parts[-1], Variable) and atom.parts[-1].name in self.fixed_confidences
        )

    def truth_of_negated(self, atom: Atom, given: Bindings) -> TruthValue:
        """Return the truth of the literal `not atom`, or `not not atom` (by `atom.negations`); None when not known."""
        held = self.truth_of_atom(atom, given)
        return held if held is None or atom.negations == 2 else not held

    def truth_of_atom(self, atom: Atom, given: Bindings) -> TruthValue:
        """Return whether an atom, its negations left out, holds for some values of its unbound variables."""
        # None when that is not known.
        if next(self.matches(atom, given, False), None) is not None:
            return True
        return None if next(self.matches(atom, given, True), None) is not None else False

    def settled_value(self, term: ClauseTerm, given: Bindings) -> Value:
        """Return the value of an argument; None when a variable in it is unbound, or its value is not known."""
        if set(variables_of(term)) <= given.keys():
            value = value_of(term, given)
            return None if isinstance(value, Unknown) else value
        return None

    def unify(self, term: ClauseTerm, value: Value, given: Bindings, possible: bool) -> Bindings | None:
        """Return the bindings with which a term has a value; None when there are none."""
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
        return given if self.may_equal(value_of(term, given), value, possible) else None

    def may_equal(self, a: Value, b: Value, possible: bool) -> bool:
        """Return whether two values are certainly equal; with `possible`, whether they may be equal."""
        truth = compare("=", a, b, self.beliefs.known_names)
        return truth is True or (possible and truth is None)

    def unify_compound(self, term: Compound, value: Value, given: Bindings, possible: bool) -> Bindings | None:
        """Return the bindings, `given` included, with which a term with arguments has a value."""
        # None when there are none.
        if isinstance(value, Unknown):
            return given if possible and value.low is None and not value.new else None
        if isinstance(value, int) or value.type != clingo.SymbolType.Function:
            return None
        if value.name != term.name or len(value.arguments) != len(term.parts):
            return None
        return self.unify_all(term.parts, [from_clingo(inner) for inner in value.arguments], given, possible)

    def unify_inverse(self, term: Operation, value: Value, given: Bindings, possible: bool) -> Bindings | None:
        """Return the bindings with which arithmetic with one unbound variable has a value; None when there are none."""
        if not isinstance(value, int | Unknown) or (isinstance(value, Unknown) and value.low is None):
            return None
        if len(term.parts) == 1:
            return self.unify(term.parts[0], calculate_uncertain("-", value), given, possible)
        left, right = term.parts
        first = set(variables_of(left)) <= given.keys()
        other, pattern = (number_of(left, given), right) if first else (number_of(right, given), left)
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

    # ---- comparisons ----

    def satisfy_comparison(self, literal: Comparison, given: Bindings) -> Iterator[Bindings]:
        """Yield the bindings, `given` included, with which a comparison holds or may hold; `X = term` binds X."""
        found = assignment(literal, set(given))
        if found is not None:
            pattern, source = found
            for value in values_of(source, given):
                bound = self.unify(pattern, value, given, self.possible)
                if bound is not None:
                    yield from self.satisfy_comparison(literal, bound)
            return
        truth = self.truth_of_comparison(literal, given)
        if self.passes(truth):
            yield self.narrow_bindings(literal, given) if truth is None else given

    def truth_of_comparison(self, literal: Comparison, given: Bindings) -> TruthValue:
        """Return whether all comparisons of a chain hold; when the chain is negated, whether one does not."""
        # None when that is not known.
        terms = [literal.first, *(term for _, term in literal.rest)]
        pairs = zip(terms, literal.rest, strict=False)
        return truth_of_all([self.truth_of_pair(sign, left, right, given) for left, (sign, right) in pairs], literal)

    def truth_of_pair(self, sign: str, left: ClauseTerm, right: ClauseTerm, given: Bindings) -> TruthValue:
        """Return the truth of one comparison; between intervals, whether it holds for some of their numbers."""
        # None when it is not known.
        names = self.beliefs.known_names
        firsts, seconds = values_of(left, given), values_of(right, given)
        pairs = product(deciding_numbers(firsts, seconds), deciding_numbers(seconds, firsts))
        truths = {compare(sign, a, b, names) for a, b in pairs}
        return True if True in truths else None if None in truths else False

    def narrow_bindings(self, literal: Comparison, given: Bindings) -> Bindings:
        """Return the bindings with unknown values narrowed to those for which a comparison may hold."""
        if literal.negated or len(literal.rest) != 1:
            return given
        ((sign, right),) = literal.rest
        found = dict(given)
        for one, way, other in ((literal.first, sign, right), (right, MIRRORED_SIGNS[sign], literal.first)):
            if isinstance(one, Variable) and isinstance(found[one.name], Unknown) and not is_interval(other):
                found[one.name] = narrow(found[one.name], way, value_of(other, found))
        return found

    # ---- aggregates and conditions ----

    def truth_of_conditional(self, literal: ConditionalLiteral, given: Bindings) -> TruthValue:
        """Return whether the literal holds wherever the condition holds; None when that is not known."""
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
        """Yield the bindings, `given` included, with which an aggregate holds or may hold."""
        # A guard `X = ...` binds X.
        # At most one is yielded; in the certain mode none where the value that X would get is not certain. Raises
        # ClauseError for a value beyond 32 bits.
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
        names = self.beliefs.known_names
        truths = [compare(sign, value_of(term, found), value, names) for sign, term in literal.guards]
        if self.passes(truth_of_all(truths, literal)):
            yield found

    def count_element(self, element: AggregateElement, given: Bindings, tally: Tally) -> None:
        """Add to `tally` the tuples of one element of an aggregate: certain ones, and those that only may be there."""
        fixed_confidences = self.fixed_confidences | fixed_confidence_variables(element.condition, element.terms)
        for possible in (False, True):
            for found in find_bindings(element.condition, given, self.beliefs, possible, fixed_confidences):
                tally.add(tuple(value_of(term, found) for term in element.terms), possible)


def truth_of_all(truths: Sequence[TruthValue], literal: Comparison | Aggregate) -> TruthValue:
    """Return whether all of some truths hold; when the literal is negated, whether one does not."""
    truth = False if False in truths else None if None in truths else True
    return truth if not literal.negated or truth is None else not truth


def fixed_confidence_variables(body: Sequence[Literal], given_out: Any) -> frozenset[str]:
    """Return the names of the variables that are passed on, or compared with other variables."""
    found = set(variables_of(given_out))
    for literal in body:
        if isinstance(literal, Comparison):
            names = set(variables_of(literal))
            found |= names if len(names) > 1 else set()
    return frozenset(found)
