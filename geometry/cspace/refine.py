"""Following a chain of cells hop by hop, and splitting what is to blame where a hop fails. Plain loops for numba."""

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from geometry.cspace.cell_tree import CellTree, split, splittable
from geometry.cspace.local_planner import BLOCKED, HopContext, hop, put
from geometry.kernels.arrays import Floats, Ints
from geometry.kernels.jit import bare
from geometry.motion.cell_clearance import DEAD, FREE, OPEN


class HopSequence(NamedTuple):
    """The poses of a way found so far.

    poses: (n, 3) x, y, angle, the first being the start; used: (1,) how many of them are in use; goal: the pose to end
    at, empty when the centre of the chain's last cell will do. free_from: for each cell one from whose middle the hop
    to its own was found free, -1 for none: most of a chain is that of the round before. stops: (2, 3) scratch: where a
    hop begins and ends.
    """

    poses: Floats
    used: npt.NDArray[np.int64]
    goal: Floats
    free_from: Ints
    stops: Floats


def new_way(start: Floats, goal: Floats, cells: int) -> HopSequence:
    """A way that begins at a pose, with room for chains of so many cells."""
    way = HopSequence(
        np.empty((2 * cells + 2, 3)), np.ones(1, np.int64), goal, np.full(cells, -1, np.int32), np.empty((2, 3))
    )
    way.poses[0] = start
    return way


@bare
def follow(tree: CellTree, scene: HopContext, chain: Ints, length: int, doubt: bool, way: HopSequence) -> int:
    """Check the hops of a chain and split what is to blame; how many cells were changed. 0: the way is free.

    One doubtful cell may be jumped over. After a hop that fails the rest is followed as if it had not, so that one look
    at a chain finds most of its faults. A cell that is to blame and too small to split is given up. doubt: the last
    cell must be split in any case.
    """
    way.used[0] = 1
    total = length + (1 if len(way.goal) > 0 else 0)
    blamed, last, n = 0, -1, 0
    here, there = way.stops[0], way.stops[1]
    put(here, way.poses[0])
    while n < total:
        step = 0
        for ahead in range(2):
            if step > 0 or n + ahead >= total or (ahead == 1 and n < length and tree.kind[chain[n]] == FREE):
                continue
            if _stop_at(tree.middle, tree.kind, chain, length, way.goal, n + ahead, there) and _go(
                tree, scene, chain, length, way, last, n + ahead, here, there
            ):
                step = ahead + 1
        if step > 0:
            last = n + step - 1
            put(here, there)
        else:
            blamed += _blame(tree, scene, chain, last, n, length, 1 + total - length)
            step, last = 1, -1
            if n < length:
                put(here, tree.middle[chain[n]])
                last = n if tree.child[chain[n]] < 0 else -1
        n += step
    if doubt:
        blamed += _divide(tree, scene, chain[length - 1])
    return blamed


@bare
def _stop_at(
    middle: Floats, kind: npt.NDArray[np.int8], chain: Ints, length: int, goal: Floats, n: int, there: Floats
) -> bool:
    """Write the n-th stop of a chain: a cell's middle or, after the last, the goal. False: the body overlaps there."""
    if n == length:
        put(there, goal)
        return True
    put(there, middle[chain[n]])
    return bool(kind[chain[n]] <= OPEN)


@bare
def _go(
    tree: CellTree,
    scene: HopContext,
    chain: Ints,
    length: int,
    way: HopSequence,
    last: int,
    n: int,
    here: Floats,
    there: Floats,
) -> bool:
    """Hop to the n-th stop, straight or by way of the face between the two cells, and write it down."""
    if not _straight(scene, chain, length, way, last, n, here, there):
        if last < 0 or n >= length or n != last + 1:
            return False
        middle = way.poses[way.used[0]]
        _meet(tree, chain[last], chain[n], middle)
        if hop(scene, here, middle) == BLOCKED or hop(scene, middle, there) == BLOCKED:
            return False
        way.used[0] += 1
    put(way.poses[way.used[0]], there)
    way.used[0] += 1
    return True


@bare
def _straight(
    scene: HopContext, chain: Ints, length: int, way: HopSequence, last: int, n: int, here: Floats, there: Floats
) -> bool:
    """Whether the hop to the n-th stop is free; from middle to middle of two cells that is found out only once."""
    between = last >= 0 and n < length
    if between and way.free_from[chain[n]] == chain[last]:
        return True
    if hop(scene, here, there) == BLOCKED:
        return False
    if between:
        way.free_from[chain[n]] = chain[last]
    return True


@bare
def _meet(tree: CellTree, a: int, b: int, middle: Floats) -> None:
    """Write the pose in the middle of the face that two neighbouring cells share."""
    for k in range(3):
        unit = tree.frame[2] if k < 2 else tree.frame[3]
        size_a = tree.sizes[tree.box[a, 3], k // 2] * unit
        size_b = tree.sizes[tree.box[b, 3], k // 2] * unit
        a0, b0 = tree.box[a, k] * unit, tree.box[b, k] * unit
        if k == 2 and b0 > a0 + size_a + 1e-12:
            b0 -= 2 * math.pi
        elif k == 2 and a0 > b0 + size_b + 1e-12:
            b0 += 2 * math.pi
        middle[k] = (max(a0, b0) + min(a0 + size_a, b0 + size_b)) / 2
        if k < 2:
            middle[k] += tree.frame[k]


@bare
def _blame(tree: CellTree, scene: HopContext, chain: Ints, last: int, n: int, length: int, ends: int) -> int:
    """Split the cell that a failed hop leads into, and the one that it leaves when that is as doubtful and as large."""
    blamed = 0
    if n < length and tree.kind[chain[n]] != FREE:
        blamed += _divide_near(tree, scene, chain, n, length, ends)
    if last >= 0 and tree.kind[chain[last]] == OPEN:
        large = n < length and tree.box[chain[last], 3] <= tree.box[chain[n], 3]
        if blamed == 0 or large:
            blamed += _divide_near(tree, scene, chain, last, length, ends)
    if blamed == 0:
        blamed += _divide_near(tree, scene, chain, min(n, length - 1), length, ends)
    return blamed


@bare
def _divide_near(tree: CellTree, scene: HopContext, chain: Ints, n: int, length: int, ends: int) -> int:
    """Divide the n-th cell of a chain; when it holds an end that is to be reached and is too small, the one beside it.

    The body is free at its ends: their cells are never given up. Others come as near to them as they can.
    """
    if length > 1 and not splittable(tree, chain[n], scene.mover):
        if n == 0:
            n = 1
        elif n == length - 1 and ends > 1:
            n -= 1
    return _divide(tree, scene, chain[n])


@bare
def _divide(tree: CellTree, scene: HopContext, cell: int) -> int:
    """Split a leaf, or give it up when it is too small. Always 1: it was changed, now or before."""
    if tree.child[cell] >= 0 or tree.kind[cell] == DEAD:
        return 1
    if splittable(tree, cell, scene.mover):
        split(tree, cell, scene.mover, scene.ground)
    else:
        tree.kind[cell] = DEAD
    return 1
