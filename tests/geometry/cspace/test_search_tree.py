"""Search trees: what is cut off is just the cell and all that hangs on it, whatever was done before."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from utak.geometry.cspace.search_tree import add_cell, cut_off, new_search_tree, set_parent, sort_cells

CAPACITY = 12
steps = st.lists(st.tuples(st.booleans(), st.integers(0, CAPACITY - 1), st.integers(0, CAPACITY - 1)), max_size=40)


def hangs_on(parents: dict[int, int], cell: int, root: int) -> bool:
    """Return whether the path to a cell runs through the root, by following the parents."""
    while cell >= 0 and cell != root:
        cell = parents[cell]
    return cell == root


@given(steps)
def test_a_cut_takes_the_cell_and_all_that_hangs_on_it(todo: list[tuple[bool, int, int]]) -> None:
    paths, parents = new_search_tree(CAPACITY), dict.fromkeys(range(CAPACITY), -1)
    for cell in range(CAPACITY):
        add_cell(paths, cell)
    for cuts, cell, parent in todo:
        if cuts:
            cells = np.full(CAPACITY + 1, -7, np.int32)
            count = cut_off(paths, cell, cells, 1)
            below = {other for other in parents if hangs_on(parents, other, cell)}
            assert cells[0] == -7
            assert cells[1] == cell
            assert sorted(cells[1:count].tolist()) == sorted(below)
            parents |= dict.fromkeys(below, -1)
        elif not hangs_on(parents, parent, cell):  # a path has no circle
            set_parent(paths, cell, parent)
            parents[cell] = parent
        assert paths.parent.tolist() == [parents[other] for other in range(CAPACITY)]


@given(st.lists(st.integers(0, 1000), max_size=60))
def test_cells_are_sorted_and_the_rest_stays(cells: list[int]) -> None:
    found = np.array([*cells, 5, 3], np.int32)
    sort_cells(found, len(cells))
    assert found.tolist() == [*sorted(cells), 5, 3]
