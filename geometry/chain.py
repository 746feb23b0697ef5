"""Chains of cells from a pose to a goal: the optimist's plan. Plain loops for numba.

A chain runs over neighbouring cells that are not known to be full; doubtful ones are dearer. Best-first search, with
the way that a disc would have to go as its guess of what is left, makes the chain that looks cheapest.

# Strategy: between two searches only the cells of one chain change. The search tree is kept: what hung on a changed
# cell is cut off, and offered again by its neighbours that still stand. A search then costs what changed, not what was
# ever seen.
"""

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from geometry.cells import Tree, centre, neighbours, splittable
from geometry.compiled import compiled
from geometry.heap import pop, push
from geometry.separation import DEAD, FULL, OPEN, SHUT, Ground, Mover, classify

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int32]
EAGER = 2.0  # how much dearer the way still to go is than the way gone
DEAR = np.array([1.0, 2.0, 5.0, 1e9, 50.0])  # the cost of a square's way by kind of cell
REGION = -2  # in place of a goal cell: the goal is a region
UNSEEN, OFFERED, SETTLED, DOUBTED = 0, 1, 2, 3


class Hunt(NamedTuple):
    """A search among the cells of a tree, kept from one chain to the next.

    cost: of the way to a cell; before: the cell before it; state: UNSEEN, OFFERED (on the heap), SETTLED, or DOUBTED (a
    settled cell that may hold a goal, put off); verdict: scratch of the repair. seen: (1,) cells that have a state. key,
    item, size: the heap. found, stack: scratch for neighbours. chain: the cells of the last chain, the start's first;
    loose: scratch. ways: (rows, columns) what is left to go at a pixel. eye: the point of the body that it is told for.
    """

    cost: Floats
    before: Ints
    state: npt.NDArray[np.int8]
    verdict: Ints
    seen: npt.NDArray[np.int64]
    key: Floats
    item: Ints
    size: npt.NDArray[np.int64]
    found: Ints
    stack: Ints
    chain: Ints
    loose: Ints
    ways: Floats
    eye: Floats


def new_hunt(capacity: int, ways: Floats, eye: Floats) -> Hunt:
    """Room to search a tree of up to so many cells."""
    ints = [np.empty(n, np.int32) for n in (capacity, capacity, 8 * capacity, capacity, 4096, capacity, capacity)]
    before, verdict, item, found, stack, chain, loose = ints
    verdict[:] = 0
    numbers = np.zeros(1, np.int64), np.empty(8 * capacity), item, np.zeros(2, np.int64)
    state = np.empty(capacity, np.int8)
    return Hunt(np.empty(capacity), before, state, verdict, *numbers, found, stack, chain, loose, ways, eye)


@compiled
def find_chain(
    tree: Tree, mover: Mover, ground: Ground, region: Ground, hunt: Hunt, start: int, goal: int, nth: int, dead: bool
) -> int:
    """Search on for a chain from a cell to the goal; its length, 0 when there is none.

    nth: the number of this search, from 1. dead: whether the chain may run through cells given up (then hunt.seen must
    have been set to 0, which forgets all searches before).
    """
    _repair(tree, mover, ground, hunt, nth)
    if hunt.state[start] == UNSEEN:
        hunt.cost[start], hunt.before[start], hunt.state[start] = 0.0, -1, OFFERED
        push(hunt.key, hunt.item, hunt.size, 0.0, start)
    while hunt.size[0] > 0:
        key, cell = pop(hunt.key, hunt.item, hunt.size)
        if tree.child[cell] >= 0 or hunt.state[cell] == SETTLED or hunt.state[cell] == UNSEEN:
            continue
        doubted = hunt.state[cell] == DOUBTED
        sight = SHUT if doubted else goal_sight(tree, mover, region, cell, goal)
        if sight <= OPEN or doubted:
            hunt.state[cell] = SETTLED
            _spread_out(tree, mover, ground, hunt, cell, dead)
            return _trace(hunt, cell)
        hunt.state[cell] = SETTLED
        _spread_out(tree, mover, ground, hunt, cell, dead)
        if sight == SHUT and (dead or splittable(tree, cell, mover)):
            hunt.state[cell] = DOUBTED
            push(hunt.key, hunt.item, hunt.size, key + 2.0 * mover.radius, cell)
    return 0


@compiled
def goal_sight(tree: Tree, mover: Mover, region: Ground, cell: int, goal: int) -> int:
    """FREE or OPEN when the cell's centre is a goal (or the cell the goal's), SHUT when it may hold one, else FULL."""
    if goal != REGION:
        return OPEN if cell == goal else FULL
    x, y, angle = centre(tree, cell)
    depth = tree.box[cell, 3]
    spread = tree.sizes[depth, 0] * tree.frame[2] / math.sqrt(2.0)
    return classify(mover, region, x, y, angle, spread, tree.sizes[depth, 1] * tree.frame[3] / 2)


