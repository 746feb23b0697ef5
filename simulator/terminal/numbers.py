"""Numbers on the command line: ASCII digits within bounds; anything else is an error of usage."""

import argparse
import re
from collections.abc import Callable

WHOLE_NUMBER = re.compile(r"[-+]?[0-9]{1,19}")  # at most 19 digits
# Digits with at most one point, and an exponent.
DECIMAL_NUMBER = re.compile(r"[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?")


def whole(low: int, high: int) -> Callable[[str], int]:
    """Return what reads an integer from `low` to `high`; it raises ArgumentTypeError for any other text.

    >>> whole(0, 99)("12")
    12
    """

    def read(text: str) -> int:
        if not WHOLE_NUMBER.fullmatch(text) or not low <= int(text) <= high:
            raise argparse.ArgumentTypeError(f"must be a whole number from {low} to {high}, not {text[:40]!r}")
        return int(text)

    return read


def decimal(low: float, high: float) -> Callable[[str], float]:
    """Return what reads a number from `low` to `high`; it raises ArgumentTypeError for any other text."""

    def read(text: str) -> float:
        if not DECIMAL_NUMBER.fullmatch(text) or not low <= float(text) <= high:
            raise argparse.ArgumentTypeError(f"must be a number from {low:g} to {high:g}, not {text[:40]!r}")
        return float(text)

    return read


def point(greatest: float) -> Callable[[str], tuple[float, float]]:
    """Return what reads a point X,Y whose coordinates are at most `greatest` in absolute value."""
    coordinate = decimal(-greatest, greatest)

    def read(text: str) -> tuple[float, float]:
        parts = text.split(",")
        if len(parts) != 2:
            raise argparse.ArgumentTypeError(f"{text[:40]!r} is no point: write X,Y")
        return coordinate(parts[0]), coordinate(parts[1])

    return read
