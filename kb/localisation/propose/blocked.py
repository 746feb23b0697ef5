"""Proposals that the newest motion was blocked: every place where something may have stopped it, with its chance.

Utak moves, and pushes objects, up to what may be a wall. The observation after it often agrees with several ends: one
square further on, with the wall one square further on, too; and a robot stopped on a grid line may see what it would
see from beyond the line. Each end has the chance of its contact before the observation. The place of the robot is floor
then, and something stands ahead of it. Walls that were seen twice are straight, so the map prior weighs the ends.
"""

import math
from collections.abc import Iterable, Sequence
from typing import NamedTuple, TypeVar

from utak.geometry.motion.se2 import Motion, Translate
from utak.kb.localisation.hypotheses.carry_outcomes import CarryOutcome, partial_outcome, predicted_outcome
from utak.kb.localisation.hypotheses.contacts import NO_SQUARES, ContactHypothesis
from utak.kb.localisation.hypotheses.explanation import Explanation
from utak.kb.localisation.hypotheses.frames import Position
from utak.kb.localisation.hypotheses.map_prior import DrawnScenes, MapDescription, relative_costs
from utak.kb.localisation.hypotheses.walk_outcomes import line_crossings, observation_places
from utak.kb.localisation.hypotheses.what_if import Surprise, count_clashes
from utak.kb.mapping.obstacle_chance import ObstacleChance
from utak.kb.mapping.occupancy import FREE, OCCUPIED, OPEN, OccupancyMap
from utak.kb.objects.held_object import HeldObject, Square

NEGLIGIBLE_CONTACT_CHANCE = 0.02  # probability of any contact up to which none is considered; tuned
MIN_END_CHANCE = 1e-4  # probability above which an end of a motion is considered; tuned
MAX_ENDS = 24  # ends that are considered: bounds the time of one explanation; tuned


EndOrContact = TypeVar("EndOrContact", "BlockedMotion", ContactHypothesis)


class BlockedMotion(NamedTuple):
    """A possible end of a motion."""

    how: str  # predicted for the end of the whole motion, else blocked
    place: Position  # from which the observation is made then, (x, y) in squares, map frame
    chance: float  # its probability before the observation, 0 to 1
    # The open squares (settled neither as free nor as occupied) one of which blocked it, (column, row) of the map
    # frame; empty where something known did, or nothing
    contact_squares: frozenset[Square] = NO_SQUARES
    outcome: CarryOutcome | None = None  # of the motion of the object in hand; None when there is none


def possible_ends(surprise: Surprise, held: HeldObject | None, motion: Motion) -> list[BlockedMotion]:
    """Return the possible ends of a straight motion: its whole way first, then contacts, the likeliest first."""
    # At a grid line each end is returned once for each side, for the observation may be made from either.
    if not isinstance(motion, Translate):
        return []
    contacts = _walk_contacts(surprise, motion) if held is None else _push_contacts(surprise, held, motion)
    x, y = surprise.place
    end = None if held is None else predicted_outcome(surprise.place, held.polygon, motion)
    chance = 1.0 - sum(contact.chance for contact in contacts)
    whole = _both_sides(BlockedMotion("predicted", (x + motion.dx, y + motion.dy), chance, outcome=end))
    if len(whole) == 1 and whole[0].chance >= 1.0 - NEGLIGIBLE_CONTACT_CHANCE:
        return []
    return [*whole, *likeliest_ends(contacts)]


def likeliest_ends(ends: Iterable[EndOrContact]) -> list[EndOrContact]:
    """Return the likeliest ends, or contacts, the likeliest first: MAX_ENDS (24) of them at most."""
    return sorted((end for end in ends if end.chance > MIN_END_CHANCE), key=lambda end: -end.chance)[:MAX_ENDS]


def _both_sides(end: BlockedMotion) -> list[BlockedMotion]:
    """Return an end once for each place from which the observation may be made there, its chance divided evenly."""
    found = observation_places(end.place)
    outcomes = (end.outcome and end.outcome._replace(place=view) for view in found)
    return [
        end._replace(place=view, chance=end.chance / len(found), outcome=outcome)
        for view, outcome in zip(found, outcomes, strict=True)
    ]


def _walk_contacts(surprise: Surprise, motion: Translate) -> list[BlockedMotion]:
    """Return the ends of a walk at each grid line that it crosses, in order, once for each side of the line."""
    way, occupancy = line_crossings(surprise.place, (motion.dx, motion.dy)), surprise.occupancy
    chances = ObstacleChance(occupancy, surprise.pictures).met([[crossing.entered] for crossing in way])
    found = []
    for crossing, chance in zip(way, chances, strict=True):
        open_ = occupancy.state[occupancy.index(*crossing.entered)] == OPEN
        squares = frozenset([crossing.entered]) if open_ else NO_SQUARES
        found += [BlockedMotion("blocked", view, chance / 2, squares) for view in (crossing.after, crossing.before)]
    return found


def _push_contacts(surprise: Surprise, held: HeldObject, motion: Translate) -> list[BlockedMotion]:
    """Return the ends of a push at each contact of Utak or of the object, in the order of the way."""
    place, polygon = surprise.place, held.polygon
    found = []
    for contact in surprise.obstructions.contacts(place, polygon, motion):
        end = partial_outcome(place, polygon, motion, contact.fraction, contact.squares)
        found += _both_sides(BlockedMotion("blocked", end.place, contact.chance, contact.squares, end))
    return found


def consistent_explanations(surprise: Surprise, explanations: Iterable[Explanation]) -> list[Explanation]:
    """Return those explanations with which the observation agrees, each with its cost by the map prior."""
    found: list[tuple[MapDescription, Explanation]] = []
    drawn: DrawnScenes = {}
    for one in explanations:
        held_objects = (
            list(surprise.held_objects.values()) if one.outcome is None else surprise.objects_after(one.outcome)
        )
        after = surprise.map_after(held_objects, one.place)
        if _settle_contact(after, one) and not count_clashes(
            surprise.frame, after, held_objects, one.place, surprise.ranges
        ):
            found.append((MapDescription(after, drawn), one))
    chances = (max(one.chance or 0.0, MIN_END_CHANCE) for _, one in found)
    costs = relative_costs([(description, -math.log(p)) for (description, _), p in zip(found, chances, strict=True)])
    return [one._replace(prior_cost=cost) for cost, (_, one) in zip(costs, found, strict=True)]


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


def has_whole_way(explanations: Sequence[Explanation]) -> bool:
    """Return whether one of the explanations is that the motion went its whole way (kind predicted)."""
    return any(explanation.how == "predicted" for explanation in explanations)
