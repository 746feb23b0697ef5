"""From start and goal to tight routes: anchor both on the skeleton, find ways over the pathgraph, pull each rope
tight.
"""

from typing import NamedTuple

import numpy as np

from geometry.homotopy.funnel import Ends, Funnel, measure_line, new_rope, tighten_word
from geometry.homotopy.landmarks import Anchor, Landmarks, add_chain, add_word, ascend, locate
from geometry.homotopy.strips import Strips
from geometry.kernels.arrays import Floats, Ints
from geometry.kernels.jit import bare
from geometry.routes.astar import RouteQuery, Search, new_search
from geometry.routes.k_shortest import PathStore, new_album, shortest_ways
from geometry.routes.layer import Layer
from geometry.skeleton.chains import Chains
from geometry.skeleton.skeleton import Flags, Heights, States


class RouteAnswers(NamedTuple):
    """Room for the routes found. What belongs to route k lies between its bounds k and k + 1."""

    bounds: Ints
    """(room + 1, 3) bounds in ``corners``, ``crossings`` and ``chains``."""
    corners: Floats
    """(size, 2) corners of the routes, in squares."""
    crossings: Ints
    """(size,) signed crossing numbers."""
    chains: Ints
    """(size,) chains of the pathgraph."""
    length: Floats
    """(room,) in squares."""
    lowest: Ints
    """(room,) the least squared clearance on the way over the skeleton, in half squares."""


class RouterBuffers(NamedTuple):
    """All scratch of a query."""

    query: RouteQuery
    search: Search
    album: PathStore
    rope: Funnel
    answers: RouteAnswers
    start: Ints
    """From the start up to the skeleton."""
    goal: Ints
    """From the goal up to the skeleton."""
    whole: Ints
    """From start to goal."""
    stretch: Ints
    """(n + 2, 3) chains that a way walks, and the positions between which."""


def new_desk(nodes: int, chains: int, sights: int, wanted: int, room: int, bars: Ints) -> RouterBuffers:
    """Scratch for ``wanted`` routes of words up to ``room`` over a pathgraph of that size."""
    query = RouteQuery(
        np.empty(4, np.int32),
        np.empty(5),
        np.empty((2, sights)),
        np.zeros(4),
        np.zeros(chains, np.uint8),
        bars,
    )
    answered = wanted if wanted > 1 else len(BOWS)
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
        new_album(wanted, nodes + 2),
        new_rope(room),
        answers,
        start,
        goal,
        whole,
        stretch,
    )


OVERFLOW = -1
BOWS = 0.2, 6.0, 1.0  # by trial among the best three on the benchmark maps and others like them (docs/geometry.md)
ENOUGH = 1.02  # times the straight line: no other way is looked for when a rope is no longer


class RoutingData(NamedTuple):
    """What a query reads of a layer, for kernels."""

    heights: Heights
    states: Flags
    width: int
    chains: Chains
    runs: Strips
    ways: Landmarks
    body: bool


def ground_of(layer: Layer) -> RoutingData:
    """The same arrays, flat where they are read by cell."""
    heights, states = layer.square.reshape(-1), layer.state.reshape(-1)
    return RoutingData(heights, states, layer.square.shape[1], layer.chains, layer.runs, layer.ways, layer.body)


