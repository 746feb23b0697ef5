"""Task plans in worlds that are known: how near to the best, and how long they take.

    python -m benchmarks.orders.planning optimum [--count 30] [--seed S]
    python -m benchmarks.orders.planning rooms [--count 12] [--seed S] [--rooms 6] [--things 6] [--goals 1,2,3]

`optimum`: small random rooms with a niche and two or three things that must go to poses, some of which block others.
The plan is compared with the cheapest sequence of errands that a search over all states finds which has the same places
and asks the same geometry, but neither the encoding nor its refutations. `rooms`: rooms in two rows (six of them
have seven doors) with a thing in some of them; plans for some numbers of goals, in milliseconds of the processor,
without the work of the first call of a kernel.
"""

import argparse
import heapq
import itertools
import statistics
import sys
import time
from collections.abc import Iterator, Sequence

import numpy as np

from benchmarks.worlds.drawn import drawn_problem, drawn_situation
from utak.geometry.manipulation.goals import At, End
from utak.geometry.motion.se2 import Pose
from utak.planner.oracles.carry import CarryOracle
from utak.planner.oracles.problem import TableState, TaskProblem
from utak.planner.situation import Situation
from utak.planner.tasking.search import MadePlan, make_plan

ROOM_WIDTH, ROOM_HEIGHT = 11, 10  # squares of each of the six rooms (a convention)
HOUSE_NAMES = "ghkmnpqrst"  # of the things in a house
GOALS, THINGS = (1, 2, 3), 6  # numbers of goals, and things in a house, where no others are asked for (a convention)
DOOR_WIDTH = 5  # squares (a convention)
MAX_ERRANDS = 5  # of the exhaustive search: beyond them no plan of these small worlds is cheaper
Drawing = list[list[str]]


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the table of one of the two measurements."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=("optimum", "rooms"))
    parser.add_argument("--count", type=int, default=0, help="worlds (30, or 12 for each number of goals)")
    parser.add_argument("--seed", type=int, default=0, help="the first world's seed (%(default)s)")
    parser.add_argument("--rooms", type=int, choices=range(2, 13, 2), default=6, help="rooms (%(default)s)")
    parser.add_argument("--things", type=int, help="things, each in a room of its own (as many as rooms, at most 6)")
    parser.add_argument("--goals", default=",".join(map(str, GOALS)), help="things with a goal (%(default)s)")
    given = parser.parse_args(arguments)
    if given.what == "optimum":
        return optimum(given.count or 30, given.seed)
    things = min(given.rooms, THINGS) if given.things is None else given.things
    if not 1 <= things <= min(given.rooms, len(HOUSE_NAMES)):
        parser.error(f"there are {things} things, and not 1 to {min(given.rooms, len(HOUSE_NAMES))}")
    goals = [number for number in map(int, given.goals.split(",")) if number <= things]
    return rooms(given.count or 12, given.seed, given.rooms, things, goals)


def optimum(count: int, seed: int) -> int:
    """Print, for each small world, the cost of the plan and of the cheapest one; return 0."""
    ratios, proved, missed = [], 0, 0
    print("world  things  plan  best  ratio  proved")
    for number in _small_worlds(seed, count):
        rows, ends = small_world(np.random.default_rng([number, 5]))
        situation = drawn_situation(rows)
        problem = drawn_problem(situation, ends)
        made = make_plan(problem, situation, CarryOracle(problem, situation, on_lattice=True))
        best = cheapest(made, problem, situation)
        if best is None or made.plan.unmet:
            missed += best is not None
            print(
                f"{number:>5}  {len(ends):>6}  {'none' if made.plan.unmet else made.plan.cost:>4}  {best or 'none':>4}"
            )
            continue
        ratios.append(made.plan.cost / best)
        proved += made.plan.proved and made.plan.cost == best
        print(f"{number:>5}  {len(ends):>6}  {made.plan.cost:>4}  {best:>4}  {ratios[-1]:.2f}  {made.plan.proved}")
    print(f"mean ratio {statistics.mean(ratios):.3f} of {len(ratios)}; fewest and proved {proved}; missed {missed}")
    return 0


