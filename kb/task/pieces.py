"""Pieces that may be one thing or two, and stretches of what bounds the floor that may be things.

An outline is cut at its inner corners: geometry names the seams (kb.objects.parts). Objects that touch are no such
pieces: they were told apart by what was felt, or by what moved. Which chances there are, kb/asp/chances.lp says by what
was counted.
"""

from collections.abc import Iterator, Sequence
from functools import lru_cache
from itertools import combinations
from typing import NamedTuple

import numpy as np
import shapely
from shapely import Polygon

from utak.geometry.kernels.arrays import XY, Bools
from utak.geometry.raster.components import components, with_edge_neighbours
from utak.kb.objects.parts import parts_of
from utak.kb.perception.protrusions import VERGE_TOUCH_COLOUR
from utak.kb.world.model import Node, WorldModel, hundredths
from utak.kb.world.rooms import Rooms

MIN_BORDER = 1e-6  # squares: pieces with a shorter border meet in a point
FELT_DISTANCE = 1.0  # squares: what was felt on a square further from an outline is not on it; convention
BENT_CLASSES = ("l_shape", "t_shape", "u_shape")  # of outlines with inner corners


class Touching(NamedTuple):
    """Two parts of an outline that have a border in common, in which they were not felt to differ."""

    one: str  # such as o1_1
    other: str
    felt: bool  # whether both were felt, in the same colour
    share: int  # percent: of belief that the outline is of a class with inner corners
    whole: bool  # whether they were seen to move as one thing

    @property
    def facts(self) -> tuple[str, ...]:
        """The same for kb/asp/chances.lp, without full stops."""
        touch = f"touch({self.one},{self.other},{'same' if self.felt else 'unfelt'},{self.share})"
        return (touch, f"whole({self.one})") if self.whole else (touch,)


class Stretch(NamedTuple):
    """A stretch of what bounds the floor that was never felt, and may be a thing."""

    name: str  # w1, w2, ... from the south-west on; another one may have the name after the next impression
    mask: Bools  # its squares, on the arrays of the view
    parts: bool  # whether it lies between two floors, or two rooms, as what stands in a doorway does

    @property
    def fact(self) -> str:
        """The same for kb/asp/chances.lp, without a full stop."""
        return f"unfelt({self.name},{'parting' if self.parts else 'sticking'},{int(self.mask.sum())})"

    def place(self, model: WorldModel) -> str:
        """Return its containing rectangle as stretch/5, without a full stop."""
        rows, columns = np.nonzero(self.mask)
        west, south, east, north = columns.min(), rows.min(), columns.max() + 1, rows.max() + 1
        (x, y), (z, w) = model.place_to_utak(west, south), model.place_to_utak(east, north)
        sides = min(x, z), min(y, w), max(x, z), max(y, w)
        return f"stretch({self.name},{','.join(str(hundredths(side)) for side in sides)})"


def unfelt_stretches(model: WorldModel, rooms: Rooms) -> Iterator[Stretch]:
    """Yield the stretches of what bounds the floor that may be things."""
    pieces = {piece.tobytes(): piece for piece in model.unfelt_pieces}  # some are found in several ways
    if not pieces:
        return
    floors = components(model.space).labels
    order = sorted(pieces.values(), key=lambda piece: (*np.argwhere(piece)[0].tolist(), int(piece.sum())))
    for number, piece in enumerate(order, 1):
        beside = with_edge_neighbours(piece) & ~piece
        parts = any(len(np.unique(labels[beside & (labels > 0)])) > 1 for labels in (floors, rooms.labels))
        yield Stretch(f"w{number}", piece, parts)


@lru_cache(maxsize=1024)
def borders(outline: Polygon) -> tuple[tuple[int, int], ...]:
    """Return the pairs of parts of an outline, by number from 1, that have a border in common."""
    pairs = combinations(enumerate(parts_of(outline), 1), 2)
    return tuple((n, m) for (n, one), (m, other) in pairs if shapely.intersection(one, other).length > MIN_BORDER)


def touching_pieces(model: WorldModel) -> Iterator[Touching]:
    """Yield the pairs of parts of outlines that touch, object by object."""
    felt = [((x + 0.5, y + 0.5), colour) for (x, y), colour in model.felt.items() if colour != VERGE_TOUCH_COLOUR]
    for node in model.objects:
        pairs = () if node.polygon is None else borders(node.polygon)
        colours = _colours(node, felt) if pairs and not node.moved else {}  # what was felt lies where it was felt
        share = max(node.shape.get(name, 0) for name in BENT_CLASSES)
        for n, m in pairs:
            one, other = colours.get(n), colours.get(m)
            known = one is not None and other is not None
            if not known or one == other:
                yield Touching(f"{node.name}_{n}", f"{node.name}_{m}", known, share, node.whole)


def _colours(node: Node, felt: Sequence[tuple[XY, str]]) -> dict[int, str]:
    """Return the colours that were felt on the parts of an outline, by number of the part."""
    parts, colours = parts_of(node.polygon), {}
    for place, colour in felt:
        away = [part.distance(shapely.Point(place)) for part in parts]
        nearest = int(np.argmin(away))
        if away[nearest] <= FELT_DISTANCE:
            colours[nearest + 1] = colour
    return colours
