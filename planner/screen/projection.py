"""Projection of the world model onto the screen, Utak's map-in-the-head: which squares a way may lead over, and how
sure that is.

A screen is an array of squares, [row, column], cut to the window that was seen. There are several, from the squares
that are surely floor to all that
might be: a way over a less certain one is a way only if what is assumed proves true.
"""

from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from geometry.raster.components import edged
from geometry.raster.geodesic import UNREACHED, reach
from kb.mapping.occupancy import FREE, OPEN
from kb.mapping.patch import Patch
from kb.world.model import SPACE, WorldModel
from planner.screen.unseen_gain import gain

Mask = NDArray[np.bool_]
Squares = NDArray[np.int64]  # flat indices
LEVELS = (SPACE, 0.15, 0.3, 0.45)  # up to which probability of being occupied a square may be crossed
UNSEEN = len(LEVELS)  # the level at which unseen squares may be crossed too
PRICE = 6.0  # squares that each level of uncertainty costs
APPROACHED = 1  # level of certainty of squares beside a thing over which he goes up to it
TRUSTED = 0.04  # a square that is occupied with at most this probability may be run over
WALL_LIKE = 0.85  # that a square is occupied which surely belongs to what stands there
WARY = 0.3  # beside squares that are occupied with at least this probability a move is made only over settled ones


class Reached(NamedTuple):
    """level: of certainty, 0 the surest. cost: the way in squares, with a price for each level."""

    level: int
    cost: float


class CostMaps:
    """One world model, projected at every level of certainty.

    Arrays are (rows, columns), as those of the model's view. carried : the squares of what goes along with him, and so
    is not in his way.
    """

    def __init__(self, model: WorldModel, carried: Mask | None = None) -> None:
        self.model = model
        self._carried = carried
        row, column = model.view.locate(*model.place)
        self.here = (column, row)
        self._barred = model.squares(model.barred)

    def free(self, level: int) -> Mask:
        """Squares that may be crossed at a level of certainty; Utak's own is always one."""
        view = self.model.view
        mask = view.probability <= LEVELS[min(level, len(LEVELS) - 1)]
        if level == UNSEEN:  # whatever pictures show: what the counts alone leave open
            mask |= ~view.seen if view.by_counts is None else ~view.seen | (view.by_counts <= LEVELS[-1])
        else:
            mask &= view.seen
        mask &= ~self._barred
        if self._carried is not None:
            mask |= self._carried
        mask[self.here[1], self.here[0]] = True
        return mask

    @cached_property
    def distances(self) -> "Distances":
        """For each level, UNSEEN included, the way to every square, in fifths of squares; -1 where none leads."""
        return Distances(self)

    def nearest(self, squares: Squares) -> Reached | None:
        """How the nearest of some squares (flat indices) can be reached: at the most certain level at which any can."""
        for level in range(UNSEEN + 1):
            far = self.distances[level].ravel()[squares]
            if (far != UNREACHED).any():
                return Reached(level, float(far[far != UNREACHED].min()) / 5 + PRICE * level)
        return None

    @cached_property
    def floor(self) -> Mask:
        """The squares that can surely be reached."""
        mask: Mask = self.distances[0] != UNREACHED
        return mask

    @cached_property
    def looked_from(self) -> Mask:
        """The squares from which he looked."""
        return self.model.squares(self.model.looked_from)

    @cached_property
    def safe(self) -> Mask:
        """Squares over which a move is made without looking first."""
        view = self.model.view
        doubtful = grown(view.seen & (view.state == OPEN) & (view.probability >= WARY), 1) | grown(~view.seen, 1)
        mask: Mask = (view.state == FREE) | (view.seen & (view.probability <= SPACE) & ~doubtful)
        mask &= ~self._barred
        mask[self.here[1], self.here[0]] = True
        return mask

    @cached_property
    def believed(self) -> Mask:
        """Squares over which a move is made by who had rather be stopped than look first: all that are hardly occupied,
        right up to what is not settled, but for those beside what was never seen.
        """
        view = self.model.view
        return self.safe | (self.free(0) & (view.probability <= TRUSTED) & ~grown(~view.seen, 1))

    @cached_property
    def approached(self) -> Mask:
        """The same for who goes up to a thing: also what may well be floor right beside things, for who is stopped
        there stands where he wants to be.
        """
        view = self.model.view
        things = view.seen & (view.probability >= WALL_LIKE) & ~self.model.verge
        return self.believed | (self.free(APPROACHED) & edged(things))

    @cached_property
    def gain(self) -> NDArray[np.float64]:
        """(rows, columns): how many squares never seen come into sight there, each by what it promises."""
        return gain(self.model.view)

    def far(self, squares: Squares) -> NDArray[np.float64]:
        """(squares,): the way to each of some squares; as far as they lie where none surely leads."""
        ways = self.distances[0].ravel()[squares] / 5
        rows, columns = np.divmod(squares, self.floor.shape[1])
        return np.where(ways < 0, np.hypot(columns - self.here[0], rows - self.here[1]), ways)


class Distances:
    """The ways to every square of a screen, by level; each is measured when it is first asked for."""

    def __init__(self, cost_maps: CostMaps) -> None:
        self._cost_maps = cost_maps
        self._known: dict[int, NDArray[np.int32]] = {}

    def __getitem__(self, level: int) -> NDArray[np.int32]:
        if level not in self._known:
            self._known[level] = reach(self._cost_maps.free(level), *self._cost_maps.here)
        return self._known[level]


def ways_to_objects(cost_maps: CostMaps) -> dict[str, float]:
    """How far it is to beside each object, in squares, by name; of those alone to which a way is known."""
    found = {}
    for node in cost_maps.model.objects:
        reached = cost_maps.nearest(_vicinity(cost_maps.model, node.patch))
        if reached is not None:
            found[node.name] = reached.cost
    return found


def _vicinity(model: WorldModel, patch: Patch) -> Squares:
    """The squares of the view (flat indices) of a patch, and those beside it."""
    rows, columns = np.nonzero(grown(np.pad(patch.mask, 1), 1))
    rows, columns = rows + patch.south - 1 - model.view.south, columns + patch.west - 1 - model.view.west
    high, wide = model.labels.shape
    inside = (rows >= 0) & (rows < high) & (columns >= 0) & (columns < wide)
    flat: Squares = rows[inside] * wide + columns[inside]
    return flat


def marked(squares: Squares, shape: tuple[int, ...]) -> Mask:
    """(rows, columns): squares given as flat indices."""
    mask: Mask = np.zeros(shape, np.bool_)
    mask.flat[squares] = True
    return mask


def shifted(mask: Mask, columns: int, rows: int) -> Mask:
    """A mask further on by a column, a row, or one of each, or back by them: each 1, 0 or -1."""
    high, wide = mask.shape
    framed = np.pad(mask, 1)
    return framed[1 - rows : 1 - rows + high, 1 - columns : 1 - columns + wide]


def grown(mask: Mask, squares: int) -> Mask:
    """A mask, and all squares within so many rows and columns of it."""
    for axis in (0, 1):
        done = 0
        while done < squares:
            step = min(squares - done, 2 * done + 1)
            further = mask.copy()
            near, far = mask.swapaxes(0, axis), further.swapaxes(0, axis)
            far[step:] |= near[:-step]
            far[:-step] |= near[step:]
            mask, done = further, done + step
    return mask
