"""Values that are not known: what could stand in a fact that may yet turn out to hold. Truths are True, False or None.

A value is an integer, a clingo symbol (a name, a text, a term), or `Unknown`. What is said of values here is exact for
the first two; of an unknown one it is None, don't know, unless its bounds decide.
"""

import operator
from collections.abc import Callable, Mapping
from typing import Any

import clingo

from kb.language.integers import MAX_INT32, MIN_INT32
from kb.three_valued.arithmetic import calculate

Truth = bool | None
Value = Any  # int, clingo.Symbol or Unknown
ORDERS: Mapping[str, Callable[[Any, Any], bool]] = {
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
    "=": operator.eq,
    "!=": operator.ne,
}
TURNED = {"<": ">", "<=": ">=", ">": "<", ">=": "<=", "=": "=", "!=": "!="}


class Unknown:
    """A value that is not known.

    Attributes
    ----------
    low, high : the bounds of a number; None for what is no number.
    new : the name of something that was not seen yet, so that it is none of the names known.
    anything : it may be a number or none.
    """

    __slots__ = ("anything", "high", "low", "new")

    def __init__(
        self, low: int | None = None, high: int | None = None, new: bool = False, anything: bool = False
    ) -> None:
        self.low, self.high, self.new, self.anything = low, high, new, anything


def symbol(value: Value) -> clingo.Symbol:
    """Return a known value as clingo holds it, which orders all values: numbers, names, texts, terms."""
    return clingo.Number(value) if isinstance(value, int) else value


def compare(sign: str, a: Value, b: Value, known: frozenset[str]) -> Truth:
    """Return whether `a sign b` holds. known : names of what was seen."""
    if not isinstance(a, Unknown) and not isinstance(b, Unknown):
        if isinstance(a, int) and isinstance(b, int):
            return ORDERS[sign](a, b)
        return ORDERS[sign](symbol(a), symbol(b))
    if a is b:
        return sign in ("=", "<=", ">=")
    if any(isinstance(value, Unknown) and value.anything for value in (a, b)):
        return None
    one, other = bounds(a), bounds(b)
    if one is not None and other is not None:
        return _within(sign, one, other)
    if sign in ("=", "!=") and _differ(a, b, known):
        return sign == "!="
    if (one is None) != (other is None):  # numbers come before all else
        return ORDERS[sign](0, 1) if one is not None else ORDERS[sign](1, 0)
    return None


def bounds(value: Value) -> tuple[int, int] | None:
    """Return between which numbers a value lies; None for what is no number."""
    if isinstance(value, int):
        return value, value
    if isinstance(value, Unknown) and value.low is not None and value.high is not None:
        return value.low, value.high
    return None


def _within(sign: str, a: tuple[int, int], b: tuple[int, int]) -> Truth:
    """Whether an order holds between numbers of which only the bounds are known."""
    if sign in (">", ">="):
        return _within(TURNED[sign], b, a)
    if sign in ("<", "<="):
        order = ORDERS[sign]
        return True if order(a[1], b[0]) else None if order(a[0], b[1]) else False
    apart = a[1] < b[0] or b[1] < a[0]
    return (sign == "!=") if apart else None


def _differ(a: Value, b: Value, known: frozenset[str]) -> bool:
    """Whether one is a name known and the other something new, or one a number and the other none."""
    if (bounds(a) is None) != (bounds(b) is None):
        return True
    pairs = ((a, b), (b, a))
    return any(isinstance(p, Unknown) and p.new and not isinstance(q, Unknown) and str(q) in known for p, q in pairs)


def narrowed(value: Unknown, sign: str, other: Value) -> Value:
    """Return what an unknown value can only be where `value sign other` holds; itself where that tells nothing."""
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


def calculated(sign: str, *values: Value) -> Value:
    """Return the result of an operation on numbers, of which some may be unknown; raises CalculationError."""
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
