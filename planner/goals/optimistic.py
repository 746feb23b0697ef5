"""Floor that is hoped for: what was never seen, or is not clear, where floor leads to it.

Who carries things is bold there: to be stopped costs him a command or two, and mostly he is not. What is hoped for may
lie beyond all that was seen, so that masks of it have a frame of BEYOND squares about the arrays of the view.
"""

import numpy as np
from numpy.typing import NDArray

from geometry.raster.components import edged
from planner.situation import Situation

Mask = NDArray[np.bool_]
BEYOND = 6  # squares that floor is hoped to go on unseen
BOLD = 2  # level of certainty of squares that are hoped to be free


def framed(mask: Mask) -> Mask:
    """(rows + 2 BEYOND, columns + 2 BEYOND): a mask of the view with its frame, in which nothing is marked."""
    return np.pad(mask, BEYOND)


def spread(mask: Mask, situation: Situation) -> Mask:
    """A mask of the view with its frame, and the squares never seen to which so many steps over their edges lead."""
    unseen, wider = ~framed(situation.model.view.seen), framed(mask)
    for _ in range(BEYOND):
        wider |= edged(wider) & unseen
    return wider


def hoped_floor(situation: Situation) -> Mask:
    """All squares that are hoped to be free, with the frame."""
    return spread(situation.cost_maps.free(BOLD), situation)
