"""Refinement: follow a channel hop by hop, and split the cells to blame where a hop fails. Plain loops for numba."""

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from utak.geometry.cspace.cell_tree import CellTree, give_up_cell, is_splittable, split_cell
from utak.geometry.cspace.local_planner import BLOCKED, HopContext, copy_pose, hop
from utak.geometry.kernels.arrays import Floats, Ints
from utak.geometry.kernels.jit import bare
from utak.geometry.motion.cell_clearance import CELL_CENTRE_FREE, CELL_FREE, CELL_GIVEN_UP


class HopSequence(NamedTuple):
    """The poses of a path found so far; the hops between them are free."""

    poses: Floats  # (n, 3) x, y of the body's centre in squares, table frame, radians; the first is the start
    used: npt.NDArray[np.int64]  # (1,) number of poses in use
    goal: Floats  # (3,) the pose to end at; (0,) if the middle of the channel's last cell will do
    # (cells,) for each cell another from whose middle the hop to its own middle was found free; -1 for none. Most of a
    # channel is that of the round before.
    free_from: Ints
    stops: Floats  # (2, 3) scratch: the poses where a hop begins and ends


def new_hop_sequence(start: Floats, goal: Floats, cells: int) -> HopSequence:
    """Return a path of one pose, `start`, with memory for channels of `cells` cells."""
    hops = HopSequence(
        np.empty((2 * cells + 2, 3)), np.ones(1, np.int64), goal, np.full(cells, -1, np.int32), np.empty((2, 3))
    )
    hops.poses[0] = start
    return hops


@bare
def follow_channel(
    tree: CellTree, context: HopContext, channel: Ints, length: int, split_last: bool, hops: HopSequence
) -> int:
    """Check the hops along a channel and split the cells to blame."""
    # Return how many were blamed, 0 if the path is free.
    # After a hop that fails the rest is followed as if it had not failed, so that one look at a channel finds most of
    # its faults.
    hops.used[0] = 1
    total = length + (1 if len(hops.goal) > 0 else 0)
    blamed, last, n = 0, -1, 0
    here, there = hops.stops[0], hops.stops[1]
    copy_pose(here, hops.poses[0])
    while n < total:
        step = 0
        for ahead in range(2):
            if step > 0 or n + ahead >= total or (ahead == 1 and n < length and tree.kind[channel[n]] == CELL_FREE):
                continue
            if _write_stop(tree.middle, tree.kind, channel, length, hops.goal, n + ahead, there) and _hop_to_stop(
                tree, context, channel, length, hops, last, n + ahead, here, there
            ):
                step = ahead + 1
        if step > 0:
            last = n + step - 1
            copy_pose(here, there)
        else:
            blamed += _split_blamed(tree, context, channel, last, n, length, 1 + total - length)
            step, last = 1, -1
            if n < length:
                copy_pose(here, tree.middle[channel[n]])
                last = n if tree.child[channel[n]] < 0 else -1
        n += step
    if split_last:
        blamed += _split_or_give_up(tree, context, channel[length - 1])
    return blamed


@bare
def _write_stop(
    middle: Floats, kind: npt.NDArray[np.int8], channel: Ints, length: int, goal: Floats, n: int, there: Floats
) -> bool:
    """Write stop n of a channel to `there`; return whether the body is known to be free there."""
    if n == length:
        copy_pose(there, goal)
        return True
    copy_pose(there, middle[channel[n]])
    return bool(kind[channel[n]] <= CELL_CENTRE_FREE)


@bare
def _hop_to_stop(
    tree: CellTree,
    context: HopContext,
    channel: Ints,
    length: int,
    hops: HopSequence,
    last: int,
    n: int,
    here: Floats,
    there: Floats,
) -> bool:
    """Hop to stop n, directly or by way of the face between two cells, and append it; return whether that is free."""
    if not _direct_hop_is_free(context, channel, length, hops, last, n, here, there):
        if last < 0 or n >= length or n != last + 1:
            return False
        middle = hops.poses[hops.used[0]]
        _write_face_pose(tree, channel[last], channel[n], middle)
        if hop(context, here, middle) == BLOCKED or hop(context, middle, there) == BLOCKED:
            return False
        hops.used[0] += 1
    copy_pose(hops.poses[hops.used[0]], there)
    hops.used[0] += 1
    return True


@bare
def _direct_hop_is_free(
    context: HopContext, channel: Ints, length: int, hops: HopSequence, last: int, n: int, here: Floats, there: Floats
) -> bool:
    """Return whether the hop to stop n is free. From middle to middle of two cells that is computed only once."""
    between = last >= 0 and n < length
    if between and hops.free_from[channel[n]] == channel[last]:
        return True
    if hop(context, here, there) == BLOCKED:
        return False
    if between:
        hops.free_from[channel[n]] = channel[last]
    return True


@bare
def _write_face_pose(tree: CellTree, a: int, b: int, middle: Floats) -> None:
    """Write the pose in the middle of the face that neighbouring cells a and b share to `middle`, (3,)."""
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
def _split_blamed(tree: CellTree, context: HopContext, channel: Ints, last: int, n: int, length: int, ends: int) -> int:
    """Split the cell that a failed hop leads into, and the one that it leaves if that is as doubtful and as large."""
    blamed = 0
    if n < length and tree.kind[channel[n]] != CELL_FREE:
        blamed += _split_near(tree, context, channel, n, length, ends)
    if last >= 0 and tree.kind[channel[last]] == CELL_CENTRE_FREE:
        large = n < length and tree.box[channel[last], 3] <= tree.box[channel[n], 3]
        if blamed == 0 or large:
            blamed += _split_near(tree, context, channel, last, length, ends)
    if blamed == 0:
        blamed += _split_near(tree, context, channel, min(n, length - 1), length, ends)
    return blamed


@bare
def _split_near(tree: CellTree, context: HopContext, channel: Ints, n: int, length: int, ends: int) -> int:
    """Split cell n of a channel, or the one next to it if cell n holds an end to be reached and is too small."""
    if length > 1 and not is_splittable(tree, channel[n], context.body):
        if n == 0:
            n = 1
        elif n == length - 1 and ends > 1:
            n -= 1
    return _split_or_give_up(tree, context, channel[n])


@bare
def _split_or_give_up(tree: CellTree, context: HopContext, cell: int) -> int:
    """Split leaf number `cell` of `tree`, or give it up if it is too small. Return 1: it was changed, now or before."""
    if tree.child[cell] >= 0 or tree.kind[cell] == CELL_GIVEN_UP:
        return 1
    if is_splittable(tree, cell, context.body):
        split_cell(tree, cell, context.body, context.nearby)
    else:
        give_up_cell(tree, cell)
    return 1
