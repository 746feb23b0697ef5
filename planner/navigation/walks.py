"""Walks: which links of the pathgraph the robot takes to its goal, chosen by planner/asp/deciding.

Geometry supplies the links between the robot's square and the goal as facts, with their lengths, clearances and risks,
the doors that they cross and the things that they border on; and the shortest ways over them, pulled tight. The other
two path-finders of the paper, and whoever has found routes already, offer each route as one link.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np
import shapely

from utak.geometry import Screen
from utak.geometry.kernels.arrays import XY, Bools, Floats, Longs, Square
from utak.geometry.pathfinders.grid_astar import grid_path
from utak.geometry.pathfinders.visibility_graph import visibility_path
from utak.kb.reasoning.encodings import encoding_constant
from utak.kb.world.model import WorldModel, hundredths
from utak.kb.world.pathgraph import bordering
from utak.kb.world.rooms import Door, Rooms, count_crossings, went_through
from utak.planner.navigation.network import Link, links_within, network
from utak.planner.question import DECIDING_ENCODING, Question
from utak.planner.screen.projection import CostMaps, SquareIndices
from utak.planner.screen.sweeps import squares_along

MAX_TIGHT_WAYS = 6  # shortest ways over links that are pulled tight before the choice: bounds its time; by trial
TRODDEN = 1.5  # squares: what is nearer than that to where the robot has been counts as walked before; a convention
# The predicates of planner/asp/deciding about links and ways alone.
WALK_PREDICATES = (
    *((name, 1) for name in ("begins", "ends", "on", "avoid_link", "walked", "not_through")),
    *(
        (name, 2)
        for name in ("crosses", "borders", "risk", "trodden", "link_price", "part", "through", "door_price", "in_room")
    ),
    *(("middle", 3), ("step", 3), ("tight", 4), ("link", 5)),
)
WALK_LEVEL = encoding_constant(DECIDING_ENCODING, "walk_level")  # at which it adds up lengths, and what comes on top
MIN_SHARED = 0.6  # a route with more than this share of its squares in common with the last one continues it (tuned)


class PlannedRoute(NamedTuple):
    """A route that geometry found, on the arrays of the view."""

    # (column, row), edge-connected and free, from the robot's square to the goal, both included. A single straight move
    # has just its two ends instead (FewestMoves.way).
    squares: tuple[Square, ...]
    length: float  # in squares
    # The least distance from the route to a square that is not free, in squares; 0 where it was not computed
    clearance: float
    level: int  # the certainty level of its squares, 0 the surest (planner.screen.projection).


class Walks(NamedTuple):
    """The links and ways among which a walk is chosen."""

    links: tuple[Link, ...]  # on the arrays of the view
    ends: tuple[str, str]  # the junctions at which the robot and the goal are
    ways: tuple[tuple[str, ...], ...]  # ways over links, by the names of these in their order
    routes: tuple[PlannedRoute, ...]  # each way, pulled tight; the shortest first
    tighten: Callable[[Sequence[str]], PlannedRoute]  # pulls any other way over the links tight


class NoWalk(NamedTuple):
    """Every way is forbidden."""

    rules: tuple[str, ...] = ()  # the rules of users because of which, as `rules.lp:3`; () where doors are why


class WalkChoice(NamedTuple):
    """The walk that was chosen."""

    route: PlannedRoute
    question: Question  # what was given


class WalkRules(NamedTuple):
    """Doors that are forbidden or dear, and what users' rules about links ask for."""

    forbidden: frozenset[str] = frozenset()  # names of doors
    prices: Mapping[str, float] = {}  # squares of way that a pass through a door costs besides, by its name
    ruled: bool = False  # whether there are such rules
    track: tuple[XY, ...] = ()  # where the robot has been, map frame, in squares
    rooms: Rooms | None = None  # the rooms of the floor


