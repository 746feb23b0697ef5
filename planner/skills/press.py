"""What is carried is pressed against walls that it may not touch, before it is held for being in their corner.

A wall lies anywhere in the squares in which it was seen, and a side of a thing that is not told anywhere in its own.
What stops a push is met, wherever in these squares it is: so what was stopped towards both walls is in the corner,
whatever is believed of its outline then.
"""

import math

import numpy as np

from geometry.motion.se2 import Translate
from kb.body import Push
from kb.language.terms import Fact
from kb.world.model import Node, WorldModel
from planner.advice import Act
from planner.goals.placement import Placement
from planner.goals.robot_goals import corner_side
from planner.situation import Situation

STOPPED = 0.1  # squares that a push at least falls short which was stopped
SAME = 2.0  # squares by which a corner may come to lie elsewhere by what a thing that is pressed into it shows
Place = tuple[float, float]


class Presser:
    """Gives the presses of one thing towards one goal, and remembers whether they stopped it."""

    def __init__(self) -> None:
        self._of: tuple[str, str] | None = None  # the goal and the thing
        self._corner: Place = (0.0, 0.0)  # a point of the lattice
        self._left: list[Translate] = []
        self._last: tuple[Translate, Place] | None = None  # the last press, and where the thing's middle was before

    def forget(self) -> None:
        """Forget all presses: what was pressed is pushed otherwise, or a push went on unstopped."""
        self._of, self._left, self._last = None, [], None

    def is_pressed(self, goal: Fact, node: Node, situation: Situation) -> bool:
        """Return whether a thing is being pressed for a goal, or was stopped by all its presses."""
        if self._of != (str(goal), node.name):
            return False
        gone_on = self._last is not None and not _stopped(*self._last, node)
        lost = self._left and situation.model.held != node.name
        if gone_on or lost or math.dist(self._corner, _corner_of(goal, situation)) > SAME:
            self.forget()
        return self._of is not None

    def begin(self, goal: Fact, node: Node, land: Placement, situation: Situation) -> None:
        """Note the presses of a thing that by all that is believed lies where a goal holds, if he holds it."""
        if land.presses and situation.model.held == node.name:
            self._of, self._corner = (str(goal), node.name), _corner_of(goal, situation)
            self._left, self._last = list(land.presses.values()), None

    def next(self, node: Node, model: WorldModel) -> Act | None:
        """Return the next press; None when none is left."""
        if not self._left:
            return None
        push = self._left.pop(0)
        self._last = push, (node.polygon.centroid.x, node.polygon.centroid.y)
        why = f"{node.name} is pressed against the wall, to be sure that it is there"
        return Act(Push(*model.frame.to_utak(push.dx, push.dy)), why, push)


def _corner_of(goal: Fact, situation: Situation) -> Place:
    """Return the corner that a goal is about, a point of the lattice."""
    (x, y), view = situation.corners[corner_side(goal)].point, situation.model.view
    return x + view.west, y + view.south


def _stopped(push: Translate, before: Place, node: Node) -> bool:
    """Return whether a push that was to move a thing fell short. before : where its middle was, on the lattice."""
    moved = np.subtract((node.polygon.centroid.x, node.polygon.centroid.y), before)
    way = math.hypot(push.dx, push.dy)
    return bool(moved @ (push.dx, push.dy) / way < way - STOPPED)
