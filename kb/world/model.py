"""The world model: a tree of nodes, rooted in Utak, made anew after every impression from the map and its
interpretation.

$org (Utak) has one son, $floor; its sons are the verge and the isolated objects. A node's place is the offset to its
parent, so that when Utak moves, or an object is pushed, one relation changes. Values are frozen; what persists from
one impression to the next is only which node a patch of squares belongs to (`Names`).
"""

import math
from collections import Counter
from collections.abc import Container, Iterable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from geometry.raster.components import edged
from kb.mapping.object_heat import NOTHING_IMAGINED, CompletionSummary
from kb.mapping.occupancy import OPEN, MapView
from kb.mapping.patch import Patch
from kb.objects.subcell_extent import NONE, Sides, SubcellExtent
from kb.perception.frame import Frame
from kb.perception.interpretation import Kinds
from kb.perception.protrusions import protrusions, unfelt
from kb.perception.regions import Percept

NEARLY = math.radians(5)  # by which two lattices differ little enough to explain the same impressions
SHIFTED = 0.3  # squares by which a square may lie elsewhere and still be the same
SPACE = 0.06  # a square that is occupied with at most this probability counts as floor
SOLID = 0.5  # a square that is occupied with at least this probability may be part of a thing
CLEAR = 0.12  # a square that is occupied, or free, but for this probability is not in doubt
SMALLEST_WALL = 13  # squares: what is one thing and as long as this is no object
SURELY_VERGE = 40 + 4 * SMALLEST_WALL  # percent: as sure of verge as kb/asp/interpretation.lp is of what goes on so far
ORG, FLOOR, VERGE = "org", "floor", "verge"

Mask = NDArray[np.bool_]


@dataclass(frozen=True)
class Node:
    """A part of the world.

    Attributes
    ----------
    kind : verge or object. confidence : that it is, in percent.
    region : its region of the map. patch : the squares that it covers, or may cover.
    open : how many of them (and of their neighbours) are not told. vague : how many of those look doubtful.
    shape : class -> confidence. polygon : its believed outline (shapely, lattice frame), None while nothing fits.
    colour : as felt, or None. support : the impressions that settled its squares.
    movable : that it can be moved, in percent. moved : he has moved it. turned : degrees by which, since he first held
    it. stuck : motions in a row that did not move it. dubious : it may well lie elsewhere or be of another outline, for
    what is seen agrees ill with how it came there. inexact : it lies only about there. astray : it does until it is
    turned back, for by a turn lies elsewhere what is turned by one who did not wake where he believes. short : by how
    many squares its sides, to the west, east, south and north, may lie further in than those of its outline. insets :
    how far in they lie within the squares in which it was seen; None when they do not lie along them.
    """

    name: str
    kind: str
    confidence: int
    region: str
    patch: Patch
    open: int
    vague: int = 0
    shape: Mapping[str, int] = field(default_factory=dict)
    polygon: Any = None
    colour: str | None = None
    support: tuple[int, ...] = ()
    movable: int = 50
    moved: bool = False
    turned: float = 0.0
    stuck: int = 0
    dubious: bool = False
    inexact: bool = False
    astray: bool = False
    short: Sides = NONE
    insets: SubcellExtent | None = None


