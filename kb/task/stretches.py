"""Stretches of what bounds the floor, as wide as a doorway and never felt, with floor on both sides: maybe things.

A thing that fills a doorway looks like wall. What is seen of it is where it ends: of walls with floor on both sides
some end along a line. How often stretches of such a thickness were things, kb/asp/chances.lp says by what was counted.

Masks are (rows, columns) bool on the arrays of the view, row 0 in the south.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from utak.geometry.kernels.arrays import Bools
from utak.geometry.raster.runs import runs_along_rows
from utak.kb.world.model import WorldModel, hundredths

MIN_WIDTH, MAX_WIDTH = 2, 8  # squares along the wall: doorways are about so wide; a convention
MAX_THICK_WALL = 12  # squares of wall through which floor behind it makes a doorway likely; a convention


class Stretch(NamedTuple):
    """A stretch of what bounds the floor that was never felt, with floor on both sides."""

    name: str  # w1, w2, ... from the south-west on; another one may have the name after the next impression
    mask: Bools  # its squares
    width: int  # squares along the wall, between places where it is thinner, thicker or ends
    thickness: int  # squares from floor to floor

    @property
    def case(self) -> str:
        """Whether it is as narrow as they may be (slim), up to twice as wide (broad), or wider (wide)."""
        return "slim" if self.width == MIN_WIDTH else "broad" if self.width <= 2 * MIN_WIDTH else "wide"

    @property
    def fact(self) -> str:
        """The same for kb/asp/chances.lp, without a full stop."""
        return f"unfelt({self.name},{self.case},{self.thickness})"

    def rectangle(self, model: WorldModel) -> str:
        """Return its containing rectangle as stretch/5, without a full stop."""
        rows, columns = np.nonzero(self.mask)
        corners = [(columns.min(), rows.min()), (columns.max() + 1, rows.max() + 1)]
        ends = np.array([model.place_to_utak(float(x), float(y)) for x, y in corners])
        return f"stretch({self.name},{','.join(str(hundredths(v)) for v in (*ends.min(0), *ends.max(0)))})"


def stretches(model: WorldModel) -> list[Stretch]:
    """Return the stretches of what bounds the floor that were never felt, from the south-west on."""
    wall = model.view.seen & ~model.space
    for node in model.objects:
        wall &= ~model.mask(node.patch)
    found = [*_across(wall, model.space)]
    found += [(mask.T, wide, thick) for mask, wide, thick in _across(wall.T, model.space.T)]
    unfelt = sorted(
        (one for one in found if not (one[0] & model.felt_verge).any()), key=lambda one: int(one[0].argmax())
    )
    return [Stretch(f"w{number}", *one) for number, one in enumerate(unfelt, 1)]


def _across(wall: Bools, space: Bools) -> Iterator[tuple[Bools, int, int]]:
    """Yield rectangles of wall with floor to the west and to the east: masks, with their rows and their columns."""
    begun: dict[tuple[int, int], int] = {}  # by columns, from the first to behind the last: in which row they begin
    standing, ground = np.pad(wall, ((0, 1), (0, 0))), np.pad(space, ((0, 1), (0, 0)))  # a row without wall ends all
    between: dict[int, set[tuple[int, int]]] = {}
    for row, start, stop in runs_along_rows(np.ascontiguousarray(standing)).each():
        inside = start > 0 and stop < standing.shape[1] and stop - start <= MAX_THICK_WALL
        if inside and ground[row, start - 1] and ground[row, stop]:
            between.setdefault(row, set()).add((start, stop))
    for row in range(len(standing)):
        here = between.get(row, set())
        for start, stop in sorted(begun.keys() - here):
            first = begun.pop((start, stop))
            free = first > 0 and bool(ground[[first - 1, row], start:stop].all())  # floor lies all round
            if MIN_WIDTH <= row - first <= MAX_WIDTH and not free:
                mask: Bools = np.zeros_like(wall)
                mask[first:row, start:stop] = True
                yield mask, row - first, stop - start
        for columns in here:
            begun.setdefault(columns, row)
