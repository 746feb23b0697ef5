"""Values that may be unknown, and their comparison. A truth value is True, False, or None for not known.

A value is an integer, a clingo symbol (a name, a string, a term) or an `Unknown`. For the first two, comparison is
exact. With an unknown value it returns None unless the bounds decide.
"""

import operator
from collections.abc import Callable, Mapping
from typing import Any

import clingo

from utak.kb.language.integers import MAX_INT32, MIN_INT32
from utak.kb.three_valued.arithmetic import calculate

TruthValue = bool | None  # None: not known
Value = Any  # int, clingo.Symbol or Unknown
# By the sign in ASP syntax.
COMPARISON_OPERATORS: Mapping[str, Callable[[Any, Any], bool]] = {
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
    "=": operator.eq,
    "!=": operator.ne,
}
# The sign for which `b sign a` says the same as `a sign b`.
MIRRORED_SIGNS = {"<": ">", "<=": ">=", ">": "<", ">=": "<=", "=": "=", "!=": "!="}


class Unknown:
    """A value that is not known."""

    __slots__ = ("anything", "high", "low", "new")

    def __init__(
        self, low: int | None = None, high: int | None = None, new: bool = False, anything: bool = False
    ) -> None:
        self.low, self.high, self.new, self.anything = low, high, new, anything


def as_clingo(value: Value) -> clingo.Symbol:
    """Return a known value, an integer or a clingo symbol, as a clingo symbol."""
    return clingo.Number(value) if isinstance(value, int) else value


def compare(sign: str, a: Value, b: Value, known: frozenset[str]) -> TruthValue:
    """Return whether `a sign b` holds; None when that is not known."""
    if not isinstance(a, Unknown) and not isinstance(b, Unknown):
        if isinstance(a, int) and isinstance(b, int):
            return COMPARISON_OPERATORS[sign](a, b)
        return COMPARISON_OPERATORS[sign](as_clingo(a), as_clingo(b))
    if a is b:
        return sign in ("=", "<=", ">=")
    if any(isinstance(value, Unknown) and value.anything for value in (a, b)):
        return None
    one, other = bounds(a), bounds(b)
    if one is not None and other is not None:
        return _within(sign, one, other)
    if sign in ("=", "!=") and _differ(a, b, known):
        return sign == "!="
    if (one is None) != (other is None):  # clingo orders numbers before all other terms
        return COMPARISON_OPERATORS[sign](0, 1) if one is not None else COMPARISON_OPERATORS[sign](1, 0)
    return None


def bounds(value: Value) -> tuple[int, int] | None:
    """Return the least and the greatest number that a value can be; None when it is no number, or may be anything."""
    if isinstance(value, int):
        return value, value
    if isinstance(value, Unknown) and value.low is not None and value.high is not None:
        return value.low, value.high
    return None


def _within(sign: str, a: tuple[int, int], b: tuple[int, int]) -> TruthValue:
    """Return whether `a sign b` holds for numbers of which only bounds (least, greatest) are known."""
    if sign in (">", ">="):
        return _within(MIRRORED_SIGNS[sign], b, a)
    if sign in ("<", "<="):
        order = COMPARISON_OPERATORS[sign]
        return True if order(a[1], b[0]) else None if order(a[0], b[1]) else False
    apart = a[1] < b[0] or b[1] < a[0]
    return (sign == "!=") if apart else None


def _differ(a: Value, b: Value, known: frozenset[str]) -> bool:
    """Return whether two values certainly differ: a known name from a new thing, a number from anything else."""
    if (bounds(a) is None) != (bounds(b) is None):
        return True
    pairs = ((a, b), (b, a))
    return any(isinstance(p, Unknown) and p.new and not isinstance(q, Unknown) and str(q) in known for p, q in pairs)


def narrow(value: Unknown, sign: str, other: Value) -> Value:
    """Return what an unknown value can still be where `value sign other` holds."""
    limits, least = bounds(value), bounds(other)
    if sign == "=" and not isinstance(other, Unknown):
        return other
    if limits is None or least is None or sign == "!=":
        return value
    low, high = limits
    if sign in ("<", "<=", "="):
        high = min(high, least[1] - (sign == "<"))
    if sign in (">", ">=", "="):
        low = max(low, least[0] + (sign == ">"))
    return low if low == high else Unknown(low, high)


def calculate_uncertain(sign: str, *values: Value) -> Value:
    """Return the result of an operation on numbers, some of which may be unknown."""
    if not any(isinstance(value, Unknown) for value in values):
        return calculate(sign, *values)
    ends = [bounds(value) or (MIN_INT32, MAX_INT32) for value in values]
    if sign == "+":
        low, high = ends[0][0] + ends[1][0], ends[0][1] + ends[1][1]
    elif sign == "-" and len(ends) == 2:
        low, high = ends[0][0] - ends[1][1], ends[0][1] - ends[1][0]
    elif sign == "-":
        low, high = -ends[0][1], -ends[0][0]
    elif sign == "*":
        corners = [p * q for p in ends[0] for q in ends[1]]
        low, high = min(corners), max(corners)
    else:
        low, high = MIN_INT32, MAX_INT32
    return Unknown(max(low, MIN_INT32), min(high, MAX_INT32))
