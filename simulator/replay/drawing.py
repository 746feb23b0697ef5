"""Pictures of the table and of what is believed, as SVG without scripts, fonts or files from elsewhere.

Points are (x, y) in squares, x to the east and y to the north.
"""

import math
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from html import escape
from typing import Any, NamedTuple

from utak.geometry.counts.retina import FIELDS, MAX_GRAY_LEVEL
from utak.geometry.motion.se2 import direction
from utak.kb.language.atoms import atom_parts
from utak.kb.world.model import FACT_UNITS_PER_SQUARE
from utak.simulator.episode.episode import Episode
from utak.simulator.episode.record import world_at
from utak.simulator.world.world import VERGE_COLOUR, World

PIXELS_PER_SQUARE = 10  # of a picture of a small table; a convention
MAX_PICTURE_PIXELS = 640  # of the longer side of a picture; a convention
LETTER_HUES = {"r": 0, "o": 30, "y": 55, "g": 120, "c": 180, "t": 175, "a": 210, "p": 285, "v": 270, "m": 315}
BELIEVED_COLOUR, BELIEVED_THING_COLOUR = "#1f6fc4", "#c8322b"  # of floor and verge, and of objects
DOOR_COLOUR = "#b86f00"

CERTAIN_PERCENT = 95  # what is held with less is drawn as doubtful: 1 of 20, a convention
HATCH = (  # of what may be something else
    '<defs><pattern id="doubt" width="7" height="7" patternUnits="userSpaceOnUse" patternTransform="rotate(-45)">'
    f'<path d="M0 0V7" stroke="{BELIEVED_THING_COLOUR}" stroke-width="2"/></pattern></defs>'
)
HATCHED = "fill:url(#doubt)"

FACT_NUMBER = re.compile(r"-?[0-9]{1,9}")
# An edge of an outline; numbers of at most nine digits.
SEGMENT = re.compile(r"segment\(([a-z]\w*),\d{1,9}((?:,-?\d{1,9}){4}),(\d{1,9})\)\.", re.ASCII)
DrawnPoint = Sequence[float]


class PlacedFrame(NamedTuple):
    """The place of the robot frame on a picture."""

    x: float  # its origin, in squares of the picture's frame
    y: float
    degrees: float  # its rotation, counter-clockwise positive

    def place(self, east: float, north: float) -> tuple[float, float]:
        """Return a point of the robot frame in the picture's frame, in squares."""
        cosine, sine = direction(self.degrees)
        return self.x + east * cosine - north * sine, self.y + east * sine + north * cosine


class BelievedSegment(NamedTuple):
    """A segment of a believed outline."""

    node: str  # whose outline it is of
    start: tuple[float, float]  # its ends (east, north), squares, robot frame
    end: tuple[float, float]
    confidence: int  # percent


class Canvas:
    """A picture that is drawn part by part."""

    def __init__(self, west: float, south: float, east: float, north: float) -> None:
        self._west, self._north = west, north
        width, height = max(east - west, 1.0), max(north - south, 1.0)
        self._scale = min(PIXELS_PER_SQUARE, MAX_PICTURE_PIXELS / max(width, height))
        self._size = width * self._scale, height * self._scale
        self._parts: list[str] = []

    def polygons(self, rings: Iterable[Sequence[DrawnPoint]], style: str, title: str = "") -> None:
        """Draw closed rings as one area; what lies in an even number of them is left out."""
        data = " ".join("M" + " L".join(self._text(x, y) for x, y in ring) + "Z" for ring in rings)
        tip = f"<title>{escape(title)}</title>" if title else ""
        if data:
            self._parts.append(f'<path fill-rule="evenodd" style="{style}" d="{data}">{tip}</path>')

    def lines(self, points: Sequence[DrawnPoint], style: str) -> None:
        """Draw a line through points."""
        data = " ".join(self._text(x, y).replace(" ", ",") for x, y in points)
        self._parts.append(f'<polyline style="fill:none;{style}" points="{data}"/>')

    def disc(self, x: float, y: float, radius: float, style: str) -> None:
        """Draw a disc; its radius is in squares."""
        px, py = self._text(x, y).split(" ")
        self._parts.append(f'<circle cx="{px}" cy="{py}" r="{radius * self._scale:.1f}" style="{style}"/>')

    def word(self, x: float, y: float, text: str) -> None:
        """Write a word about a point."""
        px, py = self._text(x, y).split(" ")
        style = "font:11px sans-serif;text-anchor:middle;dominant-baseline:middle"
        self._parts.append(f'<text x="{px}" y="{py}" style="{style}">{escape(text)}</text>')

    def svg(self) -> str:
        """Return the picture."""
        width, height = self._size
        size = f'width="{width:.0f}" height="{height:.0f}" viewBox="0 0 {width:.1f} {height:.1f}"'
        ground = '<rect width="100%" height="100%" fill="#fff"/>'
        parts = "".join(self._parts)
        defined = HATCH if HATCHED in parts else ""
        return f'<svg xmlns="http://www.w3.org/2000/svg" {size}>{defined}{ground}{parts}</svg>'

    def _text(self, x: float, y: float) -> str:
        """Return a point in pixels, as SVG writes it."""
        return f"{(x - self._west) * self._scale:.1f} {(self._north - y) * self._scale:.1f}"


