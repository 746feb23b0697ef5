"""Encircling: a closed track that winds once around an object.

The track walked so far, closed by the rest of the way, must cross a ray from the object once, with sign. So what
remains is a way to the start with a certain crossing number. Geometry finds the shortest way for each sense of
rotation. The choice between them is made like any other choice among topologically distinct routes.
"""

from collections.abc import Sequence

import numpy as np

from utak.geometry.kernels.arrays import XY, Floats, Square
from utak.geometry.raster.winding import MAX_CROSSING_NUMBER, crossing_number, shortest_path_with_crossing_number
from utak.kb.world.model import Node
from utak.planner.navigation.walks import PlannedRoute
from utak.planner.screen.projection import UNSEEN_LEVEL, CostMaps


def winding_number(track: Sequence[XY], node: Node) -> int:
    """Compute how many turns a track makes around an object, counter-clockwise positive; a whole number."""
    return crossing_number(_centred([*track, track[0]]), encircled_point(node))


def encircling_routes(cost_maps: CostMaps, track: Sequence[XY], node: Node) -> dict[int, PlannedRoute]:
    """Find the routes that complete one turn around an object and end where it began, by the sense of rotation."""
    model = cost_maps.model
    x, y = encircled_point(node)
    about = (x - model.view.west, y - model.view.south)
    row, column = model.view.locate(*track[0])
    goal = (column, row)
    done = crossing_number(_centred(track), (x, y))
    for level in range(UNSEEN_LEVEL + 1):
        free = cost_maps.free(level) & ~model.mask(node.patch)
        free[cost_maps.here[1], cost_maps.here[0]] = True  # an object seen coarsely may seem to cover it
        if not free[goal[1], goal[0]]:
            continue
        found = {}
        for turn in (1, -1):
            number = turn - done
            if abs(number) <= MAX_CROSSING_NUMBER:
                squares = shortest_path_with_crossing_number(free, cost_maps.here, goal, about, number)
                if squares and len(squares) > 1:
                    found[turn] = _route(squares, level)
        if found:
            return found
    return {}


def _centred(track: Sequence[XY]) -> Floats:
    """Move each point of a track to the centre of its square, (n, 2) float64: routes are made of centres, too."""
    centres: Floats = np.floor(np.array(track)) + 0.5
    return centres


def _route(squares: Sequence[Square], level: int) -> PlannedRoute:
    """Make an edge-connected route of squares connected by edge or corner: diagonal steps get a square between."""
    path = [squares[0]]
    for column, row in squares[1:]:
        if column != path[-1][0] and row != path[-1][1]:
            path.append((column, path[-1][1]))
        path.append((column, row))
    length = float(np.hypot(*np.diff(np.array(squares), axis=0).T).sum())
    return PlannedRoute(tuple(path), length, 0.5, level)


def encircled_point(node: Node) -> XY:
    """Return a point (x, y) within the object, in squares, map frame."""
    x, y = node.patch.centre
    column, row = min(node.patch.squares(), key=lambda s: (round(np.hypot(s[0] + 0.5 - x, s[1] + 0.5 - y), 6), s))
    return column + 0.5, row + 0.5
