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
from geometry.heap import pop, push
from geometry.skeleton import States
from geometry.ways import Ways

Bools = NDArray[np.bool_]


class Query(NamedTuple):
    """What one question adds to the pathgraph."""

    joint: Ints
    """(4,) the nodes that the start's two arcs lead to and the goal's two come from."""
    cost: Floats
    """(5,) the lengths of the five arcs; infinite where there is none."""
    sight: Floats
    """(landmarks,) the goal's distances from the landmarks."""
    line: Floats
    """(4,) a point of the straight line from start to goal and the line's normal, scaled: how much dearer an arc is."""
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
    """A* from a node to the goal, under the stamp's bars and seals; the way is then in ``came``.

    One loop without calls that pass many arrays: each would cost more than the arc it serves.
    """
    leave, ends, length, shut = chains.leave, chains.ends, ways.length, query.shut
    best, came, seen, barred = search.best, search.came, search.seen, search.barred
    n, arcs, stamp, exact = leave.shape[0], 2 * length.shape[0], search.stamp[0], search.stamp[1] != 0
    best[origin], came[origin], seen[origin] = 0.0, -1, stamp
    place, line, bowed = ways.place, query.line, query.line[2] != 0.0 or query.line[3] != 0.0
    node, size = origin, 0
    while node != n + 1:
        for slot in range(6):
            if node == n:
                code = arcs + (0 if slot == 0 else 1 if slot == 1 else 4)
                if slot > 2:
                    break
            elif slot < 4:
                chain = leave[node, slot]
                if chain < 0 or shut[chain] or ends[chain, 0] == ends[chain, 1]:
                    continue
                code = 2 * chain if ends[chain, 0] == node else 2 * chain + 1
            else:
                code = arcs + slot - 2
                if query.joint[slot - 2] != node:
                    continue
            if node == origin and search.sealed[code] == stamp:
                continue
            head, cost = n + 1, 0.0
            if code < arcs:
                head, cost = ends[code >> 1, 1 - (code & 1)], length[code >> 1]
            else:
                cost = query.cost[code - arcs]
                if code < arcs + 2:
                    head = query.joint[code - arcs]
            if (
                head < n and bowed
            ):  # among ways of one length, the one nearest to the straight line is shortest when tight
                off = (place[head, 0] - line[0]) * line[2] + (place[head, 1] - line[1]) * line[3]
                cost *= 1.0 + abs(off)
            total = best[node] + cost
            if total == np.inf or barred[head] == stamp or (seen[head] == stamp and best[head] <= total):
                continue
            if head < n and query.closed[head]:
                continue
            best[head], came[head], seen[head] = total, code, stamp
            rest = 0.0
            if head < n:
                rest = search.ahead[head] if exact else bound(ways.sight, query.sight, head)
            if rest < np.inf:
                size = push(search.key, search.node, size, total + rest, head)
        while size > 0 and (node == origin or barred[node] == stamp):
            node, size = pop(search.key, search.node, size)
            if barred[node] != stamp:
                break
        else:
            return False
        if node < n:
            barred[node] = stamp  # done with: its way is the shortest
    return True


@compiled
def bound(sight: Floats, goal: Floats, node: int) -> float:
    """A lower bound of the way from a node to the goal by the triangle inequality over the landmarks."""
    least = 0.0
    for k in range(goal.shape[0]):
        if sight[node, k] != goal[k]:  # not both infinite
            least = max(least, abs(sight[node, k] - goal[k]))
    return least


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
def survey(chains: Chains, ways: Ways, query: Query, search: Search, limit: float) -> None:
    """Fill ``ahead`` with the exact distances to the goal as far as a limit: Dijkstra, backwards."""
    leave, ends, length, ahead = chains.leave, chains.ends, ways.length, search.ahead
    n = leave.shape[0]
    ahead[:] = np.inf
    size = 0
    for k in (2, 3):
        node = query.joint[k]
        if query.cost[k] < np.inf and query.cost[k] < ahead[node] and not query.closed[node]:
            ahead[node] = query.cost[k]
            size = push(search.key, search.node, size, query.cost[k], node)
    while size > 0:
        key = search.key[0]
        node, size = pop(search.key, search.node, size)
        if key > limit:
            break
        if key > ahead[node]:
            continue
        for direction in range(4):
            chain = leave[node, direction]
            if chain < 0 or query.shut[chain]:
                continue
            other = ends[chain, 0] if ends[chain, 1] == node else ends[chain, 1]
            total = key + length[chain]
            if total < ahead[other] and not query.closed[other]:
                ahead[other] = total
                size = push(search.key, search.node, size, total, other)
    ahead[n + 1] = 0.0
    ahead[n] = query.cost[4]
    for k in (0, 1):
        if query.cost[k] < np.inf:
            ahead[n] = min(ahead[n], query.cost[k] + ahead[query.joint[k]])
    search.stamp[1] = 1
