"""Pushes by parts of a square, which tell how large a thing is before he says that it cannot pass.

A thing of whole squares, and one that covers some of them in part, look alike. Pushed on by a part of a square the one
comes upon a new row at once, the other later: so its sides are told as finely as need be, each push leaving half.
"""

import math
from collections.abc import Iterator
from itertools import product
from typing import Any

from geometry.manipulation.goals import At, placed
from geometry.motion.se2 import Pose
from kb.objects.subcell_extent import SubcellExtent, depths, moved_in
from kb.world.model import Node

FINE = 0.12  # squares up to which it is told how far in a side lies
FIRST = 0.1  # squares by which a thing is pushed first: one of whole squares is told from all others by that, and back
MOST = 16  # pushes
SHOWN = 0.5  # squares: what was pushed so far looks otherwise than before
ABOUT = 2  # squares aside at which a thing is turned back, at most
NOTHING, AWAY = 0.02, 0.3  # squares: a push that is none, and one that only leads elsewhere


class SizeEstimator:
    """Remembers how often he has pushed what only to tell its size."""

    def __init__(self) -> None:
        self._tries: dict[str, int] = {}

    def poses(self, node: Node) -> Iterator[At]:
        """Where to push a thing by parts of a square, to tell its size better; nothing when it is told.

        Whether it moves at all is not known of one that never did: then it is pushed so far that this shows.
        """
        wanted = phases(node)
        if wanted is None or self._tries.get(node.name, 0) >= MOST:
            return
        self._tries[node.name] = self._tries.get(node.name, 0) + 1
        if node.astray:  # looks tell nothing of its sides until it is turned back
            yield from _turned_back(node)
            return
        steps = [_steps(part) for part in wanted]
        pushes = sorted((math.hypot(*step), *step) for step in product(*steps))
        both = sorted(pushes, key=lambda push: push[0] < SHOWN and not node.moved)
        single = [push for _, dx, dy in pushes for push in ((dx, 0.0), (0.0, dy))]  # where there is no room for both
        for dx, dy in dict.fromkeys([*((dx, dy) for _, dx, dy in both), *single]):
            if dx or dy:
                yield At(Pose(dx, dy, 0.0))


def _turned_back(node: Node) -> Iterator[At]:
    """Where a thing lies along the lattice as it did when it was first held: near to where it is, the nearest first."""
    x0, y0, _, _ = placed(node.polygon, Pose(0.0, 0.0, -node.turned)).bounds
    for dx, dy in sorted(product(range(-ABOUT, ABOUT + 1), repeat=2), key=lambda step: math.hypot(*step)):
        yield At(Pose(round(x0) - x0 + dx, round(y0) - y0 + dy, -node.turned))


def _steps(part: float | None) -> list[float]:
    """The pushes that bring a side on by a part of a square, the shorter first; away, where it is there already.

    From there no look told it: from elsewhere one may.
    """
    if part is None:
        return [0.0]
    if abs(part) < NOTHING:
        return [AWAY, -AWAY]
    return sorted((part, part - math.copysign(1.0, part)), key=abs)


def phases(node: Node) -> tuple[float | None, float | None] | None:
    """The parts of a square, from -0.5 to 0.5, by which a thing is pushed to tell its size; None when it is told."""
    insets = node.insets
    if insets is None or node.inexact or node.dubious:
        return None
    west, east, south, north = insets.believed
    x0, y0, x1, y1 = node.polygon.bounds
    _, deep, _, high = depths((x0 - west, y0 - south, x1 + east, y1 + north))
    wanted = [_wanted(insets, 0), _wanted(insets, 2)]
    if wanted == [None, None]:
        return None
    dx, dy = (None if to is None else (to - at + 0.5) % 1.0 - 0.5 for to, at in zip(wanted, (deep, high), strict=True))
    return dx, dy


def _wanted(insets: SubcellExtent, axis: int) -> float | None:
    """How much of its last row, on the side of greater numbers, a thing should cover to be told apart; None for told.

    axis : 0 for west and east, 2 for south and north.
    """
    (low, least), (most_low, most) = insets.least[axis : axis + 2], insets.most[axis : axis + 2]
    if not (low or least):
        if most > FINE:
            return FIRST
        return 1.0 - FIRST if most_low > FINE else None
    if max(most_low - low, most - least) <= FINE:
        return None
    return (least + most) / 2 if most - least >= most_low - low else 1.0 - (low + most_low) / 2


def least_outline(node: Node) -> Any:
    """The least that a thing may be, as far as its sides along the lattice are not told; None when that is nothing."""
    return node.polygon if node.insets is None else moved_in(node.polygon, node.short)
