"""Values of which only the least and the greatest possibility may be known, in clingo's order of all symbols.

A truth value is True, False, or None for not known.
"""

from collections.abc import Iterable
from functools import lru_cache
from itertools import product
from typing import NamedTuple

import clingo
from clingo import Infimum, Number, Supremum, Symbol, SymbolType

from utak.kb.language.integers import MAX_INT32, MIN_INT32
from utak.kb.three_valued.arithmetic import calculate, require_int32

TruthValue = bool | None  # None: not known
# The sign for which `b sign a` says the same as `a sign b`.
MIRRORED_SIGNS = {"<": ">", "<=": ">=", ">": "<", ">=": "<=", "=": "=", "!=": "!="}


class Value(NamedTuple):
    """A symbol of clingo, or one of those between two."""

    low: Symbol  # the least, in clingo's order
    high: Symbol  # the greatest
    new: bool = False  # whether it is a thing that was not seen yet
    some: bool = False  # whether it is an interval, of whose numbers it takes one to compare so

    @property
    def known(self) -> bool:
        """Whether it is one symbol."""
        return self.low is self.high

    @property
    def ends(self) -> tuple[int, int]:
        """The least and the greatest number that it can be."""
        low, high = (end.number if end.type == SymbolType.Number else None for end in self[:2])
        return MIN_INT32 if low is None else low, MAX_INT32 if high is None else high


ANYTHING = Value(Infimum, Supremum)
# Anything but a number: clingo orders numbers before all other terms, and no term is before this one.
NO_NUMBER = Value(clingo.Function("!"), Supremum)
NEW = NO_NUMBER._replace(new=True)


def numbers(low: int, high: int) -> Value:
    """Return a number between two; beyond 32 bits there is none."""
    return Value(Number(max(low, MIN_INT32)), Number(min(high, MAX_INT32)))


@lru_cache(maxsize=65536)
def from_clingo(symbol: Symbol) -> Value:
    """Return the value that a clingo symbol stands for."""
    if symbol.type == SymbolType.Function and symbol.name == "unknown__":
        low, high, new = symbol.arguments
        return Value(low, high, bool(new.number))
    if symbol.type == SymbolType.Function and symbol.name == "range__":
        low, high = (from_clingo(symbol.arguments[0]).low, from_clingo(symbol.arguments[1]).high)
        return Value(low, low if low == high else high, some=True)
    return Value(symbol, symbol)


def to_clingo(value: Value) -> Symbol:
    """Return a clingo symbol that stands for a value."""
    return (
        value.low
        if value.low == value.high
        else clingo.Function("unknown__", [value.low, value.high, Number(value.new)])
    )


def compare(sign: str, a: Value, b: Value, names: frozenset[str]) -> TruthValue:
    """Return whether `a sign b` holds; None when that is not known. names: of the things that are known."""
    if sign in (">", ">="):
        return compare(MIRRORED_SIGNS[sign], b, a, names)
    if (a.some and a.low > a.high) or (b.some and b.low > b.high):
        return False
    if sign == "<":
        truth = a.high < b.low or (None if a.low < b.high else False)
    elif sign == "<=":
        truth = a.high <= b.low or (None if a.low <= b.high else False)
    else:
        truth = _equal(a, b, names)
        truth = truth if sign == "=" or truth is None else not truth
    return True if truth is None and (a.known or a.some) and (b.known or b.some) else truth


def _equal(a: Value, b: Value, names: frozenset[str]) -> TruthValue:
    """Return whether two values are equal; a new thing is none of those that are known."""
    if a.known and b.known:
        return a.low == b.low
    apart = a.high < b.low or b.high < a.low
    return False if apart or any(p.new and q.known and str(q.low) in names for p, q in ((a, b), (b, a))) else None


def narrow(value: Value, sign: str, other: Value) -> Value:
    """Return what a value can still be where `value sign other` holds."""
    low, high = value.low, value.high
    if sign in ("<", "<=", "="):
        strict = sign == "<" and other.high.type == SymbolType.Number
        high = min(high, Number(max(MIN_INT32, other.high.number - 1)) if strict else other.high)
    if sign in (">", ">=", "="):
        strict = sign == ">" and other.low.type == SymbolType.Number
        low = max(low, Number(min(MAX_INT32, other.low.number + 1)) if strict else other.low)
    return Value(low, high, value.new or (sign == "=" and other.new))


def calculate_uncertain(sign: str, *values: Value) -> Value:
    """Return the result of an operation on numbers, some of which may be unknown."""
    if all(value.known for value in values):
        exact = calculate(sign, *(value.low.number for value in values))
        return numbers(exact, exact)
    if sign not in ("+", "-", "*"):
        return numbers(MIN_INT32, MAX_INT32)
    pairs = product(*[(0, 0), *(value.ends for value in values)][-2:])
    found = [p + q if sign == "+" else p - q if sign == "-" else p * q for p, q in pairs]
    return numbers(min(found), max(found))


def aggregate(function: str, tuples: Iterable[tuple[tuple[Value, ...], bool]]) -> Value:
    """Return the value of an aggregate over tuples, each with whether it is certain."""
    # Raises CalculationError for a value beyond 32 bits.
    all_of = dict(sorted(tuples, key=lambda one: one[1]))  # a tuple that is certain and possible is certain
    certain = [values for values, is_certain in all_of.items() if is_certain]
    if function in ("#min", "#max"):
        best, none = (min, Supremum) if function == "#min" else (max, Infimum)
        sure, whole = ([values[0] for values in some if values] for some in (certain, all_of))
        lows, highs = (whole, sure) if function == "#min" else (sure, whole)
        return Value(best((one.low for one in lows), default=none), best((one.high for one in highs), default=none))
    low = high = 0
    for values, is_certain in all_of.items():
        weight = _weight(function, values)
        times = 1 if all(value.known for value in values) else MAX_INT32  # what is not known may stand for many
        low += weight[0] if is_certain else times * min(0, weight[0])
        high += weight[1] if is_certain else times * max(0, weight[1])
    require_int32(sum(_weight(function, values)[0] for values in certain))
    return numbers(low, high)


def _weight(function: str, values: tuple[Value, ...]) -> tuple[int, int]:
    """Return the least and the greatest number with which a tuple counts."""
    if function == "#count":
        return 1, 1
    first = values[0] if values else NO_NUMBER
    if first[:2] == NO_NUMBER[:2] or (first.known and first.low.type != SymbolType.Number):
        return 0, 0
    low, high = first.ends
    return (max(0, low), max(0, high)) if function == "#sum+" else (low, high)
