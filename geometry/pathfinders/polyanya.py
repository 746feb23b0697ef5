"""The shortest way of all at any angle: Polyanya (Cui, Harabor and Grastien 2017) on runs instead of a mesh.

# Strategy: a search node is an interval of a portal, all of which is visible from its root, a corner where the rope
bends (at first the start). Entering the next run, the interval casts a cone: what the cone meets of the run's other
portals stays visible from the root; beyond a side of the cone that is a corner the rope may bend, which makes that
corner the root. Nodes are taken by the least length of a way through their interval, so the first way to reach the
goal is the shortest. Dead ends are entered on the way to a goal in them alone.
"""

from typing import NamedTuple

import numpy as np

from geometry.homotopy.funnel import Ends, Funnel, measure_line, new_rope, reach, tighten_word
from geometry.homotopy.strips import Strips, extend, run_at
from geometry.kernels.arrays import Floats, Ints
from geometry.kernels.heap import pop, push
from geometry.kernels.jit import bare

CLOSE = 1e-9  # squares: two ways to a corner that differ by less are equally long
WEST, EAST, DONE = 0, 1, 2  # columns of ``span``
PORTAL, ROOT, PARENT = 0, 1, 2  # columns of ``link``
MADE, WAITING, STAMP = 0, 1, 2  # entries of ``tally``
FULL = -2
NONE = -1


class Nodes(NamedTuple):
    """Search nodes, in the order of their making, and the shortest way known to each corner.

    A corner is 2 portal for a portal's west end, 2 portal + 1 for its east end; -1 is the start.
    """

    span: Floats
    """(room, 3) west and east end of the interval, and the length of the way to the root; a goal has east < west."""
    link: Ints
    """(room, 3) signed portal entered, from 1, or 0 for a bend between two portals of one run; the root, which is the
    corner that sees the interval; the node before, -1 for none."""
    key: Floats
    """(room,) heap: least length of a way through the node."""
    heap: Ints
    """(room,) heap: the node."""
    best: Floats
    """(2 portals,) length of the shortest way known to a corner."""
    seen: Ints
    """(2 portals,) ``best`` counts where this equals the stamp."""
    tally: Ints
    """(3,) the number of nodes, the size of the heap, the stamp."""
    enter: Ints
    """(runs,) the stamp on dead ends that may be entered, for the goal lies in them."""


class PolyanyaSearch(NamedTuple):
    """All scratch of a search."""

    nodes: Nodes
    word: Ints
    rope: Funnel
    line: Floats
    sizes: Ints


def new_scout(room: int, runs: Strips) -> PolyanyaSearch:
    """Scratch for that many nodes."""
    portals = len(runs.left)
    nodes = Nodes(
        np.empty((room, 3)),
        np.empty((room, 3), np.int32),
        np.empty(room),
        np.empty(room, np.int32),
        np.empty(2 * portals),
        np.zeros(2 * portals, np.int32),
        np.zeros(3, np.int32),
        np.zeros(len(runs.low), np.int32),
    )
    words = room // 8
    return PolyanyaSearch(
        nodes, np.empty(words, np.int32), new_rope(words), np.empty((4 * words + 8, 2)), np.zeros(2, np.int32)
    )


@bare
def shortest_line(
    runs: Strips, ends: Ends, limit: float, nodes: Nodes, word: Ints, rope: Funnel, line: Floats, sizes: Ints
) -> float:
    """The length of the shortest way; its numbers of symbols and corners go to ``sizes``, NONE or FULL to the first.

    None is found that is as long as the limit, unless start and goal are in one run.
    """
    size = shortest_word(runs, ends, limit, nodes, word)
    if size == word.shape[0] or 4 * size + 8 > rope.x.shape[0]:
        size = FULL
    sizes[0] = size
    if size < 0:
        return np.inf
    sizes[1] = tighten_word(runs.left, runs.right, runs.line, False, word, size, ends, rope, line)
    return measure_line(line, sizes[1])


@bare
def shortest_word(runs: Strips, ends: Ends, limit: float, nodes: Nodes, word: Ints) -> int:
    """Write the reduced word of the shortest way; returns its size, NONE when there is no way, FULL without room."""
    rows, lows, up, down, line = runs.row, runs.low, runs.up, runs.down, runs.line
    left, right, lower, upper = runs.left, runs.right, runs.lower, runs.upper
    exits, (span, link, key, heap, best, seen, tally, enter) = runs.exit, nodes
    start = run_at(rows, lows, int(ends[1]), int(ends[0]))
    goal = run_at(rows, lows, int(ends[3]), int(ends[2]))
    if start == goal:
        return 0
    tally[MADE], tally[WAITING], tally[STAMP] = 0, 0, tally[STAMP] + 1
    mark_inwards(exits, lower, upper, goal, enter, tally[STAMP])
    depart(up, down, left, right, line, ends, start, span, link, tally)
    node = enqueue(left, right, line, ends, limit, span, link, key, heap, best, seen, tally, 0)
    while node >= 0 or tally[WAITING] > 0:
        made = tally[MADE]
        if made + 4 * rows.shape[0] >= key.shape[0]:
            return FULL
        if node < 0:
            node, tally[WAITING] = pop(key, heap, tally[WAITING])
        if span[node, EAST] < span[node, WEST]:
            return spell_word(link, node, word)
        root, symbol = link[node, ROOT], link[node, PORTAL]
        if root >= 0 and span[node, DONE] > best[root] + CLOSE:
            node = NONE
            continue
        run = upper[symbol - 1] if symbol > 0 else lower[-symbol - 1]
        if run == goal:
            arrive(left, right, line, ends, span, link, tally, node)
        spread(up, down, left, right, line, lower, upper, exits, enter, ends, span, link, best, seen, tally, node, run)
        node = enqueue(left, right, line, ends, limit, span, link, key, heap, best, seen, tally, made)
    return NONE


