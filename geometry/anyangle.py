"""The shortest way of all at any angle: Polyanya (Cui, Harabor and Grastien 2017) on runs instead of a mesh.

# Strategy: a search node is an interval of a portal, all of which is visible from its root, a corner where the rope
bends (at first the start). Entering the next run, the interval casts a cone: what the cone meets of the run's other
portals stays visible from the root; beyond a side of the cone that is a corner the rope may bend, which makes that
corner the root. Nodes are taken by the least length of a way through their interval, so the first way to reach the
goal is the shortest.
"""

from typing import NamedTuple

import numpy as np

from geometry.chains import Floats, Ints
from geometry.compiled import compiled
from geometry.rope import Rope, measure_line, new_rope, reach, tighten_word
from geometry.runs import Runs, extend, run_at

CLOSE = 1e-9  # squares: two ways to a corner that differ by less are equally long


class Nodes(NamedTuple):
    """Search nodes, in the order of their making."""

    left: Floats
    """West end of the interval."""
    right: Floats
    """East end."""
    portal: Ints
    """Signed portal entered, from 1; 0 for a bend between two portals of one run."""
    root: Ints
    """The corner that sees the interval: 2 portal for a west end, 2 portal + 1 for an east end, -1 the start."""
    done: Floats
    """Length of the way to the root."""
    parent: Ints
    """The node before, -1 for none."""
    key: Floats
    """Heap: least length of a way through the node."""
    heap: Ints
    """Heap: the node."""
    size: Ints
    """(2,) the number of nodes and of heap entries."""


class Corners(NamedTuple):
    """The shortest way known to each corner; an entry counts if its mark equals the stamp."""

    best: Floats
    seen: Ints
    stamp: Ints


FULL = -2
NONE = -1


class Scout(NamedTuple):
    """All scratch of a search."""

    nodes: Nodes
    corners: Corners
    word: Ints
    rope: Rope
    line: Floats
    sizes: Ints


def new_scout(room: int, portals: int) -> Scout:
    """Scratch for that many nodes on a screen with that many portals."""
    nodes = Nodes(
        np.empty(room),
        np.empty(room),
        np.empty(room, np.int32),
        np.empty(room, np.int32),
        np.empty(room),
        np.empty(room, np.int32),
        np.empty(room),
        np.empty(room, np.int32),
        np.zeros(2, np.int32),
    )
    corners = Corners(np.empty(2 * portals), np.zeros(2 * portals, np.int32), np.zeros(1, np.int32))
    words = room // 8
    return Scout(
        nodes, corners, np.empty(words, np.int32), new_rope(words), np.empty((4 * words + 8, 2)), np.zeros(2, np.int32)
    )


@compiled
def shortest_word(
    runs: Runs, ends: tuple[float, float, float, float], nodes: Nodes, corners: Corners, word: Ints
) -> int:
    """Write the reduced word of the shortest way; returns its size, NONE when there is no way, FULL without room."""
    start = run_at(runs, int(ends[1]), int(ends[0]))
    goal = run_at(runs, int(ends[3]), int(ends[2]))
    if start == goal:
        return 0
    nodes.size[:] = 0
    corners.stamp[0] += 1
    depart(runs, ends, start, nodes, corners)
    while nodes.size[1] > 0:
        if nodes.size[0] + 4 * runs.row.shape[0] >= nodes.left.shape[0]:
            return FULL
        node = take(nodes)
        symbol = nodes.portal[node]
        if nodes.right[node] < nodes.left[node]:
            return spell_word(nodes, node, word)
        root = nodes.root[node]
        if root >= 0 and nodes.done[node] > corners.best[root] + CLOSE:
            continue
        run = runs.upper[symbol - 1] if symbol > 0 else runs.lower[-symbol - 1]
        if run == goal:
            arrive(runs, ends, nodes, node)
        spread(runs, ends, nodes, corners, node, run)
    return NONE


@compiled
def shortest_line(
    runs: Runs,
    ends: tuple[float, float, float, float],
    nodes: Nodes,
    corners: Corners,
    word: Ints,
    rope: Rope,
    line: Floats,
    sizes: Ints,
) -> float:
    """The length of the shortest way; its numbers of symbols and corners go to ``sizes``, NONE or FULL to the first."""
    size = shortest_word(runs, ends, nodes, corners, word)
    if size == word.shape[0] or 4 * size + 8 > rope.x.shape[0]:
        size = FULL
    sizes[0] = size
    if size < 0:
        return np.inf
    sizes[1] = tighten_word(runs, False, word, size, ends, rope, line)
    return measure_line(line, sizes[1])


