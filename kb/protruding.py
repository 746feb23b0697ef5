"""Parts of what bounds the floor that stick out into it, and may be things that stand against it.

What touches a wall is one with it to the eye: only touch tells them apart. But a thing is short, and floor lies on both
sides of it, or on two sides that meet where it stands in a corner.
"""

from collections.abc import Iterator, Mapping

import numpy as np
from numpy.typing import NDArray

from geometry.components import boxes, components, edged

Mask = NDArray[np.bool_]
Place = tuple[int, int]
VERGE = "b"  # its colour
LONGEST = 10  # squares that a thing may measure between floor and floor, or from a corner to a wall
LARGEST = 12  # squares that it may measure in all


def protrusions(floor: Mask, solid: Mask) -> list[Mask]:
    """What sticks out into the floor: (rows, columns) masks, the smaller first. What stands free does not.

    floor, solid : (rows, columns) squares where floor is seen, and where something is.
    """
    found = [*_between(floor, solid), *(mask.T for mask in _between(floor.T, solid.T)), *_in_corners(floor, solid)]
    unlike = {mask.tobytes(): mask for mask in found if (edged(mask) & solid & ~mask).any()}
    return sorted(unlike.values(), key=lambda mask: int(mask.sum()))


def told_apart(parts: list[Mask], felt: Mapping[Place, str]) -> list[Mask]:
    """Of such parts those that are things, by what was felt of them: the smallest with each square that is no wall.

    felt : the colour of each square (row, column) that was felt.
    """
    wall = [place for place, colour in felt.items() if colour == VERGE]
    things: list[Mask] = []
    for place in (place for place, colour in felt.items() if colour != VERGE):
        if not any(thing[place] for thing in things):
            things += [part for part in parts if part[place] and not any(part[other] for other in wall)][:1]
    return things


def _between(floor: Mask, solid: Mask) -> Iterator[Mask]:
    """The connected parts of which each row lies between floor to the west and to the east."""
    short = np.zeros_like(solid)
    for row in range(len(solid)):
        line = solid[row].astype(np.int8)
        change = np.diff(np.concatenate([[0], line, [0]]))
        starts, stops = np.flatnonzero(change == 1), np.flatnonzero(change == -1)
        for start, stop in zip(starts.tolist(), stops.tolist(), strict=True):
            inside = start > 0 and stop < len(line)
            if inside and stop - start <= LONGEST and floor[row, start - 1] and floor[row, stop]:
                short[row, start:stop] = True
    parts = components(short)
    for n, (south, west, north, east) in enumerate(boxes(parts.labels, parts.number)[1:].tolist(), 1):
        if max(north - south, east - west) < LARGEST:
            yield parts.labels == n


def _in_corners(floor: Mask, solid: Mask) -> Iterator[Mask]:
    """Rectangles of which two sides that meet border on floor, and end at what bounds it."""
    for up, on in ((1, 1), (1, -1), (-1, 1), (-1, -1)):
        ground, full = floor[::up, ::on], solid[::up, ::on]
        tip = full[1:, 1:] & ground[:-1, 1:] & ground[1:, :-1] & ground[:-1, :-1]
        for row, column in (np.argwhere(tip) + 1).tolist():
            east = _run(full[row, column:], ground[row - 1, column:])
            north = _run(full[row:, column], ground[row:, column - 1])
            part = (slice(row, row + north), slice(column, column + east))
            if 0 < east <= LONGEST and 0 < north <= LONGEST and full[part].all():
                mask = np.zeros_like(full)
                mask[part] = True
                yield np.ascontiguousarray(mask[::up, ::on])


def _run(full: Mask, ground: Mask) -> int:
    """How far a side goes on that borders on floor, up to where something stands before it; 0 where nothing does."""
    goes_on = full & ground
    length = len(goes_on) if goes_on.all() else int(np.argmin(goes_on))
    return length if length < len(full) and full[length] and not ground[length] else 0
