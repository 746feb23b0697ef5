"""Where a thing lies, and where it shall: what planning on a screen says of that.

Shapes and goals of geometry.manipulation.plan_carrying are in the frame of the view's arrays.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from itertools import product
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from geometry.manipulation.goals import At, End, met
from geometry.motion.se2 import Pose, Translate
from geometry.raster.rasterize import squares
from kb.localisation.propose.larger_object import DEEPEST, SIDES
from kb.world.model import Node, WorldModel
from planner.screen.projection import grown, shifted
from planner.sights.frontiers import Viewpoint
from planner.situation import Situation

Mask = NDArray[np.bool_]
Ends = Callable[[], Mapping[str, End]]  # by their names, worked out when asked
Looks = Callable[[], tuple[Viewpoint, ...]]  # worked out when asked
HAIR = 0.01  # squares that do not matter
SURELY = 95  # percent: what is a thing with less may be a piece of wall, and is felt before it is taken
LIKELY = 20  # percent: with less it is hardly one
NOOK = 2  # squares about a thing that are no room to go
TURNED = 2.0  # degrees within which a thing lies as it was meant to


@dataclass(frozen=True)
class Placement:
    """Where a goal holds for an object.

    Attributes
    ----------
    ends : target's name -> where the object must lie; empty while that is not known.
    missing, lookouts : what must be known first, in words, and where just that may be seen (as of a Destination).
    approach : places near to where it must end, from which it can be told better where that is; the best first.
    holds : the goal holds as the object lies now. there : it does, but for what must be known first.
    shut_in : likewise, and he cannot leave the object where it is, for it shuts him in.
    loose : where it may lie if it cannot be brought to any of the ends.
    must_reach : what it must come to lie on wherever it must end, while that is not known: squares that were not seen,
    and those of the one end that may be it. Worked out when asked.
    presses : pushes, by their names, by which it comes to touch walls that may lie further away than is believed; after
    them a goal that holds by what is believed holds surely.
    some : it may end elsewhere, too: that it can be brought to none of the ends proves nothing.
    hoped : the ends, if the floor goes on as it is hoped to (planner.goals.optimistic); worked out when asked.
    by_the_way : what must be seen before it holds, where it does not yet: to come back for that takes longer. Likewise.
    """

    ends: Mapping[str, End]
    missing: str = ""
    viewpoints: tuple[Viewpoint, ...] = ()
    approach: Mapping[str, End] = field(default_factory=dict)
    holds: bool = False
    there: bool = False
    shut_in: bool = False
    loose: Mapping[str, End] = field(default_factory=dict)
    must_reach: Ends = dict
    hoped: Ends = dict
    by_the_way: Looks = tuple
    presses: Mapping[str, Translate] = field(default_factory=dict)
    some: bool = False


def lands(end: End, shape: Any) -> bool:
    """Does a shape, in the frame of the view's arrays, lie where a goal holds?"""
    return met(end, shape, shape)


def lands_in_one(ends: Mapping[str, End], shape: Any) -> bool:
    """Does a shape, in the frame of the view's arrays, lie where one of some goals holds?"""
    return any(lands(end, shape) for end in ends.values())


def lies_askew(node: Node) -> bool:
    """Was it turned otherwise than by quarter turns?"""
    over = node.turned % 90.0
    return min(over, 90.0 - over) > TURNED


def in_view(shape: Any, situation: Situation) -> Any:
    """A shape of the lattice in the frame of the view's arrays."""
    west, south = situation.model.view.west, situation.model.view.south
    return shapely.transform(shape, lambda points: points - np.array([west, south]))


def region_of(mask: Mask) -> Any:
    """The True squares of a (rows, columns) mask as one geometry."""
    runs = np.diff(np.pad(mask, ((0, 0), (1, 1))).astype(np.int8), axis=1)
    rows, starts = np.nonzero(runs == 1)
    stops = np.nonzero(runs == -1)[1]
    return shapely.union_all(shapely.box(starts, rows, stops, rows + 1))


def barred(node: Node, situation: Situation) -> Mask:
    """(rows, columns): the necks of doors that a thing, or he with it, may not go through; none where it lies on them.

    He holds it wherever it goes through, so a door that is forbidden to either is to both.
    """
    columns, rows = situation.model.labels.shape[::-1]
    doors = (*situation.forbidden("utak"), *situation.forbidden(node.name))
    necks = (shapely.LineString([door.a, door.b]).buffer(HAIR) for door in doors)
    mask: Mask = np.any([squares(neck, columns, rows) for neck in necks] or [np.zeros((rows, columns), bool)], axis=0)
    return mask & ~situation.model.mask(node.patch)


def hidden_behind(node: Node, side: tuple[int, int], depth: int, model: WorldModel) -> Mask:
    """(rows, columns): what seems to be wall straight behind a thing, of so many squares, and may be more of it.

    What was moved was seen to end.
    """
    mask = model.mask(node.patch)
    found, last = np.zeros_like(mask), mask
    for _ in range(depth if not node.moved else 0):
        last = shifted(last, *side) & model.verge & ~mask
        found |= last
    return found


def out_of_wall(node: Node, side: tuple[int, int], depth: int, situation: Situation) -> Pose | None:
    """Straight away from what it may go on in, by so many squares and one more or as far as that is free, so that it is
    seen whole; None where it cannot be moved so.
    """
    mask, (dx, dy) = situation.model.mask(node.patch), side
    room = np.pad(situation.cost_maps.free(0) | mask, depth + 1)
    rows, columns = np.nonzero(np.pad(mask, depth + 1))
    out = (step for step in range(1, depth + 2) if not room[rows - step * dy, columns - step * dx].all())
    far = next(out, depth + 2) - 1
    return Pose(-float(far * dx), -float(far * dy), 0.0) if far else None


def drawn_out(node: Node, needed: Mask, situation: Situation) -> At | None:
    """Where a thing shall lie first whose squares in what seems to be wall are needed; None for none such."""
    for depth, side in product(range(DEEPEST, 0, -1), SIDES):
        if (hidden_behind(node, side, depth, situation.model) & needed).any():
            pose = out_of_wall(node, side, depth, situation)
            if pose is not None:
                return At(pose)
    return None


def can_leave(node: Node, situation: Situation) -> bool:
    """Does Utak, if he has an object in hand, not stand in a nook between that and the walls?"""
    held = situation.model.held == node.name
    return not held or leads_away(situation.cost_maps.floor, situation.model.mask(node.patch))


def leads_away(floor: Mask, thing: Mask) -> bool:
    """Does floor that he reaches lead further from a thing than a nook beside it? Both (rows, columns)."""
    return bool((floor & ~grown(thing, NOOK)).any())
