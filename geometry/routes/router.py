"""The routing kernel: anchor start and goal on the skeleton, find paths over the pathgraph, pull each one tight."""

from typing import NamedTuple

import numpy as np

from geometry.homotopy.funnel import Ends, Funnel, measure_line, new_funnel, tighten_word
from geometry.homotopy.landmarks import Anchor, Landmarks, add_chain, add_word, ascend, locate
from geometry.homotopy.strips import Strips
from geometry.kernels.arrays import Floats, Ints
from geometry.kernels.jit import bare
from geometry.routes.astar import RouteQuery, Search, new_search
from geometry.routes.k_shortest import PathStore, k_shortest_paths, new_path_store
from geometry.routes.layer import Layer
from geometry.skeleton.chains import Chains
from geometry.skeleton.skeleton import Flags, Heights, States


class RouteAnswers(NamedTuple):
    """Room for the routes found; what belongs to route k lies between its bounds k and k + 1.

    Attributes
    ----------
    bounds : (room + 1, 3) bounds in `corners`, `crossings` and `chains`: those of route k are from bounds[k] to
        bounds[k + 1], excluded.
    corners : (size, 2) corners (x, y) of the routes, in squares from the screen's south-west corner.
    crossings : (size,) signed crossing numbers of the portals that the routes cross, negative when crossed southwards.
    chains : (size,) numbers of the chains of the pathgraph.
    length : (room,) of each route, in squares.
    lowest : (room,) the least squared clearance on each route's path over the skeleton, in squared half squares.
    """

    bounds: Ints
    corners: Floats
    crossings: Ints
    chains: Ints
    length: Floats
    lowest: Ints


class RouterBuffers(NamedTuple):
    """All scratch of a query.

    Attributes
    ----------
    query : the nodes and arcs that the query adds to the pathgraph.
    search : scratch of A*.
    store : the paths over the pathgraph.
    funnel : scratch for pulling a path tight.
    answers : the routes found.
    start : (room,) word (signed portals: index plus 1, negative when crossed southwards) from the start up to the
        skeleton.
    goal : (room,) word from the goal up to the skeleton.
    whole : (room,) word from start to goal.
    stretch : (n + 2, 3) the chains that a path follows, each with the positions (indices of its cells) between which; n
        is the number of nodes.
    """

    query: RouteQuery
    search: Search
    store: PathStore
    funnel: Funnel
    answers: RouteAnswers
    start: Ints
    goal: Ints
    whole: Ints
    stretch: Ints


