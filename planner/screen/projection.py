"""Cost maps: the world model projected on the screen, at several certainty levels.

The screen is the paper's map in the head: an array of squares, [row, column], cut to the window that was seen.
Certainty level 0 holds the squares that are surely floor. Each further level holds more, up to UNSEEN_LEVEL, which
holds all that is not excluded. A way over a less certain level leads to its goal only if what is assumed proves true.

Two frames are used throughout the planner. The map frame has whole squares at whole coordinates, and does not change
when the map grows. The view frame is the frame of the arrays: the map frame moved by (-view.west, -view.south).
"""

from functools import cached_property
from typing import NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from utak.geometry.kernels.arrays import XY, Bools, Floats, Square
from utak.geometry.raster.components import with_edge_neighbours
from utak.geometry.raster.geodesic import FIFTHS_PER_SQUARE, GEODESIC_UNREACHED, reach
from utak.kb.mapping.occupancy import FREE, OPEN
from utak.kb.world.model import MAX_FREE_PROBABILITY, WorldModel
from utak.planner.screen.unseen_gain import expected_gain

T = TypeVar("T", bound=np.generic)
SquareIndices = NDArray[np.int64]  # flat indices on a screen: row * columns + column
# By level: a square occupied with at most this probability may be crossed (tuned).
LEVEL_MAX_PROBABILITY = (MAX_FREE_PROBABILITY, 0.15, 0.3, 0.45)
UNSEEN_LEVEL = len(LEVEL_MAX_PROBABILITY)  # the certainty level at which unseen squares may be crossed, too
LEVEL_COST = 6.0  # squares of way that each certainty level costs (tuned on random worlds)
PART_COVERED = 1  # squares: so deep the robot stands in those that a wall covers in part, at most (derived)
APPROACH_LEVEL = 1  # certainty level of the squares beside an object over which the robot goes up to it
MAX_TRUSTED_PROBABILITY = 0.04  # a square occupied with at most this probability may be crossed without a look (tuned)
SURELY_OCCUPIED = 0.85  # a square occupied with at least this probability surely belongs to what stands there (tuned)
MIN_DOUBTFUL_PROBABILITY = 0.3  # beside squares occupied with at least this, moves need settled squares (tuned)


class Reached(NamedTuple):
    """The cheapest way to some squares."""

    level: int  # the certainty level of the way: 0 the surest, UNSEEN_LEVEL the least sure
    cost: float  # its length in squares, plus LEVEL_COST squares for each level


