"""One path at a time: routes from given words, and words from given crossing numbers."""

from collections.abc import Sequence

import numpy as np

from utak.geometry.homotopy.funnel import Ends, measure_line, new_funnel, tighten_word
from utak.geometry.homotopy.portals import crossings_of, join_words
from utak.geometry.homotopy.strips import Strips, strip_at
from utak.geometry.kernels.arrays import Ints
from utak.geometry.routes.layer import Layer
from utak.geometry.routes.route import Route


def tight_route(layer: Layer, ends: Ends, word: Ints, clearance: float, chains: tuple[int, ...]) -> Route:
    """Return the tight route of a reduced word: the shortest of its class."""
    strips, line = layer.runs, np.empty((4 * len(word) + 8, 2))
    corners = tighten_word(
        strips.left, strips.right, strips.line, layer.body, word, len(word), ends, new_funnel(len(word)), line
    )
    points = line[:corners].copy()
    points.flags.writeable = False
    return Route(points, measure_line(points, corners), clearance, crossings_of(strips, word), chains)


def word_of_crossings(strips: Strips, ends: Ends, crossings: Sequence[int]) -> Ints | None:
    """Return the reduced word of the class with these crossing numbers; None when start and goal are not connected."""
    strip = strip_at(strips.row, strips.low, int(ends[1]), int(ends[0]))
    goal = strip_at(strips.row, strips.low, int(ends[3]), int(ends[2]))
    forest = build_forest(strips)
    portals = {int(number): portal + 1 for portal, number in enumerate(strips.crossing.tolist()) if number}
    pieces: list[Ints] = []
    for number in crossings:
        portal = portals.get(abs(number))
        if portal is None:
            raise ValueError(f"there is no crossing number {number} on this screen; they go from 1 to {len(portals)}")
        near, far = strips.lower[portal - 1], strips.upper[portal - 1]
        if number < 0:
            near, far = far, near
        word = word_in_forest(strips, forest, strip, int(near))
        if word is None:
            raise ValueError(f"crossing number {number} cannot be reached from the start")
        pieces += [word, np.array([portal if number > 0 else -portal], np.int32)]
        strip = int(far)
    last = word_in_forest(strips, forest, strip, goal)
    return None if last is None else join_words(*pieces, last)


def build_forest(strips: Strips) -> Ints:
    """Return for each strip the signed portal towards the first strip of its component, (n,) int32; 0 at that strip."""
    links: list[list[tuple[int, int]]] = [[] for _ in range(len(strips.low))]
    for portal in np.flatnonzero(strips.crossing == 0).tolist():
        links[strips.lower[portal]].append((int(strips.upper[portal]), -portal - 1))
        links[strips.upper[portal]].append((int(strips.lower[portal]), portal + 1))
    towards = np.zeros(len(links), np.int32)
    seen = np.zeros(len(links), np.bool_)
    for first in range(len(links)):
        queue = [] if seen[first] else [first]
        seen[first] = True
        for strip in queue:
            for other, symbol in links[strip]:
                if not seen[other]:
                    seen[other] = True
                    towards[other] = symbol
                    queue.append(other)
    return towards


def word_in_forest(strips: Strips, forest: Ints, strip: int, goal: int) -> Ints | None:
    """Return the reduced word from one strip to another over the forest; None when they are not connected."""
    up, top = word_to_root(strips, forest, strip)
    down, other = word_to_root(strips, forest, goal)
    if top != other:
        return None
    return join_words(np.array(up, np.int32), -np.array(down[::-1], np.int32))


def word_to_root(strips: Strips, forest: Ints, strip: int) -> tuple[list[int], int]:
    """Return the word from a strip to the first strip of its component, and that strip."""
    word: list[int] = []
    while forest[strip]:
        symbol = int(forest[strip])
        word.append(symbol)
        strip = int(strips.upper[symbol - 1] if symbol > 0 else strips.lower[-symbol - 1])
    return word, strip
