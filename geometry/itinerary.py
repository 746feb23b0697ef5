"""From start and goal to tight routes: anchor both on the skeleton, find ways over the pathgraph, pull each rope
tight.
"""

from typing import NamedTuple

import numpy as np

from geometry.alternatives import Album, new_album, shortest_ways
from geometry.chains import Chains, Floats, Ints
from geometry.compiled import compiled
from geometry.layer import Layer
from geometry.rope import Rope, measure_line, new_rope, tighten_word
from geometry.runs import extend
from geometry.search import Query, Search, new_search
from geometry.ways import Anchor, add_chain, ascend, locate


class Answers(NamedTuple):
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


class Desk(NamedTuple):
    """All scratch of a query."""

    query: Query
    search: Search
    album: Album
    rope: Rope
    answers: Answers
    start: Ints
    """From the start up to the skeleton."""
    goal: Ints
    """From the goal up to the skeleton."""
    whole: Ints
    """From start to goal."""


def new_desk(nodes: int, chains: int, sights: int, wanted: int, room: int, bars: Ints) -> Desk:
    """Scratch for ``wanted`` routes of words up to ``room`` over a pathgraph of that size."""
    query = Query(
        np.empty(4, np.int32),
        np.empty(5),
        np.empty(sights),
        np.zeros(4),
        np.zeros(chains, np.uint8),
        bars,
        np.zeros(nodes, np.bool_),
    )
    answers = Answers(
        np.zeros((wanted + 1, 3), np.int32),
        np.empty((8 * room, 2)),
        np.empty(room * wanted, np.int32),
        np.empty((nodes + 2) * wanted, np.int32),
        np.empty(wanted),
        np.empty(wanted, np.int32),
    )
    words = (np.empty(room, np.int32) for _ in range(3))
    return Desk(query, new_search(nodes, chains), new_album(wanted, nodes + 2), new_rope(room), answers, *words)


OVERFLOW = -1
BOW = 1.0  # chosen by trial on the benchmark maps: 0 gives 1.014 of the optimum in the mean, 0.1 1.010, 1 1.009
Ends = tuple[float, float, float, float]  # x and y of the start, x and y of the goal


@compiled
def itineraries(layer: Layer, ends: Ends, wanted: int, desk: Desk) -> int:
    """Fill the desk's answers with up to ``wanted`` tight routes, by the length of their ways over the pathgraph.

    Returns their number, or OVERFLOW when some scratch is too small.
    """
    width = layer.square.shape[1]
    first = (int(ends[1]) + 1) * width + int(ends[0]) + 1
    last = (int(ends[3]) + 1) * width + int(ends[2]) + 1
    start, rise = anchor_at(layer, first, desk.start)
    goal, fall = anchor_at(layer, last, desk.goal)
    if max(rise, fall) >= desk.start.shape[0]:
        return OVERFLOW
    pose(layer, desk.query, start, goal)
    bow(desk.query.line, ends, BOW if wanted == 1 else 0.0)
    found = shortest_ways(layer.chains, layer.ways, desk.query, desk.search, desk.album, wanted)
    settle(desk.query, start, goal, False)
    heights = layer.square.reshape(-1)
    floor = min(heights[first], heights[last])
    for k in range(found):
        desk.whole[:rise] = desk.start[:rise]
        size, desk.answers.lowest[k] = spell(layer, desk, k, start, goal, rise, floor)
        for j in range(fall - 1, -1, -1):
            size = extend(desk.whole, size, -desk.goal[j])
        if not publish(layer, desk, size, ends, start, goal, k):
            return OVERFLOW
    return found


@compiled
def anchor_at(layer: Layer, cell: int, word: Ints) -> tuple[Anchor, int]:
    """Where a cell's steepest way up meets the skeleton, and the size of the word on it."""
    cell, size = ascend(cell, layer.square, layer.state, layer.runs, word, 0)
    return locate(cell, layer.state, layer.chains), size


@compiled
def settle(query: Query, start: Anchor, goal: Anchor, split: bool) -> None:
    """Shut the chains that an anchor splits, or open them again."""
    if start.node < 0:
        query.shut[start.chain] = query.shut[start.chain] | 2 if split else query.shut[start.chain] & 1
    if goal.node < 0:
        query.shut[goal.chain] = query.shut[goal.chain] | 2 if split else query.shut[goal.chain] & 1


@compiled
def bow(line: Floats, ends: Ends, share: float) -> None:
    """Make arcs dearer by that share of their length times their distance from the straight line, in its lengths."""
    dx, dy = ends[2] - ends[0], ends[3] - ends[1]
    square = max(dx * dx + dy * dy, 1.0)
    line[0], line[1] = ends[0], ends[1]
    line[2], line[3] = -dy * share / square, dx * share / square


