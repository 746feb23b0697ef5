"""The scores of the explanations of an observation, and the choice among them by kb/asp/accommodation.lp."""

import numpy as np

from utak.kb.localisation.hypotheses.explanation import Explanation, cheapest
from utak.kb.localisation.known.situation import ObservedSituation
from utak.kb.localisation.propose.lifted import weighed

MAX_CLEAR_CHANCE = 0.25  # probability of a contact up to which a motion counts as clear of obstacles; tuned
MIN_UNEXPLAINED = 2  # fields of noise that cost more than an act of others: derived from kb/asp/accommodation.lp


def choose(situation: ObservedSituation) -> Explanation:
    """Return the cheapest of the explanations found; of those that cost the same the first."""
    state, found = situation.state, situation.found
    if len(found) == 1:
        return found[0]
    if any(one.how in ("changed", "lifted", "lost") for one in found):
        found = tuple(weighed(situation))
    facts = {
        f"trust({0 if state.off_middle else state.confirmations})": True,
        "slips": state.slips,
        "off_middle": state.off_middle,
        "stands": any(one.how == "predicted" and not one.unexplained for one in found),
        **{f"met({n})": one.contact_known and one.frame == state.frame for n, one in enumerate(found)},
        "proven": state.in_hand is not None and state.held_objects[state.in_hand].proven,
    }
    if situation.carries:
        insets = situation.held.insets
        facts |= {
            "unchanged": np.array_equal(situation.ranges, state.observations[-1].ranges),
            "clear": sum(contact.chance for contact in situation.contacts) <= MAX_CLEAR_CHANCE,
            "uneven": insets is not None and insets.uneven,
        }
    return cheapest(found, [fact for fact, holds in facts.items() if holds])


def explains_badly(explanation: Explanation) -> bool:
    """Return whether an explanation leaves so much that others may have moved things, or is a slip of over a square."""
    return explanation.unexplained >= MIN_UNEXPLAINED or slipped_far(explanation)


def slipped_far(explanation: Explanation) -> bool:
    """Return whether by an explanation the newest motion slipped by more than a square."""
    return explanation.how == "slipped" and explanation.distance > 1 and explanation.correction is None
