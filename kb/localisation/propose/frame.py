"""Which lattice to believe instead, when a look contradicts what is believed and things have been moved.

What was left is tried first, then what had been given up; that a motion was stopped by what is not known comes last.
"""

import math
from collections.abc import Iterator
from typing import NamedTuple

from kb.localisation.hypotheses.carry_outcomes import part_way
from kb.localisation.hypotheses.contacts import Obstructions
from kb.localisation.hypotheses.frames import ELSEWHERE, FrameHypothesis, anywhere, candidates, exactly, search
from kb.localisation.hypotheses.walk_outcomes import views
from kb.localisation.hypotheses.what_if import Surprise, WhatIf
from kb.localisation.propose.blocked import likeliest
from kb.localisation.propose.origin import frames, odds_against
from kb.localisation.propose.origin_from_turns import pivoted
from kb.objects.held_object import Square
from kb.perception.frame import CENTRE, Frame

ABOUT = 2  # degrees by which the lattice may lie otherwise than any that was left
WIDEST = 8  # degrees between those that were left, for more to be thought of
FEW = 12  # lattices on which all is laid anew, at most
LEAST = 4  # at least
MOST_REPLAYS = 200  # looks that are taken in anew for that
BEST = 3  # of those, on which the motion may have been stopped by what was not known
SLIVER = 0.02  # squares^2: where there is no more room for where he woke, he was rather stopped


def explained(surprise: Surprise, anew: bool, simple: bool) -> WhatIf | None:
    """The lattice that explains a look best; None when none is left.

    anew : may hypotheses that were given up before be taken up again? simple : is it explained if the motion ended
    early, the lattice being as believed?
    """
    if surprise.turned:
        found = _otherwise_turned(surprise) or pivoted(surprise, simple)
        if found is not None:
            return found
    return _laid_otherwise(surprise, anew)


def _otherwise_turned(surprise: Surprise) -> WhatIf | None:
    """A lattice turned otherwise than believed that was never given up, and on which nothing contradicts.

    That he woke amid his square is assumed as long as that explains all.
    """
    angle = surprise.frame.angle
    others = [other for other in surprise.hypotheses if other.is_centred and other.angle != angle]
    left = search(surprise.recent, others, surprise.unsettled)
    tried = (surprise.tried(frame, left, whether=True) for frame in candidates(left, surprise.frame)[:FEW])
    return next((one for one in tried if not one.misfits), None)


