"""The world model: a frozen value, made anew after every impression from the map and its interpretation.

It is a tree. Its root is `org`, the robot; the only child of `org` is `floor`; the children of `floor` are `verge` and
the isolated objects. A node's place is the offset to its parent: when the robot moves, or an object is pushed, one
relation changes. Which name an object bears from one impression to the next is kept in kb.world.object_names.

Two frames occur. The map frame has its axes along the rows of squares; square (0, 0) is the one in which the robot
woke. The robot frame has its origin where the robot woke, and its north is the way the robot faced then.
"""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from utak.geometry.kernels.arrays import XY, Bools, Floats, Labels, Square
from utak.geometry.raster.components import with_edge_neighbours
from utak.kb.localisation.standing import Standing
from utak.kb.mapping.object_heat import NO_COMPLETION_SUMMARY, CompletionSummary
from utak.kb.mapping.occupancy import OPEN, MapView
from utak.kb.mapping.patch import Patch
from utak.kb.objects.subcell_extent import NO_INSETS, SideValues, SubcellExtent
from utak.kb.perception.frame import Frame
from utak.kb.perception.interpretation import LONGEST_OBJECT, Kinds
from utak.kb.perception.protrusions import VERGE_TOUCH_COLOUR, protrusions, untouched_parts
from utak.kb.perception.regions import Percept

MAX_SMALL_FRAME_DOUBT = math.radians(5)  # radians: two frames that differ less may explain the same impressions; tuned
MAX_SQUARE_SHIFT = 0.3  # squares: a square that lies elsewhere by at most this is still the same; tuned
# Probability: a square that is occupied at most so likely counts as floor; tuned on random worlds
MAX_FREE_PROBABILITY = 0.06
# A square that is occupied at least so likely may be part of a thing: more likely than not
MIN_OBSTACLE_PROBABILITY = 0.5
# Probability: a square that is occupied at most so likely, or free so, is not in doubt; tuned
MAX_CLEAR_PROBABILITY = 0.12
FACT_UNITS_PER_SQUARE = 100  # lengths in facts, given or shown by encodings, are hundredths of squares; convention
ROOT_NODE, FLOOR_NODE, VERGE_NODE = "org", "floor", "verge"  # names of the nodes that are no objects


def hundredths(length: float) -> int:
    """Return a length in squares as a whole number of hundredths of squares, rounded, as facts state it."""
    return round(FACT_UNITS_PER_SQUARE * length)


@dataclass(frozen=True)
class Node:
    """A part of the world below the floor: an isolated object, or what may be one."""

    name: str  # o1, o2, ... from 1, in the order in which they were first seen.
    kind: str  # What it is believed to be: object
    confidence: int  # Percent of belief that it is of this kind
    region: str  # Its region of the map, `part<n>`
    patch: Patch  # The squares that it covers, or may cover; map frame
    open: int  # How many squares of its region, and of those that touch it, are not determined yet
    vague: int = 0  # How many of these look doubtful, too (see `doubtful_squares`)
    shape: Mapping[str, int] = field(default_factory=dict)  # Shape class -> confidence in percent
    polygon: Any = None  # Its believed outline, map frame, in squares; None while nothing fits
    # Shape class -> the outline that it would have, from the south-west corner of the patch: the other classes that fit
    rivals: Mapping[str, Any] = field(default_factory=dict)
    colour: str | None = None  # The colour felt on it, one lower-case letter; None when it was not touched
    support: tuple[int, ...] = ()  # Numbers of the impressions, from 0, that settled its squares, ascending
    movable: int = 100  # Percent of belief that it can be moved, if it is an object, by kb/asp/movable.lp
    felt_first: bool = False  # Whether it is felt before it is moved: it may be a piece of wall (kb/asp/movable.lp)
    persists: int = 100  # Percent of belief that it still lies where it lay, by kb/asp/persistence.lp
    looked_at_again: bool = False  # Whether it is looked at again before a task is done that is about it, by the same
    moved: bool = False  # Whether the robot has moved it
    whole: bool = False  # Whether it was seen to move as one thing
    turned: float = 0.0  # Degrees by which it was turned since it was first held, counter-clockwise positive
    resisted: tuple[str, ...] = ()  # The ways (`way_of`) of the last motions in a row, none of which moved it
    untried: tuple[str, ...] = ()  # The ways in which it is tried next, as it did not move, by kb/asp/movable.lp
    # Whether it may well lie elsewhere, or have another outline: what is seen agrees ill with how it came there
    dubious: bool = False
    inexact: bool = False  # Whether its place is known only roughly
    # Whether its place is known only roughly until it is turned back: its turns were about a point that is not known
    # exactly, since the robot may have woken elsewhere in its square than believed
    astray: bool = False
    # By how many squares its west, east, south and north sides may lie further in than those of the outline
    short: SideValues = NO_INSETS
    # How far its sides lie within the squares in which it was seen; None when they are not parallel to the grid
    insets: SubcellExtent | None = None

    @property
    def stuck(self) -> int:
        """The number of the last motions in a row, none of which moved it."""
        return len(self.resisted)


