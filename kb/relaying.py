"""Laying all that was seen, and all that was carried, on another lattice.

In Utak's own frame his commands are exact: where he halted, and how a thing in his hand went with him, do not depend on
how the squares lie. What does is where a thing lay when he first took it, for that was seen in squares. So when the
lattice turns out to lie otherwise, things are laid anew where he took them, and carried from there as they were.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
import shapely

from geometry.rigid import Rotate, Translate
from kb.evidence import FREE, FULL, Evidence
from kb.heading import Laid, Look
from kb.lattice import Lattice
from kb.loads import Load, covered, discounted, is_whole, slack_of, whole

STEPS = sorted(((x, y) for x in (-1, 0, 1) for y in (-1, 0, 1)), key=lambda step: (math.hypot(*step), step))


class Relaid(NamedTuple):
    """What all looks say on a lattice.

    loads : as they lie after the last look, by name. misfits : fields that contradict it.
    """

    evidence: Evidence
    loads: Mapping[str, Load]
    misfits: int


def laid(load: Load, lattice: Lattice) -> Laid:
    """Where a load lies, told in Utak's own frame."""
    return Laid(load.name, _middle(load.polygon, lattice), load.turned, load.slack)


def relaid(new: Lattice, old: Lattice, looks: Sequence[Look], loads: Iterable[Load]) -> Relaid:
    """All that was seen, and where the loads are, if the lattice lies otherwise.

    old : the lattice on which the loads lie.
    """
    evidence, misfits, samples = Evidence(), 0, new.samples()
    taken: dict[str, Load] = {}  # as they lay when they were first held, on the new lattice
    known = {load.name: load for load in loads}
    for number in range(len(looks) + 1):
        for load in known.values():
            if min(load.since, len(looks)) == number:
                taken[load.name] = _taken(load, new, old, evidence)
                patch = taken[load.name].possible
                evidence.declare(evidence.squares(patch.west, patch.south, patch.mask), FREE, number - 1)
        if number == len(looks):
            break
        look = looks[number]
        there = [_carried(taken[was.name], known[was.name], was, new, old) for was in look.moved if was.name in taken]
        x, y = (math.floor(v) for v in new.place_from_utak(*look.place))
        freed = discounted(samples, look.ranges, x, y, there)
        misfits += evidence.clashes(*freed, x, y)
        evidence.look(*freed, x, y, number)
        if number == 0:
            evidence.stand(x, y, 0)
    now = {name: _carried(taken[name], load, laid(load, old), new, old) for name, load in known.items()}
    return Relaid(evidence, now, misfits)


def shifted(load: Load, new: Lattice, old: Lattice) -> Load:
    """Where a load is if Utak woke elsewhere in his square, and every look fell on the squares that it is believed to.

    Then it was taken where it was believed to lie, but every turn since was about another point.
    """
    return _carried(load, load, laid(load, old), new, old)


def _taken(load: Load, new: Lattice, old: Lattice, evidence: Evidence) -> Load:
    """A load as it lay when it was first held, on the new lattice, of which so much was seen then."""
    skew = new.angle - old.angle
    middle = new.place_from_utak(*_middle(load.first, old))
    polygon = _put(load.first, skew, middle)
    if not is_whole(load.first):
        return replace(
            load, first=polygon, polygon=polygon, slack=slack_of(polygon), full=frozenset(), empty=frozenset()
        )
    straight = Rotate(90 * round(skew / 90) - skew, middle).carry(polygon)
    x0, y0 = straight.bounds[:2]
    nearest = Translate(round(x0) - x0, round(y0) - y0).carry(straight)
    lying = [whole(shapely.transform(nearest, lambda points, s=step: points + np.array(s))) for step in STEPS]
    polygon = min(lying, key=lambda other: _unlike(other, evidence))
    return replace(load, first=polygon, polygon=polygon, slack=0.0, full=frozenset(), empty=frozenset())


def _unlike(polygon: Any, evidence: Evidence) -> int:
    """How many squares speak against a thing where it is said to lie: free ones under it, occupied ones beside it."""
    patch = covered(polygon)
    own = np.pad(patch.mask, 1)
    about = own.copy()
    about[1:] |= own[:-1]
    about[:-1] |= own[1:]
    about[:, 1:] |= own[:, :-1]
    about[:, :-1] |= own[:, 1:]
    row, column = evidence.index(patch.west - 1, patch.south - 1)
    state = evidence.state[row : row + own.shape[0], column : column + own.shape[1]]
    return int(((state == FREE) & own).sum() + ((state == FULL) & about & ~own).sum())


def _carried(taken: Load, load: Load, was: Laid, new: Lattice, old: Lattice) -> Load:
    """A load where it lay at some time, carried there from where it was taken. taken : on the new lattice."""
    began, begins = _middle(load.first, old), _middle(taken.first, new)
    aside = Rotate(was.degrees, (0.0, 0.0)).points(np.array([[begins[0] - began[0], begins[1] - began[1]]]))[0]
    middle = new.place_from_utak(was.middle[0] + float(aside[0]), was.middle[1] + float(aside[1]))
    polygon = whole(_put(taken.first, was.degrees, middle))
    slack = slack_of(polygon, was.slack)
    return replace(load, first=taken.first, polygon=polygon, slack=slack, full=frozenset(), empty=frozenset())


def _put(polygon: Any, degrees: float, middle: tuple[float, float]) -> Any:
    """A polygon turned by so many degrees, its middle brought to a point."""
    centre = polygon.centroid
    turned = Rotate(degrees, (centre.x, centre.y)).carry(polygon)
    return Translate(middle[0] - centre.x, middle[1] - centre.y).carry(turned)


def _middle(polygon: Any, lattice: Lattice) -> tuple[float, float]:
    """The middle of a polygon of the lattice, in Utak's own frame."""
    centre = polygon.centroid
    return lattice.place_to_utak(centre.x, centre.y)