def table_svg(
    world: World,
    held: str | None = None,
    step: Mapping[str, Any] | None = None,
    track: Sequence[DrawnPoint] = (),
) -> str:
    """Return a picture of the table as it is, and upon it what is sensed and believed at a step.

    track : the places of Utak so far, the waking place first.
    """
    canvas = Canvas(0, 0, world.width, world.height)
    canvas.polygons(_rings(world.verge), f"fill:{letter_fill(VERGE_COLOUR)}")
    for thing in world.fixed:
        canvas.polygons(_rings(thing.polygon), f"fill:{letter_fill(thing.colour)};stroke:#444", f"{thing.name} (fixed)")
    for thing in world.movable:
        edge = "stroke:#000;stroke-width:2" if thing.name == held else "stroke:#777"
        canvas.polygons(_rings(thing.polygon), f"fill:{letter_fill(thing.colour)};{edge}", thing.name)
        canvas.word(thing.polygon.centroid.x, thing.polygon.centroid.y, thing.name)
    if step is not None:
        _draw_retina(canvas, world.utak, world.heading, step["retina"])
        x, y = track[0]
        _draw_segments(canvas, PlacedFrame(x, y, world.heading), step["belief"].get("facts", ()))
    if len(track) > 1:
        canvas.lines(track, "stroke:#2a7;stroke-width:1.5;stroke-dasharray:3 3")
    canvas.disc(*world.utak, 0.45, "fill:#2a7;stroke:#fff")
    return canvas.svg()


def step_svg(episode: Episode, line: dict[str, Any]) -> str:
    """Return a picture of the table at a step of an episode, and upon it what is sensed and believed."""
    track = [step["utak"] for step in episode.steps[: line["step"] + 1]]
    return table_svg(world_at(episode.header, line), line["held"], line, track)


def belief_svg(facts: Sequence[str], place: DrawnPoint) -> str:
    """Return a picture of what is believed alone, in the robot frame: hatched and dashed what may be otherwise."""
    ends = [(east, north) for _, start, end, _ in segments(facts) for east, north in (start, end)] or [(0.0, 0.0)]
    east, north = ([float(value) for value in values] for values in zip(*ends, (place[0], place[1]), strict=True))
    canvas = Canvas(min(east) - 1, min(north) - 1, max(east) + 1, max(north) + 1)
    doubtful = {name: share for name, share in _shares(facts, "object").items() if share < CERTAIN_PERCENT}
    for name in doubtful:
        canvas.polygons(_closed({start: end for node, start, end, _ in segments(facts) if node == name}), HATCHED)
    _draw_segments(canvas, PlacedFrame(0.0, 0.0, 0.0), facts)
    for name, (w, s, e, n) in dict(rectangles(facts)).items():
        if name not in ("floor", "verge"):
            word = f"{name} {doubtful[name]} %" if name in doubtful else name
            canvas.word((w + e) / 2 / FACT_UNITS_PER_SQUARE, (s + n) / 2 / FACT_UNITS_PER_SQUARE, word)
    _draw_doors(canvas, facts)
    canvas.disc(place[0], place[1], 0.45, "fill:#2a7;stroke:#fff")
    return canvas.svg()