def _small_worlds(seed: int, count: int) -> Iterator[int]:
    """Yield the numbers of some small worlds from a seed on; in those left out no second thing found a place."""
    numbers = (n for n in itertools.count(seed) if len(small_world(np.random.default_rng([n, 5]))[1]) > 1)
    return itertools.islice(numbers, count)


def cheapest(made: MadePlan, problem: TaskProblem, situation: Situation) -> int | None:
    """Return the least cost of any sequence of at most MAX_ERRANDS errands that attains all goals; None for none."""
    oracle = CarryOracle(problem, situation, on_lattice=True)
    places: dict[str, list[tuple[str, End]]] = {}
    for (name, place), end in made.places.items():
        places.setdefault(name, []).append((place, end))
    goals = {(goal.subject, place) for goal in problem.goals for (x, place) in problem.fulfils if x == goal.subject}
    front: list[tuple[int, int, int, TableState]] = [(0, 0, 0, problem.state)]
    done: set[object] = set()
    counter = 0
    while front:
        cost, depth, _, state = heapq.heappop(front)
        if all(state.things[name].place == place for name, place in goals):
            return cost
        key = (tuple((name, one.place) for name, one in state.things.items()), state.robot)
        if key in done or depth == MAX_ERRANDS:
            continue
        done.add(key)
        for name, ends in places.items():
            for place, end in ends:
                if place == state.things[name].place or name == state.last:
                    continue
                answer = oracle.bring(state, name, end, place)
                if answer.after is not None:
                    counter += 1
                    heapq.heappush(front, (cost + answer.commands, depth + 1, counter, answer.after))
    return None


