"""Leading the robot to a place: commands are given to it from outside, in the place of those that it decides."""

import math
from collections.abc import Callable

import numpy as np

from utak.geometry.io.svg import without_straight_points
from utak.geometry.kernels.arrays import XY, Bools
from utak.geometry.motion.se2 import direction
from utak.geometry.pathfinders.grid_astar import grid_path
from utak.geometry.raster.rasterize import squares
from utak.kb.body import Move
from utak.simulator.run.session import Session
from utak.simulator.world.world import World

ARRIVAL_DISTANCE = 0.75  # squares; a led robot that is so near to a place has arrived; less than a square's diagonal
MAX_LEADING_COMMANDS = 40  # commands; where noise or a thing in the way takes more, leading is given up; a convention
LEADING_REASON = "the robot is led here by a command that is given to it"


def lead(session: Session, place: XY, after_step: Callable[[], None]) -> bool:
    """Lead the woken robot of a session to a place. Return whether it arrived."""
    table = session.table
    for _ in range(MAX_LEADING_COMMANDS):
        if table.held is not None:
            return False
        way = way_between(free_squares(table.world, table.polygons), table.utak, place)
        ahead = next((point for point in way if math.dist(point, table.utak) > ARRIVAL_DISTANCE / 2), None)
        if ahead is None or math.dist(table.utak, place) <= ARRIVAL_DISTANCE:
            break
        x, y = table.utak
        session.follow(move_towards((ahead[0] - x, ahead[1] - y), table.world.heading), LEADING_REASON)
        after_step()
    return math.dist(table.utak, place) <= ARRIVAL_DISTANCE


def move_towards(offset: XY, heading: int) -> Move:
    """Return the command that moves Utak by an offset (dx, dy) of the table frame; heading : that of its north."""
    cosine, sine = direction(heading)
    dx, dy = offset
    return Move(dx * cosine + dy * sine, dy * cosine - dx * sine)


def free_squares(world: World, polygons: dict[str, object] | None = None) -> Bools:
    """Return the squares of a table that nothing covers, (rows, columns) bool, row 0 in the south."""
    now = {thing.name: thing.polygon for thing in world.movable} if polygons is None else polygons
    free = np.ones((world.height, world.width), np.bool_)
    for shape in (world.verge, *(thing.polygon for thing in world.fixed), *now.values()):
        free &= ~squares(shape, world.width, world.height)
    return free


def way_between(free: Bools, start: XY, goal: XY) -> list[XY]:
    """Return the corners of a way over free squares from centre to centre, so half a square from walls; [] for none."""
    begin = _nearest_free(free, start)
    if begin is None or not free[int(goal[1]), int(goal[0])]:
        return []
    way = grid_path(free, begin, goal)
    return [] if way is None else [(x, y) for x, y in without_straight_points(way).tolist()]


def _nearest_free(free: Bools, place: XY) -> XY | None:
    """Return a place itself when its square is free, else the centre of a free square beside it, or None."""
    column, row = int(place[0]), int(place[1])
    if 0 <= row < free.shape[0] and 0 <= column < free.shape[1] and free[row, column]:
        return place
    near = [
        (math.dist((i + 0.5, j + 0.5), place), (i + 0.5, j + 0.5))
        for j in range(max(0, row - 1), min(free.shape[0], row + 2))
        for i in range(max(0, column - 1), min(free.shape[1], column + 2))
        if free[j, i]
    ]
    return min(near)[1] if near else None
