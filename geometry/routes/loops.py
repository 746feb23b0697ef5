"""Loops: closed paths over the pathgraph that wind once about given blocked squares.

A chain is an edge of the pathgraph (whose nodes are the junctions and ends of the skeleton), with its cells; a position
on it is the index of a cell, from 0 at its first.

# Strategy: a ray from one of those squares to the screen's edge is crossed by some chains. A closed path winds as often
as it crosses the ray, so the search runs on nodes times windings. Paths that never turn back on a chain are the classes
of loops; the shortest are found by A* with exact distances.
"""

from heapq import heappop, heappush
from itertools import count
from typing import NamedTuple

import numpy as np

from geometry.homotopy.landmarks import Anchor
from geometry.kernels.arrays import Bools, Ints
from geometry.routes.layer import Layer
from geometry.skeleton.chains import Chains

MAX_WINDINGS = 2  # windings in either direction through which a search may pass; convention


class Arc(NamedTuple):
    """A chain or a part of it, walked in one direction.

    Attributes
    ----------
    head : the number of the node to which it leads.
    length : in squares; of a part, in proportion to its cells.
    turns : crossings of the ray from east to west, minus those from west to east.
    chain : the number of the chain.
    begin : position on the chain at which it begins.
    end : position on the chain at which it ends.
    """

    head: int
    length: float
    turns: int
    chain: int
    begin: int
    end: int


Arcs = list[list[Arc]]


def closed_paths(layer: Layer, start: Anchor, around: Bools, wanted: int) -> list[list[Arc]]:
    """Return at most `wanted` shortest paths from an anchor back to it that wind once, counter-clockwise.

    Parameters
    ----------
    layer : the free space of a body of one radius: skeleton, pathgraph and strips.
    start : the anchor of the start, where the steepest ascent from it meets the pathgraph: a chain and the position of
        a cell on it, the node there (-1 inside a chain), and the cell.
    around : (rows, columns) bool, the blocked squares of one object, row 0 in the south; at least one.
    wanted : how many paths at most.

    Returns
    -------
    list of list of Arc
        The arcs of each path, in the order in which they are walked; shortest path first. An arc is a chain, or a part
        of one, walked in one direction: its chain, the positions at which it begins and ends, the node to which it
        leads, its length in squares. Empty when there is none.
    """
    arcs, origin = build_arcs(layer, start, ray_crossings(layer, around))
    to_origin = distances_to_origin(arcs, origin)
    order = count()
    heap: list[tuple[float, int, float, int, int, tuple[Arc, object] | None]] = []
    heappush(heap, (to_origin.get((origin, 1), np.inf), next(order), 0.0, origin, 1, None))
    found: list[list[Arc]] = []
    while heap and len(found) < wanted and heap[0][0] < np.inf:
        _, _, done, node, left, trail = heappop(heap)
        if node == origin and left == 0 and trail is not None:
            found.append(arcs_of_trail(trail))
        for arc in arcs[node]:
            if trail is not None and turns_back(trail[0], arc):
                continue
            rest = to_origin.get((arc.head, left - arc.turns), np.inf)
            if rest < np.inf:
                total = done + arc.length
                heappush(heap, (total + rest, next(order), total, arc.head, left - arc.turns, (arc, trail)))
    return found


def turns_back(last: Arc, arc: Arc) -> bool:
    """Return whether an arc is the last arc, the one walked just before, walked backwards."""
    return (arc.chain, arc.begin, arc.end) == (last.chain, last.end, last.begin)


def arcs_of_trail(trail: tuple[Arc, object] | None) -> list[Arc]:
    """Return the arcs of a trail, first to last; a trail is the last arc and the trail before it.

    An arc is a chain or a part of one, walked in one direction: node led to, length in squares, crossings of the ray,
    chain, and the positions at which it begins and ends.

    None is the trail without arcs, and gives an empty list.
    """
    path: list[Arc] = []
    while trail is not None:
        path.append(trail[0])
        trail = trail[1]  # type: ignore[assignment]
    return path[::-1]


def ray_crossings(layer: Layer, around: Bools) -> Ints:
    """Return for each chain cell how often its chain has crossed the ray up to there, (cells,) int32.

    The ray goes north from the last of the squares `around` (the eastern one of the northernmost row), between its
    column and the column to the west. Crossings from east to west count 1, those from west to east -1. The sum goes on
    from one chain to the next: only differences within a chain mean something. A chain is an edge of the pathgraph
    (whose nodes are the junctions and ends of the skeleton), with its cells.

    Parameters
    ----------
    layer : the free space of a body of one radius: skeleton, pathgraph and strips.
    around : (rows, columns) bool, row 0 in the south; at least one True.
    """
    width, cells = layer.square.shape[1], layer.chains.cells
    row, column = (int(v[-1]) for v in np.nonzero(around))
    y, x = cells // width - 1, cells % width - 1
    step = np.diff(x, prepend=x[:1])
    joint = np.zeros(len(cells), np.bool_)
    joint[layer.chains.start[:-1]] = True
    west = (step == -1) & (x == column - 1)
    east = (step == 1) & (x == column)
    passed = (west.astype(np.int32) - east.astype(np.int32)) * ((y > row) & ~joint)
    return np.cumsum(passed).astype(np.int32)


