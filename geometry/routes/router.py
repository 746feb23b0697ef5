"""The routing kernel: anchor start and goal on the skeleton, find paths over the pathgraph, pull each one tight."""

from typing import NamedTuple

import numpy as np

from utak.geometry.homotopy.funnel import Ends, Funnel, measure_line, new_funnel, tighten_word
from utak.geometry.homotopy.landmarks import Anchor, Landmarks, add_chain, add_word, ascend, locate
from utak.geometry.homotopy.strips import Strips
from utak.geometry.kernels.arrays import Floats, Ints
from utak.geometry.kernels.jit import bare
from utak.geometry.routes.astar import RouteQuery, Search, new_search
from utak.geometry.routes.k_shortest import PathStore, k_shortest_paths, new_path_store
from utak.geometry.routes.layer import Layer
from utak.geometry.skeleton.skeleton import Heights, States


class RouteAnswers(NamedTuple):
    """Room for the routes found; what belongs to route k lies between its bounds k and k + 1."""

    # (room + 1, 3) bounds in `corners`, `crossings` and `chains`: those of route k are from bounds[k] to bounds[k + 1],
    # excluded
    bounds: Ints
    corners: Floats  # (size, 2) corners (x, y) of the routes, in squares from the screen's south-west corner
    # (size,) signed crossing numbers of the portals that the routes cross, negative when crossed southwards
    crossings: Ints
    chains: Ints  # (size,) numbers of the chains of the pathgraph
    length: Floats  # (room,) of each route, in squares
    lowest: Ints  # (room,) the least squared clearance on each route's path over the skeleton, in squared half squares


class RouterBuffers(NamedTuple):
    """All scratch of a query."""

    query: RouteQuery  # the nodes and arcs that the query adds to the pathgraph
    search: Search  # scratch of A*
    store: PathStore  # the paths over the pathgraph
    funnel: Funnel  # scratch for pulling a path tight
    answers: RouteAnswers  # the routes found
    # (room,) word (signed portals: index plus 1, negative when crossed southwards) from the start up to the skeleton
    start: Ints
    goal: Ints  # (room,) word from the goal up to the skeleton
    whole: Ints  # (room,) word from start to goal
    # (n + 2, 3) the chains that a path follows, each with the positions (indices of its cells) between which; n is the
    # number of nodes
    stretch: Ints


def new_router_buffers(nodes: int, chains: int, landmark_count: int, wanted: int, room: int) -> RouterBuffers:
    """Return scratch for a query, with room for its answers; no chain is closed in it."""
    query = RouteQuery(
        np.empty(4, np.int32),
        np.empty(5),
        np.empty((2, landmark_count)),
        np.zeros(4),
        np.zeros(chains, np.uint8),
    )
    answered = wanted if wanted > 1 else len(BIASES)
    answers = RouteAnswers(
        np.zeros((answered + 1, 3), np.int32),
        np.empty((8 * room, 2)),
        np.empty(room * answered, np.int32),
        np.empty((nodes + 2) * answered, np.int32),
        np.empty(answered),
        np.empty(answered, np.int32),
    )
    start, goal, whole = (np.empty(room, np.int32) for _ in range(3))
    stretch = np.empty((nodes + 2, 3), np.int32)
    return RouterBuffers(
        query,
        new_search(nodes, chains),
        new_path_store(wanted, nodes + 2),
        new_funnel(room),
        answers,
        start,
        goal,
        whole,
        stretch,
    )


ROUTER_OVERFLOW = -1  # returned when some scratch is too small
BIASES = 0.2, 6.0, 1.0  # shares of arc length (see set_bias); by trial among the best three on the benchmark maps
STRAIGHT_ENOUGH = 1.02  # times the straight line: a route no longer than this ends the search for a shorter one


