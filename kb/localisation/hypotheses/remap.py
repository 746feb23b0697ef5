"""Laying all that was seen, and all that was carried, on another lattice.

In Utak's own frame his commands are exact: where he halted, and how a thing in his hand went with him, do not depend on
how the squares lie. What does is where a thing lay when he first took it, for that was seen in squares. So when the
lattice turns out to lie otherwise, things are laid anew where he took them, and carried from there as they were.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from copy import copy
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
import shapely

from geometry.motion.se2 import Rotate, Translate
from geometry.raster.components import components, edged
from geometry.shapes.fit import fit_shapes
from kb.localisation.hypotheses.frames import Observation, PlacedObservation, fallen
from kb.mapping.occupancy import FREE, FULL, OPEN, OccupancyMap
from kb.mapping.patch import Patch, covered
from kb.objects.held_object import HeldObject, discounted, is_whole, whole
from kb.objects.subcell_extent import SubcellExtent
from kb.perception.frame import Frame

ASKEW = 8.0  # degrees from one lattice to another from where on an outline that was measured on the one is not right
UNTOLD = 0.25  # of the squares of a thing, so many may be open when it is measured anew
REACH = 6  # squares that a thing may reach further than it was believed to
EVERY = 16  # looks after which what they say is kept, to go on from there
STEPS = sorted(((x, y) for x in (-1, 0, 1) for y in (-1, 0, 1)), key=lambda step: (math.hypot(*step), step))


class RemappedMap(NamedTuple):
    """What all looks say on a lattice.

    loads : as they lie after the last look, by name. misfits : fields that contradict it. cut : were looks left out,
    as the first of them were contradicted? Then the loads are left out, too, and misfits may be too few, though not 0.
    """

    occupancy: OccupancyMap
    loads: Mapping[str, HeldObject]
    misfits: int
    cut: bool = False


def laid(load: HeldObject, frame: Frame) -> PlacedObservation:
    """Where a load lies, told in Utak's own frame."""
    return PlacedObservation(
        load.name, _middle(load.polygon, frame), load.turned, load.slack, _middle(load.first, frame)
    )


class Replay:
    """Looks laid on a lattice one after the other, as far as some of them.

    new, old : that lattice, and the one on which the loads lie. number : how many looks are taken in.
    """

    def __init__(self, new: Frame, old: Frame) -> None:
        self.new, self.old, self.number = new, old, 0
        self._occupancy, self._misfits = OccupancyMap(), 0
        self._taken: dict[str, HeldObject] = {}  # as they lay when they were first held, on the new lattice

    def copy(self) -> "Replay":
        """The same, to go on with."""
        other = copy(self)
        other._occupancy, other._taken = self._occupancy.copy(), dict(self._taken)
        return other

    def go_on(
        self, observations: Sequence[Observation], loads: Mapping[str, HeldObject], to: int, whether: bool = False
    ) -> "Replay":
        """Take in the looks before that number; what was taken in already must be the first of them.

        whether : it is asked only whether anything contradicts: then no looks are taken in after the first that do.
        """
        for number in range(self.number, to):
            if whether and self._misfits:
                break
            self._take([load for load in loads.values() if load.since == number], number)
            observation = observations[number]
            moved = [(self._taken[was.name], was) for was in observation.moved if was.name in self._taken]
            there = [_carried(taken, loads[was.name], was, self.new) for taken, was in moved]
            x, y = (math.floor(v) for v in self.new.place_from_utak(*observation.place))
            freed = discounted(self.new.samples(), observation.ranges, x, y, there)
            self._misfits += self._occupancy.clashes(*freed, x, y)
            self._occupancy.observe(*freed, x, y, number)
            if number == 0:
                self._occupancy.stand(x, y, 0)
            self.number = number + 1
        return self

    @property
    def contradicted(self) -> bool:
        """Does anything contradict the lattice, of the looks that were taken in?"""
        return self._misfits > 0

    def end(
        self, observations: Sequence[Observation], loads: Mapping[str, HeldObject], whether: bool = False
    ) -> RemappedMap:
        """What all looks say in the end. It cannot be gone on with. whether : as for `go_on`."""
        self.go_on(observations, loads, len(observations), whether)
        if whether and self._misfits:
            return RemappedMap(self._occupancy, {}, self._misfits, cut=True)
        self._take([load for load in loads.values() if load.since >= len(observations)], len(observations))
        now = {name: _carried(self._taken[name], load, laid(load, self.old), self.new) for name, load in loads.items()}
        return RemappedMap(self._occupancy, now, self._misfits)

    def _take(self, taken: Iterable[HeldObject], number: int) -> None:
        """Take out of the map what was first held before look `number`."""
        for load in taken:
            lay = self._taken[load.name] = _taken(load, self.new, self.old, self._occupancy)
            patch = lay.possible
            self._occupancy.make_room(patch.west, patch.south)
            squares = self._occupancy.squares(patch.west, patch.south, patch.mask)
            self._occupancy.declare(squares, FREE, number - 1)


