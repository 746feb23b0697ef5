"""Forms of JSON values, as values themselves: one description, of which both a check and a JSON Schema are made.

`complaints` checks a value against a form; `simulator.episode.json_schema` writes a form as JSON Schema.
"""

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

KeyPath = tuple[str, ...]  # the keys that lead to a value
LineComplaint = tuple[KeyPath, str]  # the place of a value, and what is wrong with it

MAX_TEXT_CHARACTERS = 100_000  # characters of a string; a convention
MAX_LIST_VALUES = 10_000_000  # values of a list; a convention


@dataclass(frozen=True)
class Numeric:
    """A number from `low` to `high`."""

    low: float
    high: float


@dataclass(frozen=True)
class Whole:
    """A whole number from `low` to `high`, written without a fraction."""

    low: int
    high: int


@dataclass(frozen=True)
class Characters:
    """A string."""

    # A regular expression that must match all of it, in the subset that Python and ECMA-262 share; None for any
    form: str | None = None
    name: str = "a text"  # what messages call it


@dataclass(frozen=True)
class OneOf:
    """One of some values, of the same type."""

    known: tuple[Any, ...]


@dataclass(frozen=True)
class OrNull:
    """Null, or what another form describes."""

    inner: "Form"


@dataclass(frozen=True)
class ListOf:
    """A list of `least` to `most` values of one form."""

    inner: "Form"
    least: int = 0
    most: int = MAX_LIST_VALUES


@dataclass(frozen=True)
class Row:
    """A list of just these values, each of its own form."""

    parts: tuple["Form", ...]


@dataclass(frozen=True)
class NamesTo:
    """An object with any keys, whose values have one form."""

    inner: "Form"


@dataclass(frozen=True)
class Keys:
    """An object with these keys, each of its own form; further keys are accepted."""

    forms: Mapping[str, "Form"]  # the form of each key
    optional: frozenset[str] = frozenset()  # keys that may be missing


@dataclass(frozen=True)
class ByKind:
    """An object with a key that says what further keys it has."""

    key: str  # that key
    kinds: Mapping[str, Keys]  # its values, each with the further keys


@dataclass(frozen=True)
class IfKey:
    """An object that has one form when a key is there, and another one when it is not."""

    key: str
    present: Keys
    absent: Keys


@dataclass(frozen=True)
class AnyOf:
    """A value of one of some forms. name : what messages call it."""

    forms: tuple["Form", ...]
    name: str


@dataclass(frozen=True)
class NestedKeys:
    """An object that may hold others like itself."""

    name: str  # the name under which the form stands in a schema document
    node: Keys  # the keys of each object
    below: str  # the key of the list of those that it holds; it may be missing


@dataclass(frozen=True)
class Anything:
    """Any value."""


@dataclass(frozen=True)
class Noted:
    """A value of another form, with a note for readers of the schema."""

    note: str
    inner: "Form" = field(default_factory=Anything)


Form = (
    Numeric
    | Whole
    | Characters
    | OneOf
    | OrNull
    | ListOf
    | Row
    | NamesTo
    | Keys
    | ByKind
    | IfKey
    | AnyOf
    | NestedKeys
    | Anything
    | Noted
)


def complaints(form: Form, value: Any, at: KeyPath = ()) -> Iterator[LineComplaint]:
    """Yield what is wrong with a value."""
    yield from _CHECKERS[type(form)](form, value, at)


def accepts(form: Form, value: Any) -> bool:
    """Return whether a value has a form."""
    return next(complaints(form, value), None) is None


def _number(form: Numeric, value: Any, at: KeyPath) -> Iterator[LineComplaint]:
    if isinstance(value, bool) or not isinstance(value, int | float):
        yield at, "a number is wanted"
    elif not form.low <= value <= form.high:  # false for NaN and infinity, too
        yield at, f"a number from {form.low:g} to {form.high:g} is wanted"


def _whole(form: Whole, value: Any, at: KeyPath) -> Iterator[LineComplaint]:
    if isinstance(value, bool) or not isinstance(value, int) or not form.low <= value <= form.high:
        yield at, f"a whole number from {form.low} to {form.high} is wanted"


