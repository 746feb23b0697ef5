"""The correction of an earlier motion: how everything since is shifted where it ended elsewhere than believed."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

from utak.geometry.motion.se2 import Translate
from utak.kb.localisation.hypotheses.frames import ObjectPose, Observation, Position
from utak.kb.localisation.hypotheses.walk_outcomes import add
from utak.kb.objects.held_object import HeldObject
from utak.kb.perception.frame import Frame


class WalkCorrection(NamedTuple):
    """A shift of all observations from one on, and of the objects that were seen or moved from there."""

    since: int  # the number of the first observation that is shifted; the first of all has the number 0
    shift: Position  # from the believed place to the corrected one, (east, north) in squares, Utak's own frame
    # Objects that were first held since, by name, each with the shift of where it lies and lay, same frame and unit
    seen: tuple[tuple[str, Position], ...] = ()
    # The name of the object in hand on the motion that is corrected; None when there was none
    in_hand: str | None = None

    def place(self, place: Position) -> Position:
        """Return a place of Utak since the motion as corrected, (east, north) in squares, Utak's own frame."""
        return add(place, self.shift)

    def observations(self, observations: Sequence[Observation]) -> list[Observation]:
        """Return all observations, oldest first, with corrected places and object poses; earlier ones are unchanged."""
        since = [
            observation._replace(place=self.place(observation.place), moved=tuple(map(self._pose, observation.moved)))
            for observation in observations[self.since :]
        ]
        return [*observations[: self.since], *since]

    def held_objects(self, held_objects: Mapping[str, HeldObject], frame: Frame) -> dict[str, HeldObject]:
        """Return all held objects, by name, where they lie and lay as corrected; same frame and order as given."""
        return {name: self._corrected_object(held, frame) for name, held in held_objects.items()}

    def _pose(self, pose: ObjectPose) -> ObjectPose:
        """Return the corrected pose of an object at an observation since the motion, Utak's own frame."""
        aside = self._aside(pose.name)
        if pose.name != self.in_hand:
            pose = pose._replace(taken=add(pose.taken, aside))
        return pose._replace(middle=add(pose.middle, aside))

    def _corrected_object(self, held: HeldObject, frame: Frame) -> HeldObject:
        """Return an object where it lies as corrected, map frame of `frame`; the same object when it is not shifted."""
        aside = Translate(*frame.to_map(*self._aside(held.name)))
        if not any(aside):
            return held
        first = held.first if held.name == self.in_hand else aside.carry(held.first)
        return replace(held.lying(aside.carry(held.polygon), held.slack), first=first, seen_on=None)

    def _aside(self, name: str) -> Position:
        """Return the shift of an object, (east, north) in squares, Utak's own frame; (0, 0) when it is not shifted."""
        return self.shift if name == self.in_hand else dict(self.seen).get(name, (0.0, 0.0))
