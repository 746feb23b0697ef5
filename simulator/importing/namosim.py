"""NAMOSIM scenarios (.svg): walls, movable obstacles, robots and their goals as outlines.

An element with an outline is a wall or an obstacle by its attribute `type` (`wall`, `movable`). `namo_config` gives the
size of a cell in user units (`cell_size_cm`) and the robots; elements whose `id` they name are a robot and its goal.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from math import ceil, floor
from pathlib import Path
from typing import Any

import shapely

from utak.kb.language.diagnostics import BadInputError, SourceSpan
from utak.kb.language.source_text import MAX_FILE_BYTES, Source
from utak.kb.language.vocabulary import MAX_TABLE_SIDE
from utak.simulator.importing.imported import COLOUR_LETTERS, Imported, ImportOptions, decimal
from utak.simulator.importing.svg_path import (
    MAX_UNITS,
    SVG_NUMBER,
    SvgError,
    SvgRing,
    Transform,
    parse_path,
    parse_transform,
    ring_area,
    shape_path,
)
from utak.simulator.importing.text_file import read_raw, text_source
from utak.simulator.importing.xml_tree import XmlElement, attribute_span, parse_xml
from utak.simulator.scenario.worldfile import MAX_TOUCHING_AREA, MIN_THING_AREA

SHAPE_TAGS = ("path", "rect", "circle", "ellipse", "polygon", "polyline")
SKIPPED_TAGS = ("defs", "metadata", "namo_config", "clipPath", "mask", "symbol", "pattern", "marker")  # not drawn
CURVE_TOLERANCE = 0.02  # squares between a curve and its chords; a convention
MAX_CUT_AREA = 0.05  # square squares by which a wall may reach into an obstacle; more is an error; a convention
MAX_OBSTACLES = 500  # obstacles of a file: each is compared with each; a convention
MIN_CELL_UNITS, MAX_CELL_UNITS = 1e-6, 1e6  # user units of a cell; a convention
MAX_DRAWN_POINTS = 1_000_000  # points of all outlines of a file, which arcs make of few letters; a convention
MAX_DRAWN_SQUARES = 1e6  # squares of a coordinate on the table, in absolute value; a convention
WKT_DECIMALS = 12  # decimals of coordinates: rounding makes no overlap of `MAX_TOUCHING_AREA`
MARKER_COLOUR = "z"  # the colour of the square that marks a goal
MARKER_NAME = "goal"


@dataclass(frozen=True)
class _Shape:
    """An element with an outline."""

    element: XmlElement  # the element
    type: str  # its attribute `type`, or ''
    ids: frozenset[str]  # its own id and those of the groups around it
    rings: tuple[SvgRing, ...]  # its rings, squares, table frame
    even_odd: bool  # whether holes are told by the even-odd rule


def read(path: Path | str, options: ImportOptions) -> Imported:
    """Return the scenario of a NAMOSIM file."""
    # Where the marker would lie on something, the task is the corner of the floor that lies in the same direction.
    source = text_source(path, read_raw(path, MAX_FILE_BYTES, "a NAMOSIM scenario", options.untrusted))
    root = parse_xml(source)
    try:
        return _Reader(source, root, options.scale or Fraction(1)).scenario()
    except shapely.errors.GEOSException as error:
        what = f"the outlines cannot be joined: {str(error)[:60]}"
        raise BadInputError([source.problem(source.start(), what)]) from None


class _Reader:
    """Reads one file."""

    def __init__(self, source: Source, root: XmlElement, scale: Fraction) -> None:
        self._source, self._root = source, root
        box = self._numbers(root, "viewBox")
        if root.tag != "svg" or len(box) != 4 or not (box[2] > 0 and box[3] > 0):
            raise self._wrong(root, "viewBox", "a NAMOSIM scenario is an svg element with a viewBox of four numbers")
        config = next((element for element in root.descendants() if element.tag == "namo_config"), None)
        if config is None:
            raise self._wrong(root, "", "there is no namo_config element: this is no scenario of NAMOSIM")
        cell = self._numbers(config, "cell_size_cm")
        if len(cell) != 1 or not MIN_CELL_UNITS <= cell[0] <= MAX_CELL_UNITS:
            what = f"namo_config needs a cell_size_cm from {MIN_CELL_UNITS:g} to {MAX_CELL_UNITS:g}"
            raise self._wrong(config, "cell_size_cm", what)
        factor = float(scale) / cell[0]
        self._width, self._height = (ceil(side * factor - 1e-9) + 2 for side in box[2:])
        if max(self._width, self._height) > MAX_TABLE_SIDE:
            what = f"the table would have {max(self._width, self._height)} squares a side, more than {MAX_TABLE_SIDE}"
            raise self._wrong(config, "cell_size_cm", what)
        self._tolerance = CURVE_TOLERANCE / factor
        # One square of verge lies about the view box; y is turned to the north.
        self._to_table = Transform(factor, 0, 0, -factor, 1 - box[0] * factor, 1 + (box[1] + box[3]) * factor)
        self._view = shapely.box(1, 1, 1 + box[2] * factor, 1 + box[3] * factor)
        self._config, self._points = config, 0

    def scenario(self) -> Imported:
        """Return the scenario of the file."""
        shapes = list(self._shapes())
        agents = [element for element in self._config.children if element.tag == "agent"]
        if not agents:
            raise self._wrong(self._config, "", "namo_config names no agent")
        utak = self._middle(agents[0], "agent_id", shapes).coords[0]
        table = shapely.box(0, 0, self._width, self._height)
        walls = [self._polygon(shape) for shape in shapes if shape.type == "wall"]
        verge = shapely.union_all([table.difference(self._view), *(wall.intersection(table) for wall in walls)])
        things, verge = self._things([shape for shape in shapes if shape.type == "movable"], verge, table)
        notes = [
            f"The robot {agents[0].attributes.get('agent_id')} has an extent in NAMOSIM; Utak is a point in its middle."
        ]
        if len(agents) > 1:
            more = "1 more robot is" if len(agents) == 2 else f"{len(agents) - 1} more robots are"
            notes.append(f"{more} left out: in TABLETOP nobody else moves.")
        facts = [f"table({self._width}, {self._height}).", f'verge("{_text(verge)}").']
        facts += [f'object({name}, {colour}, "{_text(polygon)}").' for name, colour, polygon in things]
        start: tuple[str, ...] = ()
        expect: tuple[str, ...] = ()
        goal = "at(utak, corner(northeast))."
        goals = [element for element in agents[0].children if element.tag == "goal"]
        if not goals:
            notes.append("The file has no goal; the north-east corner takes its place.")
        else:
            place = self._middle(goals[0], "goal_id", shapes)
            x, y = place.coords[0]
            marker = shapely.box(floor(x), floor(y), floor(x) + 1, floor(y) + 1)  # on the grid, as it is seen best
            taken = shapely.union_all([verge, *(polygon for _, _, polygon in things), shapely.Point(utak)])
            if table.covers(marker) and not marker.intersects(taken):
                facts.append(f'fixed({MARKER_NAME}, {MARKER_COLOUR}, "{_text(marker)}").')
                start, goal = (f"object(x). shape(x, square). colour(x, {MARKER_COLOUR}).",), "at(utak, x)."
                expect = (f'near(utak, "{_text(marker)}", 1).',)
                notes.append("A fixed square of colour z marks the goal, for goals name things, not places.")
            else:
                corner = f"{'north' if y >= utak[1] else 'south'}{'east' if x >= utak[0] else 'west'}"
                goal = f"at(utak, corner({corner}))."
                where = f"({decimal(x - utak[0])}, {decimal(y - utak[1])}) in the robot's frame"
                notes.append(f"Something lies where the goal is, at {where}: the {corner} corner takes its place.")
            if len(goals) > 1:
                notes.append(f"{len(goals) - 1} more goals of the robot are left out.")
        facts.append(f'utak("POINT ({utak[0]:.12g} {utak[1]:.12g})", 0).')
        return Imported("NAMOSIM scenario", "world.lp", "\n".join([*facts, ""]), start, (goal,), expect, tuple(notes))

    def _things(self, shapes: list[_Shape], verge: Any, table: Any) -> tuple[list[tuple[str, str, Any]], Any]:
        """Return name, colour and outline of each obstacle, and the verge without what it covers of them."""
        things: list[tuple[str, str, Any]] = []
        if len(shapes) > MAX_OBSTACLES:
            raise self._wrong(shapes[MAX_OBSTACLES].element, "", f"a file has at most {MAX_OBSTACLES} obstacles here")
        letters = COLOUR_LETTERS.replace(MARKER_COLOUR, "")
        for number, shape in enumerate(shapes):
            polygon = self._polygon(shape)
            name = shape.element.attributes.get("id", "")
            if not isinstance(polygon, shapely.Polygon) or polygon.interiors or polygon.area < MIN_THING_AREA:
                raise self._wrong(shape.element, "d", f"obstacle {name[:40]} must be one polygon without holes")
            if not table.covers(polygon):
                raise self._wrong(shape.element, "d", f"obstacle {name[:40]} reaches beyond the view box")
            for other, _, taken in things:
                if polygon.intersection(taken).area > MAX_TOUCHING_AREA:
                    raise self._wrong(shape.element, "d", f"obstacle {name[:40]} overlaps another ({other})")
            common = polygon.intersection(verge).area
            if common > MAX_CUT_AREA:
                raise self._wrong(shape.element, "d", f"obstacle {name[:40]} overlaps a wall by {common:.3g} squares")
            if common > 0:
                verge = verge.difference(polygon)
            colour = letters[number % len(letters)]
            things.append((f"{colour}{number // len(letters) + 1}", colour, polygon))
        return things, verge

    def _shapes(self) -> Iterator[_Shape]:
        """Yield the drawn elements with an outline, in the order of the file."""
        waiting = [(self._root, self._to_table, frozenset[str]())]
        while waiting:
            element, transform, ids = waiting.pop()
            if element.tag in SKIPPED_TAGS:
                continue
            if "transform" in element.attributes:
                try:
                    transform = transform.after(parse_transform(element.attributes["transform"]))
                except SvgError as error:
                    raise self._wrong(element, "transform", error.what, error.at) from None
            ids |= {element.attributes["id"]} if "id" in element.attributes else frozenset()
            if element.tag in SHAPE_TAGS:
                type_ = element.attributes.get("type", "")
                rings = self._rings(element, transform)
                if rings or type_ in ("wall", "movable"):
                    even_odd = "evenodd" in element.attributes.get("fill-rule", element.attributes.get("style", ""))
                    yield _Shape(element, type_, ids, rings, even_odd)
            waiting += [(child, transform, ids) for child in reversed(element.children)]

    def _rings(self, element: XmlElement, transform: Transform) -> tuple[SvgRing, ...]:
        """Return the rings of an element in squares of the table."""
        name = "d" if element.tag == "path" else "points"
        if element.tag == "path":
            data = element.attributes.get("d")
        else:
            data = shape_path(element.tag, lambda key: self._single(element, key), element.attributes.get("points", ""))
        if data is None:
            return ()
        size = max(abs(part) for part in transform[:4]) / max(abs(part) for part in self._to_table[:4])
        try:
            rings = parse_path(data, self._tolerance / max(size, 1e-9))
        except SvgError as error:
            raise self._wrong(element, name, error.what, error.at if name == "d" else 0) from None
        self._points += sum(map(len, rings))
        placed = tuple([transform.of(point) for point in ring] for ring in rings)
        if self._points > MAX_DRAWN_POINTS:
            raise self._wrong(element, name, f"the outlines up to here have more than {MAX_DRAWN_POINTS} points")
        if not all(abs(x) <= MAX_DRAWN_SQUARES and abs(y) <= MAX_DRAWN_SQUARES for ring in placed for x, y in ring):
            raise self._wrong(element, name, f"an outline reaches more than {MAX_DRAWN_SQUARES:g} squares away")
        return placed

    def _polygon(self, shape: _Shape) -> Any:
        """Return the outline of an element; raise BadInputError when it is none."""
        whole: Any = None
        first = 0.0
        for ring in shape.rings:
            part = shapely.Polygon(ring)
            if not part.is_valid or part.area == 0:
                reason = shapely.is_valid_reason(part).partition("[")[0].lower() or "no area"
                raise self._wrong(shape.element, "d", f"the outline crosses or touches itself ({reason})")
            if whole is None:
                whole, first = part, ring_area(ring)
            elif whole.covers(part) and (shape.even_odd or ring_area(ring) * first < 0):
                whole = whole.difference(part)
            else:
                whole = whole.union(part)
        if whole is None:
            raise self._wrong(
                shape.element, "d", f"a {shape.type or 'shape'} needs an outline of three points at least"
            )
        return whole

    def _middle(self, agent: XmlElement, key: str, shapes: list[_Shape]) -> Any:
        """Return the centroid of the shape that an element names by its id, a shapely Point in the table frame."""
        name = agent.attributes.get(key, "")
        found = [shape for shape in shapes if name and name in shape.ids]
        found = [shape for shape in found if shape.type == "shape"] or found
        if not found or not found[0].rings:
            raise self._wrong(agent, key, f"no drawn shape has the id {name[:40]!r}")
        middle = shapely.Polygon(found[0].rings[0]).centroid
        if middle.is_empty or not shapely.box(0, 0, self._width, self._height).covers(middle):
            raise self._wrong(found[0].element, "d", f"{name[:40]} lies beyond the view box")
        return shapely.Point(round(middle.x, 6), round(middle.y, 6))

    def _numbers(self, element: XmlElement, key: str) -> list[float]:
        """Return the numbers in an attribute; [] when it is absent or holds something else, or too great numbers."""
        words = element.attributes.get(key, "").replace(",", " ").split()
        numbers = [float(word) for word in words] if all(SVG_NUMBER.fullmatch(word) for word in words) else []
        return numbers if all(abs(number) <= MAX_UNITS for number in numbers) else []

    def _single(self, element: XmlElement, key: str) -> float:
        """Return the number in an attribute, 0 without it; raise BadInputError for something else."""
        text = element.attributes.get(key, "0").strip().removesuffix("px")
        if not SVG_NUMBER.fullmatch(text) or not abs(float(text)) < 1e9:
            raise self._wrong(element, key, f"{key} must be a number")
        return float(text)

    def _wrong(self, element: XmlElement, key: str, what: str, at: int | None = None) -> BadInputError:
        """Return the error `what` at an attribute of an element."""
        # None for all of it.
        span: SourceSpan = (
            attribute_span(self._source, element, key)
            if at is None
            else attribute_span(self._source, element, key, at, at + 1)
        )
        return BadInputError([self._source.problem(span, what)])


def _text(shape: Any) -> str:
    """Return a shape as well-known text."""
    text: str = shapely.to_wkt(shape, rounding_precision=WKT_DECIMALS, trim=True)
    return text
