"""Clearance, skeleton and pathgraph compared with brute force: they have the components and holes of free space."""

import networkx as nx
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.geometry import lookalikes, oracles
from tests.geometry.measuring import measure
from utak.geometry import Screen
from utak.geometry.raster import distance_transform
from utak.geometry.skeleton.graph import contract
from utak.geometry.skeleton.skeleton import GROUPS, KINDS, SADDLE, SUMMIT, grow
from utak.geometry.skeleton.sweep import new_state, survey


def topology(graph):
    components = nx.number_connected_components(graph)
    return components, graph.number_of_edges() - graph.number_of_nodes() + components


@settings(deadline=None)
@given(oracles.screens())
def test_clearance_is_exact(free):
    assert np.allclose(Screen(free).clearance, oracles.clearance(free), rtol=0, atol=1e-12)


def test_clearance_is_exact_near_walls_and_far_from_them():
    free = np.ones((135, 290), bool)
    free[40:43, 200:203] = free[90, 30:120:7] = free[:, 150] = False
    free[60:75, 150] = True
    assert np.allclose(Screen(free).clearance, oracles.clearance(free), rtol=0, atol=1e-12)


@pytest.mark.long
@settings(max_examples=60, deadline=None)
@given(st.integers(178, 186), st.tuples(*[st.integers(0, 40)] * 4), st.booleans(), st.integers(0, 2**32 - 1))
def test_16_bits_are_used_only_where_they_hold_all_clearances(across, margins, round_floor, seed):
    west, east, south, north = margins
    y, x = np.mgrid[: across + south + north, : across + west + east] + 0.5
    u, v = x - west - across / 2, y - south - across / 2
    free = (np.hypot(u, v) if round_floor else np.maximum(abs(u), abs(v))) < across / 2
    free |= np.random.default_rng(seed).random(free.shape) < 0.02
    most = oracles.to_blocked(free).max()
    if distance_transform.smallest_distance_type(free) == np.int16:
        screen = Screen(free)
        assert screen._square.dtype == np.int16 and 0 <= screen._square.max() < 2**15 - 1
        assert most - 1 < screen.clearance.max() < most
    else:
        assert most > 56  # wide floor


@pytest.mark.long
@settings(max_examples=200, deadline=None)
@given(oracles.screens(most=16))
def test_both_types_of_squared_clearances_give_the_same_graph(free):
    screen = Screen(free)
    square = np.empty(screen._square.shape, np.int32)
    assert measure(free, square) and (square[1:-1] == screen._square[1:-1]).all()
    square[[0, -1]] = 0
    state, words = new_state(square.shape)
    state[[0, -1]] = 0
    flags, waiting = np.empty(square.shape[1], np.uint8), np.empty(square.shape[1], np.int32)
    grow(square.reshape(-1), state.reshape(-1), words, square.shape[1], 1, len(square) - 2, flags, waiting, 0)
    bones = contract(square, state, words)  # flags rings in the state
    assert np.array_equal(state, screen._bones[0])
    assert all(np.array_equal(a, b) for a, b in zip(bones, screen._bones[2], strict=True))


@settings(max_examples=200, deadline=None)
@given(oracles.screens(most=16))
def test_pathgraph_has_the_components_and_holes_of_free_space(free):
    assert topology(Screen(free).pathgraph) == oracles.components_and_holes(free)


@settings(max_examples=200, deadline=None)
@given(oracles.screens(most=16))
def test_skeleton_is_thin_and_connected_as_free_space_is(free):
    skeleton = Screen(free).skeleton
    assert not (skeleton & ~free).any()
    assert oracles.components_and_holes(skeleton) == oracles.components_and_holes(free)
    block = skeleton[1:, 1:] & skeleton[:-1, 1:] & skeleton[1:, :-1] & skeleton[:-1, :-1]
    for i, j in np.argwhere(block):  # only where four chains meet and each of the four cells is needed
        for cell in ((i, j), (i + 1, j), (i, j + 1), (i + 1, j + 1)):
            without = skeleton.copy()
            without[cell] = False
            assert oracles.components_and_holes(without) != oracles.components_and_holes(free)


