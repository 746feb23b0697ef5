"""The believed map as a picture in characters, drawn from the facts of the world model alone."""

import math
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from typing import NamedTuple

import numpy as np

from utak.geometry.kernels.arrays import Bools, Floats
from utak.kb.language.atoms import atom_parts, long_form
from utak.kb.world.model import FACT_UNITS_PER_SQUARE
from utak.simulator.scenario.picture import FLOOR_MARK, UTAK_MARK, labelled

VERGE_MARK, DOOR_MARK, UNSEEN_MARK = "#", "=", " "
OBJECT_MARKS = "ABCDEFGHIJKLMNOPQRSTVWXYZ"  # without U, which is Utak; further objects have the last mark
OTHER_MARK = "*"
MIN_THING_CONFIDENCE = 50  # percent: below it an object is more likely a wall, and drawn by a small letter
MAX_PICTURE_COLUMNS = 512  # characters in a row where no terminal bounds it; a convention
MAX_PICTURE_CELLS = 400_000  # characters of a picture; a convention
# Styles of the characters, in the words of `rich`.
STYLES: Mapping[str, str] = {
    UTAK_MARK: "bold white on blue", VERGE_MARK: "bright_black", FLOOR_MARK: "green", DOOR_MARK: "bold cyan",
    **dict.fromkeys(OBJECT_MARKS + OTHER_MARK, "bold yellow"),
    **dict.fromkeys(OBJECT_MARKS.lower(), "yellow"),
}  # fmt: skip
_Row = tuple[str, ...]


class BeliefPicture(NamedTuple):
    """The believed map."""

    rows: tuple[str, ...]  # the lines of the picture with the labels of its axes, the north first
    legend: tuple[str, ...]  # lines that say what its marks are, its unit and its frame


class _Facts:
    """The facts of a world model by predicate; arguments are texts."""

    def __init__(self, facts: Iterable[str]) -> None:
        self._rows: dict[tuple[str, int], list[_Row]] = defaultdict(list)
        for fact in facts:
            for name, arguments in (atom_parts(text) for text in (fact, long_form(fact)) if text):
                if arguments not in self._rows[name, len(arguments)]:
                    self._rows[name, len(arguments)].append(tuple(arguments))

    def rows(self, name: str, arity: int, thing: str = "") -> list[_Row]:
        """Return the arguments of all facts of a predicate, or of those that begin with a thing."""
        return [row for row in self._rows[name, arity] if thing in ("", row[0])]

    def numbers(self, name: str, arity: int, words: int) -> Iterator[tuple[_Row, list[int]]]:
        """Yield of each fact of a predicate its first arguments as text and the others as integers."""
        for row in self.rows(name, arity):
            with suppress(ValueError):
                yield row[:words], [int(part) for part in row[words:]]


class _Grid(NamedTuple):
    """The characters' squares: `west` and `south` of the whole in hundredths, `unit` hundredths a side."""

    west: int
    south: int
    unit: int
    columns: int
    rows: int

    def cell(self, east: float, north: float) -> tuple[int, int] | None:
        """Return (row, column), row 0 in the south, of a point in hundredths; None for one outside."""
        row, column = math.floor((north - self.south) / self.unit), math.floor((east - self.west) / self.unit)
        return (row, column) if 0 <= row < self.rows and 0 <= column < self.columns else None


def draw_belief(facts: Iterable[str], width: int | None = None) -> BeliefPicture:
    """Return the believed map: floor, verge, objects, doors and Utak; what was not seen is blank."""
    known = _Facts(facts)
    rings: dict[str, list[list[int]]] = defaultdict(list)
    for (node,), (_, *ends) in known.numbers("segment", 7, 1):
        rings[node].append(ends[:4])
    if not rings:
        return BeliefPicture((), ("nothing that could be drawn is believed",))
    marks = _marks_of_objects(known)
    grid = _grid(rings, width)
    cells = np.full((grid.rows, grid.columns), UNSEEN_MARK, dtype="U1")
    order = ["floor", "verge", *sorted(marks, key=_number)]
    for node in order:
        if node in rings:
            mark = {"floor": FLOOR_MARK, "verge": VERGE_MARK}.get(node) or marks[node]
            cells[_inside(np.array(rings[node], dtype=float), grid)] = mark
    for (node,), (east, north) in known.numbers("offset", 3, 1):
        if node in marks and (cell := grid.cell(east, north)) is not None and cells[cell] in (FLOOR_MARK, VERGE_MARK):
            cells[cell] = marks[node]
    for _, ends in known.numbers("threshold", 5, 1):
        for cell in _line(ends, grid):
            if cells[cell] in (FLOOR_MARK, UNSEEN_MARK):
                cells[cell] = DOOR_MARK
    place = next((ends for (node,), ends in known.numbers("offset", 3, 1) if node == "org"), None)
    if place is not None and (cell := grid.cell(*place)) is not None:
        cells[cell] = UTAK_MARK
    west, south, unit = ((n + grid.unit / 2) / FACT_UNITS_PER_SQUARE for n in (grid.west, grid.south, grid.unit / 2))
    rows = labelled(["".join(row) for row in cells], west, south, unit)
    return BeliefPicture(tuple(rows), tuple(_legend(known, marks, place, grid)))


def _number(node: str) -> tuple[int, str]:
    """Return a key that sorts objects by their number."""
    digits = node[1:]
    return (int(digits) if digits.isascii() and digits.isdigit() and len(digits) < 10 else 0), node


