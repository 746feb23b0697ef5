"""Passages that a route must not lead through: the floor cut along their necks, as partition.py cuts it.

# Strategy: a route keeps clear of the passages exactly when it can be deformed into a way from square to square that
takes no step that is cut. So the pathgraph is barred at those of its steps, and a start or goal whose steepest way up
would take one goes to the nearest skeleton within its own part instead. Where the pathgraph is cut although the part is
in one piece, which happens where a neck runs over another chain, a way over the part's squares is taken.
"""

from collections import deque
from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from geometry.homotopy.landmarks import locate
from geometry.kernels.arrays import Bools, Ints, Labels
from geometry.passages.necks import Passage
from geometry.passages.partition import cut_floor
from geometry.routes.layer import Layer
from geometry.routes.lifting import direction_of
from geometry.skeleton.graph import find, is_node
from geometry.skeleton.skeleton import steepest, stride


class Barrier(NamedTuple):
    """The floor of a layer, cut."""

    label: Labels
    """(rows + 2, columns + 2) the part of each cell."""
    shut: Bools
    """(2, rows + 2, columns + 2) the steps to the east and to the north that are cut."""
    bars: Ints
    """(b, 2) chain and position of the pathgraph's steps that are cut (see astar.py)."""

    def parted(self, one: int, other: int) -> bool:
        """Return whether two cells lie in different parts, or one of them on a cut."""
        label = self.label.reshape(-1)
        return bool(one != other and (label[one] != label[other] or not label[one]))

    def is_shut(self, cell: int, other: int) -> bool:
        """Return whether the step between edge neighbours is cut."""
        low = min(cell, other)
        return bool(self.shut[int(abs(cell - other) > 1)].reshape(-1)[low])


def raise_barrier(layer: Layer, level: int, passages: Iterable[Passage]) -> Barrier:
    """Cut the floor of a layer along the necks of passages."""
    label, shut = cut_floor(layer.square >= level, passages)
    width, states = layer.square.shape[1], layer.state.reshape(-1)
    bars = []
    for direction, row, column in np.argwhere(shut).tolist():
        cell = row * width + column
        if states[cell] >> direction & 1:
            bars.append(bar_at(layer, cell, cell + stride(direction, width)))
    return Barrier(label, shut, np.array(bars, np.int32).reshape(-1, 2))


def bar_at(layer: Layer, cell: int, other: int) -> tuple[int, int]:
    """Return the chain of a step of the skeleton, and the lower of the two positions on it."""
    states, width, chains = layer.state.reshape(-1), layer.square.shape[1], layer.chains
    if is_node(states[cell]) and is_node(states[other]):
        return int(chains.leave[find(chains.node, cell), direction_of(other - cell)]), 0
    inner = other if is_node(states[cell]) else cell
    anchor = locate(inner, states, width, chains.node, chains.leave, chains.start, chains.cells)
    first = int(chains.start[anchor.chain])
    onward = chains.cells[first + anchor.position + 1] == cell + other - inner
    return anchor.chain, anchor.position - (0 if onward else 1)


def way_to_skeleton(layer: Layer, level: int, barrier: Barrier, cell: int) -> list[int] | None:
    """Return the cells from a cell to the skeleton of its part: the steepest way up if nothing of it is cut."""
    heights, states, width = layer.square.reshape(-1), layer.state.reshape(-1), layer.square.shape[1]
    cells = [cell]
    while not states[cells[-1]]:
        higher = steepest(cells[-1], heights, width)
        if barrier.is_shut(cells[-1], higher):
            return way_over_cells(layer, level, barrier, cell, states > 0)
        cells.append(higher)
    return cells


def way_over_cells(layer: Layer, level: int, barrier: Barrier, cell: int, goal: Bools) -> list[int] | None:
    """Return the fewest cells from a cell to one of some, over steps that are not cut; None when there is no way."""
    heights, width = layer.square.reshape(-1), layer.square.shape[1]
    came, queue = {cell: cell}, deque([cell])
    while queue:
        here = queue.popleft()
        if goal[here]:
            way = [here]
            while way[-1] != cell:
                way.append(came[way[-1]])
            return way[::-1]
        for other in (here + 1, here + width, here - 1, here - width):
            if other not in came and heights[other] >= level and not barrier.is_shut(here, other):
                came[other] = here
                queue.append(other)
    return None
