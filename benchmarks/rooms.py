"""Random moving problems of two and three rooms, each answer checked.

    python -m benchmarks.rooms [--seconds S] [--seed N] [--peers]

Found motions are swept again with shapely. With --peers OMPL's RRTConnect searches for --limit seconds for a motion
where none is said to be possible. If it finds one that shapely finds free, the proof is contradicted.
"""

import argparse
import time
from collections import Counter
from typing import Any

import numpy as np
import shapely
from shapely import affinity, box

from benchmarks.moving import MovingScene, faults
from utak.geometry.cspace.plan_motion import plan_motion
from utak.geometry.motion.se2 import Pose

ROOMS_ELL = shapely.Polygon([(0, 0), (6, 0), (6, 2), (2, 2), (2, 6), (0, 6)])
ROOMS_TEE = shapely.Polygon([(0, 0), (6, 0), (6, 2), (4, 2), (4, 5), (2, 5), (2, 2), (0, 2)])
ROOMS_HORSESHOE = shapely.Polygon([(0, 0), (6, 0), (6, 5), (4, 5), (4, 2), (2, 2), (2, 5), (0, 5)])
BODIES = [
    box(0, 0, 3, 3),
    box(0, 0, 6, 2),
    box(0, 0, 4, 2),
    ROOMS_ELL,
    ROOMS_TEE,
    ROOMS_HORSESHOE,
    shapely.Polygon([(0, 0), (6, 0), (2, 5)]),
]


def random_scene(rng: np.random.Generator, rooms: int) -> MovingScene | None:
    """Return rooms in a row with doors, some objects, and a body with its reference point anywhere; None for none."""
    size = float(rng.uniform(0.6, 1.1))
    body = affinity.scale(BODIES[int(rng.integers(len(BODIES)))], size, size, origin=(0, 0))
    body = affinity.translate(body, *rng.uniform(-4, 1, 2))
    thick, high = float(rng.choice([0.25, 1, 2])), float(rng.uniform(8, 13))
    free, x = [], 0.0
    for n in range(rooms):
        wide = float(rng.uniform(8, 13))
        free.append(box(x, 0, x + wide, high))
        if n < rooms - 1:
            door = float(rng.uniform(1.2, 5))
            y = float(rng.uniform(door / 2, high - door / 2))
            free.append(box(x + wide - 0.01, y - door / 2, x + wide + thick + 0.01, y + door / 2))
        x += wide + thick
    x -= thick
    floor = shapely.union_all(free)
    for _ in range(int(rng.integers(0, 3))):
        thing = affinity.rotate(box(0, 0, *rng.uniform(1, 3, 2)), float(rng.uniform(0, 360)))
        floor = floor.difference(affinity.translate(thing, rng.uniform(2, x - 2), rng.uniform(1, high - 2)))
    walls = box(-1, -1, x + 1, high + 1).difference(floor)
    ends = [_free_pose(rng, body, walls, west, east, high) for west, east in ((0, 0.4 * x), (0.6 * x, x))]
    if ends[0] is None or ends[1] is None:
        return None
    return MovingScene("rooms", body, list(shapely.get_parts(walls)), ends[0], ends[1], [0, 0, x, high], "unknown")


def _free_pose(rng: np.random.Generator, body: Any, walls: Any, west: float, east: float, high: float) -> Pose | None:
    """Return a pose in which a body overlaps nothing."""
    for _ in range(300):
        pose = Pose(float(rng.uniform(west, east)), float(rng.uniform(0, high)), float(rng.uniform(0, 360)))
        if not pose.place(body).intersects(walls):
            return pose
    return None


def main() -> None:
    """Run the problems and print the results."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--peers", action="store_true")
    parser.add_argument("--limit", type=float, default=60.0)
    args = parser.parse_args()
    rng, counts, times = np.random.default_rng(args.seed), Counter[str](), []
    stop, n = time.perf_counter() + args.seconds, 0
    while time.perf_counter() < stop:
        n += 1
        scene = random_scene(rng, 2 + n % 2)
        if scene is None:
            continue
        begin = time.perf_counter()
        plan = plan_motion(scene.body, scene.obstacles, scene.start, scene.goal, scene.bounds)
        times.append(1e3 * (time.perf_counter() - begin))
        counts[plan.status] += 1
        if plan.status == "found":
            counts["faulty"] += faults(scene, plan, 64) > 0
        if args.peers and plan.status == "impossible":
            from benchmarks.engine.ompl_peer import way_exists

            counts["contradicted"] += way_exists(scene, args.limit)
    print(dict(counts))
    print("ms: median {:.0f}, 95 % {:.0f}, most {:.0f}".format(*np.percentile(times, [50, 95, 100])))


if __name__ == "__main__":
    main()
