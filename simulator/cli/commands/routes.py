"""`utak routes`: topologically distinct routes between two points of a map or of a scenario's table."""

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from utak.kb.language.diagnostics import BadInputError, Problem, SourceSpan
from utak.simulator.scenario.untrusted import add_untrusted_option, refuse_links
from utak.simulator.terminal import exits
from utak.simulator.terminal.numbers import parse_decimal, parse_whole
from utak.simulator.terminal.printing import as_json

if TYPE_CHECKING:
    from utak.geometry.kernels.arrays import Bools
    from utak.geometry.routes.route import Route

MAX_MAP_BYTES = 200_000_000  # bytes of a map file; a convention
MAX_ROUTES_ASKED = 1000  # the greatest -k; a convention
MAX_POINT_COORDINATE = 1e6  # squares; the greatest absolute value in --from and --to; a convention
# The end of the help text.
ORIGIN_HELP = (
    "Points are in squares, with fractions. With --origin bottom, the default, (0, 0) is the south-west corner, x goes "
    "east and y north, as in scenarios. With --origin top, (0, 0) is the north-west corner, x goes east and y SOUTH, "
    "as in .scen files of the Moving AI benchmarks; a line of those names squares by whole numbers, and the middle of "
    "their square A, B is the point A+0.5,B+0.5. The ways are printed with the same origin."
)


def add(parts: Any) -> None:
    """Declare the subcommand."""
    part = parts.add_parser(
        "routes",
        help="find distinct ways on a Moving AI map or a scenario's table",
        description="Find topologically distinct ways between two points of a map or of a scenario's table.",
        epilog=ORIGIN_HELP,
    )
    part.add_argument("map", metavar="MAP|SCENARIO", help="a .map file, or a scenario folder")
    part.add_argument("--from", dest="start", type=_point, required=True, metavar="X,Y", help="where the ways begin")
    part.add_argument("--to", dest="goal", type=_point, required=True, metavar="X,Y", help="where they end")
    part.add_argument(
        "--origin", choices=("bottom", "top"), default="bottom", help="the corner from which points count (see below)"
    )
    part.add_argument("-k", type=_count, default=3, metavar="N", help="how many ways at most (default 3)")
    part.add_argument("--json", action="store_true", help="print one JSON object")
    part.add_argument("--svg", metavar="FILE", help="draw squares, skeleton, pathgraph and ways")
    add_untrusted_option(part)
    part.add_argument("--force", action="store_true", help="let --svg overwrite a file that is no picture")
    part.set_defaults(execute=execute)


def execute(options: argparse.Namespace) -> int:
    """Find the routes and print them."""
    from utak.geometry.screen import Screen

    refuse_links(options, options.map)
    free = _free_squares(options.map)
    top = len(free) if options.origin == "top" else None
    start, goal = (_mirrored(point, top) for point in (options.start, options.goal))
    try:
        screen = Screen(free)
        routes = screen.routes(start, goal, k=options.k)
    except ValueError as error:
        hint = "" if top is None else "y is counted from the bottom here"
        raise BadInputError([Problem(options.map, SourceSpan(1, 1, 1), str(error), hint=hint)]) from None
    if options.svg:
        from utak.geometry.io.svg import draw, place
        from utak.simulator.episode.output_files import is_svg, write_whole

        picture = draw(screen, routes, ends=(start, goal), words=lambda point: place(_mirrored(point, top)))
        write_whole(options.svg, picture.encode("utf-8"), is_svg, "SVG picture", options.force)
    _print(routes, options.json, top)
    return exits.SUCCESS if routes else exits.NOT_REACHED


def _free_squares(name: str) -> "Bools":
    """Return the free squares: those of a map, or those of a scenario's table where nothing stands."""
    from utak.geometry.io.movingai import MapError, parse_map
    from utak.simulator.importing.text_file import read_raw, text_source

    if Path(name).is_dir():
        return _free_squares_of_scenario(name)
    raw = read_raw(name, MAX_MAP_BYTES, "a map")
    try:
        return parse_map(raw)
    except MapError as error:
        span = SourceSpan(error.line, error.column, error.end)
        raise BadInputError([text_source(name, raw).problem(span, error.what)]) from None


def _free_squares_of_scenario(name: str) -> "Bools":
    """Return the squares of a scenario's table that nothing covers."""
    from utak.geometry.raster.rasterize import squares
    from utak.simulator.scenario.scenario import read_any_world

    world = read_any_world(name)
    blocked = squares(world.verge, world.width, world.height)
    for thing in (*world.fixed, *world.movable):
        blocked |= squares(thing.polygon, world.width, world.height)
    return ~blocked


def _mirrored(point: tuple[float, float], top: int | None) -> tuple[float, float]:
    """Return a point with y counted from the other end."""
    # None to return the point as it is.
    return point if top is None else (point[0], top - point[1])


def _print(routes: "list[Route]", json: bool, top: int | None) -> None:
    """Print the routes as JSON or as text."""
    if json:
        print(as_json({"routes": [_entry(route, top) for route in routes]}))
        return
    if not routes:
        print("there is no way", file=sys.stderr)
    for number, route in enumerate(routes, 1):
        points = " ".join(f"({x:g}, {y:g})" for x, y in _points(route, top))
        print(f"{number}: length {route.length:.3f}, clearance {route.clearance:g}: {points}")


def _points(route: "Route", top: int | None) -> list[list[float]]:
    """Return the points of a route as lists."""
    return [list(_mirrored((x, y), top)) for x, y in route.points.tolist()]


def _entry(route: "Route", top: int | None) -> dict[str, Any]:
    """Return a route as JSON values."""
    return {
        "length": float(route.length),
        "clearance": float(route.clearance),
        "signature": [int(part) for part in route.signature],
        "points": _points(route, top),
    }


def _point(text: str) -> tuple[float, float]:
    """Return the point for `--from` and `--to`."""
    parts = text.split(",")
    if len(parts) != 2:
        raise argparse.ArgumentTypeError(f"{text!r} is no point: write X,Y")
    x, y = (parse_decimal(part, -MAX_POINT_COORDINATE, MAX_POINT_COORDINATE) for part in parts)
    return x, y


def _count(text: str) -> int:
    """Return the number for `-k`."""
    return parse_whole(text, 1, MAX_ROUTES_ASKED)