@dataclass(frozen=True)
class WorldModel:
    """All that is believed after one impression.

    Attributes
    ----------
    lattice, place : the frame, and Utak's place (a point of the lattice).
    view : the map. labels : (rows, columns) the regions' numbers, as in `part<n>`.
    percept, kinds : the regions and what they are taken for.
    objects : the isolated objects, and what may be one, by name.
    held : the node that is held, or None.
    looked_from : the squares on which an impression was received. barred : squares that stopped a motion, or likely
    did.
    spread, likely_spread : by how many radians the lattice may still lie otherwise than believed, and likely may.
    leeway : (west, south, east, north) how far from where he believes it he may have woken in his square, the first two
    not above 0.
    imagined : pictures that agree with all counts.
    beneath : (rows, columns), floor of the standing map, upon which things that he has moved may lie now; None while he
    has moved none.
    touch : as of the impression, the colours felt in DIRECTIONS; () when it is not known. felt : squares of the lattice
    of which it is known what colour they have.
    lost : does what he sees agree with none of it? anew : has he begun anew, and forgotten what he had seen before?
    shaken : did a look contradict another one, or a motion end beside where it should?
    contradicted : is there a part of the impression that agrees with nothing that is believed?
    """

    frame: Frame
    place: tuple[float, float]
    view: MapView
    labels: NDArray[np.int32]
    percept: Percept
    kinds: Kinds
    objects: tuple[Node, ...]
    held: str | None = None
    looked_from: frozenset[tuple[int, int]] = frozenset()
    barred: frozenset[tuple[int, int]] = frozenset()
    spread: float = 0.0
    likely_spread: float = 0.0
    leeway: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)
    imagined: CompletionSummary = NOTHING_IMAGINED
    beneath: Mask | None = None
    touch: tuple[str | None, ...] = ()
    felt: Mapping[tuple[int, int], str] = field(default_factory=dict)
    lost: bool = False
    anew: bool = False
    shaken: bool = False
    contradicted: bool = False

    @cached_property
    def certain(self) -> Mask:
        """(rows, columns): squares that the counts settle beyond doubt.

        While the lattice may lie a few degrees otherwise, those so far from where he woke that they would be others are
        not among them: nothing may have shown it yet. Much otherwise would have shown, wherever there is something to
        show it.
        """
        mask: Mask = (self.view.state != OPEN) & self.view.sure
        if 0 < self.spread <= NEARLY:
            x, y = self.frame.origin[0] - self.view.west, self.frame.origin[1] - self.view.south
            rows, columns = np.ogrid[: mask.shape[0], : mask.shape[1]]
            mask &= np.hypot(columns + 0.5 - x, rows + 0.5 - y) * self.spread <= SHIFTED
        return mask

    @cached_property
    def told(self) -> Mask:
        """(rows, columns): squares that the counts settle, and those that all pictures show alike."""
        return told(self.view)

    @cached_property
    def floor(self) -> Mask:
        """(rows, columns): the zero region in which Utak stands; the nearest one when he believes himself in a wall."""
        row, column = self.view.locate(*self.place)
        if not self.space[row, column] and self.space.any():
            rows, columns = np.nonzero(self.space)
            nearest = np.hypot(rows - row, columns - column).argmin()
            row, column = int(rows[nearest]), int(columns[nearest])
        mask: Mask = self.labels == self.labels[row, column]
        return mask

    @cached_property
    def space(self) -> Mask:
        """(rows, columns): all squares seen and taken for floor, wherever they are."""
        return space(self.view)

    @cached_property
    def verge(self) -> Mask:
        """(rows, columns): squares of regions taken for verge rather than for objects."""
        return self._believed_verge(51)

    @cached_property
    def walls(self) -> Mask:
        """(rows, columns): squares of regions that are hardly anything but verge."""
        return self._believed_verge(SURELY_VERGE)

    def _believed_verge(self, least: int) -> Mask:
        names = [f"part{n}" for n in range(int(self.labels.max()) + 1)]
        mask: Mask = np.array([self.kinds.of(name, "verge") >= least for name in names])[self.labels]
        return mask

    @cached_property
    def protruding(self) -> list[Mask]:
        """(rows, columns) masks of what sticks out into the floor from what bounds it, and was not felt."""
        height, width = self.labels.shape
        felt = {self.view.locate(x, y): colour for (x, y), colour in self.felt.items()}
        within = {(row, column): c for (row, column), c in felt.items() if 0 <= row < height and 0 <= column < width}
        standing, beside = self.verge.copy(), edged(self.verge)
        for patch in (self.mask(node.patch) for node in self.objects if not node.moved):
            standing |= patch & (patch & beside).any()  # what was felt to be a thing, and may go on
        return unfelt(protrusions(self.space, standing & solid(self.view), self.view.seen), within)

    def object(self, name: str) -> Node | None:
        """The object of this name, if there is one."""
        return next((node for node in self.objects if node.name == name), None)

    @property
    def place_on_view(self) -> tuple[float, float]:
        """Where Utak stands, in the frame of the view's arrays."""
        return self.place[0] - self.view.west, self.place[1] - self.view.south

    def place_to_utak(self, x: float, y: float) -> tuple[float, float]:
        """A point of the frame of the view's arrays, in Utak's own: east and north of where he woke."""
        return self.frame.place_to_utak(x + self.view.west, y + self.view.south)

    def point_in_words(self, place: tuple[float, float]) -> str:
        """Return a point of the frame of the view's arrays as one of Utak's own frame, in words."""
        east, north = self.place_to_utak(*place)
        return f"POINT ({east:.1f} {north:.1f})"

    def squares(self, squares: Iterable[tuple[int, int]]) -> Mask:
        """(rows, columns): squares of the lattice on the arrays of the view."""
        mask: Mask = np.zeros(self.labels.shape, np.bool_)
        for x, y in squares:
            row, column = self.view.locate(x, y)
            if 0 <= row < mask.shape[0] and 0 <= column < mask.shape[1]:
                mask[row, column] = True
        return mask

    def mask(self, patch: Patch) -> Mask:
        """(rows, columns): a patch on the arrays of the view."""
        mask = np.zeros(self.labels.shape, np.bool_)
        row, column = patch.south - self.view.south, patch.west - self.view.west
        mask[row : row + patch.mask.shape[0], column : column + patch.mask.shape[1]] = patch.mask
        return mask

    def mask_within(self, patch: Patch) -> Mask:
        """(rows, columns): what lies within the view of a patch that may reach beyond it."""
        mask: Mask = np.zeros(self.labels.shape, np.bool_)
        height, width = mask.shape
        row, column = patch.south - self.view.south, patch.west - self.view.west
        rows, columns = patch.mask.shape
        top, right = min(height, row + rows), min(width, column + columns)
        low, left = max(row, 0), max(column, 0)
        if top > low and right > left:
            mask[low:top, left:right] = patch.mask[low - row : top - row, left - column : right - column]
        return mask


