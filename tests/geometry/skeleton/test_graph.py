"""The contracted skeleton compared with walks one cell at a time, and words of states with single cells."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.geometry import lookalikes, oracles
from utak.geometry import Screen
from utak.geometry.skeleton import bit_parallel, lowest_cells
from utak.geometry.skeleton.graph import WORDS_AHEAD, contract, is_node
from utak.geometry.skeleton.skeleton import HALT
from utak.geometry.skeleton.sweep import new_state, survey


def plain_walks(screen):
    """Return the nodes, and (first end, last end, lowest cell, steps) of all chains, from the links of single cells."""
    state, heights = screen._bones[0], screen._square.ravel()
    width = state.shape[1]
    ways = {c: [d for d in range(4) if here >> d & 1] for c, here in enumerate(state.ravel().tolist()) if here}
    nodes = [c for c in ways if len(ways[c]) != 2 or state.ravel()[c] & HALT]
    numbers = {cell: n for n, cell in enumerate(nodes)}
    chains = []
    for cell in nodes:
        for direction in ways[cell]:
            cells, back = plain_walk(cell, direction, ways, numbers, width)
            first, last = 4 * numbers[cell] + direction, 4 * numbers[cells[-1]] + back
            if first < last:
                lowest = min(cells, key=lambda c: (heights[c], c))
                chains.append((first, last, lowest, len(cells) - 1))
    return nodes, chains


def plain_walk(cell, direction, ways, numbers, width):
    """Return the cells of a chain, and the direction back from the last."""
    cells = [cell]
    while True:
        cells.append(cells[-1] + (1, width, -1, -width)[direction])
        if cells[-1] in numbers:
            return cells, direction ^ 2
        (direction,) = (d for d in ways[cells[-1]] if d != direction ^ 2)


def assert_same(screen, bones=None):
    bones = screen._bones[2] if bones is None else bones
    nodes, chains = plain_walks(screen)
    assert bones.node.tolist() == nodes
    assert [*zip(*bones.port.T.tolist(), bones.neck.tolist(), bones.steps.tolist(), strict=True)] == chains


@settings(max_examples=200, deadline=None)
@given(oracles.screens(most=24), st.sampled_from([16, 20, lowest_cells.MAX_NOTES]))
def test_nodes_and_chains_are_those_of_plain_walks_for_any_room_for_notes(free, room):
    screen = Screen(free)
    square, (state, words) = np.empty_like(screen._square), new_state(screen._square.shape)
    survey(free, square, state, words)
    assert_same(screen, contract(square, state, words, min_notes=room))


@pytest.mark.long
@pytest.mark.parametrize("kind", lookalikes.KINDS)
def test_chains_that_lead_beyond_the_listed_nodes_are_right(kind):
    free = lookalikes.lookalike(kind, 600, 1, 30)
    assert free.size > 16 * WORDS_AHEAD
    assert_same(Screen(free))


def test_rings_without_junctions_next_to_chains():
    free = np.ones((12, 30), bool)
    free[4:8, 4:8] = free[:, 12:14] = free[3:5, 20:24] = free[8, 20:24] = False
    assert_same(Screen(free))
    assert_same(Screen(free[:, :12]))


@given(st.lists(st.integers(0, 255), min_size=1, max_size=700), st.integers(1, 4))
def test_words_of_states_agree_with_their_cells(cells, thin):
    states = np.zeros(-(-len(cells) // 8) * 8, np.uint8)
    states[: len(cells) : thin] = cells[::thin]
    words = states.view(np.int64)
    base, since = np.empty(-(-len(words) // 16), np.int32), np.empty(len(words), np.uint8)
    node = [c for c in range(len(states)) if is_node(int(states[c]))]
    links = [int(here & 15).bit_count() for here in states]
    assert bit_parallel.count_nodes(words, base, since) == (len(node), sum(links[c] for c in node), sum(links) // 2)
    listed = np.empty(len(node) + 1, np.int32)
    middle = len(words) // 2
    found = bit_parallel.list_nodes(
        words, middle, len(words) + 3, listed, bit_parallel.list_nodes(words, 0, middle, listed, 0)
    )
    assert listed[:found].tolist() == node
    assert [bit_parallel.node_number(c, words, base, since) for c in node] == list(range(len(node)))
