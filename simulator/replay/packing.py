"""An episode packed for a page: what changes from step to step, in blocks that are read one by one.

A packed episode is a list of texts, each deflated JSON in base64: an index, then the blocks. The index has

- `header`, `result`: those of the episode;
- `columns`: `action`, `motion`, `utak`, `place` and `seen_from` of all steps, for tracks and lists; `0` in the place of
  what the motion tells (`predicted_utak`, `predicted_place`); `seen_from` as the difference from the places before;
- `events`: the steps of each kind of event; `bounds`: the least and greatest coordinates of all outlines;
- `steps`, `block`: how many steps the episode and a block have.

A block is a list with one column for every key of its lines, `[path, differences]`, each difference from the value of
the step before in the same block; the first step of a block differs from nothing. `page_parts/decode.js` reads this.
"""

import base64
import json
import math
import zlib
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from simulator.episode.episode import Episode, EpisodeLine
from simulator.replay.decisions import by_encoding, trimmed
from simulator.replay.delta import GONE, SAME, difference
from simulator.replay.events import episode_events
from simulator.replay.outlines import split_facts

STEPS_PER_BLOCK = 250  # a compromise: longer blocks pack better, shorter ones are read faster; benchmarks/replay.py
MAX_SAFE_INTEGER = 2**53  # the greatest integer that a browser's numbers hold exactly
RETINA_TEXTS = ("least", "most", "retina")  # each is written as what it is above the one before, in this order
Path = tuple[str, ...]  # the keys that lead to a value of a step's line
SOLVED = ("belief", "solved")


def packed_episode(episode: Episode, trees: Mapping[int, Sequence[Any]] | None = None) -> list[str]:
    """Return an episode as the texts that a page holds.

    Parameters
    ----------
    episode : the episode, with one step at least.
    trees : explanations by step: lists of `{"text": ..., "children": [...]}`, whose children are of the same form.

    Returns
    -------
    The index and the blocks, each of letters, digits, `+`, `/` and `=`.
    """
    lines = [slim(kept_line(line)) for line in episode.steps]
    index = {
        "header": slim(episode.header),
        "result": slim(episode.result),
        "steps": len(lines),
        "columns": _columns(lines),
        "events": episode_events(episode),
        "bounds": _bounds(episode.steps),
        "block": STEPS_PER_BLOCK,
    }
    blocks = [lines[first : first + STEPS_PER_BLOCK] for first in range(0, len(lines), STEPS_PER_BLOCK)]
    return [deflated(index), *(deflated(_block(block, trees or {})) for block in blocks)]


def kept_line(line: EpisodeLine) -> EpisodeLine:
    """Return a step's line as a page keeps it: all of it, but for the facts of very large decisions.

    See `simulator.replay.decisions.trimmed`.
    """
    solved = line["belief"].get("solved")
    if not isinstance(solved, list):
        return line
    return line | {"belief": line["belief"] | {"solved": [trimmed(entry) for entry in solved]}}


def deflated(value: Any) -> str:
    """Return a JSON value as text: deflated without a head (RFC 1951), in base64."""
    packer = zlib.compressobj(9, zlib.DEFLATED, -zlib.MAX_WBITS, 9)
    text = json.dumps(value, separators=(",", ":"), allow_nan=False)
    return base64.b64encode(packer.compress(text.encode("ascii")) + packer.flush()).decode("ascii")


def slim(value: Any) -> Any:
    """Return a JSON value as a browser can hold it: whole floats as integers, too great integers as text."""
    if isinstance(value, float) and value.is_integer() and abs(value) < MAX_SAFE_INTEGER:
        return int(value)
    if isinstance(value, int) and abs(value) > MAX_SAFE_INTEGER:
        return str(value)
    if isinstance(value, list):
        return [slim(item) for item in value]
    if isinstance(value, dict):
        return {key: slim(item) for key, item in value.items()}
    return value


def _columns(lines: Sequence[EpisodeLine]) -> dict[str, list[Any]]:
    """Return what a page needs of all steps at once, each as a list over the steps."""
    utak, place, anew = [], [], []
    before: EpisodeLine | None = None
    seen: list[Any] = []
    for line in lines:
        here, believed = line["utak"], line["belief"].get("place")
        utak.append(SAME if before and predicted_utak(before["utak"], line["motion"]) == here else here)
        told = before and predicted_place(before["belief"].get("place"), line["action"]) == believed
        place.append(SAME if told and believed is not None else believed)
        told_anew = line["belief"].get("seen_from")
        seen = [*seen, believed]
        anew.append(SAME if told_anew is None else difference(seen, told_anew) or [told_anew])
        seen = seen if told_anew is None else told_anew
        before = line
    return {
        "action": [line["action"] for line in lines],
        "motion": [line["motion"] for line in lines],
        "utak": utak,
        "place": place,
        "seen_from": anew,
    }


