"""Holds by which something did not move: it is not taken by them again, until no other is left."""

import numpy as np
from numpy.typing import NDArray

from geometry.motion.se2 import Rotate
from kb.perception.frame import CENTRE
from kb.world.model import Node, WorldModel

MOST = 3  # times that the holds of one thing are tried again
Place = tuple[float, float]


class FailedGrasps:
    """Remembers them in the thing's own frame: as it lay at first, from its middle."""

    def __init__(self) -> None:
        self._failed: dict[str, tuple[Place, ...]] = {}
        self._forgiven: dict[str, int] = {}

    def __bool__(self) -> bool:
        return any(self._failed.values())

    def blame(self, node: Node | None, model: WorldModel) -> None:
        """Do not take a thing again from the square on which Utak stands now: plans have him in its middle."""
        if node is None or node.polygon is None:
            return
        middle = node.polygon.centroid
        square = np.floor(model.place) + np.array(CENTRE)
        holds = np.array([model.place, square]) - (middle.x, middle.y)
        self._failed[node.name] = (*self._failed.get(node.name, ()), *_turned(holds, -node.turned))

    def of(self, node: Node) -> tuple[Place, ...]:
        """The holds that failed, as the object lies now."""
        return _turned(np.array(self._failed.get(node.name, ())).reshape(-1, 2), node.turned)

    def forgiven(self, node: Node) -> bool:
        """Are there any, and may they be tried again? They are forgotten then.

        A hold may have failed for a slip, or for want of room that there is by now.
        """
        again = self._forgiven.get(node.name, 0)
        if not self._failed.get(node.name) or again >= MOST:
            return False
        self._forgiven[node.name] = again + 1
        del self._failed[node.name]
        return True


def _turned(holds: NDArray[np.float64], degrees: float) -> tuple[Place, ...]:
    """Holds of an object when it is turned by so many degrees about its middle."""
    return tuple((float(x), float(y)) for x, y in Rotate(degrees, (0.0, 0.0)).points(holds))
