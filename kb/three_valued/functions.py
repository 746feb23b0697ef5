"""The functions that compiled bodies call while clingo joins: what values that are not known can be.

Each takes clingo's symbols and returns one symbol, or a list of those that are possible: an empty one where nothing is.
"""

from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import lru_cache

import clingo
from clingo import Number, Symbol, SymbolType

from utak.kb.three_valued.arithmetic import CalculationError, ClauseError
from utak.kb.three_valued.values import (
    ANYTHING,
    NO_NUMBER,
    Value,
    aggregate,
    calculate_uncertain,
    compare,
    from_clingo,
    narrow,
    numbers,
    to_clingo,
)
from utak.kb.tracing.syntax import ANY_NAME

ANY_VALUE = clingo.Function(ANY_NAME)  # stands for any value
MAX_TOLD_APART = 1000  # numbers of an interval that are taken one by one where only what may hold is asked for
Rows = Callable[[str, int], Iterable[Sequence[Symbol]]]  # the rows of a predicate, by name and number of arguments
# Rows, as symbols and as values, by the symbol at one place, None for what is not known.
RowIndex = dict[Symbol | None, list[tuple[Sequence[Symbol], list[Value]]]]
Possibilities = Symbol | list[Symbol]


class FoundError(Exception):
    """Ends a search: what was looked for may hold."""


