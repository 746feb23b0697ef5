"""Parts of the floor that no seen floor joins with that of the robot, and the parts that they may be joined with.

All floor of a table is connected, so a part that was seen through a gap is joined with another one by floor that was
not seen, if it is floor at all. Which chance a part has to be the one, kb/asp/chances.lp says by what was counted.
"""

from collections.abc import Iterator, Mapping
from typing import NamedTuple

import numpy as np

from utak.geometry.kernels.arrays import Bools
from utak.geometry.raster.components import with_edge_neighbours
from utak.kb.mapping.occupancy import OCCUPIED
from utak.kb.world.model import WorldModel

MAX_DETOUR = 10  # squares by which a way may be longer than the shortest one, to be followed: bounds the time
NO_PART = "none"  # no other part: what was taken for floor is none, or nothing joins it


class Joint(NamedTuple):
    """A part of the floor with which another one may be joined."""

    apart: str  # the region of the map that no seen floor joins with that of the robot, such as part2
    other: str  # another region; NO_PART for none
    # near (no other one is nearer over squares that may be floor), further, wall (no such squares lead there); for none
    # open (such squares lead to another one), or shut
    case: str
    # Squares on the way between them; those by which it is longer than the shortest one; of the other; of `apart`
    measure: int

    @property
    def fact(self) -> str:
        """The same for kb/asp/chances.lp, without a full stop."""
        return f"between({self.apart},{self.other},{self.case},{self.measure})"


def joints(model: WorldModel) -> Iterator[Joint]:
    """Yield with which parts those parts of the floor may be joined that no seen floor joins with that of the robot."""
    parts = floor_parts(model)
    may_be_floor = model.view.state != OCCUPIED
    for name, mask in parts.items():
        if (mask & model.floor).any():
            continue
        away = _ways(mask, {other: there for other, there in parts.items() if other != name}, may_be_floor)
        least = min(away.values(), default=0)
        for other, there in parts.items():
            if other in away:
                near = away[other] == least
                yield Joint(name, other, "near" if near else "further", away[other] - (0 if near else least))
            elif other != name:
                yield Joint(name, other, "wall", int(there.sum()))
        yield Joint(name, NO_PART, "open" if away else "shut", int(mask.sum()))


def floor_parts(model: WorldModel) -> Mapping[str, Bools]:
    """Return the regions of seen floor that have squares, by name: masks on the view's arrays."""
    free = [region.name for region in model.percept.regions if not region.occupied]
    masks = ((name, (model.labels == int(name.removeprefix("part"))) & model.space) for name in free)
    return {name: mask for name, mask in masks if mask.any()}


def _ways(mask: Bools, others: Mapping[str, Bools], may_be_floor: Bools) -> dict[str, int]:
    """Return how many squares lie between a part of the floor and others, over squares that may be floor."""
    standing = np.logical_or.reduce([*others.values()]) if others else np.zeros_like(mask)
    found: dict[str, int] = {}
    reached, steps = mask, 0
    while not found or steps <= min(found.values()) + MAX_DETOUR:
        grown = with_edge_neighbours(reached & ~standing | mask) & may_be_floor | reached
        if (grown == reached).all():
            break
        reached = grown
        found |= {name: steps for name, there in others.items() if name not in found and (there & reached).any()}
        steps += 1
    return found
