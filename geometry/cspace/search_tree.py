"""The tree of paths of a search: each cell with its parent and its children, so that a part is cut off quickly.

Cutting off the cells whose paths run through some cell takes time in proportion to their number, not to that of all
cells. The children of a cell are a linked list in arrays. Plain loops for numba.
"""

from typing import NamedTuple

import numpy as np

from utak.geometry.kernels.arrays import Ints
from utak.geometry.kernels.jit import bare


class SearchTree(NamedTuple):
    """Parents and children of cells; all arrays are (capacity,) int32 by number of cell, and -1 stands for no cell."""

    parent: Ints  # the cell before a cell on the path to it
    first_child: Ints  # one of the cells that have a cell as their parent
    next_sibling: Ints  # the next and the previous cell with the same parent; undefined without a parent
    previous_sibling: Ints


def new_search_tree(capacity: int) -> SearchTree:
    """Return memory for a tree of up to `capacity` cells. Each cell must be added before it is used."""
    return SearchTree(*(np.empty(capacity, np.int32) for _ in range(4)))


@bare
def add_cell(paths: SearchTree, cell: int) -> None:
    """Make a cell known in `paths`, which is changed, with neither parent nor children."""
    paths.parent[cell] = paths.first_child[cell] = -1


@bare
def set_parent(paths: SearchTree, cell: int, parent: int) -> None:
    """Let the path to a cell run through another parent, as its first child; the cell keeps its children."""
    detach(paths, cell)
    first = paths.first_child[parent]
    paths.parent[cell], paths.next_sibling[cell], paths.previous_sibling[cell] = parent, first, -1
    if first >= 0:
        paths.previous_sibling[first] = cell
    paths.first_child[parent] = cell


@bare
def detach(paths: SearchTree, cell: int) -> None:
    """Take a cell, with all that hangs on it, off its parent, if it has one. `paths` is changed."""
    parent = paths.parent[cell]
    if parent < 0:
        return
    before, after = paths.previous_sibling[cell], paths.next_sibling[cell]
    if before >= 0:
        paths.next_sibling[before] = after
    else:
        paths.first_child[parent] = after
    if after >= 0:
        paths.previous_sibling[after] = before
    paths.parent[cell] = -1


@bare
def cut_off(paths: SearchTree, root: int, cells: Ints, count: int) -> int:
    """Take a cell and all cells that hang on it out of the tree; return the new number of cells in `cells`."""
    detach(paths, root)
    cells[count] = root
    done, count = count, count + 1
    while done < count:
        child = paths.first_child[cells[done]]
        paths.first_child[cells[done]] = -1
        while child >= 0:
            cells[count] = child
            count += 1
            paths.parent[child] = -1
            child = paths.next_sibling[child]
        done += 1
    return count


@bare
def sort_cells(cells: Ints, count: int) -> None:
    """Sort the first `count` of `cells`, numbers of cells, in place, ascending (heapsort, Williams 1964)."""
    for last in range(count // 2 - 1, -1, -1):
        _sift_down(cells, last, count)
    for size in range(count - 1, 0, -1):
        cells[0], cells[size] = cells[size], cells[0]
        _sift_down(cells, 0, size)


@bare
def _sift_down(cells: Ints, at: int, size: int) -> None:
    """Move the cell at index `at` of `cells` down the max-heap in its first `size` entries to its place; in place."""
    while True:
        child = 2 * at + 1
        if child >= size:
            return
        if child + 1 < size and cells[child + 1] > cells[child]:
            child += 1
        if cells[at] >= cells[child]:
            return
        cells[at], cells[child] = cells[child], cells[at]
        at = child
