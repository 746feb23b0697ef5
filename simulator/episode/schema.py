"""The forms of episodes and of what commands print under --json: one JSON Schema, `schema.json`, and a check by it.

The schema is of draft 2020-12. The check knows the words that it uses, and no other ones. It takes 1.0 for no integer.
"""

import json
import re
from collections.abc import Iterator
from functools import cache
from importlib.resources import files
from typing import Any

from utak.geometry.counts.retina import FIELD_COUNT

Schema = dict[str, Any]
KeyPath = tuple[str, ...]  # the keys that lead to a value
LineComplaint = tuple[KeyPath, str]  # the place of a value, and what is wrong with it

EPISODE_LINES = ("header", "step", "end")  # the names of the lines of an episode
EPISODE_VERSION = 1  # of the form of episodes; docs/files.md
REFERENCE = "#/$defs/"
_TYPES: dict[str, tuple[Any, str]] = {
    "object": (dict, "an object"),
    "array": (list, "a list of values"),
    "string": (str, "a text"),
    "number": ((int, float), "a number"),
    "integer": (int, "a whole number"),
    "boolean": (bool, "true or false"),
    "null": (type(None), "null"),
}


@cache
def definitions() -> dict[str, Schema]:
    """Return the schema of each form by its name."""
    text = (files(__package__) / "schema.json").read_text(encoding="utf-8")
    found: dict[str, Schema] = json.loads(text)["$defs"]
    belief = found["belief"]["properties"]
    # What depends on the number of fields of the retina; the file states it for 160.
    found["step"]["properties"]["retina"] |= {"minItems": FIELD_COUNT, "maxItems": FIELD_COUNT}
    found["field_number"]["maximum"] = FIELD_COUNT - 1
    belief["cells"]["additionalProperties"]["maximum"] = FIELD_COUNT
    for schema in (found["digits"], belief["status"]):
        schema |= {key: schema[key].replace("160", str(FIELD_COUNT)) for key in ("title", "pattern")}
    return found


def document(names: tuple[str, ...], title: str) -> Schema:
    """Return a whole schema of values that have one of some forms."""
    known = definitions()
    wanted: list[str] = []
    waiting = list(names)
    while waiting:
        name = waiting.pop(0)
        if name not in wanted:
            wanted.append(name)
            waiting += re.findall(rf'"{re.escape(REFERENCE)}(\w+)"', json.dumps(known[name]))
    choice: Schema = {"anyOf": [{"$ref": REFERENCE + name} for name in names]}
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": title,
        **(choice if len(names) > 1 else choice["anyOf"][0]),
        "$defs": {name: known[name] for name in wanted},
    }


def accepts(name: str, value: Any) -> bool:
    """Return whether a value has a form."""
    return next(complaints(name, value), None) is None


def complaints(name: str, value: Any) -> Iterator[LineComplaint]:
    """Yield what is wrong with a value that should have a form."""
    return _complaints(definitions()[name], value, ())


def _complaints(schema: Schema, value: Any, at: KeyPath) -> Iterator[LineComplaint]:
    if "$ref" in schema:
        yield from _complaints(definitions()[schema["$ref"].removeprefix(REFERENCE)], value, at)
    for part in schema.get("allOf", ()):
        yield from _complaints(part, value, at)
    if "if" in schema:
        fits = next(_complaints(schema["if"], value, at), None) is None
        yield from _complaints(schema.get("then" if fits else "else", {}), value, at)
    if "anyOf" in schema:
        yield from _of_alternatives(schema, value, at)
    known = [schema["const"]] if "const" in schema else schema.get("enum")
    if known is not None and not any(type(value) is type(one) and value == one for one in known):
        yield at, f"one of {', '.join(map(str, known))} is wanted"
    if "type" in schema:
        yield from _of_type(schema, value, at)
    if isinstance(value, dict):
        yield from _of_object(schema, value, at)


def _of_alternatives(schema: Schema, value: Any, at: KeyPath) -> Iterator[LineComplaint]:
    found = [list(_complaints(one, value, at)) for one in schema["anyOf"]]
    if all(found):  # of a value that may be null it is told what is wrong with it
        named = "title" in schema or len(found) > 2
        yield from [(at, f"{schema.get('title', 'another value')} is wanted")] if named else found[0]


def _of_type(schema: Schema, value: Any, at: KeyPath) -> Iterator[LineComplaint]:
    kind, (types, word) = schema["type"], _TYPES[schema["type"]]
    if not isinstance(value, types) or (isinstance(value, bool) and kind != "boolean"):
        yield at, f"{schema.get('title', word)} is wanted"
    elif isinstance(value, int | float) and "minimum" in schema:
        if not schema["minimum"] <= value <= schema["maximum"]:  # true for NaN and infinity, too
            yield at, f"{word} from {schema['minimum']} to {schema['maximum']} is wanted"
    elif isinstance(value, str):
        long = len(value) > schema.get("maxLength", len(value))
        if long or ("pattern" in schema and not re.search(schema["pattern"], value)):
            yield at, f"{schema.get('title', word)} is wanted"
    elif isinstance(value, list):
        yield from _of_list(schema, value, at)


def _of_list(schema: Schema, value: list[Any], at: KeyPath) -> Iterator[LineComplaint]:
    least, most = schema.get("minItems", 0), schema.get("maxItems", len(value))
    if not least <= len(value) <= most:
        yield at, f"a list of {least} values is wanted" if least == most else "a list of values is wanted"
        return
    for part, one in zip(schema.get("prefixItems", ()), value, strict=False):
        yield from _complaints(part, one, at)
    for one in value if "items" in schema else ():
        yield from _complaints(schema["items"], one, at)


def _of_object(schema: Schema, value: dict[str, Any], at: KeyPath) -> Iterator[LineComplaint]:
    for key in schema.get("required", ()):
        if key not in value:
            yield at, f"the key {key} is missing"
    properties = schema.get("properties", {})
    for key, one in value.items():
        if key in properties:
            yield from _complaints(properties[key], one, (*at, key))
        elif "additionalProperties" in schema:
            yield from _complaints(schema["additionalProperties"], one, (*at, key))
