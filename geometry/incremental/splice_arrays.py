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
    """The nodes of a skeleton's graph after a change, and their numbers before and after it.

    Cells are flat indices into the padded screen. Only a stretch of the list of nodes, which is ordered by cells, is
    merged anew; nodes before it keep their numbers.

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
    """Return the nodes of a stretch that stay merged with new ones, and how the numbers of old nodes change.

    Flat indices are row * width + column in the screen padded by one blocked cell on each side.

    Parameters
    ----------
    old : (n,) int32
        Cells (flat indices) of all nodes before the change, ascending. Their memory is reused where it has room.
    low, high : int
        The stretch: old nodes ``low <= k < high``.
    open_ends : (n,) uint8
        For each old node the bits (by direction, 0 east to 3 south) of the ends whose chains are gone; 16 and more when
        the node itself is gone.
    grown : (k,) int32
        Cells of the new nodes, which all lie within the stretch.

    Returns
    -------
    Splice
        The cells of all nodes after the change, ascending; `low` and `high`; the new number of each old node between
        them (-1 when it is gone); and by how much the numbers of nodes from `high` on grow.
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

    Flat indices are row * width + column in the screen padded by one blocked cell on each side.

    Parameters
    ----------
    heights, states, width
        Squared clearances (half squares) and states of the padded screen after the change, flat, and its width.
    bones : SkeletonGraph
        The graph before the change; its arrays are reused where they have room, so that it no longer holds.
    splice : Splice
        The cells of the nodes after the change, and how the numbers of old nodes change.
    open_ends : (n,) uint8
        For each old node the bits (by direction, 0 east to 3 south) of the ends whose chains are gone.
    seeds : (k,) int32
        Ends (4 times the new node plus direction) from which new chains may lead, ascending.

    Returns
    -------
    SkeletonGraph
        The cells of the nodes, and of each chain its two ends (4 times the node plus direction), its lowest cell and
        its number of steps. In the order that graph.py would give it: equal to that of a new screen.
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
    """Return the array of which ``array`` is the beginning if that has at least ``size`` rows, else a longer copy.

    Either begins with the rows of ``array`` and has ``size`` rows or more; further rows have arbitrary values. A copy
    has a sixteenth and 64 rows to spare.
    """
    whole = array.base
    if isinstance(whole, np.ndarray) and whole.ndim == array.ndim and len(whole) >= size:
        return cast(Array, whole)
    longer = np.empty((size + size // 16 + SPARE_ROOM, *array.shape[1:]), array.dtype)
    longer[: len(array)] = array
    return cast(Array, longer)


@bare
def renamed(end: int, low: int, high: int, number: Longs, shift: int) -> int:
    """Return the new code of an end (4 times the node plus direction) whose code before the change was ``end``.

    Parameters
    ----------
    low, high : the old nodes ``low <= k < high`` are numbered anew one by one; those before keep their numbers.
    number : (high - low,) int64, their new numbers; the node must not be gone (-1).
    shift : how much the numbers of nodes from ``high`` on grow.
    """
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

    Returns their number. Ends are coded as 4 times the number of the node plus the direction (0 east to 3 south) in
    which the chain leaves it; cells are flat indices into the padded screen. Flat indices are row * width + column in
    the screen padded by one blocked cell on each side.

    Parameters
    ----------
    heights, states : (cells,)
        Squared clearances in squared half squares and states of the skeleton, after the change, flat.
    width : int
        Width of the padded screen.
    ahead : (a, 2) int32
        Ends of the chains before the stretch; those last ends that lie in it or behind it get their new codes, in
        place.
    old_port, old_neck, old_steps : (s, 2), (s,), (s,) int32
        Ends, lowest cells and numbers of steps of the chains of the stretch before the change.
    open_ends : (n,) uint8
        For each old node the bits (by direction) of the ends whose chains are gone.
    low, high, number, shift
        How the numbers of old nodes change: those before `low` stay, those below `high` become ``number[k - low]`` (-1
        for gone), the others grow by `shift`.
    seeds : (k,) int32
        Ends, by new numbers and ascending, from which new chains are walked; a chain that is met from both ends counts
        once.
    node : (new n,) int32
        Cells of all nodes after the change.
    port, neck, steps : (s + k, 2), (s + k,), (s + k,) int32
        Filled from index 0 on: ends by new numbers, lowest cell, number of steps from square to square.
    notes : (size,) int32
        Scratch for cells that may be the lowest of their chain.
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
