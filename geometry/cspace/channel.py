"""Chains of cells from a pose to a goal: the optimist's plan. Plain loops for numba.

A chain runs over neighbouring cells that are not known to be full; doubtful ones are dearer, and the dearer the
smaller they are: what is still in doubt so finely is a tight fit or none at all, and another way round is looked at
before it is taken apart further. Best-first search, with the way that a disc would have to go as its guess of what is
left, makes the chain that looks cheapest.

# Strategy: between two searches only the cells of one chain change. The search tree is kept: what hung on a changed
# cell is cut off, and offered again by its neighbours that still stand. A search then costs what changed, not what was
# ever seen.
"""

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from geometry.cspace.cell_tree import DEEPEST, CellTree, next_neighbour, splittable
from geometry.kernels.arrays import Floats, Ints
from geometry.kernels.full_heap import pop, push
from geometry.kernels.jit import bare
from geometry.motion.cell_clearance import DEAD, FREE, FULL, OPEN, SHUT, MovingBody, NearbyEdges, classify

EAGER = 2.0  # how much dearer the way still to go is than the way gone
DEAR = np.array([1.0, 2.0, 5.0, 1e9, 50.0])  # the cost of a square's way by kind of cell, while it is large
WEARY, PATIENT, WORN = 1.15, 8, 5.0  # a doubtful cell is so much dearer with each depth below so many; at most
TIRING = np.minimum(WEARY ** np.maximum(np.arange(DEEPEST + 2) - PATIENT, 0), WORN)
PRICE = np.outer(DEAR, TIRING)  # of a square's way by kind and depth of cell
PRICE[FREE] = DEAR[FREE]
REGION = -2  # in place of a goal cell: the goal is a region
UNSEEN, OFFERED, SETTLED, DOUBTED = 0, 1, 2, 3


class ChannelSearch(NamedTuple):
    """A search among the cells of a tree, kept from one chain to the next.

    guess: of the way left from a cell; cost: of the way to it; before: the cell before it; state: UNSEEN, OFFERED (on
    the heap), SETTLED, or DOUBTED (a settled cell that may hold a goal, put off); verdict, loose: scratch of the
    repair. seen: (2,) cells that have a state, and 1 when the last chain ends at a doubted cell. key, item, size: the
    heap. chain: the cells of the last chain, the start's first. ways: (rows, columns) what is left to go at a pixel.
    eye: the point of the body it is told for.
    """

    guess: Floats
    cost: Floats
    before: Ints
    state: npt.NDArray[np.int8]
    verdict: Ints
    seen: npt.NDArray[np.int64]
    key: Floats
    item: Ints
    size: npt.NDArray[np.int64]
    chain: Ints
    loose: Ints
    ways: Floats
    eye: Floats


def new_hunt(capacity: int, ways: Floats, eye: Floats) -> ChannelSearch:
    """Room to search a tree of up to so many cells."""
    before, chain, loose = (np.empty(capacity, np.int32) for _ in range(3))
    verdict, item = np.zeros(capacity, np.int32), np.empty(8 * capacity, np.int32)
    numbers = np.zeros(2, np.int64), np.empty(8 * capacity), item, np.zeros(2, np.int64)
    state = np.empty(capacity, np.int8)
    return ChannelSearch(
        np.empty(capacity), np.empty(capacity), before, state, verdict, *numbers, chain, loose, ways, eye
    )


@bare
def find_chain(
    tree: CellTree,
    mover: MovingBody,
    ground: NearbyEdges,
    region: NearbyEdges,
    hunt: ChannelSearch,
    start: int,
    goal: int,
    nth: int,
    dead: bool,
) -> int:
    """Search on for a chain from a cell to the goal; its length, 0 when there is none.

    nth: the number of this search, from 1. dead: whether the chain may run through cells given up (then hunt.seen must
    have been set to 0, which forgets all searches before).
    """
    _repair(tree, mover, ground, hunt, nth)
    if tree.kind[start] == DEAD and not dead:
        return 0
    if hunt.state[start] == UNSEEN:
        hunt.cost[start], hunt.before[start], hunt.state[start] = 0.0, -1, OFFERED
        push(hunt.key, hunt.item, hunt.size, 0.0, start)
    while hunt.size[0] > 0:
        key, cell = pop(hunt.key, hunt.item, hunt.size)
        if tree.child[cell] >= 0 or hunt.state[cell] == SETTLED or hunt.state[cell] == UNSEEN:
            continue
        doubted = hunt.state[cell] == DOUBTED
        sight = SHUT if doubted else (OPEN if cell == goal else FULL)
        if goal == REGION and not doubted:
            sight = _goal_sight(tree, mover, region, cell)
        if sight <= OPEN or doubted:
            hunt.state[cell] = SETTLED
            hunt.seen[1] = int(doubted)
            _spread_out(tree, hunt, mover.radius, cell, dead)
            return _trace(hunt.before, hunt.chain, cell)
        hunt.state[cell] = SETTLED
        _spread_out(tree, hunt, mover.radius, cell, dead)
        if sight == SHUT and (dead or splittable(tree, cell, mover)):
            hunt.state[cell] = DOUBTED
            push(hunt.key, hunt.item, hunt.size, key + 2.0 * mover.radius, cell)
    return 0


