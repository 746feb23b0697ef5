"""Parts of what bounds the floor that stick out into it, and may be things that stand against it.

What touches a wall is one with it to the eye: only touch tells them apart. But a thing is short: floor lies on both
sides of it, or it stands where two walls meet and ends soon along both.
"""

from collections.abc import Iterator, Mapping

import numpy as np
from numpy.typing import NDArray

from geometry.raster.components import boxes, components, edged

Mask = NDArray[np.bool_]
Place = tuple[int, int]
VERGE = "b"  # its colour
LONGEST = 10  # squares that a thing may measure between floor and floor, or from a corner along a wall
LARGEST = 12  # squares that it may measure in all


def protrusions(floor: Mask, solid: Mask, seen: Mask) -> list[Mask]:
    """What sticks out into the floor: (rows, columns) masks, the smaller first. What stands free does not.

    One may be part of another: where a thing ends is not told by what is seen of it.

    floor, solid : (rows, columns) squares where floor is, and where something is that bounds it, or stands against what
    does. seen : those that were seen.
    """
    bounds = seen & ~floor  # beside what is there it may be open what is: what lies askew does not end on a line
    across, along = (short & solid for short in (_short(floor, bounds), _short(floor.T, bounds.T).T))
    pockets = [pocket & solid for pocket in _in_corners(floor, bounds)]
    between = across, along, across | along
    found = [*pockets, *(part for mask in between for part in _parts(mask))]
    found += [part for pocket in pockets for mask in between for part in _parts(mask | pocket) if (part & pocket).any()]
    unlike = {mask.tobytes(): mask for mask in found if (edged(mask) & solid & ~mask).any()}
    return sorted(unlike.values(), key=lambda mask: int(mask.sum()))


def told_apart(parts: list[Mask], felt: Mapping[Place, str]) -> list[Mask]:
    """Of such parts those that are things, by what was felt of them.

    The smallest with a square that is no wall is one; a larger one about it is, where the rest of it was felt, too, and
    has the same colour. felt : the colour of each square (row, column) that was felt.
    """
    things: list[Mask] = []
    for place, colour in felt.items():
        if colour == VERGE or any(thing[place] for thing in things):
            continue
        thing: Mask | None = None
        for part in parts:
            if not part[place] or any(part[other] and other_colour != colour for other, other_colour in felt.items()):
                continue
            if thing is None or _felt_beyond(thing, part, felt):
                thing = part
        things += [] if thing is None else [thing]
    return things


def unfelt(parts: list[Mask], felt: Mapping[Place, str]) -> list[Mask]:
    """What of such parts may be a thing, or more of one, and was not felt."""
    things = told_apart(parts, felt)
    known = np.any(things, axis=0) if things else np.False_
    left = [part & ~known for part in parts if not any(part[p] for p, colour in felt.items() if colour == VERGE)]
    unlike = {mask.tobytes(): mask for mask in left if mask.any() and not any(mask[place] for place in felt)}
    return list(unlike.values())


def _felt_beyond(thing: Mask, part: Mask, felt: Mapping[Place, str]) -> bool:
    """Does a part contain a thing, and something besides it that was felt?"""
    return not (thing & ~part).any() and any(part[place] and not thing[place] for place in felt)


def _short(floor: Mask, bounds: Mask) -> Mask:
    """(rows, columns): squares between floor to the west and floor to the east, not far from each other."""
    short = np.zeros_like(bounds)
    for row in range(len(bounds)):
        line = bounds[row].astype(np.int8)
        change = np.diff(np.concatenate([[0], line, [0]]))
        starts, stops = np.flatnonzero(change == 1), np.flatnonzero(change == -1)
        for start, stop in zip(starts.tolist(), stops.tolist(), strict=True):
            inside = start > 0 and stop < len(line)
            if inside and stop - start <= LONGEST and floor[row, start - 1] and floor[row, stop]:
                short[row, start:stop] = True
    return short


def _parts(mask: Mask) -> Iterator[Mask]:
    """The connected parts of a mask that are no larger than a thing."""
    parts = components(mask)
    for n, (south, west, north, east) in enumerate(boxes(parts.labels, parts.number)[1:].tolist(), 1):
        if max(north - south, east - west) < LARGEST:
            yield parts.labels == n


def _in_corners(floor: Mask, bounds: Mask) -> Iterator[Mask]:
    """What lies in a corner between two straight walls, from where floor meets the one to where it meets the other."""
    for up, on in ((1, 1), (1, -1), (-1, 1), (-1, -1)):
        ground, full = floor[::up, ::on], bounds[::up, ::on]
        meets = np.zeros_like(full)  # floor to the south and to the west of which something is
        meets[1:, 1:] = ground[1:, 1:] & full[:-1, 1:] & full[1:, :-1]
        places = np.argwhere(meets)
        for top, left in places.tolist():
            near = (places[:, 0] < top) & (places[:, 0] >= top - LONGEST)
            near &= (places[:, 1] > left) & (places[:, 1] <= left + LONGEST)
            for low, right in places[near].tolist():
                walls = full[low - 1 : top + 1, left - 1].all() and full[low - 1, left - 1 : right + 1].all()
                part = full[low:top, left:right]
                if walls and part[0, 0] and components(np.ascontiguousarray(part)).number == 1:
                    mask = np.zeros_like(full)
                    mask[low:top, left:right] = part
                    yield np.ascontiguousarray(mask[::up, ::on])
