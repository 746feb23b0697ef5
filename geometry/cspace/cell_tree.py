"""A tree of cells of poses: boxes of places and angles that are split where it is not yet known whether a body fits.

Plain loops for numba. A cell is a square of places times an interval of angles; all cells of one depth have the same
size. Splitting halves what contributes most to how far a point of the body may move in the cell: the place (four
children) or the angle (two). Corners of cells are whole numbers, so neighbours are found without rounding; angles wrap.
Leaves that share a face are linked; a split hands its links on to the children, and links to what was split are dropped
when next met.

Source: soft subdivision search: Zhu and Latombe 1989; Wang, Chiang and Yap 2013; Zhou, Chiang and Yap 2018.
"""

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from geometry.kernels.arrays import Floats, Ints
from geometry.kernels.jit import bare
from geometry.motion.cell_clearance import FULL, SHUT, MovingBody, NearbyEdges, classify

FINEST = 24  # halvings of place or angle at most
WHOLE = 1 << FINEST
DEEPEST = 2 * FINEST
LINKS = 64  # there is room for so many a cell


class CellTree(NamedTuple):
    """Cells, numbered from 0, the root.

    box: (capacity, 4) the least corner as whole numbers x, y, angle, and the depth. child: first child or -1 for a
    leaf. kind: as separation.classify tells. used: (1,) how many cells there are. sizes: (depths, 2) the whole-number
    sizes of place and angle by depth. frame: x, y of the corner, unit of place, unit of angle, resolution. link:
    (.., 2) the cell a link leads to and the next link of the same cell, or -1; head: a cell's first link; links: (1,)
    how many. middle: (capacity, 3) the pose in the middle of a cell: x, y, radians.
    """

    box: Ints
    child: Ints
    kind: npt.NDArray[np.int8]
    used: npt.NDArray[np.int64]
    sizes: Ints
    frame: Floats
    link: Ints
    head: Ints
    links: npt.NDArray[np.int64]
    middle: Floats


