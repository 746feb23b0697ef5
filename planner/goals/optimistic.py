"""Optimistic planning: floor that is likely there where it was never seen or is not settled.

A robot that carries objects takes such a risk: being stopped costs it a command or two, and mostly it is not stopped.
The floor may go on beyond all that was seen. So masks of it have a margin of UNSEEN_MARGIN squares around the arrays
of the view.
"""

import numpy as np

from utak.geometry.kernels.arrays import Bools
from utak.geometry.raster.components import with_edge_neighbours
from utak.planner.situation import Situation

UNSEEN_MARGIN = 6  # squares that the floor is assumed to go on unseen, and the margin of masks (tuned)
OPTIMISTIC_LEVEL = 2  # certainty level of the seen squares that are assumed to be free (tuned on random worlds)


def spread_into_unseen(mask: Bools, situation: Situation) -> Bools:
    """Add to a mask the unseen squares that UNSEEN_MARGIN steps from square to neighbouring square lead to from it."""
    unseen, wider = ~np.pad(situation.model.view.seen, UNSEEN_MARGIN), np.pad(mask, UNSEEN_MARGIN)
    for _ in range(UNSEEN_MARGIN):
        wider |= with_edge_neighbours(wider) & unseen
    return wider


def optimistic_floor(situation: Situation) -> Bools:
    """Return all squares that are assumed to be free, (rows + 2 UNSEEN_MARGIN, columns + 2 UNSEEN_MARGIN) bool."""
    return spread_into_unseen(situation.cost_maps.free(OPTIMISTIC_LEVEL), situation)
