"""The distance transform of a whole screen at once, without bands and skeleton."""

from utak.geometry.raster.distance_rows import fill_distance_rows, new_row_window
from utak.geometry.raster.distance_transform import count_steps_south


def measure(free, square):
    """Fill ``square`` (rows + 2, columns + 2) for free squares (rows, columns); return whether its type holds it."""
    steps = square.view("int16")
    count_steps_south(free, steps)
    return fill_distance_rows(square, steps, 1, len(free), new_row_window(square.shape[1]))