@dataclass(frozen=True)
class WorldModel:
    """All that is believed after one impression."""

    frame: Frame  # Where the robot frame lies in the map frame
    place: XY  # Where the robot stands, in squares, map frame
    # The occupancy of the squares seen, and of a margin of unseen ones. Arrays of (rows, columns) lie on it: row 0 in
    # the south, column 0 in the west.
    view: MapView
    labels: Labels  # The number n of each square's region `part<n>`; 0 where nothing was seen
    percept: Percept  # The regions, and which of them touch or surround each other
    kinds: Kinds  # What each region is taken for
    objects: tuple[Node, ...]  # The isolated objects, and what may be one, by number
    held: str | None = None  # The name of the object in hand
    may_hold: bool = False  # Whether something may be in hand that was grasped before the map was begun
    missing: tuple[str, ...] = ()  # The names of things that are no longer where they lay, and were not seen since
    looked_from: frozenset[Square] = frozenset()  # The squares on which an impression was received, map frame
    # The same since an impression contradicted what is believed; all of them while none did
    looked_since: frozenset[Square] = frozenset()
    barred: frozenset[Square] = frozenset()  # Squares that stopped a motion, or probably did, map frame
    spread: float = 0.0  # Radians by which the true orientation of the frame may differ from the believed one
    likely_spread: float = 0.0  # Radians by which it is likely to differ
    # How far from the believed point the robot may have woken in its square, in squares, map frame; the first two are
    # at most 0, the last two at least 0
    leeway: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)
    standing: Standing | None = None  # The squares in which the robot may stand; None: in that of its place
    imagined: CompletionSummary = NO_COMPLETION_SUMMARY  # Completions: sampled maps that agree with all counts
    # Floor of the map without the moved objects, which these may cover now; None while nothing was moved
    floor_under_moved: Bools | None = None
    # The colours felt in the eight DIRECTIONS with this impression, None for floor; () when not known
    touch: tuple[str | None, ...] = ()
    # The colour of each square that was felt not to be floor, map frame
    felt: Mapping[Square, str] = field(default_factory=dict)
    # Masks of squares on which it is to be felt where exactly one of two things that touch ends
    unsettled_seams: tuple[Bools, ...] = ()
    lost: bool = False  # Whether localisation failed: the last impressions agree with no belief
    anew: bool = False  # Whether the robot has forgotten its map and begun a new one
    interrupted: bool = False  # Whether its track has a gap: for a while it did not know where it was, or was lifted
    elsewhere: bool = False  # Whether others put the robot somewhere, and it has not found yet where on its map that is
    shaken: bool = False  # Whether an impression contradicted another one, or a motion ended beside its predicted place
    contradicted: int = 0  # How many of the last impressions in a row have fields that agree with nothing believed

    @property
    def beyond_doubt(self) -> bool:
        """Whether what the counts settle is so: the robot can stand in no other square, and nothing is unexplained."""
        stands = self.standing is None or self.standing.case == "sure"
        return self.view.sure and stands and not self.lost and not self.contradicted

    @cached_property
    def certain(self) -> Bools:
        """Squares that the counts settle beyond doubt, (rows, columns) bool on the view's arrays."""
        # While the orientation of the frame is uncertain by a few degrees, squares far from the waking point are not
        # among them: a small rotation would put others in their place, and nothing may have shown it yet. A large error
        # of orientation would have shown, wherever there is something to see.
        mask: Bools = (self.view.state != OPEN) & self.beyond_doubt
        if 0 < self.spread <= MAX_SMALL_FRAME_DOUBT:
            x, y = self.frame.origin[0] - self.view.west, self.frame.origin[1] - self.view.south
            rows, columns = np.ogrid[: mask.shape[0], : mask.shape[1]]
            mask &= np.hypot(columns + 0.5 - x, rows + 0.5 - y) * self.spread <= MAX_SQUARE_SHIFT
        return mask

    def likely(self, shape: str) -> Floats:
        """Return the probability that each square belongs to an isolated object of a class: (rows, columns) float."""
        if shape not in self._likely:
            likely = self.imagined.likely(shape)
            self._likely[shape] = likely if likely.size else np.zeros(self.labels.shape)  # none were drawn
        return self._likely[shape]

    @cached_property
    def _likely(self) -> dict[str, Floats]:
        """The same by class, for those that were asked for."""
        return {}

    @cached_property
    def told(self) -> Bools:
        """Squares that are determined, (rows, columns) bool on the view's arrays."""
        return determined_squares(self.view)

    @cached_property
    def floor(self) -> Bools:
        """The free region in which the robot stands, (rows, columns) bool on the view's arrays."""
        row, column = self.view.locate(*self.place)
        if not self.space[row, column] and self.space.any():
            rows, columns = np.nonzero(self.space)
            nearest = np.hypot(rows - row, columns - column).argmin()
            row, column = int(rows[nearest]), int(columns[nearest])
        mask: Bools = self.labels == self.labels[row, column]
        return mask

    @cached_property
    def space(self) -> Bools:
        """All squares that were seen and are taken for floor, reachable or not: (rows, columns) bool."""
        return free_squares(self.view)

    @cached_property
    def verge(self) -> Bools:
        """Squares of regions that are taken for verge rather than for objects, (rows, columns) bool."""
        return self._taken_for("bounds")

    @cached_property
    def walls(self) -> Bools:
        """Squares of regions that are almost surely verge, (rows, columns) bool on the view's arrays."""
        return self._taken_for("wall")

    def _taken_for(self, role: str) -> Bools:
        """Return the squares of regions that are taken for a role (kb/asp/taken.lp): (rows, columns) bool."""
        names = [f"part{n}" for n in range(int(self.labels.max()) + 1)]
        mask: Bools = np.array([self.kinds.is_taken(name, role) for name in names])[self.labels]
        return mask

    @cached_property
    def protruding(self) -> list[Bools]:
        """Masks of parts of the bounds that stick out into the floor and were not touched yet, smaller ones first."""
        felt = self._felt_on_view
        return untouched_parts(protrusions(self.space, self._solid, self.view.seen, felt), felt)

    @cached_property
    def unfelt_pieces(self) -> list[Bools]:
        """Masks of pieces of the bounds that may be things, however long, smaller ones first."""
        things: Bools = np.zeros(self.labels.shape, np.bool_)
        for node in self.objects:
            things |= self.mask(node.patch)
        parts = protrusions(self.space, self._solid, self.view.seen, self._felt_on_view, LONGEST_OBJECT)
        rests = [part & ~things for part in parts]
        return [rest for rest in rests if rest.any() and not (rest & self.felt_verge).any()]

    @cached_property
    def felt_verge(self) -> Bools:
        """Squares that were felt to be verge, (rows, columns) bool on the view's arrays."""
        return self.squares(square for square, colour in self.felt.items() if colour == VERGE_TOUCH_COLOUR)

    @cached_property
    def _felt_on_view(self) -> Mapping[tuple[int, int], str]:
        """The colour of each square (row, column) of the view's arrays that was felt not to be floor."""
        height, width = self.labels.shape
        felt = {self.view.locate(x, y): colour for (x, y), colour in self.felt.items()}
        return {(row, column): c for (row, column), c in felt.items() if 0 <= row < height and 0 <= column < width}

    @cached_property
    def _solid(self) -> Bools:
        """Squares of what bounds the floor, or stands against that and was not moved: (rows, columns) bool."""
        standing, near_verge = self.verge.copy(), with_edge_neighbours(self.verge)
        for patch in (self.mask(node.patch) for node in self.objects if not node.moved):
            standing |= patch & (patch & near_verge).any()  # it was felt to be a thing, and may be larger than that
        mask: Bools = standing & occupied_squares(self.view)
        return mask

    def object(self, name: str) -> Node | None:
        """Return the node of the object with this name, `o<n>`; None when there is none."""
        return next((node for node in self.objects if node.name == name), None)

    @property
    def place_box(self) -> tuple[float, float, float, float]:
        """The west, south, east and north ends of where the robot is, unless lost; frame of the arrays."""
        x, y = self.place_on_view
        west, south, east, north = self.leeway
        far = self.spread * math.dist(self.place, self.frame.origin)
        return x + west - far, y + south - far, x + east + far, y + north + far

    @property
    def robot_squares(self) -> Mapping[Square, float]:
        """The squares in which the robot may stand, map frame, each with its share of the likelihood."""
        if self.standing is None or not self.standing.shares:
            return {(math.floor(self.place[0]), math.floor(self.place[1])): 1.0}
        return self.standing.shares

    @property
    def place_on_view(self) -> XY:
        """The robot's place (x, y) in the frame of the view's arrays."""
        return self.place[0] - self.view.west, self.place[1] - self.view.south

    def place_to_utak(self, x: float, y: float) -> XY:
        """Return a point in the robot frame: (east, north), squares from where the robot woke."""
        return self.frame.place_to_utak(x + self.view.west, y + self.view.south)

    def point_in_words(self, place: XY) -> str:
        """Return a point as text: `POINT (east north)`, robot frame, in squares with one decimal."""
        east, north = self.place_to_utak(*place)
        return f"POINT ({east:.1f} {north:.1f})"

    def squares(self, squares: Iterable[Square]) -> Bools:
        """Return the mask, on the view's arrays, of those of some squares that lie on them."""
        mask: Bools = np.zeros(self.labels.shape, np.bool_)
        for x, y in squares:
            row, column = self.view.locate(x, y)
            if 0 <= row < mask.shape[0] and 0 <= column < mask.shape[1]:
                mask[row, column] = True
        return mask

    def mask(self, patch: Patch) -> Bools:
        """Return the (rows, columns) mask, on the view's arrays, of the part of a patch that lies on them."""
        mask: Bools = np.zeros(self.labels.shape, np.bool_)
        height, width = mask.shape
        row, column = patch.south - self.view.south, patch.west - self.view.west
        rows, columns = patch.mask.shape
        top, right = min(height, row + rows), min(width, column + columns)
        low, left = max(row, 0), max(column, 0)
        if top > low and right > left:
            mask[low:top, left:right] = patch.mask[low - row : top - row, left - column : right - column]
        return mask


