"""Argument types of facts: the check of one term, with the complaint and the hint for a term that does not fit."""

import re
from collections.abc import Callable, Iterable, Mapping
from typing import NamedTuple

from utak.kb.language.diagnostics import SourceSpan, did_you_mean
from utak.kb.language.terms import Number, Symbol, Term, Text

DECIMAL_FORM = re.compile(r"[-+]?(?:[0-9]{1,19}(?:\.[0-9]{0,19})?|\.[0-9]{1,19})")  # a decimal number without exponent


class Complaint(NamedTuple):
    """The reason why a term does not fit its argument."""

    span: SourceSpan  # the place of the term in its source: line and columns from 1
    what: str  # the error message, without its place
    hint: str = ""  # a remedy, or '' for none


class ArgumentType(NamedTuple):
    """The type of one argument of a predicate."""

    name: str  # the name of the argument in messages and in the vocabulary
    check: Callable[[Term], Complaint | None]  # returns the complaint about a term, or None when the term fits
    # (least, greatest) integer that fits; None for an argument that is no integer
    limits: tuple[int, int] | None = None
    words: tuple[str, ...] = ()  # all with which what fits begins, where these are some words


def abbreviated(term: Term) -> str:
    """Return a term as text of at most 40 characters, for messages; a longer one is cut and ends in `...`."""
    text = str(term)
    return text if len(text) <= 40 else f"{text[:37]}..."


def integer_argument(name: str, low: int, high: int) -> ArgumentType:
    """Return the type of integers from `low` to `high`, both included."""

    def check(term: Term) -> Complaint | None:
        """Return the complaint about a term, or None when it is an integer in the range."""
        if not isinstance(term, Number):
            return Complaint(term.span, f"{name} must be an integer, not {abbreviated(term)}")
        if not low <= term.value <= high:
            return Complaint(term.span, f"{name} must be from {low} to {high}, not {term.value}")
        return None

    return ArgumentType(name, check, (low, high))


def decimal_argument(name: str, low: float, high: float) -> ArgumentType:
    """Return the type of numbers from `low` to `high`, both included: integers, or quoted decimals such as "0.5"."""

    def check(term: Term) -> Complaint | None:
        """Return the complaint about a term, or None when it is a number in the range."""
        written = str(term.value) if isinstance(term, Number | Text) else ""
        if not DECIMAL_FORM.fullmatch(written):
            hint = 'a whole number, or a quoted decimal such as "0.5"'
            return Complaint(term.span, f"{name} must be a number, not {abbreviated(term)}", hint)
        if not low <= float(written) <= high:
            return Complaint(term.span, f"{name} must be from {low:g} to {high:g}, not {abbreviated(term)}")
        return None

    return ArgumentType(name, check)


def decimal_value(term: Term) -> float:
    """Return the number that a term states, an integer or a quoted decimal that `decimal_argument` accepted."""
    assert isinstance(term, Number | Text)
    return float(term.value)


def text_value(term: Term) -> str:
    """Return the text that a term states, a quoted one."""
    assert isinstance(term, Text)
    return term.value


def word_argument(name: str, known: Iterable[str]) -> ArgumentType:
    """Return the type of the names in `known`: no other name fits."""
    words = tuple(known)

    def check(term: Term) -> Complaint | None:
        """Return the complaint about a term, or None when it is one of the words."""
        if isinstance(term, Symbol) and not term.args and term.name in words:
            return None
        hint = did_you_mean(str(term).strip('"').lower(), words) or f"one of {', '.join(words)}"
        return Complaint(term.span, f"unknown {name} {abbreviated(term)}", hint)

    return ArgumentType(name, check, words=words)


def _check_name(term: Term) -> Complaint | None:
    """Return a complaint (place, message, hint) unless the term is a name without arguments; None when it is one."""
    if isinstance(term, Symbol) and not term.args:
        return None
    hint = f"write {term.value.lower()} without quotes" if isinstance(term, Text) and term.value.isidentifier() else ""
    return Complaint(term.span, f"a name was expected, not {abbreviated(term)}", hint)


def _check_colour(term: Term) -> Complaint | None:
    """Return a complaint (place, message, hint) unless the term is one lower-case letter; None when it is one."""
    if isinstance(term, Symbol) and not term.args and len(term.name) == 1 and term.name.isalpha():
        return None
    return Complaint(term.span, f"a colour is a single lower-case letter, not {abbreviated(term)}")


def pattern_argument(name: str, pattern: str, such_as: str) -> ArgumentType:
    """Return the type of the names that match a regular expression as a whole, such as o1 for `o[0-9]+`."""
    form = re.compile(pattern)

    def check(term: Term) -> Complaint | None:
        """Return the complaint about a term, or None when it is a name that matches."""
        if isinstance(term, Symbol) and not term.args and form.fullmatch(term.name):
            return None
        return Complaint(term.span, f"unknown {name} {abbreviated(term)}", f"such as {such_as}")

    return ArgumentType(name, check)


def wkt_argument(name: str, *kinds: str) -> ArgumentType:
    """Return the type of quoted shapes in well-known text, coordinates in squares."""

    def check(term: Term) -> Complaint | None:
        """Return the complaint about a term, or None when it is a quoted shape of an accepted kind."""
        from utak.kb.language.wkt import WktError, parse_wkt

        if not isinstance(term, Text):
            return Complaint(
                term.span, f"{name} must be a quoted text, not {abbreviated(term)}", f'such as "{kinds[0]} (...)"'
            )
        try:
            parse_wkt(term.value, kinds)
        except WktError as error:
            start = min(term.span.start + 1 + error.at, term.span.end)
            whole_text = error.at == 0
            span = term.span if whole_text else SourceSpan(term.span.line, start, start)
            return Complaint(span, f"{name}: {error.what}")
        return None

    return ArgumentType(name, check)


NAME_ARGUMENT = ArgumentType("name", _check_name)  # any name without arguments
COLOUR_ARGUMENT = ArgumentType("colour", _check_colour)  # one lower-case letter


Forms = Mapping[str, tuple[ArgumentType, ...]]  # compound terms: the types of their arguments, by name


def compound_argument(name: str, plural: str, forms: Forms) -> ArgumentType:
    """Return the type of terms with one of some names, each with its number of arguments."""

    def check(term: Term) -> Complaint | None:
        """Return the complaint about a term, or None when it has one of the forms."""
        if isinstance(term, Symbol) and term.name in forms and len(forms[term.name]) == len(term.args):
            return None
        known = ", ".join(f"{form}/{len(types)}" for form, types in forms.items())
        return Complaint(term.span, f"unknown {name} {abbreviated(term)}", f"{plural} are {known}")

    return ArgumentType(name, check)
