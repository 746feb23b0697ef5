"""The probability that something stands on squares that are open: by counts alone, or as completions of the map show.

Squares of one completion go together: where it shows a wall along a way, the wall runs along all of it. So the
probability that a motion meets an obstacle is computed for each completion by itself, and then averaged.
"""

import math
from collections.abc import Iterable, Sequence

import numpy as np

from utak.geometry.kernels.arrays import Floats, Square
from utak.kb.mapping.completions import Completions
from utak.kb.mapping.occupancy import FREE, OCCUPIED, OPEN, OccupancyMap

ERROR_PROBABILITY = 0.001  # that all completions show a square wrongly; tuned on random worlds (benchmarks.campaign)
ERROR_PROBABILITY_AT_EDGE = 0.02  # likewise of a square next to one that some completion shows occupied; tuned
UNSEEN_PROBABILITY = np.array([0.12])  # that something stands on a square never seen: floor mostly goes on; tuned


class ObstacleChance:
    """The probabilities that squares of a map are occupied, each computed once."""

    def __init__(self, occupancy: OccupancyMap, completions: Completions | None = None) -> None:
        """Begin with no probability computed."""
        self._occupancy = occupancy
        self._completions = completions
        self._known: dict[Square, Floats] = {}

    def occupied(self, square: Square) -> Floats:
        """Return the probability that a square is occupied, by each completion."""
        if square not in self._known:
            self._known[square] = self._probabilities(square)
        return self._known[square]

    def likeliest(self, square: Square) -> int:
        """Return what a square (x, y) of the map frame likeliest is, FREE or OCCUPIED; OPEN where nothing was seen."""
        occupied = self.occupied(square)
        if occupied is UNSEEN_PROBABILITY or occupied.mean() == 0.5:
            return OPEN
        return OCCUPIED if occupied.mean() > 0.5 else FREE

    def _probabilities(self, square: Square) -> Floats:
        """Return the probability that a square (x, y) of the map frame is occupied, by each completion."""
        self._occupancy.make_room(*square)
        index = self._occupancy.index(*square)
        state = self._occupancy.state[index]
        if state != OPEN:
            return np.array([float(state == OCCUPIED)])
        if self._completions is None:
            return np.array([1.0 / (1.0 + math.exp(-float(self._occupancy.logit[index])))])
        shown = self._completions.at(*square)
        if shown is None:
            return UNSEEN_PROBABILITY
        wrong = ERROR_PROBABILITY_AT_EDGE if self._next_to_occupied(square) else ERROR_PROBABILITY
        return np.where(shown, 1.0 - wrong, wrong)

    def _next_to_occupied(self, square: Square) -> bool:
        """Return whether some completion shows an edge neighbour of a square (x, y) of the map frame occupied."""
        assert self._completions is not None
        x, y = square
        shown = (self._completions.at(x + dx, y + dy) for dx, dy in ((1, 0), (-1, 0), (0, 1), (0, -1)))
        return any(one is not None and one.any() for one in shown)

    def odds(self, square: Square) -> float:
        """Return the log odds (natural logarithm) that an open square (x, y) of the map frame is occupied."""
        # A settled square has none: it raises ValueError or ZeroDivisionError.
        likely = float(self.occupied(square).mean())
        return math.log(likely / (1.0 - likely))

    def met(self, groups: Sequence[Iterable[Square]]) -> list[float]:
        """Return for each group of squares the probability that it holds the first obstacle of a motion."""
        free, found = np.ones(1), []
        for squares in groups:
            occupied = [self.occupied(square) for square in squares]
            clear = 1.0 - UNSEEN_PROBABILITY if any(one is UNSEEN_PROBABILITY for one in occupied) else np.ones(1)
            for one in occupied:
                clear = clear if one is UNSEEN_PROBABILITY else clear * (1.0 - one)
            found.append(float((free * (1.0 - clear)).mean()))
            free = free * clear
        return found