def _marks_of_objects(known: _Facts) -> dict[str, str]:
    """Return the letter of each object; a small one for what is more likely a wall."""
    sure = {node: share for (node, kind), (share,) in known.numbers("kind", 3, 2) if kind == "object"}
    found = {}
    for number, node in enumerate(sorted(sure, key=_number)):
        mark = OBJECT_MARKS[number] if number < len(OBJECT_MARKS) else OTHER_MARK
        found[node] = mark if sure[node] >= MIN_THING_CONFIDENCE else mark.lower()
    return found


def _grid(rings: Mapping[str, list[list[int]]], width: int | None) -> _Grid:
    """Return the grid of characters that covers all outlines; its lines run along most walls."""
    ends = np.array([segment for node in rings.values() for segment in node], dtype=np.int64)
    points = np.concatenate([ends[:, :2], ends[:, 2:]])
    (west, south), (east, north) = points.min(0).tolist(), points.max(0).tolist()
    label = 7
    columns = MAX_PICTURE_COLUMNS if width is None else max(10, min(width - label, MAX_PICTURE_COLUMNS))
    span_east, span_north = max(1, east - west) / FACT_UNITS_PER_SQUARE, max(1, north - south) / FACT_UNITS_PER_SQUARE
    squares = max(
        1, math.ceil((span_east + 1) / columns), math.ceil(math.sqrt(span_east * span_north / MAX_PICTURE_CELLS))
    )
    unit = FACT_UNITS_PER_SQUARE * squares
    remainders = [Counter((points[:, axis] % FACT_UNITS_PER_SQUARE).tolist()).most_common(1)[0][0] for axis in (0, 1)]
    west, south = (
        least - (least - remainder) % FACT_UNITS_PER_SQUARE
        for least, remainder in zip((west, south), remainders, strict=True)
    )
    return _Grid(west, south, unit, max(1, math.ceil((east - west) / unit)), max(1, math.ceil((north - south) / unit)))


def _inside(segments: Floats, grid: _Grid) -> Bools:
    """Return which characters' middles lie within rings of segments, by crossings: (rows, columns) bool."""
    inside = np.zeros((grid.rows, grid.columns), dtype=bool)
    middles = grid.west + grid.unit * (np.arange(grid.columns) + 0.5)
    e1, n1, e2, n2 = segments.T
    low, high = np.minimum(n1, n2), np.maximum(n1, n2)
    for row in range(grid.rows):
        north = grid.south + grid.unit * (row + 0.5)
        crossed = (low <= north) & (north < high)
        if crossed.any():
            share = (north - n1[crossed]) / (n2[crossed] - n1[crossed])
            at = np.sort(e1[crossed] + share * (e2[crossed] - e1[crossed]))
            inside[row] = np.searchsorted(at, middles) % 2 == 1
    return inside


def _line(ends: Sequence[int], grid: _Grid) -> Iterator[tuple[int, int]]:
    e1, n1, e2, n2 = ends
    count = min(MAX_PICTURE_COLUMNS * 4, 2 + int(4 * math.dist((e1, n1), (e2, n2)) / grid.unit))
    for part in range(1, count):
        share = part / count
        cell = grid.cell(e1 + share * (e2 - e1), n1 + share * (n2 - n1))
        if cell is not None:
            yield cell


def _legend(known: _Facts, marks: Mapping[str, str], place: Sequence[int] | None, grid: _Grid) -> Iterator[str]:
    """Yield the lines that say what the marks are, the unit and the frame."""
    if place is not None:
        east, north = (value / FACT_UNITS_PER_SQUARE for value in place)
        rooms = "".join(f", in {room}" for room in _rooms_of(known, "org"))
        yield f"{UTAK_MARK} the robot (utak, org in facts): east {east:g}, north {north:g}{rooms}"
    for node in sorted(marks, key=_number):
        yield f"{marks[node]} {node}: {', '.join(_said_of(known, node))}"
    for door, share in known.rows("door", 2):
        wide = "".join(
            f", {int(w) / FACT_UNITS_PER_SQUARE:g} wide" for _, w in known.rows("width", 2, door) if w.isdigit()
        )
        sides = next((f" between {a} and {b}" for _, a, b, _ in known.rows("connects", 4, door)), "")
        yield f"{DOOR_MARK} {door}: a door {share} %{sides}{wide}"
    side = grid.unit // FACT_UNITS_PER_SQUARE
    yield f"{FLOOR_MARK} floor, {VERGE_MARK} verge (walls), blank: not seen; a small letter: rather a wall than a thing"
    yield f"one character is {side} x {side} square{'s' * (side > 1)}; up is north, the way the robot faced on waking"
    yield "numbers are squares to the east and north of where it woke; facts have hundredths of squares"


def _said_of(known: _Facts, node: str) -> Iterator[str]:
    """Yield what is believed about an object, for the legend."""
    yield from (f"an object {share} %" for _, kind, share in known.rows("kind", 3, node) if kind == "object")
    yield from (f"{shape} {share} %" for _, shape, share in known.rows("shape", 3, node))
    if parts := len(known.rows("child", 2, node)):
        yield f"{parts} parts"
    yield from (f"colour {colour}" for _, colour, _ in known.rows("colour", 3, node))
    yield from (f"in {room}" for room in _rooms_of(known, node))
    if known.rows("held", 1, node):
        yield "in hand"
    yield from (f"meant by {name}" for name, meant in known.rows("bound", 2) if meant == node)


def _rooms_of(known: _Facts, node: str) -> list[str]:
    """Return the rooms in which the middle of a node may lie, with the percent where there are several."""
    found = [(room, share) for _, room, share in known.rows("in", 3, node)]
    return [room for room, _ in found] if len(found) == 1 else [f"{room} {share} %" for room, share in found]
