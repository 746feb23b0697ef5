"""Places worth a look: where the floor borders on what was never seen, and where something is seen but not settled.

These are candidates only; planner/asp/aims.lp chooses among them.
"""

import math
from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from geometry.raster.components import components, edged
from geometry.raster.geodesic import UNREACHED
from kb.mapping.occupancy import OPEN
from kb.world.model import SPACE, Node
from kb.world.rooms import Door
from planner.screen.projection import WALL_LIKE, CostMaps, Squares, grown, marked
from planner.screen.unseen_gain import BARREN

FURTHER = 7  # squares from which a thing lies within the middle zone of the eye
JAMB = 8  # squares beside what may be a door within which its walls are looked at
CLOSE = 3  # squares from which a thing lies within the fovea, whichever way it is seen
APART = 2  # squares: a new look is first sought further than this from earlier ones
GAPPING = 2  # level of certainty (planner/screen/projection.py) at which a way leads through a likely gap
SHORT_OF = 5  # squares before a place from which what lies behind it comes into sight
SMALLEST_ROOM = 6  # squares of floor that are worth a passage
ALIKE = 0.9  # places worth as much as this of the best are as good
HOMELY = 800  # squares of floor unseen among which one thing that is looked for is expected
GOES_ON = "the floor goes on unseen"
Mask = NDArray[np.bool_]


class Viewpoint(NamedTuple):
    """Squares (flat indices) from each of which something is seen that is not known yet, and what it is.

    chance : percent of belief that it is what is looked for; 100 when it is not known to be less.
    """

    squares: Squares
    what: str
    chance: int = 100


def frontiers(cost_maps: CostMaps, apart: int) -> list[Viewpoint]:
    """Floor that can be reached and borders on squares never seen, one Viewpoint for each connected stretch."""
    border = unlooked(cost_maps, apart) & grown(~cost_maps.model.view.seen, 1)
    return [Viewpoint(squares, GOES_ON) for squares in groups(_stretches(border))]


def gaps(cost_maps: CostMaps) -> list[Viewpoint]:
    """Likely gaps in what bounds the floor, through which it would go on unseen: the squares where it would.

    No stretch of them borders on floor that surely goes on; that is one of the frontiers.
    """
    view = cost_maps.model.view
    edge = view.seen & grown(~view.seen, 1)
    border = edge & (cost_maps.distances[GAPPING] != UNREACHED)
    surely = grown(edge & cost_maps.floor, 1).ravel()
    stretches = [squares for squares in groups(_stretches(border)) if not surely[squares].any()]
    return [Viewpoint(squares, "there may be a gap") for squares in stretches]


def vague_places(cost_maps: CostMaps, apart: int, odd: bool) -> list[Viewpoint]:
    """Floor close to things beside it that were seen only coarsely, one Viewpoint for each connected stretch of them.

    odd : only those that may well be floor, and so part of a door or of the floor behind an object; else all of them.
    """
    view = cost_maps.model.view
    open_ = view.seen & (view.state == OPEN) & (view.probability > SPACE) & grown(cost_maps.floor, 1)
    if odd:
        open_ &= view.probability < WALL_LIKE
    near = np.where(unlooked(cost_maps, apart), _spread(_stretches(open_), CLOSE), 0)
    return [Viewpoint(squares, "what bounds the floor is not clear") for squares in groups(near)]


def by_touch(cost_maps: CostMaps, node: Node) -> Viewpoint:
    """Floor from which an object is felt."""
    beside = grown(cost_maps.model.mask(node.patch), 1)
    return Viewpoint(np.flatnonzero(unlooked(cost_maps, 0) & beside), f"the colour of {node.name} is not known")


def against_the_wall(cost_maps: CostMaps, mask: Mask) -> Viewpoint:
    """Floor from which it is felt whether something is part of a wall."""
    beside = np.flatnonzero(unlooked(cost_maps, 0) & edged(mask))
    return Viewpoint(beside, "what may stand against the wall was not felt")


def sight_of(cost_maps: CostMaps, mask: NDArray[np.bool_], what: str) -> Viewpoint:
    """Floor close to some squares, from which they are seen as well as can be; none when all of it was looked from."""
    for reach, apart in ((CLOSE, APART), (CLOSE, 0), (FURTHER, APART)):
        near = np.flatnonzero(unlooked(cost_maps, apart) & grown(mask, reach))
        if len(near):
            return Viewpoint(near, what)
    return Viewpoint(np.zeros(0, np.int64), what)


def close_to(cost_maps: CostMaps, x: float, y: float) -> Squares:
    """Floor from which all about a point of the lattice lies within the fovea, looked from or not."""
    mask = cost_maps.model.squares([(math.floor(x), math.floor(y))])
    return np.flatnonzero(cost_maps.floor & grown(mask, CLOSE - 1))


