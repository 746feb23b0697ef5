"""Outlines in SVG: path data, the basic shapes, and transforms (SVG 1.1, chapters 7 to 9).

Curves become chords that stay within a tolerance of them. Points are (x, y) as in SVG: x to the right, y DOWN.
"""

import math
import re
from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

SvgPoint = tuple[float, float]
SvgRing = list[SvgPoint]
SVG_NUMBER = re.compile(r"[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?")
SEPARATOR = re.compile(r"[ \t\r\n\f]*,?[ \t\r\n\f]*")
BLANKS = re.compile(r"[ \t\r\n\f]*")
MAX_CHORDS = 256  # chords for one curve; a convention
MAX_PATH_POINTS = 100_000  # points of one path; a convention
MAX_PATH_PARTS = 200  # closed parts of one path; a convention
MAX_UNITS = 1e9  # user units of a coordinate, and how much transforms stretch, in absolute value; a convention
MIN_ARC_STEP = 1e-3  # radians of a chord of an arc; fewer make more chords than `MAX_CHORDS`
ARGUMENT_COUNTS = {"m": 2, "l": 2, "h": 1, "v": 1, "c": 6, "s": 4, "q": 4, "t": 2, "a": 7, "z": 0}
TRANSFORM = re.compile(r"[ \t\r\n\f,]*([A-Za-z]+)[ \t\r\n\f]*\(([^()]*)\)")
TRANSFORM_COUNTS = {
    "matrix": (6,),
    "translate": (1, 2),
    "scale": (1, 2),
    "rotate": (1, 3),
    "skewX": (1,),
    "skewY": (1,),
}


class SvgError(ValueError):
    """A text is no path or transform."""

    def __init__(self, at: int, what: str) -> None:
        self.at, self.what = at, what
        super().__init__(what)


class Transform(NamedTuple):
    """An affine map: (x, y) becomes (a x + c y + e, b x + d y + f)."""

    a: float = 1.0
    b: float = 0.0
    c: float = 0.0
    d: float = 1.0
    e: float = 0.0
    f: float = 0.0

    def of(self, point: SvgPoint) -> SvgPoint:
        """Return where a point goes."""
        x, y = point
        return self.a * x + self.c * y + self.e, self.b * x + self.d * y + self.f

    def after(self, first: "Transform") -> "Transform":
        """Return the map that carries out `first`, then this one; raise SvgError when its numbers grow too great."""
        a, b = self.of((first.a, first.b))
        c, d = self.of((first.c, first.d))
        e, f = self.of((first.e, first.f))
        whole = Transform(a - self.e, b - self.f, c - self.e, d - self.f, e, f)
        if not all(abs(part) <= MAX_UNITS for part in whole):
            raise SvgError(0, f"a transform that stretches or moves by more than {MAX_UNITS:g}")
        return whole


def parse_transform(text: str) -> Transform:
    """Return the map that a `transform` attribute describes; raise SvgError when it describes none."""
    whole, at, end = Transform(), 0, len(text.rstrip())
    while at < end:
        part = TRANSFORM.match(text, at)
        if part is None:
            raise SvgError(at, "this is no transform")
        words = part[2].replace(",", " ").split()
        if part[1] not in TRANSFORM_COUNTS or len(words) not in TRANSFORM_COUNTS[part[1]]:
            raise SvgError(part.start(1), f"{part[1][:20]} with {len(words)} numbers is no transform")
        if not all(SVG_NUMBER.fullmatch(word) and abs(float(word)) <= MAX_UNITS for word in words):
            raise SvgError(part.start(2), "a transform needs numbers")
        whole = whole.after(_single(part[1], [float(word) for word in words]))
        at = part.end()
    return whole


def _single(name: str, numbers: Sequence[float]) -> Transform:
    """Return the map of one transform. name : one of TRANSFORM_COUNTS."""
    if name == "matrix":
        return Transform(*numbers)
    if name == "translate":
        return Transform(e=numbers[0], f=numbers[1] if len(numbers) > 1 else 0.0)
    if name == "scale":
        return Transform(a=numbers[0], d=numbers[-1])
    angle = math.radians(numbers[0])
    if name == "skewX":
        return Transform(c=math.tan(angle))
    if name == "skewY":
        return Transform(b=math.tan(angle))
    cos, sin = math.cos(angle), math.sin(angle)
    x, y = numbers[1:] if len(numbers) == 3 else (0.0, 0.0)
    return Transform(cos, sin, -sin, cos, x - cos * x + sin * y, y - sin * x - cos * y)