@compiled
def pose(layer: Layer, query: Query, start: Anchor, goal: Anchor) -> None:
    """Set the query's five arcs, and the goal's distances from the landmarks."""
    query.joint[:] = -1
    query.cost[:] = np.inf
    pose_end(layer, query, start, 0)
    pose_end(layer, query, goal, 2)
    if start.cell == goal.cell:
        query.cost[:4] = np.inf
        query.cost[4] = 0.0
    elif start.chain == goal.chain and start.node < 0 and goal.node < 0:
        query.cost[4] = part(layer, query, start.chain, start.position, goal.position)
        backward = int(start.position > goal.position)  # the arcs that would pass the other end and come back
        query.cost[1 - backward] = query.cost[2 + backward] = np.inf
    settle(query, start, goal, True)
    for k in range(query.sight.shape[0]):
        query.sight[k] = np.inf
        for j in (2, 3):
            if query.cost[j] < np.inf:
                query.sight[k] = min(query.sight[k], query.cost[j] + layer.ways.sight[query.joint[j], k])


@compiled
def pose_end(layer: Layer, query: Query, anchor: Anchor, k: int) -> None:
    """Set the two arcs of one end."""
    if anchor.node >= 0:
        query.joint[k] = anchor.node
        query.cost[k] = np.inf if query.closed[anchor.node] else 0.0
        return
    chains = layer.chains
    size = chains.start[anchor.chain + 1] - chains.start[anchor.chain]
    for j in range(2):
        query.joint[k + j] = chains.ends[anchor.chain, j]
        query.cost[k + j] = part(layer, query, anchor.chain, anchor.position, j * (size - 1))


@compiled
def part(layer: Layer, query: Query, chain: int, begin: int, end: int) -> float:
    """The length of a part of a chain, in proportion to its cells; infinite when it passes a barred place."""
    chains = layer.chains
    for k in range(query.bars.shape[0]):
        if query.bars[k, 0] == chain and min(begin, end) <= query.bars[k, 1] <= max(begin, end):
            return np.inf
    steps = chains.start[chain + 1] - chains.start[chain] - 1
    return float(layer.ways.length[chain] * abs(end - begin) / steps)


@compiled
def stretch_of(chains: Chains, code: int, start: Anchor, goal: Anchor) -> tuple[int, int, int]:
    """The chain and the positions between which an arc walks; chain -1 for an arc without length."""
    extra = code - 2 * chains.ends.shape[0]
    if extra < 0:
        last = chains.start[(code >> 1) + 1] - chains.start[code >> 1] - 1
        return code >> 1, last * (code & 1), last * (1 - (code & 1))
    if extra == 4:
        return (start.chain, start.position, goal.position) if start.cell != goal.cell else (-1, 0, 0)
    anchor = start if extra < 2 else goal
    if anchor.node >= 0:
        return -1, 0, 0
    end = (chains.start[anchor.chain + 1] - chains.start[anchor.chain] - 1) * (extra & 1)
    return (anchor.chain, anchor.position, end) if extra < 2 else (anchor.chain, end, anchor.position)


@compiled
def spell(layer: Layer, desk: Desk, way: int, start: Anchor, goal: Anchor, size: int, lowest: int) -> tuple[int, int]:
    """Add a way's portals to the whole word; returns the word's size and the least square met."""
    chains, heights = layer.chains, layer.square.reshape(-1)
    for k in range(desk.album.size[way]):
        chain, begin, end = stretch_of(chains, desk.album.arcs[way, k], start, goal)
        if chain < 0:
            continue
        size = add_chain(chains, layer.ways, chain, begin, end, desk.whole, size)
        neck, first = chains.neck[chain], chains.start[chain]
        if min(begin, end) <= neck - first <= max(begin, end):
            lowest = min(lowest, heights[chains.cells[neck]])
        else:
            for j in range(first + min(begin, end), first + max(begin, end) + 1):
                lowest = min(lowest, heights[chains.cells[j]])
    return size, lowest


@compiled
def publish(layer: Layer, desk: Desk, size: int, ends: Ends, start: Anchor, goal: Anchor, k: int) -> bool:
    """Pull the rope tight and write the k-th route; False when there is no room."""
    answers, rope = desk.answers, desk.rope
    corner, crossing, chain = answers.bounds[k, 0], answers.bounds[k, 1], answers.bounds[k, 2]
    if (
        size >= desk.whole.shape[0]
        or min(answers.corners.shape[0] - corner, rope.x.shape[0]) < 4 * size + 8
        or answers.crossings.shape[0] < crossing + size
        or answers.chains.shape[0] < chain + desk.album.size[k]
    ):
        return False
    line = answers.corners[corner:]
    corners = tighten_word(layer.runs, layer.body, desk.whole, size, ends, rope, line)
    answers.length[k] = measure_line(line, corners)
    for j in range(size):
        number = layer.runs.crossing[abs(desk.whole[j]) - 1]
        if number != 0:
            answers.crossings[crossing] = number if desk.whole[j] > 0 else -number
            crossing += 1
    for j in range(desk.album.size[k]):
        walked, _, _ = stretch_of(layer.chains, desk.album.arcs[k, j], start, goal)
        if walked >= 0:
            answers.chains[chain] = walked
            chain += 1
    answers.bounds[k + 1, 0], answers.bounds[k + 1, 1], answers.bounds[k + 1, 2] = corner + corners, crossing, chain
    return True
