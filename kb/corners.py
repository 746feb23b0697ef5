"""The corners of the known floor: geometry gives its convex corners, and kb/asp/corners.lp says which is which.

The corner furthest towards any side is a corner of the floor's convex hull, so only those are given.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray

from kb.encodings import KB, solve
from kb.evidence import FULL
from kb.loads import covered
from kb.regions import label_of
from kb.worldmodel import WorldModel

SMALLEST = 6  # squares of floor that are worth a corner
HUNDREDTHS = 100
SIDES = ("northeast", "northwest", "southeast", "southwest")


class Corner(NamedTuple):
    """A convex corner: its point (x, y) in the frame of the view, and the square (column, row) of floor that has it."""

    point: tuple[float, float]
    square: tuple[int, int]


def known_floor(model: WorldModel) -> NDArray[np.bool_]:
    """(rows, columns): the floor on which Utak stands, all other floor that is seen and large enough to be some, and
    the floor under what he has moved: squares that were floor before it came there, or that it surely covers by its
    outline. Others that it may cover may be wall, also where they were seen to be occupied.
    """
    sizes = np.bincount(model.labels.ravel())
    large = (sizes >= SMALLEST)[model.labels]
    mask: NDArray[np.bool_] = model.floor | (model.space & large)
    for node in model.objects:
        if node.moved:
            under = model.view.state == FULL
            if node.polygon is not None:
                under &= model.mask_within(covered(node.polygon))
            if model.beneath is not None:
                under |= model.beneath
            mask |= (model.labels == label_of(node.region)) & under
    return mask


def corners(model: WorldModel, rules: tuple[Path, ...] = ()) -> Mapping[str, Corner]:
    """The corner of the known floor towards each side of Utak's frame."""
    found = _convex(known_floor(model))
    facts = []
    for number, corner in enumerate(found):
        east, north = model.place_to_utak(*corner.point)
        facts.append(f"convex({number},{round(HUNDREDTHS * east)},{round(HUNDREDTHS * north)})")
    answer = solve([KB / "corners.lp", *rules], facts) or ()
    return {str(a.arguments[0]): found[a.arguments[1].number] for a in answer if a.match("furthest", 2)}


def _convex(floor: NDArray[np.bool_]) -> list[Corner]:
    """The corners of the convex hull of a mask, each with the square that has it; by place."""
    rows = np.flatnonzero(floor.any(axis=1))
    first = floor[rows].argmax(axis=1)
    last = floor.shape[1] - 1 - floor[rows, ::-1].argmax(axis=1)
    owner: dict[tuple[int, int], tuple[int, int]] = {}
    for row, west, east in zip(rows.tolist(), first.tolist(), last.tolist(), strict=True):
        for height in (row, row + 1):
            owner[west, height] = (west, row)
            owner[east + 1, height] = (east, row)
    hull = shapely.convex_hull(shapely.multipoints(sorted(owner)))
    return [Corner((x, y), owner[round(x), round(y)]) for x, y in sorted(set(hull.exterior.coords))]
