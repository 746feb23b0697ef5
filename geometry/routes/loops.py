"""Loops: closed ways over the pathgraph that wind once about given blocked squares.

# Strategy: a ray from one of those squares to the screen's edge is crossed by some chains. A closed way winds as
often as it crosses the ray, so the search runs on nodes times windings. Ways that never turn back on a chain are
the classes of loops; the shortest are found by A* with exact distances.
"""

from heapq import heappop, heappush
from itertools import count
from typing import NamedTuple

import numpy as np

from geometry.homotopy.landmarks import Anchor
from geometry.kernels.arrays import Bools, Ints
from geometry.routes.layer import Layer
from geometry.skeleton.chains import Chains

WIDEST = 2  # windings either way that a search may pass through


class Arc(NamedTuple):
    """A way along a chain, whole or in part."""

    head: int
    length: float
    turns: int
    """Crossings of the ray from east to west."""
    chain: int
    begin: int
    end: int


Arcs = list[list[Arc]]


def closed_ways(layer: Layer, start: Anchor, around: Bools, wanted: int) -> list[list[Arc]]:
    """The shortest ways from an anchor back to it that wind once, counter-clockwise."""
    arcs, origin = split_graph(layer, start, turns_of_cells(layer, around))
    ahead = distances(arcs, origin)
    order = count()
    heap: list[tuple[float, int, float, int, int, tuple[Arc, object] | None]] = []
    heappush(heap, (ahead.get((origin, 1), np.inf), next(order), 0.0, origin, 1, None))
    found: list[list[Arc]] = []
    while heap and len(found) < wanted and heap[0][0] < np.inf:
        _, _, done, node, left, trail = heappop(heap)
        if node == origin and left == 0 and trail is not None:
            found.append(unroll(trail))
        for arc in arcs[node]:
            if trail is not None and turns_back(trail[0], arc):
                continue
            rest = ahead.get((arc.head, left - arc.turns), np.inf)
            if rest < np.inf:
                total = done + arc.length
                heappush(heap, (total + rest, next(order), total, arc.head, left - arc.turns, (arc, trail)))
    return found


def turns_back(last: Arc, arc: Arc) -> bool:
    """Whether an arc is the last one walked backwards."""
    return (arc.chain, arc.begin, arc.end) == (last.chain, last.end, last.begin)


def unroll(trail: tuple[Arc, object] | None) -> list[Arc]:
    """The arcs of a trail, first to last."""
    way: list[Arc] = []
    while trail is not None:
        way.append(trail[0])
        trail = trail[1]  # type: ignore[assignment]
    return way[::-1]


def turns_of_cells(layer: Layer, around: Bools) -> Ints:
    """Per chain cell, how often the chain has crossed the ray up to there."""
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


def split_graph(layer: Layer, start: Anchor, turned: Ints) -> tuple[Arcs, int]:
    """All arcs out of each node, with the start as a node of its own if it lies inside a chain."""
    chains, origin = layer.chains, start.node
    arcs: Arcs = [[] for _ in range(len(chains.node) + 1)]
    for chain, (a, b) in enumerate(chains.ends.tolist()):
        last = int(chains.start[chain + 1] - chains.start[chain] - 1)
        if start.node < 0 and chain == start.chain:
            origin = len(chains.node)
            add_both(arcs, layer, turned, chain, (a, 0), (origin, start.position))
            add_both(arcs, layer, turned, chain, (origin, start.position), (b, last))
        else:
            add_both(arcs, layer, turned, chain, (a, 0), (b, last))
    return arcs, origin


def add_both(arcs: Arcs, layer: Layer, turned: Ints, chain: int, one: tuple[int, int], two: tuple[int, int]) -> None:
    """Add a stretch of a chain in both directions; an end is a node and its position."""
    first = int(layer.chains.start[chain])
    steps = int(layer.chains.start[chain + 1]) - first - 1
    length = float(layer.ways.length[chain]) * (two[1] - one[1]) / steps
    turns = int(turned[first + two[1]] - turned[first + one[1]])
    arcs[one[0]].append(Arc(two[0], length, turns, chain, one[1], two[1]))
    arcs[two[0]].append(Arc(one[0], length, -turns, chain, two[1], one[1]))


def distances(arcs: Arcs, origin: int) -> dict[tuple[int, int], float]:
    """By node and the turns still to make: the length of the shortest way to the origin."""
    best = {(origin, 0): 0.0}
    heap = [(0.0, origin, 0)]
    while heap:
        done, node, left = heappop(heap)
        if done > best[node, left]:
            continue
        for arc in arcs[node]:
            state = arc.head, left - arc.turns  # the arc reversed leads from its head here, with turns negated
            if abs(state[1]) <= WIDEST and done + arc.length < best.get(state, np.inf):
                best[state] = done + arc.length
                heappush(heap, (done + arc.length, *state))
    return best


def cells_of_way(chains: Chains, way: list[Arc]) -> list[int]:
    """The cells of a way, from its origin back to it."""
    cells: list[int] = []
    for arc in way:
        first = int(chains.start[arc.chain])
        piece = chains.cells[first + min(arc.begin, arc.end) : first + max(arc.begin, arc.end) + 1].tolist()
        piece = piece if arc.begin <= arc.end else piece[::-1]
        cells += piece[1:] if cells else piece
    return cells