@bare
def itineraries(ground: RoutingData, ends: Ends, wanted: int, desk: RouterBuffers) -> int:
    """Fill the desk's answers with up to ``wanted`` tight routes, by the length of their ways over the pathgraph.

    When one is wanted, with up to three, the best ways for several bows, of which the shortest is meant. Returns their
    number, or OVERFLOW when some scratch is too small.
    """
    heights, states, width, chains, runs, ways, body = ground
    query, album = desk.query, desk.album
    rows, up, left = runs.row, runs.up, runs.left
    first = (int(ends[1]) + 1) * width + int(ends[0]) + 1
    last = (int(ends[3]) + 1) * width + int(ends[2]) + 1
    above, rise = ascend(first, heights, states, width, rows, up, left, desk.start)
    start = locate(above, states, width, chains.node, chains.leave, chains.start, chains.cells)
    above, fall = ascend(last, heights, states, width, rows, up, left, desk.goal)
    goal = locate(above, states, width, chains.node, chains.leave, chains.start, chains.cells)
    if rise >= desk.start.shape[0] or fall >= desk.start.shape[0]:
        return OVERFLOW
    pose(query, start, goal, chains.ends, chains.start, ways.length)
    sight_ends(query.joint, query.cost, ways.sight, query.sight)
    floor = heights[first] if heights[first] < heights[last] else heights[last]
    stretch, written = desk.stretch, 0
    enough = ENOUGH * np.sqrt((ends[2] - ends[0]) ** 2 + (ends[3] - ends[1]) ** 2)
    for share in BOWS:
        bow(query.line, ends, share if wanted == 1 else 0.0)
        split(query.shut, start, goal, 2)
        found = shortest_ways(chains.ends, ways, query, desk.search, album, wanted)
        split(query.shut, start, goal, 0)
        for k in range(found):
            row = 0 + album.place[k]
            steps = stretches(chains.ends, chains.start, album.arcs, row, 0 + album.size[row], start, goal, stretch)
            if wanted == 1 and repeats(desk.answers.bounds, desk.answers.chains, written, stretch, steps):
                return written
            low = lowest_on(chains.start, chains.cells, chains.neck, heights, stretch, steps, floor)
            desk.answers.lowest[written] = low
            size = spell(chains.start, ways, desk.start, rise, stretch, steps, desk.goal, fall, desk.whole)
            if not publish(runs, body, desk.whole, size, ends, desk.rope, stretch, steps, desk.answers, written):
                return OVERFLOW
            written += 1
        if wanted > 1 or found == 0 or desk.answers.length[written - 1] <= enough:
            break
    return written


@bare
def split(shut: States, start: Anchor, goal: Anchor, flag: int) -> None:
    """Shut the chains that an anchor splits (flag 2), or open them again (0)."""
    if start.node < 0:
        shut[start.chain] = shut[start.chain] & 1 | flag
    if goal.node < 0:
        shut[goal.chain] = shut[goal.chain] & 1 | flag


@bare
def bow(line: Floats, ends: Ends, share: float) -> None:
    """Make arcs dearer by that share of their length times their distance from the straight line, in its lengths."""
    dx, dy = ends[2] - ends[0], ends[3] - ends[1]
    square = dx * dx + dy * dy
    if square < 1.0:
        square = 1.0
    line[0], line[1] = ends[0], ends[1]
    line[2], line[3] = -dy * share / square, dx * share / square


@bare
def pose(query: RouteQuery, start: Anchor, goal: Anchor, ends: Ints, starts: Ints, length: Floats) -> None:
    """Set the query's five arcs."""
    joint, cost, bars = query.joint, query.cost, query.bars
    for k in range(2):
        anchor = goal if k else start
        for j in range(2):
            if anchor.node < 0:
                end = j * (starts[anchor.chain + 1] - starts[anchor.chain] - 1)
                joint[2 * k + j] = ends[anchor.chain, j]
                cost[2 * k + j] = part(bars, starts, length, anchor.chain, anchor.position, end)
            else:
                joint[2 * k + j] = anchor.node if j == 0 else -1
                cost[2 * k + j] = 0.0 if j == 0 else np.inf
    cost[4] = np.inf
    if start.cell == goal.cell:
        for k in range(4):
            cost[k] = np.inf
        cost[4] = 0.0
    elif start.chain == goal.chain and start.node < 0 and goal.node < 0:
        cost[4] = part(bars, starts, length, start.chain, start.position, goal.position)
        backward = int(start.position > goal.position)  # the arcs that would pass the other end and come back
        cost[1 - backward] = cost[2 + backward] = np.inf


