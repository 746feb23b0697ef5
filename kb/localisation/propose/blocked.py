"""Where a motion came to a halt, of all places where something may have stopped it: by what was known before, and by
how plain the table looks.

He moves, and pushes things, up to what may be a wall. The look after it often agrees with several halts: a square
further, and the wall stands a square further, too; and who is stopped right on a line may see what he would see from
beyond it. Each halt is as likely as what would have stopped him there was before. Where he stands there is floor, and
where he was stopped there is none ahead; and walls that were seen twice are straight.
"""

import math
from collections.abc import Iterable, Sequence
from typing import NamedTuple, TypeVar

from geometry.motion.se2 import Motion, Translate
from kb.localisation.hypotheses.carry_outcomes import Outcome, part_way, predicted
from kb.localisation.hypotheses.contacts import ContactHypothesis
from kb.localisation.hypotheses.explanation import Explanation
from kb.localisation.hypotheses.map_prior import Drawn, MapDescription, plainness
from kb.localisation.hypotheses.walk_outcomes import crossings, views
from kb.localisation.hypotheses.what_if import Place, Surprise, clashes
from kb.mapping.obstacle_chance import ObstacleChance
from kb.mapping.occupancy import FREE, FULL, OPEN, OccupancyMap
from kb.objects.held_object import HeldObject, Square

RISK = 0.02  # how likely a motion may be stopped before it is asked where
UNLIKELY = 1e-4  # how likely a halt is at least that is thought of
MOST = 24  # such halts


T = TypeVar("T", "BlockedMotion", ContactHypothesis)


class BlockedMotion(NamedTuple):
    """An end of a motion: the place that Utak looks from then, and how likely it was before the look.

    how : predicted, if it is that of the whole motion; else blocked. against : the open squares one of which would have
    stopped it there; none where it is known what did, or nothing. outcome : of a motion with something in hand.
    """

    how: str
    place: Place
    chance: float
    against: frozenset[Square] = frozenset()
    outcome: Outcome | None = None


def halts(surprise: Surprise, load: HeldObject | None, motion: Motion) -> list[BlockedMotion]:
    """The whole of a straight motion, first, and where else it may have ended; none when there is nothing to ask.

    That is so when it hardly came upon anything and ended amid a square. Who ends on a line between squares may look
    from either side of it. load : what was in hand. motion : on the lattice.
    """
    if not isinstance(motion, Translate):
        return []
    stops = _of_a_walk(surprise, motion) if load is None else _of_a_push(surprise, load, motion)
    x, y = surprise.place
    end = None if load is None else predicted(surprise.place, load.polygon, motion)
    whole = _seen(
        BlockedMotion("predicted", (x + motion.dx, y + motion.dy), 1.0 - sum(s.chance for s in stops), outcome=end)
    )
    if len(whole) == 1 and whole[0].chance >= 1.0 - RISK:
        return []
    return [*whole, *likeliest(stops)]


def likeliest(stops: Iterable[T]) -> list[T]:
    """Those halts, or stops, that are thought of, by how likely they are."""
    return sorted((stop for stop in stops if stop.chance > UNLIKELY), key=lambda stop: -stop.chance)[:MOST]


def _seen(halt: BlockedMotion) -> list[BlockedMotion]:
    """The same from each of the places from which he may look there."""
    found = views(halt.place)
    ends = (halt.outcome and halt.outcome._replace(place=view) for view in found)
    return [
        halt._replace(place=view, chance=halt.chance / len(found), outcome=end)
        for view, end in zip(found, ends, strict=True)
    ]


def _of_a_walk(surprise: Surprise, motion: Translate) -> list[BlockedMotion]:
    way, occupancy = crossings(surprise.place, (motion.dx, motion.dy)), surprise.occupancy
    chances = ObstacleChance(occupancy, surprise.pictures).met([[crossing.entered] for crossing in way])
    found = []
    for crossing, chance in zip(way, chances, strict=True):
        open_ = occupancy.state[occupancy.index(*crossing.entered)] == OPEN
        against = frozenset([crossing.entered]) if open_ else frozenset[Square]()
        found += [BlockedMotion("blocked", view, chance / 2, against) for view in (crossing.after, crossing.before)]
    return found


def _of_a_push(surprise: Surprise, load: HeldObject, motion: Translate) -> list[BlockedMotion]:
    place, polygon = surprise.place, load.polygon
    found = []
    for stop in surprise.hindrances.stops(place, polygon, motion):
        end = part_way(place, polygon, motion, stop.part, stop.against)
        found += _seen(BlockedMotion("blocked", end.place, stop.chance, stop.against, end))
    return found


def borne_out(surprise: Surprise, explanations: Iterable[Explanation]) -> list[Explanation]:
    """Those explanations of a look that bear it out, each with how plain the table looks then.

    By none of them anything that was settled before is otherwise.
    """
    found: list[tuple[MapDescription, Explanation]] = []
    drawn: Drawn = {}
    for one in explanations:
        loads = list(surprise.loads.values()) if one.outcome is None else surprise.lying(one.outcome)
        after = surprise.looked(loads, one.place)
        if _can_stand(after, one) and not clashes(surprise.frame, after, loads, one.place, surprise.ranges):
            found.append((MapDescription(after, drawn), one))
    prices = plainness([(sketch, -math.log(max(one.chance or 0.0, UNLIKELY))) for sketch, one in found])
    return [one._replace(crooked=price) for price, (_, one) in zip(prices, found, strict=True)]


def _can_stand(occupancy: OccupancyMap, explanation: Explanation) -> bool:
    """Whether something can stand against which he was stopped, and he himself where he is: so it is settled then.

    Who looks from beyond the line on which he was stopped looks from the square of what stopped him. Who just came to a
    line, or was stopped by what is known, may look from any square beside it.
    """
    against, (x, y) = explanation.against, explanation.place
    own = (math.floor(x), math.floor(y))
    if against and all(occupancy.state[occupancy.index(*square)] == FREE for square in against):
        return False
    if not against and (explanation.how != "predicted" or len(views(explanation.place)) > 1):
        return True
    here = occupancy.index(*own)
    state = FULL if own in against else FREE
    if occupancy.state[here] == OPEN:
        occupancy.state[here] = state
    return bool(occupancy.state[here] == state)


def whole_first(explanations: Sequence[Explanation]) -> bool:
    """Is that the motion went its whole way among them?"""
    return any(explanation.how == "predicted" for explanation in explanations)
