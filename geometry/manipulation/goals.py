"""Where something that is carried shall end: at a pose, inside a region, in a corner; and what such an end is worth."""

import math
from dataclasses import dataclass, replace
from typing import Any, TypeVar

import numpy as np
import numpy.typing as npt
import shapely

from geometry.cspace.solver import Inside
from geometry.motion.se2 import Pose, turned
from geometry.raster.rasterize import areas
from geometry.state_lattice.footprints import DIRECTIONS, Footprints, quarter
from geometry.state_lattice.lattice import COMMAND, Costs, Grid, StateLattice

__all__ = ["At", "Between", "End", "InCorner", "Inside"]

Extent = TypeVar("Extent", float, npt.NDArray[np.float64])

CLOSE = 1e-6  # squares: by which an end may miss a region's border
VICINITY = 10.0  # squares: how near is near
UNEASY = 2 * COMMAND // 5  # the price of an end that meets the goal only just


@dataclass(frozen=True)
class At:
    """A goal: the shape turned about its own centroid by pose.degrees and then moved by (pose.x, pose.y)."""

    pose: Pose


@dataclass(frozen=True)
class InCorner:
    """A goal: the containing rectangle of the shape within `slack` squares of both walls of a corner, at any angle.

    x, y : the corner, where the walls meet, in squares. sx, sy : 1 when it is an eastern, a northern corner, else -1.
    within : how far from the two walls it may reach at most, the lesser and the greater; what lies askew reaches more.
    press : squares further from its walls at which a body may come by whole squares, to be pressed on from there.
    """

    x: float
    y: float
    sx: int
    sy: int
    slack: float = 1.0
    within: tuple[float, float] = (math.inf, math.inf)
    press: float = 0.0

    def gaps(self, bounds: tuple[Extent, Extent, Extent, Extent]) -> tuple[Extent, Extent]:
        """How far rectangles x0, y0, x1, y1 are from the two walls; negative beyond them."""
        x = self.x - bounds[2] if self.sx > 0 else bounds[0] - self.x
        y = self.y - bounds[3] if self.sy > 0 else bounds[1] - self.y
        return x, y

    def admits(self, bounds: tuple[Extent, Extent, Extent, Extent]) -> Any:
        """Whether containing rectangles x0, y0, x1, y1 lie in the corner: a bool, or an array of them."""
        x, y = self.gaps(bounds)
        across, up = x + bounds[2] - bounds[0], y + bounds[3] - bounds[1]
        near, far = np.minimum(across, up), np.maximum(across, up)
        close = (np.minimum(x, y) >= -CLOSE) & (np.maximum(x, y) <= self.slack + CLOSE)
        return close & (near <= self.within[0] + CLOSE) & (far <= self.within[1] + CLOSE)


@dataclass(frozen=True)
class Between:
    """A goal: the shape within `slack` squares of two straight walls that meet in a corner at any angle.

    x, y : the corner, in squares. walls : the unit normals of its walls, outward. The shape may lie beyond them: where
    just they are is told by what stops it.
    """

    x: float
    y: float
    walls: tuple[tuple[float, float], tuple[float, float]]
    slack: float = 1.0

    def gaps(self, shape: Any) -> tuple[float, float]:
        """How far a shape is from the two walls; negative beyond them."""
        points = shapely.get_coordinates(shape)
        one, two = (float(np.dot(n, (self.x, self.y)) - (points @ np.array(n)).max()) for n in self.walls)
        return one, two

    def move(self, gaps: tuple[float, float]) -> tuple[float, float]:
        """The translation that brings a shape nearer to the walls by so much each."""
        dx, dy = np.linalg.solve(np.array(self.walls), np.array(gaps)).tolist()
        return dx, dy

    def about(self, reach: float) -> Any:
        """The area no further from both walls than so many squares, and up to as far beyond them."""
        ends = [
            self.move((-far, -wide))
            for far, wide in ((-reach, -reach), (-reach, reach), (reach, reach), (reach, -reach))
        ]
        return shapely.Polygon([(self.x + dx, self.y + dy) for dx, dy in ends])


@dataclass(frozen=True)
class Roomy:
    """A goal on the way to others: two free squares all round, so that Utak can take the shape wherever he likes.

    near : (x, y) that the shape's centroid shall be near to, the nearer the better; None for anywhere.
    """

    near: tuple[float, float] | None = None


End = At | Inside | InCorner | Between | Roomy


def met(goal: End, shape: Any, now: Any) -> bool:
    """Whether a shape that began as `shape` meets the goal as it lies now."""
    if isinstance(goal, Inside):
        return any(part.buffer(CLOSE).covers(now) for part in shapely.get_parts(goal.polygon))
    if isinstance(goal, InCorner):
        return bool(goal.admits(now.bounds))
    if isinstance(goal, Between):
        return max(goal.gaps(now)) <= goal.slack + CLOSE
    if isinstance(goal, Roomy):
        return False
    return bool(shapely.hausdorff_distance(placed(shape, goal.pose), now) <= CLOSE)


def placed(shape: Any, pose: Pose) -> Any:
    """A shape turned about its centroid by pose.degrees, then moved by (pose.x, pose.y)."""
    middle = np.array([shape.centroid.x, shape.centroid.y])
    return shapely.transform(shape, lambda p: turned(p - middle, pose.degrees) + middle + np.array([pose.x, pose.y]))


def moved(goal: End, dx: float, dy: float) -> End:
    """A goal, so much further east and north, for a shape that is moved as far."""
    if isinstance(goal, Inside):
        return Inside(shapely.transform(goal.polygon, lambda p: p + np.array([dx, dy])))
    if isinstance(goal, InCorner | Between):
        return replace(goal, x=goal.x + dx, y=goal.y + dy)
    if isinstance(goal, Roomy) and goal.near is not None:
        return Roomy((goal.near[0] + dx, goal.near[1] + dy))
    return goal


