"""Trials of a passage: an object is pushed where walls may leave it more room than the squares in which they were seen.

A wall lies anywhere in those squares. So where an object would fit if the walls at the sides of a passage lay further
back, it is first pushed by a part of a square, until each side has a share of what is missing, and then through. A
trial that is stopped tells that the walls do not lie so; then other shares are tried.
"""

import math
from typing import NamedTuple

import numpy as np

from utak.geometry.cspace.bottleneck import Bottleneck
from utak.geometry.kernels.arrays import XY, Bools
from utak.geometry.motion.se2 import Pose
from utak.geometry.raster.components import components, with_edge_neighbours
from utak.kb.world.model import Node, WorldModel

SHARES = (0.5, 0.25, 0.75, 0.125, 0.375, 0.625, 0.875)  # of what is missing, on one side: halves ever finer; convention
SAME_PASSAGE = 2.0  # squares between the middles of what is one passage: its narrowest place may move; a convention
BACK = 3.0  # squares by which the object is drawn back after the last trial, so that the way is free; a convention
ON_PLACE = 0.05  # squares by which a share may be missed: what is missing is known no better; a convention


class PassageTrial(NamedTuple):
    """A trial: how an object must be moved first, and the squares of wall that are supposed to be free then."""

    # Pushes along the axes of the map of which one comes first, the shortest first; () for none
    aside: tuple[Pose, ...]
    opened: Bools  # (rows, columns) bool on the arrays of the view


class PassageTrials:
    """Gives the trials of passages, one after the other, and remembers which were made."""

    def __init__(self) -> None:
        """Make one that tried nothing."""
        # The object, the middle of the passage (map frame), and the share; None for the drawing back after all shares
        self._made: list[tuple[str, XY, float | None]] = []

    def begun(self, node: Node, model: WorldModel) -> bool:
        """Return whether the robot holds an object with which it made a trial."""
        return model.held == node.name and any(name == node.name for name, _, _ in self._made)

    def next(self, node: Node, passage: Bottleneck, missing: float, model: WorldModel) -> PassageTrial | None:
        """Return the next trial of a passage, given in the view frame; it counts as made when nothing comes first."""
        # None when all were made.
        view, axis = model.view, int(np.argmax(np.abs(np.subtract(*passage.sides))))
        middle = passage.place[0] + view.west, passage.place[1] + view.south
        low = round(min(side[axis] for side in passage.sides))
        edge = node.polygon.bounds[axis] - (view.west, view.south)[axis]
        made = {s for name, place, s in self._made if name == node.name and math.dist(place, middle) < SAME_PASSAGE}
        for share in SHARES:
            if share in made or missing * max(share, 1.0 - share) >= 1.0:
                continue
            part = (low - missing * share - edge + 0.5) % 1.0 - 0.5
            if abs(part) <= ON_PLACE:
                self._made.append((node.name, middle, share))
                return PassageTrial((), _opened(passage, axis, model))
            pushes = (part, part - math.copysign(1.0, part))
            aside = tuple(Pose(push, 0.0) if axis == 0 else Pose(0.0, push) for push in pushes)
            return PassageTrial(aside, _opened(passage, axis, model))
        if not made or None in made:
            return None
        self._made.append((node.name, middle, None))
        x, y = node.polygon.centroid.x - middle[0], node.polygon.centroid.y - middle[1]
        back = Pose(0.0, math.copysign(BACK, y)) if axis == 0 else Pose(math.copysign(BACK, x), 0.0)
        return PassageTrial((back,), np.zeros_like(model.space))


def _opened(passage: Bottleneck, axis: int, model: WorldModel) -> Bools:
    """Return the squares of the walls at both sides of a passage, as far along it as they are in line."""
    rim = with_edge_neighbours(model.space) & model.verge
    lines = rim.T if axis == 0 else rim  # a line of squares along the passage each
    found: Bools = np.zeros_like(lines)
    for side in passage.sides:
        line = math.floor(side[axis] + math.copysign(ON_PLACE, side[axis] - passage.place[axis]))
        near = round(side[1 - axis])
        only = np.zeros_like(lines)
        only[line] = lines[line]
        labels = components(only).labels
        beside = labels[line, max(near - 1, 0) : near + 1]
        found |= np.isin(labels, beside[beside > 0])
    return found.T if axis == 0 else found
