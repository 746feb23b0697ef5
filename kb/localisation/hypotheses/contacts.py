"""What stopped a thing that Utak carried, and so where: at what is known to stand in its way, or what likely does."""

import itertools
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from functools import cached_property, lru_cache
from typing import Any, NamedTuple

import numpy as np
import shapely

from geometry.motion.first_contact import ContactBody, Obstacles
from geometry.motion.se2 import Motion, Rotate
from kb.localisation.hypotheses.carry_outcomes import Outcome, ahead, length_of, part_way
from kb.mapping.completions import Completions
from kb.mapping.obstacle_chance import ObstacleChance
from kb.mapping.occupancy import FULL, OPEN, OccupancyMap
from kb.mapping.patch import covered
from kb.objects.held_object import HeldObject, Square

Place = tuple[float, float]

ALIKE = 1.0  # log odds by which the likeliest squares may differ
NEARLY = 0.25  # squares by which the place at which it was stopped may be told wrongly
TOGETHER = 1e-6  # parts of a motion by which squares that are met at once may differ
HAIR = 1e-3  # squares by which what is surely not met must be further away
ROOM = 3  # squares about a motion in which something may stop it
NOTHING: frozenset[Square] = frozenset()


class ContactHypothesis(NamedTuple):
    """That a motion ended where it met something.

    part : of the motion, 0 to 1, that was gone. chance : how likely it is that it went so far, and no further.
    against : the open squares one of which stands there then, the likeliest ones; none where it is known what does.
    """

    part: float
    chance: float
    against: frozenset[Square] = NOTHING


class Obstructions:
    """What stands, or may stand, where a thing and Utak come on a motion.

    evidence : of the squares about. place, polygon : of Utak and of the thing before it. pictures : of the map.
    """

    def __init__(
        self, occupancy: OccupancyMap, place: Place, polygon: Any, motion: Motion, pictures: Completions | None = None
    ) -> None:
        known, self._squares = (_there(occupancy, place, polygon, motion, state) for state in (FULL, OPEN))
        self.walls = _obstacles(tuple(known))
        self._outlook = ObstacleChance(occupancy, pictures)

    @cached_property
    def _open(self) -> list[tuple[Square, Obstacles]]:
        """Each open square as an obstacle of its own."""
        return [(square, _obstacles((square,))) for square in self._squares]

    def stops(self, place: Place, polygon: Any, motion: Motion) -> list[ContactHypothesis]:
        """Where the motion may have been stopped, in its order, and what speaks for each.

        place, polygon : where it began, about as this was made for.
        """
        body = ContactBody(polygon, [place])
        end = self.walls.first_contact(body, motion).fraction
        near = _reachable(self._squares, place, polygon, motion)
        open_ = ((square, obstacle) for (square, obstacle), reached in zip(self._open, near, strict=True) if reached)
        met = ((obstacle.first_contact(body, motion).fraction, square) for square, obstacle in open_)
        ordered = sorted(m for m in met if m[0] < end)
        together = [[*group] for _, group in itertools.groupby(ordered, lambda m: round(m[0] / TOGETHER))]
        chances = self._outlook.met([[square for _, square in group] for group in together])
        stops = [
            ContactHypothesis(
                group[0][0], chance, _likeliest({square: self._outlook.odds(square) for _, square in group})
            )
            for group, chance in zip(together, chances, strict=True)
        ]
        return [*stops, ContactHypothesis(end, max(1.0 - sum(chances), 0.0))] if end < 1.0 else stops

    def ends(self, place: Place, polygon: Any, motion: Motion) -> list[Outcome]:
        """What the stops would have led to, the likeliest first."""
        return led_to(self.stops(place, polygon, motion), place, polygon, motion)


def near(
    stops: Iterable[ContactHypothesis], place: Place, polygon: Any, motion: Motion, part: float
) -> ContactHypothesis | None:
    """The likeliest of some stops about where a motion seems to have ended; None when there is nothing near."""
    far = NEARLY / length_of(place, polygon, motion)
    about = [stop for stop in stops if abs(stop.part - part) < far]
    return max(about, key=lambda stop: stop.chance, default=None)