@compiled
def _repair(tree: Tree, mover: Mover, ground: Ground, hunt: Hunt, nth: int) -> None:
    """Cut off what hung on cells that were split or given up, and offer it and the new cells again."""
    loose = 0
    for cell in range(hunt.seen[0]):
        if hunt.state[cell] != UNSEEN and _cut_off(tree, hunt, cell, nth):
            hunt.state[cell] = UNSEEN
            hunt.loose[loose] = cell
            loose += 1
    for cell in range(hunt.seen[0], tree.used[0]):
        hunt.state[cell] = UNSEEN
        hunt.loose[loose] = cell
        loose += 1
    hunt.seen[0] = tree.used[0]
    for k in range(loose):
        cell = hunt.loose[k]
        if tree.child[cell] < 0 and tree.kind[cell] <= SHUT:
            _be_offered(tree, mover, ground, hunt, cell)


@compiled
def _cut_off(tree: Tree, hunt: Hunt, cell: int, nth: int) -> bool:
    """Whether the way to a cell runs through one that was split or given up."""
    at = cell
    while at >= 0 and hunt.verdict[at] // 2 != nth and tree.child[at] < 0 and tree.kind[at] <= SHUT:
        at = hunt.before[at]
    bad = 0
    if at >= 0:
        bad = hunt.verdict[at] % 2 if hunt.verdict[at] // 2 == nth else 1
    stop, at = at, cell
    while at != stop:
        hunt.verdict[at] = 2 * nth + bad
        at = hunt.before[at]
    return bad == 1


@compiled
def _be_offered(tree: Tree, mover: Mover, ground: Ground, hunt: Hunt, cell: int) -> None:
    """Let the settled neighbours of a cell offer it the cheapest way to it."""
    best, by = 1e18, -1
    for k in range(neighbours(tree, cell, hunt.found, hunt.stack)):
        other = hunt.found[k]
        if hunt.state[other] >= SETTLED:
            cost = hunt.cost[other] + _step(tree, mover, other, cell)
            if cost < best:
                best, by = cost, other
    if by >= 0:
        _offer(tree, mover, ground, hunt, cell, best, by)


@compiled
def _spread_out(tree: Tree, mover: Mover, ground: Ground, hunt: Hunt, cell: int, dead: bool) -> None:
    """Offer the neighbours of a settled cell the way through it."""
    for k in range(neighbours(tree, cell, hunt.found, hunt.stack)):
        other = hunt.found[k]
        if hunt.state[other] >= SETTLED or (tree.kind[other] == DEAD and not dead):
            continue
        cost = hunt.cost[cell] + _step(tree, mover, cell, other)
        if hunt.state[other] == UNSEEN or cost < hunt.cost[other]:
            _offer(tree, mover, ground, hunt, other, cost, cell)


@compiled
def _offer(tree: Tree, mover: Mover, ground: Ground, hunt: Hunt, cell: int, cost: float, before: int) -> None:
    """Put a cell on the heap with the way to it."""
    hunt.cost[cell], hunt.before[cell], hunt.state[cell] = cost, before, OFFERED
    x, y, angle = centre(tree, cell)
    c, s = math.cos(angle), math.sin(angle)
    px = x + c * hunt.eye[0] - s * hunt.eye[1]
    py = y + s * hunt.eye[0] + c * hunt.eye[1]
    rows, columns = hunt.ways.shape
    column = min(max(int((px - ground.frame[0]) / ground.frame[2]), 0), columns - 1)
    row = min(max(int((py - ground.frame[1]) / ground.frame[2]), 0), rows - 1)
    push(hunt.key, hunt.item, hunt.size, cost + EAGER * hunt.ways[row, column], cell)


@compiled
def _step(tree: Tree, mover: Mover, a: int, b: int) -> float:
    """The cost of going from the centre of one cell to that of another."""
    ax, ay, at = centre(tree, a)
    bx, by, bt = centre(tree, b)
    turn = abs(bt - at)
    turn = min(turn, 2 * math.pi - turn)
    way = math.sqrt((bx - ax) ** 2 + (by - ay) ** 2) + 0.5 * mover.radius * turn
    return float(way * 0.5 * (DEAR[tree.kind[a]] + DEAR[tree.kind[b]]))


@compiled
def _trace(hunt: Hunt, cell: int) -> int:
    """Write the chain that ends at a cell, from its start; its length."""
    length = 0
    at = cell
    while at >= 0:
        length += 1
        at = hunt.before[at]
    n = length
    while cell >= 0:
        n -= 1
        hunt.chain[n] = cell
        cell = hunt.before[cell]
    return length