def _laid_otherwise(surprise: Surprise, anew: bool) -> WhatIf | None:
    """The lattice on which, when all is laid on it, the fewest fields contradict."""
    found: list[WhatIf] = []
    few = max(LEAST, min(FEW, MOST_REPLAYS // (len(surprise.observations) + 1)))
    for hypotheses, searched in _by_turns(surprise, anew):
        if searched and sum(hypothesis.area for hypothesis in hypotheses) < SLIVER:
            short = _cut_short(surprise, few)
            if short is not None:
                return short
        for frame in candidates(hypotheses, surprise.frame)[:few]:
            found.append(surprise.tried(frame, hypotheses, searched))
            if not found[-1].misfits:
                return found[-1]
    if found or surprise.moving is None:
        found.sort(key=lambda one: one.misfits)
        others = [one for one in found if one.frame != surprise.frame][:BEST]
        found += [surprise.tried(one.frame, one.hypotheses, one.searched, cut_short=True) for one in others]
    else:  # on none of them the motion went on to its end
        for frame in candidates(surprise.before, surprise.frame)[:few]:
            found += [surprise.tried(frame, surprise.before, cut_short=cut_short) for cut_short in (False, True)]
    return min(found, key=lambda one: one.misfits, default=None)


def _by_turns(surprise: Surprise, anew: bool) -> Iterator[tuple[tuple[FrameHypothesis, ...], bool]]:
    """Hypotheses to try one after the other, the likeliest first, each time with whether they had been given up.

    That he woke elsewhere in his square is thought of before angles at which the table looks less plain.
    """
    left = search(surprise.recent, surprise.hypotheses, surprise.unsettled)
    plainest = tuple(hypothesis for hypothesis in left if hypothesis.dear <= ELSEWHERE)
    yield plainest, False
    if len(plainest) < len(left):
        if anew:
            yield search(surprise.recent, anywhere((surprise.frame.angle,)), surprise.unsettled), True
        yield tuple(hypothesis for hypothesis in left if hypothesis.dear > ELSEWHERE), False
    if anew:
        yield _searched(surprise), True


def _searched(surprise: Surprise) -> tuple[FrameHypothesis, ...]:
    """All that may be, of angles near to those that were left."""
    angles = [surprise.frame.angle, *(h.angle for h in surprise.hypotheses)]
    if max(angles) - min(angles) > WIDEST:
        angles = [surprise.frame.angle]
    about = anywhere(range(min(angles) - ABOUT, max(angles) + ABOUT + 1))
    return search(surprise.recent, about, surprise.unsettled)


def _cut_short(surprise: Surprise, few: int) -> WhatIf | None:
    """A lattice that stood before the thing in hand was moved, on which that was stopped, and nothing contradicts.

    Rather where something is known that stopped it; of angles that do as well, the middle one.
    """
    if surprise.moving is None:
        return None
    frames = candidates(surprise.before, surprise.frame)[:few]
    for cut_short in (False, True):
        tried = [surprise.tried(frame, surprise.before, cut_short=cut_short, whether=True) for frame in frames]
        fitting = sorted((one for one in tried if not one.misfits), key=lambda one: one.frame.angle)
        if fitting:
            return fitting[(len(fitting) - 1) // 2]
    return None


class HaltedElsewhere(NamedTuple):
    """That a push was stopped, and he woke elsewhere in his square. chance : how likely the push was stopped so.

    against : log odds against it, by the part of his square in which he woke then.
    """

    supposed: WhatIf
    chance: float
    against: float


def halted_elsewhere(surprise: Surprise) -> list[HaltedElsewhere]:
    """How a push may have been stopped by which nothing contradicts, if he woke elsewhere, of a grid of places.

    Where he himself runs against something depends on where he woke. Once a thing was turned that tells where he woke.
    """
    alike: dict[tuple[int, int, frozenset[Square]], list[tuple[WhatIf, float]]] = {}
    for frame in frames(surprise.frame) if surprise.moving is not None and not surprise.turned else ():
        for supposed, chance in _halts(surprise, frame):
            assert supposed.outcome is not None
            x, y = supposed.place
            key = math.floor(x), math.floor(y), supposed.outcome.against
            alike.setdefault(key, []).append((supposed, chance))
    found = []
    for same in alike.values():
        supposed, chance = min(same, key=lambda one: math.dist(one[0].frame.origin, CENTRE))
        left = tuple(dict.fromkeys(hypothesis for one, _ in same for hypothesis in one.hypotheses))
        against = odds_against(surprise.frame, len(left))
        found.append(HaltedElsewhere(supposed._replace(hypotheses=left), chance, against))
    return found


def _halts(surprise: Surprise, frame: Frame) -> Iterator[tuple[WhatIf, float]]:
    """How a push may have been stopped on a lattice on which nothing contradicts then, with how likely that was."""
    under = surprise.laid(frame, whether=True)
    if under.misfits:
        return
    place, polygon, motion = surprise.begun(frame)
    held, hindrances = (exactly(frame),), Obstructions(under.occupancy, place, polygon, motion)
    for stop in likeliest(hindrances.stops(place, polygon, motion)):
        end = part_way(place, polygon, motion, stop.part, stop.against)
        for view in views(end.place):
            supposed = surprise.judged(frame, held, end._replace(place=view), whether=True)
            if not supposed.misfits:
                yield supposed, stop.chance
