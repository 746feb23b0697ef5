"""Channels: chains of neighbouring cells from a start to a goal that may hold a motion. Plain loops for numba.

A channel runs over cells that are not known to be blocked. Cells that are not known to be free cost more, and the more
the smaller they are: what is still undecided at that size is a tight fit or none at all, and another way round is
looked at before it is split further. Best-first search (weighted A*) finds the channel that looks cheapest. Its
estimate of the cost to go is the path that a disc would have to take.

# Strategy: between two searches only cells of one channel change. So the search tree is kept: what hung on a changed
cell is cut off, and attached again to those of its neighbours that still stand. A search then costs what changed, not
what was ever seen (as in incremental A*).
"""

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from utak.geometry.cspace.cell_tree import MAX_CELL_DEPTH, CellTree, is_splittable, next_link_to_leaf
from utak.geometry.cspace.search_tree import SearchTree, add_cell, cut_off, new_search_tree, set_parent, sort_cells
from utak.geometry.kernels.arrays import Floats, Ints
from utak.geometry.kernels.heap import pop, push
from utak.geometry.kernels.jit import bare
from utak.geometry.motion.cell_clearance import (
    CELL_BLOCKED,
    CELL_CENTRE_FREE,
    CELL_FREE,
    CELL_GIVEN_UP,
    CELL_UNDECIDED,
    MovingBody,
    NearbyEdges,
    classify_cell,
)

# All weights and prices below are tuned on random worlds (benchmarks.campaign).
COST_TO_GO_WEIGHT = 2.0  # weight of the estimated cost to go against the cost so far (weighted A*)
PRICE_BY_KIND = np.array([1.0, 2.0, 5.0, 1e9, 50.0])  # cost of one square of path by kind of cell, for large cells
PRICE_GROWTH = 1.15  # the price of a cell that is not free grows by this factor with each depth ...
CONSTANT_PRICE_DEPTH = 8  # ... below this depth ...
MAX_DEPTH_FACTOR = 5.0  # ... to this many times at most
DEPTH_FACTOR = np.minimum(
    PRICE_GROWTH ** np.maximum(np.arange(MAX_CELL_DEPTH + 2) - CONSTANT_PRICE_DEPTH, 0), MAX_DEPTH_FACTOR
)
CELL_PRICE = np.outer(PRICE_BY_KIND, DEPTH_FACTOR)  # cost of one square of path by kind and depth of cell
CELL_PRICE[CELL_FREE] = PRICE_BY_KIND[CELL_FREE]
REGION_GOAL = -2  # stands in place of a goal cell when the goal is a region
NODE_NEW, NODE_QUEUED, NODE_SETTLED, NODE_POSTPONED = 0, 1, 2, 3  # states of cells in the search; order is compared


class ChannelSearch(NamedTuple):
    """A search among the cells of a tree, kept from one channel to the next."""

    cost_to_go: Floats  # (capacity,) estimated cost from a cell to the goal, times COST_TO_GO_WEIGHT
    cost: Floats  # (capacity,) cost of the cheapest path found to a cell
    paths: SearchTree  # the tree of these paths
    # (capacity,) NODE_NEW, NODE_QUEUED (on the heap), NODE_SETTLED, or NODE_POSTPONED (a settled cell that may hold a
    # goal and is on the heap again)
    state: npt.NDArray[np.int8]
    # (2,) number of cells that have a state; 1 if the last channel ends at a postponed cell, else 0
    seen: npt.NDArray[np.int64]
    key: Floats  # the heap, see kernels.heap: keys, cells, and (number on it, number dropped when it was full)
    item: Ints
    size: npt.NDArray[np.int64]
    # (capacity,) the cells of the last channel, the start's first; how many is what find_channel returned
    channel: Ints
    unattached: Ints  # scratch of the repair
    # (rows, columns) estimated length to the goal from a pixel of the field's raster, squares, row 0 in the south
    distances: Floats
    disc_centre: Floats  # (2,) the point of the body, body frame, that these lengths are for