def new_router_buffers(
    nodes: int, chains: int, landmark_count: int, wanted: int, room: int, closed_steps: Ints
) -> RouterBuffers:
    """Return scratch for a query, with room for its answers; no chain is closed in it.

    It holds the arcs that the query adds to the pathgraph, scratch of the searches, the paths found, words of signed
    portals, and the routes found as arrays (corners in squares, crossing numbers, chains, lengths).

    A chain is an edge of the pathgraph (whose nodes are the junctions and ends of the skeleton), with its cells. A
    portal is the overlap of two strips (rows of free squares) in neighbouring rows.

    Parameters
    ----------
    nodes, chains, landmark_count : the numbers of nodes, chains and landmarks of the pathgraph.
    wanted : the number of routes, at least 1.
    room : symbols (signed portals: index plus 1, negative when crossed southwards) of the longest word.
    closed_steps : (b, 2) chain and position of steps that may not be taken: each from the cell at that position on the
        chain to the next.
    """
    query = RouteQuery(
        np.empty(4, np.int32),
        np.empty(5),
        np.empty((2, landmark_count)),
        np.zeros(4),
        np.zeros(chains, np.uint8),
        closed_steps,
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


class RoutingData(NamedTuple):
    """Arrays of a layer as the kernels read them, flat where they are read by cell.

    Attributes
    ----------
    heights : (cells,) squared clearances in squared half squares, flat and padded.
    states : (cells,) links and flags of the skeleton, 0 off it.
    width : columns of the padded grid; a cell's index is (row + 1) * width + column + 1.
    chains : the edges of the pathgraph, with their cells.
    strips : maximal horizontal rows of free squares, and the portals between neighbouring ones.
    landmarks : words and lengths of the chains, and distances from some nodes.
    body : True for a body, False for a point.
    """

    heights: Heights
    states: Flags
    width: int
    chains: Chains
    strips: Strips
    landmarks: Landmarks
    body: bool


def routing_data(layer: Layer) -> RoutingData:
    """Return what the kernels read of a layer, the free space of a body of one radius; the arrays are views.

    That is: squared clearances (squared half squares) and states of the skeleton, both flat over the padded grid, the
    grid's width, and the chains, strips, landmarks and kind (body or point) of the layer.
    """
    heights, states = layer.square.reshape(-1), layer.state.reshape(-1)
    return RoutingData(heights, states, layer.square.shape[1], layer.chains, layer.runs, layer.landmarks, layer.body)


@bare
def itineraries(data: RoutingData, ends: Ends, wanted: int, buffers: RouterBuffers) -> int:
    """Fill the answers with up to `wanted` tight routes and return their number, or ROUTER_OVERFLOW.

    The routes stand in the order of their paths over the pathgraph, shortest first. When one is wanted, up to three are
    found: the best paths for several biases, of which the shortest is meant. Return 0 when goal and start are not
    connected. ROUTER_OVERFLOW says that some scratch is too small.

    Parameters
    ----------
    data : the layer's arrays: clearances, states of the skeleton, chains, strips and landmarks.
    ends : x and y of the start, x and y of the goal, in squares from the screen's south-west corner, in free squares.
    wanted : how many routes at most, at least 1; the number for which the buffers were made.
    buffers : scratch; the routes are left in `buffers.answers`.
    """
    heights, states, width, chains, strips, landmarks, body = data
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
        set_split_chains(query.closed, start, goal, 2)
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
                strips, body, buffers.whole, size, ends, buffers.funnel, stretch, steps, buffers.answers, written
            ):
                return ROUTER_OVERFLOW
            written += 1
        if wanted > 1 or found == 0 or buffers.answers.length[written - 1] <= enough:
            break
    return written


@bare
def set_split_chains(closed: States, start: Anchor, goal: Anchor, flag: int) -> None:
    """Close the chains that start and goal split (flag 2), or open them again (flag 0).

    Chains closed on request (bit 0) stay closed. An end at a node splits none. A chain is an edge of the pathgraph
    (whose nodes are the junctions and ends of the skeleton), with its cells.

    Parameters
    ----------
    closed : (m,) of the query, by chain; changed.
    start, goal : where the steepest ascents from the ends meet the pathgraph: chain, position on it, node (-1 inside a
        chain), and cell.
    flag : 2 to close, 0 to open.
    """
    if start.node < 0:
        closed[start.chain] = closed[start.chain] & 1 | flag
    if goal.node < 0:
        closed[goal.chain] = closed[goal.chain] & 1 | flag


@bare
def set_bias(line: Floats, ends: Ends, bias: float) -> None:
    """Set the query's line so that arcs far from the straight line cost more.

    The cost grows by the share `bias` times the distance of the arc's head from the straight line, in lengths of that
    line.

    Parameters
    ----------
    line : (4,) of the query, written: the start (x, y) in squares from the screen's south-west corner, and the scaled
        normal of the straight line.
    ends : x and y of the start, x and y of the goal, in squares.
    bias : the share, without unit; 0 for none, the normal is then 0.
    """
    dx, dy = ends[2] - ends[0], ends[3] - ends[1]
    square = dx * dx + dy * dy
    if square < 1.0:
        square = 1.0
    line[0], line[1] = ends[0], ends[1]
    line[2], line[3] = -dy * bias / square, dx * bias / square


