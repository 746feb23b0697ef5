"""Contact hypotheses: what may have blocked a held object, and so where, by known obstacles and by open squares."""

import itertools
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from functools import cached_property, lru_cache
from typing import Any, NamedTuple

import numpy as np
import shapely

from utak.geometry.motion.first_contact import ContactBody, Obstacles
from utak.geometry.motion.se2 import Motion, Rotate
from utak.kb.localisation.hypotheses.carry_outcomes import CarryOutcome, advance, motion_length, partial_outcome
from utak.kb.localisation.hypotheses.frames import Position
from utak.kb.mapping.completions import Completions
from utak.kb.mapping.obstacle_chance import ObstacleChance
from utak.kb.mapping.occupancy import OCCUPIED, OPEN, OccupancyMap
from utak.kb.mapping.patch import patch_of_polygon
from utak.kb.objects.held_object import HeldObject, Square

LIKELIEST_ODDS_GAP = 1.0  # log odds within which squares count as the likeliest ones; tuned on random worlds
CONTACT_DISTANCE_ERROR = 0.25  # squares by which the place of a contact may be estimated wrongly; tuned
SAME_CONTACT_FRACTION = 1e-6  # fractions of a motion that differ by less are one contact: rounding
UNREACHED_MARGIN = 1e-3  # squares by which an obstacle must be out of reach to be left out: far above rounding
OBSTACLE_MARGIN = 3  # squares of the map around a motion that are taken as obstacles; more than a motion needs
NO_SQUARES: frozenset[Square] = frozenset()


class ContactHypothesis(NamedTuple):
    """A contact hypothesis: a motion ended where it met an obstacle."""

    fraction: float  # of the motion before the contact, 0 to 1
    chance: float  # the probability that it came so far, and no further
    # The likeliest of the open squares one of which is the obstacle then, (column, row) of the map frame; empty where
    # the obstacle is known
    squares: frozenset[Square] = NO_SQUARES


class Obstructions:
    """The obstacles, known and possible, that Utak and an object in hand may meet on a motion."""

    def __init__(
        self,
        occupancy: OccupancyMap,
        place: Position,
        polygon: Any,
        motion: Motion,
        pictures: Completions | None = None,
    ) -> None:
        """Find the obstacles about a motion."""
        known, self._squares = (_squares_near(occupancy, place, polygon, motion, state) for state in (OCCUPIED, OPEN))
        self.known = _obstacles(tuple(known))
        self._chance = ObstacleChance(occupancy, pictures)

    @cached_property
    def _open(self) -> list[tuple[Square, Obstacles]]:
        """Return each open square about the motion, (column, row) of the map frame, with the obstacle it may be."""
        return [(square, _obstacles((square,))) for square in self._squares]

    def contacts(self, place: Position, polygon: Any, motion: Motion) -> list[ContactHypothesis]:
        """Return all contacts that may have blocked the motion, in the order of the way; [] when nothing can be met."""
        body = ContactBody(polygon, [place])
        end = self.known.first_contact(body, motion)
        near = _are_reachable(self._squares, place, polygon, motion)
        open_ = ((square, obstacle) for (square, obstacle), reached in zip(self._open, near, strict=True) if reached)
        met = ((obstacle.first_contact(body, motion), square) for square, obstacle in open_)
        ordered = sorted(m for m in met if m[0] < end)
        groups = itertools.groupby(ordered, lambda m: round(m[0] / SAME_CONTACT_FRACTION))
        together = [[*group] for _, group in groups]
        chances = self._chance.met([[square for _, square in group] for group in together])
        contacts = [
            ContactHypothesis(
                group[0][0], chance, _likeliest_squares({square: self._chance.odds(square) for _, square in group})
            )
            for group, chance in zip(together, chances, strict=True)
        ]
        return [*contacts, ContactHypothesis(end, max(1.0 - sum(chances), 0.0))] if end < 1.0 else contacts


def likeliest_contact_near(
    contacts: Iterable[ContactHypothesis], place: Position, polygon: Any, motion: Motion, fraction: float
) -> ContactHypothesis | None:
    """Return the likeliest contact near a fraction of a motion; None when there is none."""
    far = CONTACT_DISTANCE_ERROR / motion_length(place, polygon, motion)
    about = [contact for contact in contacts if abs(contact.fraction - fraction) < far]
    return max(about, key=lambda contact: contact.chance, default=None)


