"""Rigid motions of the plane: poses, translations and rotations as frozen values.

Angles are in degrees, counter-clockwise positive; lengths in squares; everything in the table frame.
"""

import math
from typing import Any, NamedTuple

import numpy as np
import shapely

from geometry.kernels.arrays import Floats


class Pose(NamedTuple):
    """Where a body is: the place of its reference point (its own origin) and how far it is turned.

    x, y: squares, table frame. degrees: counter-clockwise, 0 as the body was drawn.
    """

    x: float
    y: float
    degrees: float = 0.0

    def place(self, shape: Any) -> Any:
        """The shapely geometry turned about its own origin by `degrees`, then moved to (x, y)."""
        return shapely.transform(shape, lambda p: turned(p, self.degrees) + np.array([self.x, self.y]))


class Translate(NamedTuple):
    """A straight motion without turning: dx to the east and dy to the north, in squares."""

    dx: float
    dy: float

    def part(self, fraction: float) -> "Translate":
        """The first part of this motion, fraction from 0 to 1."""
        return Translate(self.dx * fraction, self.dy * fraction)

    def reversed(self) -> "Translate":
        """The motion back."""
        return Translate(-self.dx, -self.dy)

    def steered(self, onward: float, left: float) -> "Translate":
        """So many squares on in the direction of this motion, and so many to its left; both may be negative.

        ZeroDivisionError for a motion that leads nowhere.
        """
        length = math.hypot(self.dx, self.dy)
        x, y = self.dx / length, self.dy / length
        return Translate(onward * x - left * y, onward * y + left * x)

    def points(self, points: Floats) -> Floats:
        """Points (n, 2) after the motion."""
        moved: Floats = points + np.array([self.dx, self.dy])
        return moved

    def carry(self, shape: Any) -> Any:
        """A shapely geometry after the motion."""
        return shapely.transform(shape, self.points)

    def pose(self, pose: Pose) -> Pose:
        """A pose after the motion."""
        return Pose(pose.x + self.dx, pose.y + self.dy, pose.degrees)


class Rotate(NamedTuple):
    """A turn about a fixed point of the table: degrees counter-clockwise positive, about = (x, y)."""

    degrees: float
    about: tuple[float, float]

    def part(self, fraction: float) -> "Rotate":
        """The first part of this motion, fraction from 0 to 1."""
        return Rotate(self.degrees * fraction, self.about)

    def reversed(self) -> "Rotate":
        """The motion back."""
        return Rotate(-self.degrees, self.about)

    def points(self, points: Floats) -> Floats:
        """Points (n, 2) after the motion."""
        pivot = np.array(self.about)
        moved: Floats = turned(points - pivot, self.degrees) + pivot
        return moved

    def carry(self, shape: Any) -> Any:
        """A shapely geometry after the motion."""
        return shapely.transform(shape, self.points)

    def pose(self, pose: Pose) -> Pose:
        """A pose after the motion."""
        x, y = self.points(np.array([[pose.x, pose.y]]))[0]
        return Pose(float(x), float(y), pose.degrees + self.degrees)


Motion = Translate | Rotate


def turned(points: Floats, degrees: float) -> Floats:
    """Points (n, 2) turned about the origin; quarter turns are exact."""
    cosine, sine = direction(degrees)
    x, y = points[:, 0], points[:, 1]
    return np.column_stack([cosine * x - sine * y, sine * x + cosine * y])


def direction(degrees: float) -> tuple[float, float]:
    """Cosine and sine of an angle in degrees, exact at quarter turns."""
    quarters = degrees / 90.0
    if quarters == math.floor(quarters):
        return ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))[int(quarters) % 4]
    angle = math.radians(degrees)
    return math.cos(angle), math.sin(angle)