@compiled
def depart(runs: Runs, ends: tuple[float, float, float, float], run: int, nodes: Nodes, corners: Corners) -> None:
    """All portals of the start's run."""
    for portal in range(runs.up[run], runs.up[run + 1]):
        add(runs, ends, nodes, corners, 1.0 * runs.left[portal], runs.right[portal] + 1.0, portal + 1, -1, 0.0, -1)
    for portal in range(runs.down[run], runs.down[run + 1]):
        left, right = 1.0 * runs.left[portal], runs.right[portal] + 1.0
        if ends[1] > runs.line[portal] + 1 or left <= ends[0] <= right:
            add(runs, ends, nodes, corners, left, right, -portal - 1, -1, 0.0, -1)
        elif ends[0] < left:
            add(runs, ends, nodes, corners, left, right, -portal - 1, 2 * portal, left - ends[0], -1)
        else:
            add(runs, ends, nodes, corners, left, right, -portal - 1, 2 * portal + 1, ends[0] - right, -1)


@compiled
def corner_x(runs: Runs, ends: tuple[float, float, float, float], root: int) -> float:
    """The x of a root."""
    if root < 0:
        return ends[0]
    return float(runs.left[root >> 1] if root & 1 == 0 else runs.right[root >> 1] + 1)


@compiled
def corner_y(runs: Runs, ends: tuple[float, float, float, float], root: int) -> float:
    """The y of a root."""
    return ends[1] if root < 0 else float(runs.line[root >> 1] + 1)


@compiled
def spread(
    runs: Runs,
    ends: tuple[float, float, float, float],
    nodes: Nodes,
    corners: Corners,
    node: int,
    run: int,
) -> None:
    """Make the nodes behind one that enters a run."""
    symbol, left, right = nodes.portal[node], nodes.left[node], nodes.right[node]
    portal = abs(symbol) - 1
    up = symbol > 0
    rx, ry = corner_x(runs, ends, nodes.root[node]), corner_y(runs, ends, nodes.root[node])
    depth = abs(runs.line[portal] + 1.0 - ry)
    if depth > 0.0:
        west = snapped(rx + (left - rx) * (depth + 1.0) / depth)
        east = snapped(rx + (right - rx) * (depth + 1.0) / depth)
    else:
        west = -np.inf if rx > left else rx
        east = np.inf if rx < right else rx
    to_west = nodes.done[node] + reach(left - rx, depth)
    to_east = nodes.done[node] + reach(right - rx, depth)
    bend_west = left == runs.left[portal] and (nodes.root[node] == 2 * portal or known(corners, 2 * portal, to_west))
    bend_east = right == runs.right[portal] + 1 and (
        nodes.root[node] == 2 * portal + 1 or known(corners, 2 * portal + 1, to_east)
    )
    first, last = (runs.up[run], runs.up[run + 1]) if up else (runs.down[run], runs.down[run + 1])
    sign = 1 if up else -1
    for far in range(first, last):
        low, high = 1.0 * runs.left[far], runs.right[far] + 1.0
        if bend_west and low < west:
            add(runs, ends, nodes, corners, low, min(high, west), sign * (far + 1), 2 * portal, to_west, node)
        if max(low, west) < min(high, east):
            add(
                runs,
                ends,
                nodes,
                corners,
                max(low, west),
                min(high, east),
                sign * (far + 1),
                nodes.root[node],
                nodes.done[node],
                node,
            )
        if bend_east and high > east:
            add(runs, ends, nodes, corners, max(low, east), high, sign * (far + 1), 2 * portal + 1, to_east, node)
    first, last = (runs.down[run], runs.down[run + 1]) if up else (runs.up[run], runs.up[run + 1])
    for near in range(first, last):
        low, high = 1.0 * runs.left[near], runs.right[near] + 1.0
        if near < portal and bend_west:
            bend = note_bend(nodes, 2 * portal, to_west, node)
            add(runs, ends, nodes, corners, low, high, -sign * (near + 1), 2 * near + 1, to_west + left - high, bend)
        elif near > portal and bend_east:
            bend = note_bend(nodes, 2 * portal + 1, to_east, node)
            add(runs, ends, nodes, corners, low, high, -sign * (near + 1), 2 * near, to_east + low - right, bend)


@compiled
def snapped(x: float) -> float:
    """Put what is a corner but for rounding onto it: else a ray along several corners may slip past one."""
    corner = np.floor(x + 0.5)
    return float(corner if abs(x - corner) < CLOSE else x)


