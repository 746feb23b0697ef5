"""Moving problems: plan_motion beside OMPL in one process.

    python -m benchmarks.moving FOLDER [--peers] [--runs N] [--limit SECONDS] [--only TEXT]

FOLDER holds JSON scenes: obstacles and robot as rings, start and goal as [x, y, radians], bounds of the reference
point, expected: feasible, infeasible or unknown. Every motion found is checked with shapely at 512 poses and by first
contact against the obstacles one by one. With --peers each scene is also given to OMPL's planners, which ask the same
distance kernel as plan_motion whether a state is valid; the best of them is chosen afterwards.
"""

import argparse
import json
import math
import statistics
import time
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import shapely

from utak.geometry.cspace.plan_motion import MotionPlan, plan_motion
from utak.geometry.motion.first_contact import ContactBody, Obstacles
from utak.geometry.motion.obstacle_field import ObstacleField
from utak.geometry.motion.se2 import Pose


class MovingScene(NamedTuple):
    """A moving problem."""

    name: str
    body: Any
    obstacles: list[Any]
    start: Pose
    goal: Pose
    bounds: list[float]
    expected: str


def load(path: Path) -> MovingScene:
    """Read a scene."""
    told = json.loads(path.read_text())
    start, goal = (Pose(x, y, math.degrees(a)) for x, y, a in (told["start"], told["goal"]))
    obstacles = [shapely.Polygon(ring) for ring in told["obstacles"]]
    return MovingScene(
        told["name"], shapely.Polygon(told["robot"]), obstacles, start, goal, told["bounds"], told["expected"]
    )


def faults(scene: MovingScene, plan: MotionPlan, samples: int = 512) -> int:
    """Count the motions of a plan that enter an obstacle, by shapely or by first contact; plus 1000 for a wrong end."""
    solid = shapely.union_all(scene.obstacles).buffer(-1e-6, join_style="mitre")
    shapely.prepare(solid)
    obstacles, body, bad = Obstacles(scene.obstacles), scene.start.place(scene.body), 0
    for motion in plan.motions:
        swept = [motion.part(t).carry(body) for t in np.linspace(0, 1, samples)]
        free = obstacles.first_contact(ContactBody(body), motion) == 1.0
        bad += bool(shapely.intersects(solid, swept).any()) or not free
        body = motion.carry(body)
    return bad + 1000 * int(body.symmetric_difference(scene.goal.place(scene.body)).area > 1e-6)


def timed(scene: MovingScene, runs: int) -> tuple[MotionPlan, float, float]:
    """Return the plan, and the least milliseconds without and with the preparation of the obstacle field."""
    warm, cold = [], []
    for _ in range(runs):
        begin = time.perf_counter()
        floor = ObstacleField(scene.obstacles, scene.bounds)
        ready = time.perf_counter()
        plan = plan_motion(scene.body, floor, scene.start, scene.goal)
        end = time.perf_counter()
        warm.append(end - ready)
        cold.append(end - begin)
    return plan, 1e3 * min(warm), 1e3 * min(cold)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--peers", action="store_true", help="measure OMPL too")
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--limit", type=float, default=3.0, help="seconds for a run of a peer")
    parser.add_argument("--only", default="", help="scenes whose name holds this text")
    args = parser.parse_args()
    paths = [path for path in sorted(args.folder.glob("*.json")) if args.only in path.name]
    print(f"{'scene':42}{'expected':>11}{'status':>11}{'ms':>8}{'cold':>8}{'cells':>8}{'motions':>8}{'faults':>7}")
    ratios: dict[str, float] = {}
    for path in paths:
        scene = load(path)
        timed(scene, 1)
        plan, warm, cold = timed(scene, args.runs)
        wrong = faults(scene, plan) if plan.status == "found" else 0
        row = f"{scene.name:42}{scene.expected:>11}{plan.status:>11}{warm:8.1f}{cold:8.1f}{plan.cells:8}"
        print(f"{row}{len(plan.motions):8}{wrong:7}", end="", flush=True)
        if args.peers and plan.status == "found":
            ratios[scene.name] = _beside(scene, warm, args)
        print(flush=True)
    _sum_up(ratios)


def _beside(scene: MovingScene, warm: float, args: argparse.Namespace) -> float:
    """Print OMPL's best planner and its median time, and the ratio to our time."""
    from benchmarks.engine.ompl_peer import best_planner

    name, peer = best_planner(scene, args.runs, args.limit)
    told = f"{1e3 * peer:9.1f}" if peer < args.limit else f"   >{1e3 * args.limit:6.0f}"
    print(f"   {name:12}{told}  x{1e3 * peer / warm:.2f}", end="", flush=True)
    return 1e3 * peer / warm if peer * 1e3 > 100.0 else -1e3 * peer / warm


def _sum_up(ratios: dict[str, float]) -> None:
    """Print the geometric means over the scenes that are hard for the peer, and over the others."""
    for title, some in (
        ("the best OMPL planner needs over 100 ms", [r for r in ratios.values() if r > 0]),
        ("the others", [-r for r in ratios.values() if r < 0]),
    ):
        if some:
            mean = math.exp(statistics.fmean(math.log(r) for r in some))
            print(f"{title}: {len(some)} scenes, geometric mean {mean:.2f} times our time, least {min(some):.2f}")


if __name__ == "__main__":
    main()
