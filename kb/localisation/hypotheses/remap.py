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

    evidence: OccupancyMap
    loads: Mapping[str, HeldObject]
    misfits: int
    cut: bool = False


def laid(load: HeldObject, lattice: Frame) -> PlacedObservation:
    """Where a load lies, told in Utak's own frame."""
    return PlacedObservation(
        load.name, _middle(load.polygon, lattice), load.turned, load.slack, _middle(load.first, lattice)
    )


class Replay:
    """Looks laid on a lattice one after the other, as far as some of them.

    new, old : that lattice, and the one on which the loads lie. number : how many looks are taken in.
    """

    def __init__(self, new: Frame, old: Frame) -> None:
        self.new, self.old, self.number = new, old, 0
        self._evidence, self._misfits = OccupancyMap(), 0
        self._taken: dict[str, HeldObject] = {}  # as they lay when they were first held, on the new lattice

    def copy(self) -> "Replay":
        """The same, to go on with."""
        other = copy(self)
        other._evidence, other._taken = self._evidence.copy(), dict(self._taken)
        return other

    def go_on(
        self, looks: Sequence[Observation], loads: Mapping[str, HeldObject], to: int, whether: bool = False
    ) -> "Replay":
        """Take in the looks before that number; what was taken in already must be the first of them.

        whether : it is asked only whether anything contradicts: then no looks are taken in after the first that do.
        """
        for number in range(self.number, to):
            if whether and self._misfits:
                break
            self._take([load for load in loads.values() if load.since == number], number)
            look = looks[number]
            moved = [(self._taken[was.name], was) for was in look.moved if was.name in self._taken]
            there = [_carried(taken, loads[was.name], was, self.new) for taken, was in moved]
            x, y = (math.floor(v) for v in self.new.place_from_utak(*look.place))
            freed = discounted(self.new.samples(), look.ranges, x, y, there)
            self._misfits += self._evidence.clashes(*freed, x, y)
            self._evidence.look(*freed, x, y, number)
            if number == 0:
                self._evidence.stand(x, y, 0)
            self.number = number + 1
        return self

    @property
    def contradicted(self) -> bool:
        """Does anything contradict the lattice, of the looks that were taken in?"""
        return self._misfits > 0

    def end(self, looks: Sequence[Observation], loads: Mapping[str, HeldObject], whether: bool = False) -> RemappedMap:
        """What all looks say in the end. It cannot be gone on with. whether : as for `go_on`."""
        self.go_on(looks, loads, len(looks), whether)
        if whether and self._misfits:
            return RemappedMap(self._evidence, {}, self._misfits, cut=True)
        self._take([load for load in loads.values() if load.since >= len(looks)], len(looks))
        now = {name: _carried(self._taken[name], load, laid(load, self.old), self.new) for name, load in loads.items()}
        return RemappedMap(self._evidence, now, self._misfits)

    def _take(self, taken: Iterable[HeldObject], number: int) -> None:
        """Take out of the map what was first held before look `number`."""
        for load in taken:
            lay = self._taken[load.name] = _taken(load, self.new, self.old, self._evidence)
            patch = lay.possible
            self._evidence.make_room(patch.west, patch.south)
            squares = self._evidence.squares(patch.west, patch.south, patch.mask)
            self._evidence.declare(squares, FREE, number - 1)


def relaid(
    new: Frame,
    old: Frame,
    looks: Sequence[Observation],
    loads: Iterable[HeldObject],
    begun: Replay | None = None,
    whether: bool = False,
) -> RemappedMap:
    """All that was seen, and where the loads are, if the lattice lies otherwise.

    old : the lattice on which the loads lie. begun : the first of the looks, taken in already, with loads taken as
    these were. whether : it is asked only whether anything contradicts; if so, what is told is cut.
    """
    replay = Replay(new, old) if begun is None else begun.copy()
    return replay.end(looks, {load.name: load for load in loads}, whether)


