"""Looks that belie a motion: that fit where it should have led, but contradict what they settle themselves.

A look far from all that is known hardly contradicts any of it, wherever it was received. But what it tells of the
squares that it shares with earlier looks must hold together: where it does not, he was stopped on the way.
"""

import math
from copy import deepcopy

from geometry.rigid import Motion
from kb.hauling import Outcome
from kb.loads import Load, discounted
from kb.supposing import Surprise, clashes


def belied(surprise: Surprise, outcome: Outcome) -> bool:
    """Does a look contradict what it settles together with all before it, if what is in hand came to lie so?

    outcome : of the command that the look followed, with which nothing settled before it disagrees.
    """
    loads, (x, y) = _lying(surprise, outcome), (math.floor(v) for v in outcome.place)
    samples, counts = discounted(surprise.lattice.samples(), surprise.ranges, x, y, loads)
    evidence = deepcopy(surprise.evidence)
    evidence.look(samples, counts, x, y, len(surprise.looks))
    return clashes(surprise.lattice, evidence, loads, outcome.place, surprise.ranges) > 0


def likeliest_stop(surprise: Surprise, load: Load, motion: Motion) -> Outcome | None:
    """Where the motion of a load in hand was likeliest stopped so that the look contradicts nothing, if anywhere."""
    for end in surprise.hindrances.ends(surprise.place, load.polygon, motion):
        there = _lying(surprise, end)
        fits = not clashes(surprise.lattice, surprise.evidence, there, end.place, surprise.ranges)
        if fits and not belied(surprise, end):
            return end
    return None


def _lying(surprise: Surprise, outcome: Outcome) -> list[Load]:
    """All loads where they lie if the motion of the one in hand came out so."""
    return [
        load.moved(outcome.polygon, load.slack) if name == surprise.held else load
        for name, load in surprise.loads.items()
    ]
