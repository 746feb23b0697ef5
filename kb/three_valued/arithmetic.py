"""Exact integer arithmetic of answer set programs; clingo's own integers have 32 bits and wrap without a message.

Division and remainder round towards zero, as clingo's do. A power with a negative exponent is 0.
"""

from collections.abc import Callable, Mapping
from typing import Any

from utak.kb.language.integers import MAX_INT32, MIN_INT32

MAX_EXPONENT = 64  # every power of 2 or more with a greater exponent is beyond 32 bits, so it is not computed


class CalculationError(Exception):
    """A calculation has no 32-bit result; the message says why."""


class ClauseError(Exception):
    """A rule or a query uses an unknown word or a construct that is not supported."""

    def __init__(self, what: str, at: tuple[int, int], hint: str = "") -> None:
        self.what, self.at, self.hint = what, at, hint
        super().__init__(what)


def place_of(node: Any) -> tuple[int, int]:
    """Return the line and the column, both from 1, at which a part of clingo's syntax tree begins."""
    begin = node.location.begin
    return begin.line, begin.column


def require_int32(value: int) -> int:
    """Return the integer; raise CalculationError when it does not fit in 32 bits."""
    if MIN_INT32 <= value <= MAX_INT32:
        return value
    raise CalculationError(f"a number beyond 32 bits ({MIN_INT32} to {MAX_INT32})")


def _divide(a: int, b: int) -> int:
    """Return the quotient of two integers, rounded towards zero; raise CalculationError for a division by zero."""
    if b == 0:
        raise CalculationError("a division by zero")
    return abs(a) // abs(b) * (1 if (a < 0) == (b < 0) else -1)


def _remainder(a: int, b: int) -> int:
    """Return the remainder of the division rounded towards zero; it has the sign of `a`. CalculationError for b = 0."""
    return a - b * _divide(a, b)


def _power(a: int, b: int) -> int:
    """Return a to the power of b; 0 for negative b. Raises CalculationError where b makes it surely exceed 32 bits."""
    if b < 0:
        return 0
    if abs(a) > 1 and b > MAX_EXPONENT:
        return require_int32(MAX_INT32 + 1)
    return int(a ** (b if abs(a) > 1 else min(b, 2 + b % 2)))  # the powers of 0, 1 and -1 repeat after two exponents


# By the operator in ASP syntax.
BINARY_OPERATIONS: Mapping[str, Callable[[int, int], int]] = {
    "+": lambda a, b: a + b,
    "-": lambda a, b: a - b,
    "*": lambda a, b: a * b,
    "/": _divide,
    "\\": _remainder,
    "**": _power,
    "&": lambda a, b: a & b,
    "?": lambda a, b: a | b,
    "^": lambda a, b: a ^ b,
}
# By the operator in ASP syntax.
UNARY_OPERATIONS: Mapping[str, Callable[[int], int]] = {"-": lambda a: -a, "~": lambda a: ~a, "|": abs}


def calculate(sign: str, *values: int) -> int:
    """Return the result of an operation on one or two integers.

    Examples
    --------
    >>> calculate("*", 65536, -32768)
    -2147483648
    """
    return require_int32(UNARY_OPERATIONS[sign](*values) if len(values) == 1 else BINARY_OPERATIONS[sign](*values))
