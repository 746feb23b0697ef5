"""Proposals that a held object is only a part of what seemed one thing: it moved, and the rest stayed where it was.

Things that touch look one. Which of them is in hand shows when the robot moves: the one moves with it, the other does
not.
"""

from collections.abc import Iterator
from dataclasses import replace

import shapely

from utak.geometry.kernels.arrays import Bools
from utak.geometry.motion.se2 import Translate
from utak.kb.localisation.hypotheses.carry_outcomes import predicted_outcome
from utak.kb.localisation.hypotheses.contacts import square_polygon
from utak.kb.localisation.hypotheses.explanation import Explanation
from utak.kb.localisation.hypotheses.frames import Position
from utak.kb.localisation.known.situation import ObservedSituation, count_clashes
from utak.kb.mapping.occupancy import OCCUPIED
from utak.kb.mapping.patch import Patch, patch_of_polygon
from utak.kb.objects.held_object import HeldObject, is_grid_aligned
from utak.kb.perception.seams import halves


def propose(situation: ObservedSituation) -> Iterator[Explanation]:
    """Yield the explanation that a push went as commanded and the object is only a part of what seemed one thing."""
    held, motion, state = situation.held, situation.motion, situation.state
    if held.proven or not isinstance(motion, Translate):
        return
    patch = held.seen_on or patch_of_polygon(held.polygon)
    others = state.others(held)
    for mask in halves(patch.mask):
        part, rest = _parted(held, patch, mask), Patch(patch.west, patch.south, patch.mask & ~mask)
        if part is None or not _is_beside(part, state.place):
            continue
        outcome = predicted_outcome(state.place, part.polygon, motion)._replace(how="parted")
        if patch_of_polygon(outcome.polygon).squares() & rest.squares():
            continue
        occupancy = state.occupancy.copy()
        occupancy.declare_patch(rest, OCCUPIED, len(state.observations) - 1)
        held_objects = [*others, part.moved(outcome.polygon, part.slack, commanded=True)]
        if not count_clashes(state.frame, occupancy, held_objects, outcome.place, situation.ranges):
            left = frozenset(rest.squares())
            yield Explanation("parted", outcome.place, state.frame, 0, 0.0, outcome, instead=part, left=left)
            return


def _parted(held: HeldObject, patch: Patch, mask: Bools) -> HeldObject | None:
    """Return the part of an object that lies on some of its squares; None where that is no single outline."""
    # An outline askew was fitted to what is no one thing, so the part fills its squares then.
    squares = Patch(patch.west, patch.south, mask).squares()
    cells = shapely.union_all(list(map(square_polygon, squares)))
    polygon = held.polygon.intersection(cells) if is_grid_aligned(held.polygon) else cells
    if polygon.geom_type != "Polygon" or polygon.is_empty:
        return None
    return replace(held.lying(polygon), first=polygon, shape={}, insets=None, seen_on=None)


def _is_beside(part: HeldObject, place: Position) -> bool:
    """Return whether a part covers one of the eight squares about that of the robot, before the motion."""
    x, y = (int(v // 1) for v in place)
    about = {(x + i, y + j) for i in (-1, 0, 1) for j in (-1, 0, 1)}
    return bool(about & patch_of_polygon(part.polygon).squares())