@bare
def itineraries(layer: Layer, ends: Ends, wanted: int, buffers: RouterBuffers) -> int:
    """Fill the answers with up to `wanted` tight routes and return their number, or ROUTER_OVERFLOW."""
    heights, states, width, chains, strips, landmarks = layer
    query, store = buffers.query, buffers.store
    rows, up, left = strips.row, strips.up, strips.left
    first = (int(ends[1]) + 1) * width + int(ends[0]) + 1
    last = (int(ends[3]) + 1) * width + int(ends[2]) + 1
    above, rise = ascend(first, heights, states, width, rows, up, left, buffers.start)
    start = locate(above, states, width, chains.node, chains.leave, chains.start, chains.cells)
    above, fall = ascend(last, heights, states, width, rows, up, left, buffers.goal)
    goal = locate(above, states, width, chains.node, chains.leave, chains.start, chains.cells)
    if rise >= buffers.start.shape[0] or fall >= buffers.start.shape[0]:
        return ROUTER_OVERFLOW
    set_query_arcs(query, start, goal, chains.ends, chains.start, landmarks.length)
    fill_end_distances(query.joint, query.cost, landmarks.sight, query.sight)
    floor = heights[first] if heights[first] < heights[last] else heights[last]
    stretch, written = buffers.stretch, 0
    enough = STRAIGHT_ENOUGH * np.sqrt((ends[2] - ends[0]) ** 2 + (ends[3] - ends[1]) ** 2)
    for bias in BIASES:
        set_bias(query.line, ends, bias if wanted == 1 else 0.0)
        set_split_chains(query.closed, start, goal, 1)
        found = k_shortest_paths(chains.ends, landmarks, query, buffers.search, store, wanted)
        set_split_chains(query.closed, start, goal, 0)
        for k in range(found):
            row = 0 + store.place[k]
            steps = write_stretches(
                chains.ends, chains.start, store.arcs, row, 0 + store.size[row], start, goal, stretch
            )
            if wanted == 1 and is_repeated(buffers.answers.bounds, buffers.answers.chains, written, stretch, steps):
                return written
            low = lowest_square_on(chains.start, chains.cells, chains.neck, heights, stretch, steps, floor)
            buffers.answers.lowest[written] = low
            size = write_word(
                chains.start, landmarks, buffers.start, rise, stretch, steps, buffers.goal, fall, buffers.whole
            )
            if not write_route(
                strips, buffers.whole, size, ends, buffers.funnel, stretch, steps, buffers.answers, written
            ):
                return ROUTER_OVERFLOW
            written += 1
        if wanted > 1 or found == 0 or buffers.answers.length[written - 1] <= enough:
            break
    return written


@bare
def set_split_chains(closed: States, start: Anchor, goal: Anchor, flag: int) -> None:
    """Close the chains that start and goal split (flag 1), or open them again (flag 0)."""
    if start.node < 0:
        closed[start.chain] = flag
    if goal.node < 0:
        closed[goal.chain] = flag


@bare
def set_bias(line: Floats, ends: Ends, bias: float) -> None:
    """Set the query's line so that arcs far from the straight line cost more."""
    dx, dy = ends[2] - ends[0], ends[3] - ends[1]
    square = dx * dx + dy * dy
    if square < 1.0:
        square = 1.0
    line[0], line[1] = ends[0], ends[1]
    line[2], line[3] = -dy * bias / square, dx * bias / square


@bare
def set_query_arcs(query: RouteQuery, start: Anchor, goal: Anchor, ends: Ints, starts: Ints, length: Floats) -> None:
    """Set the nodes and the lengths of the five arcs that link start and goal to the pathgraph; nothing is returned."""
    # When both lie on one chain, the arcs that would pass the other end are closed; when both lie in one cell, arc 4 of
    # length 0 alone is left.
    joint, cost = query.joint, query.cost
    for k in range(2):
        anchor = goal if k else start
        for j in range(2):
            if anchor.node < 0:
                end = j * (starts[anchor.chain + 1] - starts[anchor.chain] - 1)
                joint[2 * k + j] = ends[anchor.chain, j]
                cost[2 * k + j] = length_between(starts, length, anchor.chain, anchor.position, end)
            else:
                joint[2 * k + j] = anchor.node if j == 0 else -1
                cost[2 * k + j] = 0.0 if j == 0 else np.inf
    cost[4] = np.inf
    if start.cell == goal.cell:
        for k in range(4):
            cost[k] = np.inf
        cost[4] = 0.0
    elif start.chain == goal.chain and start.node < 0 and goal.node < 0:
        cost[4] = length_between(starts, length, start.chain, start.position, goal.position)
        backward = int(start.position > goal.position)  # the arcs that would pass the other end and come back
        cost[1 - backward] = cost[2 + backward] = np.inf


@bare
def length_between(starts: Ints, length: Floats, chain: int, begin: int, end: int) -> float:
    """Return the length of a part of a chain in squares, in proportion to its cells."""
    return float(length[chain] * abs(end - begin) / (starts[chain + 1] - starts[chain] - 1))


@bare
def fill_end_distances(joint: Ints, cost: Floats, sight: Floats, out: Floats) -> None:
    """Write the distances of goal and start from the landmarks to `out`, in squares."""
    for k in range(sight.shape[1]):
        for end in range(2):
            least = np.inf
            for j in range(2 - 2 * end, 4 - 2 * end):
                if cost[j] < np.inf and cost[j] + sight[joint[j], k] < least:
                    least = cost[j] + sight[joint[j], k]
            out[end, k] = least


