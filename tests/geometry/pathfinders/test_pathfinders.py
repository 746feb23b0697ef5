"""The shortest route against an exact visibility graph; the path-finders to compare with; maps and pictures."""

from pathlib import Path
from xml.etree import ElementTree

import networkx as nx
import numpy as np
import pytest
import shapely
from hypothesis import given, settings

from benchmarks.engine.movingai import read_map, read_trips
from tests.geometry import oracles
from tests.geometry.routes.test_routes import polygon, trips
from utak.geometry import Screen
from utak.geometry.io.svg import draw
from utak.geometry.pathfinders.grid_astar import grid_path
from utak.geometry.pathfinders.visibility_graph import visibility_path


def pinches(free):
    """Return tiny squares about the points where two blocked squares touch at a corner."""
    padded = np.pad(free, 1)
    return [
        shapely.box(x - 1e-7, y - 1e-7, x + 1e-7, y + 1e-7)
        for y in range(free.shape[0] + 1)
        for x in range(free.shape[1] + 1)
        if (b := padded[y : y + 2, x : x + 2]).sum() == 2 and b[0, 0] == b[1, 1]
    ]


def exact_length(free, start, goal):
    """Return the length of the shortest path in an exact visibility graph made with shapely, in squares."""
    space = polygon(free).buffer(1e-9, join_style="mitre").difference(shapely.union_all(pinches(free)).buffer(0))
    points = [tuple(start), tuple(goal), *map(tuple, oracles.corners_of(free))]
    graph = nx.Graph()
    graph.add_nodes_from((0, 1))
    for i, p in enumerate(points):
        for j in range(i):
            q = points[j]
            if p == q or space.covers(shapely.LineString([p, q])):
                graph.add_edge(i, j, weight=float(np.hypot(p[0] - q[0], p[1] - q[1])))
    return nx.shortest_path_length(graph, 0, 1, "weight") if nx.has_path(graph, 0, 1) else None


@settings(max_examples=40, deadline=None)
@given(trips(most=6))
def test_the_shortest_route_is_the_exact_optimum(trip):
    free, start, goal = trip
    if pinches(free):
        free = free.copy()
        for i, j in np.argwhere(~free):  # corners that touch would need a cleverer oracle: clear them away
            free[i, j] = bool(pinches(free))
    route = Screen(free).shortest(start, goal)
    expected = exact_length(free, start, goal)
    assert (route is None) == (expected is None)
    if route is not None:
        assert route.length == pytest.approx(expected, abs=1e-7)


@settings(max_examples=100, deadline=None)
@given(trips(most=14))
def test_the_shortest_route_is_never_longer_than_another(trip):
    free, start, goal = trip
    screen = Screen(free)
    route, others = screen.shortest(start, goal), screen.routes(start, goal, k=12)
    assert (route is None) == (not others)
    if route is None:
        assert visibility_path(free, start, goal) is None
        assert grid_path(free, start, goal) is None
        return
    assert route.length == pytest.approx(others[0].length, abs=1e-9)
    assert route.length == pytest.approx(oracles.length(visibility_path(free, start, goal)), abs=1e-7)
    assert oracles.length(grid_path(free, start, goal)) >= route.length - 1e-9


@settings(max_examples=60, deadline=None)
@given(trips())
def test_grid_paths_are_legal_and_shortest_on_the_grid(trip):
    free, start, goal = trip
    graph = nx.Graph()
    rows, columns = free.shape
    for y, x in np.argwhere(free):
        graph.add_node((x, y))
        for dx, dy in ((1, 0), (0, 1), (1, 1), (-1, 1)):
            if 0 <= x + dx < columns and y + dy < rows and free[y + dy, x + dx] and free[y + dy, x] and free[y, x + dx]:
                graph.add_edge((x, y), (x + dx, y + dy), weight=float(np.hypot(dx, dy)))
    a, b = ((int(p[0]), int(p[1])) for p in (start, goal))
    way = grid_path(free, (a[0] + 0.5, a[1] + 0.5), (b[0] + 0.5, b[1] + 0.5))
    if nx.has_path(graph, a, b):
        assert oracles.length(way) == pytest.approx(nx.shortest_path_length(graph, a, b, "weight"))
    else:
        assert way is None


MAP = "type octile\nheight 2\nwidth 3\nmap\n.@.\n...\n"


def test_maps_are_read_south_first(tmp_path: Path):
    path = tmp_path / "a.map"
    path.write_text(MAP)
    assert read_map(path).tolist() == [[True, True, True], [True, False, True]]
    (tmp_path / "a.map.scen").write_text("version 1\n0\ta.map\t3\t2\t0\t0\t2\t0\t4\n")
    (trip,) = read_trips(tmp_path / "a.map.scen")
    assert trip == ((0.5, 1.5), (2.5, 1.5), 4.0)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (MAP.replace("height 2", "height x"), ":2: .*whole number"),
        (MAP.replace("height 2", "height 3"), "2 rows, not 3"),
        (MAP.replace(".@.", ".@"), ":5: .*2 squares, not 3"),
        (MAP.replace("@", "%"), ":5: .*unknown square '%'"),
        ("hello", "height N"),
        (MAP.replace("map", "mop"), "'map' is missing"),
    ],
)
def test_errors_of_maps_name_the_line(tmp_path: Path, text, message):
    path = tmp_path / "a.map"
    path.write_text(text)
    with pytest.raises(ValueError, match=message):
        read_map(path)


def test_a_picture_shows_squares_skeleton_pathgraph_and_routes():
    free = np.ones((7, 9), bool)
    free[3, 3:6] = False
    screen = Screen(free)
    routes = screen.routes((1.5, 3.5), (7.5, 3.5))
    tree = ElementTree.fromstring(draw(screen, routes, ((1.5, 3.5), (7.5, 3.5))))
    classes = [element.get("class") for element in tree.iter()]
    assert classes.count("route") == len(routes) == 2
    assert classes.count("chain") == screen.pathgraph.number_of_edges()
    assert classes.count("node") == screen.pathgraph.number_of_nodes()
    assert {"blocked", "skeleton", "start", "goal"} <= set(classes)