def single_route(cost_maps: CostMaps, level: int, goals: SquareIndices, finder: str) -> PlannedRoute:
    """Return the route to the nearest reachable square of `goals` by a path-finder that finds one: visibility, grid."""
    free, goal = cost_maps.free(level), cost_maps.nearest_at(level, goals)
    if goal == cost_maps.here:
        return PlannedRoute((goal,), 0.0, 0.0, level)
    points = SINGLE_PATH_FINDERS[finder](free, _centre(cost_maps.here), _centre(goal))
    if points is None:
        raise ValueError(f"no way leads to {goal}")
    columns, rows = np.array(squares_along(free, points.tolist())).T
    length = float(np.hypot(*np.diff(points, axis=0).T).sum())
    return _planned(points, length, float(Screen(free).clearance[rows, columns].min()), free, level)


# Along lines of visibility between extreme points of obstacles, as Shakey's; by A* over the squares and their eight
# neighbours.
SINGLE_PATH_FINDERS: Mapping[str, Callable[[Bools, XY, XY], Floats | None]] = {
    "visibility": visibility_path,
    "grid": grid_path,
}


def find_walks(cost_maps: CostMaps, level: int, goals: SquareIndices, finder: str) -> Walks:
    """Return the links and ways to the nearest reachable square of `goals`, at a certainty level."""
    goal = cost_maps.nearest_at(level, goals)
    if finder in SINGLE_PATH_FINDERS or goal == cost_maps.here:
        return walks_along([single_route(cost_maps, level, goals, finder)])
    free = cost_maps.free(level)
    found = network(Screen(free), cost_maps.here, goal)

    def tighten(names: Sequence[str]) -> PlannedRoute:
        tight = found.tight(names)
        return _planned(tight.points, tight.length, tight.clearance, free, level)

    tightened = sorted(((tighten(way), way) for way in found.ways(MAX_TIGHT_WAYS)), key=lambda one: one[0].length)
    routes, ways = zip(*tightened, strict=True)
    return Walks(found.links, found.ends, ways, routes, tighten)


def walks_along(routes: Sequence[PlannedRoute]) -> Walks:
    """Return finished routes as links and ways: each route is one link."""
    ends = "here", "there"
    points = [np.array(route.squares) + 0.5 for route in routes]
    links = [Link(f"l{n}", ends, line, np.full(len(line), routes[n - 1].clearance)) for n, line in enumerate(points, 1)]
    ways: tuple[tuple[str, ...], ...] = tuple((link.name,) for link in links)
    by_name = dict(zip(ways, routes, strict=True))
    return Walks(tuple(links), ends, ways, tuple(routes), lambda names: by_name[tuple(names)])


def choose_walk(
    walks: Walks,
    cost_maps: CostMaps,
    before: frozenset[Square],
    doors: Sequence[Door],
    rules: WalkRules,
    question: Question,
) -> WalkChoice | NoWalk:
    """Choose a walk, by planner/asp/deciding."""
    model, first = cost_maps.model, len(question.about)
    facts = [f"begins({walks.ends[0]})", f"ends({walks.ends[1]})"]
    facts += [f"not_through({door})" for door in sorted(rules.forbidden)]
    facts += [f"door_price({door},{hundredths(price)})" for door, price in sorted(rules.prices.items())]
    for number, (way, route) in enumerate(zip(walks.ways, walks.routes, strict=True), first):
        columns, rows = np.array(route.squares).T
        risk = _risk(columns[1:], rows[1:], model)
        facts.append(f"tight({number},{hundredths(route.length)},{hundredths(route.clearance)},{risk})")
        facts += [f"part({number},{name})" for name in way]
        facts += [f"through({number},{door.name})" for door in doors if leads_through(route, door)]
        facts += [f"last({number})"] * (len(before.intersection(route.squares)) > MIN_SHARED * len(route.squares))
    if rules.ruled and walks.links:
        facts += _facts_for_rules(walks.links, model, rules)
    asked = question.adding(facts, (_corners_in_robot_frame(route, model) for route in walks.routes))

    def over(links: Iterable[Link]) -> Question:
        """Return the question which of some links are walked."""
        return asked.adding(fact for link in links for fact in _link_facts(link, model, doors))

    links = walks.links
    if not rules.ruled:  # then all prices are lengths, or come on top of them
        offered = {name for way in walks.ways for name in way}
        best = over(link for link in links if link.name in offered).bounded("walks")
        if best.atoms is not None:  # what is longer cannot be better
            length = best.cost_at(WALK_LEVEL) / 100
            offered |= {link.name for link in links_within(links, walks.ends, length)}
            links = tuple(link for link in links if link.name in offered)
    given = over(links)
    atoms = given.bounded("walks").atoms
    if atoms is None:
        return NoWalk(given.blamed(lambda _: False))
    steps = {str(a.arguments[1]): (str(a.arguments[0]), str(a.arguments[2])) for a in atoms if a.match("step", 3)}
    names, here = [], walks.ends[0]
    while here != walks.ends[1]:
        name, here = steps[here]
        names.append(name)
    way = tuple(names)
    route = walks.routes[walks.ways.index(way)] if way in walks.ways else walks.tighten(way)
    return WalkChoice(route, given)