@bare
def write_stretches(
    ends: Ints, starts: Ints, arcs: Ints, row: int, size: int, start: Anchor, goal: Anchor, out: Ints
) -> int:
    """Write the chains that a path follows and the positions between which, and return their number."""
    first, used = 2 * ends.shape[0], 0
    for k in range(size):
        code = arcs[row, k]
        extra = code - first
        if extra < 0:
            chain, last = code >> 1, starts[(code >> 1) + 1] - starts[code >> 1] - 1
            begin, end = last * (code & 1), last * (1 - (code & 1))
        elif extra == 4:
            chain, begin, end = start.chain, start.position, goal.position
            if start.cell == goal.cell:
                continue
        else:
            anchor = start if extra < 2 else goal
            if anchor.node >= 0:
                continue
            chain, begin = anchor.chain, anchor.position
            end = (starts[chain + 1] - starts[chain] - 1) * (extra & 1)
            if extra >= 2:
                begin, end = end, begin
        out[used, 0], out[used, 1], out[used, 2] = chain, begin, end
        used += 1
    return used


@bare
def is_repeated(bounds: Ints, chains: Ints, written: int, stretch: Ints, steps: int) -> bool:
    """Return whether a path follows the same chains, in the same order, as one of the routes written."""
    for route in range(written):
        first = bounds[route, 2]
        same = steps == bounds[route + 1, 2] - first
        for k in range(steps if same else 0):
            same = same and chains[first + k] == stretch[k, 0]
        if same:
            return True
    return False


@bare
def lowest_square_on(
    starts: Ints, cells: Ints, neck: Ints, heights: Heights, stretch: Ints, steps: int, lowest: int
) -> int:
    """Return the least squared clearance on a path, at most `lowest`, in squared half squares."""
    for k in range(steps):
        chain = stretch[k, 0]
        low, high = stretch[k, 1], stretch[k, 2]
        if low > high:
            low, high = high, low
        first = starts[chain]
        if low <= neck[chain] - first <= high:
            low = high = neck[chain] - first
        for j in range(first + low, first + high + 1):
            lowest = heights[cells[j]] if heights[cells[j]] < lowest else lowest
    return lowest


@bare
def write_word(
    starts: Ints,
    landmarks: Landmarks,
    rise: Ints,
    risen: int,
    stretch: Ints,
    steps: int,
    fall: Ints,
    fallen: int,
    word: Ints,
) -> int:
    """Write the reduced word of a path from start to goal, and return its size."""
    symbol, words, spelt = landmarks.symbol, landmarks.word, landmarks.spelt
    size = add_word(rise, 0, risen, False, word, 0)
    for k in range(steps):
        chain, begin, end = 0 + stretch[k, 0], 0 + stretch[k, 1], 0 + stretch[k, 2]
        if abs(end - begin) == starts[chain + 1] - starts[chain] - 1:
            size = add_word(words, 0 + spelt[chain], 0 + spelt[chain + 1], end < begin, word, size)
        else:
            size = add_chain(starts, symbol, chain, begin, end, word, size)
    return add_word(fall, 0, fallen, True, word, size)


@bare
def write_route(
    strips: Strips,
    word: Ints,
    size: int,
    ends: Ends,
    funnel: Funnel,
    stretch: Ints,
    steps: int,
    answers: RouteAnswers,
    k: int,
) -> bool:
    """Pull a word tight and write it as the k-th route; return False when there is no room."""
    bounds, line, crossings, chains = answers.bounds, answers.corners, answers.crossings, answers.chains
    corner, crossing, chain = bounds[k, 0], bounds[k, 1], bounds[k, 2]
    room, needed = line.shape[0] - corner, 4 * size + 8
    if size >= word.shape[0] or room < needed or funnel.x.shape[0] < needed:
        return False
    if crossings.shape[0] < crossing + size or chains.shape[0] < chain + steps:
        return False
    line = line[corner:]
    corners = tighten_word(strips.left, strips.right, strips.line, word, size, ends, funnel, line)
    answers.length[k] = measure_line(line, corners)
    number = strips.crossing
    for j in range(size):
        crossed = number[abs(word[j]) - 1]
        if crossed != 0:
            crossings[crossing] = crossed if word[j] > 0 else -crossed
            crossing += 1
    for j in range(steps):
        chains[chain + j] = stretch[j, 0]
    bounds[k + 1, 0], bounds[k + 1, 1], bounds[k + 1, 2] = corner + corners, crossing, chain + steps
    return True
