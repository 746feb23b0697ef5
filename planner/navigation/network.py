"""The pathgraph between two squares: its links as facts know them, and the shortest ways over them.

A link is a chain of the pathgraph, or the part of one between the places where start and goal meet the skeleton. Dead
ends that lead to neither are left out: who walks into one comes back to the junction that it begins at.
"""

import heapq
import math
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Sequence
from itertools import pairwise, permutations
from typing import NamedTuple

import numpy as np

from utak.geometry import Route, Screen
from utak.geometry.kernels.arrays import Bools, Floats, Square
from utak.planner.screen.sweeps import shortest_squares

MAX_EXPANSIONS = 2000  # of ways over links, for one search: bounds its time; far more than four ways ever needed


class Link(NamedTuple):
    """A link of the pathgraph between two junctions."""

    name: str
    ends: tuple[str, str]  # names of its junctions
    points: Floats  # (n, 2) centres (x, y) of its squares from the first end to the second, screen frame
    clearances: Floats  # (n,) of its squares, in squares

    @property
    def length(self) -> float:
        """Its length from square to square, in squares."""
        return float(len(self.points) - 1)

    @property
    def clearance(self) -> float:
        """The least clearance on it, in squares."""
        return float(self.clearances.min())


class Network(NamedTuple):
    """The links between two squares of a screen."""

    screen: Screen
    links: tuple[Link, ...]
    ends: tuple[str, str]  # the junctions at which start and goal are
    tails: tuple[Floats, Floats]  # the squares from the start to its junction, and from the goal to its own

    def line(self, names: Sequence[str]) -> Floats:
        """Return the line from start to goal over links, in their order: (n, 2) points, screen frame."""
        by_name, here = {link.name: link for link in self.links}, self.ends[0]
        parts = [self.tails[0]]
        for name in names:
            link = by_name[name]
            forward = link.ends[0] == here
            parts.append(link.points if forward else link.points[::-1])
            here = link.ends[1] if forward else link.ends[0]
        return np.concatenate([*parts, self.tails[1][::-1]])

    def tight(self, names: Sequence[str]) -> Route:
        """Return the shortest route of the class of a way over links."""
        return self.screen.tighten(Route(self.line(names), 0.0, 0.0, (), ()))

    def ways(self, most: int) -> list[tuple[str, ...]]:
        """Return the shortest ways over links that pass no junction twice, the shortest first."""
        arcs, (start, goal) = _arcs(self.links), self.ends
        left = _distances(arcs, goal)
        found: list[tuple[str, ...]] = []
        heap: list[tuple[float, tuple[str, ...], tuple[str, ...]]] = [(left.get(start, math.inf), (), (start,))]
        for _ in range(MAX_EXPANSIONS):
            if not heap or len(found) == most:
                break
            cost, names, passed = heapq.heappop(heap)
            here = passed[-1]
            if here == goal:
                found.append(names)
                continue
            for there, link in arcs[here]:
                if there not in passed and there in left:
                    total = cost - left[here] + link.length + left[there]
                    heapq.heappush(heap, (total, (*names, link.name), (*passed, there)))
        return found


def network(screen: Screen, start: Square, goal: Square) -> Network:
    """Return the links between two squares (column, row) of a screen."""
    graph = screen.pathgraph_arrays
    free, bones = (_squares(mask) for mask in (screen.free, screen.skeleton))
    cells = np.floor(graph.points).astype(int)
    cuts: dict[int, dict[int, str]] = defaultdict(dict)  # by chain and position: the junction there
    for edge, (first, last) in enumerate(graph.edges.tolist()):
        size = int(graph.offsets[edge + 1] - graph.offsets[edge])
        cuts[edge] = {0: f"j{first + 1}", size - 1: f"j{last + 1}"}
    ends, tails = [], []
    for name, square in (("here", start), ("there", goal)):
        tail = shortest_squares(free.__contains__, square, bones.__contains__)
        column, row = tail[-1]
        tails.append(np.array(tail) + 0.5)
        nodes = np.flatnonzero((np.floor(graph.nodes) == (column, row)).all(1))
        if len(nodes):
            ends.append(f"j{int(nodes[0]) + 1}")
            continue
        place = int(np.flatnonzero((cells == (column, row)).all(1))[0])
        edge = int(graph.offsets.searchsorted(place, side="right")) - 1
        ends.append(cuts[edge].setdefault(place - int(graph.offsets[edge]), name))
    links = [link for edge, places in cuts.items() for link in _pieces(edge, places, graph.points_of(edge), screen)]
    return Network(screen, tuple(_between(links, ends)), (ends[0], ends[1]), (tails[0], tails[1]))


def _squares(mask: Bools) -> set[Square]:
    """Return the squares (column, row) of a mask."""
    return {(column, row) for row, column in np.argwhere(mask).tolist()}


def _pieces(edge: int, places: dict[int, str], points: Floats, screen: Screen) -> Iterator[Link]:
    """Yield the parts of a chain between the junctions on it."""
    positions = sorted(places)
    for number, (begin, end) in enumerate(pairwise(positions), 1):
        part = points[begin : end + 1]
        columns, rows = np.floor(part).astype(int).T
        name = f"l{edge + 1}" if len(positions) == 2 else f"l{edge + 1}_{number}"
        yield Link(name, (places[begin], places[end]), part, screen.clearance[rows, columns])


def _between(links: Sequence[Link], ends: Sequence[str]) -> list[Link]:
    """Return links without loops and without dead ends that lead to neither end."""
    left = [link for link in links if link.ends[0] != link.ends[1]]
    while True:
        degree = Counter(end for link in left for end in link.ends)
        kept = [link for link in left if all(degree[end] > 1 or end in ends for end in link.ends)]
        if len(kept) == len(left):
            return left
        left = kept


def links_within(links: Sequence[Link], ends: tuple[str, str], most: float) -> list[Link]:
    """Return the links over which a walk from the first to the last junction is at most so long, in squares."""
    arcs = _arcs(links)
    begin, end = (_distances(arcs, junction) for junction in ends)
    far = math.inf
    return [
        link
        for link in links
        if any(begin.get(a, far) + link.length + end.get(b, far) <= most for a, b in permutations(link.ends))
    ]


def _arcs(links: Iterable[Link]) -> dict[str, list[tuple[str, Link]]]:
    """Return the links that lead from each junction, each with the junction at its other end."""
    arcs: dict[str, list[tuple[str, Link]]] = defaultdict(list)
    for link in links:
        one, other = link.ends
        arcs[one].append((other, link))
        arcs[other].append((one, link))
    return arcs


def _distances(arcs: dict[str, list[tuple[str, Link]]], goal: str) -> dict[str, float]:
    """Return the length of the shortest way over links from each junction to the goal."""
    known, heap = {goal: 0.0}, [(0.0, goal)]
    while heap:
        far, here = heapq.heappop(heap)
        if far > known[here]:
            continue
        for there, link in arcs[here]:
            if far + link.length < known.get(there, math.inf):
                known[there] = far + link.length
                heapq.heappush(heap, (known[there], there))
    return known
