"""Routes on random small floors against exact answers, and on floors where they were wrong before."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from benchmarks.floors import CHECKS, disagreements
from utak.geometry import Route, Screen
from utak.geometry.homotopy.portals import word_of_line
from utak.geometry.pathfinders.visibility_graph import visibility_path
from utak.geometry.routes.lifting import lift_to_skeleton

FLOOR_SEED = 20  # other floors than those of the campaign


def floor(*rows: str) -> np.ndarray:
    """Return a floor drawn north row first; # is blocked."""
    return np.array([[square != "#" for square in row] for row in rows[::-1]])


@pytest.mark.long
@pytest.mark.parametrize("check", CHECKS)
@settings(max_examples=40, deadline=None, derandomize=True)
@given(number=st.integers(0, 2**31))
def test_floors_are_answered_exactly(check: str, number: int) -> None:
    assert disagreements(check, FLOOR_SEED, number) == []


def test_a_line_that_ends_between_two_rows_ends_in_the_upper_one() -> None:
    screen = Screen(floor("......", "....#.", "....#.", "..#..."))
    routes = screen.routes((3.5, 1.5), (5.0, 3.0), k=2)
    assert len({route.signature for route in routes}) == 2
    assert [screen.tighten(route).signature for route in routes] == [route.signature for route in routes]


def test_a_line_that_ends_at_a_pinch_must_come_from_the_side_of_its_square() -> None:
    screen = Screen(floor("#.", ".#"))
    with pytest.raises(ValueError, match="leaves free space"):
        screen.tighten(Route(np.array([[0.5, 0.5], [1.0, 1.0]]), 0.0, 0.0, (), ()))
    assert screen.tighten(Route(np.array([[1.5, 1.5], [1.0, 1.0]]), 0.0, 0.0, (), ())).signature == ()


def test_a_route_from_a_place_to_itself_has_length_zero() -> None:
    screen = Screen(np.ones((7, 7), bool))
    (route,) = screen.routes((3.2, 3.7), (3.2, 3.7))
    assert (route.length, route.points.tolist()) == (0.0, [[3.2, 3.7]])
    (beside,) = screen.routes((3.2, 3.7), (3.8, 3.7))
    assert beside.length == pytest.approx(0.6)


def test_the_visibility_graph_does_not_look_through_a_pinch_from_the_pinch() -> None:
    free = floor("#.", ".#")
    assert visibility_path(free, (1.0, 1.0), (0.5, 0.5)) is None
    assert visibility_path(free, (0.5, 0.5), (1.0, 1.0)) is None
    assert visibility_path(free, (1.0, 1.0), (1.5, 1.5)) is not None


def test_the_length_of_an_edge_round_one_blocked_square_is_that_of_its_points() -> None:
    graph = Screen(floor(".#.", "...")).pathgraph
    ((_, _, edge),) = graph.edges(data=True)
    assert edge["length"] == np.hypot(*np.diff(edge["points"], axis=0).T).sum() == 4.0


def test_no_clearance_is_missing_among_random_squares() -> None:
    rng = np.random.default_rng(3)
    missing = 0
    for _ in range(4):
        free = rng.random((60, 60)) >= 0.3
        screen, squares = Screen(free), np.argwhere(free)
        for i, j in rng.integers(0, len(squares), (25, 2)):
            start, goal = (tuple((squares[n][::-1] + 0.5).tolist()) for n in (i, j))
            best = screen.shortest(start, goal)
            for k in (2, 3, 5):
                routes = screen.routes(start, goal, k=k)
                missing += sum(not route.clearance > 0.0 for route in routes)
                assert bool(routes) == (best is not None)
                assert best is None or routes[0].length == pytest.approx(best.length, abs=1e-9)
    assert missing == 0


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**31))
def test_a_class_is_lifted_to_the_path_by_which_it_was_found(number: int) -> None:
    rng = np.random.default_rng(number)
    free = rng.random(rng.integers(2, 14, 2)) >= rng.choice([0.05, 0.2, 0.4])
    free[0, 0] = True
    screen, squares = Screen(free), np.argwhere(free)
    start, goal = (tuple((squares[n][::-1] + 0.5).tolist()) for n in rng.integers(0, len(squares), 2))
    for route in screen.routes(start, goal, k=1):
        layer = screen._queries.layer
        found, _ = lift_to_skeleton(layer, (*start, *goal), word_of_line(layer.strips, route.points.tolist()))
        assert (0.5 * found.lowest**0.5, found.chains) == (route.clearance, route.chains)