@settings(deadline=None)
@given(oracles.screens(most=16), st.sampled_from([1, 20, 40]))
def test_results_do_not_depend_on_the_size_of_bands(free, band):
    whole = Screen(free)
    square, (state, words) = np.empty_like(whole._square), new_state(whole._square.shape)
    survey(free, square, state, words, band_cells=band)
    assert np.array_equal(square, whole._square)
    for mine, other in zip((state, words, contract(square, state, words)), whole._bones, strict=True):
        assert all(np.array_equal(a, b) for a, b in zip(mine, other, strict=True))


def test_saddles_are_where_several_groups_of_higher_neighbours_touch_by_edges():
    for higher, (kind, groups) in enumerate(zip(KINDS[:255].tolist(), GROUPS[:255].tolist(), strict=True)):
        ring = [k for k in range(8) if higher >> k & 1]
        parts = nx.Graph()
        parts.add_nodes_from(ring)
        parts.add_edges_from((k, (k + 1) % 8) for k in ring if (k + 1) % 8 in ring)
        edges = [sum(1 << k // 2 for k in part if k % 2 == 0) for part in nx.connected_components(parts)]
        edges = sorted(part for part in edges if part)
        assert kind == (SUMMIT if not edges else SADDLE if len(edges) > 1 else 0)
        assert sorted(groups >> n & 15 for n in (0, 4, 8, 12) if groups >> n & 15) == edges


@settings(deadline=None)
@given(oracles.screens())
def test_chains_are_unbroken_and_their_clearance_is_the_least_on_them(free):
    screen = Screen(free)
    graph = screen.pathgraph
    for a, b, edge in graph.edges(data=True):
        points = edge["points"]
        assert (np.abs(np.diff(points, axis=0)).sum(axis=1) == 1).all()
        ends = {tuple(points[0]), tuple(points[-1])}
        assert ends == {(graph.nodes[n]["x"], graph.nodes[n]["y"]) for n in (a, b)}
        along = [screen.clearance[int(y), int(x)] for x, y in points]
        assert edge["clearance"] == min(along)


@pytest.mark.parametrize(
    ("picture", "nodes", "edges"),
    [
        ((".",), 1, 0),
        (("....",), 1, 0),
        (("...", ".#.", "..."), 1, 1),
        ((".#", "#."), 2, 0),
        (("..#..", ".....", "..#.."), 2, 1),
    ],
)
def test_small_screens(picture, nodes, edges):
    graph = Screen(np.array([[c == "." for c in row] for row in picture])).pathgraph
    assert (graph.number_of_nodes(), graph.number_of_edges()) == (nodes, edges)


def test_a_corridor_of_one_square_has_half_a_square_of_clearance():
    assert Screen(np.ones((1, 5), bool)).clearance.tolist() == [[0.5] * 5]


@pytest.mark.parametrize(
    ("free", "message"),
    [
        (np.ones(3, bool), "two dimensions"),
        (np.ones((2, 2)), "array of bool"),
        (np.full((2, 2), np.nan), "array of bool"),
        (np.zeros((2, 2), bool), "no free square"),
        (np.zeros((0, 2), bool), "no free square"),
    ],
)
def test_bad_screens_are_rejected_with_a_reason(free, message):
    with pytest.raises(ValueError, match=message):
        Screen(free)


@pytest.mark.parametrize("kind", lookalikes.KINDS)
def test_pathgraphs_of_lookalikes_of_the_benchmarks_are_right(kind):
    screen = Screen(lookalikes.lookalike(kind, 40, 3, 6))
    assert topology(screen.pathgraph) == oracles.components_and_holes(screen.free)
