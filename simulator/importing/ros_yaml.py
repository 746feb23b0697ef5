"""The head of a ROS map (.yaml): the little of YAML that map servers write.

    file  = { key ":" value }                  a line each; "#" begins a comment; "---" may stand first, "..." last
    value = number | word | quoted text | "[" number { "," number } "]" | { newline "-" number }

Anchors, tags, nested mappings and texts over several lines are refused. So no document is larger than it looks.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass

from utak.kb.language.diagnostics import BadInputError, SourceSpan, did_you_mean
from utak.kb.language.source_text import Source

KEY_LINE = re.compile(r"([A-Za-z_][A-Za-z0-9_]*)[ \t]*:(?:[ \t]+(.*))?$")
ITEM_LINE = re.compile(r"[ \t]*-[ \t]+(\S+)[ \t]*$")
QUOTED = re.compile(r"\"([^\"\\]*)\"[ \t]*(?:#.*)?$|'([^']*)'[ \t]*(?:#.*)?$")
DECIMAL = re.compile(r"[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?")
FLAGS = {"true": 1.0, "false": 0.0, "yes": 1.0, "no": 0.0}  # words that some writers put for 1 and 0
KNOWN_KEYS = ("image", "resolution", "origin", "negate", "occupied_thresh", "free_thresh", "mode")
MODES = ("trinary", "scale", "raw")
MAX_LIST_ITEMS = 16  # values of a list; no key of a map has more than 3
MAX_METRES = 1e6  # metres of the origin, in absolute value; a convention


@dataclass(frozen=True)
class MapHead:
    """The head of a ROS map."""

    image: str  # the path of the image, as the file says it
    image_span: SourceSpan  # its place in the file
    resolution: float  # metres a pixel
    # Where the south-west corner of the image lies in the map's frame: x and y in metres, yaw in radians
    origin: tuple[float, float, float]
    negate: bool  # whether white is occupied, and black free
    occupied_thresh: float  # the shares of occupancy above which a pixel is occupied, and below which it is free
    free_thresh: float
    mode: str  # trinary, scale or raw


@dataclass(frozen=True)
class _Value:
    """The text of a value: one text, or the texts of a list; and its place."""

    span: SourceSpan
    text: str | None
    items: tuple[str, ...] = ()


def parse_head(source: Source) -> MapHead:
    """Return the head of a map that a text describes."""
    found = _values(source)
    for name in ("image", "resolution", "origin"):
        if name not in found:
            near = [key for key in found if key not in KNOWN_KEYS]
            hint = next((f"is {key} meant?" for key in near if did_you_mean(key, [name])), "")
            raise BadInputError([source.problem(source.start(), f"the key {name} is missing", hint)])
    image = found["image"]
    if not image.text:
        raise BadInputError([source.problem(image.span, "image must be the path of a file")])
    if not image.text.isprintable():
        raise BadInputError([source.problem(image.span, "the path of the image has a control character")])
    mode = found.get("mode")
    if mode is not None and mode.text not in MODES:
        hint = did_you_mean(str(mode.text), MODES)
        raise BadInputError([source.problem(mode.span, f"mode must be one of {', '.join(MODES)}", hint)])
    origin = _origin(source, found["origin"])
    occupied = _number(source, found, "occupied_thresh", 0, 1, 0.65)
    free = _number(source, found, "free_thresh", 0, 1, 0.196)
    if free > occupied:
        span = found.get("free_thresh", found.get("occupied_thresh", image)).span
        raise BadInputError([source.problem(span, f"free_thresh {free:g} is above occupied_thresh {occupied:g}")])
    return MapHead(
        image.text,
        image.span,
        _number(source, found, "resolution", 1e-6, MAX_METRES, None),
        origin,
        _number(source, found, "negate", 0, 1, 0.0) != 0,
        occupied,
        free,
        mode.text if mode is not None and mode.text else "trinary",
    )


def _values(source: Source) -> dict[str, _Value]:
    """Return the value of each key; raise BadInputError at the first line that is not as the module says."""
    found: dict[str, _Value] = {}
    listed: str | None = None  # the key whose list is being read
    for number, line in enumerate(source.lines, 1):
        text = line.rstrip()
        bare = text.lstrip()
        if not bare or bare.startswith("#") or text in ("---", "...") or text.startswith("%YAML"):
            continue
        item = ITEM_LINE.match(re.sub(r"[ \t]#.*", "", text))
        if item and listed is not None:
            value = found[listed]
            if len(value.items) >= MAX_LIST_ITEMS:
                what = f"a list of more than {MAX_LIST_ITEMS} values"
                raise BadInputError([source.problem(SourceSpan(number, 1, len(text)), what)])
            found[listed] = _Value(value.span, None, (*value.items, item[1]))
            continue
        span = SourceSpan(number, len(text) - len(bare) + 1, len(text))
        key = KEY_LINE.match(text)
        if key is None:
            hint = "a ROS map is described by lines such as resolution: 0.05"
            raise BadInputError([source.problem(span, "this is no line of a ROS map's head", hint)])
        if key[1] in found:
            raise BadInputError([source.problem(SourceSpan(number, 1, len(key[1])), f"{key[1]} is given twice")])
        start = key.start(2) + 1 if key[2] else len(text)
        found[key[1]] = _value(source, key[2] or "", SourceSpan(number, start, len(text)))
        listed = key[1] if not key[2] else None
    return found


def _value(source: Source, text: str, span: SourceSpan) -> _Value:
    """Return a value of one line; raise BadInputError for what this reader refuses."""
    quoted = QUOTED.match(text)
    if quoted:
        return _Value(span, quoted[1] if quoted[1] is not None else quoted[2])
    text = re.sub(r"(?:^|[ \t])#.*", "", text).strip()
    if text.startswith("["):
        if not text.endswith("]"):
            raise BadInputError([source.problem(span, "a list that does not end on its line", "close it with ]")])
        return _Value(span, None, tuple(part.strip() for part in text[1:-1].split(",")))
    if text[:1] in tuple("&*!|>{}@`\"'%"):
        what = f"{text[:1]!r} begins something that this reader does not know"
        raise BadInputError([source.problem(span, what, "write a number, a word, or [a, b, c]")])
    return _Value(span, text)


def _origin(source: Source, value: _Value) -> tuple[float, float, float]:
    """Return x and y in metres and yaw in radians; raise BadInputError when there are no such three numbers."""
    numbers = [float(item) for item in value.items if DECIMAL.fullmatch(item)]
    if len(value.items) != 3 or len(numbers) != 3 or not all(abs(number) <= MAX_METRES for number in numbers):
        what = f"origin must be three numbers of at most {MAX_METRES:g}: x and y in metres, yaw in radians"
        raise BadInputError([source.problem(value.span, what, "such as [-10.0, -10.0, 0.0]")])
    return numbers[0], numbers[1], numbers[2]


def _number(
    source: Source, found: Mapping[str, _Value], name: str, low: float, high: float, otherwise: float | None
) -> float:
    """Return the number of a key, or `otherwise` without the key; raise BadInputError unless it is in bounds."""
    if name not in found and otherwise is not None:
        return otherwise
    value = found[name]
    text = (value.text or "").lower()
    number = FLAGS.get(text) if name == "negate" else None
    if number is None and DECIMAL.fullmatch(text):
        number = float(text)
    if number is None or not low <= number <= high:
        raise BadInputError([source.problem(value.span, f"{name} must be a number from {low:g} to {high:g}")])
    return number
