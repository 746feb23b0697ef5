"""Pressing: a held object is pressed against the walls of a corner before it is believed to lie in that corner.

A wall lies anywhere in the squares in which it was seen, and a side of an object that is not known exactly lies
anywhere in its own. Wherever they are, a push is stopped where they meet. So an object that was stopped towards both
walls is in the corner, whatever is believed of its outline then.
"""

import math
from dataclasses import replace

import numpy as np

from utak.geometry.kernels.arrays import XY
from utak.geometry.motion.se2 import Translate
from utak.kb.language.terms import Fact
from utak.kb.world.model import Node, WorldModel
from utak.planner.advice import Act, unplanned_act
from utak.planner.goals.placement import Placement
from utak.planner.goals.robot_goals import corner_side
from utak.planner.situation import Situation
from utak.planner.steps import press

STOPPED_SHORT = 0.1  # squares by which a push that was stopped falls short at least; a convention, above rounding
CORNER_SHIFT = 2.0  # squares by which a corner may seem to move when a press shows more of its walls; tuned


class Presser:
    """Gives the presses of one object towards one goal, and remembers whether they were stopped."""

    def __init__(self) -> None:
        """Remember no press yet."""
        self._of: tuple[str, str] | None = None  # the goal and the object
        self._corner: XY = (0.0, 0.0)  # in squares, map frame
        self._left: list[Translate] = []
        self._last: tuple[Translate, XY] | None = None  # the last press, and the object's middle before it
        self._is_new = False  # whether nothing was seen yet of the last press

    def forget(self) -> None:
        """Forget all presses: the object was pushed otherwise, or a press was not stopped."""
        self._of, self._left, self._last = None, [], None

    def is_pressed(self, goal: Fact, node: Node, situation: Situation) -> bool:
        """Return whether an object is being pressed for a goal, or was stopped by all its presses."""
        if self._of != (str(goal), node.name):
            return False
        gone_on = self._last is not None and not _is_stopped(*self._last, node)
        # Out of the hand after a press, it was not pressed: others took it, or put the robot elsewhere.
        lost = (self._left or self._is_new) and situation.model.held != node.name
        self._is_new = False
        if gone_on or lost or math.dist(self._corner, _corner_of(goal, situation)) > CORNER_SHIFT:
            self.forget()
        return self._of is not None

    def has_begun(self, goal: Fact, node: Node) -> bool:
        """Return whether presses of an object for a goal were begun, and none of them went on."""
        return self._of == (str(goal), node.name)

    def begin(self, goal: Fact, node: Node, land: Placement, situation: Situation) -> None:
        """Note the presses of a held object that is believed to lie where a goal holds."""
        if land.presses and situation.model.held == node.name:
            self._of, self._corner = (str(goal), node.name), _corner_of(goal, situation)
            self._left, self._last = list(land.presses.values()), None

    def has_next(self, node: Node) -> bool:
        """Return whether a press of an object is left."""
        return bool(self._left) and self._of is not None and self._of[1] == node.name

    def next(self, node: Node, model: WorldModel) -> Act:
        """Return the next press that is left as a push that no plan asks for, and remember it."""
        push = self._left.pop(0)
        self._last, self._is_new = (push, (node.polygon.centroid.x, node.polygon.centroid.y)), True
        why = f"{node.name} is pressed against the wall, to be sure that it is there"
        return replace(unplanned_act(push, why, model), steps=(press(node.name, push, model),))


def _corner_of(goal: Fact, situation: Situation) -> XY:
    """Return the corner (x, y) that a goal is about, in squares, map frame."""
    (x, y), view = situation.corners[corner_side(goal)].point, situation.model.view
    return x + view.west, y + view.south


def _is_stopped(push: Translate, before: XY, node: Node) -> bool:
    """Return whether a push of an object fell short by more than STOPPED_SHORT squares, and it lies no further away."""
    moved = np.subtract((node.polygon.centroid.x, node.polygon.centroid.y), before)
    length = math.hypot(push.dx, push.dy)
    near = math.hypot(*moved) <= length + STOPPED_SHORT
    return bool(near and moved @ (push.dx, push.dy) / length < length - STOPPED_SHORT)
