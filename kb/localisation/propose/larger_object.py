"""Proposals that a held object is larger than it seemed: it goes on in what was taken for wall.

What touches a wall looks one with it, and is told apart only where it sticks out. Only when an object is drawn out of a
door or a niche, floor shows where wall seemed to be, and so how far the object went on.
"""

from collections.abc import Iterator
from dataclasses import replace

import shapely

from geometry.motion.se2 import Motion, Translate
from kb.localisation.hypotheses.carry_outcomes import predicted_outcome
from kb.localisation.hypotheses.explanation import Explanation
from kb.localisation.hypotheses.what_if import Surprise, count_clashes
from kb.mapping.occupancy import FREE, OCCUPIED
from kb.mapping.patch import patch_of_polygon, patch_of_squares
from kb.objects.held_object import HeldObject, is_grid_aligned

MAX_HIDDEN_DEPTH = 8  # squares by which an object may go on in what seems to be wall; a bound on time
SIDE_DIRECTIONS = ((1, 0), (0, 1), (-1, 0), (0, -1))  # map frame: east, north, west, south


def larger_objects(surprise: Surprise, held: HeldObject, motion: Motion) -> Iterator[Explanation]:
    """Yield explanations that a push went as commanded and the object is larger than it seemed, the least larger first.

    At most one for each side. An object that fills a gap in a wall mostly goes on to the end of the wall: of the
    lengths that the observation agrees with, the greatest one over squares that were settled as occupied counts, if
    there is one; else the least.

    Only for an object that never moved before, with its sides on grid lines; nothing for a turn.

    Parameters
    ----------
    surprise : the observation after the push.
    held : the object in hand, before the push, map frame.
    motion : as commanded, map frame.

    Yields
    ------
    Explanation
        Of kind larger, at the commanded place (x, y) in squares, map frame. Without residual; `larger` is the object
        before the push; `distance` is how far it goes on at least beyond what was seen, 1 to MAX_HIDDEN_DEPTH squares.
    """
    if held.proven or not isinstance(motion, Translate) or not is_grid_aligned(held.polygon):
        return
    agreeing = [list(_agreeing_lengths(surprise, held, motion, side)) for side in SIDE_DIRECTIONS]
    for found in sorted((found for found in agreeing if found), key=lambda found: found[0][0].distance):
        least, settled = found[0][0], [explanation for explanation, occupied in found if occupied]
        yield (settled[-1] if settled else least)._replace(distance=least.distance)


def _agreeing_lengths(
    surprise: Surprise, held: HeldObject, motion: Translate, side: tuple[int, int]
) -> Iterator[tuple[Explanation, bool]]:
    """Yield each explanation by which the object goes on to one side, if the observation agrees, the least first.

    With it comes whether all that was hidden had been settled as occupied.

    surprise : the observation after the push. held : the object before it, map frame. motion : as commanded, map frame.
    side : one of SIDE_DIRECTIONS.
    """
    occupancy, seen = surprise.occupancy, patch_of_polygon(held.polygon).squares()
    others = [other for other in surprise.held_objects.values() if other.name != held.name]
    for depth in range(1, MAX_HIDDEN_DEPTH + 1):
        whole = _extended(held, side, depth)
        hidden = patch_of_polygon(whole.polygon).squares() - seen
        states = {int(occupancy.state[occupancy.index(*square)]) for square in hidden}
        if FREE in states:
            return
        outcome = predicted_outcome(surprise.place, whole.polygon, motion)._replace(how="larger")
        patch, floor = patch_of_squares(hidden), occupancy.copy()
        floor.declare(floor.squares(patch.west, patch.south, patch.mask), FREE, len(surprise.observations) - 1)
        held_objects = [*others, whole.moved(outcome.polygon, whole.slack, commanded=True)]
        if not count_clashes(surprise.frame, floor, held_objects, outcome.place, surprise.ranges):
            yield (
                Explanation("larger", outcome.place, surprise.frame, 0, float(depth), outcome, larger=whole),
                states == {OCCUPIED},
            )


def _extended(held: HeldObject, side: tuple[int, int], depth: int) -> HeldObject:
    """Return an object that goes on to one side by `depth` squares; its shape class is unknown then.

    Its outlines `polygon` and `first` are both the larger one, shapely Polygon, in squares, map frame.

    held : the object as it seemed, map frame. side : one of SIDE_DIRECTIONS, a unit step (x, y) of the map frame.
    """
    steps = (Translate(step * side[0], step * side[1]) for step in range(depth + 1))
    polygon = shapely.union_all([step.carry(held.polygon) for step in steps])
    return replace(held, polygon=polygon, first=polygon, shape={})
