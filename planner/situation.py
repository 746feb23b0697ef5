"""The situation: what the meaning of a goal depends on, and what follows for doors and rooms."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np

from geometry.kernels.arrays import Bools
from kb.mapping.patch import Patch
from kb.task.task import Task
from kb.world.corners import Corner
from kb.world.model import WorldModel
from kb.world.rooms import LIKELY_DOOR, SURE, Door, Rooms, rooms_of, went_through
from planner.screen.projection import CostMaps, grown
from planner.sights.frontiers import Viewpoint, sight_of
from planner.stages import constraints


@dataclass(frozen=True)
class Situation:
    """What the meaning of a goal depends on.

    binding : parameter -> node. corners : side -> corner of the known floor. track : where Utak has been, points of
    the lattice.
    """

    model: WorldModel
    cost_maps: CostMaps
    binding: Mapping[str, str]
    rooms: Rooms
    corners: Mapping[str, Corner]
    task: Task
    rules: tuple[Path, ...] = ()
    track: tuple[tuple[float, float], ...] = ()

    @cached_property
    def supposed(self) -> Rooms:
        """The rooms as they are if what may be an object is one."""
        if (self.model.walls == self.model.verge).all():
            return self.rooms
        return rooms_of(self.model, self.rules, self.model.walls)

    def along_with(self, patch: Patch) -> "Situation":
        """The same for who takes something along wherever he goes, from its squares on."""
        return replace(self, cost_maps=CostMaps(self.model, self.model.mask(patch)))

    def beyond(self, place: tuple[float, float]) -> tuple[Bools, tuple[Viewpoint, ...]]:
        """(rows, columns) what shares a door with the room of a point, and what to look at before that is believed.

        The rooms are others if what goes on unseen, and is taken for verge, is an object.
        """
        mask = self.next_to(place, self.rooms, SURE)
        both = mask & self.next_to(place, self.supposed, LIKELY_DOOR)
        if both.any() or not mask.any():
            return both, ()
        return mask, loose_ends(self)

    def likely_beyond(self, place: tuple[float, float]) -> tuple[Rooms, Bools]:
        """The rooms, and (rows, columns) what shares a likely door with the room of a point of the lattice."""
        for rooms in (self.rooms, self.supposed):
            mask = self.next_to(place, rooms, LIKELY_DOOR)
            if mask.any():
                break
        return rooms, mask

    def forbidden(self, who: str) -> tuple[Door, ...]:
        """The doors that "utak" or a node may not go through by the constraints of the task.

        A thing that may not go through a door is kept from all that may be doors: which one is meant nothing tells.
        Utak is kept from one door that he has not gone through; while none is sure, from all that may be one, however
        unlikely: once he has gone through it nothing makes up for that.
        """
        meant = {self.binding.get(str(goal.args[0]), str(goal.args[0])) for goal in constraints(self.task)}
        if who not in meant:
            return ()
        if who == "utak":
            return self.avoided[:1] or self.rooms.doors
        return tuple(door for door in self.rooms.doors if door.likely)

    @cached_property
    def avoided(self) -> tuple[Door, ...]:
        """The sure doors that Utak has not gone through."""
        west, south = self.model.view.west, self.model.view.south
        track = np.array(self.track).reshape(-1, 2) - (west, south)
        return tuple(door for door in self.rooms.sure if not went_through(track, door))

    def next_to(self, place: tuple[float, float], rooms: Rooms, least: int) -> Bools:
        """(rows, columns) what shares a door with the room of a point, if that is one with so many percent."""
        row, column = self.model.view.locate(*place)
        return rooms.beyond(int(rooms.labels[row, column]), least)


def loose_ends(situation: Situation) -> tuple[Viewpoint, ...]:
    """Where to look at what goes on unseen and is hardly long enough to be a wall: rooms may end elsewhere."""
    model = situation.model
    pieces = model.verge & ~model.walls & grown(~model.view.seen, 1)
    labels = np.where(pieces, model.labels, 0)
    looks = (sight_of(situation.cost_maps, labels == n, "it may be no wall") for n in np.unique(labels[pieces]))
    return tuple(look for look in looks if len(look.squares))
