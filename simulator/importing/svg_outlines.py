"""Outlines that an SVG picture draws (SVG 2, chapters 5 to 10); path data is read by the library svg.path.

Curves become chords that stay within a tolerance of them. Points are (x, y) as in SVG: x to the right, y DOWN.
"""

import math
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
import shapely
from svg.path import Arc, Close, CubicBezier, Move, QuadraticBezier, parse_path

from utak.kb.language.source_text import MAX_FILE_BYTES, Source
from utak.simulator.importing.xml_tree import MAX_XML_DEPTH, XmlElement, xml_error

SVG_NUMBER = re.compile(r"[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?")
LENGTH = re.compile(rf"({SVG_NUMBER.pattern})(px|mm|cm|in|pt|pc|%|)")
UNIT_LENGTHS = {"": 1.0, "px": 1.0, "mm": 96 / 25.4, "cm": 96 / 2.54, "in": 96.0, "pt": 96 / 72, "pc": 16.0}
SEPARATOR = re.compile(r"[ \t\r\n\f]*,[ \t\r\n\f]*|[ \t\r\n\f]+")
NOT_IN_PATHS = re.compile(r"[^MmZzLlHhVvCcSsQqTtAaEe0-9+\-., \t\r\n\f]")
TRANSFORM = re.compile(r"([A-Za-z]+)[ \t\r\n\f]*\(([^()]*)\)[ \t\r\n\f,]*")
SKIPPED_TAGS = ("defs", "metadata", "namo_config", "clipPath", "mask", "symbol", "pattern", "marker")  # not drawn
SHAPE_TAGS = ("path", "rect", "circle", "ellipse", "polygon", "polyline")
MAX_CHORDS = 256  # chords for one curve; a convention
MAX_PATH_CHARACTERS = 200_000  # characters of all path data of a picture: seconds of reading; a convention
MAX_DRAWN_ELEMENTS = 20_000  # elements that are drawn, again where they are used again; a convention
# Characters of the attributes of drawn elements, again where they are used again; derived: a file without `use` has no
# more.
MAX_DRAWN_CHARACTERS = MAX_FILE_BYTES
MAX_PATH_PARTS = 200  # closed parts of one path; a convention
MAX_DRAWN_POINTS = 1_000_000  # points of all outlines, which arcs make of few letters; a convention
MAX_UNITS = 1e9  # user units of a coordinate, and how much transforms stretch, in absolute value; a convention
MAX_REACH = 1e6  # units of the target of a coordinate, in absolute value; a convention
MIN_ARC_STEP = 1e-3  # radians of a chord of an arc; fewer make more chords than `MAX_CHORDS`
TRANSFORMS: dict[str, Callable[..., tuple[float, ...]]] = {  # (a, b, c, d, e, f) of each, as for `matrix`
    "matrix": lambda a, b, c, d, e, f: (a, b, c, d, e, f),
    "translate": lambda x, y=0.0: (1, 0, 0, 1, x, y),
    "translateX": lambda x: (1, 0, 0, 1, x, 0),
    "translateY": lambda y: (1, 0, 0, 1, 0, y),
    "scale": lambda x, y=None: (x, 0, 0, x if y is None else y, 0, 0),
    "scaleX": lambda x: (x, 0, 0, 1, 0, 0),
    "scaleY": lambda y: (1, 0, 0, y, 0, 0),
    "skewX": lambda degrees: (1, 0, math.tan(math.radians(degrees)), 1, 0, 0),
    "skewY": lambda degrees: (1, math.tan(math.radians(degrees)), 0, 1, 0, 0),
    "rotate": lambda degrees, x=0.0, y=0.0: _rotation(math.radians(degrees), x, y),
}
NOTED = {  # what is not heeded, by the element or property that asks for it
    "<style>": "Style sheets of the picture are not read; styles of elements are.",
    "clip-path": "Nothing is clipped or masked.",
    "mask": "Nothing is clipped or masked.",
    "transform-origin": "transform-origin is not read.",
}

Matrix = npt.NDArray[np.float64]  # (3, 3): maps points (x, y, 1)
SvgRing = npt.NDArray[np.float64]  # (points, 2)


class SvgError(ValueError):
    """A text is not as SVG wants it; the message says why."""


class DrawnShape(NamedTuple):
    """An element with an outline."""

    element: XmlElement  # the element
    type: str  # its attribute `type`, or that of the nearest group that has one, or ''
    ids: frozenset[str]  # its own id and those of the groups around it
    rings: tuple[SvgRing, ...]  # its rings, in the target's frame
    even_odd: bool  # whether its fill rule is even-odd; else non-zero


@dataclass(frozen=True)
class _Context:
    """Holds what an element inherits from those around it."""

    transform: Matrix
    viewport: tuple[float, float]  # width and height, in user units
    type: str = ""
    ids: frozenset[str] = frozenset()
    even_odd: bool = False
    visible: bool = True
    depth: int = 0  # elements around it, also those that use it


