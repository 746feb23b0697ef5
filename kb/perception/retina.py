"""Counts of occupied squares that the gray levels of the retina stand for."""

from functools import cache

import numpy as np
from numpy.typing import NDArray

from utak.geometry.counts.retina import FIELDS, OWN_FIELD, gray_level


@cache
def level_counts(side: int, level: int) -> tuple[int, int]:
    """Return the least and the greatest number of occupied squares that a field shows as a gray level."""
    area = side * side
    fitting = [n for n in range(area + 1) if gray_level(n, side) == level]
    if not fitting:
        raise ValueError(f"a field of {side} x {side} squares never shows gray level {level}")
    return fitting[0], fitting[-1]


def count_ranges(levels: tuple[int, ...]) -> NDArray[np.int16]:
    """Return the least and the greatest number of occupied squares under each field."""
    ranges = np.array([level_counts(field.side, level) for field, level in zip(FIELDS, levels, strict=True)], np.int16)
    ranges[OWN_FIELD] = (0, 1)
    return ranges
