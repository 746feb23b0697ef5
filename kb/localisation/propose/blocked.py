"""Proposals of where the newest motion ended: at its end, or where something may have stopped it, with its chance.

Utak moves, and pushes objects, up to what may be a wall. The observation after it often agrees with several ends: one
square further on, with the wall one square further on, too; and a robot stopped on a grid line may see what it would
see from beyond the line. Each end has the chance of its contact before the observation. The place of the robot is floor
then, and something stands ahead of it. Walls that were seen twice are straight, so the map prior weighs the ends.
"""

import math
from collections.abc import Iterable
from itertools import islice

from utak.geometry.motion.se2 import Translate
from utak.kb.localisation.hypotheses.carry_outcomes import other_outcomes, partial_outcome, predicted_outcome
from utak.kb.localisation.hypotheses.contacts import NO_SQUARES
from utak.kb.localisation.hypotheses.explanation import Explanation
from utak.kb.localisation.hypotheses.frames import Position
from utak.kb.localisation.hypotheses.map_prior import MapDescription, relative_costs
from utak.kb.localisation.hypotheses.walk_outcomes import (
    blocked_ends,
    entered_square,
    line_crossings,
    observation_places,
    slipped_ends,
)
from utak.kb.localisation.known.situation import ObservedSituation, count_clashes, explained_by, residual_at
from utak.kb.localisation.propose.contradicted_motion import overlooked_contact
from utak.kb.mapping.obstacle_chance import ObstacleChance
from utak.kb.mapping.occupancy import FREE, OCCUPIED, OPEN, OccupancyMap

MIN_END_CHANCE = 1e-4  # probability above which an end of a motion is considered; tuned
MAX_ENDS = 24  # ends that a look agrees with and that are weighed: bounds the time of one explanation; tuned
NEGLIGIBLE_CONTACT_CHANCE = 0.02  # probability of any contact up to which none is considered; tuned


def propose(situation: ObservedSituation) -> list[Explanation]:
    """Return the explanation that the motion went as commanded, or where it may have ended, as far as that fits."""
    whole, ends = _whole_motion(situation), consistent_explanations(situation, possible_ends(situation))
    went = any(one.how == "predicted" for one in ends)
    fits = not whole.residual and (went or not ends)
    if fits and not situation.state.held_objects:
        if situation.stands:
            return _weighed(situation, ends or [whole])
        fits = situation.another is None
    if went and (fits or situation.carries):
        return ends
    if fits:
        contact = overlooked_contact(situation) if situation.carries else None
        return [whole if contact is None else explained_by(situation, contact)]
    # Where no settled square contradicts it, two observations contradict each other
    return [whole._replace(contradicted=not whole.residual), *(one for one in ends if one.how == "blocked")]


def _weighed(situation: ObservedSituation, ends: list[Explanation]) -> list[Explanation]:
    """Return ends of a walk with the prior cost of the believed frame, and with the frame hypotheses that are left."""
    cost = next(h.prior_cost for h in situation.left if h.contains(situation.state.frame))
    return [one._replace(prior_cost=one.prior_cost + cost, hypotheses=situation.left) for one in ends]


def propose_other_ends(situation: ObservedSituation) -> list[Explanation]:
    """Return the explanations that the newest motion ended anywhere on its way, or beside its end."""
    known, start, whole = any(one.is_end for one in situation.found), situation.state.place, situation.found[0].place
    if situation.carries:
        polygon, motion = situation.held.polygon, situation.motion
        contacts = [] if known else situation.contact_ends
        met = [one for one in (explained_by(situation, end) for end in contacts) if not one.residual]
        return met + [explained_by(situation, other) for other in other_outcomes(start, polygon, motion)]
    ends = () if known or not situation.walked else blocked_ends(start, situation.shift)
    blocked = [_blocked(situation, place, whole) for place in ends]
    return blocked + [_walked(situation, "slipped", place, whole) for place in slipped_ends(whole)]


def _whole_motion(situation: ObservedSituation) -> Explanation:
    """Return the explanation that the motion went as commanded."""
    if situation.carries:
        end = predicted_outcome(situation.state.place, situation.held.polygon, situation.motion)
        return explained_by(situation, end)
    near = situation.state.places_near(situation.ahead)
    return min(
        (_walked(situation, "predicted", place, situation.ahead) for place in near), key=lambda one: one.residual
    )


def _blocked(situation: ObservedSituation, place: Position, whole: Position) -> Explanation:
    """Return the explanation that a walk was blocked at `place`, contradicted where floor is settled ahead."""
    occupancy, entered = situation.state.occupancy, entered_square(place, situation.ahead)
    barred = entered is not None and occupancy.state[occupancy.index(*entered)] != FREE
    return _walked(situation, "blocked", place, whole)._replace(contradicted=not barred)