def relaid(
    new: Frame,
    old: Frame,
    observations: Sequence[Observation],
    loads: Iterable[HeldObject],
    begun: Replay | None = None,
    whether: bool = False,
) -> RemappedMap:
    """All that was seen, and where the loads are, if the lattice lies otherwise.

    old : the lattice on which the loads lie. begun : the first of the looks, taken in already, with loads taken as
    these were. whether : it is asked only whether anything contradicts; if so, what is told is cut.
    """
    replay = Replay(new, old) if begun is None else begun.copy()
    return replay.end(observations, {load.name: load for load in loads}, whether)


class RemapCache:
    """What all looks say on any lattice.

    Lattices on which every look falls on the same squares are told the same: all is laid on the first of them that is
    asked for, and on the others things are only shifted.
    lattice, evidence, loads : as they are believed.
    """

    def __init__(
        self,
        frame: Frame,
        occupancy: OccupancyMap,
        observations: Sequence[Observation],
        loads: Mapping[str, HeldObject],
    ) -> None:
        self._frame, self._observations, self._loads = frame, observations, loads
        believed = RemappedMap(occupancy, loads, 0)
        self._known: dict[tuple[int, bytes], tuple[Frame | None, RemappedMap]] = {self._fallen(frame): (None, believed)}
        self._on: dict[Frame, RemappedMap] = {}

    def on(self, frame: Frame, whether: bool = False) -> RemappedMap:
        """What they say on a lattice. whether : as for `relaid`."""
        if frame not in self._on or (self._on[frame].cut and not whether):
            self._on[frame] = self._laid(frame, whether)
        return self._on[frame]

    def _laid(self, frame: Frame, whether: bool) -> RemappedMap:
        fallen_ = self._fallen(frame)
        if fallen_ not in self._known or (self._known[fallen_][1].cut and not whether):
            found = relaid(frame, self._frame, self._observations, self._loads.values(), whether=whether)
            self._known[fallen_] = frame, found
        first, under = self._known[fallen_]
        if frame == first or under.cut:
            return under
        loads = {name: shifted(load, frame, first or self._frame) for name, load in under.loads.items()}
        return under._replace(loads=loads)

    def _fallen(self, frame: Frame) -> tuple[int, bytes]:
        return frame.angle, fallen(frame, self._observations).tobytes()


class Prefixes:
    """The first looks laid on a lattice, each taken in once, of however many of them that is asked.

    loads : as they lie on that lattice.
    """

    def __init__(self, frame: Frame, observations: Sequence[Observation], loads: Mapping[str, HeldObject]) -> None:
        self._observations, self._loads = observations, loads
        self._known = {0: Replay(frame, frame)}

    def of(self, number: int) -> Replay:
        """The first `number` looks, to be copied."""
        if number not in self._known:
            near = max(n for n in self._known if n < number)
            replay = self._known[near].copy()
            for stop in (*range(near + 1 + EVERY - (near + 1) % EVERY, number, EVERY), number):
                self._known[stop] = replay.go_on(self._observations, self._loads, stop).copy()
        return self._known[number]


def shifted(load: HeldObject, new: Frame, old: Frame) -> HeldObject:
    """Where a load is if Utak woke elsewhere in his square, and every look fell on the squares that it is believed to.

    Then it was taken where it was believed to lie, but every turn since was about another point.
    """
    return _carried(load, load, laid(load, old), new)


