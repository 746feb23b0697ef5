"""Active size estimation: pushes by parts of a square, made before an object is said to be too large for a passage.

An object of whole squares, and one that covers some squares only in part, look alike. Pushed by a part of a square, the
first enters a new row at once, the second later. So its sides are located as finely as need be: each push halves
what is open.
"""

import math
from collections.abc import Iterator
from itertools import product
from typing import Any

from utak.geometry.manipulation.goals import At, shape_at_pose
from utak.geometry.motion.se2 import Pose
from utak.kb.objects.subcell_extent import SubcellExtent, inset_outline, last_row_coverage
from utak.kb.world.model import Node

INSET_TOLERANCE = 0.12  # squares within which the inset of a side counts as known: an eighth; tuned on random worlds
FIRST_STEP = 0.1  # squares of the first push: it tells an object of whole squares from all others; a convention
MAX_SIZE_PUSHES = 16  # pushes of one object only to measure it; a bound on time
CHANGED_VIEW = 0.5  # squares: an object pushed by this looks otherwise than before; derived, half a square
TURN_BACK_RANGE = 2  # squares along each axis, at most, by which an object is moved when it is turned back
NO_PUSH = 0.02  # squares: a shorter push shows nothing new; a convention
PUSH_AWAY = 0.3  # squares of a push whose only purpose is to see the object from another offset; a convention


class SizeEstimator:
    """Remembers how often each object was pushed only to measure it."""

    def __init__(self) -> None:
        """Remember no push yet."""
        self._tries: dict[str, int] = {}

    def poses(self, node: Node) -> Iterator[At]:
        """Yield where to push an object by parts of a square, to measure it better; nothing when its size is known."""
        wanted = push_parts(node)
        if wanted is None or self._tries.get(node.name, 0) >= MAX_SIZE_PUSHES:
            return
        self._tries[node.name] = self._tries.get(node.name, 0) + 1
        if node.astray:  # impressions tell nothing of its sides until it is turned back
            yield from _turned_back(node)
            return
        steps = [_steps(part) for part in wanted]
        pushes = sorted((math.hypot(*step), *step) for step in product(*steps))
        both = sorted(pushes, key=lambda push: push[0] < CHANGED_VIEW and not node.moved)
        single = [push for _, dx, dy in pushes for push in ((dx, 0.0), (0.0, dy))]  # where there is no room for both
        for dx, dy in dict.fromkeys([*((dx, dy) for _, dx, dy in both), *single]):
            if dx or dy:
                yield At(Pose(dx, dy, 0.0))


def push_parts(node: Node) -> tuple[float | None, float | None] | None:
    """Return by which part of a square an object is pushed along x and y to measure it."""
    # None for an axis along which the size is known.
    insets = node.insets
    if insets is None or node.inexact or node.dubious:
        return None
    west, east, south, north = insets.believed
    x0, y0, x1, y1 = node.polygon.bounds
    _, deep, _, high = last_row_coverage((x0 - west, y0 - south, x1 + east, y1 + north))
    wanted = [_wanted_depth(insets, 0), _wanted_depth(insets, 2)]
    if wanted == [None, None]:
        return None
    dx, dy = (None if to is None else (to - at + 0.5) % 1.0 - 0.5 for to, at in zip(wanted, (deep, high), strict=True))
    return dx, dy


def least_outline(node: Node) -> Any:
    """Return the smallest outline that an object may have; None when that is empty."""
    return node.polygon if node.insets is None else inset_outline(node.polygon, node.short)


def _turned_back(node: Node) -> Iterator[At]:
    """Yield where an object lies along the grid as it did when it was first held, the nearest place first."""
    x0, y0, _, _ = shape_at_pose(node.polygon, Pose(0.0, 0.0, -node.turned)).bounds
    offsets = range(-TURN_BACK_RANGE, TURN_BACK_RANGE + 1)
    for dx, dy in sorted(product(offsets, repeat=2), key=lambda step: math.hypot(*step)):
        yield At(Pose(round(x0) - x0 + dx, round(y0) - y0 + dy, -node.turned))


def _steps(part: float | None) -> list[float]:
    """Return the pushes along one axis that shift a side by a part of a square, in squares, the shorter first."""
    # None when nothing is to be measured along the axis: then [0.0].
    if part is None:
        return [0.0]
    if abs(part) < NO_PUSH:
        return [PUSH_AWAY, -PUSH_AWAY]
    return sorted((part, part - math.copysign(1.0, part)), key=abs)


def _wanted_depth(insets: SubcellExtent, axis: int) -> float | None:
    """Return how much of its last row an object should cover to be measured, 0 to 1 squares."""
    # None when that is known.
    (low, least), (most_low, most) = insets.least[axis : axis + 2], insets.most[axis : axis + 2]
    if not (low or least):
        if most > INSET_TOLERANCE:
            return FIRST_STEP
        return 1.0 - FIRST_STEP if most_low > INSET_TOLERANCE else None
    if max(most_low - low, most - least) <= INSET_TOLERANCE:
        return None
    return (least + most) / 2 if most - least >= most_low - low else 1.0 - (low + most_low) / 2
