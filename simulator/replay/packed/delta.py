"""Differences between JSON values: what must be known besides the old value to have the new one.

A difference is itself a JSON value, so that it can be packed and read in a browser (`page_parts/decode.js` applies it):

- `0`: the value stays as it is;
- `[value]`: another value takes its place;
- an object: the differences of an object's entries, by key; `-1` for a key that is no longer there;
- a list of two or more edits of a list, from its start on: a positive number keeps so many items, a negative one drops
  so many, and a list inserts its items. What no edit speaks of is kept.
"""

import difflib
import json
from typing import Any

SAME = 0  # the difference of equal values
GONE = -1  # the difference of an entry that is no longer there
MAX_MATCHED_PAIRS = 250_000  # pairs of items that are compared to find the shortest edits; beyond, all are replaced


def difference(old: Any, new: Any) -> Any:
    """Return the difference that leads from one JSON value to another one.

    Examples
    --------
    >>> difference({"a": 1, "b": [1, 2, 3]}, {"b": [1, 3, 4]})
    {'b': [1, -1, 1, [4]], 'a': -1}
    """
    if _equal(old, new):
        return SAME
    if isinstance(old, dict) and isinstance(new, dict):
        changed = {key: difference(old[key], new[key]) if key in old else [new[key]] for key in new}
        kept = {key: how for key, how in changed.items() if how != SAME}
        return kept | {key: GONE for key in old if key not in new}
    if isinstance(old, list) and isinstance(new, list) and old and new:
        return _edits(old, new)
    return [new]


def patched(old: Any, how: Any) -> Any:
    """Return the value to which a difference leads from an old value, which is left as it is."""
    if isinstance(how, dict):
        found = dict(old)
        for key, part in how.items():
            if isinstance(part, int) and part == GONE:
                del found[key]
            else:
                found[key] = patched(found.get(key), part)
        return found
    if not isinstance(how, list):
        return old
    if len(how) == 1:
        return how[0]
    result: list[Any] = []
    at = 0
    for edit in how:
        if isinstance(edit, list):
            result += edit
        elif edit > 0:
            result += old[at : at + edit]
            at += edit
        else:
            at -= edit
    return result + old[at:]


def _equal(old: Any, new: Any) -> bool:
    """Return whether two JSON values are the same; true and 1 are not."""
    if type(old) is not type(new) or old != new:
        return False
    if isinstance(old, list):
        return all(map(_equal, old, new))
    return not isinstance(old, dict) or all(_equal(old[key], new[key]) for key in new)


def _edits(old: list[Any], new: list[Any]) -> list[Any]:
    """Return the edits that lead from one list to another one; both have items, and they differ."""
    head, shorter = 0, min(len(old), len(new))
    while head < shorter and _equal(old[head], new[head]):
        head += 1
    tail = 0
    while tail < shorter - head and _equal(old[-1 - tail], new[-1 - tail]):
        tail += 1
    before, after = old[head : len(old) - tail], new[head : len(new) - tail]
    if len(before) * len(after) > MAX_MATCHED_PAIRS:
        steps = [("replace", 0, len(before), 0, len(after))]
    else:
        texts, others = ([json.dumps(item) for item in items] for items in (before, after))
        steps = list(difflib.SequenceMatcher(None, texts, others, autojunk=False).get_opcodes())
    edits: list[Any] = [head] if head else []
    for step, start, end, first, last in steps:
        if step == "equal":
            edits.append(end - start)
            continue
        if end > start:
            edits.append(start - end)
        if last > first:
            edits.append(new[head + first : head + last])
    return edits if len(edits) > 1 else [0, *edits]
