"""Pieces that touch, and may be one thing or two: the parts of an outline, which is cut at its inner corners.

Geometry names the seams (kb.objects.parts). Which chance two parts have to be one thing, kb/asp/chances.lp says by what
was counted. Objects that touch are no such pieces: they were told apart by what was felt, or by what moved.
"""

from collections.abc import Iterator, Sequence
from functools import lru_cache
from itertools import combinations
from typing import NamedTuple

import numpy as np
import shapely
from shapely import Polygon

from utak.geometry.kernels.arrays import XY
from utak.kb.objects.parts import parts_of
from utak.kb.perception.protrusions import VERGE_TOUCH_COLOUR
from utak.kb.world.model import Node, WorldModel

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