def short_of(cost_maps: CostMaps, squares: Squares) -> Squares:
    """Floor from which it is seen what lies behind some squares: those that can be reached, or short of them."""
    mask = marked(squares, cost_maps.floor.shape)
    near = unlooked(cost_maps, APART) & grown(mask, SHORT_OF)
    return np.flatnonzero(near | (mask & cost_maps.floor))


def jambs(cost_maps: CostMaps, doors: Iterable[Door]) -> list[Viewpoint]:
    """Floor from which the walls beside what may be a door are seen closely, one Viewpoint for each that is not
    sure.
    """
    view = cost_maps.model.view
    vague = view.seen & (view.state == OPEN) & (view.probability > SPACE)
    found = []
    for door in doors:
        ends = np.zeros(vague.shape, np.bool_)
        for x, y in (door.a, door.b):
            row, column = round(y), round(x)
            reach = slice(max(row - JAMB, 0), row + JAMB), slice(max(column - JAMB, 0), column + JAMB)
            ends[reach] = True
        look = sight_of(cost_maps, vague & ends, "what may be a door is not clear")
        found += [look] * bool(not door.sure and len(look.squares))
    return found


def rooms_beyond(cost_maps: CostMaps) -> list[Viewpoint]:
    """Floor that is seen and cannot be reached yet: all floor is connected, so some passage must lead there."""
    apart = components(cost_maps.model.space & ~cost_maps.floor).labels
    what = "floor is seen beyond, so a passage must lead there"
    return [Viewpoint(squares, what) for squares in groups(apart) if len(squares) >= SMALLEST_ROOM]


def promised(cost_maps: CostMaps, viewpoints: list[Viewpoint]) -> list[Viewpoint]:
    """Frontiers, each with how likely it is that what is looked for comes into sight at its nearest square."""
    if not viewpoints:
        return []
    new = cost_maps.gain.ravel()
    return [look._replace(chance=_chance(float(new[_nearest(cost_maps, look.squares)]))) for look in viewpoints]


def best_views(cost_maps: CostMaps, met: Mask, move: float, way: float) -> list[Viewpoint]:
    """Of squares that one straight move leads to those from which most comes into sight for what it costs.

    They need not border on what was never seen: a long move along it often shows more than a short one up to it.
    met : (rows, columns), the squares that one move leads to. move, way : what a move, and a square of way, cost.
    """
    some = np.flatnonzero(met & unlooked(cost_maps, APART))
    new = cost_maps.gain.ravel()[some]
    if new.max(initial=0.0) < BARREN:
        return []
    far = cost_maps.distances[0].ravel()[some] / 5
    worth = new / (move + way * far)
    best = worth >= ALIKE * worth.max()
    chance = _chance(float(new[best][far[best].argmin()]))
    return [Viewpoint(some[best], GOES_ON, chance)]


def _chance(squares: float) -> int:
    return max(1, min(90, round(100 * squares / HOMELY)))


def _nearest(cost_maps: CostMaps, squares: Squares) -> int:
    """Of some squares the one that is reached first, at the most certain level at which any is."""
    reached = cost_maps.nearest(squares)
    if reached is None:
        return int(squares[0])
    far = cost_maps.distances[reached.level].ravel()[squares]
    return int(squares[np.where(far < 0, far.max() + 1, far).argmin()])


def unlooked(cost_maps: CostMaps, apart: int) -> NDArray[np.bool_]:
    """Floor that can be reached and from which nothing was looked at yet.

    A second look from the same square tells nothing new.
    """
    mask: NDArray[np.bool_] = cost_maps.floor & ~grown(cost_maps.looked_from, apart)
    return mask


def _stretches(mask: Mask) -> NDArray[np.int32]:
    """(rows, columns): the stretches of a mask by number, 0 outside it; squares that meet at a corner are of one."""
    labels: NDArray[np.int32] = np.where(mask, components(grown(mask, 1)).labels, 0)
    return labels


def groups(labels: NDArray[np.int32]) -> list[Squares]:
    """The flat indices of each label but 0, by label."""
    flat = labels.ravel()
    squares = np.flatnonzero(flat)
    ordered = squares[np.argsort(flat[squares], kind="stable")]
    cuts = np.flatnonzero(np.diff(flat[ordered])) + 1
    return [group for group in np.split(ordered, cuts) if len(group)]


def _spread(labels: NDArray[np.int32], squares: int) -> NDArray[np.int32]:
    """Labels grown by so many rows and columns; where two meet the greater number counts."""
    for _ in range(squares):
        for axis in (0, 1):
            padded = np.pad(labels, [(1, 1) if a == axis else (0, 0) for a in (0, 1)])
            lower, upper = (padded[:-2], padded[2:]) if axis == 0 else (padded[:, :-2], padded[:, 2:])
            labels = np.maximum(labels, np.maximum(lower, upper))
    return labels
