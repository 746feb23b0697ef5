"""NAMOSIM scenarios (.svg): walls, movable obstacles, robots and their goals as outlines.

An element with an outline is a wall or an obstacle by its attribute `type` (`wall`, `movable`). `namo_config` gives the
size of a cell in user units (`cell_size_cm`) and the robots; elements whose `id` they name are a robot and its goal.
"""

from fractions import Fraction
from functools import partial
from math import ceil, floor
from pathlib import Path
from typing import Any

import shapely

from utak.kb.language.diagnostics import BadInputError
from utak.kb.language.source_text import MAX_FILE_BYTES, Source
from utak.kb.language.vocabulary import MAX_TABLE_SIDE
from utak.simulator.importing.imported import COLOUR_LETTERS, Imported, ImportOptions, decimal, region_text
from utak.simulator.importing.svg_outlines import DrawnShape, SvgError, SvgPicture, filled_area, matrix, numbers_in
from utak.simulator.importing.text_file import read_raw, text_source
from utak.simulator.importing.xml_tree import XmlElement, parse_xml, xml_error
from utak.simulator.scenario.worldfile import MIN_THING_AREA
from utak.simulator.world.placing import MAX_TOUCHING_AREA

CURVE_TOLERANCE = 0.02  # squares between a curve and its chords; a convention
MAX_CUT_AREA = 0.05  # square squares by which a wall may reach into an obstacle; more is an error; a convention
MAX_OBSTACLES = 500  # obstacles of a file: each is compared with each; a convention
MIN_CELL_UNITS, MAX_CELL_UNITS = 1e-6, 1e6  # user units of a cell; a convention
WKT_DECIMALS = 12  # decimals of coordinates: rounding makes no overlap of `MAX_TOUCHING_AREA`
MARKER_COLOUR = "z"  # the colour of the square that marks a goal
MARKER_NAME = "goal"


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
        self._source = source
        box = numbers_in(root.attributes.get("viewBox", ""))
        if root.tag != "svg" or len(box) != 4 or not (box[2] > 0 and box[3] > 0):
            raise self._wrong(root, "viewBox", "a NAMOSIM scenario is an svg element with a viewBox of four numbers")
        config = next((element for element in root.descendants() if element.tag == "namo_config"), None)
        if config is None:
            raise self._wrong(root, "", "there is no namo_config element: this is no scenario of NAMOSIM")
        cell = numbers_in(config.attributes.get("cell_size_cm", ""))
        if len(cell) != 1 or not MIN_CELL_UNITS <= cell[0] <= MAX_CELL_UNITS:
            what = f"namo_config needs a cell_size_cm from {MIN_CELL_UNITS:g} to {MAX_CELL_UNITS:g}"
            raise self._wrong(config, "cell_size_cm", what)
        factor = float(scale) / cell[0]
        self._width, self._height = (ceil(side * factor - 1e-9) + 2 for side in box[2:])
        if max(self._width, self._height) > MAX_TABLE_SIDE:
            what = f"the table would have {max(self._width, self._height)} squares a side, more than {MAX_TABLE_SIDE}"
            raise self._wrong(config, "cell_size_cm", what)
        # One square of verge lies about the view box; y is turned to the north.
        to_table = matrix(factor, 0, 0, -factor, 1 - box[0] * factor, 1 + (box[1] + box[3]) * factor)
        self._view = shapely.box(1, 1, 1 + box[2] * factor, 1 + box[3] * factor)
        self._config, self._picture = config, SvgPicture(source, root, to_table, (box[2], box[3]))

    def scenario(self) -> Imported:
        """Return the scenario of the file."""
        shapes = list(self._picture.shapes(CURVE_TOLERANCE))
        agents = [element for element in self._config.children if element.tag == "agent"]
        if not agents:
            raise self._wrong(self._config, "", "namo_config names no agent")
        utak = self._middle(agents[0], "agent_id", shapes).coords[0]
        table = shapely.box(0, 0, self._width, self._height)
        walls = [self._polygon(shape) for shape in shapes if shape.type == "wall"]
        verge = shapely.union_all([table.difference(self._view), *(wall.intersection(table) for wall in walls)])
        things, verge = self._things([shape for shape in shapes if shape.type == "movable"], verge, table)
        robot = agents[0].attributes.get("agent_id")
        notes = [
            f"The robot {robot} has an extent in NAMOSIM; Utak is a point in its middle.",
            *sorted(self._picture.notes),
        ]
        if len(agents) > 1:
            more = "1 more robot is" if len(agents) == 2 else f"{len(agents) - 1} more robots are"
            notes.append(f"{more} left out: in TABLETOP nobody else moves.")
        wkt = partial(region_text, decimals=WKT_DECIMALS)
        facts = [f"table({self._width}, {self._height}).", f'verge("{wkt(verge)}").']
        facts += [f'object({name}, {colour}, "{wkt(polygon)}").' for name, colour, polygon in things]
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
                facts.append(f'fixed({MARKER_NAME}, {MARKER_COLOUR}, "{wkt(marker)}").')
                start, goal = (f"object(x). shape(x, square). colour(x, {MARKER_COLOUR}).",), "at(utak, x)."
                expect = (f'near(utak, "{wkt(marker)}", 1).',)
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

    def _things(self, shapes: list[DrawnShape], verge: Any, table: Any) -> tuple[list[tuple[str, str, Any]], Any]:
        """Return name, colour and outline of each obstacle, and the verge without what it covers of them."""
        things: list[tuple[str, str, Any]] = []
        if len(shapes) > MAX_OBSTACLES:
            raise self._wrong(shapes[MAX_OBSTACLES].element, "", f"a file has at most {MAX_OBSTACLES} obstacles here")
        letters = COLOUR_LETTERS.replace(MARKER_COLOUR, "")
        for number, shape in enumerate(shapes):
            polygon = self._polygon(shape)
            obstacle = f"obstacle {shape.element.attributes.get('id', '')[:40]}"
            common = polygon.intersection(verge).area
            other = next(
                (other for other, _, one in things if polygon.intersection(one).area > MAX_TOUCHING_AREA), None
            )
            problem = ""
            if not isinstance(polygon, shapely.Polygon) or polygon.interiors or polygon.area < MIN_THING_AREA:
                problem = "must be one polygon without holes"
            elif not table.covers(polygon):
                problem = "reaches beyond the view box"
            elif other is not None:
                problem = f"overlaps another ({other})"
            elif common > MAX_CUT_AREA:
                problem = f"overlaps a wall by {common:.3g} squares"
            if problem:
                raise self._wrong(shape.element, "d", f"{obstacle} {problem}")
            verge = verge.difference(polygon) if common > 0 else verge
            colour = letters[number % len(letters)]
            things.append((f"{colour}{number // len(letters) + 1}", colour, polygon))
        return things, verge

    def _polygon(self, shape: DrawnShape) -> Any:
        """Return the outline of an element; raise BadInputError when it is none."""
        if not shape.rings:
            what = f"a {shape.type or 'shape'} needs an outline of three points at least"
            raise self._wrong(shape.element, "d", what)
        try:
            return filled_area(shape.rings, shape.even_odd)
        except SvgError as error:
            raise self._wrong(shape.element, *error.args) from None

    def _middle(self, agent: XmlElement, key: str, shapes: list[DrawnShape]) -> Any:
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

    def _wrong(self, element: XmlElement, key: str, what: str) -> BadInputError:
        return xml_error(self._source, element, key, what)
