"""Measuring shapes: which shape classes fit the squares of a patch, and how well. kb/asp/shapes.lp decides."""

from collections.abc import Mapping
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
import shapely

from utak.geometry.kernels.arrays import Bools
from utak.geometry.motion.se2 import Translate
from utak.geometry.raster.runs import mask_to_polygon
from utak.geometry.shapes.fit import Fit, fit_shapes
from utak.kb.mapping.occupancy import OCCUPIED, OPEN, MapView
from utak.kb.mapping.patch import Patch

MIN_COVERED_PROBABILITY = 0.85  # an open square occupied at least so likely is measured as if it were covered; tuned
MAX_MEASUREMENTS = 2048  # measurements that are remembered; a bound on memory
MAX_OPEN_RATIO = 2.0  # open squares for each covered one, at most: beyond that nothing is measured; tuned


class ShapeMeasurement(NamedTuple):
    """A measurement of a patch."""

    # Shape class and number of squares that it leaves wrong, the likeliest class first; () when nothing fits yet
    fits: tuple[tuple[str, int], ...]
    polygon: Any  # The outline of the first class, map frame, in squares; None when nothing fits yet
    open: int  # How many squares of the patch are not settled
    full: int  # How many are settled as covered
    others: Mapping[str, Any] = {}  # The outlines of the other classes, from the south-west corner of the patch

    def traced(self, patch: Patch) -> "ShapeMeasurement":
        """Return the measurement with the outline of the squares of the patch, if they are connected by their sides."""
        outline = mask_to_polygon(patch.mask)
        if outline.geom_type != "Polygon":
            return self
        ring = shapely.Polygon(outline.exterior).simplify(0.0)
        return self._replace(polygon=Translate(patch.west, patch.south).carry(ring))


def measure_seen(patch: Patch, view: MapView) -> ShapeMeasurement:
    """Measure a patch of the map."""
    row, column = patch.south - view.south, patch.west - view.west
    part = (slice(row, row + patch.mask.shape[0]), slice(column, column + patch.mask.shape[1]))
    settled = patch.mask & (view.state[part] == OCCUPIED)
    open_ = patch.mask & (view.state[part] == OPEN)
    full = settled | (open_ & (view.probability[part] >= MIN_COVERED_PROBABILITY))
    possible = open_ & ~full
    if not full.any() or possible.sum() > MAX_OPEN_RATIO * full.sum():
        return ShapeMeasurement((), None, int(open_.sum()), int(settled.sum()))
    return _measured(patch, full, possible)._replace(open=int(open_.sum()), full=int(settled.sum()))


def measure_whole(patch: Patch) -> ShapeMeasurement:
    """Measure a patch, map frame, all of whose squares are known to be covered; at least one."""
    return _measured(patch, patch.mask, np.zeros_like(patch.mask))


def _measured(patch: Patch, full: Bools, possible: Bools) -> ShapeMeasurement:
    """Return the fits of a patch, the outline of the first of them, and the counts of both masks."""
    found = _fits(full.tobytes(), possible.tobytes(), full.shape)
    fits = tuple((fit.shape, fit.misfit) for fit in found)
    placed = Translate(patch.west, patch.south).carry(found[0].polygon)
    others = {fit.shape: fit.polygon for fit in found[1:]}
    return ShapeMeasurement(fits, placed, int(possible.sum()), int(full.sum()), others)


@lru_cache(maxsize=MAX_MEASUREMENTS)
def _fits(full: bytes, possible: bytes, shape: tuple[int, int]) -> tuple[Fit, ...]:
    """Return the fits of some squares, the likeliest first, in the frame of the masks."""
    return tuple(fit_shapes(*(np.frombuffer(squares, np.bool_).reshape(shape) for squares in (full, possible))))