def new_channel_search(capacity: int, distances: Floats, disc_centre: Floats) -> ChannelSearch:
    """Return a search with memory for a tree of `capacity` cells, nothing seen yet."""
    channel, unattached = (np.empty(capacity, np.int32) for _ in range(2))
    item = np.empty(8 * capacity, np.int32)
    numbers = np.zeros(2, np.int64), np.empty(8 * capacity), item, np.zeros(2, np.int64)
    state = np.empty(capacity, np.int8)
    return ChannelSearch(
        np.empty(capacity),
        np.empty(capacity),
        new_search_tree(capacity),
        state,
        *numbers,
        channel,
        unattached,
        distances,
        disc_centre,
    )


@bare
def find_channel(
    tree: CellTree,
    body: MovingBody,
    nearby: NearbyEdges,
    region: NearbyEdges,
    search: ChannelSearch,
    start: int,
    goal: int,
    through_given_up: bool,
) -> int:
    """Go on searching for a channel from cell `start` to the goal; return its number of cells, 0 if there is none."""
    _repair_search(tree, body.radius, nearby, search)
    if tree.kind[start] == CELL_GIVEN_UP and not through_given_up:
        return 0
    if search.state[start] == NODE_NEW:
        search.cost[start], search.state[start] = 0.0, NODE_QUEUED
        _enqueue(search, 0.0, start)
    while search.size[0] > 0:
        key = search.key[0]
        cell, search.size[0] = pop(search.key, search.item, search.size[0])
        if tree.child[cell] >= 0 or search.state[cell] == NODE_SETTLED or search.state[cell] == NODE_NEW:
            continue
        postponed = search.state[cell] == NODE_POSTPONED
        goal_kind = CELL_UNDECIDED if postponed else (CELL_CENTRE_FREE if cell == goal else CELL_BLOCKED)
        if goal == REGION_GOAL and not postponed:
            goal_kind = _kind_in_goal(tree, body, region, cell)
        if goal_kind <= CELL_CENTRE_FREE or postponed:
            search.state[cell] = NODE_SETTLED
            search.seen[1] = int(postponed)
            _relax_neighbours(tree, search, body.radius, cell, through_given_up)
            return _write_channel(search.paths.parent, search.channel, cell)
        search.state[cell] = NODE_SETTLED
        _relax_neighbours(tree, search, body.radius, cell, through_given_up)
        if goal_kind == CELL_UNDECIDED and (through_given_up or is_splittable(tree, cell, body)):
            search.state[cell] = NODE_POSTPONED
            _enqueue(search, key + 2.0 * body.radius, cell)
    return 0


@bare
def _enqueue(search: ChannelSearch, key: float, cell: int) -> None:
    """Put a cell on the heap, or count it as dropped if the heap is full."""
    if search.size[0] >= len(search.key):
        search.size[1] += 1
    else:
        search.size[0] = push(search.key, search.item, search.size[0], key, cell)


@bare
def _kind_in_goal(tree: CellTree, body: MovingBody, region: NearbyEdges, cell: int) -> int:
    """Return the kind of a cell with respect to the goal region, whose complement is `region`."""
    depth = tree.box[cell, 3]
    spread = tree.sizes[depth, 0] * tree.frame[2] / math.sqrt(2.0)
    half = tree.sizes[depth, 1] * tree.frame[3] / 2
    return classify_cell(body, region, tree.middle[cell, 0], tree.middle[cell, 1], tree.middle[cell, 2], spread, half)


@bare
def _repair_search(tree: CellTree, radius: float, nearby: NearbyEdges, search: ChannelSearch) -> None:
    """Cut off what hung on cells that were split or given up."""
    unattached = 0
    for k in range(tree.changes[0]):
        root = tree.changed[k]
        if root < search.seen[0] and search.state[root] != NODE_NEW:
            first, unattached = unattached, cut_off(search.paths, root, search.unattached, unattached)
            for n in range(first, unattached):
                search.state[search.unattached[n]] = NODE_NEW
    tree.changes[0] = 0
    sort_cells(search.unattached, unattached)
    for cell in range(search.seen[0], tree.used[0]):
        add_cell(search.paths, cell)
        search.state[cell] = NODE_NEW
        search.cost_to_go[cell] = _cost_to_go(tree.middle, search.distances, search.disc_centre, nearby.frame, cell)
        search.unattached[unattached] = cell
        unattached += 1
    search.seen[0] = tree.used[0]
    for k in range(unattached):
        cell = search.unattached[k]
        if tree.child[cell] < 0 and tree.kind[cell] <= CELL_UNDECIDED:
            _attach(tree, search, radius, cell)