def parse_path(text: str, tolerance: float) -> list[SvgRing]:
    """Return the closed rings of path data; a part that is not closed is closed by a chord.

    Examples
    --------
    >>> parse_path("M 0 0 h 4 v 2 H 0 z", 0.1)
    [[(0.0, 0.0), (4.0, 0.0), (4.0, 2.0), (0.0, 2.0)]]
    """
    pen = _Pen(tolerance)
    letter, at = "", BLANKS.match(text).end()  # type: ignore[union-attr]
    while at < len(text):
        begin = at
        if text[at].isalpha():
            if text[at].lower() not in ARGUMENT_COUNTS or (not letter and text[at].lower() != "m"):
                raise SvgError(at, f"{text[at]!r} is no command of a path here")
            letter, at = text[at], at + 1
        elif not letter or letter in "zZ":
            raise SvgError(at, f"a command of a path was expected, not {text[at]!r}")
        numbers, at = _numbers(text, at, letter)
        pen.draw(letter, numbers)
        if pen.points > MAX_PATH_POINTS or len(pen.rings) > MAX_PATH_PARTS:
            raise SvgError(begin, f"a path of more than {MAX_PATH_POINTS} points, or {MAX_PATH_PARTS} parts")
        letter = {"m": "l", "M": "L"}.get(letter, letter)
        at = (SEPARATOR if letter not in "zZ" else BLANKS).match(text, at).end()  # type: ignore[union-attr]
    return [ring for ring in map(_open_ring, pen.rings) if len(ring) >= 3]


def _numbers(text: str, at: int, letter: str) -> tuple[list[float], int]:
    """Return the numbers of one command, and the index after them; raise SvgError when there are too few."""
    numbers: list[float] = []
    for index in range(ARGUMENT_COUNTS[letter.lower()]):
        gap = (SEPARATOR if index else BLANKS).match(text, at)
        assert gap is not None
        at = gap.end()
        if letter in "aA" and index in (3, 4):  # flags may stand without blanks: "01" is two of them
            if text[at : at + 1] not in ("0", "1"):
                raise SvgError(at, "a flag of an arc is 0 or 1")
            numbers.append(float(text[at]))
            at += 1
            continue
        word = SVG_NUMBER.match(text, at)
        if word is None or not abs(float(word.group())) <= MAX_UNITS:
            raise SvgError(
                at, f"command {letter} needs {ARGUMENT_COUNTS[letter.lower()]} numbers of at most {MAX_UNITS:g}"
            )
        numbers.append(float(word.group()))
        at = word.end()
    return numbers, at


def _open_ring(ring: SvgRing) -> SvgRing:
    """Return a ring without repeated neighbours, the last point different from the first."""
    points = [point for index, point in enumerate(ring) if index == 0 or point != ring[index - 1]]
    while len(points) > 1 and points[-1] == points[0]:
        points.pop()
    return points


class _Pen:
    """Draws the commands of one path."""

    def __init__(self, tolerance: float) -> None:
        self.rings: list[SvgRing] = [[]]
        self.points = 0
        self._tolerance = tolerance
        self._here: SvgPoint = (0.0, 0.0)
        self._begin: SvgPoint = (0.0, 0.0)
        self._handle: tuple[str, SvgPoint] | None = None  # the kind and the last control point of the last curve

    def draw(self, letter: str, numbers: Sequence[float]) -> None:
        """Carry out one command."""
        kind = letter.lower()
        x0, y0 = self._here if letter.islower() else (0.0, 0.0)
        if kind == "z":
            self._here, self._handle = self._begin, None
            self.rings.append([])
        elif kind == "m":
            self._here = self._begin = (x0 + numbers[0], y0 + numbers[1])
            self.rings.append([self._here])
            self._handle = None
        elif kind == "a":
            end = (x0 + numbers[5], y0 + numbers[6])
            self._add(_arc(self._here, numbers[:5], end, self._tolerance))
        elif kind == "h":
            self._add([(x0 + numbers[0], self._here[1])])
        elif kind == "v":
            self._add([(self._here[0], y0 + numbers[0])])
        elif kind == "l":
            self._add([(x0 + numbers[0], y0 + numbers[1])])
        else:
            points = [(x0 + numbers[i], y0 + numbers[i + 1]) for i in range(0, len(numbers), 2)]
            self._curve(kind, points)

    def _curve(self, kind: str, points: list[SvgPoint]) -> None:
        """Draw a Bezier curve. kind : c, s, q or t. points : its control points and its end."""
        degree = "c" if kind in "cs" else "q"
        if kind in "st":
            last = self._handle[1] if self._handle and self._handle[0] == degree else self._here
            points = [(2 * self._here[0] - last[0], 2 * self._here[1] - last[1]), *points]
        self._add(_bezier([self._here, *points], self._tolerance))
        self._handle = degree, points[-2]

    def _add(self, points: Sequence[SvgPoint]) -> None:
        """Append points; after a closed part they begin the next one where that began."""
        if not self.rings[-1]:
            self.rings[-1].append(self._here)
        self.rings[-1] += points
        self.points += len(points)
        self._here, self._handle = points[-1], None


