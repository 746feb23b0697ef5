"""First contact: the exact algorithm beside a sweep with shapely and Box2D's time of impact, in one process.

    python -m benchmarks.contact [--motions N] [--check N]

The sweep tests 32 poses of each motion and then halves the step. Box2D's b2TimeOfImpact takes convex pieces only, so
the body and the obstacles are convex here. --check compares that many random pushes and turns of all kinds of shapes
with shapely and counts disagreements: a motion that shapely finds to enter an obstacle, or one that stopped too early.
"""

import argparse
import math
import time
from collections.abc import Callable
from typing import Any

import numpy as np
import shapely
from shapely import affinity, box

from utak.geometry.motion.first_contact import ContactBody, Obstacles
from utak.geometry.motion.se2 import Motion, Rotate, Translate

CONTACT_ELL = shapely.Polygon([(0, 0), (3, 0), (3, 1), (1, 1), (1, 3), (0, 3)])
CONTACT_HORSESHOE = shapely.Polygon([(0, 0), (3, 0), (3, 2), (2, 2), (2, 1), (1, 1), (1, 2), (0, 2)])
CONTACT_SHAPES = [
    box(0, 0, 2, 2),
    box(0, 0, 4, 1),
    CONTACT_ELL,
    CONTACT_HORSESHOE,
    shapely.Polygon([(0, 0), (4, 0), (4, 3)]),
]


def swept(body: Any, solid: Any, motion: Motion, steps: int = 32) -> float:
    """Return the fraction of a motion at its first contact by a sweep: the first overlap, halved down to 1e-6."""
    poses = [motion.part(t).carry(body) for t in np.linspace(0, 1, steps)]
    hit = np.nonzero(shapely.intersects(solid, poses))[0]
    if len(hit) == 0:
        return 1.0
    low, high = max(int(hit[0]) - 1, 0) / (steps - 1), int(hit[0]) / (steps - 1)
    while high - low > 1e-6:
        middle = (low + high) / 2
        if solid.intersects(motion.part(middle).carry(body)):
            high = middle
        else:
            low = middle
    return low


def box2d_motions(body: Any, obstacles: list[Any], motions: list[Motion]) -> int:
    """Count the motions of a convex body that Box2D's time of impact stops at any convex obstacle.

    A turn is a sweep with its centre at the pivot. Box2D is made for small turns: in large ones it may miss impacts.
    """
    import Box2D

    moving = Box2D.b2PolygonShape(vertices=shapely.get_coordinates(body)[:-1].tolist())
    still = [Box2D.b2PolygonShape(vertices=shapely.get_coordinates(o)[:-1].tolist()) for o in obstacles]
    rest = Box2D.b2Sweep(a0=0, a=0, c0=(0, 0), c=(0, 0), localCenter=(0, 0), alpha0=0)
    stopped = 0
    for motion in motions:
        if isinstance(motion, Translate):
            sweep = Box2D.b2Sweep(a0=0, a=0, c0=(0, 0), c=tuple(motion), localCenter=(0, 0), alpha0=0)
        else:
            turn, pivot = math.radians(motion.degrees), motion.about
            sweep = Box2D.b2Sweep(a0=0, a=turn, c0=pivot, c=pivot, localCenter=pivot, alpha0=0)
        stopped += any(
            Box2D.b2TimeOfImpact(shapeA=moving, shapeB=s, sweepA=sweep, sweepB=rest, tMax=1.0)[1] < 1.0 for s in still
        )
    return stopped


def rate(work: Callable[[], Any], count: int, runs: int = 25) -> float:
    """Return the motions per second, the best of some runs."""
    best = math.inf
    for _ in range(runs):
        begin = time.perf_counter()
        work()
        best = min(best, time.perf_counter() - begin)
    return count / best


