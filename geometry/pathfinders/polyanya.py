"""Polyanya: the shortest path of all at any angle (Cui, Harabor and Grastien 2017), on strips instead of a mesh.

# Strategy: a search node is an interval of a portal, all of which is visible from its root. The root is a corner where
the path bends; at first it is the start. Entering the next strip, the interval casts a cone. What the cone meets of the
strip's other portals stays visible from the root. Where a side of the cone is a corner, the path may bend beyond it,
and that corner becomes the root. Nodes are taken by the least length of a path through their interval, so the first
path to reach the goal is the shortest. Dead ends are entered only when the goal lies in them.
"""

from typing import NamedTuple

import numpy as np

from utak.geometry.homotopy.funnel import Ends, Funnel, measure_line, new_funnel, step_length, tighten_word
from utak.geometry.homotopy.strips import Strips, append_symbol, strip_at
from utak.geometry.kernels.arrays import Floats, Ints
from utak.geometry.kernels.heap import pop, push
from utak.geometry.kernels.jit import bare

CORNER_TOLERANCE = 1e-9  # squares; rounding: two paths to a corner that differ by less are equally long
SPAN_WEST, SPAN_EAST, SPAN_LENGTH = 0, 1, 2  # columns of `Nodes.span`
LINK_PORTAL, LINK_ROOT, LINK_PARENT = 0, 1, 2  # columns of `Nodes.link`
NODE_COUNT, HEAP_SIZE, STAMP_INDEX = 0, 1, 2  # entries of `Nodes.counters`
SEARCH_OVERFLOW = -2  # returned when the scratch is too small
NO_PATH = -1  # returned when there is no path


class Nodes(NamedTuple):
    """Search nodes, in the order in which they were made, and the shortest path known to each corner."""

    # (room, 3) west and east end of the interval (x, in squares from the screen's south-west corner), and the length of
    # the path to the root, in squares; a goal node has east < west, and the length of the whole path
    span: Floats
    # (room, 3) the signed portal entered, from 1, or 0 for a bend between two portals of one strip; the root, which is
    # the corner that sees the interval; the node before, -1 for none
    link: Ints
    key: Floats  # (room,) heap: the least length of a path through the node, in squares
    heap: Ints  # (room,) heap: the number of the node
    best: Floats  # (2 portals,) the length of the shortest path known to a corner, in squares
    seen: Ints  # (2 portals,) the stamp of the search in which `best` was written; other entries do not count
    counters: Ints  # (3,) the number of nodes, the size of the heap, the stamp of the present search
    enter: Ints  # (strips,) the stamp on dead ends that may be entered because the goal lies in them


class PolyanyaSearch(NamedTuple):
    """All scratch of a search, and its result."""

    nodes: Nodes  # the search nodes
    # (room,) the reduced word of the path found: signed portals (index plus 1, negative when crossed southwards), of
    # which the first `sizes[0]` count
    word: Ints
    funnel: Funnel  # scratch for pulling the path tight
    # (n, 2) the corners (x, y) of the path found, in squares from the screen's south-west corner; the first `sizes[1]`
    # count
    line: Floats
    sizes: Ints  # (2,) the size of the word, or NO_PATH or SEARCH_OVERFLOW; the number of corners


def new_polyanya_search(room: int, strips: Strips) -> PolyanyaSearch:
    """Return scratch for at most `room` nodes on those strips; words of up to `room` // 8 symbols have room."""
    portals = len(strips.left)
    nodes = Nodes(
        np.empty((room, 3)),
        np.empty((room, 3), np.int32),
        np.empty(room),
        np.empty(room, np.int32),
        np.empty(2 * portals),
        np.zeros(2 * portals, np.int32),
        np.zeros(3, np.int32),
        np.zeros(len(strips.low), np.int32),
    )
    words = room // 8
    return PolyanyaSearch(
        nodes, np.empty(words, np.int32), new_funnel(words), np.empty((4 * words + 8, 2)), np.zeros(2, np.int32)
    )


