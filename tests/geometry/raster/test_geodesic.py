"""Geodesic distances against Dijkstra's algorithm on a graph, and crossing numbers against angles."""

import heapq
import itertools
import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from utak.geometry.raster.geodesic import GEODESIC_UNREACHED, reach
from utak.geometry.raster.winding import MAX_CROSSING_NUMBER, crossing_number, shortest_path_with_crossing_number

STEPS = [(dr, dc) for dr in (-1, 0, 1) for dc in (-1, 0, 1) if dr or dc]


def moves(free: np.ndarray, row: int, column: int):  # type: ignore[no-untyped-def]
    """Yield the squares reached in one step, with its cost; no corner of a blocked square is cut."""
    for dr, dc in STEPS:
        p, q = row + dr, column + dc
        if 0 <= p < free.shape[0] and 0 <= q < free.shape[1] and free[p, q] and free[row, q] and free[p, column]:
            yield (p, q), 7 if dr and dc else 5


def least_costs(free: np.ndarray, start: tuple[int, int]) -> dict[tuple[int, int], int]:
    """Return the least cost from a start (row, column) to every square that it can reach."""
    best, queue = {start: 0}, [(0, start)]
    while queue:
        cost_so_far, square = heapq.heappop(queue)
        if cost_so_far == best[square]:
            for other, cost in moves(free, *square):
                if cost_so_far + cost < best.get(other, 10**9):
                    best[other] = cost_so_far + cost
                    heapq.heappush(queue, (cost_so_far + cost, other))
    return best


def raster(rows: int, columns: int, seed: int) -> tuple[np.ndarray, np.random.Generator]:
    """Return a random mask, and the generator that it came from."""
    rng = np.random.default_rng(seed)
    return rng.random((rows, columns)) < rng.uniform(0.5, 1.0), rng


@settings(max_examples=100, deadline=None)
@given(st.integers(1, 12), st.integers(1, 12), st.integers(0, 2**32 - 1))
def test_distances_equal_those_of_dijkstra_on_a_graph(rows: int, columns: int, seed: int) -> None:
    free, rng = raster(rows, columns, seed)
    row, column = int(rng.integers(rows)), int(rng.integers(columns))
    free[row, column] = True
    want = np.full(free.shape, GEODESIC_UNREACHED)
    for square, cost_so_far in least_costs(free, (row, column)).items():
        want[square] = cost_so_far
    assert np.array_equal(reach(free, column, row), want)


def test_a_start_in_a_wall_or_outside_is_refused() -> None:
    free = np.array([[True, False]])
    for column, row in ((1, 0), (2, 0), (-1, 0), (0, 1)):
        with pytest.raises(ValueError, match="not a free square"):
            reach(free, column, row)


point = st.tuples(st.integers(-9, 9), st.integers(-9, 9)).map(lambda p: (p[0] + 0.5, p[1] + 0.25))


def full_turns(points: list[tuple[float, float]], about: tuple[float, float]) -> float:
    """Return how far a polyline turns about a point, in full turns, by angles."""
    angles = [math.atan2(y - about[1], x - about[0]) for x, y in points]
    steps = [(b - a + math.pi) % (2 * math.pi) - math.pi for a, b in itertools.pairwise(angles)]
    return sum(steps) / (2 * math.pi)


@pytest.mark.long
@settings(max_examples=300, deadline=None)
@given(st.lists(point, min_size=2, max_size=12))
def test_the_crossing_number_of_a_closed_line_is_its_winding_number(points: list[tuple[float, float]]) -> None:
    about = (0.1, 0.1)
    closed = [*points, points[0]]
    for (ax, ay), (bx, by) in itertools.pairwise(closed):  # no side through the point itself
        cross = (bx - ax) * (about[1] - ay) - (by - ay) * (about[0] - ax)
        assume(abs(cross) > 1e-6 or (ax, ay) == (bx, by))
    assert crossing_number(np.array(closed), about) == round(full_turns(closed, about))


@pytest.mark.long
@settings(max_examples=300, deadline=None)
@given(st.lists(point, min_size=1, max_size=6), st.lists(point, min_size=1, max_size=6), point)
def test_crossing_numbers_add_up_and_change_sign_when_reversed(
    one: list, other: list, middle: tuple[float, float]
) -> None:
    first, second = np.array([*one, middle]), np.array([middle, *other])
    about = (0.1, 0.1)
    assert crossing_number(np.vstack([first, second[1:]]), about) == crossing_number(first, about) + crossing_number(
        second, about
    )
    assert crossing_number(first[::-1], about) == -crossing_number(first, about)


def sheets(free: np.ndarray, start: tuple[int, int], about: tuple[float, float]) -> dict[tuple[int, int, int], int]:
    """Return the least cost to each (crossing number, row, column), by Dijkstra on these triples."""
    best, queue = {(0, *start): 0}, [(0, (0, *start))]
    while queue:
        cost_so_far, state = heapq.heappop(queue)
        if cost_so_far > best[state]:
            continue
        number, row, column = state
        for (p, q), cost in moves(free, row, column):
            step = crossing_number(np.array([(column + 0.5, row + 0.5), (q + 0.5, p + 0.5)]), about)
            other = (number + step, p, q)
            if abs(other[0]) <= MAX_CROSSING_NUMBER and cost_so_far + cost < best.get(other, 10**9):
                best[other] = cost_so_far + cost
                heapq.heappush(queue, (cost_so_far + cost, other))
    return best


def cost_of(squares: list[tuple[int, int]]) -> int:
    """Return the cost of a path over squares."""
    return sum(7 if a != c and b != d else 5 for (a, b), (c, d) in itertools.pairwise(squares))


@settings(max_examples=40, deadline=None)
@given(
    st.integers(3, 9),
    st.integers(3, 9),
    st.integers(0, 2**32 - 1),
    st.integers(-MAX_CROSSING_NUMBER, MAX_CROSSING_NUMBER),
)
def test_a_path_is_the_shortest_with_its_crossing_number(rows: int, columns: int, seed: int, number: int) -> None:
    free, rng = raster(rows, columns, seed)
    row, column = int(rng.integers(1, rows - 1)), int(rng.integers(1, columns - 1))
    free[row, column] = False
    free[0, 0] = free[-1, -1] = True
    about = (column + 0.5, row + 0.5)
    best = sheets(free, (0, 0), about)
    for goal in ((0, 0), (rows - 1, columns - 1)):
        path = shortest_path_with_crossing_number(free, (0, 0), goal[::-1], about, number)
        want = best.get((number, *goal))
        if path is None:
            assert want is None
            continue
        assert path[0] == (0, 0)
        assert path[-1] == goal[::-1]
        assert crossing_number(np.array(path) + 0.5, about) == number
        assert cost_of(path) == want
        assert all((b, a) in [m for m, _ in moves(free, d, c)] for (c, d), (a, b) in itertools.pairwise(path))


def test_a_number_out_of_range_and_a_blocked_end_are_refused() -> None:
    free = np.array([[True, False], [True, True]])
    with pytest.raises(ValueError, match="crossing numbers"):
        shortest_path_with_crossing_number(free, (0, 0), (0, 1), (1.5, 0.5), MAX_CROSSING_NUMBER + 1)
    with pytest.raises(ValueError, match="not a free square"):
        shortest_path_with_crossing_number(free, (0, 0), (1, 0), (1.5, 0.5), 0)
