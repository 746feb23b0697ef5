"""Numbers on the command line: ASCII digits within bounds; anything else is an error of usage."""

import argparse
import re

WHOLE_NUMBER = re.compile(r"[-+]?[0-9]{1,19}")  # at most 19 digits
# Digits with at most one point, and an exponent.
DECIMAL_NUMBER = re.compile(r"[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?")

MIN_SECONDS, MAX_SECONDS = 0.001, 1_000_000  # the bounds of `--seconds` of runs; conventions


def parse_whole(text: str, low: int, high: int) -> int:
    """Return the integer that a text denotes; raise ArgumentTypeError unless it is from `low` to `high`.

    >>> parse_whole("12", 0, 99)
    12
    """
    if not WHOLE_NUMBER.fullmatch(text) or not low <= int(text) <= high:
        raise argparse.ArgumentTypeError(f"must be a whole number from {low} to {high}, not {text[:40]!r}")
    return int(text)


def parse_decimal(text: str, low: float, high: float) -> float:
    """Return the number that a text denotes; raise ArgumentTypeError unless it is from `low` to `high`."""
    if not DECIMAL_NUMBER.fullmatch(text) or not low <= float(text) <= high:
        raise argparse.ArgumentTypeError(f"must be a number from {low:g} to {high:g}, not {text[:40]!r}")
    return float(text)
