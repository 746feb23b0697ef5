"""The k shortest ways over the pathgraph without a repeated node.

# Strategy: Yen (1971) with Lawler's (1972) partition: every way found is the best of a set of ways, and each
further one leaves one already taken at an arc not used there. Arcs, not nodes, tell ways apart, for two chains may
join the same two nodes. Exact distances to the goal guide each search and dismiss those that cannot do better than
the ways in hand.
"""

from typing import NamedTuple

import numpy as np

from geometry.homotopy.landmarks import Landmarks
from geometry.kernels.arrays import Floats, Ints
from geometry.kernels.jit import bare
from geometry.routes.astar import RouteQuery, Search, seek, survey

MANY = 2000  # chains from which on distances to the goal are first sought close about the shortest way alone


class PathStore(NamedTuple):
    """Landmarks found: those taken come first, shortest first, then those in hand, shortest first."""

    place: Ints
    """(room,) in which row of the others each way stands."""
    cost: Floats
    """(room,) its length."""
    arcs: Ints
    """(room, longest) arcs, from start to goal."""
    size: Ints
    """(room,) number of arcs."""
    fork: Ints
    """(room,) where it leaves the way it comes from."""
    shared: Ints
    """(room,) how many first arcs it has in common with the way that is being varied."""


def new_album(room: int, longest: int) -> PathStore:
    """Room for some ways of at most ``longest`` arcs."""
    place, size, fork, shared = (np.empty(room, np.int32) for _ in range(4))
    return PathStore(place, np.empty(room), np.empty((room, longest), np.int32), size, fork, shared)


@bare
def shortest_ways(ends: Ints, ways: Landmarks, query: RouteQuery, search: Search, album: PathStore, wanted: int) -> int:
    """Fill the album with up to ``wanted`` shortest ways; returns their number. ``ends`` are those of the chains."""
    n = ways.head.shape[0]
    search.stamp[1] = 0
    search.stamp[0] += 1
    if not seek(ways, query, search, n):
        return 0
    album.place[0], album.fork[0], album.cost[0] = 0, 0, search.best[n + 1]
    record(ends, query.joint, search.came, album.arcs, album.size, 0, 0, n)
    if wanted == 1:
        return 1
    limit = (1.5 if ends.shape[0] < MANY else 1.1) * album.cost[0] + 1.0
    while True:
        survey(ways, query, search, limit)
        taken, have = 0, 1
        while taken < have and taken < wanted:
            taken += 1
            if taken < wanted:
                have = branch(ends, ways, query, search, album, taken - 1, have, wanted)
        if limit == np.inf or (taken == wanted and album.cost[taken - 1] <= limit):
            return taken
        limit = np.inf  # ways beyond the survey's limit may be missing


@bare
def branch(
    ends: Ints, ways: Landmarks, query: RouteQuery, search: Search, album: PathStore, way: int, have: int, wanted: int
) -> int:
    """Put the best ways that leave a taken way, at each of its arcs from its fork on; returns how many there are."""
    joint, extra, length = query.joint, query.cost, ways.length
    path, barred, sealed, stamps = search.path, search.barred, search.sealed, search.stamp
    best, came = search.best, search.came
    place, cost, arcs, size, fork, shared = album
    n, first, row = ways.head.shape[0], 2 * ends.shape[0], 0 + place[way]
    walk(ends, joint, arcs, size, row, n, path)
    for other in range(way + 1):
        shared[other] = in_common(arcs, size, row, 0 + place[other])
    so_far = 0.0
    for k in range(size[row]):
        origin, code = 0 + path[k], 0 + arcs[row, k]
        if k >= fork[row]:
            stamps[0] += 1
            stamp = stamps[0]
            for other in range(way + 1):
                if shared[other] >= k and size[place[other]] > k:
                    sealed[arcs[place[other], k]] = stamp
            for j in range(k + 1):
                barred[path[j]] = stamp
            limit = cost[wanted - 1] if have >= wanted else np.inf
            if so_far + promise(ways, query, search, origin) < limit and seek(ways, query, search, origin):
                total = so_far + best[n + 1]
                if total < limit:
                    new = insert(place, cost, way, have, wanted, total)
                    for j in range(k):
                        arcs[new, j] = arcs[row, j]
                    fork[new] = k
                    record(ends, joint, came, arcs, size, new, k, origin)
                    have = have + 1 if have < wanted else have
        so_far += length[code >> 1] if code < first else extra[code - first]
    return have


@bare
def walk(ends: Ints, joint: Ints, arcs: Ints, size: Ints, row: int, start: int, path: Ints) -> None:
    """Write the node that each arc of a way comes from."""
    path[0] = start
    for k in range(size[row] - 1):
        extra = arcs[row, k] - 2 * ends.shape[0]
        path[k + 1] = ends[arcs[row, k] >> 1, 1 - (arcs[row, k] & 1)] if extra < 0 else joint[extra]


@bare
def in_common(arcs: Ints, size: Ints, row: int, other: int) -> int:
    """How many first arcs two ways have in common."""
    k = 0
    while k < size[row] and k < size[other] and arcs[row, k] == arcs[other, k]:
        k += 1
    return k


@bare
def promise(ways: Landmarks, query: RouteQuery, search: Search, origin: int) -> float:
    """The least that a way from a node over an unsealed arc can cost."""
    arc, head, step = ways.arc, ways.head, ways.step
    joint, extra, shut = query.joint, query.cost, query.shut
    sealed, barred, ahead, stamp = search.sealed, search.barred, search.ahead, search.stamp[0]
    n, arcs, least = head.shape[0], 2 * shut.shape[0], np.inf
    if origin == n:
        for k in range(2):
            if sealed[arcs + k] != stamp and extra[k] < np.inf and extra[k] + ahead[joint[k]] < least:
                least = extra[k] + ahead[joint[k]]
        return extra[4] if sealed[arcs + 4] != stamp and extra[4] < least else least
    for slot in range(4):
        to, code = head[origin, slot], arc[origin, slot]
        if to >= 0 and barred[to] != stamp and not shut[code >> 1] and sealed[code] != stamp:
            rest = step[origin, slot] + ahead[to]
            least = rest if rest < least else least
    for k in range(2, 4):
        if joint[k] == origin and sealed[arcs + k] != stamp and extra[k] < least:
            least = extra[k]
    return least


@bare
def insert(place: Ints, cost: Floats, way: int, have: int, wanted: int, total: float) -> int:
    """Make room for a way among those in hand; returns the row where its arcs belong."""
    at = have if have < wanted else wanted - 1
    row = have if have < wanted else 0 + place[at]
    while at > way + 1 and cost[at - 1] > total:
        place[at], cost[at] = place[at - 1], cost[at - 1]
        at -= 1
    place[at], cost[at] = row, total
    return row


@bare
def record(ends: Ints, joint: Ints, came: Ints, arcs: Ints, size: Ints, row: int, fork: int, origin: int) -> None:
    """Write the way just found from a node on behind its first ``fork`` arcs."""
    first, goal = 2 * ends.shape[0], came.shape[0] - 1
    k, node = fork, goal
    while node != origin:
        node = tail(ends, joint, first, goal, 0 + came[node])
        k += 1
    size[row], node = k, goal
    while node != origin:
        k -= 1
        arcs[row, k] = came[node]
        node = tail(ends, joint, first, goal, 0 + came[node])


@bare
def tail(ends: Ints, joint: Ints, first: int, goal: int, code: int) -> int:
    """The node an arc comes from."""
    if code < first:
        return int(ends[code >> 1, code & 1])
    return int(joint[code - first]) if code - first in (2, 3) else goal - 1
