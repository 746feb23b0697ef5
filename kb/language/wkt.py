"""Shapes written as text (well-known text, WKT): our own reader, which says at which character a text goes wrong.

shape   = "POINT" "(" point ")" | "LINESTRING" line | "POLYGON" polygon | "MULTIPOLYGON" "(" polygon { "," polygon } ")"
polygon = "(" line { "," line } ")"       the outer ring, then the holes; a ring ends where it begins
line    = "(" point { "," point } ")"
point   = number number                   x and y in squares
number  = [ "+" | "-" ] ( digits [ "." [ digits ] ] | "." digits ) [ ( "e" | "E" ) [ "+" | "-" ] digits ]

Words are parted by blanks, brackets and commas, by nothing else: `10.5.5` and `8-5` are one word each, and no number.
Nothing but blanks may follow the last bracket.
"""

import re
from typing import Any, NamedTuple

import shapely

NUMBER = re.compile(r"[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?")
WORD = re.compile(r"[(),]|[^\s(),]+")
KINDS = ("POINT", "LINESTRING", "POLYGON", "MULTIPOLYGON")
FURTHEST = 1e6  # squares: no coordinate is greater

Point = tuple[float, float]
Line = list[Point]


class WktError(ValueError):
    """A text is no shape; `at` is the character (from 0) where it goes wrong."""

    def __init__(self, at: int, what: str) -> None:
        self.at, self.what = at, what
        super().__init__(what)


def parse_wkt(text: str, kinds: tuple[str, ...] = KINDS) -> Any:
    """Return the shapely geometry that a text describes, which must be one of `kinds` and valid.

    Raises WktError for anything else: no number, a ring that is not closed, a boundary that crosses itself.

    >>> parse_wkt("POLYGON ((0 0, 4 0, 4 2, 0 0))").area
    4.0
    """
    reader = _Reader(text)
    kind = reader.kind(kinds)
    try:
        shape = _BUILD[kind](reader)
    except shapely.errors.ShapelyError as error:
        raise WktError(0, f"no valid shape: {error}") from None
    reader.finish()
    if shape.is_empty or not shape.is_valid:
        raise WktError(0, _flaw(shape))
    return shape


def _flaw(shape: Any) -> str:
    """Why shapely holds a shape to be invalid, in our words."""
    reason = shapely.is_valid_reason(shape)
    what, _, place = reason.partition("[")
    words = {
        "Self-intersection": "the boundary crosses or touches itself",
        "Ring Self-intersection": "the boundary crosses or touches itself",
        "Hole lies outside shell": "a hole lies outside the shape",
        "Holes are nested": "one hole lies in another",
        "Interior is disconnected": "the holes cut the shape into parts",
        "Nested shells": "one part lies in another",
        "Duplicate Rings": "a ring is given twice",
        "Too few points in geometry component": "too few different points",
    }.get(what, what.lower() or "no valid shape")
    return f"{words} at ({place.removesuffix(']').replace(' ', ', ')})" if place else words


class _Token(NamedTuple):
    text: str
    at: int


class _Reader:
    """Reads words from left to right."""

    def __init__(self, text: str) -> None:
        self.text = text
        self.tokens = [_Token(m.group(), m.start()) for m in WORD.finditer(text)]
        self.tokens.append(_Token("", len(text)))
        self.next = 0

    def take(self) -> _Token:
        token = self.tokens[self.next]
        self.next += bool(token.text)
        return token

    def kind(self, kinds: tuple[str, ...]) -> str:
        token = self.take()
        if token.text.upper() not in kinds:
            raise WktError(token.at, f"a shape here is a {' or '.join(kinds)}, not {token.text[:20] or 'nothing'!r}")
        return token.text.upper()

    def expect(self, marks: str) -> str:
        token = self.take()
        if token.text not in tuple(marks):
            wanted = " or ".join(repr(mark) for mark in marks)
            raise WktError(token.at, f"{wanted} was expected, {token.text[:20] or 'the end'!r} found")
        return token.text

    def finish(self) -> None:
        token = self.take()
        if token.text:
            raise WktError(token.at, f"the shape ends before {token.text[:20]!r}")

    def number(self) -> float:
        token = self.take()
        if not NUMBER.fullmatch(token.text):
            raise WktError(token.at, f"a number was expected, {token.text[:20] or 'the end'!r} found")
        value = float(token.text)
        if not abs(value) <= FURTHEST:
            raise WktError(token.at, f"a coordinate beyond {FURTHEST:.0f} squares")
        return value

    def point(self) -> Point:
        return self.number(), self.number()

    def single(self) -> Point:
        """`( point )`: one point alone."""
        self.expect("(")
        point = self.point()
        self.expect(")")
        return point

    def several(self, part: Any) -> list[Any]:
        """`( part , part ... )`."""
        self.expect("(")
        parts = [part()]
        while self.expect(",)") == ",":
            parts.append(part())
        return parts

    def line(self) -> Line:
        return self.several(self.point)

    def ring(self) -> Line:
        at = self.tokens[self.next].at
        points = self.line()
        if points[0] != points[-1]:
            raise WktError(at, "a ring that does not end where it begins")
        if len(points) < 4:
            raise WktError(at, "a ring needs three corners at least")
        return points

    def polygon(self) -> Any:
        outer, *holes = self.several(self.ring)
        return shapely.Polygon(outer, holes)


_BUILD: dict[str, Any] = {
    "POINT": lambda reader: shapely.Point(reader.single()),
    "LINESTRING": lambda reader: shapely.LineString(reader.line()),
    "POLYGON": lambda reader: reader.polygon(),
    "MULTIPOLYGON": lambda reader: shapely.MultiPolygon(reader.several(reader.polygon)),
}
