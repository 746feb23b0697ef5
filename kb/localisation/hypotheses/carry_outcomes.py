"""Carry outcomes: what a push or a turn may have led to, for Utak and for the object in hand.

The motion may have gone as commanded, not at all (the hand was empty, or the object cannot be moved), as far as an
obstacle, or a little beside. kb/asp/accommodation.lp chooses.
"""

import math
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from utak.geometry.motion.first_contact import ContactBody, Obstacles
from utak.geometry.motion.se2 import Motion, Rotate, Translate
from utak.kb.localisation.hypotheses.frames import Position
from utak.kb.localisation.hypotheses.walk_outcomes import observation_places
from utak.kb.objects.held_object import Square
from utak.kb.objects.subcell_extent import SubcellExtent

END_SPACING = 0.25  # squares between the tried ends of a motion; a convention
CONTACT_REACH = 0.5  # squares ahead of a blocked body within which the obstacle stands; tuned on random worlds
MAX_OBJECT_SLIP = 1.0  # squares by which an object may end beside its predicted place, in each axis; tuned
MAX_TURN_SLIP = 6.0  # degrees by which a turn may end beside the predicted one; tuned
TURN_SLIPS_PER_DEGREE = 2  # tried turns for each degree of slip
_SLIP_STEPS = range(-round(MAX_OBJECT_SLIP / END_SPACING), round(MAX_OBJECT_SLIP / END_SPACING) + 1)
SLIP_OFFSETS = sorted(
    (math.hypot(i, j) * END_SPACING, i * END_SPACING, j * END_SPACING)
    for i in _SLIP_STEPS
    for j in _SLIP_STEPS
    if i or j
)  # (distance, dx, dy) in squares, the nearest first


class CarryOutcome(NamedTuple):
    """A possible outcome of a motion with an object in hand."""

    # Predicted; stuck (nothing moved); blocked (it ended early); slipped (it ended beside); smaller (as commanded, but
    # the object does not fill its squares); larger (as commanded, but there is more of the object than was seen);
    # parted (as commanded, but the object is only a part of what seemed one thing)
    how: str
    # Of Utak after it, (x, y) in squares, map frame; for an end on a grid line the side from which the observation is
    # made
    place: Position
    polygon: Any  # the outline of the object after it (shapely Polygon), map frame
    degrees: float  # by which the object was turned, counter-clockwise positive
    distance: float  # of the outermost point of the object from where it was predicted, along its path, in squares
    # The squares (column, row) of the map frame one of which blocked it; empty where what did is known
    contact_squares: frozenset[Square] = frozenset()
    # The sub-cell extent of the object (how far each side lies within the squares in which it was seen, as it lay when
    # first held), where another one is believed than before; else None
    insets: SubcellExtent | None = None

    @property
    def as_commanded(self) -> bool:
        """Return whether the motion went as commanded: predicted, smaller, larger or parted."""
        return self.how in ("predicted", "smaller", "larger", "parted")

    @property
    def stopped(self) -> bool:
        """Return whether the motion ended early (blocked), or did not begin (stuck)."""
        return self.how in ("stuck", "blocked")


def predicted_outcome(place: Position, polygon: Any, motion: Motion) -> CarryOutcome:
    """Return the outcome of the whole motion as commanded, at a distance of 0 from the predicted one."""
    return _outcome("predicted", place, polygon, motion, 0.0)


def blocked_by_known(place: Position, polygon: Any, motion: Motion, known: Obstacles) -> CarryOutcome | None:
    """Return the motion as far as its first contact with known obstacles; None when it meets none."""
    fraction = known.first_contact(ContactBody(polygon, [place]), motion)
    return partial_outcome(place, polygon, motion, fraction) if fraction < 1.0 else None


def partial_outcome(
    place: Position,
    polygon: Any,
    motion: Motion,
    fraction: float,
    contact_squares: frozenset[Square] = frozenset(),
) -> CarryOutcome:
    """Return the outcome of a motion that was blocked after a fraction of it."""
    distance = motion_length(place, polygon, motion) * (1.0 - fraction)
    outcome = _outcome("blocked", place, polygon, motion.part(fraction), distance)
    return outcome._replace(contact_squares=contact_squares)


def observed_from(outcome: CarryOutcome) -> list[CarryOutcome]:
    """Return an outcome once for each place from which the observation may be made after it."""
    return [outcome._replace(place=view) for view in observation_places(outcome.place)]


def advance(place: Position, polygon: Any, motion: Motion) -> tuple[Position, Any]:
    """Return Utak's place (x, y) and the outline of the object CONTACT_REACH (0.5) squares further on the motion."""
    length = motion_length(place, polygon, motion)
    outcome = _outcome(
        "predicted", place, polygon, motion.part(min(1.0, CONTACT_REACH / max(length, CONTACT_REACH))), 0.0
    )
    return outcome.place, outcome.polygon


def other_outcomes(place: Position, polygon: Any, motion: Motion) -> Iterator[CarryOutcome]:
    """Yield all outcomes but the commanded one, the likeliest of each kind first: stuck, blocked, slipped."""
    # Blocked ones come at steps of at most 0.25 squares, the furthest first; slipped ones the nearest to the commanded
    # end first (for a turn first those turned otherwise, by up to 6 degrees, then those shifted, by up to 1 square in
    # each axis).
    length = motion_length(place, polygon, motion)
    yield CarryOutcome("stuck", place, polygon, 0.0, length)
    steps = math.ceil(length / END_SPACING)
    for step in range(steps - 1, 0, -1):
        yield _outcome("blocked", place, polygon, motion.part(step / steps), length * (1 - step / steps))
    for other, distance in _slipped_motions(motion, length):
        yield _outcome("slipped", place, polygon, other, distance)
    if isinstance(motion, Rotate):
        # Where in the square of waking the origin lies is an assumption, and so is the centre of the turn.
        turned = motion.carry(polygon)
        for distance, dx, dy in SLIP_OFFSETS:
            yield CarryOutcome("slipped", place, Translate(dx, dy).carry(turned), motion.degrees, distance)


def motion_length(place: Position, polygon: Any, motion: Motion) -> float:
    """Return the length of the path of the outermost point of an object on a motion, in squares."""
    if isinstance(motion, Translate):
        return math.hypot(motion.dx, motion.dy)
    corners = np.array(polygon.exterior.coords) - np.array(place)
    return abs(math.radians(motion.degrees)) * float(np.hypot(*corners.T).max())


def _outcome(how: str, place: Position, polygon: Any, motion: Motion, distance: float) -> CarryOutcome:
    """Return the outcome of a motion that really happened: Utak's place and the object's outline after it."""
    if isinstance(motion, Translate):
        place = (place[0] + motion.dx, place[1] + motion.dy)
    degrees = motion.degrees if isinstance(motion, Rotate) else 0.0
    return CarryOutcome(how, place, motion.carry(polygon), degrees, distance)


def _slipped_motions(motion: Motion, length: float) -> list[tuple[Motion, float]]:
    """Return motions a little beside a motion, each with the distance of its end from the commanded one, in squares."""
    if isinstance(motion, Rotate):
        per_degree = length / max(abs(motion.degrees), 1.0)
        number = round(TURN_SLIPS_PER_DEGREE * MAX_TURN_SLIP)
        slips = [sign * step / TURN_SLIPS_PER_DEGREE for step in range(1, number + 1) for sign in (1, -1)]
        return [(motion._replace(degrees=motion.degrees + d), abs(d) * per_degree) for d in slips]
    return [(Translate(motion.dx + dx, motion.dy + dy), distance) for distance, dx, dy in SLIP_OFFSETS]