def contact_outcomes(
    contacts: Iterable[ContactHypothesis], place: Position, polygon: Any, motion: Motion
) -> list[CarryOutcome]:
    """Return the outcomes of some contacts of a motion, all blocked, the likeliest first; [] for no contacts."""
    likely = sorted(contacts, key=lambda contact: -contact.chance)
    return [partial_outcome(place, polygon, motion, contact.fraction, contact.squares) for contact in likely]


def suspected_squares(
    outcome: CarryOutcome | None,
    motion: Motion,
    held: HeldObject,
    others: Iterable[HeldObject],
    occupancy: OccupancyMap,
) -> frozenset[Square]:
    """Return the likeliest of the open squares one of which blocked an object, or Utak with it."""
    # Else empty when nothing was blocked, when the object was never seen to move (the hand may be empty), or when
    # something known explains it.
    if outcome is not None and outcome.contact_squares:
        return outcome.contact_squares
    if outcome is None or not outcome.stopped or not held.proven:
        return NO_SQUARES
    place, polygon = advance(outcome.place, outcome.polygon, motion)
    there = patch_of_polygon(polygon).squares() | {(math.floor(place[0]), math.floor(place[1]))}
    there -= replace(held, polygon=outcome.polygon, full=NO_SQUARES, empty=NO_SQUARES).possible.squares()
    there.discard((math.floor(outcome.place[0]), math.floor(outcome.place[1])))
    state = {square: occupancy.state[occupancy.index(*square)] for square in there}
    if OCCUPIED in state.values() or any(there & other.possible.squares() for other in others):
        return NO_SQUARES
    odds = {square: float(occupancy.logit[occupancy.index(*square)]) for square in there if state[square] == OPEN}
    return _likeliest_squares(odds)


def square_polygon(square: Square) -> Any:
    """Return a square (column, row) of the map frame as a shapely Polygon of side 1, map frame."""
    x, y = square
    return shapely.box(x, y, x + 1, y + 1)


def _likeliest_squares(odds: Mapping[Square, float]) -> frozenset[Square]:
    """Return those squares whose log odds are within LIKELIEST_ODDS_GAP (1) of the highest; empty for none."""
    return frozenset(square for square, odd in odds.items() if odd >= max(odds.values()) - LIKELIEST_ODDS_GAP)


def _are_reachable(squares: Sequence[Square], place: Position, polygon: Any, motion: Motion) -> list[bool]:
    """Return for each square whether Utak or the object may meet it on a motion; False only where neither can."""
    corners, low = np.array([*shapely.get_coordinates(polygon), place]), np.array(squares, np.float64).reshape(-1, 2)
    if isinstance(motion, Rotate):  # every point keeps its distance from the centre of the turn
        far = np.hypot(*(corners - np.array(motion.about)).T).max() + UNREACHED_MARGIN
        nearest = np.clip(np.array(motion.about), low, low + 1.0) - np.array(motion.about)
        reached = np.hypot(*nearest.T) <= far
    else:
        ends = np.concatenate([corners, motion.points(corners)])
        high, below = ends.max(0) + UNREACHED_MARGIN, ends.min(0) - UNREACHED_MARGIN
        reached = ((low <= high) & (low + 1.0 >= below)).all(1)
    return list(map(bool, reached))


@lru_cache(maxsize=512)
def _obstacles(squares: tuple[Square, ...]) -> Obstacles:
    """Return squares (column, row) as obstacles, map frame; cached, for one frame after another asks for them."""
    return Obstacles([square_polygon(square) for square in squares])


def _squares_near(occupancy: OccupancyMap, place: Position, polygon: Any, motion: Motion, state: int) -> list[Square]:
    """Return the squares of one state within OBSTACLE_MARGIN (3) squares of the bounding box of a motion."""
    corners = np.array([*shapely.get_coordinates(polygon), place])
    if isinstance(motion, Rotate):
        reach = float(np.hypot(*(corners - np.array(place)).T).max())
        low, high = np.array(place) - reach, np.array(place) + reach
    else:
        ends = np.concatenate([corners, motion.points(corners)])
        low, high = ends.min(0), ends.max(0)
    row, column = occupancy.index(*(math.floor(v) - OBSTACLE_MARGIN for v in low))
    top, right = occupancy.index(*(math.ceil(v) + OBSTACLE_MARGIN for v in high))
    row, column = max(row, 0), max(column, 0)
    rows, columns = np.nonzero(occupancy.state[row:top, column:right] == state)
    west, south = columns + column + occupancy.west, rows + row + occupancy.south
    return list(zip(west.tolist(), south.tolist(), strict=True))
