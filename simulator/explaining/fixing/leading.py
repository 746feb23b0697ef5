"""A robot that is led: a command can be given to it from outside, in the place of the one that it decided."""

import math
from collections.abc import Callable

import numpy as np

from utak.geometry import Screen
from utak.geometry.kernels.arrays import XY, Bools
from utak.geometry.motion.se2 import direction
from utak.geometry.raster.rasterize import squares
from utak.kb.body import Body, Command, Move
from utak.kb.task.task import Task
from utak.simulator.run.session import (
    FollowingRobotProtocol,
    RobotMaker,
    RobotProtocol,
    Session,
    StepReportProtocol,
    VerdictProtocol,
)
from utak.simulator.scenario.settings import Settings
from utak.simulator.world.physics import Tabletop
from utak.simulator.world.world import World

ARRIVAL_DISTANCE = 0.75  # squares; a led robot that is so near to a place has arrived; less than a square's diagonal
MAX_LEADING_COMMANDS = 40  # commands; where noise or a thing in the way takes more, leading is given up; a convention
LEADING_REASON = "the robot is led here by a command that is given to it"


class LedRobot:
    """A robot whose next command can be given from outside."""

    def __init__(self, robot: RobotProtocol) -> None:
        if not isinstance(robot, FollowingRobotProtocol):
            raise TypeError("this robot takes no commands from outside")
        self._robot, self._follow = robot, robot.follow
        self.given: Command | None = None
        self.led = False

    def wake(self) -> StepReportProtocol:
        """Take the first impression and return the report on it."""
        return self._robot.wake()

    def step(self) -> StepReportProtocol:
        """Give the command from outside, or the decided one, and return the report."""
        if self.given is None:
            return self._robot.step()
        command, self.given = self.given, None
        return self._follow(command, LEADING_REASON)

    @property
    def finished(self) -> bool:
        """Whether the robot has a verdict and is not led on."""
        return self._robot.finished and not self.led

    @property
    def verdict(self) -> VerdictProtocol:
        """The verdict at the end."""
        return self._robot.verdict


class Leader:
    """Leads one robot to a place."""

    def __init__(self, place: XY, make: RobotMaker) -> None:
        self._place, self._make = place, make
        self._robot: LedRobot | None = None

    def make(self, body: Body, task: Task, settings: Settings) -> LedRobot:
        """Return the robot that is led."""
        self._robot = LedRobot(self._make(body, task, settings))
        self._robot.led = True
        return self._robot

    def lead(self, session: Session, watch: Callable[[Session], None]) -> bool:
        """Lead the woken robot of a session to the place. Return whether it arrived."""
        assert self._robot is not None
        for _ in range(MAX_LEADING_COMMANDS):
            if session.table.held is not None:
                return False
            ahead = self._next_corner(session.table)
            if ahead is None or math.dist(session.table.utak, self._place) <= ARRIVAL_DISTANCE:
                break
            x, y = session.table.utak
            self._robot.given = move_towards((ahead[0] - x, ahead[1] - y), session.table.world.heading)
            session.step()
            watch(session)
        self._robot.led = False
        return math.dist(session.table.utak, self._place) <= ARRIVAL_DISTANCE

    def _next_corner(self, table: Tabletop) -> XY | None:
        """Return the next corner of the way to the place; None without a way."""
        way = way_between(free_squares(table.world, table.polygons), table.utak, self._place)
        return next((point for point in way if math.dist(point, table.utak) > ARRIVAL_DISTANCE / 2), None)


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
    """Return the corners of a way over free squares, half a square from walls where that is possible."""
    # [] without one.
    screen = Screen(free)
    begin = _nearest_free(free, start)
    if begin is None or not free[int(goal[1]), int(goal[0])]:
        return []
    for radius in (0.5, 0.0):
        try:
            routes = screen.routes(begin, goal, 1, radius)
        except ValueError:  # an end is nearer to a wall than that
            continue
        if routes:
            return [(float(x), float(y)) for x, y in routes[0].points]
    return []


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
