"""Routes are in free space, tight, distinct and the best of all, against brute force and shapely."""

from itertools import islice, pairwise

import networkx as nx
import numpy as np
import pytest
import shapely
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from tests.geometry import oracles
from utak.geometry import Route, Screen

MAX_PATHS = 500  # ways over a pathgraph: screens with more are left out, for there may be any number


def polygon(free):
    return shapely.union_all([shapely.box(j, i, j + 1, i + 1) for i, j in np.argwhere(free)])


@st.composite
def trips(draw, most=10):
    """Draw a screen and two points in free squares."""
    free = draw(oracles.screens(most=most))
    squares = np.argwhere(free)
    picks = draw(st.tuples(*[st.integers(0, len(squares) - 1)] * 2))
    shifts = draw(st.tuples(*[st.sampled_from([0.5, 0.25, 0.9])] * 4))
    (a, b), (c, d) = squares[picks[0]], squares[picks[1]]
    return free, (b + shifts[0], a + shifts[1]), (d + shifts[2], c + shifts[3])


def is_tight(points, space):
    """Return whether no corner of a route can be cut, however little."""
    for a, v, b in zip(points, points[1:], points[2:], strict=False):
        p, q = v + (a - v) * 1e-3, v + (b - v) * 1e-3
        triangle = shapely.Polygon([p, v, q])
        if triangle.area > 1e-12 and space.buffer(1e-9).covers(triangle):
            return False
    return True


def pathgraph_polylines(screen, start, goal):
    """Yield every simple path over the pathgraph as a polyline of centres, its ends attached by steepest ascents."""
    graph = nx.MultiGraph()
    for a, b, key, edge in screen.pathgraph.edges(keys=True, data=True):
        for n, (p, q) in enumerate(pairwise(map(tuple, edge["points"].tolist()))):
            graph.add_edge(p, q, key=(a, b, key, n))
    graph.add_nodes_from((d["x"], d["y"]) for _, d in screen.pathgraph.nodes(data=True))
    up, down = (ascent(screen, p, graph) for p in (start, goal))
    between = [[up[-1]]] if up[-1] == down[-1] else nx.all_simple_paths(graph, up[-1], down[-1])
    yield from ([start, *up, *path[1:-1], *down[::-1], goal] for path in between)


def ascent(screen, point, graph):
    """Return the centres from a point's square up to the pathgraph along the steepest ascent."""
    x, y = int(point[0]) + 0.5, int(point[1]) + 0.5
    path = [(x, y)]
    rank = {}
    for (j, i), c in np.ndenumerate(screen.clearance):
        rank[i + 0.5, j + 0.5] = (round(4 * c * c), j, i)
    while not graph.has_node((x, y)):
        x, y = max(((x + 1, y), (x, y + 1), (x - 1, y), (x, y - 1)), key=lambda p: rank.get(p, (-1,)))
        path.append((x, y))
    return path


@settings(max_examples=150, deadline=None)
@given(trips())
def test_routes_lie_in_free_space_and_are_tight_and_distinct(trip):
    free, start, goal = trip
    screen, space = Screen(free), polygon(free)
    routes = screen.routes(start, goal, k=6)
    assert len({route.signature for route in routes}) == len(routes)
    assert [route.length for route in routes] == sorted(route.length for route in routes)
    for route in routes:
        assert tuple(route.points[0]) == start
        assert tuple(route.points[-1]) == goal
        assert route.length == pytest.approx(oracles.length(route.points), abs=1e-9)
        assert start == goal or space.buffer(1e-9).covers(shapely.LineString(route.points))
        assert is_tight(route.points, space)


@settings(max_examples=100, deadline=None)
@given(trips(most=8))
def test_routes_are_the_best_classes_of_all(trip):
    free, start, goal = trip
    screen = Screen(free)
    if not screen.routes(start, goal, k=1):
        return
    paths = list(islice(pathgraph_polylines(screen, start, goal), MAX_PATHS + 1))
    assume(len(paths) <= MAX_PATHS)
    best = sorted(oracles.length(oracles.rubber_band(path, free)) for path in paths)
    found = [route.length for route in screen.routes(start, goal, k=5)]
    assert found == pytest.approx(best[:5], abs=1e-9)


@settings(max_examples=60, deadline=None)
@given(trips())
def test_a_goal_in_another_component_cannot_be_reached(trip):
    free, start, goal = trip
    graph = nx.Graph()
    graph.add_nodes_from(map(tuple, np.argwhere(free)))
    graph.add_edges_from(
        ((i, j), (i + a, j + b)) for i, j in np.argwhere(free) for a, b in ((0, 1), (1, 0)) if (i + a, j + b) in graph
    )
    a, b = ((int(p[1]), int(p[0])) for p in (start, goal))
    assert bool(Screen(free).routes(start, goal)) == nx.has_path(graph, a, b)


@settings(max_examples=80, deadline=None)
@given(trips())
def test_tightening_finds_the_same_route_again(trip):
    free, start, goal = trip
    screen = Screen(free)
    for route in screen.routes(start, goal, k=4):
        again = screen.tighten(route)
        assert (again.length, again.signature) == (pytest.approx(route.length, abs=1e-9), route.signature)


def test_a_loose_route_is_tightened():
    free = np.ones((7, 9), bool)
    free[3, 3:6] = False
    screen = Screen(free)
    loose = Route(np.array([[1.5, 3.5], [1.5, 6.5], [8.5, 6.5], [7.5, 3.5]]), 0.0, 0.5, (), ())
    tight = screen.tighten(loose)
    assert tight.points.tolist() == [[1.5, 3.5], [3.0, 4.0], [6.0, 4.0], [7.5, 3.5]]
    with pytest.raises(ValueError, match="leaves free space"):
        screen.tighten(Route(np.array([[1.5, 3.5], [7.5, 3.5]]), 0.0, 0.5, (), ()))


@pytest.mark.parametrize(
    ("start", "goal", "message"),
    [
        ((1.5, 1.5), (0.5, 0.5), "start .* blocked"),
        ((0.5, 0.5), (1.5, 1.5), "goal .* blocked"),
        ((-1.0, 0.5), (0.5, 0.5), "start .* outside"),
        ((float("nan"), 0.5), (0.5, 0.5), "start .* outside"),
        ((0.5, 0.5), (0.5, 9.0), "goal .* outside"),
        ((0.5, 0.5), (1.0, 2.0, 3.0), "goal must be"),
        ((0.5, 0.5), {(0, 1)}, "goal must be a point"),
        ((0.5,), (0.5, 0.5), "start must be a point"),
        ((0.5, 0.5, 0.5), (0.5, 0.5), "start must be a point"),
        (None, (0.5, 0.5), "start must be a point"),
        (("east", 0.5), (0.5, 0.5), "start must be a point"),
    ],
)
def test_errors_name_the_bad_end(start, goal, message):
    free = np.ones((3, 3), bool)
    free[1, 1] = False
    with pytest.raises(ValueError, match=message):
        Screen(free).routes(start, goal)


@pytest.mark.parametrize(
    "wish",
    [{"k": 0}, {"k": 1.5}, {"k": None}],
    ids=str,
)
def test_errors_name_the_bad_number(wish):
    with pytest.raises(ValueError, match=f"{next(iter(wish))} must be"):
        Screen(np.ones((3, 3), bool)).routes((0.5, 0.5), (2.5, 2.5), **wish)
