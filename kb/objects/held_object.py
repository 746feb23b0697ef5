"""Loads: things that Utak has taken hold of, and what he believes of where they lie now.

What never moves is known from the counts of all looks together (kb.mapping.occupancy). A thing that he carries
would contradict
them, so it is taken out of the standing map when he grasps it: from then on it is a shape with a place of its own, and
every look is freed of what the shape itself shows before it is counted as evidence of the rest.
"""

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from geometry.counts.uncover import uncover
from kb.mapping.patch import Patch, covered, patch_of_squares
from kb.objects.subcell_extent import NONE, Sides, SubcellExtent, further, moved_in, told, turned, within_play
from kb.perception.frame import Samples

Mask = NDArray[np.bool_]
Square = tuple[int, int]  # (x, y) of the lattice
WHOLE = 1e-6  # squares: corners this near to corners of the lattice are taken to be there
ROUNDING = 1e-4  # squares by which an outline may lie otherwise that is known but for the rounding of commands
DUBIOUS = 8  # fields that a motion of a thing leaves as noise when it rather lies elsewhere
SLIGHT = 0.3  # squares by which the outline of a thing that is not whole may lie otherwise
NOTHING = Patch(0, 0, np.zeros((1, 1), np.bool_))  # no square


@dataclass(frozen=True)
class HeldObject:
    """Something that Utak has held.

    Attributes
    ----------
    name : of its node in the world model. polygon : where it is believed to lie (shapely, lattice frame).
    first : where it lay when he first took hold of it. slack : squares by which its outline may lie otherwise.
    full, empty : squares, of those that the slack leaves open, that were seen to be covered or not since it last moved.
    shape, colour, support : as of the node, from before it was grasped; support grows with every look at it. The shape
    of what was found to be larger since is {} until it is measured.
    turned : degrees that it was turned since then. proven : it was seen to move. stuck : motions in a row that did not
    move it. since : how many looks had been received when it was first held. astray : squares by which it may lie
    otherwise besides, for it is not known where in his square Utak stands, and so about what it was turned.
    unexplained : fields that the worst explained of its motions left as noise. skewed : its outline was measured on
    another lattice, and could not be measured on this one. thwarted : motions in all that did not move it though it had
    moved before, and nothing is suspected to have stopped it. inexact : it lies only about where it is believed to,
    also where its corners seem to lie on the lattice. insets : how far its sides may lie within the squares in which it
    was seen; None when it does not lie along them. stopped : one of its motions ended early, or beside.
    """

    name: str
    polygon: Any
    first: Any
    slack: float = 0.0
    full: frozenset[Square] = frozenset()
    empty: frozenset[Square] = frozenset()
    turned: float = 0.0
    shape: Mapping[str, int] = field(default_factory=dict)
    colour: str | None = None
    support: tuple[int, ...] = ()
    proven: bool = False
    stuck: int = 0
    since: int = 0
    astray: float = 0.0
    unexplained: int = 0
    skewed: bool = False
    thwarted: int = 0
    inexact: bool = False
    insets: SubcellExtent | None = None
    stopped: bool = False

    @property
    def dubious(self) -> bool:
        """May it well lie elsewhere than it is believed to, or be of another outline?"""
        return self.skewed or self.unexplained >= DUBIOUS

    @property
    def play(self) -> float:
        """By how many squares its outline may lie otherwise, for whatever reason; 0 for what only rounding leaves."""
        play = max(self.slack, self.astray)
        return play if play >= WHOLE else 0.0

    @property
    def lying_insets(self) -> SubcellExtent | None:
        """How far in its sides lie, those to the west, east, south, north as it lies now; None when it lies askew."""
        quarters = self._quarters
        return None if self.insets is None or quarters is None else self.insets.after(quarters)

    @property
    def short(self) -> Sides:
        """By how much they may lie further in than they are believed to."""
        insets = self.lying_insets
        return (self.play, self.play, self.play, self.play) if insets is None else insets.short

    @property
    def _quarters(self) -> int | None:
        """How many quarter turns it was turned; None when it lies askew."""
        quarters = round(self.turned / 90.0)
        return quarters if abs(self.turned - 90.0 * quarters) < WHOLE else None

    @cached_property
    def sure(self) -> Patch:
        """The squares that it surely covers."""
        inner = self._within(1) if self.play else self.polygon
        patch = NOTHING if inner.is_empty else covered(inner)
        return patch if not self.full else patch_of_squares(patch.squares() | self.full)

    @cached_property
    def possible(self) -> Patch:
        """The squares that it covers or may cover."""
        if not self.play:
            return self.sure
        patch = covered(self._within(-1))
        return patch if not self.empty else patch_of_squares(patch.squares() - self.empty)

    def _within(self, inwards: int) -> Any:
        """The outline where it is least, or where it is most with -1: what is known of each side is made use of."""
        insets = self.lying_insets
        if insets is not None and not self.stopped and self.play <= max(insets.play, ROUNDING):
            west, east, south, north = insets.plays[inwards > 0]
            far = inwards * west, inwards * east, inwards * south, inwards * north
            outline = within_play(self.polygon, far, inwards * ROUNDING)
            if outline is not None:
                return outline
        return self.polygon.buffer(-inwards * self.play, join_style="mitre")

    def moved(self, polygon: Any, slack: float, degrees: float = 0.0, commanded: bool = False) -> "HeldObject":
        """The load after a motion that it was seen to make.

        degrees : by which it was turned. commanded : whether it went all the way; where it was stopped it lies right
        beside a line of the lattice as often as on it.
        """
        stopped, turned = self.stopped or not commanded, self.turned + degrees
        return replace(self.lying(polygon, slack), turned=turned, proven=True, stuck=0, stopped=stopped)

    def lying(self, polygon: Any, otherwise: float = SLIGHT) -> "HeldObject":
        """The load where a polygon says, of which no look has told yet.

        otherwise : its slack; what is whole has none, unless its sides may lie further in or out.
        """
        nothing: frozenset[Square] = frozenset()
        placed = whole(polygon)
        slack = max(otherwise, SLIGHT) if self.inexact else slack_of(placed, otherwise)
        if self.insets is not None and self._quarters is not None and self.insets.play:
            slack = max(slack, self.insets.play)
        return replace(self, polygon=placed, slack=slack, full=nothing, empty=nothing)

    def seen(self, samples: Samples, ranges: NDArray[np.int16], x: int, y: int) -> "HeldObject":
        """The load after a look from square (x, y): fields of a single square tell which of the open ones it covers."""
        single = (samples.weight.sum(1) == 1) & (samples.slack == 0)
        open_ = self.possible.squares() - self.sure.squares()
        if not open_ or not single.any():
            return self
        columns, rows = (samples.columns[single, 0] + x).tolist(), (samples.rows[single, 0] + y).tolist()
        counts = dict(zip(zip(columns, rows, strict=True), ranges[single].tolist(), strict=True))
        full = self.full | {square for square in open_ if counts.get(square, (0, 1))[0] > 0}
        empty = self.empty | {square for square in open_ if counts.get(square, (0, 1))[1] == 0}
        return replace(self, full=full, empty=empty)

    def told(self, agrees: Callable[[Any], bool]) -> "HeldObject | None":
        """The load as a look leaves it that tells how far in its sides lie; None when it agrees with no such outline.

        agrees : does the look agree with the load if that is its outline?
        """
        quarters = self._quarters
        if self.insets is None or quarters is None or self.inexact or self.skewed or self.astray > ROUNDING:
            return None
        left = told(self.insets.after(quarters), self.polygon, agrees)
        return None if left is None else self.inset(left.after(-quarters))

    def inset(self, insets: SubcellExtent) -> "HeldObject | None":
        """The load with its sides where they are believed to lie then; None when it would be no outline."""
        quarters = self._quarters
        if self.insets is None or quarters is None:
            return None
        change = further(insets, self.insets)
        if not any(change):
            return replace(self, insets=insets, slack=max(insets.play, ROUNDING) if insets.play else self.slack)
        polygon, first = moved_in(self.polygon, turned(change, quarters)), moved_in(self.first, change)
        if polygon is None or first is None:
            return None
        lying = self.lying(polygon, max(insets.play, ROUNDING))
        return replace(lying, first=first, insets=insets)

    def woken(self, far: float) -> "HeldObject":
        """The load, if where Utak woke is known up to so many squares, which tells about what point it was turned."""
        return replace(self, astray=2 * far * abs(math.sin(math.radians(self.turned / 2))))

    def resisted(self) -> "HeldObject":
        """The load after a motion that it was expected to make and did not."""
        return replace(self, stuck=self.stuck + 1)


