"""Chains of cells from a pose to a goal: the optimist's plan. Plain loops for numba.

A chain runs over neighbouring cells that are not known to be full; doubtful ones are dearer. Best-first search, with
the way that a disc would have to go as its guess of what is left, makes the chain that looks cheapest.
"""

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from geometry.cells import Tree, centre, neighbours, splittable
from geometry.compiled import compiled
from geometry.separation import DEAD, FREE, FULL, OPEN, SHUT, Ground, Mover, classify

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int32]
EAGER = 2.0  # how much dearer the way still to go is than the way gone
DEAR = np.array([1.0, 2.0, 5.0, 1e9, 50.0])  # the cost of a square's way by kind of cell
REGION = -2  # in place of a goal cell: the goal is a region


class Hunt(NamedTuple):
    """Room to search in, for all cells of a tree.

    cost: of the way to a cell; before: the cell before it; round: the search that last saw it; done: whether it is
    settled, and 2 once it has been put off as a doubtful goal. key, item, size: a heap of cells by cost. found, stack:
    for neighbours. chain: the cells of the last chain. ways: (rows, columns) what is left to go at a pixel. eye: the
    point of the body from which that is told.
    """

    cost: Floats
    before: Ints
    round: Ints
    done: npt.NDArray[np.int8]
    key: Floats
    item: Ints
    size: npt.NDArray[np.int64]
    found: Ints
    stack: Ints
    chain: Ints
    ways: Floats
    eye: Floats


def new_hunt(capacity: int, ways: Floats, eye: Floats) -> Hunt:
    """Room to search a tree of up to so many cells."""
    return Hunt(
        np.empty(capacity),
        np.empty(capacity, np.int32),
        np.zeros(capacity, np.int32),
        np.empty(capacity, np.int8),
        np.empty(8 * capacity),
        np.empty(8 * capacity, np.int32),
        np.zeros(1, np.int64),
        np.empty(capacity, np.int32),
        np.empty(4096, np.int32),
        np.empty(capacity, np.int32),
        ways,
        eye,
    )


@compiled
def push(hunt: Hunt, key: float, item: int) -> None:
    """Put an item on the heap; when it is full, forget it."""
    at = hunt.size[0]
    if at >= len(hunt.key):
        return
    hunt.size[0] += 1
    while at > 0:
        up = (at - 1) >> 1
        if hunt.key[up] <= key:
            break
        hunt.key[at], hunt.item[at] = hunt.key[up], hunt.item[up]
        at = up
    hunt.key[at], hunt.item[at] = key, item


@compiled
def pop(hunt: Hunt) -> tuple[float, int]:
    """Take the item with the least key off the heap."""
    best, item = hunt.key[0], hunt.item[0]
    hunt.size[0] -= 1
    size = hunt.size[0]
    key, last = hunt.key[size], hunt.item[size]
    at = 0
    while True:
        down = 2 * at + 1
        if down >= size:
            break
        if down + 1 < size and hunt.key[down + 1] < hunt.key[down]:
            down += 1
        if hunt.key[down] >= key:
            break
        hunt.key[at], hunt.item[at] = hunt.key[down], hunt.item[down]
        at = down
    hunt.key[at], hunt.item[at] = key, last
    return best, item


@compiled
def left_to_go(hunt: Hunt, ground: Ground, x: float, y: float, angle: float) -> float:
    """A guess at the way from a pose to the goal."""
    c, s = math.cos(angle), math.sin(angle)
    px = x + c * hunt.eye[0] - s * hunt.eye[1]
    py = y + s * hunt.eye[0] + c * hunt.eye[1]
    rows, columns = hunt.ways.shape
    column = min(max(int((px - ground.frame[0]) / ground.frame[2]), 0), columns - 1)
    row = min(max(int((py - ground.frame[1]) / ground.frame[2]), 0), rows - 1)
    return float(hunt.ways[row, column])


@compiled
def is_goal(tree: Tree, mover: Mover, region: Ground, cell: int, goal: int) -> int:
    """FREE or OPEN when the cell's centre is a goal (or the cell the goal's), SHUT when it may hold one, else FULL."""
    if goal != REGION:
        return OPEN if cell == goal else FULL
    x, y, angle = centre(tree, cell)
    depth = tree.box[cell, 3]
    spread = tree.sizes[depth, 0] * tree.frame[2] / math.sqrt(2.0)
    return classify(mover, region, x, y, angle, spread, tree.sizes[depth, 1] * tree.frame[3] / 2)


@compiled
def find_chain(
    tree: Tree, mover: Mover, ground: Ground, region: Ground, hunt: Hunt, start: int, goal: int, nth: int, dead: bool
) -> int:
    """Search for the cheapest-looking chain from a cell to the goal; its length, 0 when there is none.

    The chain is left in hunt.chain, from the start. nth: the number of this search, above all before. dead: whether it
    may run through cells given up.
    """
    hunt.size[0] = 0
    hunt.round[start], hunt.cost[start], hunt.before[start], hunt.done[start] = nth, 0.0, -1, 0
    push(hunt, 0.0, start)
    while hunt.size[0] > 0:
        key, cell = pop(hunt)
        if hunt.done[cell] == 1:
            continue
        sight = is_goal(tree, mover, region, cell, goal) if hunt.done[cell] == 0 else SHUT
        if sight in (FREE, OPEN) or hunt.done[cell] == 2:
            return _trace(hunt, cell)
        hunt.done[cell] = 1
        _spread_out(tree, mover, ground, hunt, cell, nth, dead)
        if sight == SHUT and splittable(tree, cell, mover):
            hunt.done[cell] = 2
            push(hunt, key + 2.0 * mover.radius, cell)
    return 0


@compiled
def _trace(hunt: Hunt, cell: int) -> int:
    """Write the chain that ends at a cell, from its start."""
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


@compiled
def _spread_out(tree: Tree, mover: Mover, ground: Ground, hunt: Hunt, cell: int, nth: int, dead: bool) -> None:
    """Offer the neighbours of a settled cell the way through it."""
    x, y, angle = centre(tree, cell)
    dear = DEAR[tree.kind[cell]]
    for k in range(neighbours(tree, cell, hunt.found, hunt.stack)):
        other = hunt.found[k]
        kind = tree.kind[other]
        if kind == FULL or (kind == DEAD and not dead):
            continue
        if hunt.round[other] != nth:
            hunt.round[other], hunt.cost[other], hunt.done[other] = nth, 1e18, 0
        elif hunt.done[other] != 0:
            continue
        px, py, turned = centre(tree, other)
        turn = abs(turned - angle)
        turn = min(turn, 2 * math.pi - turn)
        way = math.sqrt((px - x) ** 2 + (py - y) ** 2) + 0.5 * mover.radius * turn
        cost = hunt.cost[cell] + way * 0.5 * (dear + DEAR[kind])
        if cost < hunt.cost[other]:
            hunt.cost[other], hunt.before[other] = cost, cell
            push(hunt, cost + EAGER * left_to_go(hunt, ground, px, py, turned), other)
