"""Measuring shapes: which shape classes fit the squares of a patch, and how well. kb/asp/shapes.lp decides."""

from typing import Any, NamedTuple

import numpy as np
import shapely

from geometry.kernels.arrays import Bools
from geometry.shapes.fit import fit_shapes
from kb.mapping.occupancy import OCCUPIED, OPEN, MapView
from kb.mapping.patch import Patch

MIN_COVERED_PROBABILITY = 0.85  # an open square occupied at least so likely is measured as if it were covered; tuned
MAX_OPEN_RATIO = 2.0  # open squares for each covered one, at most: beyond that nothing is measured; tuned


class ShapeMeasurement(NamedTuple):
    """A measurement of a patch.

    Attributes
    ----------
    fits : tuple of (str, int)
        Shape class and number of squares that it leaves wrong, the likeliest class first; () when nothing fits yet.
    polygon : shapely Polygon or None
        The outline of the first class, map frame, in squares; None when nothing fits yet.
    open : int
        How many squares of the patch are not settled.
    full : int
        How many are settled as covered.
    """

    fits: tuple[tuple[str, int], ...]
    polygon: Any
    open: int
    full: int


class ShapeMeasurer:
    """Measures patches, and remembers the fits of all squares that it has measured, so that none is measured twice."""

    def __init__(self) -> None:
        self._known: dict[tuple[bytes, bytes], tuple[tuple[tuple[str, int], ...], Any]] = {}

    def measure(self, patch: Patch, view: MapView) -> ShapeMeasurement:
        """Measure a patch of the map.

        Squares that no count settles count as covered where they are occupied with a probability of at least
        MIN_COVERED_PROBABILITY.

        Parameters
        ----------
        patch : Patch
            The squares that the object covers, or may cover; map frame.
        view : MapView
            The map; the patch lies within its arrays.

        Returns
        -------
        ShapeMeasurement
            Which shape classes fit and the number of squares that each leaves wrong, the likeliest first; the outline
            of the first one (shapely Polygon, map frame, in squares); and how many squares of the patch the counts
            leave open, and settle as covered, probabilities left out. () and None for the first two when no square
            counts as covered, or more than MAX_OPEN_RATIO others for each that does.
        """
        row, column = patch.south - view.south, patch.west - view.west
        part = (slice(row, row + patch.mask.shape[0]), slice(column, column + patch.mask.shape[1]))
        settled = patch.mask & (view.state[part] == OCCUPIED)
        open_ = patch.mask & (view.state[part] == OPEN)
        full = settled | (open_ & (view.probability[part] >= MIN_COVERED_PROBABILITY))
        possible = open_ & ~full
        if not full.any() or possible.sum() > MAX_OPEN_RATIO * full.sum():
            return ShapeMeasurement((), None, int(open_.sum()), int(settled.sum()))
        return self._measured(patch, full, possible)._replace(open=int(open_.sum()), full=int(settled.sum()))

    def measure_whole(self, patch: Patch) -> ShapeMeasurement:
        """Measure a patch, map frame, all of whose squares are known to be covered; at least one.

        The result holds the shape classes that fit with the number of squares that each leaves wrong, the likeliest
        first, the outline of the first one (shapely Polygon, map frame, in squares), 0 open squares, and the number of
        squares of the patch.
        """
        return self._measured(patch, patch.mask, np.zeros_like(patch.mask))

    def _measured(self, patch: Patch, full: Bools, possible: Bools) -> ShapeMeasurement:
        """Return the fits of a patch, the outline of the first of them in the map frame, and the counts of both masks.

        Fits are pairs (shape class, number of squares that it leaves wrong), the likeliest class first; the outline is
        a shapely Polygon in squares; `open` is the number of squares of `possible`, `full` that of `full`.

        `full` and `possible` are (rows, columns) masks, on the patch's own array, of its squares that are covered, and
        of those that may be.
        """
        fits, polygon = self._fit(full, possible)
        placed = shapely.transform(polygon, lambda points: points + np.array([patch.west, patch.south]))
        return ShapeMeasurement(fits, placed, int(possible.sum()), int(full.sum()))

    def _fit(self, full: Bools, possible: Bools) -> tuple[tuple[tuple[str, int], ...], Any]:
        """Return the fits of some squares, and the outline of the first, in the frame of the masks.

        The fits are pairs (shape class, number of squares that it leaves wrong), the likeliest class first; the outline
        is a shapely Polygon, in squares, origin at the south-west corner of the masks' square [0, 0].
        """
        key = (full.tobytes() + bytes(full.shape), possible.tobytes())
        if key not in self._known:
            found = fit_shapes(full, possible)
            self._known[key] = (tuple((fit.shape, fit.misfit) for fit in found), found[0].polygon)
        return self._known[key]
