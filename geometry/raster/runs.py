"""Runs: maximal series of True squares along a row of a mask, and the polygon that a mask covers."""

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
import shapely

from utak.geometry.kernels.arrays import Bools, Longs


class Runs(NamedTuple):
    """The runs of a mask, row by row, from west to east in each."""

    rows: Longs  # (n,) int64, the row of each run
    first: Longs  # (n,) int64, its first column, and the column after its last
    after: Longs

    def each(self) -> Iterator[tuple[int, int, int]]:
        """Yield row, first column and column after the last of each run."""
        yield from zip(self.rows.tolist(), self.first.tolist(), self.after.tolist(), strict=True)


def runs_along_rows(mask: Bools) -> Runs:
    """Return the runs of True squares of a mask along its rows."""
    change = np.diff(np.pad(mask, ((0, 0), (1, 1))).astype(np.int8), axis=1)
    rows, first = np.nonzero(change == 1)
    return Runs(rows, first, np.nonzero(change == -1)[1])


def mask_to_polygon(mask: Bools) -> Any:
    """Convert a mask (rows, columns) of bool to one shapely geometry, in squares, in the frame of the array."""
    rows, first, after = runs_along_rows(mask)
    return shapely.union_all(shapely.box(first, rows, after, rows + 1))
