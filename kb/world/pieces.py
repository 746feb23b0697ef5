"""Pieces that touch, and may be one thing or several: the parts of an outline, and objects that may touch each other.

Geometry names the seams: an outline is cut at its inner corners (kb.objects.parts). Which chance each pair has to be one
thing, kb/asp/chances.lp says by what was counted.
"""

from collections.abc import Iterator
from functools import lru_cache
from itertools import combinations
from typing import NamedTuple

import numpy as np
import shapely
from shapely import Polygon

from utak.geometry.kernels.arrays import Square
from utak.geometry.raster.components import with_edge_neighbours
from utak.kb.objects.parts import parts_of
from utak.kb.perception.protrusions import VERGE_TOUCH_COLOUR
from utak.kb.world.model import Node, WorldModel

MIN_BORDER = 1e-6  # squares: pieces with a shorter border meet in a point


class Touching(NamedTuple):
    """Two pieces that touch."""

    one: str  # o1_1, or o1
    other: str
    case: str  # parts (of one outline) or nodes
    colours: str  # same, unfelt (at least one of them) or different
    share: int  # percent: of belief that the outline is of its class; of nodes 0
    whole: bool  # whether they were seen to move as one

    @property
    def fact(self) -> str:
        """The same for kb/asp/chances.lp, without a full stop."""
        return f"touch({self.one},{self.other},{self.case},{self.colours},{self.share})"


@lru_cache(maxsize=1024)
def outline_parts(outline: Polygon) -> tuple[Polygon, ...]:
    """Return the parts of an outline, which stays the same over many steps; () for one."""
    return parts_of(outline)


@lru_cache(maxsize=1024)
def borders(outline: Polygon) -> tuple[tuple[int, int], ...]:
    """Return the pairs of parts of an outline, by number from 1, that have a border in common."""
    pairs = combinations(enumerate(outline_parts(outline), 1), 2)
    return tuple((n, m) for (n, one), (m, other) in pairs if shapely.intersection(one, other).length > MIN_BORDER)


def touching_pieces(model: WorldModel) -> Iterator[Touching]:
    """Yield the pieces that touch: of each outline, by number, then objects that lie edge to edge."""
    felt = [((x + 0.5, y + 0.5), colour) for (x, y), colour in model.felt.items() if colour != VERGE_TOUCH_COLOUR]
    for node in model.objects:
        yield from _parts(node, felt)
    for one, other in combinations(model.objects, 2):
        if _lie_edge_to_edge(one, other):
            yield Touching(one.name, other.name, "nodes", _compared(one.colour, other.colour), 0, False)


def _parts(node: Node, felt: list[tuple[tuple[float, float], str]]) -> Iterator[Touching]:
    """Yield the pairs of parts of an outline that have a border in common."""
    pairs = () if node.polygon is None else borders(node.polygon)
    if not pairs:
        return
    parts = outline_parts(node.polygon)
    colours: list[str | None] = [None] * len(parts)
    if not node.moved:  # what was felt lies where it was felt
        for place, colour in felt:
            away = [part.distance(shapely.Point(place)) for part in parts]
            nearest = int(np.argmin(away))
            colours[nearest] = colour if away[nearest] <= 1 else colours[nearest]
    share = max((node.shape.get(name, 0) for name in ("l_shape", "t_shape", "u_shape")), default=0)
    for n, m in pairs:
        name = node.name
        yield Touching(
            f"{name}_{n}", f"{name}_{m}", "parts", _compared(colours[n - 1], colours[m - 1]), share, node.whole
        )


def _compared(one: str | None, other: str | None) -> str:
    """Return how two colours compare."""
    if one is None or other is None:
        return "unfelt"
    return "same" if one == other else "different"


def _lie_edge_to_edge(one: Node, other: Node) -> bool:
    """Return whether a square of one object has an edge in common with one of another."""
    if one.moved or other.moved:
        return False  # each is known by itself
    a, b = one.patch, other.patch
    if a.west > b.west + b.mask.shape[1] or b.west > a.west + a.mask.shape[1]:
        return False
    if a.south > b.south + b.mask.shape[0] or b.south > a.south + a.mask.shape[0]:
        return False
    beside = _beside(one)
    return any(square in beside for square in b.squares())


def _beside(node: Node) -> frozenset[Square]:
    """Return the squares of an object and those that have an edge in common with one."""
    mask = with_edge_neighbours(np.pad(node.patch.mask, 1))
    rows, columns = np.nonzero(mask)
    west, south = node.patch.west - 1, node.patch.south - 1
    return frozenset(zip((columns + west).tolist(), (rows + south).tolist(), strict=True))