def _bezier(control: Sequence[SvgPoint], tolerance: float) -> list[SvgPoint]:
    """Return the ends of the chords of a Bezier curve, without its begin."""
    degree = len(control) - 1
    bend = max(
        math.hypot(*(p - 2 * q + r for p, q, r in zip(*control[i : i + 3], strict=True))) for i in range(degree - 1)
    )
    count = min(MAX_CHORDS, max(1, math.ceil(math.sqrt(degree * (degree - 1) / 8 * bend / tolerance))))
    points = []
    for step in range(1, count):
        t = step / count
        weights = [math.comb(degree, i) * t**i * (1 - t) ** (degree - i) for i in range(degree + 1)]
        points.append(
            (
                sum(weight * x for weight, (x, _) in zip(weights, control, strict=True)),
                sum(weight * y for weight, (_, y) in zip(weights, control, strict=True)),
            )
        )
    return [*points, control[-1]]


def _arc(begin: SvgPoint, numbers: Sequence[float], end: SvgPoint, tolerance: float) -> list[SvgPoint]:
    """Return the ends of the chords of an elliptic arc, without its begin (SVG 1.1, F.6)."""
    rx, ry, large, sweep = abs(numbers[0]), abs(numbers[1]), bool(numbers[3]), bool(numbers[4])
    if begin == end or rx == 0 or ry == 0:
        return [end]
    cos, sin = math.cos(math.radians(numbers[2])), math.sin(math.radians(numbers[2]))
    half = (begin[0] - end[0]) / 2, (begin[1] - end[1]) / 2
    x, y = cos * half[0] + sin * half[1], cos * half[1] - sin * half[0]
    stretch = math.hypot(x / rx, y / ry)
    if stretch > 1:
        rx, ry = rx * stretch, ry * stretch
    rest = max(0.0, 1 - (x / rx) ** 2 - (y / ry) ** 2)
    norm = (x / rx) ** 2 + (y / ry) ** 2
    share = math.sqrt(rest / norm) * (-1 if large == sweep else 1) if norm else 0.0
    cx, cy = share * rx * y / ry, -share * ry * x / rx
    middle = cos * cx - sin * cy + (begin[0] + end[0]) / 2, sin * cx + cos * cy + (begin[1] + end[1]) / 2
    first = math.atan2((y - cy) / ry, (x - cx) / rx)
    turn = math.atan2((-y - cy) / ry, (-x - cx) / rx) - first
    turn += math.tau * ((turn < 0 and sweep) - (turn > 0 and not sweep))
    most = 2 * math.acos(max(0.0, 1 - tolerance / max(rx, ry, tolerance)))
    count = min(MAX_CHORDS, max(1, math.ceil(abs(turn) / max(most, MIN_ARC_STEP))))
    points = []
    for step in range(1, count):
        angle = first + turn * step / count
        u, v = rx * math.cos(angle), ry * math.sin(angle)
        points.append((cos * u - sin * v + middle[0], sin * u + cos * v + middle[1]))
    return [*points, end]


def shape_path(tag: str, number: Callable[[str], float], points: str = "") -> str | None:
    """Return the path data of a basic shape; None for other elements, and for shapes without extent."""
    if tag in ("polygon", "polyline"):
        return f"M {points} z" if points.strip() else None
    if tag == "rect":
        width, height = number("width"), number("height")
        return (
            f"M {number('x')!r} {number('y')!r} h {width!r} v {height!r} h {-width!r} z" if width and height else None
        )
    if tag in ("circle", "ellipse"):
        rx, ry = (number("r"), number("r")) if tag == "circle" else (number("rx"), number("ry"))
        x, y = number("cx"), number("cy")
        half = f"a {rx!r} {ry!r} 0 0 1"
        return f"M {x - rx!r} {y!r} {half} {2 * rx!r} 0 {half} {-2 * rx!r} 0 z" if rx > 0 and ry > 0 else None
    return None


def ring_area(ring: Sequence[SvgPoint]) -> float:
    """Return the signed area of a ring in square units; positive where it turns from x to y."""
    pairs: Iterator[tuple[SvgPoint, SvgPoint]] = zip(ring, [*ring[1:], ring[0]], strict=True)
    return sum(x0 * y1 - x1 * y0 for (x0, y0), (x1, y1) in pairs) / 2