class SvgPicture:
    """A picture whose outlines are wanted in a frame of their own."""

    def __init__(self, source: Source, root: XmlElement, to_target: Matrix, size: tuple[float, float]) -> None:
        # to_target : from user units. size : width and height of the view box.
        self._source, self._root = source, root
        self._first = _Context(to_target, size)
        self._by_id = {one.attributes["id"]: one for one in reversed([*root.descendants()]) if "id" in one.attributes}
        self._points = self._characters = 0
        self.notes: set[str] = set()  # what of the picture is not heeded, a sentence each

    def shapes(self, tolerance: float) -> Iterator[DrawnShape]:
        """Yield the drawn elements with an outline, in the order of the picture; chords lie near curves."""
        # tolerance : units of the target.
        waiting, visits, characters = [(self._root, self._first)], 0, 0
        while waiting:
            element, context = waiting.pop()
            visits += 1
            characters += sum(map(len, element.attributes.values()))
            for count, most, what in (
                (visits, MAX_DRAWN_ELEMENTS, "elements are drawn"),
                (characters, MAX_DRAWN_CHARACTERS, "characters of attributes are drawn"),
                (context.depth, MAX_XML_DEPTH, "elements are drawn within each other"),
            ):
                if count > most:
                    raise xml_error(self._source, element, "", f"more than {most} {what}")
            properties = properties_of(element)
            self.notes |= {NOTED[name] for name in (f"<{element.tag}>", *properties) if name in NOTED}
            if element.tag in SKIPPED_TAGS or properties.get("display") == "none":
                continue
            try:
                context = self._within(element, properties, context)
                if element.tag in SHAPE_TAGS and context.visible:
                    rings = self._rings(element, context, tolerance)
                    yield DrawnShape(element, context.type, context.ids, rings, context.even_odd)
                children = self._used(element) if element.tag == "use" else element.children
            except SvgError as error:
                raise xml_error(self._source, element, *error.args) from None
            waiting += [(child, context) for child in reversed(children)]

    def _within(self, element: XmlElement, properties: Mapping[str, str], around: _Context) -> _Context:
        """Return what an element hands on to those in it."""
        transform, viewport = around.transform @ parse_transform(properties.get("transform", "")), around.viewport
        if element.tag == "use":
            transform = transform @ matrix(1, 0, 0, 1, *_lengths(element, viewport, x="0", y="0"))
        elif element.tag == "svg" and element is not self._root:
            inner, viewport = _viewport(element, viewport)
            transform = transform @ inner
            self.notes.add("What lies beyond an inner svg element is drawn, too.")
        if not (np.abs(transform) <= MAX_UNITS).all():
            raise SvgError("transform", f"a transform that stretches or moves by more than {MAX_UNITS:g}")
        return replace(
            around,
            transform=transform,
            viewport=viewport,
            type=properties.get("type", around.type),
            ids=around.ids | ({properties["id"]} if "id" in properties else set()),
            even_odd=properties["fill-rule"] == "evenodd" if "fill-rule" in properties else around.even_odd,
            visible=properties["visibility"] == "visible" if "visibility" in properties else around.visible,
            depth=around.depth + 1,
        )

    def _used(self, use: XmlElement) -> list[XmlElement]:
        """Return what a `use` element draws."""
        name = use.attributes.get("href", use.attributes.get("xlink:href", ""))
        found = self._by_id.get(name[1:]) if name[:1] == "#" else None
        if found is None:
            raise SvgError("xlink:href" if "xlink:href" in use.attributes else "href", f"{name[:40]!r} is no element")
        if found.tag in ("symbol", "svg"):
            size = {key: use.attributes[key] for key in ("width", "height") if key in use.attributes}
            return [XmlElement("svg", found.attributes | size, found.at, found.children)]
        return [found]

    def _rings(self, element: XmlElement, context: _Context, tolerance: float) -> tuple[SvgRing, ...]:
        """Return the rings of a shape in the target's frame."""
        data = _path_data(element, context.viewport)
        self._characters += len(data)
        if self._characters > MAX_PATH_CHARACTERS:
            raise SvgError("d", f"path data of more than {MAX_PATH_CHARACTERS} characters up to here")
        stretch = max(1e-9, float(np.abs(context.transform[:2, :2]).max()))
        rings = rings_of(data, tolerance / stretch)
        self._points += sum(map(len, rings))
        placed = tuple(ring @ context.transform[:2, :2].T + context.transform[:2, 2] for ring in rings)
        if self._points > MAX_DRAWN_POINTS:
            raise SvgError("d", f"the outlines up to here have more than {MAX_DRAWN_POINTS} points")
        if not all((np.abs(ring) <= MAX_REACH).all() for ring in placed):
            raise SvgError("d", f"an outline reaches more than {MAX_REACH:g} squares away")
        return placed


