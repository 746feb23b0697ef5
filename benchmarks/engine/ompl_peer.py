"""OMPL's planners on a scene, with a compiled validity checker. ompl comes with the extra `bench`."""

import math
import statistics
import time
from typing import Any

import shapely
from ompl import base, geometric, util

from utak.geometry.motion.body import new_moving_body
from utak.geometry.motion.cell_clearance import clearance_at
from utak.geometry.motion.obstacle_field import ObstacleField
from utak.geometry.motion.se2 import Pose

PLANNERS = ("RRTConnect", "LBKPIECE1", "BKPIECE1", "KPIECE1", "PRM")
VALIDITY_RESOLUTION = 0.002
"""Of the space's extent between two checked states; coarser, and half of the motions pass through walls (measured)."""


def best_planner(scene: Any, runs: int, limit: float) -> tuple[str, float]:
    """Return the planner with the least median time, and that median in seconds.

    Parameters
    ----------
    scene : Any
        With ``body``, ``obstacles``, ``bounds``, ``start`` and ``goal``, as for ``plan_motion``.
    runs : int
        Runs of each planner.
    limit : float
        Seconds after which a run ends; a run that finds nothing counts as so long.
    """
    quiet()
    medians = {}
    for name in PLANNERS:
        times = []
        for _ in range(runs):
            times.append(_solve(scene, name, limit))
            if len(times) == 1 and times[0] >= limit:
                break
        medians[name] = statistics.median(times)
    name = min(medians, key=lambda key: medians[key])
    return name, medians[name]


def quiet() -> None:
    """Turn OMPL's messages off."""
    if hasattr(util, "noOutputHandler"):
        util.noOutputHandler()
    if hasattr(util, "setLogLevel"):
        util.setLogLevel(util.LogLevel.LOG_NONE)


def way_exists(scene: Any, limit: float) -> bool:
    """Return whether RRTConnect finds a path within ``limit`` seconds whose densely sampled states are all free."""
    quiet()
    setup, _ = _search(scene, "RRTConnect", limit)
    if not setup.haveExactSolutionPath():
        return False
    path = setup.getSolutionPath()
    path.interpolate(20_000)
    solid = shapely.union_all(scene.obstacles).buffer(-1e-6, join_style="mitre")
    shapely.prepare(solid)
    poses = [Pose(s.getX(), s.getY(), math.degrees(s.getYaw())) for s in path.getStates()]
    return not shapely.intersects(solid, [pose.place(scene.body) for pose in poses]).any()


def _solve(scene: Any, name: str, limit: float) -> float:
    """Return the seconds until an exact solution is found; the limit when none is."""
    setup, taken = _search(scene, name, limit)
    return taken if setup.haveExactSolutionPath() else limit


def _search(scene: Any, name: str, limit: float) -> tuple[Any, float]:
    """Return OMPL's set-up after a search, and how many seconds the search took."""
    mover = new_moving_body(scene.body)
    ground = ObstacleField(scene.obstacles, scene.bounds).ground(mover)
    ox, oy = (float(v) for v in mover.reference)

    def is_valid(state: Any) -> bool:
        x, y, angle = state.getX(), state.getY(), state.getYaw()
        c, s = math.cos(angle), math.sin(angle)
        return bool(clearance_at(mover, ground, x - c * ox + s * oy, y - s * ox - c * oy, c, s) >= 0.0)

    space = base.SE2StateSpace()
    box = base.RealVectorBounds(2)
    for axis in range(2):
        box.setLow(axis, scene.bounds[axis])
        box.setHigh(axis, scene.bounds[axis + 2])
    space.setBounds(box)
    setup = geometric.SimpleSetup(space)
    setup.setStateValidityChecker(is_valid)
    setup.getSpaceInformation().setStateValidityCheckingResolution(VALIDITY_RESOLUTION)
    ends = []
    for pose in (scene.start, scene.goal):
        state = space.allocState()
        state.setX(pose.x)
        state.setY(pose.y)
        state.setYaw(math.remainder(math.radians(pose.degrees), 2 * math.pi))
        ends.append(state)
    setup.setStartAndGoalStates(*ends)
    setup.setPlanner(getattr(geometric, name)(setup.getSpaceInformation()))
    is_valid(ends[0])
    begin = time.perf_counter()
    setup.solve(limit)
    taken = time.perf_counter() - begin
    return setup, taken