def _characters(form: Characters, value: Any, at: KeyPath) -> Iterator[LineComplaint]:
    fits = isinstance(value, str) and len(value) <= MAX_TEXT_CHARACTERS
    if not fits or (form.form is not None and not re.fullmatch(form.form, value)):
        yield at, f"{form.name} is wanted"


def _one_of(form: OneOf, value: Any, at: KeyPath) -> Iterator[LineComplaint]:
    if not any(type(value) is type(one) and value == one for one in form.known):
        yield at, f"one of {', '.join(map(str, form.known))} is wanted"


def _or_null(form: OrNull, value: Any, at: KeyPath) -> Iterator[LineComplaint]:
    if value is not None:
        yield from complaints(form.inner, value, at)


def _list_of(form: ListOf, value: Any, at: KeyPath) -> Iterator[LineComplaint]:
    if not isinstance(value, list) or not form.least <= len(value) <= form.most:
        exact = form.least == form.most
        yield at, f"a list of {form.least} values is wanted" if exact else "a list of values is wanted"
        return
    for one in value:
        yield from complaints(form.inner, one, at)


def _row(form: Row, value: Any, at: KeyPath) -> Iterator[LineComplaint]:
    if not isinstance(value, list) or len(value) != len(form.parts):
        yield at, f"a list of {len(form.parts)} values is wanted"
        return
    for part, one in zip(form.parts, value, strict=True):
        yield from complaints(part, one, at)


def _names_to(form: NamesTo, value: Any, at: KeyPath) -> Iterator[LineComplaint]:
    if not isinstance(value, dict):
        yield at, "an object is wanted"
        return
    for key, one in value.items():
        yield from complaints(form.inner, one, (*at, key))


def _keys(form: Keys, value: Any, at: KeyPath) -> Iterator[LineComplaint]:
    if not isinstance(value, dict):
        yield at, "an object is wanted"
        return
    for key, inner in form.forms.items():
        if key in value:
            yield from complaints(inner, value[key], (*at, key))
        elif key not in form.optional:
            yield at, f"the key {key} is missing"


def _by_kind(form: ByKind, value: Any, at: KeyPath) -> Iterator[LineComplaint]:
    yield from complaints(Keys({form.key: OneOf(tuple(form.kinds))}), value, at)
    kind = value.get(form.key) if isinstance(value, dict) else None
    if isinstance(kind, str) and kind in form.kinds:
        yield from complaints(form.kinds[kind], value, at)


def _if_key(form: IfKey, value: Any, at: KeyPath) -> Iterator[LineComplaint]:
    present = isinstance(value, dict) and form.key in value
    yield from complaints(form.present if present else form.absent, value, at)


def _any_of(form: AnyOf, value: Any, at: KeyPath) -> Iterator[LineComplaint]:
    if not any(accepts(one, value) for one in form.forms):
        yield at, f"{form.name} is wanted"


def _tree(form: NestedKeys, value: Any, at: KeyPath) -> Iterator[LineComplaint]:
    yield from complaints(form.node, value, at)
    yield from complaints(Keys({form.below: ListOf(form)}, frozenset({form.below})), value, at)


def _noted(form: Noted, value: Any, at: KeyPath) -> Iterator[LineComplaint]:
    yield from complaints(form.inner, value, at)


def _anything(form: Anything, value: Any, at: KeyPath) -> Iterator[LineComplaint]:
    yield from ()


# By the class of a form: the generator of the complaints about a value.
_CHECKERS: Mapping[type, Callable[[Any, Any, KeyPath], Iterator[LineComplaint]]] = {
    Numeric: _number,
    Whole: _whole,
    Characters: _characters,
    OneOf: _one_of,
    OrNull: _or_null,
    ListOf: _list_of,
    Row: _row,
    NamesTo: _names_to,
    Keys: _keys,
    ByKind: _by_kind,
    IfKey: _if_key,
    AnyOf: _any_of,
    NestedKeys: _tree,
    Anything: _anything,
    Noted: _noted,
}
