"""Routes on random small floors, compared with exact answers.

    python -m benchmarks.floors --count 10000 [--seed 1] [--only words,shortest,images,chains]

Every floor goes through every check once, with a random start and goal. What differs from brute force
(benchmarks/engine/exact.py) is printed with the floor's number. The exit code is 1 when anything differs.
"""

import argparse
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterator
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from benchmarks.engine.exact import Exact
from utak.geometry import Route, Screen
from utak.geometry.kernels.arrays import XY, Bools
from utak.geometry.pathfinders.visibility_graph import visibility_path

PATH_TOLERANCE = 1e-9  # squares by which lengths may differ because of rounding (a convention)


def random_floor(rng: np.random.Generator) -> Bools:
    """Return a floor of at most 12 x 12, at least two squares of it free: noise, rooms, oblique corridor, or maze."""
    while True:
        rows, columns = (int(v) for v in rng.integers(2, 13, 2))
        free = FLOOR_MAKERS[int(rng.integers(len(FLOOR_MAKERS)))](rng, rows, columns)
        if free.sum() >= 2:
            return free


def noise(rng: np.random.Generator, rows: int, columns: int) -> Bools:
    """Return a floor with squares blocked at random."""
    return rng.random((rows, columns)) >= rng.choice([0.05, 0.15, 0.3, 0.45, 0.6])


def rooms(rng: np.random.Generator, rows: int, columns: int) -> Bools:
    """Return a floor with walls across it, each with one or two gaps."""
    free = np.ones((rows, columns), np.bool_)
    for axis, size in ((0, rows), (1, columns)):
        for at in rng.choice(size, min(size, int(rng.integers(0, 3))), replace=False):
            wall = free if axis == 0 else free.T
            wall[at] = False
            for _ in range(int(rng.integers(1, 3))):
                first = int(rng.integers(wall.shape[1]))
                wall[at, first : first + int(rng.integers(1, 3))] = True
    return free


def oblique(rng: np.random.Generator, rows: int, columns: int) -> Bools:
    """Return a corridor oblique to the grid, with some squares blocked."""
    i, j = np.indices((rows, columns))
    steep = rng.choice([-1.0, -0.5, 0.5, 1.0, 2.0])
    free: Bools = np.abs(i - rows / 2 - steep * (j - columns / 2)) <= rng.integers(1, 6)
    return free & (rng.random((rows, columns)) >= rng.choice([0.0, 0.05]))


def maze(rng: np.random.Generator, rows: int, columns: int) -> Bools:
    """Return a maze: pillars at odd rows and columns, each with a wall to one side."""
    free = np.ones((rows, columns), np.bool_)
    for i in range(1, rows - 1, 2):
        for j in range(1, columns - 1, 2):
            a, b = ((0, 1), (1, 0), (0, -1), (-1, 0))[int(rng.integers(4))]
            free[i, j] = free[i + a, j + b] = False
    return free


FLOOR_MAKERS = [noise, noise, rooms, oblique, maze]


def random_point(rng: np.random.Generator, free: Bools) -> XY:
    """Return a point in a free square: its centre, or a quarter off, or on its southern or western edge."""
    squares = np.argwhere(free)
    row, column = squares[int(rng.integers(len(squares)))].tolist()
    x, y = rng.choice([0.0, 0.25, 0.5, 0.5, 0.75], 2).tolist()
    return column + x, row + y


class Case:
    """A random floor with its exact answers, a screen, a start and a goal.

    Attributes
    ----------
    rng : numpy.random.Generator
        Draws whatever else a check needs; the same for the same seed and number.
    free : (rows, columns) bool
    exact : Exact
    screen : Screen
    start, goal : (x, y) in squares
    """

    def __init__(self, seed: int, number: int) -> None:
        self.rng = np.random.default_rng([seed, number])
        self.free = random_floor(self.rng)
        self.exact, self.screen = Exact(self.free), Screen(self.free)
        self.start, self.goal = random_point(self.rng, self.free), random_point(self.rng, self.free)

    def walk(self) -> NDArray[np.float64] | None:
        """Return a random walk from start to goal over centres of edge neighbours; None when it does not arrive."""
        here, there = ((int(p[0]), int(p[1])) for p in (self.start, self.goal))
        line: list[XY] = [self.start]
        for _ in range(400):
            line.append((here[0] + 0.5, here[1] + 0.5))
            if here == there:
                return np.array([*line, self.goal])
            steps = [(here[0] + a, here[1] + b) for a, b in ((1, 0), (0, 1), (-1, 0), (0, -1))]
            open_steps = [p for p in steps if self.exact.padded[p[1] + 1, p[0] + 1]]
            if not open_steps:
                return None
            here = open_steps[int(self.rng.integers(len(open_steps)))]
        return None


def words(case: Case) -> Iterator[str]:
    """Yield faults of signatures: two lines of one class must have one signature, of two classes two."""
    routes = case.screen.routes(case.start, case.goal, k=6)
    lines = [route.points for route in routes]
    for route in routes:
        if case.screen.tighten(route).signature != route.signature:
            yield "a route that is tightened has another signature"
    signatures = [route.signature for route in routes]
    walk = case.walk()
    if walk is not None:
        tight = case.screen.tighten(Route(walk, 0.0, 0.0, (), ()))
        if case.exact.word(tight.points) != case.exact.word(walk):
            yield "tightening changes the class"
        if not case.exact.is_free(tight.points):
            yield "a tightened line leaves free space"
        lines.append(walk)
        signatures.append(tight.signature)
    classes = [case.exact.word(line) for line in lines]
    for k, (one, signature) in enumerate(zip(classes, signatures, strict=True)):
        for other, another in zip(classes[:k], signatures[:k], strict=True):
            if (one == other) != (signature == another):
                yield f"classes {one} and {other} have the signatures {signature} and {another}"
    if len(set(signatures[: len(routes)])) < len(routes):
        yield "two routes are of one class"