@bare
def mark_inwards(exits: Ints, lower: Ints, upper: Ints, goal: int, enter: Ints, stamp: int) -> None:
    """Mark the runs by which one comes to the goal where that lies in a dead end."""
    run = goal
    while exits[run] != 0:
        enter[run] = stamp
        run = upper[exits[run] - 1] if exits[run] > 0 else lower[-exits[run] - 1]


@bare
def depart(
    up: Ints,
    down: Ints,
    left: Ints,
    right: Ints,
    line: Ints,
    ends: Ends,
    run: int,
    span: Floats,
    link: Ints,
    tally: Ints,
) -> None:
    """All portals of the start's run."""
    for portal in range(up[run], up[run + 1]):
        note(span, link, tally, 1.0 * left[portal], right[portal] + 1.0, 0.0, portal + 1, -1, -1)
    for portal in range(down[run], down[run + 1]):
        west, east, root, done = 1.0 * left[portal], right[portal] + 1.0, -1, 0.0
        if ends[1] == line[portal] + 1 and ends[0] < west:
            root, done = 2 * portal, west - ends[0]
        elif ends[1] == line[portal] + 1 and ends[0] > east:
            root, done = 2 * portal + 1, ends[0] - east
        note(span, link, tally, west, east, done, -portal - 1, root, -1)


@bare
def spread(
    up: Ints,
    down: Ints,
    left: Ints,
    right: Ints,
    line: Ints,
    lower: Ints,
    upper: Ints,
    exits: Ints,
    enter: Ints,
    ends: Ends,
    span: Floats,
    link: Ints,
    best: Floats,
    seen: Ints,
    tally: Ints,
    node: int,
    run: int,
) -> None:
    """Note the nodes behind one that enters a run."""
    west, east, done = span[node, WEST], span[node, EAST], span[node, DONE]
    symbol, root = link[node, PORTAL], link[node, ROOT]
    portal, upward, stamp = abs(symbol) - 1, symbol > 0, tally[STAMP]
    corner = 2 * portal
    x, y = ends[0], ends[1]
    if root >= 0:
        x, y = 1.0 * (right[root >> 1] + 1 if root & 1 else left[root >> 1]), line[root >> 1] + 1.0
    depth = abs(line[portal] + 1.0 - y)
    if depth > 0.0:
        low, high = snapped(x + (west - x) * (depth + 1.0) / depth), snapped(x + (east - x) * (depth + 1.0) / depth)
    else:
        low, high = -np.inf if x > west else x, np.inf if x < east else x
    to_west, to_east = done + reach(west - x, depth), done + reach(east - x, depth)
    bend_west = west == left[portal] and (root == corner or known(best, seen, stamp, corner, to_west))
    bend_east = east == right[portal] + 1 and (root == corner + 1 or known(best, seen, stamp, corner + 1, to_east))
    first, last, sign = (up[run], up[run + 1], 1) if upward else (down[run], down[run + 1], -1)
    if not bend_west:
        first = first_beyond(right, low, first, last)
    for far in range(first, last):
        a, b, code = 1.0 * left[far], right[far] + 1.0, sign * (far + 1)
        if a >= high and not bend_east:
            break
        other = upper[far] if upward else lower[far]
        if exits[other] == -code and enter[other] != stamp:
            continue
        if bend_west and a < low:
            note(span, link, tally, a, b if b < low else low, to_west, code, corner, node)
        if (a if a > low else low) < (b if b < high else high):
            note(span, link, tally, a if a > low else low, b if b < high else high, done, code, root, node)
        if bend_east and b > high:
            note(span, link, tally, a if a > high else high, b, to_east, code, corner + 1, node)
    if not (bend_west or bend_east):
        return
    first, last = (down[run], down[run + 1]) if upward else (up[run], up[run + 1])
    for near in range(first, last):
        a, b, code = 1.0 * left[near], right[near] + 1.0, -sign * (near + 1)
        other = lower[near] if upward else upper[near]
        if exits[other] == -code and enter[other] != stamp:
            continue
        if near < portal and bend_west:
            bend = note(span, link, tally, west, west, to_west, 0, corner, node)
            note(span, link, tally, a, b, to_west + west - b, code, 2 * near + 1, bend)
        elif near > portal and bend_east:
            bend = note(span, link, tally, east, east, to_east, 0, corner + 1, node)
            note(span, link, tally, a, b, to_east + a - east, code, 2 * near, bend)