@bare
def _attach(tree: CellTree, search: ChannelSearch, radius: float, cell: int) -> None:
    """Put a cell on the heap with the cheapest path to it through its settled neighbours, if there is one."""
    # Blocked and split cells must not be given.
    child, head, links, middle, kind = tree.child, tree.head, tree.link, tree.middle, tree.kind
    best, by = 1e18, -1
    link = next_link_to_leaf(child, head, links, cell, -1)
    while link >= 0:
        other = links[link, 0]
        if search.state[other] >= NODE_SETTLED:
            cost = search.cost[other] + _step_cost(middle, kind, tree.box, radius, other, cell)
            if cost < best:
                best, by = cost, other
        link = next_link_to_leaf(child, head, links, cell, link)
    if by >= 0:
        search.cost[cell], search.state[cell] = best, NODE_QUEUED
        set_parent(search.paths, cell, by)
        _enqueue(search, best + search.cost_to_go[cell], cell)


@bare
def _relax_neighbours(tree: CellTree, search: ChannelSearch, radius: float, cell: int, through_given_up: bool) -> None:
    """Put the neighbours of a settled cell on the heap where the path through it is cheaper."""
    child, head, links, middle, kind = tree.child, tree.head, tree.link, tree.middle, tree.kind
    link = next_link_to_leaf(child, head, links, cell, -1)
    while link >= 0:
        other = links[link, 0]
        if search.state[other] < NODE_SETTLED and (kind[other] != CELL_GIVEN_UP or through_given_up):
            cost = search.cost[cell] + _step_cost(middle, kind, tree.box, radius, cell, other)
            if search.state[other] == NODE_NEW or cost < search.cost[other]:
                search.cost[other], search.state[other] = cost, NODE_QUEUED
                set_parent(search.paths, other, cell)
                _enqueue(search, cost + search.cost_to_go[other], other)
        link = next_link_to_leaf(child, head, links, cell, link)


@bare
def _step_cost(middle: Floats, kind: npt.NDArray[np.int8], box: Ints, radius: float, a: int, b: int) -> float:
    """Return the cost of going from the middle of cell a to the middle of cell b."""
    dx, dy = middle[b, 0] - middle[a, 0], middle[b, 1] - middle[a, 1]
    turn = abs(middle[b, 2] - middle[a, 2])
    turn = min(turn, 2 * math.pi - turn)
    price = CELL_PRICE[kind[a], box[a, 3]] + CELL_PRICE[kind[b], box[b, 3]]
    return float((math.sqrt(dx * dx + dy * dy) + 0.5 * radius * turn) * 0.5 * price)


@bare
def _cost_to_go(middle: Floats, distances: Floats, disc_centre: Floats, frame: Floats, cell: int) -> float:
    """Return the estimated cost from the middle of a cell to the goal, times COST_TO_GO_WEIGHT."""
    c, s = math.cos(middle[cell, 2]), math.sin(middle[cell, 2])
    x = middle[cell, 0] + c * disc_centre[0] - s * disc_centre[1]
    y = middle[cell, 1] + s * disc_centre[0] + c * disc_centre[1]
    column = min(max(int((x - frame[0]) / frame[2]), 0), distances.shape[1] - 1)
    row = min(max(int((y - frame[1]) / frame[2]), 0), distances.shape[0] - 1)
    return float(COST_TO_GO_WEIGHT * distances[row, column])


@bare
def _write_channel(parent: Ints, channel: Ints, cell: int) -> int:
    """Write the channel that ends at a cell to `channel`, from its start on; return its number of cells."""
    length = 0
    at = cell
    while at >= 0:
        length += 1
        at = parent[at]
    n = length
    while cell >= 0:
        n -= 1
        channel[n] = cell
        cell = parent[cell]
    return length