def _link_facts(link: Link, model: WorldModel, doors: Sequence[Door]) -> Iterator[str]:
    """Yield the facts about a link."""
    name, (one, other) = link.name, link.ends
    yield f"link({name},{one},{other},{hundredths(link.length)},{hundredths(link.clearance)})"
    columns, rows = np.floor(link.points).astype(int).T
    yield f"risk({name},{_risk(columns[1:], rows[1:], model)})"
    yield from (f"crosses({name},{door.name})" for door in doors if count_crossings(link.points, door) % 2)


def _facts_for_rules(links: Sequence[Link], model: WorldModel, rules: WalkRules) -> Iterator[str]:
    """Yield what users' rules alone ask of links: where they lead, what bounds them, where the robot has been."""
    points, clearances = (np.concatenate([getattr(link, part) for link in links]) for part in ("points", "clearances"))
    columns, rows = np.floor(points).astype(int).T
    rooms = np.zeros(len(points), np.int64) if rules.rooms is None else rules.rooms.labels[rows, columns]
    been = shapely.MultiPoint(np.array(rules.track or [model.place]) - (model.view.west, model.view.south))
    path = been if len(been.geoms) == 1 else shapely.LineString(been.geoms)
    trodden = shapely.distance(shapely.points(points), path) < TRODDEN
    ends = np.cumsum([len(link.points) for link in links])[:-1]
    parts = (np.split(values, ends) for values in (bordering(points, clearances, model), rooms, trodden))
    for link, beside, within, passed in zip(links, *parts, strict=True):
        yield from (f"borders({link.name},{model.objects[thing].name})" for thing in np.flatnonzero(beside.any(0)))
        yield from (f"in_room({link.name},r{room})" for room in np.unique(within[within > 0]))
        yield f"trodden({link.name},{round(100 * float(passed.mean()))})"
        east, north = model.place_to_utak(*link.points[len(link.points) // 2])
        yield f"middle({link.name},{hundredths(east)},{hundredths(north)})"


def _risk(columns: Longs, rows: Longs, model: WorldModel) -> int:
    """Return the probability of being occupied, in percent, summed over some squares of the view."""
    return round(100 * float(model.view.probability[rows, columns].sum()))


def _planned(points: Floats, length: float, clearance: float, free: Bools, level: int) -> PlannedRoute:
    return PlannedRoute(tuple(squares_along(free, points.tolist())), length, clearance, level)


def _corners_in_robot_frame(route: PlannedRoute, model: WorldModel) -> list[list[float]]:
    """Return the first square of a route, those where it changes its direction, and the last one."""
    squares = np.array(route.squares)
    steps = np.diff(squares, axis=0)
    turns = [0, *(np.flatnonzero((steps[1:] != steps[:-1]).any(axis=1)) + 1).tolist(), len(squares) - 1]
    places = (model.place_to_utak(*_centre((column, row))) for column, row in squares[turns].tolist())
    return [[round(east, 2), round(north, 2)] for east, north in places]


def leads_through(route: PlannedRoute, door: Door) -> bool:
    """Return whether a route passes the neck of a door, also where it comes back."""
    return went_through(np.array(route.squares) + 0.5, door)


def _centre(square: Square) -> XY:
    """Return the centre (x, y) of a square (column, row), in squares, in the same frame."""
    return square[0] + 0.5, square[1] + 0.5
