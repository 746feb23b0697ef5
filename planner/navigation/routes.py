"""Ways over a screen, by one of the paper's three path-finders, and the choice among them (planner/asp/routes.lp).

Geometry finds topologically distinct routes; their lengths, clearances and risks go to the encoding as facts, with
the doors they lead through.
"""

from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from geometry import Screen
from geometry.pathfinders.grid_astar import grid_way
from geometry.pathfinders.visibility_graph import visibility_way
from kb.reasoning.solver import solve
from kb.world.rooms import Door, crosses
from planner.navigation.subgoals import ASP
from planner.screen.projection import CostMaps
from planner.screen.sweeps import Square, squares_along

Mask = NDArray[np.bool_]
Points = Sequence[tuple[float, float]]
ROUTES = 4  # topologically distinct routes that are offered for a choice
SHARED = 0.6  # of a way's squares: then it continues the one before


class PlannedRoute(NamedTuple):
    """A way that geometry found.

    squares : (column, row), edge-connected and free. length, clearance : in squares.
    level : of certainty, 0 the surest (planner.screen.projection).
    """

    squares: tuple[Square, ...]
    length: float
    clearance: float
    level: int


Line = tuple[list[list[float]], float, float]  # points (x, y), length, clearance
PathFinder = Callable[[Mask, Square, Square], list[Line]]


def by_skeleton(free: Mask, here: Square, there: Square) -> list[Line]:
    """Tight routes, one for each class, from the pathgraph of the skeleton: (points, length, clearance) of each."""
    routes = Screen(free).routes(_centre(here), _centre(there), k=ROUTES)
    return [(route.points.tolist(), route.length, route.clearance) for route in routes]


def by_visibility(free: Mask, here: Square, there: Square) -> list[Line]:
    """The shortest way along lines of visibility between extreme points of obstacles, as Shakey went."""
    return _single(free, visibility_way(free, _centre(here), _centre(there)))


def by_grid(free: Mask, here: Square, there: Square) -> list[Line]:
    """The shortest way over the squares and their eight neighbours, by A*."""
    return _single(free, grid_way(free, _centre(here), _centre(there)))


def _single(free: Mask, points: NDArray[np.float64] | None) -> list[Line]:
    """A path-finder's only way, with its length and the clearance of the squares that it touches."""
    if points is None:
        return []
    line = points.tolist()
    columns, rows = np.array(squares_along(free, line)).T
    length = float(np.hypot(*np.diff(points, axis=0).T).sum())
    return [(line, length, float(Screen(free).clearance[rows, columns].min()))]


FINDERS: Mapping[str, PathFinder] = {"skeleton": by_skeleton, "visibility": by_visibility, "grid": by_grid}


def ways(cost_maps: CostMaps, level: int, goals: NDArray[np.int64], finder: str) -> list[PlannedRoute]:
    """Topologically distinct ways, at a level of certainty, to the nearest square that can be reached of some."""
    free, distances = cost_maps.free(level), cost_maps.distances[level].ravel()
    reached = goals[distances[goals] >= 0]
    row, column = divmod(int(reached[np.argmin(distances[reached])]), free.shape[1])
    if (column, row) == cost_maps.here:
        return [PlannedRoute((cost_maps.here,), 0.0, 0.0, level)]
    found = FINDERS[finder](free, cost_maps.here, (column, row))
    return [PlannedRoute(tuple(squares_along(free, points)), length, clear, level) for points, length, clear in found]


def choose_way(
    offered: Sequence[PlannedRoute],
    cost_maps: CostMaps,
    before: frozenset[Square],
    doors: Sequence[Door],
    forbidden: frozenset[str],
) -> PlannedRoute | None:
    """The way that kb rules prefer; None when every one of them is forbidden.

    before : the squares of the way chosen last time. doors : known doors. forbidden : those that the task forbids.
    """
    facts = [f"not_through({door})" for door in sorted(forbidden)]
    for number, way in enumerate(offered):
        columns, rows = np.array(way.squares).T
        risk = round(100 * float(cost_maps.model.view.probability[rows[1:], columns[1:]].sum()))
        facts.append(f"route({number},{round(10 * way.length)},{round(10 * way.clearance)},{risk})")
        facts += [f"through({number},{door.name})" for door in doors if leads_through(way, door)]
        if len(before.intersection(way.squares)) > SHARED * len(way.squares):
            facts.append(f"last({number})")
    answer = solve([ASP / "routes.lp"], facts)
    return offered[answer[0].arguments[0].number] if answer else None


def leads_through(way: PlannedRoute, door: Door) -> bool:
    """Does a way cross the neck of a door, and not come back?"""
    points = np.array(way.squares) + 0.5
    return bool(crosses(points, door) % 2)


def _centre(square: Square) -> tuple[float, float]:
    return square[0] + 0.5, square[1] + 0.5