@bare
def _goal_sight(tree: CellTree, mover: MovingBody, region: NearbyEdges, cell: int) -> int:
    """FREE or OPEN when a cell's middle is in the goal region, SHUT when another pose in it may be, else FULL."""
    depth = tree.box[cell, 3]
    spread = tree.sizes[depth, 0] * tree.frame[2] / math.sqrt(2.0)
    half = tree.sizes[depth, 1] * tree.frame[3] / 2
    return classify(mover, region, tree.middle[cell, 0], tree.middle[cell, 1], tree.middle[cell, 2], spread, half)


@bare
def _repair(tree: CellTree, mover: MovingBody, ground: NearbyEdges, hunt: ChannelSearch, nth: int) -> None:
    """Cut off what hung on cells that were split or given up, and offer it and the new cells again."""
    loose = 0
    for cell in range(hunt.seen[0]):
        if hunt.state[cell] != UNSEEN and _cut_off(tree.child, tree.kind, hunt.before, hunt.verdict, cell, nth):
            hunt.state[cell] = UNSEEN
            hunt.loose[loose] = cell
            loose += 1
    for cell in range(hunt.seen[0], tree.used[0]):
        hunt.state[cell] = UNSEEN
        hunt.guess[cell] = _guess(tree.middle, hunt.ways, hunt.eye, ground.frame, cell)
        hunt.loose[loose] = cell
        loose += 1
    hunt.seen[0] = tree.used[0]
    for k in range(loose):
        cell = hunt.loose[k]
        if tree.child[cell] < 0 and tree.kind[cell] <= SHUT:
            _be_offered(tree, hunt, mover.radius, cell)


@bare
def _cut_off(child: Ints, kind: npt.NDArray[np.int8], before: Ints, verdict: Ints, cell: int, nth: int) -> bool:
    """Whether the way to a cell runs through one that was split or given up. verdict: what was found out on the way."""
    at = cell
    while at >= 0 and verdict[at] // 2 != nth and child[at] < 0 and kind[at] <= SHUT:
        at = before[at]
    bad = 0
    if at >= 0:
        bad = verdict[at] % 2 if verdict[at] // 2 == nth else 1
    stop, at = at, cell
    while at != stop:
        verdict[at] = 2 * nth + bad
        at = before[at]
    return bad == 1


@bare
def _be_offered(tree: CellTree, hunt: ChannelSearch, radius: float, cell: int) -> None:
    """Let the settled neighbours of a cell offer it the cheapest way to it."""
    child, head, links, middle, kind = tree.child, tree.head, tree.link, tree.middle, tree.kind
    best, by = 1e18, -1
    link = next_neighbour(child, head, links, cell, -1)
    while link >= 0:
        other = links[link, 0]
        if hunt.state[other] >= SETTLED:
            cost = hunt.cost[other] + _step(middle, kind, tree.box, radius, other, cell)
            if cost < best:
                best, by = cost, other
        link = next_neighbour(child, head, links, cell, link)
    if by >= 0:
        hunt.cost[cell], hunt.before[cell], hunt.state[cell] = best, by, OFFERED
        push(hunt.key, hunt.item, hunt.size, best + hunt.guess[cell], cell)


@bare
def _spread_out(tree: CellTree, hunt: ChannelSearch, radius: float, cell: int, dead: bool) -> None:
    """Offer the neighbours of a settled cell the way through it."""
    child, head, links, middle, kind = tree.child, tree.head, tree.link, tree.middle, tree.kind
    link = next_neighbour(child, head, links, cell, -1)
    while link >= 0:
        other = links[link, 0]
        if hunt.state[other] < SETTLED and (kind[other] != DEAD or dead):
            cost = hunt.cost[cell] + _step(middle, kind, tree.box, radius, cell, other)
            if hunt.state[other] == UNSEEN or cost < hunt.cost[other]:
                hunt.cost[other], hunt.before[other], hunt.state[other] = cost, cell, OFFERED
                push(hunt.key, hunt.item, hunt.size, cost + hunt.guess[other], other)
        link = next_neighbour(child, head, links, cell, link)


@bare
def _step(middle: Floats, kind: npt.NDArray[np.int8], box: Ints, radius: float, a: int, b: int) -> float:
    """The cost of going from the middle of one cell to that of another."""
    dx, dy = middle[b, 0] - middle[a, 0], middle[b, 1] - middle[a, 1]
    turn = abs(middle[b, 2] - middle[a, 2])
    turn = min(turn, 2 * math.pi - turn)
    price = PRICE[kind[a], box[a, 3]] + PRICE[kind[b], box[b, 3]]
    return float((math.sqrt(dx * dx + dy * dy) + 0.5 * radius * turn) * 0.5 * price)


@bare
def _guess(middle: Floats, ways: Floats, eye: Floats, frame: Floats, cell: int) -> float:
    """What may be left to go from the middle of a cell."""
    c, s = math.cos(middle[cell, 2]), math.sin(middle[cell, 2])
    x = middle[cell, 0] + c * eye[0] - s * eye[1]
    y = middle[cell, 1] + s * eye[0] + c * eye[1]
    column = min(max(int((x - frame[0]) / frame[2]), 0), ways.shape[1] - 1)
    row = min(max(int((y - frame[1]) / frame[2]), 0), ways.shape[0] - 1)
    return float(EAGER * ways[row, column])


@bare
def _trace(before: Ints, chain: Ints, cell: int) -> int:
    """Write the chain that ends at a cell, from its start; its length."""
    length = 0
    at = cell
    while at >= 0:
        length += 1
        at = before[at]
    n = length
    while cell >= 0:
        n -= 1
        chain[n] = cell
        cell = before[cell]
    return length
