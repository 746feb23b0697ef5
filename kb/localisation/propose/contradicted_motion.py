"""Looks that belie a motion: that fit where it should have led, but contradict what they settle themselves.

A look far from all that is known hardly contradicts any of it, wherever it was received. But what it tells of the
squares that it shares with earlier looks must hold together: where it does not, he was stopped on the way.
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from geometry.motion.se2 import Motion, Rotate
from kb.localisation.hypotheses.carry_outcomes import STRIDE, Outcome, otherwise, predicted
from kb.localisation.hypotheses.what_if import Place, Surprise, clashes
from kb.mapping.occupancy import FULL
from kb.mapping.patch import covered
from kb.objects.held_object import WHOLE, HeldObject

CROWDED = 4  # squares that seem to stand right about a thing since it was turned, of which nothing told
BESIDE = 1.0  # squares about a thing


def overlooked(surprise: Surprise, load: HeldObject, motion: Motion) -> Outcome | None:
    """Where the motion of a load in hand was stopped, if the look after it belies the whole of it; None else.

    Nothing settled before disagrees with the whole motion.
    """
    if belied(surprise, predicted(surprise.place, load.polygon, motion)):
        return likeliest_stop(surprise, load, motion)
    return rather_short(surprise, load, motion) if isinstance(motion, Rotate) else None


def belied(surprise: Surprise, outcome: Outcome) -> bool:
    """Does a look contradict what it settles together with all before it, if what is in hand came to lie so?

    outcome : of the command that the look followed, with which nothing settled before it disagrees.
    """
    loads = surprise.lying(outcome)
    occupancy = surprise.looked(loads, outcome.place)
    return clashes(surprise.frame, occupancy, loads, outcome.place, surprise.ranges) > 0


def likeliest_stop(surprise: Surprise, load: HeldObject, motion: Motion) -> Outcome | None:
    """Where the motion of a load in hand was likeliest stopped so that the look contradicts nothing, if anywhere."""
    for end in surprise.hindrances.ends(surprise.place, load.polygon, motion):
        there = surprise.lying(end)
        fits = not clashes(surprise.frame, surprise.occupancy, there, end.place, surprise.ranges)
        if fits and not belied(surprise, end):
            return end
    return None


def rather_short(surprise: Surprise, load: HeldObject, motion: Rotate) -> Outcome | None:
    """Where a turn rather ended short, if that explains what seems to stand right about the thing since it was turned.

    No look contradicts the whole turn. But where the thing lay before, nothing can have come to stand meanwhile. Of
    ends that explain as much the middle one is told.
    """
    place, polygon = surprise.place, load.polygon
    others = [other for other in surprise.loads.values() if other.name != load.name]
    whole = _turned(load, motion.carry(polygon), load.slack, motion.degrees)
    seem = _crowded(surprise, whole, others, place)
    if seem < CROWDED:
        return None
    ends = [*surprise.hindrances.ends(place, polygon, motion)]
    ends += [end for end in otherwise(place, polygon, motion) if end.how == "blocked"]
    stand: list[tuple[int, float, Outcome]] = []
    for end in ends:
        there = _turned(load, end.polygon, STRIDE, end.degrees)
        if not clashes(surprise.frame, surprise.occupancy, [*others, there], place, surprise.ranges):
            stand.append((_crowded(surprise, there, others, place), end.degrees, end))
    fewest = min((many for many, *_ in stand), default=seem)
    fitting = sorted((one for one in stand if one[0] == fewest), key=lambda one: one[1])
    return fitting[len(fitting) // 2][2] if 2 * fewest < seem else None


def _turned(load: HeldObject, polygon: Any, slack: float, degrees: float) -> HeldObject:
    """A thing after a turn. It is the less astray the less it is turned in all, wherever in his square Utak stands."""
    moved = load.moved(polygon, slack, degrees)
    before, after = (abs(math.sin(math.radians(one.turned / 2))) for one in (load, moved))
    whole = before < WHOLE  # turned not at all, or all the way round: by how much it may then be astray is not told
    return moved if whole else replace(moved, astray=load.astray * after / before)


def _crowded(surprise: Surprise, load: HeldObject, others: Sequence[HeldObject], place: Place) -> int:
    """How many squares right about a thing are occupied of which no look told before, if it came to lie so."""
    before, after = surprise.occupancy, surprise.looked([*others, load], place)
    about = covered(load.polygon.buffer(BESIDE, join_style="mitre")).squares()
    new = [square for square in about if before.state[before.index(*square)] != FULL]
    return sum(after.state[after.index(*square)] == FULL for square in new)
