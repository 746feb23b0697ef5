"""What may stand on squares of which it is open: by counts alone, or as pictures of the map show it.

What pictures show goes together: where one shows a wall that runs along a way, it runs along all of it. So how likely a
motion comes upon something is asked of each picture by itself.
"""

import math
from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from kb.mapping.completions import Completions
from kb.mapping.occupancy import FULL, OPEN, OccupancyMap

Square = tuple[int, int]
Floats = NDArray[np.float64]
HARDLY, BESIDE = 0.001, 0.02  # how likely all pictures show a square wrongly; beside what one of them shows occupied
UNSEEN = np.array([0.12])  # how likely something stands on a square never seen: floor mostly goes on


class ObstacleChance:
    """What may stand on the squares of a map. pictures : of it; by counts alone without."""

    def __init__(self, occupancy: OccupancyMap, pictures: Completions | None = None) -> None:
        self._occupancy = occupancy
        self._pictures = pictures
        self._known: dict[Square, Floats] = {}

    def occupied(self, square: Square) -> Floats:
        """(m,): how likely a square is occupied, by each of the pictures; by counts as one."""
        if square not in self._known:
            self._known[square] = self._asked(square)
        return self._known[square]

    def _asked(self, square: Square) -> Floats:
        self._occupancy.make_room(*square)
        index = self._occupancy.index(*square)
        state = self._occupancy.state[index]
        if state != OPEN:
            return np.array([float(state == FULL)])
        if self._pictures is None:
            return np.array([1.0 / (1.0 + math.exp(-float(self._occupancy.logit[index])))])
        shown = self._pictures.at(*square)
        if shown is None:
            return UNSEEN
        wrong = BESIDE if self._beside(square) else HARDLY
        return np.where(shown, 1.0 - wrong, wrong)

    def _beside(self, square: Square) -> bool:
        """Does a square lie beside one that some picture shows occupied?"""
        assert self._pictures is not None
        x, y = square
        shown = (self._pictures.at(x + dx, y + dy) for dx, dy in ((1, 0), (-1, 0), (0, 1), (0, -1)))
        return any(one is not None and one.any() for one in shown)

    def odds(self, square: Square) -> float:
        """The log odds that a square is occupied of which that is open."""
        likely = float(self.occupied(square).mean())
        return math.log(likely / (1.0 - likely))

    def met(self, groups: Sequence[Iterable[Square]]) -> list[float]:
        """How likely each of some groups of squares, come upon in this order, is the first with an obstacle.

        Those of a group that were never seen lie side by side, and count as one: a wall is straight.
        """
        free, found = np.ones(1), []
        for squares in groups:
            occupied = [self.occupied(square) for square in squares]
            clear = 1.0 - UNSEEN if any(one is UNSEEN for one in occupied) else np.ones(1)
            for one in occupied:
                clear = clear if one is UNSEEN else clear * (1.0 - one)
            found.append(float((free * (1.0 - clear)).mean()))
            free = free * clear
        return found
