"""The table of the nodes that a search has come to, against a dictionary."""

from hypothesis import given, settings
from hypothesis import strategies as st

from utak.geometry.state_lattice.astar import _come_to, _new_table, _slot_of, _with_room

NODES = st.integers(0, 40) | st.integers(0, 2**27)


@settings(max_examples=60, deadline=None)
@given(st.lists(st.tuples(NODES, st.integers(0, 9)), max_size=200))
def test_a_table_keeps_the_least_cost_of_each_node_while_it_grows(steps: list[tuple[int, int]]) -> None:
    opened, known = _new_table(2), dict[int, tuple[int, int]]()
    for number, (node, cost) in enumerate(steps):
        opened = _with_room(opened, 1)
        better = node not in known or cost < known[node][0]
        assert _come_to(opened, node, cost, number) == better
        if better:
            known[node] = cost, number
    assert opened.number[0] == len(known)
    assert len(opened.node) >= 2 * len(known)
    for node, (cost, number) in known.items():
        slot = _slot_of(opened, node)
        assert (opened.node[slot], opened.cost[slot], opened.parent[slot]) == (node, cost, number)
