"""`utak routes`: topologically distinct routes between two points of a map or of a scenario's table."""

import argparse
import sys
from pathlib import Path
from typing import Any

from utak.geometry.io.movingai import MapError, parse_map
from utak.geometry.io.svg import draw, place
from utak.geometry.kernels.arrays import Bools
from utak.geometry.routes.route import Route
from utak.geometry.screen import Screen
from utak.kb.language.diagnostics import BadInputError, SourceSpan
from utak.simulator.episode.output_files import is_svg, write_whole
from utak.simulator.explaining.fixing.leading import free_squares
from utak.simulator.importing.text_file import read_raw, text_source
from utak.simulator.scenario.scenario import read_any_world
from utak.simulator.scenario.untrusted import refuse_links
from utak.simulator.terminal import exits
from utak.simulator.terminal.printing import as_json

MAX_MAP_BYTES = 200_000_000  # bytes of a map file; a convention


def execute(options: argparse.Namespace) -> int:
    """Find the routes and print them."""
    refuse_links(options, options.map)
    free = _free_squares(options.map)
    top = len(free) if options.origin == "top" else None
    start, goal = (_mirrored(point, top) for point in (options.start, options.goal))
    try:
        screen = Screen(free)
        routes = screen.routes(start, goal, k=options.k)
    except ValueError as error:
        hint = "" if top is None else "y is counted from the bottom here"
        raise BadInputError.at(options.map, str(error), hint) from None
    if options.svg:
        picture = draw(screen, routes, ends=(start, goal), words=lambda point: place(_mirrored(point, top)))
        write_whole(options.svg, picture.encode("utf-8"), is_svg, "SVG picture", options.force)
    entries = [_entry(route, top) for route in routes]
    if options.json:
        print(as_json({"routes": entries}))
    elif not routes:
        print("there is no way", file=sys.stderr)
    for number, one in enumerate(() if options.json else entries, 1):
        points = " ".join(f"({x:g}, {y:g})" for x, y in one["points"])
        print(f"{number}: length {one['length']:.3f}, clearance {one['clearance']:g}: {points}")
    return exits.SUCCESS if routes else exits.NOT_REACHED


def _free_squares(name: str) -> Bools:
    """Return the free squares: those of a map, or those of a scenario's table where nothing stands."""
    if Path(name).is_dir():
        return free_squares(read_any_world(name))
    raw = read_raw(name, MAX_MAP_BYTES, "a map")
    try:
        return parse_map(raw)
    except MapError as error:
        span = SourceSpan(error.line, error.column, error.end)
        raise BadInputError([text_source(name, raw).problem(span, error.what)]) from None


def _mirrored(point: tuple[float, float], top: int | None) -> tuple[float, float]:
    """Return a point with y counted from the other end."""
    # None to return the point as it is.
    return point if top is None else (point[0], top - point[1])


def _entry(route: Route, top: int | None) -> dict[str, Any]:
    return {
        "length": float(route.length),
        "clearance": float(route.clearance),
        "signature": [int(part) for part in route.signature],
        "points": [list(_mirrored((x, y), top)) for x, y in route.points.tolist()],
    }