@bare
def shortest_line(
    strips: Strips, ends: Ends, limit: float, nodes: Nodes, word: Ints, funnel: Funnel, line: Floats, sizes: Ints
) -> float:
    """Return the length of the shortest path of all, in squares; infinite when none is found."""
    size = shortest_word(strips, ends, limit, nodes, word)
    if size == word.shape[0] or 4 * size + 8 > funnel.x.shape[0]:
        size = SEARCH_OVERFLOW
    sizes[0] = size
    if size < 0:
        return np.inf
    sizes[1] = tighten_word(strips.left, strips.right, strips.line, word, size, ends, funnel, line)
    return measure_line(line, sizes[1])


@bare
def shortest_word(strips: Strips, ends: Ends, limit: float, nodes: Nodes, word: Ints) -> int:
    """Write the reduced word of the shortest path and return its size, or NO_PATH, or SEARCH_OVERFLOW without room."""
    rows, lows, up, down, line = strips.row, strips.low, strips.up, strips.down, strips.line
    left, right, lower, upper = strips.left, strips.right, strips.lower, strips.upper
    exits, (span, link, key, heap, best, seen, counters, enter) = strips.exit, nodes
    start = strip_at(rows, lows, int(ends[1]), int(ends[0]))
    goal = strip_at(rows, lows, int(ends[3]), int(ends[2]))
    if start == goal:
        return 0
    counters[NODE_COUNT], counters[HEAP_SIZE], counters[STAMP_INDEX] = 0, 0, counters[STAMP_INDEX] + 1
    mark_dead_ends_to_goal(exits, lower, upper, goal, enter, counters[STAMP_INDEX])
    add_start_nodes(up, down, left, right, line, ends, start, span, link, counters)
    node = enqueue(left, right, line, ends, limit, span, link, key, heap, best, seen, counters, 0)
    while node >= 0 or counters[HEAP_SIZE] > 0:
        made = counters[NODE_COUNT]
        if made + 4 * rows.shape[0] >= key.shape[0]:
            return SEARCH_OVERFLOW
        if node < 0:
            node, counters[HEAP_SIZE] = pop(key, heap, counters[HEAP_SIZE])
        if span[node, SPAN_EAST] < span[node, SPAN_WEST]:
            return spell_word(link, node, word)
        root, symbol = link[node, LINK_ROOT], link[node, LINK_PORTAL]
        if root >= 0 and span[node, SPAN_LENGTH] > best[root] + CORNER_TOLERANCE:
            node = NO_PATH
            continue
        strip = upper[symbol - 1] if symbol > 0 else lower[-symbol - 1]
        if strip == goal:
            add_goal_node(left, right, line, ends, span, link, counters, node)
        add_successors(
            up, down, left, right, line, lower, upper, exits, enter, ends, span, link, best, seen, counters, node, strip
        )
        node = enqueue(left, right, line, ends, limit, span, link, key, heap, best, seen, counters, made)
    return NO_PATH


@bare
def mark_dead_ends_to_goal(exits: Ints, lower: Ints, upper: Ints, goal: int, enter: Ints, stamp: int) -> None:
    """Mark with the stamp the strips of the dead end in which the goal's strip lies, if it lies in one."""
    strip = goal
    while exits[strip] != 0:
        enter[strip] = stamp
        strip = upper[exits[strip] - 1] if exits[strip] > 0 else lower[-exits[strip] - 1]


@bare
def add_start_nodes(
    up: Ints,
    down: Ints,
    left: Ints,
    right: Ints,
    line: Ints,
    ends: Ends,
    strip: int,
    span: Floats,
    link: Ints,
    counters: Ints,
) -> None:
    """Add a node for every portal of the start's strip."""
    for portal in range(up[strip], up[strip + 1]):
        add_node(span, link, counters, 1.0 * left[portal], right[portal] + 1.0, 0.0, portal + 1, -1, -1)
    for portal in range(down[strip], down[strip + 1]):
        west, east, root, done = 1.0 * left[portal], right[portal] + 1.0, -1, 0.0
        if ends[1] == line[portal] + 1 and ends[0] < west:
            root, done = 2 * portal, west - ends[0]
        elif ends[1] == line[portal] + 1 and ends[0] > east:
            root, done = 2 * portal + 1, ends[0] - east
        add_node(span, link, counters, west, east, done, -portal - 1, root, -1)