def properties_of(element: XmlElement) -> dict[str, str]:
    """Return the attributes of an element, and in their place the properties that its style declares."""
    declared = (part.partition(":") for part in element.attributes.get("style", "").split(";"))
    return element.attributes | {name.strip().lower(): value.strip() for name, colon, value in declared if colon}


def parse_transform(text: str) -> Matrix:
    """Return the map that a list of transforms describes; lengths in px, angles in degrees."""
    text = "" if text.strip() == "none" else text.strip()
    whole, end = np.eye(3), 0
    while end < len(text):
        found = TRANSFORM.match(text, end)  # a search would look for a bracket behind each letter of a long word
        if found is None:
            raise SvgError("transform", f"{text[end : end + 20]!r} is no transform")
        end, (name, words) = found.end(), found.groups()
        numbers = [word.removesuffix("px").removesuffix("deg") for word in SEPARATOR.split(words.strip())]
        if not all(map(SVG_NUMBER.fullmatch, numbers)):
            raise SvgError("transform", f"the transform {name[:20]} needs numbers")
        try:
            whole = whole @ matrix(*TRANSFORMS[name](*map(float, numbers)))
        except (KeyError, TypeError, ValueError):
            raise SvgError("transform", f"{name[:20]} with {len(numbers)} numbers is no transform") from None
    return whole


def matrix(a: float, b: float, c: float, d: float, e: float, f: float) -> Matrix:
    """Return the map that takes (x, y) to (a x + c y + e, b x + d y + f)."""
    return np.array([[a, c, e], [b, d, f], [0, 0, 1]], float)


def _rotation(angle: float, x: float, y: float) -> tuple[float, ...]:
    cos, sin = math.cos(angle), math.sin(angle)
    return cos, sin, -sin, cos, x - cos * x + sin * y, y - sin * x - cos * y


def _viewport(element: XmlElement, around: tuple[float, float]) -> tuple[Matrix, tuple[float, float]]:
    """Return the map of an inner svg element's user units to those around it, and its width and height in its own."""
    x, y, width, height = _lengths(element, around, x="0", y="0", width="100%", height="100%")
    box = numbers_in(element.attributes.get("viewBox", ""))
    if len(box) != 4 or not (box[2] > 0 and box[3] > 0):
        return matrix(1, 0, 0, 1, x, y), (width, height)
    across, down = width / box[2], height / box[3]
    ratio = element.attributes.get("preserveAspectRatio", "xMidYMid").split()
    if ratio not in (["none"], ["xMidYMid"], ["xMidYMid", "meet"]):
        raise SvgError("preserveAspectRatio", "preserveAspectRatio is read as xMidYMid or none")
    if ratio != ["none"]:
        across = down = min(across, down)
        x, y = x + (width - across * box[2]) / 2, y + (height - down * box[3]) / 2
    return matrix(across, 0, 0, down, x - across * box[0], y - down * box[1]), (box[2], box[3])


def numbers_in(text: str) -> list[float]:
    """Return the numbers in a text; [] when it holds something else, or too great numbers."""
    words = SEPARATOR.split(text.strip())
    numbers = [float(word) for word in words] if all(map(SVG_NUMBER.fullmatch, words)) else []
    return numbers if all(abs(number) <= MAX_UNITS for number in numbers) else []


def _lengths(element: XmlElement, viewport: tuple[float, float], **defaults: str) -> list[float]:
    """Return lengths of an element in user units. defaults : by the attribute."""
    across, down = viewport
    lengths = []
    for name, default in defaults.items():
        found = LENGTH.fullmatch(element.attributes.get(name, default).strip())
        whole = {"x": across, "h": across, "y": down, "t": down}.get(name[-1], math.hypot(across, down) / math.sqrt(2))
        length = float(found[1]) * (whole / 100 if found[2] == "%" else UNIT_LENGTHS[found[2]]) if found else math.inf
        if not abs(length) <= MAX_UNITS:
            raise SvgError(name, f"{name} must be a number, with a unit or without")
        lengths.append(length)
    return lengths


