"""The reader of shapes in well-known text (WKT); an error names the character at which the text goes wrong.

shape   = "POINT" "(" point ")" | "LINESTRING" line | "POLYGON" polygon | "MULTIPOLYGON" "(" polygon { "," polygon } ")"
polygon = "(" line { "," line } ")"       the outer ring, then the holes; a ring ends where it begins
line    = "(" point { "," point } ")"
point   = number number                   x and y in squares
number  = [ "+" | "-" ] ( digits [ "." [ digits ] ] | "." digits ) [ ( "e" | "E" ) [ "+" | "-" ] digits ]

Only blanks, brackets and commas separate words: `10.5.5` and `8-5` are one word each, and no numbers. Only blanks may
follow the last bracket.
"""

import re
from typing import Any, NamedTuple

import shapely

WKT_NUMBER = re.compile(r"[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?")  # a decimal number
WKT_WORD = re.compile(r"[(),]|[^\s(),]+")  # a mark, or characters up to the next mark or blank
WKT_KINDS = ("POINT", "LINESTRING", "POLYGON", "MULTIPOLYGON")  # the kinds of shapes that are read
MAX_WKT_COORDINATE = 1e6  # squares; no coordinate has a greater absolute value (a convention)

_Point = tuple[float, float]
_Ring = list[_Point]


class WktError(ValueError):
    """A text is not a valid shape."""

    def __init__(self, at: int, what: str) -> None:
        self.at, self.what = at, what
        super().__init__(what)


def parse_wkt(text: str, kinds: tuple[str, ...] = WKT_KINDS) -> Any:
    """Return the shapely geometry that a text describes.

    Examples
    --------
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
    """Return the reason why a shapely geometry is invalid, in plain words, with the point (x, y) where there is one."""
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
    """A word of the text."""

    text: str  # the word; '' for the end of the text
    at: int  # the index of its first character, from 0


class _Reader:
    """A recursive-descent parser over the words of one text."""

    # Every method that reads moves on in the text, and raises WktError, with the place, where something else stands
    # there.

    def __init__(self, text: str) -> None:
        self.text = text
        self.tokens = [_Token(m.group(), m.start()) for m in WKT_WORD.finditer(text)]
        self.tokens.append(_Token("", len(text)))
        self.next = 0

    def take(self) -> _Token:
        """Return the next word and move on; the word after the last one is '', and returned again and again."""
        token = self.tokens[self.next]
        self.next += bool(token.text)
        return token

    def kind(self, kinds: tuple[str, ...]) -> str:
        """Read the kind of a shape, and return it in upper case; `kinds` are those that are accepted, in upper case."""
        token = self.take()
        if token.text.upper() not in kinds:
            raise WktError(token.at, f"a shape here is a {' or '.join(kinds)}, not {token.text[:20] or 'nothing'!r}")
        return token.text.upper()

    def expect(self, marks: str) -> str:
        """Read one of the given marks, and return it. marks : the marks, one character each."""
        token = self.take()
        if token.text not in tuple(marks):
            wanted = " or ".join(repr(mark) for mark in marks)
            raise WktError(token.at, f"{wanted} was expected, {token.text[:20] or 'the end'!r} found")
        return token.text

    def finish(self) -> None:
        """Raise WktError unless the text ends here."""
        token = self.take()
        if token.text:
            raise WktError(token.at, f"the shape ends before {token.text[:20]!r}")

    def number(self) -> float:
        """Read a coordinate, and return it in squares; beyond MAX_WKT_COORDINATE it is an error."""
        token = self.take()
        if not WKT_NUMBER.fullmatch(token.text):
            raise WktError(token.at, f"a number was expected, {token.text[:20] or 'the end'!r} found")
        value = float(token.text)
        if not abs(value) <= MAX_WKT_COORDINATE:
            raise WktError(token.at, f"a coordinate beyond {MAX_WKT_COORDINATE:.0f} squares")
        return value

    def point(self) -> _Point:
        """Read the two coordinates of a point, and return them as (x, y) in squares."""
        return self.number(), self.number()

    def single(self) -> _Point:
        """Read one point in brackets, `( point )`, and return it as (x, y) in squares."""
        self.expect("(")
        point = self.point()
        self.expect(")")
        return point

    def several(self, part: Any) -> list[Any]:
        """Read a list in brackets, `( part , part ... )`, and return its parts in order, at least one."""
        self.expect("(")
        parts = [part()]
        while self.expect(",)") == ",":
            parts.append(part())
        return parts

    def line(self) -> _Ring:
        """Read the points of a line, `( point , point ... )`, and return them as a list of (x, y) in squares."""
        return self.several(self.point)

    def ring(self) -> _Ring:
        """Read a closed ring with at least three corners, and return its points (x, y) in squares."""
        at = self.tokens[self.next].at
        points = self.line()
        if points[0] != points[-1]:
            raise WktError(at, "a ring that does not end where it begins")
        if len(points) < 4:
            raise WktError(at, "a ring needs three corners at least")
        return points

    def polygon(self) -> Any:
        """Read a polygon, the outer ring and the holes, and return it as a shapely Polygon that may be invalid."""
        outer, *holes = self.several(self.ring)
        return shapely.Polygon(outer, holes)


_BUILD: dict[str, Any] = {
    "POINT": lambda reader: shapely.Point(reader.single()),
    "LINESTRING": lambda reader: shapely.LineString(reader.line()),
    "POLYGON": lambda reader: reader.polygon(),
    "MULTIPOLYGON": lambda reader: shapely.MultiPolygon(reader.several(reader.polygon)),
}
