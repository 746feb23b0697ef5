"""The k shortest paths over the pathgraph without a repeated node.

# Strategy: Yen (1971) with Lawler's (1972) partition: every path found is the best of a set of paths, and each further
one deviates from a path already taken at an arc that is not used there. Arcs, not nodes, tell paths apart, because two
chains may join the same two nodes. Exact distances to the goal guide each search and dismiss those that cannot give a
path better than the candidates.
"""

from typing import NamedTuple

import numpy as np

from utak.geometry.homotopy.landmarks import Landmarks
from utak.geometry.kernels.arrays import Floats, Ints
from utak.geometry.kernels.jit import bare
from utak.geometry.routes.astar import RouteQuery, Search, fill_goal_distances, find_path_to_goal

# Chains; goal distances are first filled up to 1.1 shortest paths from here on, to 1.5 below; no measurement on record.
LARGE_PATHGRAPH = 2000


class PathStore(NamedTuple):
    """Paths found: first those taken, shortest first, then the candidates, shortest first."""

    place: Ints  # (room,) by path in that order, the row of `arcs`, `size` and `fork` in which it stands
    cost: Floats  # (room,) by path in that order, its cost: its length in squares, unless the query is biased
    arcs: Ints  # (room, longest) arc codes, from start to goal (2 chain, plus 1 when walked backwards; see astar.py).
    size: Ints  # (room,) number of arcs
    # (room,) the index, from 0, of the arc at which it leaves the path that it deviates from; 0 for the first path
    fork: Ints
    # (room,) by path in that order, how many first arcs it has in common with the path from which deviations are sought
    shared: Ints


def new_path_store(room: int, longest: int) -> PathStore:
    """Return room, not initialised, for at most `room` paths of at most `longest` arcs."""
    place, size, fork, shared = (np.empty(room, np.int32) for _ in range(4))
    return PathStore(place, np.empty(room), np.empty((room, longest), np.int32), size, fork, shared)


@bare
def k_shortest_paths(
    ends: Ints, landmarks: Landmarks, query: RouteQuery, search: Search, store: PathStore, wanted: int
) -> int:
    """Fill the store with up to `wanted` shortest paths from start to goal, and return their number."""
    start = landmarks.head.shape[0]
    search.stamp[1] = 0
    search.stamp[0] += 1
    if not find_path_to_goal(landmarks, query, search, start):
        return 0
    store.place[0], store.fork[0], store.cost[0] = 0, 0, search.best[start + 1]
    record_path(ends, query.joint, search.arrival, store.arcs, store.size, 0, 0, start)
    if wanted == 1:
        return 1
    limit = (1.5 if ends.shape[0] < LARGE_PATHGRAPH else 1.1) * store.cost[0] + 1.0
    while True:
        fill_goal_distances(landmarks, query, search, limit)
        taken, have = 0, 1
        while taken < have and taken < wanted:
            taken += 1
            if taken < wanted:
                have = add_deviations(ends, landmarks, query, search, store, taken - 1, have, wanted)
        if limit == np.inf or (taken == wanted and store.cost[taken - 1] <= limit):
            return taken
        limit = np.inf  # paths beyond the limit of the distances may be missing


@bare
def add_deviations(
    ends: Ints,
    landmarks: Landmarks,
    query: RouteQuery,
    search: Search,
    store: PathStore,
    path: int,
    have: int,
    wanted: int,
) -> int:
    """Add the best deviations from a taken path, at each of its arcs from its fork on; return the number of paths."""
    joint, extra, length = query.joint, query.cost, landmarks.length
    nodes, node_ban, arc_ban, stamps = search.nodes, search.node_ban, search.arc_ban, search.stamp
    best, arrival = search.best, search.arrival
    place, cost, arcs, size, fork, shared = store
    start, first, row = landmarks.head.shape[0], 2 * ends.shape[0], 0 + place[path]
    fill_path_nodes(ends, joint, arcs, size, row, start, nodes)
    for other in range(path + 1):
        shared[other] = count_common_arcs(arcs, size, row, 0 + place[other])
    so_far = 0.0
    for k in range(size[row]):
        origin, code = 0 + nodes[k], 0 + arcs[row, k]
        if k >= fork[row]:
            stamps[0] += 1
            stamp = stamps[0]
            for other in range(path + 1):
                if shared[other] >= k and size[place[other]] > k:
                    arc_ban[arcs[place[other], k]] = stamp
            for j in range(k + 1):
                node_ban[nodes[j]] = stamp
            limit = cost[wanted - 1] if have >= wanted else np.inf
            if so_far + deviation_bound(landmarks, query, search, origin) < limit and find_path_to_goal(
                landmarks, query, search, origin
            ):
                total = so_far + best[start + 1]
                if total < limit:
                    new = insert_path(place, cost, path, have, wanted, total)
                    for j in range(k):
                        arcs[new, j] = arcs[row, j]
                    fork[new] = k
                    record_path(ends, joint, arrival, arcs, size, new, k, origin)
                    have = have + 1 if have < wanted else have
        so_far += length[code >> 1] if code < first else extra[code - first]
    return have


