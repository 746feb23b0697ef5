"""Loops about objects, and goals that are sets of squares."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from geometry import Screen
from tests.geometry import oracles


def winding_number(points, x, y):
    """Return how often a closed polyline winds about a point that it does not meet, counter-clockwise positive."""
    fine = np.concatenate([np.linspace(p, q, 50) for p, q in pairwise(points)])
    angle = np.unwrap(np.arctan2(fine[:, 1] - y, fine[:, 0] - x))
    return round(float(angle[-1] - angle[0]) / (2 * np.pi))


def test_a_loop_hugs_the_object():
    free = np.ones((9, 12), bool)
    free[4:6, 5:8] = False
    screen = Screen(free)
    (loop,) = screen.loops((2.5, 4.5), ~free, k=1)
    assert loop.points[0].tolist() == loop.points[-1].tolist() == [2.5, 4.5]
    assert winding_number(loop.points, 6.5, 5.0) == 1
    assert {(5.0, 4.0), (8.0, 4.0), (8.0, 6.0), (5.0, 6.0)} <= set(map(tuple, loop.points.tolist()))
    assert loop.length == pytest.approx(oracles.length([(2.5, 4.5), (5, 4), (8, 4), (8, 6), (5, 6), (2.5, 4.5)]))


def test_no_loop_leads_about_the_outer_wall_or_through_a_gap_that_is_too_narrow():
    free = np.ones((9, 12), bool)
    free[0:6, 5:8] = False
    assert Screen(free).loops((2.5, 4.5), ~free) == []
    free[0:2] = True
    assert len(Screen(free).loops((2.5, 4.5), ~free)) == 1
    assert Screen(free).loops((2.5, 4.5), ~free, radius=1.0) == []


@settings(max_examples=60, deadline=None)
@given(oracles.screens(most=12))
def test_every_loop_winds_once(free):
    holes = [(i, j) for i, j in np.argwhere(~free)]
    screen = Screen(free)
    start = np.argwhere(free)[0]
    for i, j in holes[:3]:
        mask = np.zeros_like(free)
        mask[i, j] = True
        loops = screen.loops((start[1] + 0.5, start[0] + 0.5), mask, k=3)
        assert len({loop.signature for loop in loops}) == len(loops)
        for loop in loops:
            assert winding_number(loop.points, j + 0.5, i + 0.5) == 1


@settings(max_examples=80, deadline=None)
@given(oracles.screens(most=12), st.data())
def test_a_route_to_a_set_is_as_short_as_the_best_to_its_squares(free, data):
    screen = Screen(free)
    squares = np.argwhere(free)
    start = squares[data.draw(st.integers(0, len(squares) - 1))]
    picks = data.draw(st.lists(st.integers(0, len(squares) - 1), min_size=1, max_size=3, unique=True))
    goal = np.zeros_like(free)
    goal[tuple(squares[picks].T)] = True
    point = (start[1] + 0.5, start[0] + 0.5)
    routes = screen.routes(point, goal, k=3)
    single = [screen.routes(point, (j + 0.5, i + 0.5), k=3) for i, j in np.argwhere(goal)]
    best = min((r.length for found in single for r in found), default=None)
    assert bool(routes) == (best is not None)
    if routes:
        assert routes[0].length <= best + 1e-9
        assert all(goal[int(r.points[-1][1]), int(r.points[-1][0])] for r in routes)
        as_set = {(int(j), int(i)) for i, j in np.argwhere(goal)}
        assert [r.length for r in screen.routes(point, as_set, k=3)] == [r.length for r in routes]


def test_a_region_as_goal_is_entered_once_for_each_class():
    free = np.ones((9, 15), bool)
    free[3:6, 5:7] = False
    goal = np.zeros_like(free)
    goal[:, 11:] = True
    free[4, 12] = False  # a pillar within the goal makes no further classes
    routes = Screen(free).routes((1.5, 4.5), goal & free, k=5)
    assert len(routes) >= 2
    assert all(r.points[-1][0] == 11.5 for r in routes[:2])