class Names:
    """Which name each patch has: a patch keeps the name of the one that it shares most squares with."""

    def __init__(self) -> None:
        self._known: dict[str, set[tuple[int, int]]] = {}
        self._count = 0

    def assign(self, patches: list[Patch], borne: Container[str] = ()) -> list[str]:
        """Names for patches, the old ones first; names that no patch continues are forgotten.

        borne : names that others bear now: what is left where such a thing lay is another one.
        """
        squares = [patch.squares() for patch in patches]
        owner = {square: name for name, known in self._known.items() if name not in borne for square in known}
        shared = Counter((owner[square], i) for i, own in enumerate(squares) for square in own if square in owner)
        names: dict[int, str] = {}
        taken = set()
        for name, i in sorted(shared, key=lambda share: (-shared[share], int(share[0][1:]), share[1])):
            if i not in names and name not in taken:
                names[i] = name
                taken.add(name)
        for i in range(len(patches)):
            if i not in names:
                self._count += 1
                names[i] = f"o{self._count}"
        self._known = {names[i]: own for i, own in enumerate(squares)}
        return [names[i] for i in range(len(patches))]

    def forget(self) -> None:
        """Give new names to all patches from now on."""
        self._known = {}


def unsettled(mask: Mask, view: MapView) -> tuple[int, int]:
    """How many squares of a region, and of the squares that touch it, are not told; how many look doubtful."""
    about = edged(mask)
    return int((about & ~told(view)).sum()), int((about & in_doubt(view)).sum())


def space(view: MapView) -> Mask:
    """(rows, columns): squares seen and taken for floor."""
    mask: Mask = view.seen & (view.probability <= SPACE)
    return mask


def solid(view: MapView) -> Mask:
    """(rows, columns): squares on which something rather is than not."""
    mask: Mask = view.seen & (view.probability >= SOLID)
    return mask


def told(view: MapView) -> Mask:
    """(rows, columns): squares that the counts settle, and those that all pictures show alike."""
    mask: Mask = (view.state != OPEN) | (view.probability <= SPACE) | (view.probability >= 1 - SPACE)
    return mask


def in_doubt(view: MapView) -> Mask:
    """(rows, columns): squares that no count settles and of which it is open how they look, too."""
    mask: Mask = (view.state == OPEN) & (view.probability > CLEAR) & (view.probability < 1 - CLEAR)
    return mask