def lain(load: HeldObject, was: PlacedObservation, frame: Frame) -> HeldObject:
    """A load where it lay at some time, on the lattice that is believed."""
    return _carried(load, load, was, frame)


def _taken(load: HeldObject, new: Frame, old: Frame, occupancy: OccupancyMap) -> HeldObject:
    """A load as it lay when it was first held, on the new lattice, of which so much was seen then."""
    skew = new.angle - old.angle
    askew = 90 * round(skew / 90) - skew
    middle = new.place_from_utak(*_middle(load.first, old))
    first, skewed = _put(load.first, skew, middle), load.skewed or abs(askew) > ASKEW
    straight = is_whole(load.first)
    seen = None if straight and abs(askew) <= ASKEW else _outline(covered(first), occupancy)
    if seen is not None:
        first, skewed = seen, False
    elif straight:
        first = _straightened(Rotate(askew, middle).carry(first), occupancy)
    lying = load.lying(first)
    insets = load.insets if skew == 0.0 and seen is None else SubcellExtent() if is_whole(lying.polygon) else None
    return replace(lying, first=lying.polygon, skewed=skewed, insets=insets)


def _straightened(polygon: Any, occupancy: OccupancyMap) -> Any:
    """A thing with sides along the lattice, on corners of it: where what was seen speaks least against that."""
    x0, y0 = polygon.bounds[:2]
    nearest = Translate(round(x0) - x0, round(y0) - y0).carry(polygon)
    lying = [whole(shapely.transform(nearest, lambda points, s=step: points + np.array(s))) for step in STEPS]
    return min(lying, key=lambda other: _unlike(other, occupancy))


def _outline(patch: Patch, occupancy: OccupancyMap) -> Any:
    """The outline of what was seen where a thing is said to lie, if nearly all of it was told by then; None else."""
    own = np.pad(patch.mask, REACH)
    state = occupancy.window(patch.west - REACH, patch.south - REACH, own.shape)
    labels = components(state != FREE).labels
    met = np.bincount(labels[own & (labels > 0)], minlength=1)
    part = labels == met.argmax()
    full, possible = part & (state == FULL), part & (state == OPEN)
    inside = part[1:-1, 1:-1].sum() == part.sum()
    if not met.any() or not inside or possible.sum() > UNTOLD * full.sum():
        return None
    best = fit_shapes(full, possible)[0]
    if best.misfit:
        return None
    return shapely.transform(best.polygon, lambda points: points + np.array([patch.west - REACH, patch.south - REACH]))


def _unlike(polygon: Any, occupancy: OccupancyMap) -> int:
    """How many squares speak against a thing where it is said to lie: free ones under it, occupied ones beside it."""
    patch = covered(polygon)
    own = np.pad(patch.mask, 1)
    about = edged(own)
    state = occupancy.window(patch.west - 1, patch.south - 1, own.shape)
    return int(((state == FREE) & own).sum() + ((state == FULL) & about & ~own).sum())


def _carried(taken: HeldObject, load: HeldObject, was: PlacedObservation, new: Frame) -> HeldObject:
    """A load where it lay at some time, carried there from where it was taken. taken : on the new lattice."""
    began = np.array([_middle(taken.first, new)]) - was.taken
    aside = Rotate(was.degrees, (0.0, 0.0)).points(began)[0]
    middle = new.place_from_utak(was.middle[0] + float(aside[0]), was.middle[1] + float(aside[1]))
    lying = load.lying(_put(taken.first, was.degrees, middle), was.slack)
    return replace(lying, first=taken.first, skewed=taken.skewed, insets=taken.insets)


def _put(polygon: Any, degrees: float, middle: tuple[float, float]) -> Any:
    """A polygon turned by so many degrees, its middle brought to a point."""
    centre = polygon.centroid
    turned = Rotate(degrees, (centre.x, centre.y)).carry(polygon)
    return Translate(middle[0] - centre.x, middle[1] - centre.y).carry(turned)


def _middle(polygon: Any, frame: Frame) -> tuple[float, float]:
    """The middle of a polygon of the lattice, in Utak's own frame."""
    centre = polygon.centroid
    return frame.place_to_utak(centre.x, centre.y)