class CostMaps:
    """One world model, projected on the screen at every certainty level."""

    def __init__(self, model: WorldModel, carried: Bools | None = None, kept_off: Bools | None = None) -> None:
        """Make the cost maps of a world model; each map is computed when it is first asked for."""
        self.model = model
        nothing: Bools = np.zeros(model.labels.shape, np.bool_)
        self.kept_off = nothing if kept_off is None else kept_off
        self._carried = nothing if carried is None else carried
        row, column = model.view.locate(*model.place)
        self.here = (column, row)
        self._barred = model.squares(model.barred)

    def free(self, level: int) -> Bools:
        """Compute the squares that may be crossed at a certainty level, (rows, columns) bool."""
        view = self.model.view
        mask = view.probability <= LEVEL_MAX_PROBABILITY[min(level, len(LEVEL_MAX_PROBABILITY) - 1)]
        if level == UNSEEN_LEVEL:  # the counts alone decide, whatever the sampled completions show
            mask |= ~view.seen if view.by_counts is None else ~view.seen | (view.by_counts <= LEVEL_MAX_PROBABILITY[-1])
        else:
            mask &= view.seen
        return (mask & ~self._barred | self._carried) & ~self.kept_off | self._stand

    @cached_property
    def _stand(self) -> Bools:
        """The robot's own square, (rows, columns) bool; with those to the floor where that square is in part wall."""
        # A wall covers some squares in part, so the robot may stand in one that meets floor at a corner alone.
        (column, row), space = self.here, self.model.space
        mask: Bools = np.zeros(space.shape, np.bool_)
        south, west = max(row - PART_COVERED, 0), max(column - PART_COVERED, 0)
        near = np.argwhere(space[south : row + PART_COVERED + 1, west : column + PART_COVERED + 1])
        if len(near) and not space[row, column]:
            near += np.array((south, west))
            other = near[np.hypot(*(near - (row, column)).T).argmin()]
            (south, west), (north, east) = np.minimum(other, (row, column)), np.maximum(other, (row, column))
            mask[south : north + 1, west : east + 1] = True
        mask[row, column] = True
        return mask

    @cached_property
    def distances(self) -> "DistanceMaps":
        """The length of the shortest way from the robot to every square, by certainty level."""
        return DistanceMaps(self)

    def nearest_at(self, level: int, squares: SquareIndices) -> Square:
        """Return the one of some squares, (column, row), to which the shortest way leads at a certainty level."""
        distances = self.distances[level].ravel()
        reached = squares[distances[squares] >= 0]
        row, column = divmod(int(reached[np.argmin(distances[reached])]), self.floor.shape[1])
        return column, row

    def nearest(self, squares: SquareIndices) -> Reached | None:
        """Find the cheapest way to any of `squares`, at the surest level at which one of them can be reached."""
        for level in range(UNSEEN_LEVEL + 1):
            far = self.distances[level].ravel()[squares]
            if (far != GEODESIC_UNREACHED).any():
                return Reached(
                    level, float(far[far != GEODESIC_UNREACHED].min()) / FIFTHS_PER_SQUARE + LEVEL_COST * level
                )
        return None

    @cached_property
    def floor(self) -> Bools:
        """The squares that can surely be reached: those with a way at certainty level 0, (rows, columns) bool."""
        mask: Bools = self.distances[0] != GEODESIC_UNREACHED
        return mask

    @cached_property
    def looked_from(self) -> Bools:
        """The squares on which an impression was received, (rows, columns) bool."""
        return self.model.squares(self.model.looked_from)

    @cached_property
    def unsettled(self) -> Bools:
        """The squares that were seen, but neither settled nor taken for floor, (rows, columns) bool."""
        mask: Bools = self.model.view.seen & (self.model.view.state == OPEN) & ~self.model.space
        return mask

    @cached_property
    def safe(self) -> Bools:
        """The squares over which a move is made without looking first, (rows, columns) bool."""
        view = self.model.view
        doubtful = self.unsettled & (view.probability >= MIN_DOUBTFUL_PROBABILITY) | ~view.seen
        mask: Bools = (view.state == FREE) | (self.model.space & ~dilate(doubtful, 1))
        return mask & ~(self._barred | self.kept_off) | self._stand

    @cached_property
    def believed(self) -> Bools:
        """The squares of bold moves, (rows, columns) bool: the safe ones, and all that are hardly occupied."""
        view = self.model.view
        return self.safe | (self.free(0) & (view.probability <= MAX_TRUSTED_PROBABILITY) & ~dilate(~view.seen, 1))

    @cached_property
    def approachable(self) -> Bools:
        """The squares of bold moves up to an object, (rows, columns) bool."""
        view = self.model.view
        things = view.seen & (view.probability >= SURELY_OCCUPIED) & ~self.model.verge
        return self.believed | (self.free(APPROACH_LEVEL) & with_edge_neighbours(things))

    @cached_property
    def information_gain(self) -> Floats:
        """The weighted number of unseen squares that come into sight from each square, (rows, columns) float64."""
        return expected_gain(self.model.view)

    def far(self, squares: SquareIndices) -> Floats:
        """Compute the length of the sure way from the robot to each of `squares`, in squares, (n,) float64."""
        lengths = self.distances[0].ravel()[squares] / FIFTHS_PER_SQUARE
        rows, columns = np.divmod(squares, self.floor.shape[1])
        return np.where(lengths < 0, np.hypot(columns - self.here[0], rows - self.here[1]), lengths)


class DistanceMaps:
    """The distances of all squares from the robot, by certainty level; each map is computed at its first use."""

    def __init__(self, cost_maps: CostMaps) -> None:
        """Make the distance maps of some cost maps; nothing is computed yet."""
        self._cost_maps = cost_maps
        self._known: dict[int, NDArray[np.int32]] = {}

    def __getitem__(self, level: int) -> NDArray[np.int32]:
        """Return the distances of all squares from the robot at a certainty level, 0 to UNSEEN_LEVEL."""
        if level not in self._known:
            self._known[level] = reach(self._cost_maps.free(level), *self._cost_maps.here)
        return self._known[level]


def costs_to_objects(cost_maps: CostMaps) -> dict[str, float]:
    """Compute the cost of the way to each object's vicinity, by the object's name, in model order."""
    found = {}
    for node in cost_maps.model.objects:
        reached = cost_maps.nearest(np.flatnonzero(dilate(cost_maps.model.mask(node.patch), 1)))
        if reached is not None:
            found[node.name] = reached.cost
    return found


def square_index(place: XY, model: WorldModel) -> SquareIndices:
    """Return the flat index, an array (1,), of the view's square in which a point (x, y) of the map frame lies."""
    row, column = model.view.locate(*place)
    return np.array([row * model.labels.shape[1] + column])


def indices_to_mask(squares: SquareIndices, shape: tuple[int, ...]) -> Bools:
    """Return the (rows, columns) bool mask of `shape` that is True on the given flat indices only."""
    mask: Bools = np.zeros(shape, np.bool_)
    mask.flat[squares] = True
    return mask


def shift_mask(mask: NDArray[T], columns: int, rows: int) -> NDArray[T]:
    """Return `mask` moved by (`columns`, `rows`), each 1, 0 or -1; what comes in from outside is False or 0."""
    high, wide = mask.shape
    moved = np.zeros_like(mask)
    to, of = ((slice(max(0, s), n + min(0, s)) for n, s in ((high, k * rows), (wide, k * columns))) for k in (1, -1))
    moved[*to] = mask[*of]
    return moved


def dilate(mask: Bools, squares: int) -> Bools:
    """Dilate `mask` with a square: return all squares within `squares` rows and columns of a True one."""
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