def shortest(case: Case) -> Iterator[str]:
    """Yield faults of shortest routes: exact lengths, first in order, in free space, with a clearance."""
    least = float(case.exact.distances(case.start, [case.goal])[0])
    best = case.screen.shortest(case.start, case.goal)
    if (least == np.inf) != (best is None) or (best is not None and abs(best.length - least) > PATH_TOLERANCE):
        yield f"shortest says {best and best.length}, not {least}"
    seen = visibility_path(case.free, case.start, case.goal)
    long = np.inf if seen is None else float(np.hypot(*np.diff(seen, axis=0).T).sum())
    if abs(long - least) > PATH_TOLERANCE and long != least:
        yield f"the visibility graph says {long}, not {least}"
    for k in (1, 2, 3, 5):
        routes = case.screen.routes(case.start, case.goal, k=k)
        if bool(routes) != (least < np.inf):
            yield f"k = {k}: {len(routes)} routes"
        if routes and k > 1 and abs(routes[0].length - least) > PATH_TOLERANCE:
            yield f"k = {k}: the first is {routes[0].length} long, not {least}"
        for route in routes:
            yield from faults(case, route, case.start, case.goal)


def faults(case: Case, route: Route, start: XY, goal: XY) -> Iterator[str]:
    """Yield what is wrong with a route of a point between two ends."""
    if not case.exact.is_free(route.points):
        yield f"a route leaves free space: {route.points.tolist()}"
    if tuple(route.points[0]) != start or tuple(route.points[-1]) != goal:
        yield "a route has other ends"
    if abs(route.length - float(np.hypot(*np.diff(route.points, axis=0).T).sum())) > PATH_TOLERANCE:
        yield "a route's length is not that of its points"
    if not 0.0 < route.clearance < np.inf:
        yield f"a route's clearance is {route.clearance}"


def images(case: Case) -> Iterator[str]:
    """Yield answers that differ between a floor and its mirror image or its quarter turn."""
    rows, columns = case.free.shape
    squares = np.argwhere(case.free)
    (i, j), (m, n) = (squares[int(k)].tolist() for k in case.rng.integers(0, len(squares), 2))

    def mirrored(x: float, y: float) -> XY:
        return columns - x, y

    def turned(x: float, y: float) -> XY:
        return rows - y, x

    start, end = (j + 0.5, i + 0.5), (n + 0.5, m + 0.5)
    expected = answers(case.screen, start, end)
    for image, place in ((np.fliplr, mirrored), (lambda a: np.fliplr(a.T), turned)):
        again = answers(Screen(image(case.free)), place(*start), place(*end))
        if not np.allclose(expected, again, rtol=0, atol=PATH_TOLERANCE):
            yield f"{expected} on the floor and {again} on its image"


def answers(screen: Screen, start: XY, end: XY) -> list[float]:
    """Return what no symmetry changes: the shortest length, number of routes, cycles."""
    first = screen.routes(start, end, k=3)
    graph = screen.pathgraph
    return [
        first[0].length if first else -1.0,
        float(graph.number_of_edges() - graph.number_of_nodes()),
    ]


def chains(case: Case) -> Iterator[str]:
    """Yield faults of the edges of the pathgraph: their length, clearance and points must agree."""
    for _, _, edge in case.screen.pathgraph.edges(data=True):
        points = edge["points"]
        long = float(np.hypot(*np.diff(points, axis=0).T).sum())
        if abs(edge["length"] - long) > PATH_TOLERANCE:
            yield f"an edge has length {edge['length']}, its points {long}"
        if not case.exact.is_free(points):
            yield "an edge leaves free space"
        if case.screen.tighten(Route(points, 0.0, 0.0, (), ())).length > edge["length"] + PATH_TOLERANCE:
            yield "an edge is shorter than the shortest way of its class"
        lowest = min(case.screen.clearance[int(y), int(x)] for x, y in points)
        if edge["clearance"] != lowest:
            yield f"an edge has clearance {edge['clearance']}, its squares {lowest}"
        if any(abs(p - q).sum() != 1.0 for p, q in pairwise(points)):
            yield "an edge jumps"


CHECKS: dict[str, Callable[[Case], Iterator[str]]] = {
    check.__name__: check for check in (words, shortest, images, chains)
}


def disagreements(check: str, seed: int, number: int) -> list[str]:
    """Return what one check finds wrong on the floor of a seed and number, each as a sentence."""
    return list(CHECKS[check](Case(seed, number)))


def main() -> int:
    """Check random floors, print what is wrong, and return 1 when anything is, else 0."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=10000, help="floors")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--first", type=int, default=0, help="the number of the first floor")
    parser.add_argument("--only", default=",".join(CHECKS), help="checks, with commas between")
    options = parser.parse_args()
    wrong: Counter[str] = Counter()
    begun = time.process_time()
    for number in range(options.first, options.first + options.count):
        for check in options.only.split(","):
            for what in disagreements(check, options.seed, number):
                print(f"floor {number}, {check}: {what}", flush=True)
                wrong[check] += 1
    print(f"{options.count} floors, {sum(wrong.values())} disagreements", end=" ")
    print(dict(wrong) if wrong else "", f"({time.process_time() - begun:.0f} s of the processor)")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
