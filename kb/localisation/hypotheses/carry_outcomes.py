"""What may have come of a push or a turn with something in hand: where Utak and his load may be now.

It may have gone as predicted, not at all (nothing was in his hand, or it cannot be moved), as far as something stood in
the way, or a little otherwise. Which of these is believed is for kb/asp/accommodation.lp.
"""

import math
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from geometry.motion.first_contact import ContactBody, Obstacles
from geometry.motion.se2 import Motion, Rotate, Translate
from kb.objects.subcell_extent import SubcellExtent

Place = tuple[float, float]
STRIDE = 0.25  # squares between places at which a motion may have ended
AHEAD = 0.5  # squares in front of what was stopped in which something stands
ASTRAY = 1.0  # squares by which a load may end beside the predicted place
ASKEW = 6.0  # degrees by which a turn may end beside the predicted one
STEPS = range(-round(ASTRAY / STRIDE), round(ASTRAY / STRIDE) + 1)
OFFSETS = sorted((math.hypot(i, j) * STRIDE, i * STRIDE, j * STRIDE) for i in STEPS for j in STEPS if i or j)


class Outcome(NamedTuple):
    """What a motion may have led to.

    how : predicted, stuck, blocked, slipped, or smaller: it went as predicted, but the load does not fill its squares;
    or larger: likewise, but there is more of it than was seen.
    place : of Utak; polygon : of the load, both on the lattice. degrees : by which the load was turned. distance : from
    what was predicted, in squares. against : the squares one of which stopped it, if it is open what stands there.
    insets : of the load, where that is believed otherwise.
    """

    how: str
    place: Place
    polygon: Any
    degrees: float
    distance: float
    against: frozenset[tuple[int, int]] = frozenset()
    insets: SubcellExtent | None = None

    @property
    def as_commanded(self) -> bool:
        """Did the motion go as it was commanded?"""
        return self.how in ("predicted", "smaller", "larger")

    @property
    def stopped(self) -> bool:
        """Did the motion end early, or not begin?"""
        return self.how in ("stuck", "blocked")


def predicted(place: Place, polygon: Any, motion: Motion) -> Outcome:
    """The motion as it was commanded."""
    return _after("predicted", place, polygon, motion, 0.0)


def arrested(place: Place, polygon: Any, motion: Motion, walls: Obstacles) -> Outcome | None:
    """The motion as far as what is known to stand in the way lets it go; None when nothing does."""
    fraction = walls.first_contact(ContactBody(polygon, [place]), motion).fraction
    return part_way(place, polygon, motion, fraction) if fraction < 1.0 else None


def part_way(
    place: Place, polygon: Any, motion: Motion, part: float, against: frozenset[tuple[int, int]] = frozenset()
) -> Outcome:
    """A part of a motion, from 0 to 1, after which it was stopped."""
    distance = length_of(place, polygon, motion) * (1.0 - part)
    return _after("blocked", place, polygon, motion.part(part), distance)._replace(against=against)


def ahead(place: Place, polygon: Any, motion: Motion) -> tuple[Place, Any]:
    """Where Utak and his load would be a little further on the way: what stopped them stands there."""
    part = min(1.0, AHEAD / max(length_of(place, polygon, motion), AHEAD))
    outcome = _after("predicted", place, polygon, motion.part(part), 0.0)
    return outcome.place, outcome.polygon


def otherwise(place: Place, polygon: Any, motion: Motion) -> Iterator[Outcome]:
    """All else that may have happened, the likeliest of each kind first."""
    length = length_of(place, polygon, motion)
    yield Outcome("stuck", place, polygon, 0.0, length)
    steps = math.ceil(length / STRIDE)
    for step in range(steps - 1, 0, -1):
        yield _after("blocked", place, polygon, motion.part(step / steps), length * (1 - step / steps))
    for other, distance in _beside(motion, length):
        yield _after("slipped", place, polygon, other, distance)
    if isinstance(motion, Rotate):
        # Where in his square he stands he only assumes, and so what exactly the turn was about.
        turned = motion.carry(polygon)
        for distance, dx, dy in OFFSETS:
            yield Outcome("slipped", place, Translate(dx, dy).carry(turned), motion.degrees, distance)


def _after(how: str, place: Place, polygon: Any, motion: Motion, distance: float) -> Outcome:
    if isinstance(motion, Translate):
        place = (place[0] + motion.dx, place[1] + motion.dy)
    degrees = motion.degrees if isinstance(motion, Rotate) else 0.0
    return Outcome(how, place, motion.carry(polygon), degrees, distance)


def length_of(place: Place, polygon: Any, motion: Motion) -> float:
    """How far the outermost point of a load goes on a motion, in squares."""
    if isinstance(motion, Translate):
        return math.hypot(motion.dx, motion.dy)
    corners = np.array(polygon.exterior.coords) - np.array(place)
    return abs(math.radians(motion.degrees)) * float(np.hypot(*corners.T).max())


def _beside(motion: Motion, length: float) -> list[tuple[Motion, float]]:
    """Motions a little other than a motion, by how far they end from it."""
    if isinstance(motion, Rotate):
        per_degree = length / max(abs(motion.degrees), 1.0)
        askew = [sign * step * 0.5 for step in range(1, round(2 * ASKEW) + 1) for sign in (1, -1)]
        return [(motion._replace(degrees=motion.degrees + d), abs(d) * per_degree) for d in askew]
    return [(Translate(motion.dx + dx, motion.dy + dy), distance) for distance, dx, dy in OFFSETS]
