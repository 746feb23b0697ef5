"""Protrusions: parts of what bounds the floor that stick out into it, and may be things that stand against the verge.

What touches a wall is one region with it to the eye; only touch separates them. But a thing is short: floor lies on
both sides of it, or it stands where two walls meet and ends soon along both.

Masks are (rows, columns) bool on the arrays of the map view, row 0 in the south.
"""

from collections.abc import Iterator, Mapping

import numpy as np

from utak.geometry.kernels.arrays import Bools
from utak.geometry.raster.components import bounding_boxes, components, with_edge_neighbours
from utak.geometry.raster.runs import runs_along_rows

RowColumn = tuple[int, int]  # a square as (row, column)
VERGE_TOUCH_COLOUR = "b"  # the colour of the verge; convention (the simulated world)
MAX_THING_LENGTH = 10  # squares that a thing may measure between floor and floor, or from a corner along a wall; tuned
MAX_THING_EXTENT = 12  # squares: the longer side of a thing's containing rectangle, at most; tuned


def protrusions(
    floor: Bools,
    solid: Bools,
    seen: Bools,
    felt: Mapping[RowColumn, str] | None = None,
    extent: int = MAX_THING_EXTENT,
) -> list[Bools]:
    """Find the parts of the bounds of the floor that stick out into it. Parts that stand free are left out."""
    bounds = seen & ~floor  # squares beside a thing may be open: what lies askew does not end on a grid line
    across, along = (short & solid for short in (_short_runs(floor, bounds), _short_runs(floor.T, bounds.T).T))
    pockets = [pocket & solid for pocket in _corner_parts(floor, bounds)]
    between = across, along, across | along
    things = np.zeros_like(bounds)
    for place, colour in (felt or {}).items():
        things[place] = colour != VERGE_TOUCH_COLOUR
    found = [*pockets, *(part for mask in between for part in _likely_parts(mask, things, extent))]
    found += [
        part
        for pocket in pockets
        for mask in between
        for part in _likely_parts(mask | pocket, things, extent)
        if (part & pocket).any()
    ]
    unlike = {mask.tobytes(): mask for mask in found if (with_edge_neighbours(mask) & solid & ~mask).any()}
    return sorted(unlike.values(), key=lambda mask: int(mask.sum()))


def separate_things(parts: list[Bools], felt: Mapping[RowColumn, str]) -> list[Bools]:
    """Return those of some parts that are things, by the colours felt on them."""
    things: list[Bools] = []
    for place, colour in felt.items():
        if colour == VERGE_TOUCH_COLOUR or any(thing[place] for thing in things):
            continue
        thing: Bools | None = None
        for part in parts:
            if not part[place] or any(part[other] and other_colour != colour for other, other_colour in felt.items()):
                continue
            if thing is None or _felt_beyond(thing, part, felt):
                thing = part
        things += [] if thing is None else [thing]
    return things


def with_embedded_things(things: list[Bools], felt: Mapping[RowColumn, str], solid: Bools) -> list[Bools]:
    """Return some things that stick out, and those that stand in a gap of a wall, as far as they were felt."""
    found = list(things)
    for colour in sorted(set(felt.values()) - {VERGE_TOUCH_COLOUR}):
        mask = np.zeros(solid.shape, np.bool_)
        for place, other in felt.items():
            mask[place] = other == colour and not any(thing[place] for thing in things)
        parts = components(mask)
        for n in range(1, parts.number + 1):
            part: Bools = parts.labels == n
            near = with_edge_neighbours(part)
            like = [
                number
                for number, thing in enumerate(found)
                if (thing & near).any() and _is_felt_as(colour, thing, felt)
            ]
            if like:
                found[like[0]] = _within_rectangle(found[like[0]] | part, colour, solid, felt)
            else:
                found.append(_within_rectangle(part, colour, solid, felt))
    return found


def joined_through_walls(
    things: list[Bools], parts: list[Bools], felt: Mapping[RowColumn, str], solid: Bools
) -> list[Bools]:
    """Return some things, with what sticks out of a wall on the other side joined to those that fill a gap in it."""
    found = list(things)
    known = np.any(found, axis=0) if found else np.False_
    unfelt = [part for part in reversed(parts) if not (part & known).any() and not any(part[place] for place in felt)]
    one = 0
    while one < len(found):
        colour = next(colour for place, colour in felt.items() if found[one][place])
        like = [thing for thing in found[one + 1 :] if _is_felt_as(colour, thing, felt)]
        for other in (*like, *unfelt):
            bridge = None if (other & found[one]).any() else _bridge(found[one], other, solid)
            if bridge is not None and not any(bridge[place] and c != colour for place, c in felt.items()):
                whole = found[one] | other | bridge
                found[one:] = [whole, *(thing for thing in found[one + 1 :] if not (thing & whole).any())]
                break
        else:
            one += 1
    return found


def _is_felt_as(colour: str, thing: Bools, felt: Mapping[RowColumn, str]) -> bool:
    """Return whether a colour was felt on some square of a thing."""
    return any(thing[place] and other == colour for place, other in felt.items())


