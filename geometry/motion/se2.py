"""Rigid motions of the plane: poses, translations and rotations as frozen values.

Angles are in degrees, counter-clockwise positive; lengths in squares; everything in the table frame.
"""

import math
from typing import Any, NamedTuple

import numpy as np
import shapely

from utak.geometry.kernels.arrays import Floats


class Pose(NamedTuple):
    """A pose of a body: the place of its reference point (its own origin) and its rotation.

    Attributes
    ----------
    x, y : place of the reference point, squares, table frame.
    degrees : rotation, counter-clockwise positive; 0 as the body was drawn. May exceed a whole turn.
    """

    x: float
    y: float
    degrees: float = 0.0

    def place(self, shape: Any) -> Any:
        """Return a shapely geometry as it lies at this pose: from the body frame to the table frame, both in squares.

        It is turned about its own origin by `degrees`, then moved by (x, y).

        Parameters
        ----------
        shape : shapely geometry in the body frame; the result is of the same type, a new one.
        """
        return shapely.transform(shape, lambda p: turned(p, self.degrees) + np.array([self.x, self.y]))


class Translate(NamedTuple):
    """A straight motion without turning.

    Attributes
    ----------
    dx, dy : displacement to the east and to the north, squares, table frame.
    """

    dx: float
    dy: float

    def part(self, fraction: float) -> "Translate":
        """Return the first part of this motion, in the same direction.

        `fraction` of its length is from 0 to 1 (not checked).
        """
        return Translate(self.dx * fraction, self.dy * fraction)

    def steered(self, onward: float, left: float) -> "Translate":
        """Return a translation given relative to the direction of this one.

        Parameters
        ----------
        onward : squares in the direction of this motion; may be negative.
        left : squares to the left of this motion, seen along it; may be negative.

        Returns
        -------
        Translate in the table frame; its length does not depend on the length of this one.

        Raises
        ------
        ZeroDivisionError : this motion has no length.
        """
        length = math.hypot(self.dx, self.dy)
        x, y = self.dx / length, self.dy / length
        return Translate(onward * x - left * y, onward * y + left * x)

    def points(self, points: Floats) -> Floats:
        """Return points (n, 2) x, y, squares, table frame, as they lie after the motion; a new array."""
        moved: Floats = points + np.array([self.dx, self.dy])
        return moved

    def carry(self, shape: Any) -> Any:
        """Return the shapely geometry `shape` (squares, table frame) as it lies after the motion.

        It is a new one of the same type.
        """
        return shapely.transform(shape, self.points)

    def pose(self, pose: Pose) -> Pose:
        """Return the pose, after the motion, of what was at `pose` before it.

        x, y in squares, table frame; the same degrees.
        """
        return Pose(pose.x + self.dx, pose.y + self.dy, pose.degrees)


class Rotate(NamedTuple):
    """A rotation about a fixed point of the table.

    Attributes
    ----------
    degrees : angle, counter-clockwise positive; may exceed a whole turn.
    about : the pivot (x, y), squares, table frame.
    """

    degrees: float
    about: tuple[float, float]

    def part(self, fraction: float) -> "Rotate":
        """Return the first part of this motion, about the same pivot.

        `fraction` of its angle is from 0 to 1 (not checked).
        """
        return Rotate(self.degrees * fraction, self.about)

    def points(self, points: Floats) -> Floats:
        """Return points (n, 2) x, y, squares, table frame, as they lie after the motion; a new array."""
        pivot = np.array(self.about)
        moved: Floats = turned(points - pivot, self.degrees) + pivot
        return moved

    def carry(self, shape: Any) -> Any:
        """Return the shapely geometry `shape` (squares, table frame) as it lies after the motion.

        It is a new one of the same type.
        """
        return shapely.transform(shape, self.points)

    def pose(self, pose: Pose) -> Pose:
        """Return the pose, after the motion, of what was at `pose` before it.

        x, y in squares, table frame; the degrees of both add up, beyond a whole turn.
        """
        x, y = self.points(np.array([[pose.x, pose.y]]))[0]
        return Pose(float(x), float(y), pose.degrees + self.degrees)


Motion = Translate | Rotate


def turned(points: Floats, degrees: float) -> Floats:
    """Return points (n, 2) x, y rotated by `degrees` counter-clockwise about the origin; exact at quarter turns."""
    cosine, sine = direction(degrees)
    x, y = points[:, 0], points[:, 1]
    rotated = np.empty((len(points), 2))
    rotated[:, 0] = cosine * x - sine * y
    rotated[:, 1] = sine * x + cosine * y
    return rotated


def direction(degrees: float) -> tuple[float, float]:
    """Return (cosine, sine) of an angle in degrees, exact at quarter turns."""
    quarters = degrees / 90.0
    if quarters == math.floor(quarters):
        return ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))[int(quarters) % 4]
    angle = math.radians(degrees)
    return math.cos(angle), math.sin(angle)
