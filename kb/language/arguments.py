"""What may stand as an argument of a fact: small checks of one term, each with its own complaint and hint."""

import re
from collections.abc import Callable, Iterable
from typing import NamedTuple

from kb.language.diagnostics import Span, did_you_mean
from kb.language.terms import Number, Symbol, Term, Text


class Complaint(NamedTuple):
    """Why a term cannot stand where it does."""

    span: Span
    what: str
    hint: str = ""


class Slot(NamedTuple):
    """One place among a fact's arguments: how the vocabulary names it, and the check of what stands there.

    limits : the least and the greatest number that may stand there; None where no number does.
    """

    name: str
    check: Callable[[Term], Complaint | None]
    limits: tuple[int, int] | None = None


def short(term: Term) -> str:
    """A term as a message shows it."""
    text = str(term)
    return text if len(text) <= 40 else f"{text[:37]}..."


def whole(name: str, low: int, high: int) -> Slot:
    """An integer from `low` to `high`."""

    def check(term: Term) -> Complaint | None:
        if not isinstance(term, Number):
            return Complaint(term.span, f"{name} must be an integer, not {short(term)}")
        if not low <= term.value <= high:
            return Complaint(term.span, f"{name} must be from {low} to {high}, not {term.value}")
        return None

    return Slot(name, check, (low, high))


def word(name: str, known: Iterable[str]) -> Slot:
    """One of a few words."""
    words = tuple(known)

    def check(term: Term) -> Complaint | None:
        if isinstance(term, Symbol) and not term.args and term.name in words:
            return None
        hint = did_you_mean(str(term).strip('"').lower(), words) or f"one of {', '.join(words)}"
        return Complaint(term.span, f"unknown {name} {short(term)}", hint)

    return Slot(name, check)


def _name(term: Term) -> Complaint | None:
    if isinstance(term, Symbol) and not term.args:
        return None
    hint = f"write {term.value.lower()} without quotes" if isinstance(term, Text) and term.value.isidentifier() else ""
    return Complaint(term.span, f"a name was expected, not {short(term)}", hint)


def _colour(term: Term) -> Complaint | None:
    if isinstance(term, Symbol) and not term.args and len(term.name) == 1 and term.name.isalpha():
        return None
    return Complaint(term.span, f"a colour is a single lower-case letter, not {short(term)}")


def named(name: str, pattern: str, such_as: str) -> Slot:
    """A name of the robot's own making, such as o1. pattern : of such names, as a regular expression."""
    form = re.compile(pattern)

    def check(term: Term) -> Complaint | None:
        if isinstance(term, Symbol) and not term.args and form.fullmatch(term.name):
            return None
        return Complaint(term.span, f"unknown {name} {short(term)}", f"such as {such_as}")

    return Slot(name, check)


def shape_text(name: str, *kinds: str) -> Slot:
    """A shape as quoted text, of one of the kinds given (POINT, LINESTRING, POLYGON, MULTIPOLYGON)."""

    def check(term: Term) -> Complaint | None:
        from kb.language.wkt import WktError, parse_wkt

        if not isinstance(term, Text):
            return Complaint(
                term.span, f"{name} must be a quoted text, not {short(term)}", f'such as "{kinds[0]} (...)"'
            )
        try:
            parse_wkt(term.value, kinds)
        except WktError as error:
            start = min(term.span.start + 1 + error.at, term.span.end)
            whole_text = error.at == 0
            span = term.span if whole_text else Span(term.span.line, start, start)
            return Complaint(span, f"{name}: {error.what}")
        return None

    return Slot(name, check)


NAME = Slot("name", _name)
COLOUR = Slot("colour", _colour)
