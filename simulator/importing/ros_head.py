"""The head of a ROS map (.yaml): a few keys with their values, read by PyYAML as nodes that know their places.

Nothing but texts and lists of texts is made of the nodes, so that no tag or alias does anything.
"""

import re
from dataclasses import dataclass

import yaml

from utak.kb.language.diagnostics import BadInputError, SourceSpan, did_you_mean
from utak.kb.language.source_text import Source

DECIMAL = re.compile(r"[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?")
FLAGS = {"true": 1.0, "false": 0.0, "yes": 1.0, "no": 0.0}  # words that some writers put for 1 and 0
NEEDED_KEYS = ("image", "resolution", "origin")
KNOWN_KEYS = (*NEEDED_KEYS, "negate", "occupied_thresh", "free_thresh", "mode")
MODES = ("trinary", "scale", "raw")
MAX_HEAD_BYTES = 65_536  # bytes: a second of reading; a convention
MAX_METRES = 1e6  # metres of the origin, in absolute value; a convention


@dataclass(frozen=True)
class MapHead:
    """The head of a ROS map."""

    image: str = ""  # the path of the image, as the file says it
    resolution: float = 0.05  # metres a pixel
    # Where the south-west corner of the image lies in the map's frame: x and y in metres, yaw in radians
    origin: tuple[float, float, float] = (0.0, 0.0, 0.0)
    negate: bool = False  # whether white is occupied, and black free
    occupied_thresh: float = 0.65  # the shares of occupancy above which a pixel is occupied, and below which it is free
    free_thresh: float = 0.196
    mode: str = "trinary"  # trinary, scale or raw


class _Values:
    """The values of a head by key; a value that is missing or wrong is an error at its place."""

    def __init__(self, source: Source) -> None:
        self._source = source
        try:
            root = yaml.compose(source.text, yaml.SafeLoader)
        except (yaml.YAMLError, RecursionError) as error:
            mark = getattr(error, "problem_mark", None) or getattr(error, "context_mark", None)
            what = (
                f"this is no YAML: {getattr(error, 'problem', None) or getattr(error, 'reason', 'nested too deeply')}"
            )
            place = source.start() if mark is None else SourceSpan(mark.line + 1, mark.column + 1, mark.column + 1)
            raise BadInputError([source.problem(place, what)]) from None
        if not isinstance(root, yaml.MappingNode):
            hint = "a ROS map is described by lines such as resolution: 0.05"
            raise BadInputError([source.problem(source.start(), "this is no head of a ROS map", hint)])
        self._nodes: dict[str, yaml.Node] = {}
        for key, value in root.value:
            if not isinstance(key, yaml.ScalarNode) or key.value in self._nodes:
                raise self.wrong(
                    key, "this key is given twice" if isinstance(key, yaml.ScalarNode) else "this is no key"
                )
            self._nodes[key.value] = value
        for name in NEEDED_KEYS:
            if name not in self._nodes:
                near = (key for key in self._nodes if key not in KNOWN_KEYS and did_you_mean(key, [name]))
                hint = next((f"is {key[:40]} meant?" for key in near), "")
                raise BadInputError([source.problem(source.start(), f"the key {name} is missing", hint)])

    def wrong(self, key: "str | yaml.Node", what: str, hint: str = "") -> BadInputError:
        """Return the error `what` at the value of a key, or at a node."""
        node = self._nodes[key] if isinstance(key, str) else key
        line, first, end = node.start_mark.line, node.start_mark.column, node.end_mark.column
        last = end if node.end_mark.line == line else len(self._source.lines[line])
        return BadInputError([self._source.problem(SourceSpan(line + 1, first + 1, max(first + 1, last)), what, hint)])

    def text(self, name: str, otherwise: str = "") -> str:
        """Return a text."""
        node = self._nodes.get(name)
        if node is not None and not isinstance(node, yaml.ScalarNode):
            raise self.wrong(name, f"{name} must be a single value")
        return otherwise if node is None else node.value

    def number(self, name: str, low: float, high: float, otherwise: float) -> float:
        """Return a number in bounds; `otherwise` without the key."""
        text = self.text(name, repr(otherwise)).lower()
        number = FLAGS.get(text) if name == "negate" else None
        if number is None and DECIMAL.fullmatch(text):
            number = float(text)
        if number is None or not low <= number <= high:
            raise self.wrong(name, f"{name} must be a number from {low:g} to {high:g}")
        return number

    def place(self, name: str) -> tuple[float, float, float]:
        """Return x and y in metres and yaw in radians."""
        node = self._nodes[name]
        items = [one.value for one in node.value] if isinstance(node, yaml.SequenceNode) else []
        numbers = [float(one) for one in items if isinstance(one, str) and DECIMAL.fullmatch(one)]
        if len(items) != 3 or len(numbers) != 3 or not all(abs(number) <= MAX_METRES for number in numbers):
            what = f"{name} must be three numbers of at most {MAX_METRES:g}: x and y in metres, yaw in radians"
            raise self.wrong(name, what, "such as [-10.0, -10.0, 0.0]")
        return numbers[0], numbers[1], numbers[2]


def parse_head(source: Source) -> MapHead:
    """Return the head of a map that a text describes."""
    values = _Values(source)
    image, mode = values.text("image"), values.text("mode", MapHead.mode)
    if not image or not image.isprintable():
        raise values.wrong("image", "image must be the path of a file")
    if mode not in MODES:
        raise values.wrong("mode", f"mode must be one of {', '.join(MODES)}", did_you_mean(mode, MODES))
    occupied = values.number("occupied_thresh", 0, 1, MapHead.occupied_thresh)
    free = values.number("free_thresh", 0, 1, MapHead.free_thresh)
    if free > occupied:
        named = "free_thresh" if values.text("free_thresh") else "occupied_thresh"
        raise values.wrong(named, f"free_thresh {free:g} is above occupied_thresh {occupied:g}")
    resolution = values.number("resolution", 1e-6, MAX_METRES, 0)
    negate = values.number("negate", 0, 1, 0) != 0
    return MapHead(image, resolution, values.place("origin"), negate, occupied, free, mode)