@compiled
def known(corners: Corners, corner: int, length: float) -> bool:
    """Note a way to a corner; False when a shorter one is known."""
    stamp = corners.stamp[0]
    if corners.seen[corner] == stamp and length > corners.best[corner] + CLOSE:
        return False
    if corners.seen[corner] != stamp or length < corners.best[corner]:
        corners.best[corner] = length
        corners.seen[corner] = stamp
    return True


@compiled
def note_bend(nodes: Nodes, corner: int, done: float, parent: int) -> int:
    """A node for a bend, off the heap."""
    node = nodes.size[0]
    nodes.size[0] += 1
    nodes.portal[node], nodes.root[node], nodes.done[node], nodes.parent[node] = 0, corner, done, parent
    return int(node)


@compiled
def add(
    runs: Runs,
    ends: tuple[float, float, float, float],
    nodes: Nodes,
    corners: Corners,
    left: float,
    right: float,
    symbol: int,
    root: int,
    done: float,
    parent: int,
) -> None:
    """Make a node, unless a shorter way to its root is known."""
    if root >= 0 and not known(corners, root, done):
        return
    y = runs.line[abs(symbol) - 1] + 1.0
    rx, ry = corner_x(runs, ends, root), corner_y(runs, ends, root)
    near, far = abs(y - ry), abs(ends[3] - y)
    cross = rx + (ends[2] - rx) * near / (near + far) if near + far > 0.0 else ends[2]
    cross = min(max(cross, left), right)
    put(
        nodes,
        left,
        right,
        symbol,
        root,
        done,
        parent,
        done + reach(cross - rx, near) + reach(ends[2] - cross, far),
    )


@compiled
def arrive(runs: Runs, ends: tuple[float, float, float, float], nodes: Nodes, node: int) -> None:
    """The way from a node's root to the goal, in the run that the node enters."""
    portal = abs(nodes.portal[node]) - 1
    left, right, root = nodes.left[node], nodes.right[node], nodes.root[node]
    rx, ry = corner_x(runs, ends, root), corner_y(runs, ends, root)
    near, far = abs(runs.line[portal] + 1.0 - ry), abs(ends[3] - runs.line[portal] - 1.0)
    cross = rx + (ends[2] - rx) * near / (near + far) if near + far > 0.0 else rx
    if cross < left - CLOSE and left != runs.left[portal]:
        return
    if cross > right + CLOSE and right != runs.right[portal] + 1:
        return
    cross = min(max(cross, left), right)
    total = nodes.done[node] + reach(cross - rx, near) + reach(ends[2] - cross, far)
    put(nodes, 1.0, 0.0, 0, root, total, node, total)


@compiled
def put(nodes: Nodes, left: float, right: float, symbol: int, root: int, done: float, parent: int, key: float) -> None:
    """Write a node and put it on the heap."""
    node = nodes.size[0]
    nodes.left[node], nodes.right[node], nodes.portal[node] = left, right, symbol
    nodes.root[node], nodes.done[node], nodes.parent[node] = root, done, parent
    nodes.size[0] += 1
    k = nodes.size[1]
    nodes.size[1] += 1
    while k > 0:
        up = (k - 1) >> 1
        if nodes.key[up] <= key:
            break
        nodes.key[k], nodes.heap[k] = nodes.key[up], nodes.heap[up]
        k = up
    nodes.key[k], nodes.heap[k] = key, node


@compiled
def take(nodes: Nodes) -> int:
    """The most promising node, off the heap."""
    top = nodes.heap[0]
    nodes.size[1] -= 1
    size = nodes.size[1]
    key, node = nodes.key[size], nodes.heap[size]
    k = 0
    while 2 * k + 1 < size:
        child = 2 * k + 1
        if child + 1 < size and nodes.key[child + 1] < nodes.key[child]:
            child += 1
        if nodes.key[child] >= key:
            break
        nodes.key[k], nodes.heap[k] = nodes.key[child], nodes.heap[child]
        k = child
    nodes.key[k], nodes.heap[k] = key, node
    return int(top)


@compiled
def spell_word(nodes: Nodes, node: int, word: Ints) -> int:
    """The reduced word of the portals on the way to a node."""
    size = 0
    while node >= 0:
        size = extend(word, size, -nodes.portal[node])
        node = nodes.parent[node]
    for k in range((size + 1) // 2):
        word[k], word[size - 1 - k] = -word[size - 1 - k], -word[k]
    return size
