"""The distance transform of a whole screen at once, without bands and skeleton."""

from geometry.raster.distance_rows import measure_rows, new_window
from geometry.raster.distance_transform import count_columns


def measure(free, square):
    """Fill ``square`` (rows + 2, columns + 2) for free squares (rows, columns); return whether its type holds it."""
    steps = square.view("int16")
    count_columns(free, steps)
    return measure_rows(square, steps, 1, len(free), new_window(square.shape[1]))
