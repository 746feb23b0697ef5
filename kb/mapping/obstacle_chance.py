"""The probability that something stands on squares that are open: by counts alone, or as completions of the map show.

Squares of one completion go together: where it shows a wall along a way, the wall runs along all of it. So the
probability that a motion meets an obstacle is computed for each completion by itself, and then averaged.
"""

import math
from collections.abc import Iterable, Sequence

import numpy as np

from geometry.kernels.arrays import Floats, Square
from kb.mapping.completions import Completions
from kb.mapping.occupancy import OCCUPIED, OPEN, OccupancyMap

ERROR_PROBABILITY = 0.001  # that all completions show a square wrongly; tuned on random worlds (benchmarks.campaign)
ERROR_PROBABILITY_AT_EDGE = 0.02  # likewise of a square next to one that some completion shows occupied; tuned
UNSEEN_PROBABILITY = np.array([0.12])  # that something stands on a square never seen: floor mostly goes on; tuned


class ObstacleChance:
    """The probabilities that squares of a map are occupied, each computed once.

    Parameters
    ----------
    occupancy : OccupancyMap
        The map; it grows where a square beyond it is asked for. A probability once asked for stays, whatever is settled
        later.
    completions : Completions, optional
        Completions of the map (sampled maps that agree with all counts). Without them counts alone give the probability
        of an open square.
    """

    def __init__(self, occupancy: OccupancyMap, completions: Completions | None = None) -> None:
        """Begin with no probability computed."""
        self._occupancy = occupancy
        self._completions = completions
        self._known: dict[Square, Floats] = {}

    def occupied(self, square: Square) -> Floats:
        """Return the probability that a square is occupied, by each completion.

        Parameters
        ----------
        square : (x, y)
            Map frame.

        Returns
        -------
        (m,) float64
            One value, 0 to 1, for each completion; (1,) where the square is settled (0 or 1), where there are no
            completions, or where nothing was seen (UNSEEN_PROBABILITY).
        """
        if square not in self._known:
            self._known[square] = self._probabilities(square)
        return self._known[square]

    def _probabilities(self, square: Square) -> Floats:
        """Return the probability that a square (x, y) of the map frame is occupied, by each completion; not yet kept.

        (m,) float64, 0 to 1, or (1,) where the square is settled (0 or 1), where there are no completions (then by
        counts alone), or where nothing was seen (UNSEEN_PROBABILITY itself, 0.12). The map grows to hold the square.
        """
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
        """Return whether some completion shows an edge neighbour of a square (x, y) of the map frame occupied.

        Neighbours that were never seen, or lie beyond the completions, do not count. Completions must be given.
        """
        assert self._completions is not None
        x, y = square
        shown = (self._completions.at(x + dx, y + dy) for dx, dy in ((1, 0), (-1, 0), (0, 1), (0, -1)))
        return any(one is not None and one.any() for one in shown)

    def odds(self, square: Square) -> float:
        """Return the log odds (natural logarithm) that an open square (x, y) of the map frame is occupied.

        By the mean of its probability over all completions; above 0 where it is more likely occupied than free. A
        settled square has none: it raises ValueError or ZeroDivisionError.
        """
        likely = float(self.occupied(square).mean())
        return math.log(likely / (1.0 - likely))

    def met(self, groups: Sequence[Iterable[Square]]) -> list[float]:
        """Return for each group of squares the probability that it holds the first obstacle of a motion.

        Squares of a group that were never seen count as one square: they are adjacent, and a wall is straight.

        Parameters
        ----------
        groups : sequence of iterables of (x, y)
            The squares that the motion enters, group after group in the order of the way; map frame.

        Returns
        -------
        list of float
            In the same order, 0 to 1. They sum to 1 at most; the rest is that the motion meets nothing.
        """
        free, found = np.ones(1), []
        for squares in groups:
            occupied = [self.occupied(square) for square in squares]
            clear = 1.0 - UNSEEN_PROBABILITY if any(one is UNSEEN_PROBABILITY for one in occupied) else np.ones(1)
            for one in occupied:
                clear = clear if one is UNSEEN_PROBABILITY else clear * (1.0 - one)
            found.append(float((free * (1.0 - clear)).mean()))
            free = free * clear
        return found
