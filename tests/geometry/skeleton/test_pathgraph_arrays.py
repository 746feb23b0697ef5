"""The pathgraph in arrays and as a networkx graph, against plain loops and against networkx's own calls."""

import copy
import gc
import pickle

import networkx as nx
import numpy as np
import pytest
from hypothesis import given, settings

from tests.geometry import lookalikes, oracles
from utak.geometry import Screen
from utak.geometry.skeleton.networkx_export import networkx_graph, paused_collection


def plain(graph):
    """Nodes and edges of a networkx graph in its own order, as lists that can be compared."""
    nodes = [(n, dict(data)) for n, data in graph.nodes(data=True)]
    edges = [
        (a, b, key, {name: v.tolist() if name == "points" else v for name, v in data.items()})
        for a, b, key, data in graph.edges(keys=True, data=True)
    ]
    return nodes, edges, {n: list(row) for n, row in graph.adjacency()}


def by_networkx(arrays):
    """The same graph by the public calls of networkx, one node and one edge at a time."""
    graph = nx.MultiGraph()
    for node, ((x, y), clearance) in enumerate(
        zip(arrays.nodes.tolist(), arrays.node_clearances.tolist(), strict=True)
    ):
        graph.add_node(node, x=x, y=y, clearance=clearance)
    for edge, (a, b) in enumerate(arrays.edges.tolist()):
        graph.add_edge(
            a,
            b,
            key=edge,
            length=arrays.lengths[edge].item(),
            clearance=arrays.edge_clearances[edge].item(),
            points=arrays.points_of(edge),
        )
    return graph


def assert_consistent(screen, arrays):
    """Everything in the arrays follows from the clearance of the screen, the nodes and the points."""
    clearance, m = screen.clearance, len(arrays.edges)
    assert [clearance[int(y), int(x)] for x, y in arrays.nodes] == arrays.node_clearances.tolist()
    assert sorted(map(tuple, arrays.nodes[:, ::-1].tolist())) == [*map(tuple, arrays.nodes[:, ::-1].tolist())]
    assert arrays.offsets[0] == 0 and arrays.offsets[-1] == len(arrays.points)
    for edge in range(m):
        points = arrays.points_of(edge)
        along = [clearance[int(y), int(x)] for x, y in points]
        assert (points[[0, -1]] == arrays.nodes[arrays.edges[edge]]).all()
        assert (np.abs(np.diff(points, axis=0)).sum(axis=1) == 1).all()
        assert arrays.lengths[edge] == len(points) - 1
        assert arrays.edge_clearances[edge] == min(along)


@settings(max_examples=150, deadline=None)
@given(oracles.screens(most=16))
def test_arrays_and_graph_say_what_plain_loops_say(free):
    screen = Screen(free)
    assert_consistent(screen, screen.pathgraph_arrays)
    assert plain(screen.pathgraph) == plain(by_networkx(screen.pathgraph_arrays))


@pytest.mark.parametrize("kind", lookalikes.KINDS)
def test_arrays_and_graph_of_larger_floors(kind):
    screen = Screen(lookalikes.lookalike(kind, 60, 2, 6))
    assert_consistent(screen, screen.pathgraph_arrays)
    assert plain(screen.pathgraph) == plain(by_networkx(screen.pathgraph_arrays))


def test_arrays_are_computed_once_and_read_only():
    screen = Screen(np.ones((4, 7), bool))
    arrays = screen.pathgraph_arrays
    assert screen.pathgraph_arrays is arrays
    for array in arrays:
        with pytest.raises(ValueError, match="read-only"):
            array[...] = 0


@pytest.fixture
def graph():
    """A graph with parallel edges and many nodes."""
    free = np.ones((12, 30), bool)
    free[4:8, 4:8] = free[:, 12:14] = free[3:5, 20:24] = free[8, 20:24] = False
    free[6, 12:14] = True
    return Screen(free).pathgraph


def test_both_directions_of_an_edge_share_their_attributes(graph):
    for a, b, key in graph.edges(keys=True):
        graph[a][b][key]["mark"] = key
        assert graph[b][a][key]["mark"] == key


def test_the_graph_can_be_changed_as_any_multigraph(graph):
    nodes, edges = graph.number_of_nodes(), graph.number_of_edges()
    a, b, key = next(iter(graph.edges(keys=True)))
    new = graph.add_edge(a, b, length=1.0)
    assert new not in (None, key) and graph.number_of_edges() == edges + 1
    graph.add_node("outside", x=0.0)
    graph.add_edge("outside", a)
    degree = graph.degree(a)
    loops = graph.number_of_edges(a, a)
    graph.remove_node(a)
    assert graph.number_of_nodes() == nodes and graph.number_of_edges() == edges + 2 - degree + loops
    assert a not in graph and all(a not in row for row in graph.adj.values())
    graph.remove_edges_from([*graph.edges(keys=True)])
    assert graph.number_of_edges() == 0


def test_copies_pickles_and_views_are_the_same_graph(graph):
    for other in (graph.copy(), copy.deepcopy(graph), pickle.loads(pickle.dumps(graph)), nx.MultiGraph(graph)):
        assert plain(other)[:2] == plain(graph)[:2]
        assert type(other) is nx.MultiGraph
        other.remove_node(0)
        assert 0 in graph
    assert graph.to_directed().number_of_edges() >= graph.number_of_edges()
    assert graph.subgraph([0]).number_of_nodes() == 1
    assert nx.is_connected(graph)
    assert nx.shortest_path_length(graph, 0, max(graph), weight="length") > 0.0


def test_points_of_the_graph_belong_to_its_user():
    screen = Screen(np.ones((5, 9), bool))
    kept = screen.pathgraph_arrays.points.copy()
    for _, _, data in screen.pathgraph.edges(data=True):
        data["points"] += 1.0
    assert (screen.pathgraph_arrays.points == kept).all()


@pytest.mark.parametrize("enabled", [True, False])
def test_the_garbage_collector_is_left_as_it_was(enabled):
    was = gc.isenabled()
    try:
        (gc.enable if enabled else gc.disable)()
        networkx_graph(Screen(np.ones((3, 3), bool)).pathgraph_arrays)
        assert gc.isenabled() == enabled
        with pytest.raises(RuntimeError), paused_collection():
            raise RuntimeError
        assert gc.isenabled() == enabled
    finally:
        (gc.enable if was else gc.disable)()