def _path_data(element: XmlElement, viewport: tuple[float, float]) -> str:
    """Return the path data of a shape; '' when it has no extent."""
    given = element.attributes
    if element.tag == "path":
        return given.get("d", "")
    if element.tag in ("polygon", "polyline"):
        return f"M {given['points']} z" if given.get("points", "").strip() else ""
    if element.tag == "rect":
        x, y, width, height = _lengths(element, viewport, x="0", y="0", width="0", height="0")
        rx, ry = _lengths(element, viewport, rx=given.get("ry", "0"), ry=given.get("rx", "0"))
        rx, ry = min(rx, width / 2), min(ry, height / 2)
        if not (rx > 0 and ry > 0):
            return f"M {x!r} {y!r} h {width!r} v {height!r} h {-width!r} z" if width > 0 and height > 0 else ""
        turn = f"a {rx!r} {ry!r} 0 0 1"
        return (
            f"M {x + rx!r} {y!r} h {width - 2 * rx!r} {turn} {rx!r} {ry!r} v {height - 2 * ry!r} {turn} {-rx!r} {ry!r} "
            f"h {2 * rx - width!r} {turn} {-rx!r} {-ry!r} v {2 * ry - height!r} {turn} {rx!r} {-ry!r} z"
        )
    radii = {"r": "0"} if element.tag == "circle" else {"rx": given.get("ry", "0"), "ry": given.get("rx", "0")}
    x, y, *both = _lengths(element, viewport, cx="0", cy="0", **radii)
    rx, ry = both[0], both[-1]
    half = f"a {rx!r} {ry!r} 0 0 1"
    return f"M {x - rx!r} {y!r} {half} {2 * rx!r} 0 {half} {-2 * rx!r} 0 z" if rx > 0 and ry > 0 else ""


def rings_of(data: str, tolerance: float) -> list[SvgRing]:
    """Return the closed rings of path data; a part that is not closed is closed by a chord.

    Examples
    --------
    >>> [ring.tolist() for ring in rings_of("M 0 0 h 4 v 2 H 0 z", 0.1)]
    [[[0.0, 0.0], [4.0, 0.0], [4.0, 2.0], [0.0, 2.0]]]
    """
    wrong = NOT_IN_PATHS.search(data)
    if wrong:
        raise SvgError("d", f"{wrong[0]!r} is no command of a path")
    try:
        path = parse_path(data)
    except (ValueError, ArithmeticError, AssertionError, IndexError):
        raise SvgError("d", "this is no path: a command is cut short, or has wrong numbers") from None
    if len(path) and not isinstance(path[0], Move):
        raise SvgError("d", "a path begins with M")
    rings: list[list[complex]] = []
    for part in path:
        if isinstance(part, Move | Close):
            rings.append([part.end])
        else:
            rings[-1] += _chords(part, tolerance)
    if len(rings) > MAX_PATH_PARTS:
        raise SvgError("d", f"a path of more than {MAX_PATH_PARTS} parts")
    found = []
    for ring in rings:
        points = np.array(ring)
        points = points[points != np.roll(points, -1)]
        if not (np.abs(points) <= MAX_UNITS).all():
            raise SvgError("d", f"a path needs numbers of at most {MAX_UNITS:g}")
        if len(points) >= 3:
            found.append(np.column_stack([points.real, points.imag]))
    return found


def _chords(part: Any, tolerance: float) -> list[complex]:
    """Return the ends of the chords of a part of a path, without its begin."""
    if isinstance(part, Arc) and part.start != part.end and part.radius.real and part.radius.imag:
        radius = part.radius_scale * max(part.radius.real, part.radius.imag)
        most = 2 * math.acos(max(0.0, 1 - tolerance / max(radius, tolerance)))
        count = abs(math.radians(part.delta)) / max(most, MIN_ARC_STEP)
    elif isinstance(part, CubicBezier | QuadraticBezier):
        controls = (part.control1, part.control2) if isinstance(part, CubicBezier) else (part.control,)
        points = [part.start, *controls, part.end]
        bend = max(abs(p - 2 * q + r) for p, q, r in zip(points, points[1:], points[2:], strict=False))
        degree = len(points) - 1
        count = math.sqrt(degree * (degree - 1) / 8 * bend / tolerance)
    else:
        return [part.end]
    if not math.isfinite(count):
        raise SvgError("d", f"a path needs numbers of at most {MAX_UNITS:g}")
    whole = min(MAX_CHORDS, max(1, math.ceil(count)))
    return [*(part.point(step / whole) for step in range(1, whole)), part.end]


def filled_area(rings: Iterable[SvgRing], even_odd: bool) -> Any:
    """Return what rings fill, a shapely geometry; raise SvgError when a ring is no simple polygon."""
    parts = []
    for ring in rings:
        part = shapely.Polygon(ring)
        if not part.is_valid or part.area == 0:
            reason = shapely.is_valid_reason(part).partition("[")[0].lower() or "no area"
            raise SvgError("d", f"the outline crosses or touches itself ({reason})")
        parts.append(part)
    if len(parts) < 2:
        return parts[0] if parts else shapely.Polygon()
    filled = []
    for face in shapely.get_parts(shapely.polygonize([shapely.union_all([part.exterior for part in parts])])):
        middle = face.representative_point()
        turns = [1 if part.exterior.is_ccw else -1 for part in parts if part.covers(middle)]
        if len(turns) % 2 if even_odd else sum(turns):
            filled.append(face)
    return shapely.union_all(filled)
