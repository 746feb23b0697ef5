"""Routes over a screen by one of the paper's three path-finders, and the choice among them (planner/asp/routes.lp).

Geometry finds topologically distinct routes. Their lengths, clearances and risks become facts, with the doors that they
lead through.
"""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import NamedTuple

import numpy as np

from utak.geometry import Screen
from utak.geometry.kernels.arrays import XY, Bools, Floats, Square
from utak.geometry.pathfinders.grid_astar import grid_path
from utak.geometry.pathfinders.visibility_graph import visibility_path
from utak.kb.reasoning.solver import solve
from utak.kb.world.model import WorldModel
from utak.kb.world.rooms import Door, went_through
from utak.planner.navigation.subgoals import PLANNER_ASP, TENTHS_PER_SQUARE
from utak.planner.screen.projection import CostMaps, SquareIndices
from utak.planner.screen.sweeps import squares_along

MAX_ROUTES = 4  # topologically distinct routes that are offered for a choice (tuned on random worlds)
NO_DOOR_PRICES: Mapping[str, float] = {}
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


# Points (x, y) from centre to centre in the view frame, length and clearance, all in squares.
FoundLine = tuple[list[list[float]], float, float]
# Of the free squares, (rows, columns), the start and the goal.
PathFinder = Callable[[Bools, Square, Square], list[FoundLine]]


def _by_skeleton(free: Bools, start: Square, goal: Square) -> list[FoundLine]:
    """Find the tight routes of the shortest topological classes, from the pathgraph of the skeleton."""
    routes = Screen(free).routes(_centre(start), _centre(goal), k=MAX_ROUTES)
    return [(route.points.tolist(), route.length, route.clearance) for route in routes]


def _single(find: Callable[..., Floats | None], free: Bools, start: Square, goal: Square) -> list[FoundLine]:
    """Find the only route of a path-finder, with the clearance of the squares that it touches; [] for none."""
    points = find(free, _centre(start), _centre(goal))
    if points is None:
        return []
    line = points.tolist()
    columns, rows = np.array(squares_along(free, line)).T
    length = float(np.hypot(*np.diff(points, axis=0).T).sum())
    return [(line, length, float(Screen(free).clearance[rows, columns].min()))]


# By the skeleton; along lines of visibility between extreme points of obstacles, as Shakey's; by A* over the squares
# and their eight neighbours. The last two find the shortest route alone.
PATH_FINDERS: Mapping[str, PathFinder] = {
    "skeleton": _by_skeleton,
    "visibility": partial(_single, visibility_path),
    "grid": partial(_single, grid_path),
}


def find_routes(cost_maps: CostMaps, level: int, goals: SquareIndices, finder: str) -> list[PlannedRoute]:
    """Find topologically distinct routes to the nearest reachable square of `goals`, the shortest first."""
    free, distances = cost_maps.free(level), cost_maps.distances[level].ravel()
    reached = goals[distances[goals] >= 0]
    row, column = divmod(int(reached[np.argmin(distances[reached])]), free.shape[1])
    if (column, row) == cost_maps.here:
        return [PlannedRoute((cost_maps.here,), 0.0, 0.0, level)]
    lines = PATH_FINDERS[finder](free, cost_maps.here, (column, row))
    return [PlannedRoute(tuple(squares_along(free, points)), length, clear, level) for points, length, clear in lines]


def choose_route(
    offered: Sequence[PlannedRoute],
    cost_maps: CostMaps,
    before: frozenset[Square],
    doors: Sequence[Door],
    forbidden: frozenset[str],
    prices: Mapping[str, float] = NO_DOOR_PRICES,
) -> PlannedRoute | None:
    """Choose one of some routes, by planner/asp/routes.lp; None when every route leads through a forbidden door."""
    # It is the one of least length, with costs added for risk, for a clearance below one square, and for a switch from
    # the route before; of equals the first offered.
    facts = [f"not_through({door})" for door in sorted(forbidden)]
    facts += [f"door_price({door},{round(TENTHS_PER_SQUARE * price)})" for door, price in sorted(prices.items())]
    for number, route in enumerate(offered):
        columns, rows = np.array(route.squares).T
        risk = round(100 * float(cost_maps.model.view.probability[rows[1:], columns[1:]].sum()))
        length, clearance = (round(TENTHS_PER_SQUARE * squares) for squares in (route.length, route.clearance))
        facts.append(f"route({number},{length},{clearance},{risk})")
        facts += [f"through({number},{door.name})" for door in doors if leads_through(route, door)]
        if len(before.intersection(route.squares)) > MIN_SHARED * len(route.squares):
            facts.append(f"last({number})")
    about = [_corners_in_robot_frame(route, cost_maps.model) for route in offered]
    answer = solve([PLANNER_ASP / "routes.lp"], facts, about=about)
    return offered[answer[0].arguments[0].number] if answer else None


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
