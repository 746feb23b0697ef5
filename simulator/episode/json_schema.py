"""Forms of values as JSON Schema, draft 2020-12."""

from collections.abc import Callable, Mapping
from typing import Any

from simulator.episode.forms import (
    MAX_LIST_VALUES,
    MAX_TEXT_CHARACTERS,
    AnyOf,
    Anything,
    ByKind,
    Characters,
    Form,
    IfKey,
    Keys,
    ListOf,
    NamesTo,
    NestedKeys,
    Noted,
    Numeric,
    OneOf,
    OrNull,
    Row,
    Whole,
)

DIALECT = "https://json-schema.org/draft/2020-12/schema"
Schema = dict[str, Any]


def schema_of(form: Form) -> Schema:
    """Return a form as JSON Schema.

    Examples
    --------
    >>> schema_of(OrNull(Whole(0, 7)))
    {'anyOf': [{'type': 'integer', 'minimum': 0, 'maximum': 7}, {'type': 'null'}]}
    """
    return _WRITERS[type(form)](form)


def document(forms: Mapping[str, Form], title: str, any_of: tuple[str, ...]) -> Schema:
    """Return a whole schema with a definition for each form."""
    wanted: Schema = {"anyOf": [{"$ref": f"#/$defs/{name}"} for name in any_of]}
    if len(any_of) == 1:
        wanted = {"$ref": f"#/$defs/{any_of[0]}"}
    return {
        "$schema": DIALECT,
        "title": title,
        **wanted,
        "$defs": {name: schema_of(form) for name, form in forms.items()},
    }


def _whole_match(pattern: str) -> str:
    """Return a pattern that matches all of a string when it is searched for; `$` would allow a line end after it."""
    return f"^(?:{pattern})(?![\\s\\S])"


def _list_of(form: ListOf) -> Schema:
    found: Schema = {"type": "array", "items": schema_of(form.inner)}
    if form.least:
        found["minItems"] = form.least
    if form.most != MAX_LIST_VALUES:
        found["maxItems"] = form.most
    return found


def _row(form: Row) -> Schema:
    count = len(form.parts)
    parts = [schema_of(part) for part in form.parts]
    return {"type": "array", "prefixItems": parts, "minItems": count, "maxItems": count}


def _characters(form: Characters) -> Schema:
    pattern = {} if form.form is None else {"pattern": _whole_match(form.form)}
    return {"type": "string", "maxLength": MAX_TEXT_CHARACTERS, **pattern}


def _keys(form: Keys) -> Schema:
    properties = {key: schema_of(inner) for key, inner in form.forms.items()}
    return {
        "type": "object",
        "required": [key for key in form.forms if key not in form.optional],
        "properties": properties,
    }


def _by_kind(form: ByKind) -> Schema:
    cases = [
        {"if": {"required": [form.key], "properties": {form.key: {"const": kind}}}, "then": schema_of(keys)}
        for kind, keys in form.kinds.items()
    ]
    return {**_keys(Keys({form.key: OneOf(tuple(form.kinds))})), "allOf": cases}


def _if_key(form: IfKey) -> Schema:
    return {
        "if": {"required": [form.key]},
        "then": schema_of(form.present),
        "else": schema_of(form.absent),
        "type": "object",
    }


def _tree(form: NestedKeys) -> Schema:
    found = _keys(form.node)
    found["properties"][form.below] = {"type": "array", "items": {"$ref": f"#/$defs/{form.name}"}}
    return found


# By the class of a form: the function that returns its schema.
_WRITERS: Mapping[type, Callable[[Any], Schema]] = {
    Numeric: lambda form: {"type": "number", "minimum": form.low, "maximum": form.high},
    Whole: lambda form: {"type": "integer", "minimum": form.low, "maximum": form.high},
    Characters: _characters,
    OneOf: lambda form: {"enum": list(form.known)},
    OrNull: lambda form: {"anyOf": [schema_of(form.inner), {"type": "null"}]},
    ListOf: _list_of,
    Row: _row,
    NamesTo: lambda form: {"type": "object", "additionalProperties": schema_of(form.inner)},
    Keys: _keys,
    ByKind: _by_kind,
    IfKey: _if_key,
    AnyOf: lambda form: {"anyOf": [schema_of(one) for one in form.forms]},
    NestedKeys: _tree,
    Anything: lambda form: {},
    Noted: lambda form: {"description": form.note, **schema_of(form.inner)},
}
