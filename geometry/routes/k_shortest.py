"""The k shortest paths over the pathgraph without a repeated node.

# Strategy: Yen (1971) with Lawler's (1972) partition: every path found is the best of a set of paths, and each further
one deviates from a path already taken at an arc that is not used there. Arcs, not nodes, tell paths apart, because two
chains may join the same two nodes. Exact distances to the goal guide each search and dismiss those that cannot give a
path better than the candidates.
"""

from typing import NamedTuple

import numpy as np

from geometry.homotopy.landmarks import Landmarks
from geometry.kernels.arrays import Floats, Ints
from geometry.kernels.jit import bare
from geometry.routes.astar import RouteQuery, Search, fill_goal_distances, find_path_to_goal

# Chains; goal distances are first filled up to 1.1 shortest paths from here on, to 1.5 below; no measurement on record.
LARGE_PATHGRAPH = 2000


class PathStore(NamedTuple):
    """Paths found: first those taken, shortest first, then the candidates, shortest first.

    Attributes
    ----------
    place : (room,) by path in that order, the row of `arcs`, `size` and `fork` in which it stands.
    cost : (room,) by path in that order, its cost: its length in squares, unless the query is biased.
    arcs : (room, longest) arc codes, from start to goal (2 chain, plus 1 when walked backwards; see astar.py).
    size : (room,) number of arcs.
    fork : (room,) the index, from 0, of the arc at which it leaves the path that it deviates from; 0 for the first
        path.
    shared : (room,) by path in that order, how many first arcs it has in common with the path from which deviations are
        sought.
    """

    place: Ints
    cost: Floats
    arcs: Ints
    size: Ints
    fork: Ints
    shared: Ints


def new_path_store(room: int, longest: int) -> PathStore:
    """Return room, not initialised, for at most `room` paths of at most `longest` arcs.

    It holds, by path, its arcs (codes), their number, its cost in squares, and where it forks from another.
    """
    place, size, fork, shared = (np.empty(room, np.int32) for _ in range(4))
    return PathStore(place, np.empty(room), np.empty((room, longest), np.int32), size, fork, shared)


@bare
def k_shortest_paths(
    ends: Ints, landmarks: Landmarks, query: RouteQuery, search: Search, store: PathStore, wanted: int
) -> int:
    """Fill the store with up to `wanted` shortest paths from start to goal, and return their number.

    It is 0 when there is none. The paths stand in the store's order, shortest first. When one path is wanted and the
    query is biased, it is the cheapest path instead, up to a factor of PATH_SLACK. A chain is an edge of the pathgraph
    (whose nodes are the junctions and ends of the skeleton), with its cells.

    Parameters
    ----------
    ends : (m, 2) the first and the last node of each chain.
    landmarks : arcs out of each node (node led to, code, length in squares), and the nodes' distances from landmarks,
        nodes chosen in advance, in squares.
    query : the nodes and lengths (squares) of the arcs that join start and goal to the pathgraph, and which chains
        and steps are closed.
    search : scratch; changed.
    store : written: path k stands in row place[k] of `arcs` and `size`, its cost in cost[k].
    wanted : how many paths at most; at least 1, at most the store's room.
    """
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
    """Add the best deviations from a taken path, at each of its arcs from its fork on; return the number of paths.

    That is the number of all in the store, taken ones and candidates, at most `wanted`.

    A deviation follows the path up to a node and leaves it there by an arc by which no path taken so far leaves. A
    chain is an edge of the pathgraph (whose nodes are the junctions and ends of the skeleton), with its cells.

    Parameters
    ----------
    ends : (m, 2) the first and the last node of each chain.
    landmarks : arcs out of each node (node led to, code, length in squares), and the nodes' distances from landmarks,
        nodes chosen in advance, in squares.
    query : the nodes and lengths (squares) of the arcs that join start and goal to the pathgraph, and which chains
        and steps are closed.
    search : scratch; changed, but for its distances to the goal, which must be filled.
    store : the paths; candidates are added, and the worst replaced when there are as many as wanted.
    path : the index of the taken path in the store's order.
    have : the number of paths in the store, at most `wanted`.
    wanted : how many paths are wanted.
    """
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
    """Write to `nodes` the node from which each arc of a path comes, the start first, in the order of the path.

    A chain is an edge of the pathgraph (whose nodes are the junctions and ends of the skeleton), with its cells.

    Parameters
    ----------
    ends : (m, 2) the first and the last node of each chain.
    joint : (4,) the nodes to which the two arcs out of the start lead, and those from which the two into the goal come.
    arcs, size : (room, longest) arc codes (2 chain, plus 1 when walked backwards), and (room,) numbers of arcs, of the
        store.
    row : the path's row in them.
    start : the number of the start's node.
    nodes : written from index 0 on, one entry for each arc.
    """
    nodes[0] = start
    for k in range(size[row] - 1):
        extra = arcs[row, k] - 2 * ends.shape[0]
        nodes[k + 1] = ends[arcs[row, k] >> 1, 1 - (arcs[row, k] & 1)] if extra < 0 else joint[extra]


