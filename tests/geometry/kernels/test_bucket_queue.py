"""The bucket queue, and the path costs found with it, which equal those of Dijkstra's algorithm with a heap."""

import networkx as nx
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from utak.geometry.kernels.bucket_queue import BUCKETS, new_queue, put, take
from utak.geometry.motion.obstacle_field import (
    PIXEL_DIAGONAL_COST,
    PIXEL_STEP_COST,
    TIGHT_PIXEL_FACTOR,
    disc_path_costs,
)


@settings(max_examples=30, deadline=None, derandomize=True)
@given(st.lists(st.integers(0, BUCKETS - 1), max_size=40))
def test_nodes_are_taken_in_order_of_cost(costs: list[int]) -> None:
    queue = new_queue(64)
    for node, cost in enumerate(costs):
        put(queue, cost, node)
    taken = []
    for now in range(BUCKETS):
        while (node := take(queue, now)) >= 0:
            taken.append(costs[node])
    assert taken == sorted(costs) and queue.used[1] == 0


def test_a_node_is_lost_when_no_memory_is_left() -> None:
    queue = new_queue(1)
    put(queue, 3, 7)
    put(queue, 3, 8)
    assert (take(queue, 3), take(queue, 3)) == (7, -1)


@settings(max_examples=15, deadline=None, derandomize=True)
@given(arrays(np.bool_, (7, 9)), st.integers(0, 62))
def test_path_costs_of_a_disc_equal_those_of_networkx(tight: np.ndarray, goal: int) -> None:
    goals = np.zeros((7, 9), bool)
    goals.flat[goal] = True
    graph = nx.DiGraph()
    for y, x in np.ndindex(7, 9):
        for v, u in np.ndindex(7, 9):
            if max(abs(x - u), abs(y - v)) == 1:
                side = PIXEL_DIAGONAL_COST if x != u and y != v else PIXEL_STEP_COST
                graph.add_edge((y, x), (v, u), weight=side * (TIGHT_PIXEL_FACTOR if tight[v, u] else 1))
    expected = nx.single_source_dijkstra_path_length(graph, divmod(goal, 9))
    found = disc_path_costs(tight, goals)
    assert all(found[place] == expected[place] for place in np.ndindex(7, 9))


def test_without_a_goal_every_cost_is_the_greatest() -> None:
    assert disc_path_costs(np.zeros((3, 3), bool), np.zeros((3, 3), bool)).min() == pytest.approx(2**40)