class RemapCache:
    """What all looks say on any lattice.

    Lattices on which every look falls on the same squares are told the same: all is laid on the first of them that is
    asked for, and on the others things are only shifted.
    lattice, evidence, loads : as they are believed.
    """

    def __init__(
        self, lattice: Frame, evidence: OccupancyMap, looks: Sequence[Observation], loads: Mapping[str, HeldObject]
    ) -> None:
        self._lattice, self._looks, self._loads = lattice, looks, loads
        believed = RemappedMap(evidence, loads, 0)
        self._known: dict[tuple[int, bytes], tuple[Frame | None, RemappedMap]] = {
            self._fallen(lattice): (None, believed)
        }
        self._on: dict[Frame, RemappedMap] = {}

    def on(self, lattice: Frame, whether: bool = False) -> RemappedMap:
        """What they say on a lattice. whether : as for `relaid`."""
        if lattice not in self._on or (self._on[lattice].cut and not whether):
            self._on[lattice] = self._laid(lattice, whether)
        return self._on[lattice]

    def _laid(self, lattice: Frame, whether: bool) -> RemappedMap:
        fallen_ = self._fallen(lattice)
        if fallen_ not in self._known or (self._known[fallen_][1].cut and not whether):
            found = relaid(lattice, self._lattice, self._looks, self._loads.values(), whether=whether)
            self._known[fallen_] = lattice, found
        first, under = self._known[fallen_]
        if lattice == first or under.cut:
            return under
        loads = {name: shifted(load, lattice, first or self._lattice) for name, load in under.loads.items()}
        return under._replace(loads=loads)

    def _fallen(self, lattice: Frame) -> tuple[int, bytes]:
        return lattice.angle, fallen(lattice, self._looks).tobytes()


class Prefixes:
    """The first looks laid on a lattice, each taken in once, of however many of them that is asked.

    loads : as they lie on that lattice.
    """

    def __init__(self, lattice: Frame, looks: Sequence[Observation], loads: Mapping[str, HeldObject]) -> None:
        self._looks, self._loads = looks, loads
        self._known = {0: Replay(lattice, lattice)}

    def of(self, number: int) -> Replay:
        """The first `number` looks, to be copied."""
        if number not in self._known:
            near = max(n for n in self._known if n < number)
            replay = self._known[near].copy()
            for stop in (*range(near + 1 + EVERY - (near + 1) % EVERY, number, EVERY), number):
                self._known[stop] = replay.go_on(self._looks, self._loads, stop).copy()
        return self._known[number]


def shifted(load: HeldObject, new: Frame, old: Frame) -> HeldObject:
    """Where a load is if Utak woke elsewhere in his square, and every look fell on the squares that it is believed to.

    Then it was taken where it was believed to lie, but every turn since was about another point.
    """
    return _carried(load, load, laid(load, old), new)


def lain(load: HeldObject, was: PlacedObservation, lattice: Frame) -> HeldObject:
    """A load where it lay at some time, on the lattice that is believed."""
    return _carried(load, load, was, lattice)


def _taken(load: HeldObject, new: Frame, old: Frame, evidence: OccupancyMap) -> HeldObject:
    """A load as it lay when it was first held, on the new lattice, of which so much was seen then."""
    skew = new.angle - old.angle
    askew = 90 * round(skew / 90) - skew
    middle = new.place_from_utak(*_middle(load.first, old))
    first, skewed = _put(load.first, skew, middle), load.skewed or abs(askew) > ASKEW
    straight = is_whole(load.first)
    seen = None if straight and abs(askew) <= ASKEW else _outline(covered(first), evidence)
    if seen is not None:
        first, skewed = seen, False
    elif straight:
        first = _straightened(Rotate(askew, middle).carry(first), evidence)
    lying = load.lying(first)
    insets = load.insets if skew == 0.0 and seen is None else SubcellExtent() if is_whole(lying.polygon) else None
    return replace(lying, first=lying.polygon, skewed=skewed, insets=insets)


def _straightened(polygon: Any, evidence: OccupancyMap) -> Any:
    """A thing with sides along the lattice, on corners of it: where what was seen speaks least against that."""
    x0, y0 = polygon.bounds[:2]
    nearest = Translate(round(x0) - x0, round(y0) - y0).carry(polygon)
    lying = [whole(shapely.transform(nearest, lambda points, s=step: points + np.array(s))) for step in STEPS]
    return min(lying, key=lambda other: _unlike(other, evidence))


def _outline(patch: Patch, evidence: OccupancyMap) -> Any:
    """The outline of what was seen where a thing is said to lie, if nearly all of it was told by then; None else."""
    own = np.pad(patch.mask, REACH)
    state = evidence.window(patch.west - REACH, patch.south - REACH, own.shape)
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


def _unlike(polygon: Any, evidence: OccupancyMap) -> int:
    """How many squares speak against a thing where it is said to lie: free ones under it, occupied ones beside it."""
    patch = covered(polygon)
    own = np.pad(patch.mask, 1)
    about = edged(own)
    state = evidence.window(patch.west - 1, patch.south - 1, own.shape)
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


def _middle(polygon: Any, lattice: Frame) -> tuple[float, float]:
    """The middle of a polygon of the lattice, in Utak's own frame."""
    centre = polygon.centroid
    return lattice.place_to_utak(centre.x, centre.y)