@bare
def set_query_arcs(query: RouteQuery, start: Anchor, goal: Anchor, ends: Ints, starts: Ints, length: Floats) -> None:
    """Set the nodes and the lengths of the five arcs that link start and goal to the pathgraph; nothing is returned.

    Arcs 0 and 1 lead from the start to the first and to the last node of its chain, arcs 2 and 3 from the first and
    from the last node of the goal's chain to the goal, and arc 4 from the start to the goal along a chain that both
    share. An end that lies at a node has its first arc, to that node, of length 0, and no second. When both lie on one
    chain, the arcs that would pass the other end are closed; when both lie in one cell, arc 4 of length 0 alone is
    left. A chain is an edge of the pathgraph (whose nodes are the junctions and ends of the skeleton), with its cells.

    Parameters
    ----------
    query : written are `joint`, the node at the other end of arcs 0 to 3 (-1 for none), and `cost`, the lengths of all
        five in squares (infinite for arcs that there are not). `closed_steps` is read: chain and position of steps that
        may not be taken; an arc over one of them is infinite.
    start, goal : where the steepest ascents from the ends meet the pathgraph: chain, position on it, node (-1 inside a
        chain), and cell.
    ends : (m, 2) the first and the last node of each chain.
    starts : (m + 1,) where the cells of each chain begin.
    length : (m,) of the chains, in squares.
    """
    joint, cost, closed_steps = query.joint, query.cost, query.closed_steps
    for k in range(2):
        anchor = goal if k else start
        for j in range(2):
            if anchor.node < 0:
                end = j * (starts[anchor.chain + 1] - starts[anchor.chain] - 1)
                joint[2 * k + j] = ends[anchor.chain, j]
                cost[2 * k + j] = length_between(closed_steps, starts, length, anchor.chain, anchor.position, end)
            else:
                joint[2 * k + j] = anchor.node if j == 0 else -1
                cost[2 * k + j] = 0.0 if j == 0 else np.inf
    cost[4] = np.inf
    if start.cell == goal.cell:
        for k in range(4):
            cost[k] = np.inf
        cost[4] = 0.0
    elif start.chain == goal.chain and start.node < 0 and goal.node < 0:
        cost[4] = length_between(closed_steps, starts, length, start.chain, start.position, goal.position)
        backward = int(start.position > goal.position)  # the arcs that would pass the other end and come back
        cost[1 - backward] = cost[2 + backward] = np.inf


@bare
def length_between(closed_steps: Ints, starts: Ints, length: Floats, chain: int, begin: int, end: int) -> float:
    """Return the length of a part of a chain in squares, in proportion to its cells; infinite with a closed step.

    It is 0 from a position to itself.

    A chain is an edge of the pathgraph (whose nodes are the junctions and ends of the skeleton), with its cells.

    Parameters
    ----------
    closed_steps : (b, 2) chain and position of steps that may not be taken, each to the next position.
    starts : (m + 1,) where the cells of each chain begin.
    length : (m,) of the chains, in squares.
    chain : the number of the chain.
    begin, end : positions on it, indices of its cells from 0, in either order.
    """
    low, high = (begin, end) if begin < end else (end, begin)
    for k in range(closed_steps.shape[0]):
        if closed_steps[k, 0] == chain and low <= closed_steps[k, 1] < high:
            return np.inf
    return float(length[chain] * (high - low) / (starts[chain + 1] - starts[chain] - 1))