@bare
def add_successors(
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
    counters: Ints,
    node: int,
    strip: int,
) -> None:
    """Add the nodes that follow a node which enters a strip: what its root sees of the other portals, and bends."""
    west, east, done = span[node, SPAN_WEST], span[node, SPAN_EAST], span[node, SPAN_LENGTH]
    symbol, root = link[node, LINK_PORTAL], link[node, LINK_ROOT]
    portal, upward, stamp = abs(symbol) - 1, symbol > 0, counters[STAMP_INDEX]
    corner = 2 * portal
    x, y = ends[0], ends[1]
    if root >= 0:
        x, y = 1.0 * (right[root >> 1] + 1 if root & 1 else left[root >> 1]), line[root >> 1] + 1.0
    depth = abs(line[portal] + 1.0 - y)
    if depth > 0.0:
        low, high = (
            snap_to_corner(x + (west - x) * (depth + 1.0) / depth),
            snap_to_corner(x + (east - x) * (depth + 1.0) / depth),
        )
    else:
        low, high = -np.inf if x > west else x, np.inf if x < east else x
    to_west, to_east = done + step_length(west - x, depth), done + step_length(east - x, depth)
    bend_west = west == left[portal] and (root == corner or update_best(best, seen, stamp, corner, to_west))
    bend_east = east == right[portal] + 1 and (
        root == corner + 1 or update_best(best, seen, stamp, corner + 1, to_east)
    )
    first, last, sign = (up[strip], up[strip + 1], 1) if upward else (down[strip], down[strip + 1], -1)
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
            add_node(span, link, counters, a, b if b < low else low, to_west, code, corner, node)
        if (a if a > low else low) < (b if b < high else high):
            add_node(span, link, counters, a if a > low else low, b if b < high else high, done, code, root, node)
        if bend_east and b > high:
            add_node(span, link, counters, a if a > high else high, b, to_east, code, corner + 1, node)
    if not (bend_west or bend_east):
        return
    first, last = (down[strip], down[strip + 1]) if upward else (up[strip], up[strip + 1])
    for near in range(first, last):
        a, b, code = 1.0 * left[near], right[near] + 1.0, -sign * (near + 1)
        other = lower[near] if upward else upper[near]
        if exits[other] == -code and enter[other] != stamp:
            continue
        if near < portal and bend_west:
            bend = add_node(span, link, counters, west, west, to_west, 0, corner, node)
            add_node(span, link, counters, a, b, to_west + west - b, code, 2 * near + 1, bend)
        elif near > portal and bend_east:
            bend = add_node(span, link, counters, east, east, to_east, 0, corner + 1, node)
            add_node(span, link, counters, a, b, to_east + a - east, code, 2 * near, bend)


@bare
def first_beyond(right: Ints, x: float, first: int, last: int) -> int:
    """Return the first of a strip's portals, numbered `first` to `last` - 1, that ends east of x."""
    while first < last:
        middle = (first + last) >> 1
        if right[middle] + 1.0 <= x:
            first = middle + 1
        else:
            last = middle
    return int(first)


@bare
def snap_to_corner(x: float) -> float:
    """Return x (in squares), or the whole number that it equals but for rounding."""
    corner = np.floor(x + 0.5)
    return float(corner if abs(x - corner) < CORNER_TOLERANCE else x)


@bare
def update_best(best: Floats, seen: Ints, stamp: int, corner: int, length: float) -> bool:
    """Record the length of a path to a corner, and return whether no shorter one is known."""
    if seen[corner] != stamp:
        best[corner], seen[corner] = length, stamp
        return True
    if length < best[corner]:
        best[corner] = length
    return bool(length <= best[corner] + CORNER_TOLERANCE)


