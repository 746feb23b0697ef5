"""Doors of random floors: the same however a floor is turned, mirrored and moved, and cut along their mouths.

    python -m benchmarks.doorways [--count N] [--seed S]

The passages of each floor are compared with those of its eight images under the symmetries of the grid, each moved by
another frame of walls. The cut floor is compared with the pieces that shapely cuts. Prints the numbers of floors and
passages, and each disagreement with a picture of the floor; the exit code is 1 when there is one.
"""

import argparse
import itertools
import sys
from collections import Counter
from collections.abc import Callable, Iterator

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.affinity import rotate

from utak.geometry import Passage, Screen
from utak.geometry.kernels.arrays import Bools, Labels

Outline = tuple[object, ...]
MAX_FLOOR_SIDE = 26  # squares (a convention)
CUT_HALF_WIDTH = 1e-6  # squares: of a cut in shapely (a convention)


def random_floor(rng: np.random.Generator) -> Bools:
    """Return a random floor (rows, columns) with at least one free square: clutter, or rooms, some of them oblique."""
    make = (_cluttered, _walled, _slanted, _with_corridors)[int(rng.integers(4))]
    free = make(rng)
    free[int(rng.integers(free.shape[0])), int(rng.integers(free.shape[1]))] = True
    return free


def _cluttered(rng: np.random.Generator) -> Bools:
    """Return a floor with single squares blocked at random."""
    free: Bools = rng.random(rng.integers(1, 16, size=2)) >= rng.choice([0.0, 0.08, 0.25, 0.4])
    return free


def _walled(rng: np.random.Generator) -> Bools:
    """Return a floor with walls across, each with doors anywhere: in the middle or flush with another wall."""
    free = np.ones(rng.integers(6, MAX_FLOOR_SIDE, size=2), np.bool_)
    for _ in range(int(rng.integers(1, 4))):
        view = free if rng.random() < 0.5 else free.T
        place, thick = int(rng.integers(1, view.shape[0] - 1)), int(rng.integers(1, 5))
        view[place : place + thick] = False
        for _ in range(int(rng.integers(1, 3))):
            wide = int(rng.integers(1, 5))
            last = view.shape[1] - wide
            door = int(rng.choice([0, max(last, 0), rng.integers(0, max(last, 0) + 1)]))
            view[place : place + thick, door : door + wide] = True
    return free & (rng.random(free.shape) >= rng.choice([0.0, 0.0, 0.02]))


def _slanted(rng: np.random.Generator) -> Bools:
    """Return two rooms with a door between, turned by any angle; squares that walls touch are blocked."""
    high, wide = (float(v) for v in rng.uniform(5, 11, size=2))
    left, gap = float(rng.uniform(4, 9)), float(rng.uniform(0.6, 3.5))
    door = float(rng.uniform(1, 0.5 * high))
    south = float(rng.choice([0.0, high - door, rng.uniform(0, high - door)]))
    rooms = [shapely.box(0, 0, left, high), shapely.box(left + gap, 0, left + gap + wide, high)]
    floor = shapely.union_all([*rooms, shapely.box(left, south, left + gap, south + door)])
    floor = rotate(floor, float(rng.uniform(0, 90)), origin=(0, 0))
    x0, y0, x1, y1 = floor.bounds
    columns, rows = np.meshgrid(np.arange(np.floor(x0), np.ceil(x1)), np.arange(np.floor(y0), np.ceil(y1)))
    free: Bools = shapely.covers(floor, shapely.box(columns, rows, columns + 1, rows + 1))
    return free


