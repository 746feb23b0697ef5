"""Accommodation: the believed pose, the angle of the lattice and the map, made to agree with every new impression.

From the command the pose is predicted. When the impression cannot have been received there, explanations are gathered (the motion was blocked, it
ended beside the predicted place, the lattice lies at another angle) and kb/asp/accommodation.lp chooses the cheapest. Then the impression
is taken into the evidence. Each of the 160 cells ends as predicted, as explained (it shows squares not settled before), or as noise.
"""

import math
from dataclasses import dataclass, field
from enum import StrEnum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kb.body import Command, Impression, Move, Push
from kb.encodings import KB, solve
from kb.evidence import OPEN, Evidence
from kb.heading import ANGLES, Look, believed, contradictions, standing
from kb.lattice import WOKE, Lattice
from kb.retina import FIELDS, count_ranges

MEMORY = 12  # looks by which angles are judged: those that contradict older looks are gone already
NEAR = 2  # squares about the predicted place in which Utak is looked for first
Place = tuple[float, float]


class CellStatus(StrEnum):
    """How a cell of the impression is accounted for."""

    PREDICTED = "predicted"
    EXPLAINED = "explained"
    NOISE = "noise"


class Explanation(NamedTuple):
    """A pose that may have given rise to the impression. place: a point of the lattice at that angle."""

    how: str
    place: Place
    angle: int
    misfits: int
    distance: float


class Accommodated(NamedTuple):
    """What one impression led to. cells: a CellStatus for each of the 160 fields."""

    explanation: Explanation
    cells: tuple[CellStatus, ...]


@dataclass
class Memory:
    """All that is held true of the pose and the map. One of the few places with state.

    place is a point of the lattice; looks keep where each impression was received, in Utak's own frame.
    """

    evidence: Evidence = field(default_factory=Evidence)
    lattice: Lattice = field(default_factory=Lattice)
    place: Place = WOKE
    looks: list[Look] = field(default_factory=list)
    angles: tuple[int, ...] = ANGLES
    trust: int = 0

    @property
    def square(self) -> tuple[int, int]:
        """The square of the lattice on which Utak stands."""
        return math.floor(self.place[0]), math.floor(self.place[1])

    @property
    def spread(self) -> float:
        """By how many radians the angles that still stand differ from the believed one, at most."""
        return math.radians(max((abs(a - self.lattice.angle) for a in self.angles), default=0))

    def wake(self, impression: Impression) -> Accommodated:
        """Take in the first impression."""
        return self._accommodate(impression, self.place, ())

    def accommodate(self, command: Command, impression: Impression) -> Accommodated:
        """Take in the impression that followed a command."""
        shift = (0.0, 0.0)
        if isinstance(command, Move | Push):
            shift = self.lattice.to_lattice(command.east, command.north)
        x, y = self.place
        return self._accommodate(impression, (x + shift[0], y + shift[1]), _along((x, y), shift))

    # -- explaining ------------------------------------------------------------------------------

    def _accommodate(self, impression: Impression, predicted: Place, stops: tuple[Place, ...]) -> Accommodated:
        ranges = count_ranges(impression.retina)
        explanation = self._explain(ranges, predicted, stops)
        if explanation.angle != self.lattice.angle:
            self._turn(explanation.angle)
        if explanation.how in ("predicted", "turned"):
            self.trust += 1
        x, y = math.floor(explanation.place[0]), math.floor(explanation.place[1])
        cells = self._statuses(ranges, x, y)
        self.place = explanation.place
        self.looks.append(Look(ranges, self.lattice.place_to_utak(*self.place)))
        self.evidence.look(self.lattice.samples(), ranges, x, y, len(self.looks) - 1)
        if explanation.how != "blocked":
            self.evidence.stand(x, y, len(self.looks) - 1)
        return Accommodated(explanation, cells)

    def _explain(self, ranges: NDArray[np.int16], predicted: Place, stops: tuple[Place, ...]) -> Explanation:
        look = Look(ranges, self.lattice.place_to_utak(*predicted))
        recent = [*self.looks[-MEMORY:], look]
        left = standing(self.angles, recent)
        first = self._explanation("predicted", predicted, ranges, predicted)
        if self.lattice.angle in left and not first.misfits:
            self.angles = left
            return first
        explanations = [first]
        if left:
            angle = believed(left, self.lattice.angle)
            place = Lattice(angle).place_from_utak(*look.place)
            explanations.append(Explanation("turned", place, angle, contradictions(angle, recent), 0.0))
        explanations += [self._explanation("blocked", stop, ranges, predicted) for stop in stops]
        explanations += [self._explanation("slipped", place, ranges, predicted) for place in _around(predicted)]
        chosen = self._choose(explanations)
        if chosen.how == "turned":
            self.angles = left
        return chosen

    def _explanation(self, how: str, place: Place, ranges: NDArray[np.int16], predicted: Place) -> Explanation:
        x, y = math.floor(place[0]), math.floor(place[1])
        misfits = int(self.evidence.misfits(self.lattice.samples(), ranges, x, y).sum())
        return Explanation(how, place, self.lattice.angle, misfits, math.dist(place, predicted))

    def _choose(self, explanations: list[Explanation]) -> Explanation:
        facts = [
            f"explanation({number},{e.how},{e.misfits},{math.ceil(e.distance)})"
            for number, e in enumerate(explanations)
        ]
        answer = solve([KB / "accommodation.lp"], [*facts, f"trust({self.trust})"])
        if not answer:
            raise AssertionError("accommodation.lp always has an answer")
        return explanations[answer[0].arguments[0].number]

    def _turn(self, angle: int) -> None:
        """Believe another angle, and build the map anew from all looks."""
        self.lattice = Lattice(angle)
        self.evidence = Evidence()
        for number, look in enumerate(self.looks):
            x, y = self.lattice.place_from_utak(*look.place)
            self.evidence.look(self.lattice.samples(), look.ranges, math.floor(x), math.floor(y), number)
            self.evidence.stand(math.floor(x), math.floor(y), number)

    def _statuses(self, ranges: NDArray[np.int16], x: int, y: int) -> tuple[CellStatus, ...]:
        samples = self.lattice.samples()
        noise = self.evidence.misfits(samples, ranges, x, y)
        row, column = self.evidence.index(x, y)
        state = self.evidence.state[samples.rows + row, samples.columns + column]
        new = ((state == OPEN) & (samples.weight > 0)).any(1)
        return tuple(
            CellStatus.NOISE if noise[i] else CellStatus.EXPLAINED if new[i] else CellStatus.PREDICTED
            for i in range(len(FIELDS))
        )


def _along(start: Place, shift: tuple[float, float]) -> tuple[Place, ...]:
    """Places at which a motion may have been stopped, the last first, a square's side apart."""
    length = math.hypot(*shift)
    steps = math.ceil(length)
    parts = [i / steps for i in range(steps - 1, -1, -1)] if steps else []
    return tuple((start[0] + shift[0] * t, start[1] + shift[1] * t) for t in parts)


def _around(place: Place) -> tuple[Place, ...]:
    """The places within NEAR squares of a place, by distance; the place itself is not among them."""
    reach = range(-NEAR, NEAR + 1)
    offsets = sorted((i * i + j * j, i, j) for i in reach for j in reach if i or j)
    return tuple((place[0] + i, place[1] + j) for _, i, j in offsets)