def letter_fill(letter: str) -> str:
    """Return the colour with which things of a colour letter are drawn; verge is grey."""
    if letter == VERGE_COLOUR:
        return "#d4d4d4"
    hue = LETTER_HUES.get(letter, (ord(letter) - ord("a")) * 360 // 26)
    return f"hsl({hue},45%,78%)"


def segments(facts: Iterable[str]) -> Iterator[BelievedSegment]:
    """Yield each segment/7 among facts; damaged ones are left out."""
    for fact in facts:
        if found := SEGMENT.fullmatch(fact.replace(" ", "")):
            e1, n1, e2, n2 = (int(part) / FACT_UNITS_PER_SQUARE for part in found[2][1:].split(","))
            yield BelievedSegment(found[1], (e1, n1), (e2, n2), int(found[3]))


def rectangles(facts: Iterable[str]) -> Iterator[tuple[str, list[int]]]:
    """Yield the node and west, south, east, north (hundredths of squares, robot frame) of each rect/5 among facts."""
    for fact in facts:
        name, arguments = atom_parts(fact) if fact.startswith("rect(") else ("", ())
        if name and len(arguments) == 5 and all(FACT_NUMBER.fullmatch(part) for part in arguments[1:]):
            yield arguments[0], [int(part) for part in arguments[1:]]


def _closed(follows: dict[tuple[float, float], tuple[float, float]]) -> Iterator[list[tuple[float, float]]]:
    """Yield the rings of points that follow one another."""
    while follows:
        here, end = follows.popitem()
        ring = [here]
        while end in follows:
            ring.append(end)
            end = follows.pop(end)
        yield ring


def _shares(facts: Iterable[str], kind: str) -> dict[str, int]:
    """Return for each node of which kind/3 says `kind` its percent."""
    found = {}
    for fact in facts:
        name, arguments = atom_parts(fact) if fact.startswith("kind(") else ("", ())
        if name and len(arguments) == 3 and arguments[1] == kind and FACT_NUMBER.fullmatch(arguments[2]):
            found[arguments[0]] = int(arguments[2])
    return found


def _draw_doors(canvas: Canvas, facts: Iterable[str]) -> None:
    """Draw the lines of doors, dashed with their percent where they are in doubt."""
    doors, lines = {}, {}
    for fact in facts:
        name, arguments = atom_parts(fact) if fact.startswith(("door(", "threshold(")) else ("", ())
        if not all(FACT_NUMBER.fullmatch(part) for part in arguments[1:]):
            continue
        if name == "door" and len(arguments) == 2:
            doors[arguments[0]] = int(arguments[1])
        elif name == "threshold" and len(arguments) == 5:
            lines[arguments[0]] = [int(part) / FACT_UNITS_PER_SQUARE for part in arguments[1:]]
    for name, (e1, n1, e2, n2) in lines.items():
        share = doors.get(name, 100)
        dashes = ";stroke-dasharray:5 4" if share < CERTAIN_PERCENT else ""
        canvas.lines([(e1, n1), (e2, n2)], f"stroke:{DOOR_COLOUR};stroke-width:3{dashes}")
        canvas.word((e1 + e2) / 2, (n1 + n2) / 2, f"{name} {share} %" if share < 100 else name)


def _rings(shape: Any) -> list[Sequence[DrawnPoint]]:
    parts = [part for part in getattr(shape, "geoms", [shape]) if not part.is_empty]
    return [list(ring.coords)[:-1] for part in parts for ring in (part.exterior, *part.interiors)]


def _draw_retina(canvas: Canvas, utak: DrawnPoint, heading: float, levels: Sequence[int]) -> None:
    """Draw the fields of the retina that show something; the darker, the more of them is occupied."""
    pose = PlacedFrame(math.floor(utak[0]) + 0.5, math.floor(utak[1]) + 0.5, heading)
    for (east, north, side), level in zip(FIELDS, levels, strict=True):
        if level:
            corners = [(east, north), (east + side, north), (east + side, north + side), (east, north + side)]
            ring = [pose.place(e - 0.5, n - 0.5) for e, n in corners]
            style = f"fill:#333;fill-opacity:{0.4 * level / MAX_GRAY_LEVEL:.2f};stroke:#999;stroke-width:.3"
            canvas.polygons([ring], style)


def _draw_segments(canvas: Canvas, pose: PlacedFrame, facts: Iterable[str]) -> None:
    """Draw the boundaries that are believed; the stronger, the surer."""
    for name, start, end, confidence in segments(facts):
        colour = BELIEVED_COLOUR if name in ("floor", "verge") else BELIEVED_THING_COLOUR
        style = f"stroke:{colour};stroke-width:2;stroke-opacity:{0.2 + confidence / 125:.2f}"
        canvas.lines([pose.place(*start), pose.place(*end)], style)
