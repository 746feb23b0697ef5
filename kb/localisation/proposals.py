"""The table of proposals, in the order in which they are asked, and the explanation of an observation that is chosen.

The table is the same after a walk, after a push or a turn, and on waking. A row is a condition and a proposal; rows are
asked while the condition holds for what was found so far. kb/asp/accommodation.lp chooses after each part of the table.
"""

from collections.abc import Callable, Iterable

from utak.kb.localisation.hypotheses.explanation import Explanation
from utak.kb.localisation.known.situation import ObservedSituation, is_simple
from utak.kb.localisation.propose import (
    blocked,
    earlier_motion,
    frame,
    larger_object,
    lifted,
    origin,
    others,
    parted_object,
    smaller_object,
)
from utak.kb.localisation.score import choose, explains_badly, slipped_far

ProposalRow = tuple[Callable[[ObservedSituation], bool], Callable[[ObservedSituation], Iterable[Explanation]]]


def explain(situation: ObservedSituation) -> tuple[Explanation, tuple[Explanation, ...]]:
    """Return the explanation chosen, and the ends of the newest motion that the observation agrees with."""
    ends: tuple[Explanation, ...] = ()
    for rows in TABLE:
        for needed, propose in rows:
            if needed(situation):
                situation = situation.having((*situation.found, *propose(situation)))
        ends = ends or tuple(one for one in situation.found if one.is_end)
        situation = situation.having([choose(situation)])
    return situation.found[0], ends


def _unexplained(situation: ObservedSituation) -> bool:
    """Return whether something contradicts that the motion went as commanded."""
    return situation.found[0].unexplained > 0


def _unexplained_carry(situation: ObservedSituation) -> bool:
    return _unexplained(situation) and situation.carries


def _unframed(situation: ObservedSituation) -> bool:
    """Return whether frames are to be weighed: always before any object was moved, later where something is amiss."""
    return not situation.state.held_objects or _unexplained(situation)


def _not_simple(situation: ObservedSituation) -> bool:
    """Return whether nothing simple explains the observation."""
    return _unexplained(situation) and not any(is_simple(situation.state, one) for one in situation.found)


def _bad(situation: ObservedSituation) -> bool:
    """Return whether what was chosen explains the observation badly."""
    return situation.command is not None and explains_badly(situation.found[0])


def _others(situation: ObservedSituation) -> bool:
    """Return whether others may have changed something: who slips cannot tell that from its own slips."""
    return _bad(situation) and not situation.state.slips


def _elsewhere(situation: ObservedSituation) -> bool:
    """Return whether others may have put the robot elsewhere: it sees nothing as expected."""
    chosen, state = situation.found[0], situation.state
    astray = chosen.unexplained >= state.max_residual or (slipped_far(chosen) and not state.held_objects)
    return _others(situation) and astray


TABLE: tuple[tuple[ProposalRow, ...], ...] = (
    (
        (lambda _: True, blocked.propose),
        (_unexplained, blocked.propose_other_ends),
        (_unexplained_carry, smaller_object.propose),
        (_unexplained_carry, larger_object.propose),
        (_unexplained_carry, parted_object.propose),
        (_unframed, frame.propose),
        (_unexplained, earlier_motion.propose),
        (_not_simple, origin.propose),
    ),
    ((_bad, earlier_motion.propose_slips),),
    ((_others, others.propose), (_elsewhere, lifted.propose)),
)