def _with_corridors(rng: np.random.Generator) -> Bools:
    """Return rooms joined by corridors with a bend."""
    free = np.zeros(rng.integers(10, MAX_FLOOR_SIDE, size=2), np.bool_)
    high, wide = free.shape
    middles = []
    for _ in range(int(rng.integers(2, 5))):
        row, column = int(rng.integers(0, high - 4)), int(rng.integers(0, wide - 4))
        h, w = (int(v) for v in rng.integers(3, 9, size=2))
        free[row : row + h, column : column + w] = True
        middles.append((min(row + h // 2, high - 1), min(column + w // 2, wide - 1)))
    for (a, b), (c, d) in itertools.pairwise(middles):
        thick = int(rng.integers(1, 4))
        free[min(a, c) : max(a, c) + thick, b : b + thick] = True
        free[c : c + thick, min(b, d) : max(b, d) + thick] = True
    return free


def disagreements(free: Bools) -> list[str]:
    """Return what is wrong with the passages of a floor, each as a sentence."""
    passages = Screen(free).passages()
    labels = Screen(free).parts(passages)
    expected = Counter(_outline(passage, lambda point: point) for passage in passages)
    found = []
    for number, (turns, mirrored) in enumerate((t, m) for m in (False, True) for t in range(4)):
        image = np.pad(_turned(free, turns, mirrored), [(number % 3, 1), (2, number % 2)])
        seen = Screen(image).passages()
        back = _way_back(free.shape, turns, mirrored, (2.0, float(number % 3)))
        if Counter(_outline(passage, back) for passage in seen) != expected:
            found.append(f"turned {turns} times, mirrored {mirrored}: other passages")
        parts = Screen(image).parts(seen)[number % 3 : -1, 2 : image.shape[1] - number % 2]
        if not _same_parts(_turned(labels, turns, mirrored), parts):
            found.append(f"turned {turns} times, mirrored {mirrored}: other parts")
    return [*found, *_badly_cut(free, passages, labels)]


def _outline(passage: Passage, back: Callable[[tuple[float, float]], tuple[float, float]]) -> Outline:
    """Return a passage without the order of its sides and ends, its points mapped by ``back``."""
    sides = sorted(
        (tuple(sorted(map(back, mouth))), side) for mouth, side in zip(passage.mouths, passage.sides, strict=True)
    )
    between = sorted(back((column + 0.5, row + 0.5)) for column, row in passage.between)
    return passage.width, tuple(sides), tuple(between)


def _turned(grid: NDArray[np.generic], turns: int, mirrored: bool) -> NDArray[np.generic]:
    """Return a grid mirrored left to right, if asked, then turned by so many quarters."""
    return np.ascontiguousarray(np.rot90(grid[:, ::-1] if mirrored else grid, turns))


def _way_back(
    shape: tuple[int, ...], turns: int, mirrored: bool, frame: tuple[float, float]
) -> Callable[[tuple[float, float]], tuple[float, float]]:
    """Return the map from points (x, y) of a turned and framed floor back to the floor, which has that shape."""

    def back(point: tuple[float, float]) -> tuple[float, float]:
        x, y = point[0] - frame[0], point[1] - frame[1]
        high, wide = (shape[0], shape[1]) if turns % 2 == 0 else (shape[1], shape[0])
        for _ in range(turns):  # np.rot90 moves the square in row i and column j to row wide - 1 - j and column i
            x, y = high_to_wide(x, y, high)
            high, wide = wide, high
        return (wide - x, y) if mirrored else (x, y)

    def high_to_wide(x: float, y: float, high: int) -> tuple[float, float]:
        return high - y, x

    return back


def _same_parts(one: NDArray[np.generic], other: NDArray[np.generic]) -> bool:
    """Return whether two grids of labels divide the squares alike."""
    pairs = {*zip(one.ravel().tolist(), other.ravel().tolist(), strict=True)}
    return len(pairs) == len({a for a, _ in pairs}) == len({b for _, b in pairs}) and (0, 0) in pairs | {(0, 0)}


def _badly_cut(free: Bools, passages: list[Passage], labels: Labels) -> Iterator[str]:
    """Yield what is wrong with the cuts along passages, compared with an exact cut of the floor as a polygon."""
    rows, columns = np.nonzero(free)
    floor = shapely.union_all(shapely.box(columns, rows, columns + 1, rows + 1))
    lines = shapely.MultiLineString([mouth for passage in passages for mouth in passage.mouths])
    for passage in passages:
        for mouth in passage.mouths:
            inner = shapely.line_interpolate_point(
                shapely.linestrings(mouth), np.linspace(0.01, 0.99, 99), normalized=True
            )
            if not shapely.contains_properly(floor, inner).all():
                yield f"the mouth {mouth} leaves the floor"
    pieces = shapely.get_parts(
        floor.difference(lines.buffer(CUT_HALF_WIDTH, cap_style="square")).buffer(-CUT_HALF_WIDTH)
    )
    where = shapely.STRtree(pieces)
    known = np.argwhere(labels > 0)
    points = shapely.points(known[:, 1] + 0.5, known[:, 0] + 0.5)
    numbers, inside = where.query(points, predicate="within")
    if sorted(numbers.tolist()) != list(range(len(known))):
        yield "a square that belongs to a part lies on a cut"
    pairs = {*zip(labels[tuple(known[numbers].T)].tolist(), inside.tolist(), strict=True)}
    if len({a for a, _ in pairs}) != len(pairs):
        yield "a part holds squares that the cuts divide"
    if len({b for _, b in pairs}) != len(pairs):
        yield "a part ends where no cut is"
    for passage in passages:
        (x, y), (u, v) = passage.gates
        if not (labels[int(y), int(x)] and labels[int(v), int(u)]):
            yield f"a gate of the passage at {passage.place} is in no part"


def main(argv: list[str] | None = None) -> int:
    """Check random floors, print what is wrong, and return 1 when anything is, else 0."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--count", type=int, default=10_000)
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args(argv)
    rng = np.random.default_rng(options.seed)
    doors = wrong = 0
    for number in range(options.count):
        free = random_floor(rng)
        doors += len(Screen(free).passages())
        expected = disagreements(free)
        wrong += bool(expected)
        if expected:
            picture = "\n".join("".join(".#"[not square] for square in row) for row in free[::-1])
            print(f"floor {number}:", *expected, picture, "", sep="\n")
    print(f"{options.count} floors, {doors} passages, {wrong} floors with a disagreement")
    return int(wrong > 0)


if __name__ == "__main__":
    sys.exit(main())
