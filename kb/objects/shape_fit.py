"""Measuring objects: which shapes fit the squares of a patch, and how well. Geometry measures.

Kb/asp/shapes.lp decides.
"""

from typing import Any, NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray

from geometry.shapes.fit import fit_shapes
from kb.mapping.occupancy import FULL, OPEN, MapView
from kb.mapping.patch import Patch

Mask = NDArray[np.bool_]
LIKELY = 0.85  # that a square is covered: then it is measured as if it were
MOST_OPEN = 2.0  # times as many open squares as settled ones: beyond that nothing is measured


class Measured(NamedTuple):
    """What was measured of a patch.

    fits: (class, squares wrong) pairs, the likeliest first. polygon: the first one's outline in the lattice, or None.
    open, full: squares that are not settled, and that are settled as covered.
    """

    fits: tuple[tuple[str, int], ...]
    polygon: Any
    open: int
    full: int


class Measurer:
    """Measures patches, and remembers what it measured."""

    def __init__(self) -> None:
        self._known: dict[tuple[bytes, bytes], tuple[tuple[tuple[str, int], ...], Any]] = {}

    def measure(self, patch: Patch, view: MapView) -> Measured:
        """The fits of one patch of the map."""
        row, column = patch.south - view.south, patch.west - view.west
        part = (slice(row, row + patch.mask.shape[0]), slice(column, column + patch.mask.shape[1]))
        settled = patch.mask & (view.state[part] == FULL)
        open_ = patch.mask & (view.state[part] == OPEN)
        full = settled | (open_ & (view.probability[part] >= LIKELY))
        possible = open_ & ~full
        if not full.any() or possible.sum() > MOST_OPEN * full.sum():
            return Measured((), None, int(open_.sum()), int(settled.sum()))
        return self._fitted(patch, full, possible)._replace(open=int(open_.sum()), full=int(settled.sum()))

    def measure_whole(self, patch: Patch) -> Measured:
        """The fits of a patch of which all is known."""
        return self._fitted(patch, patch.mask, np.zeros_like(patch.mask))

    def _fitted(self, patch: Patch, full: Mask, possible: Mask) -> Measured:
        """The fits of the squares of a patch that are covered, or may be."""
        fits, polygon = self._fit(full, possible)
        placed = shapely.transform(polygon, lambda points: points + np.array([patch.west, patch.south]))
        return Measured(fits, placed, int(possible.sum()), int(full.sum()))

    def _fit(self, full: Mask, possible: Mask) -> tuple[tuple[tuple[str, int], ...], Any]:
        key = (full.tobytes() + bytes(full.shape), possible.tobytes())
        if key not in self._known:
            found = fit_shapes(full, possible)
            self._known[key] = (tuple((fit.shape, fit.misfit) for fit in found), found[0].polygon)
        return self._known[key]