def new_tree(x: float, y: float, side: float, radius: float, resolution: float, capacity: int) -> CellTree:
    """A tree of one cell: the square of places at (x, y) and all angles. resolution: cells are not split below it."""
    sizes = [(WHOLE, WHOLE)]
    for _ in range(DEEPEST):
        place, angle = sizes[-1]
        spread = side * (place / WHOLE) / math.sqrt(2)
        swing = 2 * radius * math.sin(math.pi * min(angle / WHOLE, 1.0) / 2)
        sizes.append((place // 2, angle) if spread >= swing else (place, angle // 2))
    tree = CellTree(
        np.empty((capacity, 4), np.int32),
        np.empty(capacity, np.int32),
        np.empty(capacity, np.int8),
        np.ones(1, np.int64),
        np.array(sizes, np.int32),
        np.array([x, y, side / WHOLE, 2 * math.pi / WHOLE, resolution]),
        np.empty((LINKS * capacity, 2), np.int32),
        np.empty(capacity, np.int32),
        np.zeros(1, np.int64),
        np.empty((capacity, 3)),
    )
    tree.middle[0] = x + side / 2, y + side / 2, math.pi
    tree.box[0], tree.child[0], tree.kind[0], tree.head[0] = 0, -1, SHUT, -1
    return tree


@bare
def splittable(tree: CellTree, cell: int, mover: MovingBody) -> bool:
    """Whether a cell is larger than the resolution and there is room for its children."""
    depth = tree.box[cell, 3]
    if depth + 1 >= len(tree.sizes) or tree.used[0] + 4 > len(tree.child) or tree.links[0] > len(tree.link) // 2:
        return False
    spread = tree.sizes[depth, 0] * tree.frame[2] / math.sqrt(2.0)
    swing = 2.0 * mover.radius * math.sin(min(tree.sizes[depth, 1] * tree.frame[3] / 2, math.pi) / 2)
    return bool(spread + swing > tree.frame[4])


@bare
def split(tree: CellTree, cell: int, mover: MovingBody, ground: NearbyEdges) -> None:
    """Give a leaf its children and classify them."""
    depth = tree.box[cell, 3] + 1
    place, angle = tree.sizes[depth, 0], tree.sizes[depth, 1]
    first = tree.used[0]
    count = 4 if place < tree.sizes[depth - 1, 0] else 2
    tree.child[cell] = first
    tree.used[0] += count
    spread = place * tree.frame[2] / math.sqrt(2.0)
    half = angle * tree.frame[3] / 2
    for n in range(count):
        new = first + n
        for k in range(3):
            tree.box[new, k] = tree.box[cell, k]
        if count == 4:
            tree.box[new, 0] += (n & 1) * place
            tree.box[new, 1] += (n >> 1) * place
        else:
            tree.box[new, 2] += n * angle
        tree.box[new, 3] = depth
        tree.child[new], tree.head[new] = -1, -1
        x = tree.frame[0] + (tree.box[new, 0] + 0.5 * place) * tree.frame[2]
        y = tree.frame[1] + (tree.box[new, 1] + 0.5 * place) * tree.frame[2]
        turn = (tree.box[new, 2] + 0.5 * angle) * tree.frame[3]
        tree.middle[new, 0], tree.middle[new, 1], tree.middle[new, 2] = x, y, turn
        tree.kind[new] = classify(mover, ground, x, y, turn, spread, half)
        for other in range(first, new):
            _link_if_face(tree, new, other)
    at = tree.head[cell]
    while at >= 0:
        other = tree.link[at, 0]
        at = tree.link[at, 1]
        if tree.child[other] < 0:
            for new in range(first, first + count):
                _link_if_face(tree, new, other)


@bare
def leaf_at(tree: CellTree, x: float, y: float, angle: float) -> int:
    """The leaf that holds a pose; -1 outside the tree."""
    ix = math.floor((x - tree.frame[0]) / tree.frame[2])
    iy = math.floor((y - tree.frame[1]) / tree.frame[2])
    it = math.floor(angle / tree.frame[3]) % WHOLE
    if ix < 0 or iy < 0 or ix >= WHOLE or iy >= WHOLE:
        return -1
    cell = 0
    while tree.child[cell] >= 0:
        first = tree.child[cell]
        depth = tree.box[first, 3]
        place, angle_size = tree.sizes[depth, 0], tree.sizes[depth, 1]
        if place < tree.sizes[depth - 1, 0]:
            n = int(ix >= tree.box[cell, 0] + place) + 2 * int(iy >= tree.box[cell, 1] + place)
        else:
            n = int(it >= tree.box[cell, 2] + angle_size)
        cell = first + n
    return cell


@bare
def _link_if_face(tree: CellTree, a: int, b: int) -> None:
    """Link two leaves to each other when they share a face and neither is FULL."""
    if tree.kind[a] == FULL or tree.kind[b] == FULL:
        return
    sizes_a, sizes_b = tree.sizes[tree.box[a, 3]], tree.sizes[tree.box[b, 3]]
    x = _overlap(tree.box[a, 0], sizes_a[0], tree.box[b, 0], sizes_b[0])
    y = _overlap(tree.box[a, 1], sizes_a[0], tree.box[b, 1], sizes_b[0])
    if x < 0 or y < 0 or (x == 0 and y == 0):
        return
    t = _turned_overlap(tree.box[a, 2], sizes_a[1], tree.box[b, 2], sizes_b[1])
    if t < 0 or (t == 0 and (x == 0 or y == 0)) or tree.links[0] + 2 > len(tree.link):
        return
    at = tree.links[0]
    tree.links[0] += 2
    tree.link[at, 0], tree.link[at, 1], tree.head[a] = b, tree.head[a], at
    tree.link[at + 1, 0], tree.link[at + 1, 1], tree.head[b] = a, tree.head[b], at + 1


@bare
def next_neighbour(child: Ints, head: Ints, link: Ints, cell: int, at: int) -> int:
    """The link after link `at` of a cell (-1: its first) that leads to a leaf; -1 at the end. Old links are dropped.

    child, head, link: the tree's. (Whole trees are many arrays: too many to hand to what is called a million times.)
    """
    while True:
        found = head[cell] if at < 0 else link[at, 1]
        if found < 0 or child[link[found, 0]] < 0:
            return int(found)
        if at < 0:
            head[cell] = link[found, 1]
        else:
            link[at, 1] = link[found, 1]


@bare
def _overlap(a: int, size_a: int, b: int, size_b: int) -> int:
    """By how much two intervals overlap: 0 when they touch, negative when they are apart."""
    return min(a + size_a, b + size_b) - max(a, b)


@bare
def _turned_overlap(a: int, size_a: int, b: int, size_b: int) -> int:
    """The same on the circle of angles."""
    best = _overlap(a, size_a, b, size_b)
    best = max(best, _overlap(a + WHOLE, size_a, b, size_b))
    return max(best, _overlap(a, size_a, b + WHOLE, size_b))