def build_arcs(layer: Layer, start: Anchor, crossings: Ints) -> tuple[Arcs, int]:
    """Return all arcs out of each node, and the start's node: a node of its own if the start lies inside a chain.

    That node's number is the number of the pathgraph's nodes; its chain is replaced by the two parts beside it.

    Parameters
    ----------
    layer : the free space of a body of one radius: skeleton, pathgraph and strips.
    start : the anchor of the start, where the steepest ascent from it meets the pathgraph: a chain and the position of
        a cell on it, the node there (-1 inside a chain), and the cell.
    crossings : (cells,) for each chain cell how often its chain has crossed the ray up to there, westwards less
        eastwards.

    Returns
    -------
    arcs : by node, the list of arcs that leave it, in the order of the chains; empty for a node without chains. A chain
        is in it once for each direction.
    origin : the number of the start's node.
    """
    chains, origin = layer.chains, start.node
    arcs: Arcs = [[] for _ in range(len(chains.node) + 1)]
    for chain, (a, b) in enumerate(chains.ends.tolist()):
        last = int(chains.start[chain + 1] - chains.start[chain] - 1)
        if start.node < 0 and chain == start.chain:
            origin = len(chains.node)
            add_arcs(arcs, layer, crossings, chain, (a, 0), (origin, start.position))
            add_arcs(arcs, layer, crossings, chain, (origin, start.position), (b, last))
        else:
            add_arcs(arcs, layer, crossings, chain, (a, 0), (b, last))
    return arcs, origin


def add_arcs(arcs: Arcs, layer: Layer, crossings: Ints, chain: int, one: tuple[int, int], two: tuple[int, int]) -> None:
    """Add a stretch of a chain to `arcs`, in both directions.

    A chain is an edge of the pathgraph (whose nodes are the junctions and ends of the skeleton), with its cells.

    Parameters
    ----------
    arcs : by node, the arcs that leave it; extended.
    layer : the free space of a body of one radius: skeleton, pathgraph and strips.
    crossings : (cells,) for each chain cell how often its chain has crossed the ray up to there, westwards less
        eastwards.
    chain : the number of the chain.
    one, two : the stretch's ends, each a node and its position on the chain; that of `one` is the lower.
    """
    first = int(layer.chains.start[chain])
    steps = int(layer.chains.start[chain + 1]) - first - 1
    length = float(layer.landmarks.length[chain]) * (two[1] - one[1]) / steps
    turns = int(crossings[first + two[1]] - crossings[first + one[1]])
    arcs[one[0]].append(Arc(two[0], length, turns, chain, one[1], two[1]))
    arcs[two[0]].append(Arc(one[0], length, -turns, chain, two[1], one[1]))


def distances_to_origin(arcs: Arcs, origin: int) -> dict[tuple[int, int], float]:
    """Return, by node and windings still to make, the length of the shortest path to the origin, in squares.

    Keys are (node, windings): how often the ray is still to be crossed from east to west, net, from -MAX_WINDINGS to
    MAX_WINDINGS. Where no path leads there is no key.

    Parameters
    ----------
    arcs : by node, the arcs that leave it; each has its reverse among them.
    origin : the number of the node to which paths lead.
    """
    best = {(origin, 0): 0.0}
    heap = [(0.0, origin, 0)]
    while heap:
        done, node, left = heappop(heap)
        if done > best[node, left]:
            continue
        for arc in arcs[node]:
            state = arc.head, left - arc.turns  # the arc reversed leads from its head here, with turns negated
            if abs(state[1]) <= MAX_WINDINGS and done + arc.length < best.get(state, np.inf):
                best[state] = done + arc.length
                heappush(heap, (done + arc.length, *state))
    return best


def cells_of_path(chains: Chains, path: list[Arc]) -> list[int]:
    """Return the padded cells of a path, from its origin back to it: indices in the flat padded grid.

    The first and the last cell are the same. An empty path gives an empty list. A cell's index is (row + 1) * width +
    column + 1, with width = columns + 2. A chain is an edge of the pathgraph (whose nodes are the junctions and ends of
    the skeleton), with its cells.

    Parameters
    ----------
    chains : the chains of the pathgraph.
    path : arcs (a chain, and the positions at which each begins and ends), in the order in which they are walked.
    """
    cells: list[int] = []
    for arc in path:
        first = int(chains.start[arc.chain])
        piece = chains.cells[first + min(arc.begin, arc.end) : first + max(arc.begin, arc.end) + 1].tolist()
        piece = piece if arc.begin <= arc.end else piece[::-1]
        cells += piece[1:] if cells else piece
    return cells
