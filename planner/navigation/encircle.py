"""Circling: a closed track that winds once about an object.

The track walked so far, closed by the way that is still to go, must cross a ray from the object once, with sign. So
what remains is a way to the
start with a certain crossing number; geometry finds the shortest of each, and the choice between going left and going
right is made like any other choice among topologically distinct routes.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from geometry.raster.winding import MOST, crossings, winding_way
from kb.world.model import Node, WorldModel
from planner.navigation.routes import PlannedRoute
from planner.screen.projection import UNSEEN, CostMaps
from planner.screen.sweeps import Square

Place = tuple[float, float]


def winding(track: Sequence[Place], node: Node) -> int:
    """How often a track (points of the lattice), closed by its first point, winds about an object."""
    return crossings(_centred([*track, track[0]]), pivot(node))


def ways_round(cost_maps: CostMaps, track: Sequence[Place], node: Node) -> dict[int, PlannedRoute]:
    """The ways, at the most certain level, that complete one turn about an object and end where the track began.

    By the sign of the turn: 1 counter-clockwise, -1 clockwise.
    """
    model = cost_maps.model
    x, y = pivot(node)
    about = (x - model.view.west, y - model.view.south)
    goal = _square(track[0], model)
    done = crossings(_centred(track), (x, y))
    for level in range(UNSEEN + 1):
        free = cost_maps.free(level) & ~model.mask(node.patch)
        free[cost_maps.here[1], cost_maps.here[0]] = (
            True  # a thing seen coarsely may seem to reach as far as his square
        )
        if not free[goal[1], goal[0]]:
            continue
        found = {}
        for turn in (1, -1):
            number = turn - done
            squares = winding_way(free, cost_maps.here, goal, about, number) if abs(number) <= MOST else None
            if squares and len(squares) > 1:
                found[turn] = _way(squares, level)
        if found:
            return found
    return {}


def _centred(track: Sequence[Place]) -> NDArray[np.float64]:
    """(n, 2): a track by the centres of its squares, as a way is told: so both count on one side of the ray."""
    centres: NDArray[np.float64] = np.floor(np.array(track)) + 0.5
    return centres


def _way(squares: Sequence[Square], level: int) -> PlannedRoute:
    """A way as an edge-connected path: a diagonal step is made by the square beside it."""
    path = [squares[0]]
    for column, row in squares[1:]:
        if column != path[-1][0] and row != path[-1][1]:
            path.append((column, path[-1][1]))
        path.append((column, row))
    length = float(np.hypot(*np.diff(np.array(squares), axis=0).T).sum())
    return PlannedRoute(tuple(path), length, 0.5, level)


def pivot(node: Node) -> Place:
    """A point within the object: the centre of its square nearest to its middle."""
    x, y = node.patch.centre
    column, row = min(node.patch.squares(), key=lambda s: (round(np.hypot(s[0] + 0.5 - x, s[1] + 0.5 - y), 6), s))
    return column + 0.5, row + 0.5


def _square(place: Place, model: WorldModel) -> Square:
    row, column = model.view.locate(*place)
    return column, row
