"""`utak routes`: topologically distinct ways between two points of a map or of a scenario's table."""

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from kb.problems import BadInputError, Problem, Span
from simulator import exits
from simulator.untrusted import add_option, refuse_links

if TYPE_CHECKING:
    from geometry.distance import Bools
    from geometry.route import Route

LARGEST = 200_000_000  # bytes of a map
MOST = 1000


def add(parts: Any) -> None:
    """Declare the subcommand."""
    part = parts.add_parser("routes", help="find distinct ways on a Moving AI map or a scenario's table")
    part.add_argument("map", metavar="MAP|SCENARIO", help="a .map file, or a scenario folder")
    part.add_argument("--from", dest="start", type=_point, required=True, metavar="X,Y", help="where the ways begin")
    part.add_argument("--to", dest="goal", type=_point, required=True, metavar="X,Y", help="where they end")
    part.add_argument("-k", type=_count, default=3, metavar="N", help="how many ways at most (default 3)")
    part.add_argument("--json", action="store_true", help="print one JSON object")
    part.add_argument("--svg", metavar="FILE", help="draw squares, skeleton, pathgraph and ways")
    add_option(part)
    part.add_argument("--force", action="store_true", help="let --svg overwrite a file that is no picture")
    part.set_defaults(execute=execute)


def execute(options: argparse.Namespace) -> int:
    """Find the ways, and print them."""
    from geometry.screen import Screen

    refuse_links(options, options.map)
    free = _free(options.map)
    try:
        screen = Screen(free)
        routes = screen.routes(options.start, options.goal, k=options.k)
    except ValueError as error:
        raise BadInputError([Problem(options.map, Span(1, 1, 1), str(error))]) from None
    if options.svg:
        from geometry.picture import draw
        from simulator.outputs import is_svg, write_whole

        write_whole(options.svg, draw(screen, routes), is_svg, "SVG picture", options.force)
    _print(routes, options.json)
    return exits.DONE if routes else exits.NOT_REACHED


def _free(name: str) -> "Bools":
    """Where one may be: on a map as it says, in a scenario wherever nothing stands."""
    from geometry.movingai import read_map
    from kb.source import read_bytes

    if Path(name).is_dir():
        return _free_of_scenario(name)
    read_bytes(name, LARGEST)  # which refuses what is no regular file
    try:
        return read_map(name)
    except ValueError as error:
        place, _, what = str(error).partition(": error: ")
        line = place.rpartition(":")[2]
        number = int(line) if line.isdigit() else 1
        raise BadInputError([Problem(name, Span(number, 1, 1), what or str(error))]) from None


def _free_of_scenario(name: str) -> "Bools":
    from geometry.digital import squares
    from simulator.scenario import read_any_world

    world = read_any_world(name)
    blocked = squares(world.verge, world.width, world.height)
    for thing in (*world.fixed, *world.movable):
        blocked |= squares(thing.polygon, world.width, world.height)
    return ~blocked


def _print(routes: "list[Route]", as_json: bool) -> None:
    if as_json:
        import json

        print(json.dumps({"routes": [_entry(route) for route in routes]}))
        return
    if not routes:
        print("there is no way", file=sys.stderr)
    for number, route in enumerate(routes, 1):
        points = " ".join(f"({x:g}, {y:g})" for x, y in route.points.tolist())
        print(f"{number}: length {route.length:.3f}, clearance {route.clearance:g}: {points}")


def _entry(route: "Route") -> dict[str, Any]:
    return {
        "length": float(route.length),
        "clearance": float(route.clearance),
        "signature": [int(part) for part in route.signature],
        "points": route.points.tolist(),
    }


def _point(text: str) -> tuple[float, float]:
    x, y = (float(part) for part in text.split(","))
    if not (abs(x) <= 1e6 and abs(y) <= 1e6):
        raise argparse.ArgumentTypeError(f"{text} is no point")
    return x, y


def _count(text: str) -> int:
    if not 1 <= int(text) <= MOST:
        raise argparse.ArgumentTypeError(f"must be from 1 to {MOST}, not {text}")
    return int(text)