def prices(goal: End, shape: Any, body: Footprints, board: StateLattice, grid: Grid) -> Costs:
    """The price of ending at each pose of the board, -1 where the goal is not met: (4, squares).

    For a pose off the lattice the places beside it count, when it is a whole number of quarter turns away.
    """
    if isinstance(goal, At):
        return _beside(goal.pose, shape, body, grid)
    if isinstance(goal, Inside):
        found = [_inside(goal, quarter(body.lying, k), board, grid) for k in range(4)]
    elif isinstance(goal, Between):
        found = [_between(goal, shape, body, k, grid) for k in range(4)]
    elif isinstance(goal, Roomy):
        found = [_roomy(goal, quarter(body.lying, k), board, grid) for k in range(4)]
    else:
        found = [_cornered(goal, shape, body, k, grid) for k in range(4)]
    return np.where(board.lies, np.array(found), -1).astype(np.int32)


def _inside(goal: Inside, lying: npt.NDArray[np.int64], board: StateLattice, grid: Grid) -> Costs:
    """The prices of one quarter: dear where the body, were it a square larger, would reach free squares outside."""
    price = np.full(len(board.solid), -1, np.int32)
    fat = np.unique(np.vstack([lying, *(lying + np.array(step) for step in DIRECTIONS)]), axis=0)
    for part in shapely.get_parts(goal.polygon):
        outside = grid.padded(areas(part, grid.columns, grid.rows) < 1 - CLOSE, True)
        inside, easy = grid.clear(outside, lying), grid.clear(outside & ~board.solid, fat)
        price[inside & (price != 0)] = UNEASY
        price[inside & easy] = 0
    return price


def _roomy(goal: Roomy, lying: npt.NDArray[np.int64], board: StateLattice, grid: Grid) -> Costs:
    """The prices of one quarter where all squares within two of the body's are free: a tenth of a command a square."""
    reach = range(-2, 3)
    fat = np.unique(np.vstack([lying + np.array((dx, dy)) for dx in reach for dy in reach]), axis=0)
    roomy = grid.clear(board.solid, fat)
    if goal.near is None:
        return np.where(roomy, 0, -1).astype(np.int32)
    row, column = np.divmod(np.arange(len(roomy)), grid.stride)
    far = np.hypot(column - grid.pad + 0.5 - goal.near[0], row - grid.pad + 0.5 - goal.near[1])
    return np.where(roomy & (far <= VICINITY), np.round(far * COMMAND / 10), -1).astype(np.int32)


def _cornered(goal: InCorner, shape: Any, body: Footprints, k: int, grid: Grid) -> Costs:
    """The prices of one quarter: dear where a gap to a wall is more than half of what is allowed."""
    x0, y0, x1, y1 = lying_at(shape, body, k, body.home).bounds
    row, column = np.divmod(np.arange((grid.rows + 2 * grid.pad) * grid.stride), grid.stride)
    dx, dy = column - grid.pad - body.home[0], row - grid.pad - body.home[1]
    bounds = x0 + dx, y0 + dy, x1 + dx, y1 + dy
    gap, most = np.maximum(*goal.gaps(bounds)), replace(goal, slack=goal.slack + goal.press)
    return np.where(most.admits(bounds), np.where(gap <= goal.slack / 2 + CLOSE, 0, UNEASY), -1).astype(np.int32)


def _between(goal: Between, shape: Any, body: Footprints, k: int, grid: Grid) -> Costs:
    """The prices of one quarter: dear where a gap to a wall is more than half of what is allowed."""
    gaps = goal.gaps(lying_at(shape, body, k, body.home))
    row, column = np.divmod(np.arange((grid.rows + 2 * grid.pad) * grid.stride), grid.stride)
    dx, dy = column - grid.pad - body.home[0], row - grid.pad - body.home[1]
    gap = np.maximum(*(gap - x * dx - y * dy for gap, (x, y) in zip(gaps, goal.walls, strict=True)))
    return np.where(gap <= goal.slack + CLOSE, np.where(gap <= goal.slack / 2, 0, UNEASY), -1).astype(np.int32)


def lying_at(shape: Any, body: Footprints, k: int, place: tuple[int, int]) -> Any:
    """The shape in a pose of the board: k quarter turns about the middle of its home square, then moved."""
    home = np.array(body.home) + 0.5
    move = np.array(place) + 0.5
    return shapely.transform(shape, lambda p: turned(p - home, 90.0 * k) + move)


def _beside(pose: Pose, shape: Any, body: Footprints, grid: Grid) -> Costs:
    """The pose's own place on the board, or the up to four about it."""
    found = np.full((4, (grid.rows + 2 * grid.pad) * grid.stride), -1, np.int32)
    k = round(pose.degrees / 90.0)
    if abs(pose.degrees - 90.0 * k) > 1e-7:
        return found
    there, here = placed(shape, pose).centroid, lying_at(shape, body, k, body.home).centroid
    dx, dy = there.x - here.x + body.home[0], there.y - here.y + body.home[1]
    for x in {math.floor(dx + CLOSE), math.ceil(dx - CLOSE)}:
        for y in {math.floor(dy + CLOSE), math.ceil(dy - CLOSE)}:
            if 0 <= x < grid.columns and 0 <= y < grid.rows:
                found[k % 4, grid.number(x, y)] = round(100 * math.hypot(x - dx, y - dy))
    return found
