"""What stopped a thing that Utak carried, when nothing that is known stood in its way."""

import math
from collections.abc import Iterable
from dataclasses import replace

from geometry.rigid import Motion
from kb.evidence import FULL, OPEN, Evidence
from kb.hauling import Outcome, ahead
from kb.loads import Load, Square, covered

ALIKE = 1.0  # log odds by which the likeliest squares may differ
NOTHING: frozenset[Square] = frozenset()


def suspects(
    outcome: Outcome | None, motion: Motion, load: Load, others: Iterable[Load], evidence: Evidence
) -> frozenset[Square]:
    """The open squares (of the lattice) one of which likely stopped a load, or Utak with it; the likeliest ones alone.

    None when it was not stopped, never moved before (then the hand may be empty), or what is known explains it.
    motion : as it was commanded. others : the other things that were moved, where they lie.
    """
    if outcome is None or outcome.how not in ("stuck", "blocked") or not load.proven:
        return NOTHING
    place, polygon = ahead(outcome.place, outcome.polygon, motion)
    there = covered(polygon).squares() | {(math.floor(place[0]), math.floor(place[1]))}
    there -= replace(load, polygon=outcome.polygon, full=NOTHING, empty=NOTHING).possible.squares()
    there.discard((math.floor(outcome.place[0]), math.floor(outcome.place[1])))
    state = {square: evidence.state[evidence.index(*square)] for square in there}
    if FULL in state.values() or any(there & other.possible.squares() for other in others):
        return NOTHING
    odds = {square: float(evidence.logit[evidence.index(*square)]) for square in there if state[square] == OPEN}
    return frozenset(square for square, odd in odds.items() if odd >= max(odds.values()) - ALIKE)
