"""Going up to what may be a thing: floor from which it is told what it is, or where it can be taken.

Who is to take it counts commands. He goes by one straight move where that will do, right up to it, over what may well
be floor: where that is none he is stopped by the thing itself.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from geometry.raster.components import components, edged
from kb.mapping.occupancy import OPEN
from kb.world.model import Node
from planner.screen.moves import one_move
from planner.screen.projection import WALL_LIKE, CostMaps, Squares, grown, marked, shifted
from planner.screen.unseen_gain import sums
from planner.sights.frontiers import ALIKE, APART, CLOSE, FURTHER, Viewpoint, groups, unlooked

PROMISING = 0.1  # a place at which a thing is this likely is worth a look
LIKELY = 0.5  # what is looked for as likely as this is gone up to
SETTING_OUT = 4.0  # squares of way that a look costs besides the way there
DEAR_LOOK = 12.0  # the same for who does not want to stay, and counts commands rather than squares
ANEW = 0.03  # what it is worth that a square never seen comes into sight, beside one of the thing that is told
Mask = NDArray[np.bool_]


class Approach(NamedTuple):
    """What he goes up to a thing for.

    take : to take it; else to be beside it is all that is wanted. corner : east and north, each 1 or -1, where the
    walls are of the corner that he shall bring it to, if that is what for: between it and them he is in its way.
    """

    take: bool
    corner: tuple[int, int] | None = None


ARRIVE, TAKE = Approach(take=False), Approach(take=True)


def sightings(
    cost_maps: CostMaps, likely: NDArray[np.float64], what: str, to: Approach
) -> list[tuple[Squares, Viewpoint]]:
    """Floor close to where something is likely that is looked for: the squares of each such place, and its Viewpoint.

    likely : (rows, columns), how likely each square belongs to such a thing.
    """
    view = cost_maps.model.view
    spots = groups(components(likely >= PROMISING).labels)
    found = []
    for spot in spots:
        mask = marked(spot, likely.shape)
        if not (view.state.ravel()[spot] == OPEN).any():
            continue
        chance = float(likely.ravel()[spot].max())
        near = close(cost_maps, mask, chance, to)
        if len(near):
            found.append((spot, Viewpoint(near, what, round(100 * chance))))
    return found


def inspection(cost_maps: CostMaps, node: Node, chance: float, to: Approach) -> Viewpoint:
    """Floor from which an object is seen as well as can be. chance : that it is what is looked for."""
    squares = close(cost_maps, cost_maps.model.mask(node.patch), chance, to)
    return Viewpoint(squares, f"what {node.name} is is not clear")


def close(cost_maps: CostMaps, mask: Mask, chance: float, to: Approach) -> Squares:
    """Floor from which something is seen better than it was.

    At first the floor at its sides. What is not to be taken and hardly is what is looked for is looked at from further
    away first, where most of it is told already. Else he goes where most of it can be told.
    """
    beside = grown(mask, 1)
    near = _to_take(cost_maps, mask, to) if to.take else np.flatnonzero(cost_maps.floor & edged(mask))
    if (chance >= LIKELY or to.take) and len(near) and not (beside & cost_maps.looked_from).any():
        return _telling(cost_maps, near, mask, chance, to) if to.take else near
    if not to.take:
        far = grown(mask, FURTHER)
        near = np.flatnonzero(cost_maps.floor & far)
        if len(near) and not (far & cost_maps.looked_from).any():
            return near
    about = grown(mask, CLOSE)
    for apart in (APART, 0):
        near = np.flatnonzero(unlooked(cost_maps, apart) & about)
        if len(near):
            break
    return _telling(cost_maps, near, mask, chance, to)


def _to_take(cost_maps: CostMaps, mask: Mask, to: Approach) -> Squares:
    """Where a thing may be taken: squares at the sides of what surely belongs to it, for it may well be there that he
    is wanted, or else of all that may; of these those that one move leads to, if there are any.
    """
    surely = mask & (cost_maps.model.view.probability >= WALL_LIKE)
    sides = _out_of_its_way(cost_maps, surely, to)
    for some in (sides, edged(mask)):
        met = np.flatnonzero(one_move(cost_maps, "inspect", some))
        near = met if len(met) else np.flatnonzero(cost_maps.floor & some)
        if len(near):
            break
    return near


def _out_of_its_way(cost_maps: CostMaps, surely: Mask, to: Approach) -> Mask:
    """The sides of a thing; not those where he would be in its way, if there is floor at others."""
    sides = edged(surely)
    if to.corner is None:
        return sides
    east, north = to.corner
    free = sides & ~(shifted(surely, east, 0) | shifted(surely, 0, north))
    return free if (cost_maps.floor & free).any() else sides


def _telling(cost_maps: CostMaps, near: Squares, mask: Mask, chance: float, to: Approach) -> Squares:
    """Of some floor the squares from which most of what is open of a thing is seen exactly, for the way there.

    chance : that it is what is looked for, and that who is not beside it must set out once more to be.
    """
    beside = grown(mask, 1)
    open_ = beside & ~cost_maps.model.told
    if len(near) < 2 or not open_.any():
        return near
    seen = sums(np.pad(open_, CLOSE).astype(np.float64), CLOSE).ravel()[near]
    if to.take:
        seen = seen + ANEW * cost_maps.gain.ravel()[near]
    apart = ~beside.ravel()[near]
    setting_out = DEAR_LOOK if to.take else SETTING_OUT
    value = (seen + 1) / (cost_maps.far(near) + setting_out * (1 + chance * apart))
    best: Squares = near[value >= ALIKE * value.max()]
    return best