def borne_out(loads: Mapping[str, HeldObject], held: str | None) -> dict[str, HeldObject]:
    """The loads that are held or were seen to move: he may have grasped beside any other, and it stands elsewhere."""
    return {name: load for name, load in loads.items() if load.proven or name == held}


def whole(polygon: Any) -> Any:
    """The polygon with its corners exactly on corners of the lattice, if all of them lie there but for rounding."""
    return shapely.transform(polygon, np.rint) if is_whole(polygon) else polygon


def is_whole(polygon: Any) -> bool:
    """Do all corners lie on corners of the lattice?"""
    points = shapely.get_coordinates(polygon)
    return bool(np.abs(points - np.rint(points)).max() < WHOLE)


def slack_of(polygon: Any, otherwise: float = SLIGHT) -> float:
    """By how much an outline may lie otherwise: not at all where it is whole, for then its image tells it exactly."""
    return 0.0 if is_whole(polygon) else max(otherwise, ROUNDING)


def seen_insets(polygon: Any) -> SubcellExtent | None:
    """How far in the sides of a thing may lie that never moved; None when they are not along the lattice."""
    return SubcellExtent() if polygon is not None and is_whole(polygon) else None


def seen_short(polygon: Any) -> Sides:
    """By how much they may lie further in than those of its outline."""
    if polygon is None:
        return NONE
    insets = seen_insets(polygon)
    return (SLIGHT, SLIGHT, SLIGHT, SLIGHT) if insets is None else insets.short


def discounted(
    samples: Samples, ranges: NDArray[np.int16], x: int, y: int, loads: Iterable[HeldObject]
) -> tuple[Samples, NDArray[np.int16]]:
    """What a look from square (x, y) says of all but the loads: their squares are not sampled, and not counted.

    ranges : (160, 2) least and greatest counts. A greatest count below 0 means that a load cannot be where it is
    believed to be.
    """
    left, weight = ranges.copy(), samples.weight.copy()
    for load in loads:
        possible, sure = load.possible, load.sure
        here = x - possible.west, y - possible.south, x - sure.west, y - sure.south
        uncover(samples.columns, samples.rows, weight, left, possible.mask, sure.mask, *here)
    return samples._replace(weight=weight), left
