"""Shortest ways over the pathgraph: A* and the k shortest ways without a repeated node.

A query adds two nodes to the n of the pathgraph: the start (n) and the goal (n + 1). An arc is coded as 2 chain + 1
when walked backwards, 2 chain when forwards; with m chains, 2m and 2m + 1 lead from the start to the ends of its
chain, 2m + 2 and 2m + 3 from the ends of the goal's chain to the goal, and 2m + 4 from the start to the goal along
a chain they share.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from geometry.chains import Chains, Floats, Ints
from geometry.compiled import compiled
from geometry.rope import reach
from geometry.skeleton import States
from geometry.ways import Ways

Bools = NDArray[np.bool_]


class Query(NamedTuple):
    """What one question adds to the pathgraph."""

    joint: Ints
    """(4,) the nodes that the start's two arcs lead to and the goal's two come from."""
    cost: Floats
    """(5,) the lengths of the five arcs; infinite where there is none."""
    goal: Floats
    """(2,) the goal's place."""
    shut: States
    """(m,) not 0 for chains that may not be walked from end to end: bit 0 by wish, bit 1 because an end splits them."""
    bars: Ints
    """(b, 2) chain and position of the places that may not be passed."""
    closed: Bools
    """(n,) nodes that may not be entered."""


class Search(NamedTuple):
    """Scratch of a search. An entry counts only if its mark equals the current stamp."""

    best: Floats
    """(n + 2,) the shortest way found so far."""
    came: Ints
    """(n + 2,) the arc by which it came."""
    seen: Ints
    """(n + 2,) mark of ``best`` and ``came``."""
    barred: Ints
    """(n + 2,) mark of nodes that the present search must not enter."""
    sealed: Ints
    """(2m + 5,) mark of arcs that the present search must not use from its origin."""
    ahead: Floats
    """(n + 2,) exact distance to the goal, when ``known``."""
    key: Floats
    """(2m + 8,) heap of promising nodes."""
    node: Ints
    """(2m + 8,)"""
    stamp: Ints
    """(2,) the current stamp; whether ``ahead`` is filled."""


def new_search(nodes: int, chains: int) -> Search:
    """Scratch for a pathgraph of that size."""
    return Search(
        np.empty(nodes + 2),
        np.empty(nodes + 2, np.int32),
        np.zeros(nodes + 2, np.int32),
        np.zeros(nodes + 2, np.int32),
        np.zeros(2 * chains + 5, np.int32),
        np.empty(nodes + 2),
        np.empty(2 * chains + 8),
        np.empty(2 * chains + 8, np.int32),
        np.zeros(2, np.int32),
    )


@compiled
def fresh(search: Search) -> int:
    """Begin a new search: all marks of earlier ones become void."""
    search.stamp[0] += 1
    return int(search.stamp[0])


@compiled
def seek(chains: Chains, ways: Ways, query: Query, search: Search, origin: int) -> bool:
    """A* from a node to the goal, under the stamp's bars and seals; the way is then in ``came``."""
    n, stamp = chains.node.shape[0], search.stamp[0]
    search.best[origin] = 0.0
    search.came[origin] = -1
    search.seen[origin] = stamp
    size = 0
    if origin == n:
        for k in (0, 1, 4):
            size = try_arc(chains, ways, query, search, origin, 2 * ways.length.shape[0] + k, origin, size)
    else:
        size = expand(chains, ways, query, search, origin, origin, size)
    while size > 0:
        node, size = pop(search, size)
        if node == n + 1:
            return True
        if search.barred[node] == stamp:
            continue
        search.barred[node] = stamp  # done with: its way is the shortest
        size = expand(chains, ways, query, search, node, origin, size)
    return False


@compiled
def expand(chains: Chains, ways: Ways, query: Query, search: Search, node: int, origin: int, size: int) -> int:
    """Try all arcs out of a pathgraph node; returns the heap's size."""
    for direction in range(4):
        chain = chains.leave[node, direction]
        if chain >= 0 and not query.shut[chain] and chains.ends[chain, 0] != chains.ends[chain, 1]:
            code = 2 * chain if chains.ends[chain, 0] == node else 2 * chain + 1
            size = try_arc(chains, ways, query, search, node, code, origin, size)
    for k in (2, 3):
        if query.joint[k] == node:
            size = try_arc(chains, ways, query, search, node, 2 * ways.length.shape[0] + k, origin, size)
    return size


