"""Things that are larger than they seemed: what stood in a door, or in a niche, goes on in what was taken for wall.

What touches a wall is one with it to the eye, and is told from it where it sticks out. Only when it is drawn out it
shows how far it went on: floor is seen where wall seemed to be.
"""

from collections.abc import Iterator
from dataclasses import replace

import shapely

from geometry.motion.se2 import Motion, Translate
from kb.localisation.hypotheses.carry_outcomes import predicted
from kb.localisation.hypotheses.explanation import Explanation
from kb.localisation.hypotheses.what_if import Surprise, clashes
from kb.mapping.occupancy import FREE
from kb.mapping.patch import covered, patch_of_squares
from kb.objects.held_object import HeldObject, is_whole

DEEPEST = 3  # squares by which a thing goes on in what seems to be wall, at most
SIDES = ((1, 0), (0, 1), (-1, 0), (0, -1))


def larger(surprise: Surprise, load: HeldObject, motion: Motion) -> Iterator[Explanation]:
    """That a thing in hand that never moved before went as commanded, and more of it than was seen: the least first."""
    if load.proven or not isinstance(motion, Translate) or not is_whole(load.polygon):
        return
    occupancy, seen = surprise.occupancy, covered(load.polygon).squares()
    others = [other for other in surprise.loads.values() if other.name != load.name]
    for depth in range(1, DEEPEST + 1):
        for side in SIDES:
            whole = _going_on(load, side, depth)
            hidden = covered(whole.polygon).squares() - seen
            if any(occupancy.state[occupancy.index(*square)] == FREE for square in hidden):
                continue
            outcome = predicted(surprise.place, whole.polygon, motion)._replace(how="larger")
            patch, floor = patch_of_squares(hidden), occupancy.copy()
            floor.declare(floor.squares(patch.west, patch.south, patch.mask), FREE, len(surprise.observations) - 1)
            loads = [*others, whole.moved(outcome.polygon, whole.slack, commanded=True)]
            if not clashes(surprise.frame, floor, loads, outcome.place, surprise.ranges):
                yield Explanation("larger", outcome.place, surprise.frame, 0, float(depth), outcome, larger=whole)


def _going_on(load: HeldObject, side: tuple[int, int], depth: int) -> HeldObject:
    """A load that goes on to one side by so many squares: what shape it has is not known then."""
    steps = (Translate(step * side[0], step * side[1]) for step in range(depth + 1))
    polygon = shapely.union_all([step.carry(load.polygon) for step in steps])
    return replace(load, polygon=polygon, first=polygon, shape={})
