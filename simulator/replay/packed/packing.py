"""An episode packed for a page: what changes from step to step, in blocks that are read one by one.

A packed episode is a list of texts (`simulator.replay.packed.short_texts`): an index, then the blocks. The index has

- `header`, `result`: those of the episode;
- `columns`: `action`, `motion`, `utak`, `place` and `seen_from` of all steps (`simulator.replay.packed.tracks`);
- `events`: the steps of each kind of event; `bounds`: the least and greatest coordinates of floor and things;
- `steps`, `block`: how many steps the episode and a block have; `detail`: what is kept of decisions.

A block has one column for every key of its lines, `[path, differences]`, each difference from the value of
the step before in the same block; the first step of a block differs from nothing. `page_parts/decode.js` reads this.
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from simulator.episode.episode import Episode, EpisodeLine
from simulator.replay.packed.decisions import DETAILS, by_encoding, route_points, trimmed
from simulator.replay.packed.delta import GONE, difference
from simulator.replay.packed.impressions import pack_impression
from simulator.replay.packed.outlines import split_facts
from simulator.replay.packed.short_texts import short_text
from simulator.replay.packed.tracks import believed_place, offset_facts, places_anew, poses, track_columns

STEPS_PER_BLOCK = (
    500  # a compromise: longer blocks pack better, shorter ones are read faster; benchmarks/episodes/replay.py
)
# Bytes of a packed episode of up to STEPS_PER_BLOCK steps, and for each step more, that may be exceeded only when no
# detail of decisions is left to leave out. With the player, 500 steps have 150 KB and 5,000 steps 1.5 MB; a convention.
PACKED_BYTES = 115_000
BYTES_PER_STEP = 285
MAX_SAFE_INTEGER = 2**53  # the greatest integer that a browser's numbers hold exactly
Path = tuple[str, ...]  # the keys that lead to a value of a step's line


def packed_episode(
    episode: Episode, events: Mapping[str, Sequence[int]], trees: Mapping[int, Sequence[Any]] | None = None
) -> list[str]:
    """Return an episode as the texts that a page holds."""
    lines = [slim(line) for line in episode.steps]
    blocks = [lines[first : first + STEPS_PER_BLOCK] for first in range(0, len(lines), STEPS_PER_BLOCK)]
    movable = episode.header["world"]["movable"]
    columns = [_columns(block, movable, trees or {}) for block in blocks]
    index = {
        "header": slim(episode.header),
        "result": slim(episode.result),
        "steps": len(lines),
        "columns": track_columns(lines),
        "events": dict(events),
        "bounds": _bounds(lines),
        "block": STEPS_PER_BLOCK,
    }
    budget = PACKED_BYTES + BYTES_PER_STEP * max(0, len(lines) - STEPS_PER_BLOCK)
    texts: list[str] = []
    for detail in DETAILS:
        parts = [columns[n] + _decisions(block, detail) for n, block in enumerate(blocks)]
        texts = [short_text([{**index, "detail": list(detail)}]), *map(short_text, parts)]
        if sum(map(len, texts)) <= budget:
            break
    return texts


def kept_line(line: EpisodeLine, detail: tuple[int, int] = DETAILS[0]) -> EpisodeLine:
    """Return a step's line with its decisions cut to a detail (`simulator.replay.packed.decisions.trimmed`)."""
    solved = line["belief"].get("solved")
    if not isinstance(solved, list):
        return line
    return line | {"belief": line["belief"] | {"solved": [trimmed(entry, detail) for entry in solved]}}


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


def _bounds(lines: Sequence[EpisodeLine]) -> list[int] | None:
    """Return the least east and north, and the greatest, of all rectangles, in hundredths of squares, robot frame."""
    # Returns None when there are none.
    found: set[str] = set()
    for line in lines:
        found.update(fact for fact in line["belief"]["facts"] if fact.startswith("rect(") and fact[5:11] != "verge,")
    boxes = []
    for fact in sorted(found):
        parts = fact[len("rect(") : -len(").")].split(",")[1:]
        if len(parts) == 4 and all(part.removeprefix("-").isdecimal() and len(part) < 10 for part in parts):
            boxes.append([int(part) for part in parts])
    if not boxes:
        return None
    west, south, east, north = zip(*boxes, strict=True)
    return [min(west), min(south), max(east), max(north)]


def _columns(
    lines: Sequence[EpisodeLine], movable: Mapping[str, EpisodeLine], trees: Mapping[int, Sequence[Any]]
) -> list[Any]:
    """Return the columns of a block but for decisions: pairs of a path of keys, and the differences between steps."""
    prepared = [dict(_prepared(line, movable)) for line in lines]
    for line, values in zip(lines, prepared, strict=True):
        if line["step"] in trees:
            values["replay", "trees"] = slim(list(trees[line["step"]]))
    paths = dict.fromkeys(path for line in prepared for path in line)
    return [[list(path), _differences([line.get(path, _Absent) for line in prepared])] for path in paths]


def _decisions(lines: Sequence[EpisodeLine], detail: tuple[int, int]) -> list[Any]:
    """Return the column of the decisions of a block, cut to a detail; [] where no step records decisions."""
    values: list[Any] = []
    before: dict[str, Any] | None = None
    for line in lines:
        solved = kept_line(line, detail)["belief"].get("solved")
        if isinstance(solved, list):
            before = by_encoding(solved, before, route_points(line))
        values.append(before if isinstance(solved, list) else _Absent)
    return [[["packed", "solved"], _differences(values)]] if before is not None else []


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


def _prepared(line: EpisodeLine, movable: Mapping[str, EpisodeLine]) -> Iterator[tuple[Path, Any]]:
    """Yield the entries of a step's line that no column of the index has, written so that little changes."""
    for key, value in line.items():
        if key not in ("step", "action", "motion", "utak", "objects", "retina", "belief"):
            yield (key,), value
    yield ("objects",), poses(line["objects"], movable)
    impression, belief = pack_impression(line)
    for key, value in impression.items():
        yield ("packed", key), value
    place = believed_place(line)
    if place is not None:
        del belief["place"]
    if places_anew(line) is not None:
        del belief["seen_from"]
    if isinstance(belief.get("solved"), list):
        del belief["solved"]  # _decisions
    split = split_facts(belief["facts"])
    if split is not None:
        del belief["facts"]
        told = place is not None and set(offset_facts(place)) <= set(split.others)
        yield ("facts", "offsets"), told
        yield ("facts", "others"), [f for f in split.others if not told or f not in offset_facts(place or [])]
        yield ("facts", "corners"), split.corners
        yield ("facts", "confidences"), split.confidences
    for key, value in belief.items():
        yield ("belief", key), value
