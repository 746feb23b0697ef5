"""The squares in which the robot may stand, with their shares of the likelihood.

An orientation of the grid weighs by its map prior, an origin by the room that it has in the square of waking, another
end of a motion by its chance. That each point of what is left of a square is as likely is a convention.
"""

import math
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping
from typing import NamedTuple

from utak.kb.localisation.hypotheses.frames import OFF_CENTRE_COST, Hypothesis, OriginBox, Position, exact_hypothesis
from utak.kb.localisation.hypotheses.walk_outcomes import add
from utak.kb.localisation.known.state import TrackerState
from utak.kb.objects.held_object import Square
from utak.kb.perception.frame import Frame

MIN_STATED_SHARE = 0.0005  # of the likelihood, below which a square is left out: half a thousandth, the unit of facts
NOWHERE = 1e-9  # squares: a box is no narrower than that


class Standing(NamedTuple):
    """The squares in which the robot may stand."""

    # sure, unsure, slips (motions ended elsewhere before), anew (a map begun anew lies anywhere), or lost (none known)
    case: str
    frame: Frame  # of the map whose squares they are
    shares: Mapping[Square, float]  # of the likelihood; what is missing from 1 is elsewhere


def standing(state: TrackerState) -> Standing:
    """Return the squares in which the robot may stand."""
    if state.lost:
        return Standing("lost", state.frame, {})
    shares = _shares(_weighed(state))
    sure = state.sure and len(shares) == 1 and not any(state.residuals[-1:])
    case = "anew" if state.been else "slips" if state.slips else "sure" if sure else "unsure"
    return Standing(case, state.frame, shares)


def _shares(weighed: Iterable[tuple[OriginBox, float]]) -> dict[Square, float]:
    """Return the share of each square in boxes with weights, in each of which all points are as likely."""
    found: defaultdict[Square, float] = defaultdict(float)
    for (west, south, east, north), weight in weighed:
        for x, along in _parts(west, east):
            for y, up in _parts(south, north):
                found[x, y] += weight * along * up
    total = sum(found.values())
    return {square: share / total for square, share in found.items() if share >= MIN_STATED_SHARE * total}


def _parts(low: float, high: float) -> Iterator[tuple[int, float]]:
    """Yield the whole numbers from which squares between two ends begin, each with its share of what lies between."""
    high = max(high, low + NOWHERE)
    for line in range(math.floor(low), math.ceil(high)):
        yield line, (min(high, line + 1) - max(low, line)) / (high - low)


def _weighed(state: TrackerState) -> Iterator[tuple[OriginBox, float]]:
    """Yield boxes, map frame, in which the robot may be, with their weights."""
    if any(state.place_error):
        (x, y), (west, south, east, north) = state.place, state.place_error
        yield (x + west, y + south, x + east, y + north), 1.0
        return
    here = state.frame.place_to_utak(*state.place)
    ends = ((here, 1.0), *((add(here, end.shift), math.exp(-end.prior_cost)) for end in state.ends))
    for hypothesis in state.frames or (exact_hypothesis(state.frame),):
        exact = hypothesis.is_centred or hypothesis.is_point
        room = 1.0 if exact else hypothesis.area * math.exp(-OFF_CENTRE_COST)
        weight = room * math.exp(-hypothesis.prior_cost)
        for place, odds in ends:
            yield _box(hypothesis, state.frame, place), weight * odds


def _box(hypothesis: Hypothesis, believed: Frame, place: Position) -> OriginBox:
    """Return where a place of Utak's own frame is on the map by a hypothesis, turned as the believed map is."""
    west, south, east, north = hypothesis.box
    turns = round((believed.angle - hypothesis.angle) / 90)  # the grid is the same after each quarter turn
    for _ in range(turns % 4):
        west, south, east, north = 1 - north, west, 1 - south, east
    x, y = Frame(hypothesis.angle + 90 * turns).to_map(*place)
    return west + x, south + y, east + x, north + y