def _bridge(one: Bools, other: Bools, solid: Bools) -> Bools | None:
    """Return the solid squares between two things that match across a wall, the one behind the other; None if not."""
    found = _upright_bridge(one, other, solid)
    if found is None:
        found = _upright_bridge(one.T, other.T, solid.T)
        found = None if found is None else np.ascontiguousarray(found.T)
    return found


def _upright_bridge(one: Bools, other: Bools, solid: Bools) -> Bools | None:
    """Return the solid squares between two things of which one lies north of the other; None if they do not match."""
    low, high = sorted((one, other), key=lambda thing: int(np.flatnonzero(thing.any(1))[0]))
    columns = low.any(0), high.any(0)
    last = len(solid) - 1 - np.argmax(low[::-1], axis=0)  # the northernmost row of the southern thing, by column
    first = np.argmax(high, axis=0)  # the southernmost row of the northern one
    rows = np.arange(len(solid))[:, None]
    between = (rows > last) & (rows < first) & columns[0] & columns[1]
    bridging = columns[0] & columns[1] & (last + 1 < first) & (solid | ~between).all(0)
    across = np.arange(solid.shape[1])
    meets_north = columns[0] & solid[np.minimum(last + 1, len(solid) - 1), across]
    meets_south = columns[1] & solid[np.maximum(first - 1, 0), across]
    if not bridging.any() or (bridging != meets_north).any() or (bridging != meets_south).any():
        return None
    mask: Bools = between & bridging
    return mask


def _within_rectangle(thing: Bools, colour: str, solid: Bools, felt: Mapping[RowColumn, str]) -> Bools:
    """Return a thing with all that is solid in its containing rectangle; itself where another colour was felt there."""
    rows, columns = np.flatnonzero(thing.any(1)), np.flatnonzero(thing.any(0))
    mask: Bools = np.zeros_like(thing)
    mask[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1] = True
    mask &= solid
    return thing if any(mask[place] and other != colour for place, other in felt.items()) else mask


def untouched_parts(parts: list[Bools], felt: Mapping[RowColumn, str]) -> list[Bools]:
    """Return what of some parts may be a thing, or more of one, and was not felt yet."""
    things = separate_things(parts, felt)
    known = np.any(things, axis=0) if things else np.False_
    left = [
        part & ~known
        for part in parts
        if not any(part[p] for p, colour in felt.items() if colour == VERGE_TOUCH_COLOUR)
    ]
    unlike = {mask.tobytes(): mask for mask in left if mask.any() and not any(mask[place] for place in felt)}
    return list(unlike.values())


def _felt_beyond(thing: Bools, part: Bools, felt: Mapping[RowColumn, str]) -> bool:
    """Return whether a part contains a whole thing, and besides a square outside that thing which was felt."""
    return not (thing & ~part).any() and any(part[place] and not thing[place] for place in felt)


def _short_runs(floor: Bools, bounds: Bools) -> Bools:
    """Return the squares of short runs of a row, between floor to the west and floor to the east."""
    short = np.zeros_like(bounds)
    for row, start, stop in runs_along_rows(bounds).each():
        inside = start > 0 and stop < bounds.shape[1]
        if inside and stop - start <= MAX_THING_LENGTH and floor[row, start - 1] and floor[row, stop]:
            short[row, start:stop] = True
    return short


def _likely_parts(mask: Bools, things: Bools, extent: int) -> Iterator[Bools]:
    """Yield the mask of each edge-connected part that is likely a thing."""
    parts = components(mask)
    felt = set(np.unique(parts.labels[things & mask]).tolist())
    for n, (south, west, north, east) in enumerate(bounding_boxes(parts.labels, parts.number)[1:].tolist(), 1):
        if max(north - south, east - west) < extent or n in felt:
            yield parts.labels == n


def _corner_parts(floor: Bools, bounds: Bools) -> Iterator[Bools]:
    """Yield the masks of what lies in a corner of two straight walls, between where floor meets each."""
    for up, on in ((1, 1), (1, -1), (-1, 1), (-1, -1)):
        ground, full = floor[::up, ::on], bounds[::up, ::on]
        meets = np.zeros_like(full)  # floor with bounds to the south and to the west
        meets[1:, 1:] = ground[1:, 1:] & full[:-1, 1:] & full[1:, :-1]
        places = np.argwhere(meets)
        for top, left in places.tolist():
            near = (places[:, 0] < top) & (places[:, 0] >= top - MAX_THING_LENGTH)
            near &= (places[:, 1] > left) & (places[:, 1] <= left + MAX_THING_LENGTH)
            for low, right in places[near].tolist():
                walls = full[low - 1 : top + 1, left - 1].all() and full[low - 1, left - 1 : right + 1].all()
                part = full[low:top, left:right]
                if walls and part[0, 0] and components(np.ascontiguousarray(part)).number == 1:
                    mask = np.zeros_like(full)
                    mask[low:top, left:right] = part
                    yield np.ascontiguousarray(mask[::up, ::on])