def count_open_squares(mask: Bools, view: MapView) -> tuple[int, int]:
    """Return how many squares of a region and its edge neighbours are not determined, and how many are doubtful."""
    about = with_edge_neighbours(mask)
    return int((about & ~determined_squares(view)).sum()), int((about & doubtful_squares(view)).sum())


def free_squares(view: MapView) -> Bools:
    """Return the squares that were seen and are taken for floor: (rows, columns) bool on the view's arrays."""
    mask: Bools = view.seen & (view.probability <= MAX_FREE_PROBABILITY)
    return mask


def occupied_squares(view: MapView) -> Bools:
    """Return the squares that were seen and are at least as likely occupied as not, (rows, columns) bool."""
    mask: Bools = view.seen & (view.probability >= MIN_OBSTACLE_PROBABILITY)
    return mask


def determined_squares(view: MapView) -> Bools:
    """Return the squares that the counts settle or whose probability is close to 0 or 1, (rows, columns) bool."""
    mask: Bools = (
        (view.state != OPEN)
        | (view.probability <= MAX_FREE_PROBABILITY)
        | (view.probability >= 1 - MAX_FREE_PROBABILITY)
    )
    return mask


def doubtful_squares(view: MapView) -> Bools:
    """Return the squares that no count settles and whose probability is far from 0 and 1, (rows, columns) bool."""
    mask: Bools = (
        (view.state == OPEN)
        & (view.probability > MAX_CLEAR_PROBABILITY)
        & (view.probability < 1 - MAX_CLEAR_PROBABILITY)
    )
    return mask
