"""What is held true of the pose, the lattice and the map, and what follows from it.

How it is made to agree with every new impression is for kb.localisation.accommodation.
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass, field

from kb.localisation.hypotheses.explanation import Explanation
from kb.localisation.hypotheses.frames import CENTRED, Box, FrameHypothesis, Observation, leeway
from kb.localisation.hypotheses.walk_outcomes import HAIR, MotionHypothesis
from kb.mapping.completions import Completions
from kb.mapping.occupancy import FREE, OPEN, OccupancyMap
from kb.objects.held_object import HeldObject
from kb.perception.frame import CENTRE, Frame

RECENT = 4  # looks by which he tells that he is lost
LOST = 8  # misfits, of these looks
ASTRAY = 24  # so many once he has moved a thing, which may just lie otherwise than he believes
DOUBTED = 0.05  # how likely one of his last motions ended elsewhere, and nothing is sure
Place = tuple[float, float]


@dataclass
class Holding:
    """All that is held true of the pose and the map.

    place is a point of the lattice; looks keep where each impression was received, in Utak's own frame. loads are the
    things that he has held, by name, and held the one that he holds. moved : his last straight motions, which may have
    ended otherwise than believed. barred : squares before which he was stopped himself; suspected : those of
    which one stopped what he carried, for all that was known. unfit : misfits of each of the last looks. been : where
    looks were received, in his own frame, before he began anew. ended : where the newest motion may have ended by the
    look after it, if it came upon anything. pictures : the last ones of the map on this lattice, if any were drawn.
    """

    occupancy: OccupancyMap = field(default_factory=OccupancyMap)
    frame: Frame = field(default_factory=Frame)
    place: Place = CENTRE
    observations: list[Observation] = field(default_factory=list)
    hypotheses: tuple[FrameHypothesis, ...] = CENTRED
    trust: int = 0
    barred: set[tuple[int, int]] = field(default_factory=set)
    suspected: set[tuple[int, int]] = field(default_factory=set)
    searches: int = 0
    slipped: bool = False
    moved: tuple[MotionHypothesis, ...] = ()
    loads: dict[str, HeldObject] = field(default_factory=dict)
    held: str | None = None
    unfit: tuple[int, ...] = ()
    been: tuple[Place, ...] = ()
    ended: tuple[Explanation, ...] = ()
    pictures: Completions | None = None

    @property
    def lost(self) -> bool:
        """Does what he sees agree with nothing that he believes, look after look?"""
        most = ASTRAY if any(load.proven for load in self.loads.values()) else LOST
        return sum(self.unfit) >= most and sum(unfit > 0 for unfit in self.unfit) > 1

    @property
    def square(self) -> tuple[int, int]:
        """The square of the lattice on which Utak stands."""
        return math.floor(self.place[0]), math.floor(self.place[1])

    @property
    def track(self) -> list[Place]:
        """Where he has been, as points of the lattice."""
        return [
            self.frame.place_from_utak(*place)
            for place in (*self.been, *(observation.place for observation in self.observations))
        ]

    @property
    def looked_from(self) -> frozenset[tuple[int, int]]:
        """The squares on which an impression was received that he has not forgotten."""
        return frozenset((math.floor(x), math.floor(y)) for x, y in self.track[len(self.been) :])

    @property
    def spread(self) -> float:
        """By how many radians the angles that still stand differ from the believed one, at most."""
        return self._spread(self.hypotheses)

    @property
    def likely_spread(self) -> float:
        """The same of those on which the table is hardly less plain than on any other."""
        return self._spread(other for other in self.hypotheses if other.is_plausible)

    def _spread(self, hypotheses: Iterable[FrameHypothesis]) -> float:
        return math.radians(max((abs(other.angle - self.frame.angle) for other in hypotheses), default=0))

    @property
    def closed(self) -> frozenset[tuple[int, int]]:
        """The squares on which something stands, or likely does, for it stopped a motion.

        Not those that are seen to be free, by one who slips and may have stopped by himself, or with all about them:
        then it was believed wrongly that he was stopped, or where.
        """
        sure = set() if self.slipped else {square for square in self.barred if not self._free_about(*square)}
        doubted = (self.barred | self.suspected) - sure
        return frozenset((*sure, *(s for s in doubted if self.occupancy.state[self.occupancy.index(*s)] == OPEN)))

    def _free_about(self, x: int, y: int) -> bool:
        """Are a square of the lattice and the eight about it seen to be free?"""
        row, column = self.occupancy.index(x, y)
        about = self.occupancy.state[max(row - 1, 0) : row + 2, max(column - 1, 0) : column + 2]
        return bool((about == FREE).all())

    @property
    def _off_middle(self) -> bool:
        """Has it turned out that he did not wake amid his square?"""
        return self.frame.origin != CENTRE

    @property
    def _beside_line(self) -> bool:
        """Was he stopped beside a line, which tells where he stands but for a hair?"""
        return min(map(abs, self.leeway)) <= 2 * HAIR

    @property
    def leeway(self) -> Box:
        """How far from where he believes it he may have woken: to the west and south (not above 0), east and north."""
        return leeway(self.frame, self.observations, self.hypotheses)

    @property
    def sure(self) -> bool:
        """Is what the counts settle beyond doubt?

        Not when a look contradicted another one or a motion ended beside where it should, nor while it is open where
        one of his last motions ended, while several places in his square are left at which he may have woken, or
        several angles none of which is that of his own axes.
        """
        along = self.frame.angle == 0 and all(other.is_centred for other in self.hypotheses)
        told = not (self.shaken or any(map(self._elsewhere_likely, self.moved)))
        return told and (along or len(self.hypotheses) == 1)

    @property
    def shaken(self) -> bool:
        """Did a look contradict another one, or a motion end beside where it should?"""
        return self.slipped or self.occupancy.overruled > 0

    def _elsewhere_likely(self, motion: MotionHypothesis) -> bool:
        """Did a motion likely end in another square than is believed, by the look after it?"""
        if motion.number >= len(self.observations):
            return False
        places = [self.observations[motion.number].place, *motion.likely(DOUBTED)]
        squares = {(math.floor(x), math.floor(y)) for x, y in (self.frame.place_from_utak(*own) for own in places)}
        return len(squares) > 1

    @property
    def tellable(self) -> tuple[MotionHypothesis, ...]:
        """The last straight motions that can be told again: alone, or with a thing that is still known, in hand."""
        return tuple(motion for motion in self.moved if motion.load is None or motion.load in self.loads)

    @property
    def in_doubt(self) -> tuple[MotionHypothesis, ...]:
        """Those that likely ended elsewhere than is believed."""
        return tuple(motion for motion in self.earlier if motion.likely(DOUBTED))

    @property
    def earlier(self) -> tuple[MotionHypothesis, ...]:
        """Those of them after which a look was taken in already."""
        return tuple(motion for motion in self.tellable if motion.number < len(self.observations))