def speed(count: int, pieces: int) -> None:
    """Print a table: pushes and turns per second against various numbers of convex obstacles."""
    rng = np.random.default_rng(pieces)
    body, obstacles = box(-1, -1, 1, 1), []
    while len(obstacles) < pieces:
        x, y = rng.uniform(-12, 12, 2)
        piece = affinity.rotate(box(x, y, x + 1.5, y + 1), float(rng.uniform(0, 90)))
        if piece.distance(body) > 0.1:
            obstacles.append(piece)
    vectors, degrees = rng.uniform(-8, 8, (count, 2)), rng.uniform(-180, 180, count)
    prepared, mover = Obstacles(obstacles), ContactBody(body)
    prepared.pushes(mover, vectors[:2])
    solid = shapely.union_all(obstacles)
    shapely.prepare(solid)
    few = max(count // 40, 20)
    pushes: list[Motion] = [Translate(*v) for v in vectors[:few].tolist()]
    turns: list[Motion] = [
        Rotate(d, (x, y)) for d, (x, y) in zip(degrees[:few].tolist(), vectors[:few].tolist(), strict=True)
    ]
    rows = [
        ("push", rate(lambda: prepared.pushes(mover, vectors), count)),
        ("push, one call each", rate(lambda: [prepared.first_contact(mover, m) for m in pushes], few)),
        ("turn, one call each", rate(lambda: [prepared.first_contact(mover, m) for m in turns], few)),
        ("push, shapely sweep", rate(lambda: [swept(body, solid, m) for m in pushes], few)),
        ("turn, shapely sweep", rate(lambda: [swept(body, solid, m) for m in turns], few)),
    ]
    try:
        rows.append(("push, Box2D", rate(lambda: box2d_motions(body, obstacles, pushes), few)))
        rows.append(("turn, Box2D", rate(lambda: box2d_motions(body, obstacles, turns), few)))
    except ImportError:
        print("Box2D is not installed (pip install Box2D)")
    print(f"{len(prepared.surface.edges)} edges")
    for title, each in rows:
        print(f"  {title:22}{each:12.0f} a second")


def disagreements(count: int) -> int:
    """Count disagreements with shapely over random motions, each from where the last one stopped."""
    rng = np.random.default_rng(1)
    bad = done = 0
    while done < count:
        still = [_thrown(rng) for _ in range(4)]
        body = _thrown(rng)
        if any(body.relate(o)[0] == "2" for o in still):
            continue
        prepared = Obstacles(still)
        for _ in range(5):
            motion = _motion(rng)
            fraction = prepared.first_contact(ContactBody(body), motion)
            bad += _disagrees(body, still, motion, fraction)
            body = motion.part(fraction).carry(body)
            done += 1
    return bad


def _thrown(rng: np.random.Generator) -> Any:
    """Return a shape at a random place; half of the places are whole squares, with many flush contacts."""
    shape = CONTACT_SHAPES[int(rng.integers(len(CONTACT_SHAPES)))]
    if rng.random() < 0.5:
        turned = affinity.rotate(shape, 90.0 * int(rng.integers(4)), origin=(0, 0))
        return affinity.translate(turned, *np.round(rng.uniform(-6, 6, 2)))
    return affinity.translate(affinity.rotate(shape, float(rng.uniform(0, 360))), *rng.uniform(-6, 6, 2))


def _motion(rng: np.random.Generator) -> Motion:
    """Return a random push or turn, every other push along an axis."""
    if rng.random() < 0.5:
        dx, dy = rng.uniform(-9, 9, 2) if rng.random() < 0.5 else rng.integers(-9, 10, 2) * rng.integers(0, 2, 2)
        return Translate(float(dx), float(dy))
    x, y = rng.uniform(-6, 6, 2)
    return Rotate(float(rng.uniform(-400, 400)), (float(x), float(y)))


def _disagrees(body: Any, still: list[Any], motion: Motion, fraction: float) -> bool:
    """Return whether shapely finds that the motion enters an obstacle, or that it stopped too early."""
    travelled = motion.part(fraction)
    poses = [travelled.part(t).carry(body) for t in np.linspace(0, 1, 24)]
    for obstacle in still:
        if obstacle.intersects(shapely.union_all(poses)):
            cores = shapely.buffer(poses, -1e-6, join_style="mitre")
            if shapely.intersects(obstacle.buffer(-1e-6, join_style="mitre"), cores).any():
                return True
    if fraction == 1.0:
        return False
    length = math.hypot(*motion) if isinstance(motion, Translate) else abs(math.radians(motion.degrees)) * 10
    on = [motion.part(fraction + step / length).carry(body) for step in (1e-5, 1e-4, 1e-3)]
    return not any(pose.intersection(obstacle).area > 0.0 for pose in on for obstacle in still)


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--motions", type=int, default=2_000)
    parser.add_argument("--check", type=int, default=0)
    args = parser.parse_args()
    for pieces in (6, 69):
        speed(args.motions, pieces)
    if args.check:
        print(f"{disagreements(args.check)} disagreements with shapely in {args.check} motions")


if __name__ == "__main__":
    main()
