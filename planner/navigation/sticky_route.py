"""The sticky route: the route under way and its subgoal, kept while they hold.

Both are kept in the map frame, so that they stay valid when the view grows.
"""

import numpy as np

from utak.geometry.kernels.arrays import Square
from utak.kb.world.model import WorldModel
from utak.planner.navigation.subgoals import Subgoal
from utak.planner.navigation.walks import PlannedRoute
from utak.planner.screen.projection import CostMaps, SquareIndices


class StickyRoute:
    """Remembers the squares of the present route and of its subgoal, in the map frame."""

    def __init__(self) -> None:
        """Remember no route yet."""
        self._subgoal: frozenset[Square] = frozenset()
        self._path: tuple[Square, ...] = ()
        self._level = 0  # the certainty level of the route

    def keep(self, route: PlannedRoute, subgoal: frozenset[Square], model: WorldModel) -> None:
        """Remember a route, on the arrays of the present view, and the squares of its subgoal, in the map frame."""
        view = model.view
        self._path = tuple((column + view.west, row + view.south) for column, row in route.squares)
        self._subgoal, self._level = subgoal, route.level

    def path(self, model: WorldModel) -> list[Square]:
        """Return the squares (column, row) of the route on the arrays of the present view, in order; [] for none."""
        return [(x - model.view.west, y - model.view.south) for x, y in self._path]

    def subgoal(self, model: WorldModel) -> frozenset[int]:
        """Return the squares of the subgoal on the arrays of the present view, as flat indices."""
        return frozenset(np.flatnonzero(model.squares(self._subgoal)).tolist())

    def rest(self, subgoal: Subgoal, level: int, model: WorldModel, cost_maps: CostMaps) -> PlannedRoute | None:
        """Return the rest of the route from the robot's square on, if it still leads to a subgoal over free squares."""
        # None when the robot is not on the route or at its end, when it ends at no square of the subgoal, or when a
        # square ahead is not free at the level.
        path = self.path(model)
        if level != self._level or cost_maps.here not in path:
            return None
        rest = path[path.index(cost_maps.here) :]
        columns, rows = np.array(rest).T
        end = rest[-1][1] * model.labels.shape[1] + rest[-1][0]
        if len(rest) < 2 or end not in subgoal.squares or not cost_maps.free(level)[rows, columns].all():
            return None
        return PlannedRoute(tuple(rest), float(len(rest)), 0.0, level)


def to_map_squares(squares: SquareIndices, model: WorldModel) -> frozenset[Square]:
    """Convert flat indices (row * columns + column) on the arrays of the view to squares (x, y) of the map frame."""
    rows, columns = np.divmod(squares, model.labels.shape[1])
    return frozenset(zip((columns + model.view.west).tolist(), (rows + model.view.south).tolist(), strict=True))
