"""The way that he is on, and what he aims at: kept while it holds, on the lattice, however the view grows."""

import numpy as np

from kb.world.model import WorldModel
from planner.navigation.routes import PlannedRoute
from planner.navigation.subgoals import Subgoal
from planner.screen.projection import CostMaps, Squares
from planner.screen.sweeps import Square


class StickyRoute:
    """Remembers the squares of the lattice that were aimed at, and those of the way there."""

    def __init__(self) -> None:
        self._aimed: frozenset[Square] = frozenset()
        self._path: tuple[Square, ...] = ()
        self._level = 0  # of certainty of the way

    def keep(self, way: PlannedRoute, aimed: frozenset[Square], model: WorldModel) -> None:
        """Remember a way, and the squares of the lattice that are aimed at by it."""
        view = model.view
        self._path = tuple((column + view.west, row + view.south) for column, row in way.squares)
        self._aimed, self._level = aimed, way.level

    def path(self, model: WorldModel) -> list[Square]:
        """The squares (column, row) of the way, on the arrays of the view."""
        return [(x - model.view.west, y - model.view.south) for x, y in self._path]

    def subgoal(self, model: WorldModel) -> frozenset[int]:
        """The squares aimed at last time, as flat indices of this view."""
        rows, columns = model.labels.shape
        places = ((y - model.view.south, x - model.view.west) for x, y in self._aimed)
        return frozenset(row * columns + column for row, column in places if 0 <= row < rows and 0 <= column < columns)

    def rest(self, subgoal: Subgoal, level: int, model: WorldModel, cost_maps: CostMaps) -> PlannedRoute | None:
        """What is left of the way, when it still leads to an aim over squares believed free."""
        path = self.path(model)
        if level != self._level or cost_maps.here not in path:
            return None
        rest = path[path.index(cost_maps.here) :]
        columns, rows = np.array(rest).T
        end = rest[-1][1] * model.labels.shape[1] + rest[-1][0]
        if len(rest) < 2 or end not in subgoal.squares or not cost_maps.free(level)[rows, columns].all():
            return None
        return PlannedRoute(tuple(rest), float(len(rest)), 0.0, level)


def lattice_squares(squares: Squares, model: WorldModel) -> frozenset[Square]:
    """Squares of the lattice, from flat indices of the view."""
    rows, columns = np.divmod(squares, model.labels.shape[1])
    return frozenset(zip((columns + model.view.west).tolist(), (rows + model.view.south).tolist(), strict=True))
