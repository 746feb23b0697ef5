"""The k shortest ways over the pathgraph without a repeated node.

# Strategy: Yen (1971) with Lawler's (1972) partition: every way found is the best of a set of ways, and each
further one leaves one already taken at an arc not used there. Arcs, not nodes, tell ways apart, for two chains may
join the same two nodes. Exact distances to the goal guide each search and dismiss those that cannot do better than
the ways in hand.
"""

from typing import NamedTuple

import numpy as np

from geometry.chains import Chains, Floats, Ints
from geometry.compiled import compiled
from geometry.search import Query, Search, arc_cost, fresh, head_of, seek, survey, tail_of
from geometry.ways import Ways


class Album(NamedTuple):
    """Ways found: those taken come first, shortest first, then those in hand, shortest first."""

    arcs: Ints
    """(room, longest) arcs of each way, from start to goal."""
    size: Ints
    """(room,) number of arcs of each."""
    fork: Ints
    """(room,) where each leaves the way it comes from."""
    cost: Floats
    """(room,) length of each."""


def new_album(room: int, longest: int) -> Album:
    """Room for some ways of at most ``longest`` arcs."""
    return Album(
        np.empty((room, longest), np.int32), np.empty(room, np.int32), np.empty(room, np.int32), np.empty(room)
    )


@compiled
def shortest_ways(chains: Chains, ways: Ways, query: Query, search: Search, album: Album, wanted: int) -> int:
    """Fill the album with up to ``wanted`` shortest ways; returns their number. Its room must exceed ``wanted``."""
    search.stamp[1] = 0
    fresh(search)
    start = chains.node.shape[0]
    if not seek(chains, ways, query, search, start):
        return 0
    record(chains, ways, query, search, album, 0, 0, start, 0.0)
    if wanted == 1:
        return 1
    limit = 1.5 * album.cost[0] + 1.0
    survey(chains, ways, query, search, limit)
    found = fan_out(chains, ways, query, search, album, wanted)
    if found < wanted or album.cost[found - 1] > limit:  # ways beyond the survey's limit may be missing
        survey(chains, ways, query, search, np.inf)
        found = fan_out(chains, ways, query, search, album, wanted)
    return found


@compiled
def fan_out(chains: Chains, ways: Ways, query: Query, search: Search, album: Album, wanted: int) -> int:
    """Branch off the ways taken, shortest first, until there are enough."""
    have, taken = 1, 1
    while taken < wanted:
        have = branch(chains, ways, query, search, album, taken - 1, have, wanted)
        if have == taken:
            break
        taken += 1
    return taken


@compiled
def branch(
    chains: Chains, ways: Ways, query: Query, search: Search, album: Album, way: int, have: int, wanted: int
) -> int:
    """Put the best ways that leave a taken way, at each of its arcs from its fork on; returns how many there are."""
    so_far = 0.0
    for k in range(album.size[way]):
        origin = tail_of(chains, query, album.arcs[way, k])
        if k >= album.fork[way]:
            limit = album.cost[wanted - 1] if have >= wanted else np.inf
            stamp = fresh(search)
            seal(album, way, k, search, stamp)
            if so_far + promise(chains, ways, query, search, origin) < limit:
                for j in range(k):
                    search.barred[tail_of(chains, query, album.arcs[way, j])] = stamp
                search.barred[origin] = stamp
                if seek(chains, ways, query, search, origin):
                    have = insert(chains, ways, query, search, album, way, k, origin, so_far, have, wanted)
        so_far += arc_cost(ways, query, album.arcs[way, k])
    return have


@compiled
def seal(album: Album, way: int, k: int, search: Search, stamp: int) -> None:
    """Seal the arcs by which taken ways with the same beginning go on."""
    for other in range(way + 1):
        if album.size[other] > k and same_beginning(album, way, other, k):
            search.sealed[album.arcs[other, k]] = stamp


@compiled
def same_beginning(album: Album, way: int, other: int, size: int) -> bool:
    """Whether two ways agree in their first arcs."""
    k = size - 1
    while k >= 0 and album.arcs[way, k] == album.arcs[other, k]:
        k -= 1
    return k < 0


@compiled
def promise(chains: Chains, ways: Ways, query: Query, search: Search, origin: int) -> float:
    """The least that a way from a node over an unsealed arc can cost."""
    stamp, best, first = search.stamp[0], np.inf, 2 * chains.ends.shape[0]
    if origin == chains.node.shape[0]:
        for k in (0, 1, 4):
            if search.sealed[first + k] != stamp and query.cost[k] < np.inf:
                best = min(best, query.cost[k] + search.ahead[head_of(chains, query, first + k)])
        return best
    for direction in range(4):
        chain = chains.leave[origin, direction]
        if chain >= 0 and not query.shut[chain]:
            code = 2 * chain if chains.ends[chain, 0] == origin else 2 * chain + 1
            if search.sealed[code] != stamp:
                best = min(best, ways.length[chain] + search.ahead[head_of(chains, query, code)])
    for k in (2, 3):
        if query.joint[k] == origin and search.sealed[first + k] != stamp:
            best = min(best, query.cost[k])
    return best


@compiled
def insert(
    chains: Chains,
    ways: Ways,
    query: Query,
    search: Search,
    album: Album,
    way: int,
    fork: int,
    origin: int,
    so_far: float,
    have: int,
    wanted: int,
) -> int:
    """Keep the way just found among those in hand, in its place; returns how many ways there are."""
    goal = chains.node.shape[0] + 1
    total = so_far + search.best[goal]
    last = min(have, wanted - 1)
    if have >= wanted and total >= album.cost[wanted - 1]:
        return have
    place = last
    while place > way + 1 and album.cost[place - 1] > total:
        album.arcs[place, : album.size[place - 1]] = album.arcs[place - 1, : album.size[place - 1]]
        album.size[place], album.fork[place] = album.size[place - 1], album.fork[place - 1]
        album.cost[place] = album.cost[place - 1]
        place -= 1
    album.arcs[place, :fork] = album.arcs[way, :fork]
    record(chains, ways, query, search, album, place, fork, origin, so_far)
    return min(have + 1, wanted)


@compiled
def record(
    chains: Chains,
    ways: Ways,
    query: Query,
    search: Search,
    album: Album,
    place: int,
    fork: int,
    origin: int,
    so_far: float,
) -> None:
    """Write the way just found behind its first ``fork`` arcs."""
    goal = chains.node.shape[0] + 1
    size, node = fork, goal
    while node != origin:
        node = tail_of(chains, query, search.came[node])
        size += 1
    album.size[place], album.fork[place] = size, fork
    album.cost[place] = so_far + search.best[goal]
    node = goal
    for k in range(size - 1, fork - 1, -1):
        album.arcs[place, k] = search.came[node]
        node = tail_of(chains, query, search.came[node])