class Functions:
    """The functions, with the tuples of aggregates that were put together, and the first error."""

    def __init__(self, rows: Rows = lambda _name, _arity: (), names: frozenset[str] = frozenset()) -> None:
        self._rows, self._names = rows, names
        self._tuples: dict[Symbol, list[tuple[tuple[Value, ...], bool]]] = defaultdict(list)
        self._tables: dict[tuple[str, int, int | None], RowIndex] = {}
        self._vague: dict[tuple[Symbol, int], list[Sequence[Symbol]]] = defaultdict(list)
        self.error: ClauseError | None = None

    def forget(self) -> None:
        """Forget the first error, and all tuples of aggregates."""
        self.error = None
        self._tuples.clear()

    def _fail(self, what: str, place: Symbol) -> list[Symbol]:
        """Return nothing, after the first error is kept."""
        self.error = self.error or ClauseError(what, (place.arguments[0].number, place.arguments[1].number))
        return []

    def stop(self, *_given: Symbol) -> Symbol:
        """End the search."""
        raise FoundError

    def nothing(self) -> Possibilities:
        """Return nothing."""
        return []

    # ---- values ----

    def narrow(self, certain: Symbol, one: Symbol, sign: Symbol, other: Symbol) -> Possibilities:
        """Return what a value can be where it compares so with another one."""
        a, b = from_clingo(one), from_clingo(other)
        truth = compare(sign.string, a, b, self._names)
        if truth is False or (truth is None and certain.number):
            return []
        return one if truth or a.known else to_clingo(narrow(a, sign.string, b))

    def not_all(self, certain: Symbol, *pairs: Symbol) -> Possibilities:
        """Return a symbol where one of some comparisons does not hold."""
        parts = [pair.arguments for pair in pairs]
        truths = {compare(sign.string, from_clingo(a), from_clingo(b), self._names) for a, sign, b in parts}
        return certain if False in truths or (None in truths and not certain.number) else []

    def part(self, certain: Symbol, term: Symbol, name: Symbol, count: Symbol, at: Symbol) -> Possibilities:
        """Return one argument of a term, if it has that name and number of arguments."""
        value = from_clingo(term)
        if not value.known:
            return [] if certain.number or value.new or value.high.type == SymbolType.Number else to_clingo(ANYTHING)
        fits = term.type == SymbolType.Function and (term.name, len(term.arguments)) == (name.string, count.number)
        return term.arguments[at.number] if fits else []

    def compound(self, name: Symbol, *parts: Symbol) -> Symbol:
        """Return a term with arguments."""
        known = all(from_clingo(part).known for part in parts)
        return clingo.Function(name.string, parts) if known else to_clingo(NO_NUMBER)

    def calculate(self, place: Symbol, sign: Symbol, *parts: Symbol) -> Possibilities:
        """Return the result of an operation on numbers."""
        values = [from_clingo(part) for part in parts]
        strange = [value for value in values if value.known and value.low.type != SymbolType.Number]
        if strange:
            return self._fail(f"operation undefined: {strange[0].low} is no number", place)
        try:
            return to_clingo(calculate_uncertain(sign.string, *values))
        except CalculationError as error:
            shown, text = [str(value.low) for value in values], sign.string
            one = f"|{shown[0]}|" if text == "|" else f"{text}{shown[0]}"
            return self._fail(f"{error}, in {f' {text} '.join(shown) if len(shown) == 2 else one}", place)

    def calculate_if(self, place: Symbol, sign: Symbol, parts: Symbol, *_given: Symbol) -> Possibilities:
        """Return the result of an operation on numbers where some literals hold: each gave one of the other values."""
        return self.calculate(place, sign, *parts.arguments)

    def undo(self, sign: Symbol, first: Symbol, other: Symbol, result: Symbol) -> Possibilities:
        """Return the operand of `+`, `-` or `*` with which another one has a result; first: whether it is the left."""
        value, known = from_clingo(result), from_clingo(other)
        if any(one.known and one.low.type != SymbolType.Number for one in (value, known)):
            return []
        try:
            if sign.string == "-":
                return to_clingo(calculate_uncertain(*("+", value, known) if first.number else ("-", known, value)))
            if sign.string == "+" or not (value.known and known.known):
                return to_clingo(calculate_uncertain("-" if sign.string == "+" else "?", value, known))
            exact = known.low.number and value.low.number % known.low.number == 0
            return to_clingo(calculate_uncertain("/", value, known)) if exact else []
        except CalculationError:
            return []  # no 32-bit integer solves the equation

    def each(self, low: Symbol, high: Symbol) -> Possibilities:
        """Return the numbers of an interval."""
        (least, a), (b, greatest) = from_clingo(low).ends, from_clingo(high).ends
        if least == a and b == greatest and b - a <= MAX_TOLD_APART:
            return [Number(number) for number in range(a, b + 1)]
        return to_clingo(numbers(least, greatest)) if least <= greatest else []

    def settled(self, value: Symbol) -> Possibilities:
        """Return a value, if it is known."""
        return value if from_clingo(value).known else []

    # ---- aggregates ----

    def put(self, key: Symbol, certain: Symbol, values: Symbol, *_given: Symbol) -> Symbol:
        """Put a tuple to an aggregate."""
        self._tuples[key].append((tuple(map(from_clingo, values.arguments)), bool(certain.number)))
        return certain

    def tally(self, place: Symbol, function: Symbol, key: Symbol, _count: Symbol) -> Possibilities:
        """Return the value of an aggregate whose tuples are put together."""
        try:
            return to_clingo(aggregate(function.string, self._tuples[key]))
        except CalculationError as error:
            return self._fail(f"{error}, in {function.string}", place)

    # ---- complete predicates ----

    def widest(self, predicate: Symbol, count: Symbol, *values: Symbol) -> Possibilities:
        """Return a row of a predicate that may hold, unless another one with unknown values may be all that it may."""
        row = values[: count.number]
        if not all(from_clingo(one).known for one in row):
            rows = self._vague[predicate, count.number]
            if any(other != row and all(map(_includes, other, row)) for other in rows):
                return []
            rows.append(row)
        return clingo.Tuple_(row)

    def joined(self, certain: Symbol, predicate: Symbol, *given: Symbol) -> Possibilities:
        """Return the rows of a complete predicate that have, or may have, some values; `any__` is for any."""
        return [clingo.Tuple_(row) for row in self._meeting(predicate.string, given, bool(certain.number))]

    def match(self, wanted: Symbol, predicate: Symbol, *given: Symbol) -> Possibilities:
        """Return a symbol where a complete predicate has a row with some values, if that is wanted, or has none."""
        certain = not predicate.string.startswith(("maybe__", "any__"))
        found = next(self._meeting(predicate.string, given, certain), None) is not None
        return wanted if found == bool(wanted.number) else []

    def _meeting(self, predicate: str, given: Sequence[Symbol], certain: bool) -> Iterator[list[Symbol]]:
        """Yield the rows of a complete predicate with what their values can be where they equal some others."""
        wanted = [(at, None if _is_open(one) else from_clingo(one)) for at, one in enumerate(given) if one != ANY_VALUE]
        first = next((at for at, value in wanted if value and value.known), None)
        table = self._table(predicate, len(given), first)
        for row, values in table[None] if first is None else (*table.get(given[first], ()), *table[None]):
            met = list(row)
            for at, value in wanted:
                truth = compare("=", value, values[at], self._names) if value else self._fits(given[at], row[at])
                if truth is False or (truth is None and certain):
                    break
                if not truth and value:
                    met[at] = to_clingo(narrow(value, "=", values[at]))
            else:
                yield met

    def _fits(self, pattern: Symbol, symbol: Symbol) -> bool | None:
        """Return whether a symbol is a term in which `any__` stands for any; None when that is not known."""
        if pattern == ANY_VALUE:
            return True
        if not _is_open(pattern) or not from_clingo(symbol).known:
            return compare("=", from_clingo(pattern), from_clingo(symbol), self._names)
        parts = symbol.arguments if symbol.type == SymbolType.Function else []
        if not parts or (symbol.name, len(parts)) != (pattern.name, len(pattern.arguments)):
            return False
        truths = {self._fits(a, b) for a, b in zip(pattern.arguments, parts, strict=True)}
        return False if False in truths else None if None in truths else True

    def _table(self, predicate: str, arity: int, at: int | None) -> RowIndex:
        """Return the rows of a complete predicate by one argument, or all of them."""
        if (predicate, arity, at) not in self._tables:
            table = self._tables[predicate, arity, at] = defaultdict(list)
            if at is None:
                table[None] = [(row, list(map(from_clingo, row))) for row in self._rows(predicate, arity)]
            else:
                for row, values in self._table(predicate, arity, None)[None]:
                    table[row[at] if values[at].known else None].append((row, values))
        return self._tables[predicate, arity, at]


def _includes(symbol: Symbol, other: Symbol) -> bool:
    """Return whether a value may be all that another one may be."""
    a, b = from_clingo(symbol), from_clingo(other)
    return a.low <= b.low and b.high <= a.high and (b.new or not a.new)


@lru_cache(maxsize=65536)
def _is_open(symbol: Symbol) -> bool:
    """Return whether something in a symbol stands for any value."""
    return ANY_NAME in str(symbol)
