"""State of the localisation tracker: pose, frame hypotheses, occupancy map and held objects, as one frozen value.

Whatever proposes or scores explanations reads this value. kb.localisation.tracker alone makes the next one.
"""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from itertools import pairwise

from utak.kb.localisation.hypotheses.frames import (
    CENTRED_HYPOTHESES,
    KEPT_ODDS,
    Hypothesis,
    Observation,
    OriginBox,
    Position,
    origin_leeway,
)
from utak.kb.localisation.hypotheses.map_prior import UNTRIED_COST
from utak.kb.localisation.hypotheses.recognition import Look, places_within
from utak.kb.localisation.hypotheses.walk_outcomes import (
    LINE_DISTANCE,
    StraightMotion,
    add,
    observation_places,
    squares_passed,
)
from utak.kb.mapping.completions import Completions
from utak.kb.mapping.occupancy import FREE, OPEN, OccupancyMap
from utak.kb.objects.held_object import HeldObject, Square
from utak.kb.objects.persistence import ChangesByOthers
from utak.kb.perception.frame import CENTRE, Frame

MAX_RESIDUAL = 8  # residual fields of the last observations together from which localisation has failed; tuned
MAX_RESIDUAL_AFTER_MOVING = 24  # the same once an object was moved, for it may lie elsewhere than believed; tuned


