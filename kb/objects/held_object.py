"""Held objects: what is believed of objects that the robot has held, and of where they lie now.

What never moves is known from the counts of all impressions together (kb.mapping.occupancy). An object that moves
would contradict them, so it is taken out of the map when it is grasped. From then on it is a shape with a place of its
own, and its share of every impression is subtracted before the counts of the rest are solved.
"""

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from utak.geometry.counts.uncover import remove_covered_squares
from utak.geometry.kernels.arrays import Square as Square
from utak.kb.mapping.patch import Patch, patch_of_polygon, patch_of_squares
from utak.kb.objects.subcell_extent import (
    NO_INSETS,
    SideValues,
    SubcellExtent,
    inset_change,
    inset_outline,
    narrowed,
    turn_sides,
    within_play,
)
from utak.kb.perception.frame import Samples

# Squares: a corner so close to a corner of the grid is taken to be there; rounding of floats
GRID_CORNER_TOLERANCE = 1e-6
# Squares: tolerance of an outline that is known exactly, but for the rounding of commands; derived
COMMAND_ROUNDING = 1e-4
# Fields that a motion leaves unexplained, from which the object more likely lies elsewhere; tuned
MIN_DUBIOUS_FIELDS = 8
OUTLINE_TOLERANCE = 0.3  # squares: how far the true outline may lie from a fitted one off the grid; tuned
EMPTY_PATCH = Patch(0, 0, np.zeros((1, 1), np.bool_))  # no square


@dataclass(frozen=True)
class HeldObject:
    """An object that the robot holds, or has held."""

    name: str  # The name of its node in the world model
    polygon: Any  # Its believed outline, where it is believed to lie now; map frame, in squares
    first: Any  # Where it lay when it was first held; map frame
    slack: float = 0.0  # How far the true outline may lie from the believed one, in squares
    # Squares of the map frame that the tolerance `slack` leaves open, but that were seen to be occupied, or not, since
    # it last moved
    full: frozenset[Square] = frozenset()
    empty: frozenset[Square] = frozenset()
    turned: float = 0.0  # Degrees by which it was turned since it was first held, counter-clockwise positive
    # Shape class -> confidence in percent, from before it was grasped; {} until it is measured anew, if it was found to
    # be larger than it seemed
    shape: Mapping[str, int] = field(default_factory=dict)
    colour: str | None = None  # The colour felt on it before it was grasped; None when it was not felt
    # Numbers of the impressions, from 0, that support it; every impression of it is added
    support: tuple[int, ...] = ()
    proven: bool = False  # Whether it was seen to move
    resisted: tuple[str, ...] = ()  # The ways (`way_of`) of the last motions in a row, none of which moved it
    since: int = 0  # How many impressions had been received when it was first held
    # Additional tolerance in squares: where the robot stands in its square, and so the centre of its turns, is not
    # known exactly
    astray: float = 0.0
    unexplained: int = 0  # How many fields the worst explained of its motions left unexplained
    skewed: bool = False  # Whether its outline was measured in another frame, and could not be measured in this one
    # How many motions in all did not move it, though it had moved before and nothing is suspected to have stopped it
    thwarted: int = 0
    inexact: bool = False  # Whether its place is known only roughly, even where its corners seem to lie on the grid
    # How far its sides may lie within the squares in which it was seen, as it lay when first held; None when they are
    # not parallel to the grid
    insets: SubcellExtent | None = None
    stopped: bool = False  # Whether one of its motions ended early, or beside its predicted place
    # Whether it was seen to move as one thing: a motion that did not end early left no field unexplained
    whole: bool = False
    touching: bool = False  # Whether another thing lay right beside it when it was first held: they may share squares
    # The squares on which it was seen before it was grasped, map frame; None when these are not known any more, for the
    # frame is another one
    seen_on: Patch | None = None

    @property
    def dubious(self) -> bool:
        """Whether it may well lie elsewhere than believed, or have another outline."""
        return self.skewed or self.unexplained >= MIN_DUBIOUS_FIELDS

    @property
    def play(self) -> float:
        """The distance within which the true outline lies of the believed one, in squares; 0 for mere rounding."""
        play = max(self.slack, self.astray)
        return play if play >= GRID_CORNER_TOLERANCE else 0.0

    @property
    def lying_insets(self) -> SubcellExtent | None:
        """The possible insets of its sides as it lies now; None when its sides are not parallel to the grid."""
        quarters = self.quarters
        return None if self.insets is None or quarters is None else self.insets.after(quarters)

    @property
    def short(self) -> SideValues:
        """The distance by which each side may lie further in than believed, in squares."""
        insets = self.lying_insets
        return (self.play, self.play, self.play, self.play) if insets is None else insets.short

    @property
    def quarters(self) -> int | None:
        """The number of quarter turns by which it was turned, counter-clockwise positive; None when it lies askew."""
        quarters = round(self.turned / 90.0)
        return quarters if abs(self.turned - 90.0 * quarters) < GRID_CORNER_TOLERANCE else None

    @cached_property
    def sure(self) -> Patch:
        """The squares that it surely covers, map frame; a patch without squares when there are none."""
        inner = self._bound(1) if self.play else self.polygon
        patch = EMPTY_PATCH if inner.is_empty else patch_of_polygon(inner)
        return patch if not self.full else patch_of_squares(patch.squares() | self.full)

    @cached_property
    def possible(self) -> Patch:
        """The squares that it covers or may cover, those of `sure` included; map frame."""
        if not self.play:
            return self.sure
        patch = patch_of_polygon(self._bound(-1))
        return patch if not self.empty else patch_of_squares(patch.squares() - self.empty)

    def _bound(self, inwards: int) -> Any:
        """Return the smallest possible outline (inwards 1), or the greatest (-1): a shapely polygon, map frame."""
        insets = self.lying_insets
        if insets is not None and not self.stopped and self.play <= max(insets.play, COMMAND_ROUNDING):
            west, east, south, north = insets.plays[inwards > 0]
            far = inwards * west, inwards * east, inwards * south, inwards * north
            outline = within_play(self.polygon, far, inwards * COMMAND_ROUNDING)
            if outline is not None:
                return outline
        return self.polygon.buffer(-inwards * self.play, join_style="mitre")

    def moved(self, polygon: Any, slack: float, degrees: float = 0.0, commanded: bool = False) -> "HeldObject":
        """Return the object after a motion that it was seen to make."""
        stopped, turned = self.stopped or not commanded, self.turned + degrees
        return replace(self.lying(polygon, slack), turned=turned, proven=True, resisted=(), stopped=stopped)

    def lying(self, polygon: Any, otherwise: float = OUTLINE_TOLERANCE) -> "HeldObject":
        """Return the object at another place, of which no impression has shown anything yet."""
        nothing: frozenset[Square] = frozenset()
        placed = snap_to_grid(polygon)
        slack = max(otherwise, OUTLINE_TOLERANCE) if self.inexact else outline_tolerance(placed, otherwise)
        if self.insets is not None and self.quarters is not None and self.insets.play:
            slack = max(slack, self.insets.play)
        return replace(self, polygon=placed, slack=slack, full=nothing, empty=nothing)

    def seen(self, samples: Samples, ranges: NDArray[np.int16], x: int, y: int) -> "HeldObject":
        """Return the object after an impression: fields of one square show which of its open squares it covers."""
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
        """Return the object with the insets of its sides narrowed by an impression."""
        # None when the impression agrees with no outline of possible insets, or when insets say nothing of it: it lies
        # askew, its place is known only roughly, or its outline is of another frame.
        quarters = self.quarters
        if self.insets is None or quarters is None or self.inexact or self.skewed or self.astray > COMMAND_ROUNDING:
            return None
        left = narrowed(self.insets.after(quarters), self.polygon, agrees)
        return None if left is None else self.inset(left.after(-quarters))

    def inset(self, insets: SubcellExtent) -> "HeldObject | None":
        """Return the object with other possible insets, its sides moved to where they are then believed to lie."""
        # None when the result would be no outline, or when its sides are not parallel to the grid.
        quarters = self.quarters
        if self.insets is None or quarters is None:
            return None
        change = inset_change(insets, self.insets)
        if not any(change):
            return replace(self, insets=insets, slack=max(insets.play, COMMAND_ROUNDING) if insets.play else self.slack)
        polygon, first = inset_outline(self.polygon, turn_sides(change, quarters)), inset_outline(self.first, change)
        if polygon is None or first is None:
            return None
        lying = self.lying(polygon, max(insets.play, COMMAND_ROUNDING))
        return replace(lying, first=first, insets=insets)

    def woken(self, far: float) -> "HeldObject":
        """Return the object if the point where the robot woke is known within a distance."""
        return replace(self, astray=2 * far * abs(math.sin(math.radians(self.turned / 2))))