@bare
def fill_end_distances(joint: Ints, cost: Floats, sight: Floats, out: Floats) -> None:
    """Write the distances of goal and start from the landmarks to `out`, in squares.

    Parameters
    ----------
    joint : (4,) the nodes to which the start's two arcs lead (0, 1) and from which the goal's two come (2, 3).
    cost : (5,) the lengths of these arcs, and of that from start to goal, in squares; infinite where there is none.
    sight : (n, landmarks) the nodes' distances, in squares, from the landmarks (nodes chosen in advance).
    out : (2, landmarks) written: the goal's (row 0) and the start's (row 1); infinite where no arc leads to a node.
    """
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
    """Write the chains that a path follows and the positions between which, and return their number.

    A chain is an edge of the pathgraph (whose nodes are the junctions and ends of the skeleton), with its cells.

    Parameters
    ----------
    ends : (m, 2) the first and the last node of each chain.
    starts : (m + 1,) where the cells of each chain begin.
    arcs : (room, longest) arc codes of paths (2 chain, plus 1 when walked backwards; see astar.py).
    row, size : the path's row there, and its number of arcs.
    start, goal : where the steepest ascents from the ends meet the pathgraph: chain, position on it, node (-1 inside a
        chain), and cell.
    out : (n, 3) written from row 0 on: chain, first and last position, in the order of the path; positions are indices
        of the chain's cells from 0. Arcs without length, at an end that lies at a node, are left out.
    """
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
    """Return whether a path follows the same chains, in the same order, as one of the routes written.

    A chain is an edge of the pathgraph (whose nodes are the junctions and ends of the skeleton), with its cells.

    Parameters
    ----------
    bounds, chains : of the answers: which chains the routes follow.
    written : the number of routes written.
    stretch : (n, 3) the path's chains, in column 0.
    steps : how many rows of `stretch` count.
    """
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
    """Return the least squared clearance on a path, at most `lowest`, in squared half squares.

    A cell's index is (row + 1) * width + column + 1, with width = columns + 2. A chain is an edge of the pathgraph
    (whose nodes are the junctions and ends of the skeleton), with its cells.

    Parameters
    ----------
    starts, cells, neck : of the chains: where the cells of each begin, the cells, and the index of its lowest cell.
    heights : (cells,) squared clearances in squared half squares, flat and padded.
    stretch : (n, 3) the path's chains, and the positions between which, in either order.
    steps : how many rows of `stretch` count.
    lowest : the least squared clearance elsewhere, at the ends; returned when no cell of the path is lower.
    """
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
    """Write the reduced word of a path from start to goal, and return its size.

    A size equal to the length of `word` says that there was not enough room. A chain is an edge of the pathgraph (whose
    nodes are the junctions and ends of the skeleton), with its cells. A word is reduced when no symbol stands next to
    its negative. A portal is the overlap of two strips (rows of free squares) in neighbouring rows.

    Parameters
    ----------
    starts : (m + 1,) where the cells of each chain begin.
    landmarks : the words of the chains.
    rise, risen : the word (signed portals) from the start up to the skeleton, and its size.
    stretch, steps : the chains that the path follows and the positions between which, (n, 3), and their number.
    fall, fallen : the word from the goal up to the skeleton, and its size; it is appended backwards.
    word : written: signed portals, negative when crossed southwards.
    """
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
    body: bool,
    word: Ints,
    size: int,
    ends: Ends,
    funnel: Funnel,
    stretch: Ints,
    steps: int,
    answers: RouteAnswers,
    k: int,
) -> bool:
    """Pull a word tight and write it as the k-th route; return False when there is no room.

    A chain is an edge of the pathgraph (whose nodes are the junctions and ends of the skeleton), with its cells.

    Parameters
    ----------
    strips : the strips of free squares (maximal horizontal rows), and the portals between those of neighbouring rows.
    body : True for a body, which keeps to the lines between centres of squares; False for a point.
    word, size : signed portals (index plus 1, negative when crossed southwards) from start to goal, and their number.
    ends : x and y of the start, x and y of the goal, in squares from the screen's south-west corner.
    funnel : scratch, of the same room as `word`.
    stretch, steps : the chains that the path follows, in column 0, and their number.
    answers : written, but for `lowest`: corners (squares), crossing numbers, chains and length (squares) of route k,
        behind those of the routes before it, and the bounds behind it.
    k : the number of the route, from 0; those before it must be written.
    """
    bounds, line, crossings, chains = answers.bounds, answers.corners, answers.crossings, answers.chains
    corner, crossing, chain = bounds[k, 0], bounds[k, 1], bounds[k, 2]
    room, needed = line.shape[0] - corner, 4 * size + 8
    if size >= word.shape[0] or room < needed or funnel.x.shape[0] < needed:
        return False
    if crossings.shape[0] < crossing + size or chains.shape[0] < chain + steps:
        return False
    line = line[corner:]
    corners = tighten_word(strips.left, strips.right, strips.line, body, word, size, ends, funnel, line)
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