def small_world(rng: np.random.Generator) -> tuple[list[str], dict[str, End]]:
    """Return a random room with a niche, and up to three things with the pose of each: one in the niche, its mouth."""
    width, height, deep = int(rng.integers(14, 19)), int(rng.integers(11, 15)), int(rng.integers(8, 12))
    side = int(rng.integers(3, 5))
    low = int(rng.integers(1, height - side - 1))
    grid: Drawing = [["b"] * (width + deep + 2) for _ in range(height + 2)]
    _clear(grid, 1, 1, width, height)
    _clear(grid, width + 1, low, deep, side)
    names = "ghk"[: int(rng.integers(2, 4))]
    spots = list(_free_spots(grid, side, rng, width))
    ends: dict[str, End] = {}
    mouth = [width + deep - side, width - side + 1, width // 2]
    for name, (x, y), column in zip(names, spots, mouth, strict=False):
        _fill(grid, x, y, side, side, name)
        ends[name] = At(Pose(float(column + 1 - x), float(low - y), 0.0))
    robot = next((x, y) for x, y in _free_spots(grid, 1, rng, width))
    grid[robot[1]][robot[0]] = "U"
    return ["".join(row) for row in reversed(grid)], ends


def rooms(count: int, seed: int, number_of_rooms: int, things: int, numbers_of_goals: Sequence[int]) -> int:
    """Print the processor's milliseconds of plans for some numbers of goals in a house; return 0."""
    print(f"{number_of_rooms} rooms, {things} things")
    print("goals  planned  median ms  95th ms  most ms  proposals  questions")
    for goals in numbers_of_goals:
        times, proposals, questions, planned = [], [], [], 0
        for number in range(seed, seed + count):
            rows, ends = house(np.random.default_rng([number, goals, 6]), goals, number_of_rooms, things)
            situation = drawn_situation(rows)
            problem = drawn_problem(situation, ends)
            for _ in range(2):  # the second time, for the first one may compile a kernel
                oracle = CarryOracle(problem, situation, on_lattice=True)
                before = time.process_time()
                made = make_plan(problem, situation, oracle)
                took = 1000 * (time.process_time() - before)
            times.append(took)
            proposals.append(made.plan.rounds)
            questions.append(oracle.asked)
            planned += not made.plan.unmet
        ordered = sorted(times)
        high = ordered[min(len(ordered) - 1, round(0.95 * len(ordered)))]
        print(
            f"{goals:>5}  {planned:>3}/{count:<3}  {statistics.median(times):>9.0f}  {high:>7.0f}  {ordered[-1]:>7.0f}"
            f"  {statistics.median(proposals):>9.0f}  {statistics.median(questions):>9.0f}",
            flush=True,
        )
    return 0


def house(
    rng: np.random.Generator, goals: int, number_of_rooms: int = 6, things: int = 6
) -> tuple[list[str], dict[str, End]]:
    """Return rooms in two rows with doors between neighbours, some things, and poses in other rooms for some of them.

    goals : things that have a pose. number_of_rooms : an even number. things : at most one a room, and at most 10.
    """
    wide, high, columns = ROOM_WIDTH + 2, ROOM_HEIGHT + 2, number_of_rooms // 2
    grid: Drawing = [["b"] * (columns * wide + 2) for _ in range(2 * high + 2)]
    corners = [(2 + wide * column, 2 + high * row) for row in range(2) for column in range(columns)]
    for x, y in corners:
        _clear(grid, x, y, ROOM_WIDTH, ROOM_HEIGHT)
    for x, y in corners:
        if (x, y)[0] > 2:
            _clear(grid, x - 2, y + int(rng.integers(0, ROOM_HEIGHT - DOOR_WIDTH)), 2, DOOR_WIDTH)
        if y > 2:
            _clear(grid, x + int(rng.integers(0, ROOM_WIDTH - DOOR_WIDTH)), y - 2, DOOR_WIDTH, 2)
    ends: dict[str, End] = {}
    order, shift = list(rng.permutation(number_of_rooms)), int(rng.integers(1, number_of_rooms))
    for number, name in enumerate(HOUSE_NAMES[:things]):
        x0, y0 = corners[order[number]]
        side = int(rng.integers(2, 5))
        x, y = x0 + int(rng.integers(2, ROOM_WIDTH - side - 1)), y0 + int(rng.integers(2, ROOM_HEIGHT - side - 1))
        _fill(grid, x, y, side, side, name)
        if number < goals:
            x1, y1 = corners[order[(number + shift) % number_of_rooms]]
            ends[name] = At(Pose(float(x1 - x), float(y1 - y), 0.0))
    x0, y0 = corners[order[0]]
    grid[y0][x0 + ROOM_WIDTH - 1] = "U"
    return ["".join(row) for row in reversed(grid)], ends


def _clear(grid: Drawing, x: int, y: int, width: int, height: int) -> None:
    """Make floor of a rectangle of squares; (x, y) is its southwest one."""
    _fill(grid, x, y, width, height, ".")


def _fill(grid: Drawing, x: int, y: int, width: int, height: int, mark: str) -> None:
    """Write a mark on a rectangle of squares; (x, y) is its southwest one."""
    for row in range(y, y + height):
        for column in range(x, x + width):
            grid[row][column] = mark


def _free_spots(grid: Drawing, side: int, rng: np.random.Generator, width: int) -> Iterator[tuple[int, int]]:
    """Yield random places (x, y) of squares with a side, a square of floor about them; they need not be apart later."""
    taken: list[tuple[int, int]] = []
    for _ in range(2000):
        x, y = int(rng.integers(2, width - side)), int(rng.integers(2, len(grid) - side - 2))
        around = [grid[row][column] for row in range(y - 1, y + side + 1) for column in range(x - 1, x + side + 1)]
        apart = all(max(abs(x - a), abs(y - b)) > side + 1 for a, b in taken)
        if set(around) == {"."} and apart:
            taken.append((x, y))
            yield x, y


if __name__ == "__main__":
    sys.exit(main())