def held_or_moved(loads: Mapping[str, HeldObject], held: str | None) -> dict[str, HeldObject]:
    """Return the objects that are held or were seen to move: a grasp of any other may have missed it."""
    return {name: load for name, load in loads.items() if load.proven or name == held}


def snap_to_grid(polygon: Any) -> Any:
    """Return a polygon with its corners rounded to corners of the grid if all of them lie there but for rounding."""
    return shapely.transform(polygon, np.rint) if is_grid_aligned(polygon) else polygon


def is_grid_aligned(polygon: Any) -> bool:
    """Return whether all corners of a shapely geometry of the map frame lie on corners of the grid."""
    points = shapely.get_coordinates(polygon)
    return bool(np.abs(points - np.rint(points)).max() < GRID_CORNER_TOLERANCE)


def outline_tolerance(polygon: Any, otherwise: float = OUTLINE_TOLERANCE) -> float:
    """Return how far the true outline may lie from a believed one, in squares."""
    return 0.0 if is_grid_aligned(polygon) else max(otherwise, COMMAND_ROUNDING)


def initial_insets(polygon: Any) -> SubcellExtent | None:
    """Return the possible insets of the sides of an object that never moved; None when it is not on the grid."""
    # `polygon` is its believed outline, a shapely Polygon, map frame, or None when there is none; then the result is
    # None.
    return SubcellExtent() if polygon is not None and is_grid_aligned(polygon) else None


def initial_short(polygon: Any) -> SideValues:
    """Return by how much further in the sides of an object that never moved may lie than its outline, in squares."""
    if polygon is None:
        return NO_INSETS
    insets = initial_insets(polygon)
    return (OUTLINE_TOLERANCE,) * 4 if insets is None else insets.short


def subtract_held_objects(
    samples: Samples, ranges: NDArray[np.int16], x: int, y: int, loads: Iterable[HeldObject]
) -> tuple[Samples, NDArray[np.int16]]:
    """Subtract objects that were held from an impression, so that it speaks of all else alone."""
    left, weight = ranges.copy(), samples.weight.copy()
    for load in loads:
        possible, sure = load.possible, load.sure
        here = x - possible.west, y - possible.south, x - sure.west, y - sure.south
        remove_covered_squares(samples.columns, samples.rows, weight, left, possible.mask, sure.mask, *here)
    return samples._replace(weight=weight), left
