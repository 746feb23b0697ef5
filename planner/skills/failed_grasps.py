"""Failed grasps: grasps by which an object did not move. They are avoided until no other is left."""

from collections.abc import Sequence

import numpy as np

from utak.geometry.kernels.arrays import XY, Floats
from utak.geometry.motion.se2 import Rotate
from utak.kb.perception.frame import CENTRE
from utak.kb.world.model import Node, WorldModel

MAX_RETRIES = 3  # times that the failed grasps of one object are tried again; a bound on time


class FailedGrasps:
    """Remembers failed grasps in the frame of each object: as it lay at first, from its middle, in squares."""

    def __init__(self) -> None:
        """Remember nothing yet."""
        self._failed: dict[str, tuple[XY, ...]] = {}
        self._retries: dict[str, int] = {}

    def __bool__(self) -> bool:
        """Return whether any failed grasp of any object is remembered."""
        return any(self._failed.values())

    def record(self, node: Node | None, model: WorldModel) -> None:
        """Record that a grasp of an object from the robot's present square failed."""
        # Both the present place and the middle of the square are recorded, for plans grasp from the middle.
        if node is None or node.polygon is None:
            return
        middle = node.polygon.centroid
        square = np.floor(model.place) + np.array(CENTRE)
        grasps = np.array([model.place, square]) - (middle.x, middle.y)
        self._failed[node.name] = (*self._failed.get(node.name, ()), *rotated_grasps(grasps, -node.turned))

    def grasps(self, node: Node) -> tuple[XY, ...]:
        """Return the failed grasps of an object as it lies now: (x, y) of the robot from its middle, in squares."""
        return rotated_grasps(self._failed.get(node.name, ()), node.turned)

    def forgive(self, node: Node) -> bool:
        """Forget the failed grasps of an object, and return whether there were any and they may be tried again."""
        # A grasp may have failed because of a slip, or for want of room that there is by now.
        again = self._retries.get(node.name, 0)
        if not self._failed.get(node.name) or again >= MAX_RETRIES:
            return False
        self._retries[node.name] = again + 1
        del self._failed[node.name]
        return True


def rotated_grasps(grasps: Sequence[XY] | Floats, degrees: float) -> tuple[XY, ...]:
    """Return grasps after the object is turned by degrees, counter-clockwise: (x, y) from its middle, in squares."""
    points = np.array(grasps, np.float64).reshape(-1, 2)
    return tuple((float(x), float(y)) for x, y in Rotate(degrees, (0.0, 0.0)).points(points))