def led_to(stops: Iterable[ContactHypothesis], place: Place, polygon: Any, motion: Motion) -> list[Outcome]:
    """What stops of a motion would have led to, the likeliest first."""
    likely = sorted(stops, key=lambda stop: -stop.chance)
    return [part_way(place, polygon, motion, stop.part, stop.against) for stop in likely]


def suspects(
    outcome: Outcome | None, motion: Motion, load: HeldObject, others: Iterable[HeldObject], occupancy: OccupancyMap
) -> frozenset[Square]:
    """The open squares (of the lattice) one of which likely stopped a load, or Utak with it; the likeliest ones alone.

    None when it was not stopped, never moved before (then the hand may be empty), or what is known explains it.
    motion : as it was commanded. others : the other things that were moved, where they lie.
    """
    if outcome is not None and outcome.against:
        return outcome.against
    if outcome is None or not outcome.stopped or not load.proven:
        return NOTHING
    place, polygon = ahead(outcome.place, outcome.polygon, motion)
    there = covered(polygon).squares() | {(math.floor(place[0]), math.floor(place[1]))}
    there -= replace(load, polygon=outcome.polygon, full=NOTHING, empty=NOTHING).possible.squares()
    there.discard((math.floor(outcome.place[0]), math.floor(outcome.place[1])))
    state = {square: occupancy.state[occupancy.index(*square)] for square in there}
    if FULL in state.values() or any(there & other.possible.squares() for other in others):
        return NOTHING
    odds = {square: float(occupancy.logit[occupancy.index(*square)]) for square in there if state[square] == OPEN}
    return _likeliest(odds)


def _likeliest(odds: Mapping[Square, float]) -> frozenset[Square]:
    """Of squares with the log odds that they are occupied the likeliest."""
    return frozenset(square for square, odd in odds.items() if odd >= max(odds.values()) - ALIKE)


def _reachable(squares: Sequence[Square], place: Place, polygon: Any, motion: Motion) -> list[bool]:
    """Which squares a thing and Utak may meet on a motion; the others they surely do not."""
    corners, low = np.array([*shapely.get_coordinates(polygon), place]), np.array(squares, np.float64).reshape(-1, 2)
    if isinstance(motion, Rotate):  # all stays as far from him as it was
        far = np.hypot(*(corners - np.array(motion.about)).T).max() + HAIR
        nearest = np.clip(np.array(motion.about), low, low + 1.0) - np.array(motion.about)
        reached = np.hypot(*nearest.T) <= far
    else:
        ends = np.concatenate([corners, motion.points(corners)])
        reached = ((low <= ends.max(0) + HAIR) & (low + 1.0 >= ends.min(0) - HAIR)).all(1)
    return list(map(bool, reached))


@lru_cache(maxsize=512)
def _obstacles(squares: tuple[Square, ...]) -> Obstacles:
    """Squares of the lattice as obstacles; kept, for one lattice after another asks for the same ones."""
    return Obstacles([box_of(square) for square in squares])


def _there(occupancy: OccupancyMap, place: Place, polygon: Any, motion: Motion, state: int) -> list[Square]:
    """The squares of a state to which a thing and Utak may come on a motion."""
    corners = np.array([*shapely.get_coordinates(polygon), place])
    if isinstance(motion, Rotate):
        reach = float(np.hypot(*(corners - np.array(place)).T).max())
        low, high = np.array(place) - reach, np.array(place) + reach
    else:
        ends = np.concatenate([corners, motion.points(corners)])
        low, high = ends.min(0), ends.max(0)
    row, column = occupancy.index(*(math.floor(v) - ROOM for v in low))
    top, right = occupancy.index(*(math.ceil(v) + ROOM for v in high))
    row, column = max(row, 0), max(column, 0)
    rows, columns = np.nonzero(occupancy.state[row:top, column:right] == state)
    west, south = columns + column + occupancy.west, rows + row + occupancy.south
    return list(zip(west.tolist(), south.tolist(), strict=True))


def box_of(square: Square) -> Any:
    """A square of the lattice, as a shapely polygon."""
    x, y = square
    return shapely.box(x, y, x + 1, y + 1)