@bare
def first_beyond(right: Ints, x: float, first: int, last: int) -> int:
    """The first of a run's portals that reaches beyond x."""
    while first < last:
        middle = (first + last) >> 1
        if right[middle] + 1.0 <= x:
            first = middle + 1
        else:
            last = middle
    return int(first)


@bare
def snapped(x: float) -> float:
    """Put what is a corner but for rounding onto it: else a ray along several corners may slip past one."""
    corner = np.floor(x + 0.5)
    return float(corner if abs(x - corner) < CLOSE else x)


@bare
def known(best: Floats, seen: Ints, stamp: int, corner: int, length: float) -> bool:
    """Note a way to a corner; False when a shorter one is known."""
    if seen[corner] != stamp:
        best[corner], seen[corner] = length, stamp
        return True
    if length < best[corner]:
        best[corner] = length
    return bool(length <= best[corner] + CLOSE)


@bare
def note(
    span: Floats, link: Ints, tally: Ints, west: float, east: float, done: float, symbol: int, root: int, parent: int
) -> int:
    """Write a node, off the heap."""
    node = tally[MADE]
    tally[MADE] = node + 1
    span[node, WEST], span[node, EAST], span[node, DONE] = west, east, done
    link[node, PORTAL], link[node, ROOT], link[node, PARENT] = symbol, root, parent
    return int(node)


@bare
def enqueue(
    left: Ints,
    right: Ints,
    line: Ints,
    ends: Ends,
    limit: float,
    span: Floats,
    link: Ints,
    key: Floats,
    heap: Ints,
    best: Floats,
    seen: Ints,
    tally: Ints,
    first: int,
) -> int:
    """Put the nodes from ``first`` on the heap, but for bends, those beyond the limit, and those whose root has a
    shorter way.

    Returns the best of them, off the heap, if it is to be taken next, as in open space it nearly always is; else NONE.
    """
    size, stamp, next_node, least = tally[WAITING], tally[STAMP], NONE, np.inf
    for node in range(first, tally[MADE]):
        west, east, done, root = span[node, WEST], span[node, EAST], span[node, DONE], link[node, ROOT]
        total = done
        if east >= west:
            if link[node, PORTAL] == 0 or (root >= 0 and not known(best, seen, stamp, root, done)):
                continue
            x, y = ends[0], ends[1]
            if root >= 0:
                x, y = 1.0 * (right[root >> 1] + 1 if root & 1 else left[root >> 1]), line[root >> 1] + 1.0
            at = line[abs(link[node, PORTAL]) - 1] + 1.0
            near, far = abs(at - y), abs(ends[3] - at)
            cross = x + (ends[2] - x) * near / (near + far) if near + far > 0.0 else ends[2]
            cross = west if cross < west else east if cross > east else cross
            total += reach(cross - x, near) + reach(ends[2] - cross, far)
        if total >= limit:
            continue
        if total >= least:
            size = push(key, heap, size, total, node)
            continue
        if next_node >= 0:
            size = push(key, heap, size, least, next_node)
        next_node, least = node, total
    if size > 0 and next_node >= 0 and key[0] < least:
        size, next_node = push(key, heap, size, least, next_node), NONE
    tally[WAITING] = size
    return next_node


@bare
def arrive(left: Ints, right: Ints, line: Ints, ends: Ends, span: Floats, link: Ints, tally: Ints, node: int) -> None:
    """The way from a node's root to the goal, in the run that the node enters."""
    portal, root = abs(link[node, PORTAL]) - 1, link[node, ROOT]
    west, east = span[node, WEST], span[node, EAST]
    x, y = ends[0], ends[1]
    if root >= 0:
        x, y = 1.0 * (right[root >> 1] + 1 if root & 1 else left[root >> 1]), line[root >> 1] + 1.0
    near, far = abs(line[portal] + 1.0 - y), abs(ends[3] - line[portal] - 1.0)
    cross = x + (ends[2] - x) * near / (near + far) if near + far > 0.0 else x
    if cross < west - CLOSE and west != left[portal]:
        return
    if cross > east + CLOSE and east != right[portal] + 1:
        return
    cross = west if cross < west else east if cross > east else cross
    total = span[node, DONE] + reach(cross - x, near) + reach(ends[2] - cross, far)
    note(span, link, tally, 1.0, 0.0, total, 0, root, node)


@bare
def spell_word(link: Ints, node: int, word: Ints) -> int:
    """The reduced word of the portals on the way to a node."""
    size = 0
    while node >= 0:
        size = extend(word, size, -link[node, PORTAL])
        node = link[node, PARENT]
    for k in range((size + 1) // 2):
        word[k], word[size - 1 - k] = -word[size - 1 - k], -word[k]
    return size
