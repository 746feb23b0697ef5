"""Barriers: passages that a route must not lead through; the floor is cut along their necks, as partition.py cuts it.

# Strategy: a route keeps clear of the passages exactly when it can be deformed into a path from square to square that
takes no step that is cut. So the pathgraph is closed at those of its steps. A start or goal whose steepest ascent would
take such a step goes to the nearest skeleton within its own part instead. Where the pathgraph is cut although the part
is in one piece, which happens where a neck runs over another chain, a path over the part's squares is taken.
"""

from collections import deque
from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from utak.geometry.homotopy.landmarks import locate
from utak.geometry.kernels.arrays import Bools, Ints, Labels
from utak.geometry.passages.necks import Passage
from utak.geometry.passages.partition import cut_floor
from utak.geometry.routes.layer import Layer
from utak.geometry.routes.lifting import direction_of
from utak.geometry.skeleton.graph import find, is_node
from utak.geometry.skeleton.skeleton import steepest, stride


class Barrier(NamedTuple):
    """The floor of a layer, cut along the necks of passages."""

    # (rows + 2, columns + 2) int32, the number of the part of each cell, from 1; 0 on a cut and off the floor
    label: Labels
    # (2, rows + 2, columns + 2) bool, whether the step from each cell to the east (0) or to the north (1) is cut
    closed: Bools
    # (b, 2) int32, chain and position of the pathgraph's steps that are cut: each from the cell at that position on the
    # chain, counted from 0, to the next one
    closed_steps: Ints

    def separates(self, one: int, other: int) -> bool:
        """Return whether two cells (indices in the flat padded grid) lie in different parts, or one on a cut."""
        label = self.label.reshape(-1)
        return bool(one != other and (label[one] != label[other] or not label[one]))

    def is_closed(self, cell: int, other: int) -> bool:
        """Return whether the step between two edge neighbours is cut, in either direction."""
        low = min(cell, other)
        return bool(self.closed[int(abs(cell - other) > 1)].reshape(-1)[low])


def build_barrier(layer: Layer, level: int, passages: Iterable[Passage]) -> Barrier:
    """Return the floor of a layer, cut along the necks of passages."""
    label, closed = cut_floor(layer.square >= level, passages)
    width, states = layer.square.shape[1], layer.state.reshape(-1)
    closed_steps = []
    for direction, row, column in np.argwhere(closed).tolist():
        cell = row * width + column
        if states[cell] >> direction & 1:
            closed_steps.append(chain_step_of(layer, cell, cell + stride(direction, width)))
    return Barrier(label, closed, np.array(closed_steps, np.int32).reshape(-1, 2))


def chain_step_of(layer: Layer, cell: int, other: int) -> tuple[int, int]:
    """Return the chain of a step of the skeleton between two cells, and the lower of the two positions on it."""
    states, width, chains = layer.state.reshape(-1), layer.square.shape[1], layer.chains
    if is_node(states[cell]) and is_node(states[other]):
        return int(chains.leave[find(chains.node, cell), direction_of(other - cell)]), 0
    inner = other if is_node(states[cell]) else cell
    anchor = locate(inner, states, width, chains.node, chains.leave, chains.start, chains.cells)
    first = int(chains.start[anchor.chain])
    onward = chains.cells[first + anchor.position + 1] == cell + other - inner
    return anchor.chain, anchor.position - (0 if onward else 1)


def path_to_skeleton(layer: Layer, level: int, barrier: Barrier, cell: int) -> list[int] | None:
    """Return the cells from a cell to the skeleton of its part: the steepest ascent if no step of it is cut."""
    # None when there are none.
    heights, states, width = layer.square.reshape(-1), layer.state.reshape(-1), layer.square.shape[1]
    cells = [cell]
    while not states[cells[-1]]:
        higher = steepest(cells[-1], heights, width)
        if barrier.is_closed(cells[-1], higher):
            return path_over_cells(layer, level, barrier, cell, states > 0)
        cells.append(higher)
    return cells


def path_over_cells(layer: Layer, level: int, barrier: Barrier, cell: int, goal: Bools) -> list[int] | None:
    """Return the fewest cells from a cell to a goal cell over steps that are not cut; None when there is no path."""
    heights, width = layer.square.reshape(-1), layer.square.shape[1]
    came, queue = {cell: cell}, deque([cell])
    while queue:
        here = queue.popleft()
        if goal[here]:
            path = [here]
            while path[-1] != cell:
                path.append(came[path[-1]])
            return path[::-1]
        for other in (here + 1, here + width, here - 1, here - width):
            if other not in came and heights[other] >= level and not barrier.is_closed(here, other):
                came[other] = here
                queue.append(other)
    return None
