"""New nodes and chains of a changed stretch spliced into the arrays of the old ones, which have spare room.

# Strategy: nodes and chains are ordered by cells, so what a small change alters lies in one short stretch of either
array. Before the stretch everything stays in place, but for last ends in the stretch or behind it. Behind it everything
moves by the same number of places and its ends change by the same number. Only the stretch itself is merged one by one.
"""

from bisect import bisect_left
from typing import Any, NamedTuple, TypeVar, cast

import numpy as np
from numpy.typing import NDArray

from geometry.kernels.arrays import Ints, Longs
from geometry.kernels.jit import bare
from geometry.skeleton.graph import SkeletonGraph, find, walk_chain
from geometry.skeleton.lowest_cells import lowest_of, new_notes
from geometry.skeleton.skeleton import Flags, Heights

Array = TypeVar("Array", bound=NDArray[Any])

SPARE_ROOM = 64  # nodes or chains, and a sixteenth of what there are: so many more fit into new arrays (a convention)


class Splice(NamedTuple):
    """The nodes after a change, and their numbers before and after it.

    Attributes
    ----------
    node : (n,) int32
        Cells of all nodes after the change.
    low, high : int
        Number of the first old node of the stretch that is merged, and of the one behind its last.
    number : (high - low,) int64
        New number of each of these old nodes; -1 for nodes that are gone.
    shift : int
        How much the numbers of the nodes behind the stretch grow.
    """

    node: Ints
    low: int
    high: int
    number: Longs
    shift: int


def splice_nodes(old: Ints, low: int, high: int, open_ends: Flags, grown: Ints) -> Splice:
    """Return the nodes of a stretch that stay merged with new ones.

    Parameters
    ----------
    old : (n,) int32
        Cells of all nodes before the change.
    low, high : int
        The stretch: old nodes ``low <= k < high``.
    open_ends : (n,) uint8
        For each old node the bits of the ends whose chains are gone; 16 and more when the node itself is gone.
    grown : (k,) int32
        Cells of the new nodes.
    """
    stretch, stays = old[low:high], open_ends[low:high] < 16
    merged = np.concatenate([stretch[stays], grown])
    merged.sort()
    number = np.where(stays, merged.searchsorted(stretch) + low, -1)
    shift = len(merged) - len(stretch)
    size = len(old) + shift
    whole = with_room(old, size)
    if shift:
        whole[high + shift : size] = whole[high : len(old)]
    whole[low : high + shift] = merged
    return Splice(whole[:size], low, high, number, shift)


def splice_chains(
    heights: Heights, states: Flags, width: int, bones: SkeletonGraph, splice: Splice, open_ends: Flags, seeds: Ints
) -> SkeletonGraph:
    """Return the graph after a change: new chains walked from the seeds, merged with the chains that stay.

    Parameters
    ----------
    heights, states, width
        Squared clearances and states of the padded screen, flat, and its width.
    bones : SkeletonGraph
        The graph before the change; its arrays are reused where they have room.
    splice : Splice
        The nodes after the change.
    open_ends : (n,) uint8
        For each old node the bits of the ends whose chains are gone.
    seeds : (k,) int32
        Ends (4 times the new node plus direction) from which new chains may lead, ascending.
    """
    old, (node, low, high, number, shift) = len(bones.port), splice
    first, last = (bisect_left(bones.port[:, 0], 4 * n) for n in (low, high))
    stretch = bones.port[first:last], bones.neck[first:last], bones.steps[first:last]
    room = last - first + len(seeds)
    fresh = np.empty((room, 2), np.int32), np.empty(room, np.int32), np.empty(room, np.int32)
    notes = new_notes(len(heights))[0]
    found = merge_chains(
        heights,
        states,
        width,
        bones.port[:first],
        *stretch,
        open_ends,
        low,
        high,
        number,
        shift,
        seeds,
        node,
        *fresh,
        notes,
    )
    moved = found - (last - first)
    size = old + moved
    port, neck, steps = with_room(bones.port, size), with_room(bones.neck, size), with_room(bones.steps, size)
    if moved:
        ends = port.reshape(-1)  # along one axis numpy needs no copy to move what overlaps
        ends[2 * (last + moved) : 2 * size] = ends[2 * last : 2 * old]
        neck[last + moved : size], steps[last + moved : size] = neck[last:old], steps[last:old]
    if shift:
        port[last + moved : size] += 4 * shift
    here = slice(first, first + found)
    port[here], neck[here], steps[here] = (part[:found] for part in fresh)
    return SkeletonGraph(node, port[:size], neck[:size], steps[:size])


def with_room(array: Array, size: int) -> Array:
    """Return the array of which ``array`` is the beginning if that has at least ``size`` rows, else a longer copy."""
    whole = array.base
    if isinstance(whole, np.ndarray) and whole.ndim == array.ndim and len(whole) >= size:
        return cast(Array, whole)
    longer = np.empty((size + size // 16 + SPARE_ROOM, *array.shape[1:]), array.dtype)
    longer[: len(array)] = array
    return cast(Array, longer)


@bare
def renamed(end: int, low: int, high: int, number: Longs, shift: int) -> int:
    """Return the new code of an end (4 times the node plus direction) whose code before the change was ``end``."""
    node = end >> 2
    if node < low:
        return end
    return 4 * (number[node - low] if node < high else node + shift) + (end & 3)


@bare
def merge_chains(
    heights: Heights,
    states: Flags,
    width: int,
    ahead: Ints,
    old_port: Ints,
    old_neck: Ints,
    old_steps: Ints,
    open_ends: Flags,
    low: int,
    high: int,
    number: Longs,
    shift: int,
    seeds: Ints,
    node: Ints,
    port: Ints,
    neck: Ints,
    steps: Ints,
    notes: Ints,
) -> int:
    """Fill ``port``, ``neck`` and ``steps`` with the old chains of a stretch that stay and the new ones, in order.

    Returns their number. The chains ``ahead`` of the stretch only get the new codes of their last ends. ``seeds`` are
    ascending ends from which new chains are walked; ``notes`` is scratch (see lowest_cells.py).
    """
    size, k = 0, 0
    for chain in range(ahead.shape[0]):
        if ahead[chain, 1] >= 4 * low:
            ahead[chain, 1] = renamed(ahead[chain, 1], low, high, number, shift)
    for chain in range(old_port.shape[0] + 1):
        first, last = 4 * node.shape[0], 0
        if chain < old_port.shape[0]:
            a, b = old_port[chain, 0], old_port[chain, 1]
            if open_ends[a >> 2] >> (a & 3) & 1 or open_ends[b >> 2] >> (b & 3) & 1:
                continue
            first, last = renamed(a, low, high, number, shift), renamed(b, low, high, number, shift)
        while k < seeds.shape[0] and seeds[k] < first:
            end, back, long, noted = walk_chain(node[seeds[k] >> 2], seeds[k] & 3, heights, states, width, notes, 0)
            other = 4 * find(node, end) + back
            if seeds[k] < other:
                port[size, 0], port[size, 1], neck[size], steps[size] = (
                    seeds[k],
                    other,
                    lowest_of(notes, 0, noted, heights),
                    long,
                )
                size += 1
            k += 1
        if chain < old_port.shape[0]:
            port[size, 0], port[size, 1] = first, last
            neck[size], steps[size] = old_neck[chain], old_steps[chain]
            size += 1
    return size
