"""Shortest ways over the pathgraph: A*, and exact distances to the goal.

A query adds two nodes to the n of the pathgraph: the start (n) and the goal (n + 1). An arc is coded as 2 chain + 1
when walked backwards, 2 chain when forwards; with m chains, 2m and 2m + 1 lead from the start to the ends of its
chain, 2m + 2 and 2m + 3 from the ends of the goal's chain to the goal, and 2m + 4 from the start to the goal along
a chain they share.
"""

from typing import NamedTuple

import numpy as np

from geometry.homotopy.landmarks import Landmarks
from geometry.kernels.arrays import Floats, Ints
from geometry.kernels.heap import pop, push
from geometry.kernels.jit import bare
from geometry.skeleton.skeleton import States

EAGER = 1.05  # times the bound, where arcs are made dearer anyway: a third of the time on random squares, as good ways


class RouteQuery(NamedTuple):
    """What one question adds to the pathgraph."""

    joint: Ints
    """(4,) the nodes that the start's two arcs lead to and the goal's two come from."""
    cost: Floats
    """(5,) the lengths of the five arcs; infinite where there is none."""
    sight: Floats
    """(2, landmarks) the goal's distances from the landmarks, and the start's."""
    line: Floats
    """(4,) a point of the straight line from start to goal and the line's normal, scaled: how much dearer an arc is."""
    shut: States
    """(m,) not 0 for chains that may not be walked from end to end: bit 0 by wish, bit 1 because an end splits them."""
    bars: Ints
    """(b, 2) chain and position of the steps that may not be taken: each from that position to the next one."""


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
    path: Ints
    """(n + 2,) the nodes of the way that is being varied."""
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
        np.empty(nodes + 2, np.int32),
        np.empty(2 * chains + 8),
        np.empty(2 * chains + 8, np.int32),
        np.zeros(2, np.int32),
    )


@bare
def seek(ways: Landmarks, query: RouteQuery, search: Search, origin: int) -> bool:
    """A* from a node to the goal, under the stamp's bars and seals; the way is then in ``came``.

    The shortest way, unless the query's line makes arcs dearer: then one at most EAGER times as dear as the cheapest.

    One loop without calls that pass many arrays, all of them local names: taking an array out of a tuple, or handing
    it on, costs more than the arc it serves.
    """
    arc, head, step, place, sight = ways.arc, ways.head, ways.step, ways.place, ways.sight
    joint, extra, line, goal = query.joint, query.cost, query.line, query.sight
    shut = query.shut
    best, came, seen, barred, sealed = search.best, search.came, search.seen, search.barred, search.sealed
    ahead, key, spot = search.ahead, search.key, search.node
    n, arcs, stamp, exact = head.shape[0], 2 * shut.shape[0], search.stamp[0], search.stamp[1] != 0
    bowed = line[2] != 0.0 or line[3] != 0.0
    eager = EAGER if bowed else 1.0
    best[origin], came[origin], seen[origin] = 0.0, -1, stamp
    node, size = origin, 0
    while node != n + 1:
        for slot in range(6):
            if node == n:
                if slot > 2:
                    break
                to = n + 1 if slot == 2 else 0 + joint[slot]
                code = arcs + (4 if slot == 2 else slot)
                cost = extra[code - arcs]
            elif slot < 4:
                to, code, cost = 0 + head[node, slot], 0 + arc[node, slot], step[node, slot]
                if to < 0 or shut[code >> 1]:
                    continue
            else:
                to, code, cost = n + 1, arcs + slot - 2, extra[slot - 2]
                if joint[slot - 2] != node:
                    continue
            if node == origin and sealed[code] == stamp:
                continue
            if (
                to < n and bowed
            ):  # among ways of one length, the one nearest to the straight line is shortest when tight
                cost *= 1.0 + abs((place[to, 0] - line[0]) * line[2] + (place[to, 1] - line[1]) * line[3])
            total = best[node] + cost
            if total == np.inf or barred[to] == stamp or (seen[to] == stamp and best[to] <= total):
                continue
            best[to], came[to], seen[to] = total, code, stamp
            rest = 0.0
            if to < n:
                rest = ahead[to] if exact else eager * bound(sight, goal, 0, to)
            if rest < np.inf:
                size = push(key, spot, size, total + rest, to)
        while size > 0 and (node == origin or barred[node] == stamp):
            node, size = pop(key, spot, size)
            if barred[node] != stamp:
                break
        else:
            return False
        if node < n:
            barred[node] = stamp  # done with: its way is the shortest
    return True


@bare
def bound(sight: Floats, ends: Floats, end: int, node: int) -> float:
    """A lower bound of the way from a node to the goal (end 0) or the start (1), by the landmarks' triangles."""
    least = 0.0
    for k in range(sight.shape[1]):
        if sight[node, k] != ends[end, k]:  # not both infinite
            gap = abs(sight[node, k] - ends[end, k])
            least = gap if gap > least else least
    return least


@bare
def survey(ways: Landmarks, query: RouteQuery, search: Search, limit: float) -> None:
    """Fill ``ahead`` with the exact distances to the goal: Dijkstra, backwards.

    Nodes that no way up to the limit can pass are left out.
    """
    arc, head, step, sight = ways.arc, ways.head, ways.step, ways.sight
    joint, cost, ends, shut = query.joint, query.cost, query.sight, query.shut
    ahead, key, spot = search.ahead, search.key, search.node
    n, size = head.shape[0], 0
    for k in range(n + 2):
        ahead[k] = np.inf
    for k in range(2, 4):
        if cost[k] < np.inf and cost[k] < ahead[joint[k]]:
            ahead[joint[k]] = cost[k]
            size = push(key, spot, size, cost[k], 0 + joint[k])
    while size > 0:
        done = key[0]
        node, size = pop(key, spot, size)
        if done > ahead[node]:
            continue
        for slot in range(4):
            other = 0 + head[node, slot]
            if other < 0 or shut[arc[node, slot] >> 1]:
                continue
            total = done + step[node, slot]
            if total < ahead[other] and total + bound(sight, ends, 1, other) <= limit:
                ahead[other] = total
                size = push(key, spot, size, total, other)
    ahead[n + 1] = 0.0
    ahead[n] = cost[4]
    for k in range(2):
        if cost[k] < np.inf and cost[k] + ahead[joint[k]] < ahead[n]:
            ahead[n] = cost[k] + ahead[joint[k]]
    search.stamp[1] = 1
