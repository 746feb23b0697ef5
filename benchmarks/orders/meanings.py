"""Plans for equal things: what it saves that the plan chooses which thing each parameter means.

    python -m benchmarks.orders.meanings [--count 20] [--seed S] [--things 2]

Random rooms with a wall and some equal things, as many as there are poses. The plan that may choose is compared with
the plans for each of the ways to tell the things apart beforehand: with the cheapest of them, and with the first one,
which is as good as any for somebody who does not look at the ways. The table tells the commands of the plans, and
the processor's milliseconds of the one that may choose and of the first one.
"""

import argparse
import statistics
import sys
import time
from collections.abc import Sequence
from dataclasses import replace
from itertools import permutations
from typing import NamedTuple

import numpy as np

from benchmarks.worlds.drawn import drawn_problem, drawn_situation
from utak.geometry.kernels.arrays import XY
from utak.geometry.manipulation.goals import At
from utak.geometry.motion.se2 import Pose
from utak.planner.oracles.carry import CarryOracle
from utak.planner.oracles.problem import TaskProblem
from utak.planner.situation import Situation
from utak.planner.tasking.search import MadePlan, make_plan

WIDTH, HEIGHT, SIDE = 36, 22, 3  # squares of the room and of a thing (a convention)
LEAST_WALL, MOST_WALL = 8, 13  # squares that the wall reaches into the room
EQUAL_NAMES = "ghkm"  # of the things


class EqualThings(NamedTuple):
    """A world with equal things.

    Attributes
    ----------
    rows : the drawing, the north row first.
    corners : the southwest corner (x, y) of each thing, in squares.
    ends : where the southwest corners of things shall be, as many as there are things.
    """

    rows: list[str]
    corners: tuple[XY, ...]
    ends: tuple[XY, ...]


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the table; return 0."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=20, help="worlds (%(default)s)")
    parser.add_argument("--seed", type=int, default=0, help="the first world's seed (%(default)s)")
    parser.add_argument(
        "--things", type=int, choices=range(1, len(EQUAL_NAMES) + 1), default=2, help="things (%(default)s)"
    )
    given = parser.parse_args(arguments)
    chosen, cheapest, first, times = [], [], [], []
    print("world  chosen  cheapest  first  proved   ms  ms of the first")
    for number in range(given.seed, given.seed + given.count):
        world = equal_things(np.random.default_rng([number, 7]), given.things)
        situation = drawn_situation(world.rows)
        fixed = [timed(one, situation) for one in told_apart(world, situation)]
        made, took = timed(problem_with_choice(world, situation), situation)
        costs = [one.plan.cost for one, _ in fixed if not one.plan.unmet]
        if made.plan.unmet or not costs or fixed[0][0].plan.unmet:
            print(f"{number:>5}  {'none' if made.plan.unmet else made.plan.cost:>6}  {min(costs, default='none'):>8}")
            continue
        chosen.append(made.plan.cost)
        cheapest.append(min(costs))
        first.append(fixed[0][0].plan.cost)
        times.append((took, fixed[0][1]))
        print(
            f"{number:>5}  {chosen[-1]:>6}  {cheapest[-1]:>8}  {first[-1]:>5}  {made.plan.proved!s:>6}"
            f"  {took:>3.0f}  {fixed[0][1]:>15.0f}"
        )
    if not chosen:
        return 0
    best = sum(one == other for one, other in zip(chosen, cheapest, strict=True))
    print(
        f"sum  {sum(chosen)} chosen, {sum(cheapest)} cheapest, {sum(first)} first; the cheapest in {best} of"
        f" {len(chosen)}; median {statistics.median(one for one, _ in times):.0f} ms, of the first"
        f" {statistics.median(other for _, other in times):.0f} ms"
    )
    return 0


def timed(problem: TaskProblem, situation: Situation) -> tuple[MadePlan, float]:
    """Return the plan for a problem, and the processor's milliseconds that it took when no kernel was compiled."""
    took = 0.0
    for _ in range(2):
        before = time.process_time()
        made = make_plan(problem, situation, CarryOracle(problem, situation, on_lattice=True))
        took = 1000 * (time.process_time() - before)
    return made, took


def told_apart(world: EqualThings, situation: Situation) -> list[TaskProblem]:
    """Return the problems in which it is told which thing goes to which end, one for each way to tell them apart."""
    found = []
    for ends in permutations(world.ends):
        pairs = zip(world.corners, ends, strict=True)
        by_name = {name: _end(corner, end) for name, (corner, end) in zip(EQUAL_NAMES, pairs, strict=False)}
        found.append(drawn_problem(situation, by_name))
    return found


def problem_with_choice(world: EqualThings, situation: Situation) -> TaskProblem:
    """Return the problem in which each parameter may mean each thing; the first one means the first thing so far."""
    names = EQUAL_NAMES[: len(world.corners)]
    problem = told_apart(world, situation)[0]
    goals = tuple(replace(goal, parameter=f"x{number}") for number, goal in enumerate(problem.goals))
    places = {
        (name, f"{goal.name}_pose"): _end(world.corners[thing], world.ends[number])
        for number, goal in enumerate(goals)
        for thing, name in enumerate(names)
    }
    fulfils = {(name, place): (place.removesuffix("_pose"),) for name, place in places}
    meanings = {goal.parameter: (goal.subject, *(n for n in names if n != goal.subject)) for goal in goals}
    return replace(problem, goals=goals, places=places, fulfils=fulfils, meanings=meanings)


def _end(corner: XY, end: XY) -> At:
    """Return the end of a thing whose southwest corner comes from one place to another one."""
    return At(Pose(end[0] - corner[0], end[1] - corner[1], 0.0))


def equal_things(rng: np.random.Generator, things: int) -> EqualThings:
    """Return a random world with equal things, apart from each other, from the wall and from the ends."""
    grid = [["."] * WIDTH for _ in range(HEIGHT)]
    for x in range(WIDTH):
        grid[0][x] = grid[-1][x] = "b"
    for row in grid:
        row[0] = row[-1] = "b"
    column, length = int(rng.integers(13, 22)), int(rng.integers(LEAST_WALL, MOST_WALL + 1))
    from_north = rng.random() < 0.5
    for y in range(1, length + 1):
        grid[HEIGHT - 1 - y if from_north else y][column] = "b"
    taken: list[XY] = []

    def spot(side: int) -> XY:
        """Return a place for a square with a side, and take it."""
        while True:
            x, y = int(rng.integers(3, WIDTH - 3 - side)), int(rng.integers(3, HEIGHT - 3 - side))
            around = {grid[b][a] for b in range(y - 2, y + side + 2) for a in range(x - 2, x + side + 2)}
            if around == {"."} and all(max(abs(x - a), abs(y - b)) > SIDE + 2 for a, b in taken):
                taken.append((x, y))
                return float(x), float(y)

    corners = tuple(spot(SIDE) for _ in range(things))
    ends = tuple(spot(SIDE) for _ in range(things))
    robot = spot(1)
    for name, (x, y) in zip(EQUAL_NAMES, corners, strict=False):
        for row in grid[int(y) : int(y) + SIDE]:
            row[int(x) : int(x) + SIDE] = name * SIDE
    grid[int(robot[1])][int(robot[0])] = "U"
    return EqualThings(["".join(row) for row in reversed(grid)], corners, ends)


if __name__ == "__main__":
    sys.exit(main())
