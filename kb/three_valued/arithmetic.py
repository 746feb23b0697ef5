"""Integer arithmetic as answer set programs know it, with checks: clingo's integers have 32 bits and wrap in silence.

Division and remainder are those of clingo (towards zero); a power with a negative exponent is 0.
"""

from collections.abc import Callable, Mapping

from kb.language.integers import MAX_INT32, MIN_INT32

MOST_BITS = 64  # no power with more of them is worked out


class CalculationError(Exception):
    """A calculation has no result of 32 bits; says why."""


def checked(value: int) -> int:
    """Return an integer that has at most 32 bits; raises CalculationError for any other."""
    if MIN_INT32 <= value <= MAX_INT32:
        return value
    raise CalculationError(f"a number beyond 32 bits ({MIN_INT32} to {MAX_INT32})")


def _divide(a: int, b: int) -> int:
    if b == 0:
        raise CalculationError("a division by zero")
    return abs(a) // abs(b) * (1 if (a < 0) == (b < 0) else -1)


def _remainder(a: int, b: int) -> int:
    return a - b * _divide(a, b)


def _power(a: int, b: int) -> int:
    if b < 0:
        return 0
    if abs(a) > 1 and b > MOST_BITS:
        return checked(MAX_INT32 + 1)
    return int(a ** (b if abs(a) > 1 else min(b, 2 + b % 2)))  # of 0, 1 and -1 high powers are those of 2 and 3


BINARY: Mapping[str, Callable[[int, int], int]] = {
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
UNARY: Mapping[str, Callable[[int], int]] = {"-": lambda a: -a, "~": lambda a: ~a, "|": abs}


def calculate(sign: str, *values: int) -> int:
    """Return the result of one operation on one or two integers; raises CalculationError when it has none.

    >>> calculate("*", 65536, -32768)
    -2147483648
    """
    return checked(UNARY[sign](*values) if len(values) == 1 else BINARY[sign](*values))