@dataclass(frozen=True)
class TrackerState:
    """Everything the localisation tracker believes after an observation."""

    # The occupancy map, map frame. The tracker updates it in place; everybody else only reads it.
    occupancy: OccupancyMap = field(default_factory=OccupancyMap)
    # The believed frame: the angle, in degrees, by which Utak's own frame is turned against the map frame, and its
    # origin, a point of the square of waking
    frame: Frame = field(default_factory=Frame)
    place: Position = CENTRE  # where Utak is: (x, y) in squares, map frame
    # All observations since the tracker began, oldest first; each keeps its place in Utak's own frame
    observations: tuple[Observation, ...] = ()
    # The frames that are left, and other ends of the last motions within KEPT_ODDS of the believed ones
    hypotheses: tuple[Hypothesis, ...] = CENTRED_HYPOTHESES
    confirmations: int = 0  # number of observations in a row that confirmed the believed frame
    # Squares that stopped Utak himself when a motion was about to enter them, map frame
    blocked_squares: frozenset[Square] = frozenset()
    # Open squares (not settled as free or occupied) one of which probably stopped a held object, map frame
    suspected_squares: frozenset[Square] = frozenset()
    slipped: bool = False  # whether any motion ended beside its predicted end, on this map
    # Whether motions did so on an earlier map, or that contradicted itself, which the robot's own motions explain
    unsteady: bool = False
    # The last straight motions, oldest first
    motions: tuple[StraightMotion, ...] = ()
    # All objects that were ever held, by name, map frame
    held_objects: Mapping[str, HeldObject] = field(default_factory=dict)
    in_hand: str | None = None  # the name of the object in the hand; None when the hand is empty
    may_hold: bool = False  # whether what was in hand on the map of before may be there still; then in_hand is None
    # Number of unexplained fields of each of the last observations, oldest first; 4 at most
    residuals: tuple[int, ...] = ()
    # The number of the first observation since one left fields unexplained; 0 while none did
    sound_since: int = 0
    # Places of the observations before the tracker began anew, oldest first, (east, north) in squares, Utak's own frame
    been: tuple[Position, ...] = ()
    # The newest completions of the map in this frame (sampled maps that agree with all counts); None when none were
    # drawn
    completions: Completions | None = None
    # The squares of things that were seen and never held, by name, map frame: whole things can be moved by others
    things: Mapping[str, frozenset[Square]] = field(default_factory=dict)
    place_error: OriginBox = (0.0, 0.0, 0.0, 0.0)  # how far Utak may be from `place` since it was lifted: W, S, E, N
    # By square that others changed, map frame: the number of the first observation since
    changed_at: Mapping[Square, int] = field(default_factory=dict)
    removed: int = 0  # how many known things others were seen to have taken away, on any map
    lifted_at: frozenset[int] = frozenset()  # the numbers of the observations before which it was put elsewhere
    # What was believed before it was put where it recognised nothing yet, and what it saw since
    former: "TrackerState | None" = None
    looks: tuple[Look, ...] = ()

    def places_near(self, place: Position) -> list[Position]:
        """Return the places from which an observation may be made that ends a motion at `place`, one in each square."""
        return places_within(place, self.place_error) if any(self.place_error) else list(observation_places(place))

    @property
    def changes(self) -> ChangesByOthers:
        """Return what others were seen to change."""
        last = max(self.changed_at.values(), default=None)
        return ChangesByOthers(self.removed, None if last is None else len(self.observations) - 1 - last)

    # -- pose and track --------------------------------------------------------------------------

    @property
    def square(self) -> Square:
        """Return the square (column, row) of the map frame in which Utak is; the square of waking is (0, 0)."""
        return math.floor(self.place[0]), math.floor(self.place[1])

    @property
    def track(self) -> list[Position]:
        """Return all places of observations as (x, y) in squares, oldest first; map frame."""
        return [
            self.frame.place_from_utak(*place)
            for place in (*self.been, *(observation.place for observation in self.observations))
        ]

    @property
    def looked_from(self) -> frozenset[Square]:
        """Return the squares from which the observations of the present map were made: (column, row), map frame."""
        return self._looked_from(0)

    @property
    def looked_since(self) -> frozenset[Square]:
        """Return the squares from which observations were made since one left fields unexplained; map frame."""
        return self._looked_from(self.sound_since)

    def _looked_from(self, first: int) -> frozenset[Square]:
        """Return the squares from which the observations of the present map were made from a number on; map frame."""
        return frozenset((math.floor(x), math.floor(y)) for x, y in self.track[len(self.been) + first :])

    @property
    def passed(self) -> frozenset[Square]:
        """Return the squares through which the robot went on the present map: (column, row), map frame."""
        ways = enumerate(pairwise(self.track[len(self.been) :]), 1)
        walked = ((n, square) for n, way in ways if n not in self.lifted_at for square in squares_passed(*way))
        return frozenset(square for n, square in walked if n >= self.changed_at.get(square, 0))

    @property
    def leeway(self) -> tuple[float, float, float, float]:
        """Return how far the true origin of the frame may lie from the believed one: (west, south, east, north)."""
        return origin_leeway(self.frame, self.observations, self.frames)

    @property
    def place_doubt(self) -> float:
        """Return how far Utak may be from the believed place since it was lifted, in squares; 0 when it never was."""
        west, south, east, north = self.place_error
        return math.hypot(max(-west, east), max(-south, north))

    @property
    def off_middle(self) -> bool:
        """Return whether the believed origin of the frame is not exactly the middle of the square of waking."""
        return self.frame.origin != CENTRE

    @property
    def beside_line(self) -> bool:
        """Return whether a contact at a grid line has fixed the origin in one axis, but for the width of a contact."""
        return min(map(abs, self.leeway)) <= 2 * LINE_DISTANCE

    # -- certainty -------------------------------------------------------------------------------

    @property
    def lost(self) -> bool:
        """Return whether localisation has failed: observation after observation contradicts what is believed."""
        return sum(self.residuals) >= self.max_residual and sum(residual > 0 for residual in self.residuals) > 1

    @property
    def max_residual(self) -> int:
        """Return from how many residual fields on localisation has failed."""
        moved = any(held.proven for held in self.held_objects.values())
        return MAX_RESIDUAL_AFTER_MOVING if moved else MAX_RESIDUAL

    @property
    def spread(self) -> float:
        """Return the greatest difference between the believed orientation and one that is left, in radians."""
        return self._spread(self.frames)

    @property
    def likely_spread(self) -> float:
        """Return the greatest difference between the believed orientation and a plausible one left, in radians."""
        return self._spread(other for other in self.frames if other.prior_cost <= KEPT_ODDS)

    def _spread(self, hypotheses: Iterable[Hypothesis]) -> float:
        """Return the greatest difference in orientation between the believed frame and some hypotheses, in radians."""
        return math.radians(max((abs(other.angle - self.frame.angle) for other in hypotheses), default=0))

    @property
    def sure(self) -> bool:
        """Return whether what the counts settle is beyond doubt."""
        along = self.frame.angle == 0 and all(other.is_centred for other in self.frames)
        settled = not (self.shaken or self._askew_since_lift or any(map(self._is_elsewhere, self.ends)))
        return settled and (along or len(self.frames) == 1)

    @property
    def slips(self) -> bool:
        """Return whether motions of this robot end beside their predicted ends, as it knows from any map."""
        return self.slipped or self.unsteady

    @property
    def shaken(self) -> bool:
        """Return whether observations ever contradicted each other, or a motion ever ended beside its predicted end."""
        return self.slipped or self.occupancy.overruled > 0

    @property
    def _askew_since_lift(self) -> bool:
        """Return whether any look since the robot was put somewhere may have been made in another square."""
        looks = self.observations[max(self.lifted_at) :] if any(self.place_error) else ()
        return any(len(self.places_near(self.frame.place_from_utak(*look.place))) > 1 for look in looks)

    def _is_elsewhere(self, end: Hypothesis) -> bool:
        """Return whether the observation after a motion was made in another square if the motion ended elsewhere."""
        own = self.observations[end.since or 0].place
        places = self.frame.place_from_utak(*own), self.frame.place_from_utak(*add(own, end.shift))
        return len({(math.floor(x), math.floor(y)) for x, y in places}) > 1

    @property
    def frames(self) -> tuple[Hypothesis, ...]:
        """Return the hypotheses by which all motions ended as believed: the frames that are left."""
        return tuple(one for one in self.hypotheses if one.since is None)

    @property
    def ends(self) -> tuple[Hypothesis, ...]:
        """Return the hypotheses by which one of the last straight motions ended elsewhere than believed."""
        numbers = {motion.number for motion in self.reestimable}
        return tuple(one for one in self.hypotheses if one.since in numbers)

    def kept_end(self, since: int, shift: Position) -> Hypothesis | None:
        """Return the hypothesis by which everything since an observation lies elsewhere by a shift, or None."""
        near = [end for end in self.ends if end.since == since and math.dist(end.shift, shift) < 4 * LINE_DISTANCE]
        return min(near, key=lambda end: math.dist(end.shift, shift), default=None)

    def prior_cost(self, angle: int) -> float:
        """Return by how much the map prior of an orientation is worse than the best one, in log odds."""
        if angle == self.frame.angle:
            return 0.0
        return min((one.prior_cost for one in self.frames if one.angle == angle), default=UNTRIED_COST)

    # -- obstacles that contacts showed ----------------------------------------------------------

    @property
    def closed(self) -> frozenset[Square]:
        """Return the squares (column, row) of the map frame that stopped a motion, and so are (probably) occupied."""
        blocked = self.blocked_squares
        certain = set() if self.slipped else {square for square in blocked if not self._free_around(*square)}
        doubted = (blocked | self.suspected_squares) - certain
        return frozenset((*certain, *(s for s in doubted if self.occupancy.state[self.occupancy.index(*s)] == OPEN)))

    def _free_around(self, x: int, y: int) -> bool:
        """Return whether the square (x, y) of the map frame and its eight neighbours are settled as free."""
        row, column = self.occupancy.index(x, y)
        around = self.occupancy.state[max(row - 1, 0) : row + 2, max(column - 1, 0) : column + 2]
        return bool((around == FREE).all())

    # -- motions that may be re-estimated --------------------------------------------------------

    @property
    def reestimable(self) -> tuple[StraightMotion, ...]:
        """Return the last straight motions, oldest first, that can be re-estimated (may have other ends)."""
        return tuple(motion for motion in self.motions if motion.in_hand is None or motion.in_hand in self.held_objects)

    @property
    def earlier(self) -> tuple[StraightMotion, ...]:
        """Return the last straight motions whose observation has been integrated already, oldest first."""
        return tuple(motion for motion in self.reestimable if motion.number < len(self.observations))

    def is_beside_things(self, held: HeldObject) -> bool:
        """Return whether other things that were seen lie on an object's squares, or share an edge with them."""
        own = held.possible.squares()
        about = {(x + dx, y + dy) for x, y in own for dx, dy in ((0, 0), (1, 0), (-1, 0), (0, 1), (0, -1))}
        seen = (squares for name, squares in self.things.items() if name != held.name)
        held_before = (other.possible.squares() for other in self.others(held))
        return any(not about.isdisjoint(squares) for squares in (*seen, *held_before))

    def others(self, held: HeldObject) -> list[HeldObject]:
        """Return all objects that were ever held except the one of the name of `held`, where they lie, map frame."""
        return [other for other in self.held_objects.values() if other.name != held.name]
