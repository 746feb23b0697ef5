"""One rope at a time: routes from given words, and words from given crossing numbers."""

from collections.abc import Sequence

import numpy as np

from geometry.homotopy.funnel import Ends, measure_line, new_rope, tighten_word
from geometry.homotopy.portals import crossings_of, join_words
from geometry.homotopy.strips import Strips, run_at
from geometry.kernels.arrays import Ints
from geometry.routes.layer import Layer
from geometry.routes.route import Route


def tight_route(layer: Layer, ends: Ends, word: Ints, clearance: float, chains: tuple[int, ...]) -> Route:
    """The tight route of a reduced word."""
    runs, line = layer.runs, np.empty((4 * len(word) + 8, 2))
    corners = tighten_word(
        runs.left, runs.right, runs.line, layer.body, word, len(word), ends, new_rope(len(word)), line
    )
    points = line[:corners].copy()
    points.flags.writeable = False
    return Route(points, measure_line(points, corners), clearance, crossings_of(runs, word), chains)


def word_of_crossings(runs: Strips, ends: Ends, crossings: Sequence[int]) -> Ints | None:
    """The portals of the class with these crossing numbers; None when start and goal are not connected.

    Raises
    ------
    ValueError
        When there is no such crossing number, or none that can be reached.
    """
    run = run_at(runs.row, runs.low, int(ends[1]), int(ends[0]))
    goal = run_at(runs.row, runs.low, int(ends[3]), int(ends[2]))
    tree = forest(runs)
    portals = {int(number): portal + 1 for portal, number in enumerate(runs.crossing.tolist()) if number}
    pieces: list[Ints] = []
    for number in crossings:
        portal = portals.get(abs(number))
        if portal is None:
            raise ValueError(f"there is no crossing number {number} on this screen; they go from 1 to {len(portals)}")
        near, far = runs.lower[portal - 1], runs.upper[portal - 1]
        if number < 0:
            near, far = far, near
        way = way_in_forest(runs, tree, run, int(near))
        if way is None:
            raise ValueError(f"crossing number {number} cannot be reached from the start")
        pieces += [way, np.array([portal if number > 0 else -portal], np.int32)]
        run = int(far)
    last = way_in_forest(runs, tree, run, goal)
    return None if last is None else join_words(*pieces, last)


def forest(runs: Strips) -> Ints:
    """Per run, the signed portal towards the first run of its component; 0 at that."""
    links: list[list[tuple[int, int]]] = [[] for _ in range(len(runs.low))]
    for portal in np.flatnonzero(runs.crossing == 0).tolist():
        links[runs.lower[portal]].append((int(runs.upper[portal]), -portal - 1))
        links[runs.upper[portal]].append((int(runs.lower[portal]), portal + 1))
    towards = np.zeros(len(links), np.int32)
    seen = np.zeros(len(links), np.bool_)
    for first in range(len(links)):
        queue = [] if seen[first] else [first]
        seen[first] = True
        for run in queue:
            for other, symbol in links[run]:
                if not seen[other]:
                    seen[other] = True
                    towards[other] = symbol
                    queue.append(other)
    return towards


def way_in_forest(runs: Strips, tree: Ints, run: int, goal: int) -> Ints | None:
    """The portals from one run to another over the forest; None when they are not connected."""
    up, top = way_to_root(runs, tree, run)
    down, other = way_to_root(runs, tree, goal)
    if top != other:
        return None
    return join_words(np.array(up, np.int32), -np.array(down[::-1], np.int32))


def way_to_root(runs: Strips, tree: Ints, run: int) -> tuple[list[int], int]:
    """The portals from a run to the first of its component, and that run."""
    word: list[int] = []
    while tree[run]:
        symbol = int(tree[run])
        word.append(symbol)
        run = int(runs.upper[symbol - 1] if symbol > 0 else runs.lower[-symbol - 1])
    return word, run