def predicted_utak(before: list[float], motion: EpisodeLine | None) -> list[float]:
    """Return where a true motion, which is no turn, leads from a place, in squares, table frame."""
    way = motion.get("translate", (0, 0)) if motion else (0, 0)
    return [before[0] + way[0], before[1] + way[1]]


def predicted_place(before: Any, action: EpisodeLine | None) -> Any:
    """Return where a command leads from a believed place, in squares of the robot frame, rounded to six digits."""
    if not isinstance(before, list) or len(before) != 2 or not all(isinstance(v, int | float) for v in before):
        return None
    way = (action.get("east", 0), action.get("north", 0)) if action else (0, 0)
    return [math.floor((v + w) * 1e6 + 0.5) / 1e6 for v, w in zip(before, way, strict=True)]


def _bounds(lines: Sequence[EpisodeLine]) -> list[int] | None:
    """Return the least east and north, and the greatest, of all rectangles, in hundredths of squares, robot frame.

    Returns None when there are none. Facts of other forms count for nothing.
    """
    found: set[str] = set()
    for line in lines:
        found.update(fact for fact in line["belief"]["facts"] if fact.startswith("rect("))
    boxes = []
    for fact in sorted(found):
        parts = fact[len("rect(") : -len(").")].split(",")[1:]
        if len(parts) == 4 and all(part.removeprefix("-").isdecimal() and len(part) < 10 for part in parts):
            boxes.append([int(part) for part in parts])
    if not boxes:
        return None
    west, south, east, north = zip(*boxes, strict=True)
    return [min(west), min(south), max(east), max(north)]


def _block(lines: Sequence[EpisodeLine], trees: Mapping[int, Sequence[Any]]) -> list[Any]:
    """Return the columns of some steps: pairs of a path of keys, and the differences from step to step."""
    prepared = [dict(_prepared(line)) for line in lines]
    for line, values in zip(lines, prepared, strict=True):
        if line["step"] in trees:
            values["replay", "trees"] = slim(list(trees[line["step"]]))
    decided: Any = None
    for values in prepared:
        if SOLVED in values:
            decided = values[SOLVED] = by_encoding(values[SOLVED], decided)
    paths = dict.fromkeys(path for line in prepared for path in line)
    return [[list(path), _differences([line.get(path, _Absent) for line in prepared])] for path in paths]


class _Absent:
    """Stands for a value that a step's line does not have."""


def _differences(values: Sequence[Any]) -> list[Any]:
    """Return the difference of each value from the one before; GONE where there is none."""
    found: list[Any] = []
    before: Any = _Absent
    for value in values:
        if value is _Absent:
            found.append(GONE)
        else:
            found.append([value] if before is _Absent else difference(before, value))
        before = value
    return found


def _prepared(line: EpisodeLine) -> Iterator[tuple[Path, Any]]:
    """Yield the entries of a step's line that no column of the index has, written so that little changes."""
    for key, value in line.items():
        if key not in ("step", "action", "motion", "utak", "retina", "belief"):
            yield (key,), value
    belief = dict(line["belief"])
    belief.pop("place", None)
    belief.pop("seen_from", None)
    split = split_facts(belief["facts"])
    if split is not None:
        del belief["facts"]
        yield ("facts", "others"), split.others
        yield ("facts", "corners"), split.corners
        yield ("facts", "confidences"), split.confidences
    below = ""
    for name in RETINA_TEXTS:
        text = belief.pop(name, None) if name != "retina" else "".join(map(str, line["retina"]))
        if text is None:
            continue
        plain = isinstance(text, str) and len(text) == 160 and set(text) <= set("01234567")
        if plain and below:
            yield ("retina", name), _above(text, below)
        else:
            yield ("retina", name), text
        below = text if plain else ""
    belief |= _letters(belief)
    for key, value in belief.items():
        yield ("belief", key), value


def _above(digits: str, below: str) -> str:
    """Return by how much each of some digits is above another one, modulo 8, as digits."""
    return "".join(str((int(a) - int(b)) % 8) for a, b in zip(digits, below, strict=True))


def _letters(belief: dict[str, Any]) -> dict[str, Any]:
    """Return `explained` as its facts and, for each explained field in order, the letter of its fact.

    Returns {} where it does not cover each field of status `e` just once, in ascending order, by at most 26 facts.
    """
    explained, status = belief.get("explained"), belief.get("status")
    if not isinstance(explained, dict) or not isinstance(status, str) or len(explained) > 26:
        return {}
    facts = list(explained)
    letter_of: dict[int, str] = {}
    for number, fields in enumerate(explained.values()):
        if not isinstance(fields, list) or not all(type(field) is int for field in fields) or fields != sorted(fields):
            return {}
        letter_of |= {field: chr(ord("a") + number) for field in fields}
    marked = [field for field, letter in enumerate(status) if letter == "e"]
    if sorted(letter_of) != marked or sum(map(len, explained.values())) != len(marked):
        return {}
    return {"explained": [facts, "".join(letter_of[field] for field in marked)]}