@bare
def fill_path_nodes(ends: Ints, joint: Ints, arcs: Ints, size: Ints, row: int, start: int, nodes: Ints) -> None:
    """Write to `nodes` the node from which each arc of a path comes, the start first, in the order of the path."""
    nodes[0] = start
    for k in range(size[row] - 1):
        extra = arcs[row, k] - 2 * ends.shape[0]
        nodes[k + 1] = ends[arcs[row, k] >> 1, 1 - (arcs[row, k] & 1)] if extra < 0 else joint[extra]


@bare
def count_common_arcs(arcs: Ints, size: Ints, row: int, other: int) -> int:
    """Return how many first arcs two paths have in common, before they differ or one ends."""
    k = 0
    while k < size[row] and k < size[other] and arcs[row, k] == arcs[other, k]:
        k += 1
    return k


@bare
def deviation_bound(landmarks: Landmarks, query: RouteQuery, search: Search, origin: int) -> float:
    """Return a lower bound of the length from a node to the goal over an arc that is not banned, in squares."""
    arc, head, step = landmarks.arc, landmarks.head, landmarks.step
    joint, extra, closed = query.joint, query.cost, query.closed
    arc_ban, node_ban, goal_distance, stamp = search.arc_ban, search.node_ban, search.goal_distance, search.stamp[0]
    start, arcs, least = head.shape[0], 2 * closed.shape[0], np.inf
    if origin == start:
        for k in range(2):
            if arc_ban[arcs + k] != stamp and extra[k] < np.inf and extra[k] + goal_distance[joint[k]] < least:
                least = extra[k] + goal_distance[joint[k]]
        return extra[4] if arc_ban[arcs + 4] != stamp and extra[4] < least else least
    for slot in range(4):
        to, code = head[origin, slot], arc[origin, slot]
        if to >= 0 and node_ban[to] != stamp and not closed[code >> 1] and arc_ban[code] != stamp:
            rest = step[origin, slot] + goal_distance[to]
            least = rest if rest < least else least
    for k in range(2, 4):
        if joint[k] == origin and arc_ban[arcs + k] != stamp and extra[k] < least:
            least = extra[k]
    return least


@bare
def insert_path(place: Ints, cost: Floats, path: int, have: int, wanted: int, total: float) -> int:
    """Make room among the candidates for a path of cost `total`, and return the row for its arcs."""
    at = have if have < wanted else wanted - 1
    row = have if have < wanted else 0 + place[at]
    while at > path + 1 and cost[at - 1] > total:
        place[at], cost[at] = place[at - 1], cost[at - 1]
        at -= 1
    place[at], cost[at] = row, total
    return row


@bare
def record_path(
    ends: Ints, joint: Ints, arrival: Ints, arcs: Ints, size: Ints, row: int, fork: int, origin: int
) -> None:
    """Write the path just found, from a node on, behind its first `fork` arcs; the arcs go from there to the goal."""
    first, goal = 2 * ends.shape[0], arrival.shape[0] - 1
    k, node = fork, goal
    while node != origin:
        node = arc_tail(ends, joint, first, goal, 0 + arrival[node])
        k += 1
    size[row], node = k, goal
    while node != origin:
        k -= 1
        arcs[row, k] = arrival[node]
        node = arc_tail(ends, joint, first, goal, 0 + arrival[node])


@bare
def arc_tail(ends: Ints, joint: Ints, first: int, goal: int, code: int) -> int:
    """Return the number of the node from which an arc comes."""
    if code < first:
        return int(ends[code >> 1, code & 1])
    return int(joint[code - first]) if code - first in (2, 3) else goal - 1