@compiled
def try_arc(
    chains: Chains, ways: Ways, query: Query, search: Search, node: int, code: int, origin: int, size: int
) -> int:
    """Relax one arc; returns the heap's size."""
    stamp = search.stamp[0]
    if node == origin and search.sealed[code] == stamp:
        return size
    head = head_of(chains, query, code)
    total = search.best[node] + arc_cost(ways, query, code)
    if total == np.inf or search.barred[head] == stamp or (search.seen[head] == stamp and search.best[head] <= total):
        return size
    if head < chains.node.shape[0] and query.closed[head]:
        return size
    search.best[head] = total
    search.came[head] = code
    search.seen[head] = stamp
    return push(search, size, total + remaining(ways, query, search, head), head)


@compiled
def remaining(ways: Ways, query: Query, search: Search, node: int) -> float:
    """A lower bound of the way from a node to the goal: exact when known, else the straight line."""
    if node >= ways.place.shape[0]:
        return 0.0
    if search.stamp[1]:
        return float(search.ahead[node])
    return reach(ways.place[node, 0] - query.goal[0], ways.place[node, 1] - query.goal[1])


@compiled
def arc_cost(ways: Ways, query: Query, code: int) -> float:
    """The length of an arc."""
    arcs = 2 * ways.length.shape[0]
    return float(ways.length[code >> 1] if code < arcs else query.cost[code - arcs])


@compiled
def head_of(chains: Chains, query: Query, code: int) -> int:
    """The node an arc leads to."""
    extra = code - 2 * chains.ends.shape[0]
    if extra < 0:
        return int(chains.ends[code >> 1, 1 - (code & 1)])
    return int(query.joint[extra]) if extra < 2 else chains.node.shape[0] + 1


@compiled
def tail_of(chains: Chains, query: Query, code: int) -> int:
    """The node an arc comes from."""
    extra = code - 2 * chains.ends.shape[0]
    if extra < 0:
        return int(chains.ends[code >> 1, code & 1])
    return int(query.joint[extra]) if extra in (2, 3) else chains.node.shape[0]


@compiled
def survey(chains: Chains, ways: Ways, query: Query, search: Search) -> None:
    """Fill ``ahead`` with the exact distances to the goal: Dijkstra, backwards."""
    n = chains.node.shape[0]
    search.ahead[:] = np.inf
    size = 0
    for k in (2, 3):
        node = query.joint[k]
        if query.cost[k] < np.inf and query.cost[k] < search.ahead[node] and not query.closed[node]:
            search.ahead[node] = query.cost[k]
            size = push(search, size, query.cost[k], node)
    while size > 0:
        key = search.key[0]
        node, size = pop(search, size)
        if key > search.ahead[node]:
            continue
        for direction in range(4):
            chain = chains.leave[node, direction]
            if chain < 0 or query.shut[chain]:
                continue
            other = chains.ends[chain, 0] if chains.ends[chain, 1] == node else chains.ends[chain, 1]
            total = key + ways.length[chain]
            if total < search.ahead[other] and not query.closed[other]:
                search.ahead[other] = total
                size = push(search, size, total, other)
    search.ahead[n + 1] = 0.0
    search.ahead[n] = query.cost[4]
    for k in (0, 1):
        if query.cost[k] < np.inf:
            search.ahead[n] = min(search.ahead[n], query.cost[k] + search.ahead[query.joint[k]])
    search.stamp[1] = 1


@compiled
def push(search: Search, size: int, key: float, node: int) -> int:
    """Put a node on the heap; returns the heap's size."""
    k = size
    while k > 0:
        parent = (k - 1) >> 1
        if search.key[parent] <= key:
            break
        search.key[k], search.node[k] = search.key[parent], search.node[parent]
        k = parent
    search.key[k], search.node[k] = key, node
    return size + 1


@compiled
def pop(search: Search, size: int) -> tuple[int, int]:
    """Take the most promising node; returns it and the heap's size."""
    top = search.node[0]
    size -= 1
    key, node = search.key[size], search.node[size]
    k = 0
    while 2 * k + 1 < size:
        child = 2 * k + 1
        if child + 1 < size and search.key[child + 1] < search.key[child]:
            child += 1
        if search.key[child] >= key:
            break
        search.key[k], search.node[k] = search.key[child], search.node[child]
        k = child
    search.key[k], search.node[k] = key, node
    return top, size
