"""Carrying plans computed from the truth in random worlds of tasks 5 to 9; every plan is repeated with shapely.

    python -m benchmarks.errands [--task 5,6,7,8,9] [--seed N] [--count N] [--no-pull] [--margin M] [--unable]

Every twelfth world is impossible: there the missing width is compared with the true one.
"""

import argparse
import time
from collections import Counter
from collections.abc import Sequence
from typing import Any

import numpy as np
import shapely

from benchmarks.worlds.makers import scenario, seeds
from benchmarks.worlds.placing import digital
from benchmarks.worlds.scenes import RandomScenario
from benchmarks.worlds.walking import furthest_corner
from utak.geometry.manipulation.plan_carrying import CarryingPlan, InCorner, Inside, plan_carrying


def free_squares(world: RandomScenario) -> np.ndarray:
    """Return the squares that neither walls nor other objects cover, (rows, columns)."""
    width, height = world.plan.width, world.plan.height
    others = [world.plan.verge, *(thing.polygon for thing in world.things[1:])]
    return ~np.any([digital(other, width, height) for other in others], axis=0)


def goal_of(world: RandomScenario) -> InCorner | Inside:
    """Return the goal of the task as an end of manipulation planning, from the truth."""
    if world.task != 5:
        return Inside(list(shapely.get_parts(world.target)))
    corner = furthest_corner(world.plan.floor, "northeast", world.heading)
    assert corner is not None
    x, y, inward_x, inward_y = corner
    return InCorner(x, y, -int(inward_x), -int(inward_y))


def faults(plan: CarryingPlan, shape: Any, free: np.ndarray, goal: InCorner | Inside, samples: int = 65) -> list[str]:
    """Return what is wrong with a plan when it is repeated with shapely; nothing when it is correct."""
    rows, columns = np.nonzero(free)
    floor = shapely.union_all(shapely.box(columns, rows, columns + 1, rows + 1)).buffer(1e-6, join_style="mitre")
    shapely.prepare(floor)
    wrong = []
    for leg in plan.legs:
        square = np.floor(np.array(leg.place)) + leg.direction_square
        if shapely.box(*square, *(square + 1)).intersection(shape).area < 1e-9:
            wrong.append("grasp")
        utak = shapely.Point(leg.place)
        for motion in leg.motions:
            swept = [motion.part(t).carry(shape) for t in np.linspace(0, 1, samples)]
            way = [motion.part(t).carry(utak) for t in np.linspace(0, 1, samples)]
            wrong += [] if shapely.covers(floor, swept).all() and shapely.covers(floor, way).all() else ["collision"]
            shape, utak = motion.carry(shape), motion.carry(utak)
    if isinstance(goal, Inside):
        ended = any(part.buffer(1e-5).covers(shape) for part in shapely.get_parts(goal.polygon))
    else:
        ended = max(goal.gaps(shape.bounds)) <= goal.slack + 1e-5
    return wrong if ended else [*wrong, "goal"]


def main(arguments: Sequence[str] | None = None) -> None:
    """Print a line for each task, and one for each world with a fault."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--task", default="5,6,7,8,9")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--count", type=int, default=40)
    parser.add_argument("--no-pull", action="store_true")
    parser.add_argument("--margin", type=float, default=0.0)
    parser.add_argument("--unable", action="store_true", help="only worlds in which the task cannot be done")
    args = parser.parse_args(arguments)
    for task in [int(part) for part in args.task.split(",")]:
        statuses, times, commands, off = Counter[str](), [], [], []
        for seed in seeds(args.seed, args.count, args.unable):
            world = scenario(task, seed)
            shape, free, goal = world.things[0].polygon, free_squares(world), goal_of(world)
            utak = (world.utak.x, world.utak.y)
            begin = time.perf_counter()
            plan = plan_carrying(shape, free, utak, goal, args.margin, not args.no_pull)
            taken = time.perf_counter() - begin
            wanted = "found" if world.possible else "impossible"
            statuses[plan.status if plan.status == wanted else f"WRONG {plan.status}"] += 1
            if plan.status == "found":
                times.append(taken)
                commands.append(plan.commands)
                wrong = faults(plan, shape, free, goal)
                statuses["faulty"] += bool(wrong)
            if not world.possible:
                off.append(plan.missing - world.missing)
            if plan.status != wanted or (plan.status == "found" and wrong):
                print(f"  task {task} seed {seed}: {plan.status} {plan.reason}, wanted {wanted}; {1e3 * taken:.0f} ms")
        told = "ms median {:.0f}, 95 % {:.0f}, most {:.0f}".format(*(1e3 * np.percentile(times or [0], [50, 95, 100])))
        most = f"commands median {np.median(commands or [0]):.0f}, most {max(commands or [0])}"
        print(f"task {task}: {dict(statuses)}, {told}; {most}; missing off by {[round(v, 2) for v in off]}", flush=True)


if __name__ == "__main__":
    main()
