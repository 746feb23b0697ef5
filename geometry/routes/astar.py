"""A* over the pathgraph, and exact distances to the goal.

The edges of the pathgraph are called chains. A query adds two nodes to the n of the pathgraph: the start (n) and the
goal (n + 1). An arc is a chain walked in one direction, coded as 2 chain + 1 when walked backwards, 2 chain when
forwards. With m chains, 2m and 2m + 1 lead from the start to the ends of its chain, 2m + 2 and 2m + 3 from the ends of
the goal's chain to the goal, and 2m + 4 from the start to the goal along a chain that they share.
"""

from typing import NamedTuple

import numpy as np

from utak.geometry.homotopy.landmarks import Landmarks
from utak.geometry.kernels.arrays import Floats, Ints
from utak.geometry.kernels.heap import pop, push
from utak.geometry.kernels.jit import bare
from utak.geometry.skeleton.skeleton import States

PATH_SLACK = 1.05  # factor on the lower bound in biased searches; on random squares a third of the time, paths as good


class RouteQuery(NamedTuple):
    """The nodes, arcs and closed chains that one query adds to the pathgraph of n nodes and m chains."""

    # (4,) the nodes to which the start's two arcs lead, and those from which the goal's two arcs come; -1 for none
    joint: Ints
    # (5,) the lengths of the five arcs (see the module's description), in squares; infinite where there is none
    cost: Floats
    sight: Floats  # (2, landmarks) the goal's distances from the landmarks (row 0), and the start's (row 1), in squares
    # (4,) a point (x, y) of the straight line from start to goal, in squares, and the line's normal, scaled: an arc's
    # cost grows by the share that the product of this normal and the offset of the arc's head from the point gives; a
    # normal of 0 for no bias
    line: Floats
    closed: States  # (m,) 1 for chains that start or goal split, which none may walk from end to end; else 0


class Search(NamedTuple):
    """Scratch of a search; an entry counts only if its mark equals the current stamp."""

    # (n + 2,) the cost of the cheapest path found so far to each node: its length in squares, unless biased
    best: Floats
    arrival: Ints  # (n + 2,) the code of the arc by which that path arrives; -1 at the node where the search began
    seen: Ints  # (n + 2,) mark of `best` and `arrival`
    node_ban: Ints  # (n + 2,) mark of nodes that the present search must not enter
    arc_ban: Ints  # (2m + 5,) mark, by code, of arcs that the present search must not use from its origin
    goal_distance: Floats  # (n + 2,) exact distances to the goal, in squares, when filled
    nodes: Ints  # (n + 2,) the nodes of the path from which deviations are sought
    key: Floats  # (2m + 8,) heap: lower bounds of costs
    node: Ints  # (2m + 8,) heap: nodes
    stamp: Ints  # (2,) the current stamp, which grows from search to search; whether `goal_distance` is filled (1 or 0)


def new_search(nodes: int, chains: int) -> Search:
    """Return scratch for searches on a pathgraph of that many nodes and chains (its edges), without any search yet."""
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
def find_path_to_goal(landmarks: Landmarks, query: RouteQuery, search: Search, origin: int) -> bool:
    """Search a path from a node to the goal (A*), and return whether there is one; it is left in `search.arrival`."""
    arc, head, step, place, sight = landmarks.arc, landmarks.head, landmarks.step, landmarks.place, landmarks.sight
    joint, extra, line, goal = query.joint, query.cost, query.line, query.sight
    closed = query.closed
    best, arrival, seen, node_ban, arc_ban = search.best, search.arrival, search.seen, search.node_ban, search.arc_ban
    goal_distance, key, spot = search.goal_distance, search.key, search.node
    n, arcs, stamp, exact = head.shape[0], 2 * closed.shape[0], search.stamp[0], search.stamp[1] != 0
    biased = line[2] != 0.0 or line[3] != 0.0
    inflation = PATH_SLACK if biased else 1.0
    best[origin], arrival[origin], seen[origin] = 0.0, -1, stamp
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
                if to < 0 or closed[code >> 1]:
                    continue
            else:
                to, code, cost = n + 1, arcs + slot - 2, extra[slot - 2]
                if joint[slot - 2] != node:
                    continue
            if node == origin and arc_ban[code] == stamp:
                continue
            if to < n and biased:  # among paths of one length, that nearest the straight line is shortest when tight
                cost *= 1.0 + abs((place[to, 0] - line[0]) * line[2] + (place[to, 1] - line[1]) * line[3])
            total = best[node] + cost
            if total == np.inf or node_ban[to] == stamp or (seen[to] == stamp and best[to] <= total):
                continue
            best[to], arrival[to], seen[to] = total, code, stamp
            rest = 0.0
            if to < n:
                rest = goal_distance[to] if exact else inflation * landmark_bound(sight, goal, 0, to)
            if rest < np.inf:
                size = push(key, spot, size, total + rest, to)
        while size > 0 and (node == origin or node_ban[node] == stamp):
            node, size = pop(key, spot, size)
            if node_ban[node] != stamp:
                break
        else:
            return False
        if node < n:
            node_ban[node] = stamp  # finished: its path is the shortest
    return True


@bare
def landmark_bound(sight: Floats, ends: Floats, end: int, node: int) -> float:
    """Return a lower bound of the path length from a node to the goal (end 0) or to the start (end 1), in squares."""
    least = 0.0
    for k in range(sight.shape[1]):
        if sight[node, k] != ends[end, k]:  # not both infinite
            gap = abs(sight[node, k] - ends[end, k])
            least = gap if gap > least else least
    return least


@bare
def fill_goal_distances(landmarks: Landmarks, query: RouteQuery, search: Search, limit: float) -> None:
    """Fill `search.goal_distance` with exact distances to the goal in squares, by Dijkstra's algorithm backwards."""
    # The second entry of `search.stamp` is set, so that searches use these distances.
    arc, head, step, sight = landmarks.arc, landmarks.head, landmarks.step, landmarks.sight
    joint, cost, ends, closed = query.joint, query.cost, query.sight, query.closed
    goal_distance, key, spot = search.goal_distance, search.key, search.node
    n, size = head.shape[0], 0
    for k in range(n + 2):
        goal_distance[k] = np.inf
    for k in range(2, 4):
        if cost[k] < np.inf and cost[k] < goal_distance[joint[k]]:
            goal_distance[joint[k]] = cost[k]
            size = push(key, spot, size, cost[k], 0 + joint[k])
    while size > 0:
        done = key[0]
        node, size = pop(key, spot, size)
        if done > goal_distance[node]:
            continue
        for slot in range(4):
            other = 0 + head[node, slot]
            if other < 0 or closed[arc[node, slot] >> 1]:
                continue
            total = done + step[node, slot]
            if total < goal_distance[other] and total + landmark_bound(sight, ends, 1, other) <= limit:
                goal_distance[other] = total
                size = push(key, spot, size, total, other)
    goal_distance[n + 1] = 0.0
    goal_distance[n] = cost[4]
    for k in range(2):
        if cost[k] < np.inf and cost[k] + goal_distance[joint[k]] < goal_distance[n]:
            goal_distance[n] = cost[k] + goal_distance[joint[k]]
    search.stamp[1] = 1