@bare
def count_common_arcs(arcs: Ints, size: Ints, row: int, other: int) -> int:
    """Return how many first arcs two paths have in common, before they differ or one ends.

    A chain is an edge of the pathgraph (whose nodes are the junctions and ends of the skeleton), with its cells.

    Parameters
    ----------
    arcs, size : (room, longest) arc codes (2 chain, plus 1 when walked backwards), and (room,) numbers of arcs, of the
        store.
    row, other : the paths' rows in them.
    """
    k = 0
    while k < size[row] and k < size[other] and arcs[row, k] == arcs[other, k]:
        k += 1
    return k


@bare
def deviation_bound(landmarks: Landmarks, query: RouteQuery, search: Search, origin: int) -> float:
    """Return a lower bound of the length from a node to the goal over an arc that is not banned, in squares.

    It is infinite when there is no such arc, or none that leads to the goal within the limit of the distances. A chain
    is an edge of the pathgraph (whose nodes are the junctions and ends of the skeleton), with its cells.

    Parameters
    ----------
    landmarks : arcs out of each node: node led to, code, length in squares.
    query : the nodes and lengths (squares) of the arcs that join start and goal to the pathgraph, and which chains
        are closed.
    search : the bans under the current stamp, and the distances to the goal, which must be filled.
    origin : the number of the node.
    """
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
    """Make room among the candidates for a path of cost `total`, and return the row for its arcs.

    The row is one of `arcs`, `size` and `fork` of the store; rows of other paths stay where they are, only the order
    changes. It comes behind candidates of the same cost. When there are as many paths as wanted, the row is that of the
    most expensive, which is dropped.

    Parameters
    ----------
    place, cost : (room,) of the store; changed so that the candidates stay ordered by cost.
    path : the index, in the store's order, of the last path taken; candidates begin behind it.
    have : the number of paths in the store.
    wanted : how many paths are wanted.
    total : the cost of the path: its length in squares, more where the query's bias makes arcs costlier.
    """
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
    """Write the path just found, from a node on, behind its first `fork` arcs; the arcs go from there to the goal.

    A chain is an edge of the pathgraph (whose nodes are the junctions and ends of the skeleton), with its cells.

    Parameters
    ----------
    ends : (m, 2) the first and the last node of each chain.
    joint : (4,) the nodes to which the two arcs out of the start lead, and those from which the two into the goal come.
    arrival : (n + 2,) the code of the arc by which the path arrives at each node.
    arcs, size : (room, longest) arc codes (2 chain, plus 1 when walked backwards), and (room,) numbers of arcs, of the
        store; both written at `row`.
    row : the path's row in them.
    fork : how many arcs stand there already.
    origin : the number of the node behind these arcs, from which the search began.
    """
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
    """Return the number of the node from which an arc comes.

    A chain is an edge of the pathgraph (whose nodes are the junctions and ends of the skeleton), with its cells.

    Parameters
    ----------
    ends : (m, 2) the first and the last node of each chain.
    joint : (4,) the nodes to which the two arcs out of the start lead, and those from which the two into the goal come.
    first : the least code of an arc that the query adds, 2m.
    goal : the number of the goal's node; the start's is one less.
    code : the code of the arc: 2 chain, plus 1 when walked backwards; 2m and more for those of the query (see
        astar.py).
    """
    if code < first:
        return int(ends[code >> 1, code & 1])
    return int(joint[code - first]) if code - first in (2, 3) else goal - 1