@bare
def add_node(
    span: Floats, link: Ints, counters: Ints, west: float, east: float, done: float, symbol: int, root: int, parent: int
) -> int:
    """Write a node, without putting it on the heap, and return its number."""
    node = counters[NODE_COUNT]
    counters[NODE_COUNT] = node + 1
    span[node, SPAN_WEST], span[node, SPAN_EAST], span[node, SPAN_LENGTH] = west, east, done
    link[node, LINK_PORTAL], link[node, LINK_ROOT], link[node, LINK_PARENT] = symbol, root, parent
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
    counters: Ints,
    first: int,
) -> int:
    """Put the nodes from number `first` on the heap, but return the best one instead when it comes next."""
    size, stamp, next_node, least = counters[HEAP_SIZE], counters[STAMP_INDEX], NO_PATH, np.inf
    for node in range(first, counters[NODE_COUNT]):
        west, east, done, root = (
            span[node, SPAN_WEST],
            span[node, SPAN_EAST],
            span[node, SPAN_LENGTH],
            link[node, LINK_ROOT],
        )
        total = done
        if east >= west:
            if link[node, LINK_PORTAL] == 0 or (root >= 0 and not update_best(best, seen, stamp, root, done)):
                continue
            x, y = ends[0], ends[1]
            if root >= 0:
                x, y = 1.0 * (right[root >> 1] + 1 if root & 1 else left[root >> 1]), line[root >> 1] + 1.0
            at = line[abs(link[node, LINK_PORTAL]) - 1] + 1.0
            near, far = abs(at - y), abs(ends[3] - at)
            cross = x + (ends[2] - x) * near / (near + far) if near + far > 0.0 else ends[2]
            cross = west if cross < west else east if cross > east else cross
            total += step_length(cross - x, near) + step_length(ends[2] - cross, far)
        if total >= limit:
            continue
        if total >= least:
            size = push(key, heap, size, total, node)
            continue
        if next_node >= 0:
            size = push(key, heap, size, least, next_node)
        next_node, least = node, total
    if size > 0 and next_node >= 0 and key[0] < least:
        size, next_node = push(key, heap, size, least, next_node), NO_PATH
    counters[HEAP_SIZE] = size
    return next_node


@bare
def add_goal_node(
    left: Ints, right: Ints, line: Ints, ends: Ends, span: Floats, link: Ints, counters: Ints, node: int
) -> None:
    """Add the goal as a node, if it is reached from a node's root within the strip that the node enters."""
    portal, root = abs(link[node, LINK_PORTAL]) - 1, link[node, LINK_ROOT]
    west, east = span[node, SPAN_WEST], span[node, SPAN_EAST]
    x, y = ends[0], ends[1]
    if root >= 0:
        x, y = 1.0 * (right[root >> 1] + 1 if root & 1 else left[root >> 1]), line[root >> 1] + 1.0
    near, far = abs(line[portal] + 1.0 - y), abs(ends[3] - line[portal] - 1.0)
    cross = x + (ends[2] - x) * near / (near + far) if near + far > 0.0 else x
    if cross < west - CORNER_TOLERANCE and west != left[portal]:
        return
    if cross > east + CORNER_TOLERANCE and east != right[portal] + 1:
        return
    cross = west if cross < west else east if cross > east else cross
    total = span[node, SPAN_LENGTH] + step_length(cross - x, near) + step_length(ends[2] - cross, far)
    add_node(span, link, counters, 1.0, 0.0, total, 0, root, node)


@bare
def spell_word(link: Ints, node: int, word: Ints) -> int:
    """Write the reduced word of the portals on the path to a node, and return its size."""
    size = 0
    while node >= 0:
        size = append_symbol(word, size, -link[node, LINK_PORTAL])
        node = link[node, LINK_PARENT]
    for k in range((size + 1) // 2):
        word[k], word[size - 1 - k] = -word[size - 1 - k], -word[k]
    return size