@bare
def part(bars: Ints, starts: Ints, length: Floats, chain: int, begin: int, end: int) -> float:
    """The length of a part of a chain, in proportion to its cells; infinite when it takes a barred step."""
    low, high = (begin, end) if begin < end else (end, begin)
    for k in range(bars.shape[0]):
        if bars[k, 0] == chain and low <= bars[k, 1] < high:
            return np.inf
    return float(length[chain] * (high - low) / (starts[chain + 1] - starts[chain] - 1))


@bare
def sight_ends(joint: Ints, cost: Floats, sight: Floats, out: Floats) -> None:
    """The distances of goal and start from the landmarks."""
    for k in range(sight.shape[1]):
        for end in range(2):
            least = np.inf
            for j in range(2 - 2 * end, 4 - 2 * end):
                if cost[j] < np.inf and cost[j] + sight[joint[j], k] < least:
                    least = cost[j] + sight[joint[j], k]
            out[end, k] = least


@bare
def stretches(ends: Ints, starts: Ints, arcs: Ints, row: int, size: int, start: Anchor, goal: Anchor, out: Ints) -> int:
    """Write the chains that a way walks, and the positions between which; returns how many."""
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
def repeats(bounds: Ints, chains: Ints, written: int, stretch: Ints, steps: int) -> bool:
    """Whether a way walks the same chains as one of those published."""
    for way in range(written):
        first = bounds[way, 2]
        same = steps == bounds[way + 1, 2] - first
        for k in range(steps if same else 0):
            same = same and chains[first + k] == stretch[k, 0]
        if same:
            return True
    return False


@bare
def lowest_on(starts: Ints, cells: Ints, neck: Ints, heights: Heights, stretch: Ints, steps: int, lowest: int) -> int:
    """The least square on a way, at most the given one."""
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
def spell(
    starts: Ints,
    ways: Landmarks,
    rise: Ints,
    risen: int,
    stretch: Ints,
    steps: int,
    fall: Ints,
    fallen: int,
    word: Ints,
) -> int:
    """Write the portals of a way from start to goal; returns the word's size."""
    symbol, words, spelt = ways.symbol, ways.word, ways.spelt
    size = add_word(rise, 0, risen, False, word, 0)
    for k in range(steps):
        chain, begin, end = 0 + stretch[k, 0], 0 + stretch[k, 1], 0 + stretch[k, 2]
        if abs(end - begin) == starts[chain + 1] - starts[chain] - 1:
            size = add_word(words, 0 + spelt[chain], 0 + spelt[chain + 1], end < begin, word, size)
        else:
            size = add_chain(starts, symbol, chain, begin, end, word, size)
    return add_word(fall, 0, fallen, True, word, size)


@bare
def publish(
    runs: Strips,
    body: bool,
    word: Ints,
    size: int,
    ends: Ends,
    rope: Funnel,
    stretch: Ints,
    steps: int,
    answers: RouteAnswers,
    k: int,
) -> bool:
    """Pull the rope tight and write the k-th route; False when there is no room."""
    bounds, line, crossings, chains = answers.bounds, answers.corners, answers.crossings, answers.chains
    corner, crossing, chain = bounds[k, 0], bounds[k, 1], bounds[k, 2]
    room, needed = line.shape[0] - corner, 4 * size + 8
    if size >= word.shape[0] or room < needed or rope.x.shape[0] < needed:
        return False
    if crossings.shape[0] < crossing + size or chains.shape[0] < chain + steps:
        return False
    line = line[corner:]
    corners = tighten_word(runs.left, runs.right, runs.line, body, word, size, ends, rope, line)
    answers.length[k] = measure_line(line, corners)
    number = runs.crossing
    for j in range(size):
        crossed = number[abs(word[j]) - 1]
        if crossed != 0:
            crossings[crossing] = crossed if word[j] > 0 else -crossed
            crossing += 1
    for j in range(steps):
        chains[chain + j] = stretch[j, 0]
    bounds[k + 1, 0], bounds[k + 1, 1], bounds[k + 1, 2] = corner + corners, crossing, chain + steps
    return True