def _walked(situation: ObservedSituation, how: str, place: Position, whole: Position) -> Explanation:
    """Return the explanation that the observation was made at `place`, in the believed frame."""
    return Explanation(how, place, situation.state.frame, residual_at(situation, place), math.dist(place, whole))


def possible_ends(situation: ObservedSituation) -> list[Explanation]:
    """Return the possible ends of a straight motion: its whole way first, then contacts, the likeliest first."""
    # At a grid line each end is returned once for each side, for the observation may be made from either. How far the
    # observation contradicts them is not looked at.
    if not isinstance(situation.motion, Translate) or not (situation.walked or situation.carries):
        return []
    whole = _whole_motion(situation)._replace(place=situation.ahead)
    contacts = _push_contacts(situation) if situation.carries else _walk_contacts(situation)
    chance = 1.0 - sum(map(_chance, contacts))
    ends = _both_sides(whole._replace(chance=chance))
    if len(ends) == 1 and chance >= 1.0 - NEGLIGIBLE_CONTACT_CHANCE:
        return []
    first = ends[0].place
    far = [one if one.outcome else one._replace(distance=math.dist(one.place, first)) for one in contacts]
    return [*ends, *sorted((one for one in far if _chance(one) > MIN_END_CHANCE), key=lambda one: -_chance(one))]


def _chance(end: Explanation) -> float:
    return 0.0 if end.chance is None else end.chance


def _both_sides(end: Explanation) -> list[Explanation]:
    """Return an end once for each place from which the observation may be made there, its chance divided evenly."""
    found, chance = observation_places(end.place), _chance(end)
    outcomes = (end.outcome and end.outcome._replace(place=view) for view in found)
    return [
        end._replace(place=view, chance=chance / len(found), outcome=outcome)
        for view, outcome in zip(found, outcomes, strict=True)
    ]


def _walk_contacts(situation: ObservedSituation) -> list[Explanation]:
    """Return the ends of a walk at each grid line that it crosses, in order, once for each side of the line."""
    state = situation.state
    way, occupancy = line_crossings(state.place, situation.shift), state.occupancy
    chances = ObstacleChance(occupancy, state.completions).met([[crossing.entered] for crossing in way])
    found = []
    for crossing, chance in zip(way, chances, strict=True):
        open_ = occupancy.state[occupancy.index(*crossing.entered)] == OPEN
        end = Explanation("blocked", crossing.after, state.frame, 0, 0.0, chance=chance / 2)
        end = end._replace(contact_squares=frozenset([crossing.entered]) if open_ else NO_SQUARES)
        found += [end, end._replace(place=crossing.before)]
    return found


def _push_contacts(situation: ObservedSituation) -> list[Explanation]:
    """Return the ends of a push at each contact of Utak or of the object, in the order of the way."""
    state, polygon, motion = situation.state, situation.held.polygon, situation.motion
    found = []
    for contact in situation.contacts:
        end = partial_outcome(state.place, polygon, motion, contact.fraction, contact.squares)
        one = Explanation("blocked", end.place, state.frame, 0, end.distance, end, chance=contact.chance)
        found += _both_sides(one._replace(contact_squares=contact.squares))
    return found


def consistent_explanations(situation: ObservedSituation, explanations: Iterable[Explanation]) -> list[Explanation]:
    """Return those explanations with which the observation agrees, each with its cost by the map prior."""
    state = situation.state
    found: list[tuple[MapDescription, Explanation]] = []
    fitting = (one for one in explanations if not residual_at(situation, one.place, one.outcome))
    for one in islice(fitting, MAX_ENDS):
        held_objects = situation.objects_after(one.outcome)
        after = situation.map_after(held_objects, one.place)
        if _settle_contact(after, one) and not count_clashes(
            state.frame, after, held_objects, one.place, situation.ranges
        ):
            against = -math.log(max(_chance(one), MIN_END_CHANCE))
            found.append((MapDescription(after, against), one))
    costs = relative_costs([description for description, _ in found])
    return [one._replace(residual=0, prior_cost=cost) for cost, (_, one) in zip(costs, found, strict=True)]


def _settle_contact(occupancy: OccupancyMap, explanation: Explanation) -> bool:
    """Settle the square of Utak in `occupancy` after an explanation, and return whether a contact is possible."""
    # A contact is impossible where all its squares are free, or where Utak would be in an occupied square. At the
    # commanded end on a line, or at a known obstacle, the observation may be made from any square beside it, so nothing
    # is settled and True is returned.
    against, (x, y) = explanation.contact_squares, explanation.place
    own = (math.floor(x), math.floor(y))
    if against and all(occupancy.state[occupancy.index(*square)] == FREE for square in against):
        return False
    if not against and (explanation.how != "predicted" or len(observation_places(explanation.place)) > 1):
        return True
    here = occupancy.index(*own)
    state = OCCUPIED if own in against else FREE
    if occupancy.state[here] == OPEN:
        occupancy.state[here] = state
    return bool(occupancy.state[here] == state)
