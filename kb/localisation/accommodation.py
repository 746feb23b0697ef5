"""Accommodation: the believed pose, the angle of the lattice and the map, made to agree with every new impression.

From the command the pose is predicted. When the impression cannot have been received there, explanations are gathered
(the motion was blocked, it ended beside the predicted place, the lattice lies at another angle) and
kb/asp/accommodation.lp chooses the cheapest. Then the impression is taken into the evidence. Each of the 160 cells ends
as predicted, as explained (it shows squares not settled before), or as noise. Who is lost forgets, and begins anew.
"""

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from kb.body import Command, Impression, Move, Push, Release, Turn
from kb.localisation.after_carry import Carried
from kb.localisation.after_walk import Walked
from kb.localisation.holding import RECENT
from kb.localisation.hypotheses.explanation import Accommodated, Explanation, statuses
from kb.localisation.hypotheses.frames import ANYWHERE, Observation
from kb.localisation.hypotheses.remap import laid
from kb.localisation.hypotheses.walk_outcomes import MotionHypothesis, amid, ends, next_square, views
from kb.localisation.hypotheses.what_if import as_motion
from kb.localisation.score import Place
from kb.mapping.occupancy import FREE, FULL, OccupancyMap
from kb.objects.held_object import ROUNDING, HeldObject, discounted
from kb.perception.retina import count_ranges

REMEMBERED = 12  # motions that may turn out to have been stopped


@dataclass
class Memory(Walked, Carried):
    """What is held true, kept up to date: one of the few places with state."""

    def anew(self) -> "Memory":
        """The memory of one who begins anew with what he sees next, for he is lost, or gives up what was contradicted.

        In his own frame he goes on from where he believes himself, so that he knows about where he came from. That he
        slips he takes no longer from what he has forgotten.
        """
        been = (*self.been, *(observation.place for observation in self.observations[:-1]))
        return Memory(OccupancyMap(), self.frame, self.place, hypotheses=ANYWHERE, been=been)

    def wake(self, impression: Impression) -> Accommodated:
        """Take in the first impression."""
        return self._accommodate(impression, self.place, ())

    def accommodate(self, command: Command, impression: Impression) -> Accommodated:
        """Take in the impression that followed a command."""
        self.ended = ()
        if self.held is not None and isinstance(command, Push | Turn):
            return self._carry(impression, self.loads[self.held], command)
        if isinstance(command, Release):
            self.held = None
        shift = (0.0, 0.0)
        if isinstance(command, Move) and self.held is None:
            shift = self.frame.to_lattice(command.east, command.north)
        x, y = self.place
        return self._accommodate(impression, (x + shift[0], y + shift[1]), ends((x, y), shift), command)

    def grasp(self, load: HeldObject) -> None:
        """Believe that a thing is in hand: what is new as a load is taken out of the standing map.

        A thing lies on the floor, so there is floor under it.
        """
        if load.name not in self.loads:
            self._take_out(load)
        self.loads.setdefault(load.name, replace(load, since=len(self.observations)))
        self.held = load.name

    def _take_out(self, load: HeldObject) -> None:
        """Believe that there is floor where a load lies."""
        patch = load.possible
        self.occupancy.declare(
            self.occupancy.squares(patch.west, patch.south, patch.mask), FREE, len(self.observations) - 1
        )

    def _carry(self, impression: Impression, load: HeldObject, command: Push | Turn) -> Accommodated:
        """Take in the impression that followed a push or a turn with a load in hand."""
        ranges, motion = count_ranges(impression.retina), as_motion(command, self.frame, self.place)
        if isinstance(command, Turn) and self._beside_line:
            load = self.loads[load.name] = replace(load, astray=max(load.astray, ROUNDING))
        chosen = self._came_of(self._surprise(command, ranges), load, motion)
        if isinstance(command, Push):
            self._remember(command, load.name)
            self._doubt(chosen)
        self._lie(chosen)
        if chosen.larger is not None:
            self._take_out(chosen.larger)
            self.loads[load.name] = chosen.larger
        self._carried(self.loads[load.name], chosen, as_motion(command, self.frame, self.place), ranges)
        self.place = chosen.place
        if chosen.outcome is not None and chosen.outcome.as_commanded:
            carried = self.loads[load.name]
            self.loads[load.name] = self._told(carried, ranges, self.place) or carried
        self._stray(ranges)
        return self._take_in(chosen, ranges)

    def _accommodate(
        self, impression: Impression, predicted: Place, stops: tuple[Place, ...], command: Command | None = None
    ) -> Accommodated:
        ranges = count_ranges(impression.retina)
        if stops and isinstance(command, Move):
            self._remember(command)
        explanation = self._explain(ranges, predicted, stops, command)
        self._doubt(explanation)
        self._lie(explanation)
        self.trust = self.trust + 1 if explanation.how == "predicted" else self.trust * (explanation.chance is not None)
        if explanation.how == "slipped":
            self.slipped, self.moved = True, ()
        elif explanation.how in ("blocked", "misled"):
            since = len(self.observations) if explanation.retold is None else explanation.retold.correction.since
            self.moved = tuple(m._replace(stopped=True) if m.number == since else m for m in self.moved)
        if explanation.how == "blocked" or explanation.place == self.place != predicted:
            self.barred |= explanation.against or {next_square(explanation.place, predicted)}
        return self._take_in(explanation, ranges)

    def _standing(self, place: Place) -> Place:
        """Where he stands who looks from a place: on the near side of the line on which something stopped him."""
        sides = [place, *views(place)]
        squares = [(math.floor(x), math.floor(y)) for x, y in sides]
        free = (self.occupancy.state[self.occupancy.index(*s)] != FULL and s not in self.barred for s in squares)
        return amid(next((side for side, can_stand in zip(sides, free, strict=True) if can_stand), place))

    def _remember(self, command: Move | Push, load: str | None = None) -> None:
        """A motion that is looked at next may turn out to have ended otherwise. load : the name of what is in hand."""
        motion = MotionHypothesis(len(self.observations), (command.east, command.north), self.hypotheses, load=load)
        self.moved = (*self.moved[1 - REMEMBERED :], motion)

    def _take_in(self, explanation: Explanation, ranges: NDArray[np.int16]) -> Accommodated:
        """Take an explained impression into the evidence, freed of what the loads show."""
        x, y = math.floor(explanation.place[0]), math.floor(explanation.place[1])
        for name, load in self.loads.items():
            self.loads[name] = load.seen(self.frame.samples(), ranges, x, y)
        samples, counts = discounted(self.frame.samples(), ranges, x, y, self.loads.values())
        cells = statuses(self.occupancy, samples, counts, x, y)
        self.place = explanation.place
        moved = tuple(laid(load, self.frame) for load in self.loads.values())
        self.observations.append(Observation(ranges, self.frame.place_to_utak(*self.place), moved))
        self.occupancy.observe(samples, counts, x, y, len(self.observations) - 1)
        self.occupancy.overruled += explanation.misfits  # also where two looks contradict, and nothing that was settled
        if len(self.observations) == 1:
            self.occupancy.stand(x, y, 0)
        self.unfit = (*self.unfit[1 - RECENT :], explanation.misfits)
        self.place = self._standing(self.place)
        return Accommodated(explanation, cells)
