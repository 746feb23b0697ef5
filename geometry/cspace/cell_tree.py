"""A tree of cells of poses: boxes of places and angles, split where it is not yet known whether the body is free.

Plain loops for numba. A cell is a square of places times an interval of angles; all cells of one depth have the same
size. Splitting halves what contributes most to how far a point of the body may move in the cell: the place (four
children) or the angle (two). Corners of cells are whole numbers, so neighbours are found without rounding; angles wrap.
Leaves that share a face are linked. A split hands its links on to the children, and links to what was split are dropped
when next met.

Source: soft subdivision search: Zhu and Latombe 1989; Wang, Chiang and Yap 2013; Zhou, Chiang and Yap 2018.
"""

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from utak.geometry.kernels.arrays import Floats, Ints
from utak.geometry.kernels.jit import bare
from utak.geometry.motion.cell_clearance import (
    CELL_BLOCKED,
    CELL_GIVEN_UP,
    CELL_UNDECIDED,
    MovingBody,
    NearbyEdges,
    classify_cell,
)

MAX_HALVINGS = 24  # halvings of place, and of angle, at most; a convention: units of cells fit 32 bits
ROOT_UNITS = 1 << MAX_HALVINGS  # sides of the root cell in whole-number units of place and of angle
MAX_CELL_DEPTH = 2 * MAX_HALVINGS  # derived: a split halves either the place or the angle
LINKS_PER_CELL = (
    64  # links for which memory is reserved, on average a cell; tuned on random worlds (benchmarks.campaign)
)


class CellTree(NamedTuple):
    """The cells of a subdivision, numbered from 0, the root. Depth d counts splits from the root."""

    # (capacity, 4) int32, lower corner of each cell in whole-number units from the root's lower corner: x, y, angle;
    # and its depth
    box: Ints
    child: Ints  # (capacity,) number of the first child, the others follow it; -1 for a leaf
    kind: npt.NDArray[np.int8]  # (capacity,) as cell_clearance.classify_cell says, or CELL_GIVEN_UP.
    used: npt.NDArray[np.int64]  # (1,) number of cells
    sizes: Ints  # (depths, 2) sides of a cell by depth, in units: place, angle
    # (5,) x, y of the root's lower corner (squares, table frame); unit of place (squares); unit of angle (radians);
    # resolution (squares)
    frame: Floats
    # (links, 2) the cell that a link leads to, and the next link of the same cell or -1. Linked cells share a face.
    link: Ints
    head: Ints  # (capacity,) first link of each cell; -1 for none
    links: npt.NDArray[np.int64]  # (1,) number of links
    # (capacity, 3) the pose of the body's centre in the middle of each cell: x, y in squares, table frame; radians from
    # 0 to 2 pi
    middle: Floats
    changed: Ints  # (capacity,) the cells that were split or given up since the last search for a channel
    changes: npt.NDArray[np.int64]  # (1,) number of such cells


def new_cell_tree(x: float, y: float, side: float, radius: float, resolution: float, capacity: int) -> CellTree:
    """Return a tree of one cell, number 0, undecided: a square of places and all angles."""
    sizes = [(ROOT_UNITS, ROOT_UNITS)]
    for _ in range(MAX_CELL_DEPTH):
        place, angle = sizes[-1]
        spread = side * (place / ROOT_UNITS) / math.sqrt(2)
        swing = 2 * radius * math.sin(math.pi * min(angle / ROOT_UNITS, 1.0) / 2)
        sizes.append((place // 2, angle) if spread >= swing else (place, angle // 2))
    tree = CellTree(
        np.empty((capacity, 4), np.int32),
        np.empty(capacity, np.int32),
        np.empty(capacity, np.int8),
        np.ones(1, np.int64),
        np.array(sizes, np.int32),
        np.array([x, y, side / ROOT_UNITS, 2 * math.pi / ROOT_UNITS, resolution]),
        np.empty((LINKS_PER_CELL * capacity, 2), np.int32),
        np.empty(capacity, np.int32),
        np.zeros(1, np.int64),
        np.empty((capacity, 3)),
        np.empty(capacity, np.int32),
        np.zeros(1, np.int64),
    )
    tree.middle[0] = x + side / 2, y + side / 2, math.pi
    tree.box[0], tree.child[0], tree.kind[0], tree.head[0] = 0, -1, CELL_UNDECIDED, -1
    return tree


@bare
def is_splittable(tree: CellTree, cell: int, body: MovingBody) -> bool:
    """Return whether a cell is larger than the resolution and there is memory for its children and their links."""
    depth = tree.box[cell, 3]
    if depth + 1 >= len(tree.sizes) or tree.used[0] + 4 > len(tree.child) or tree.links[0] > len(tree.link) // 2:
        return False
    spread = tree.sizes[depth, 0] * tree.frame[2] / math.sqrt(2.0)
    swing = 2.0 * body.radius * math.sin(min(tree.sizes[depth, 1] * tree.frame[3] / 2, math.pi) / 2)
    return bool(spread + swing > tree.frame[4])


@bare
def split_cell(tree: CellTree, cell: int, body: MovingBody, nearby: NearbyEdges) -> None:
    """Give a leaf its four or two children, classify them and link them to their neighbours. `tree` is changed."""
    depth = tree.box[cell, 3] + 1
    place, angle = tree.sizes[depth, 0], tree.sizes[depth, 1]
    first = tree.used[0]
    count = 4 if place < tree.sizes[depth - 1, 0] else 2
    tree.child[cell] = first
    tree.used[0] += count
    _note_change(tree, cell)
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
        tree.kind[new] = classify_cell(body, nearby, x, y, turn, spread, half)
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
def give_up_cell(tree: CellTree, cell: int) -> None:
    """Mark the leaf `cell` of `tree` as given up: no channel may run through it any more."""
    tree.kind[cell] = CELL_GIVEN_UP
    _note_change(tree, cell)


@bare
def _note_change(tree: CellTree, cell: int) -> None:
    """Add a cell to those of `tree` that were changed since the last search."""
    tree.changed[tree.changes[0]] = cell
    tree.changes[0] += 1


@bare
def leaf_at(tree: CellTree, x: float, y: float, angle: float) -> int:
    """Return the number of the leaf that holds the pose (x, y, angle) of the body's centre; -1 outside the root."""
    ix = math.floor((x - tree.frame[0]) / tree.frame[2])
    iy = math.floor((y - tree.frame[1]) / tree.frame[2])
    it = math.floor(angle / tree.frame[3]) % ROOT_UNITS
    if ix < 0 or iy < 0 or ix >= ROOT_UNITS or iy >= ROOT_UNITS:
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
    """Link leaves a and b of `tree` to each other if they share a face and neither is CELL_BLOCKED."""
    if tree.kind[a] == CELL_BLOCKED or tree.kind[b] == CELL_BLOCKED:
        return
    sizes_a, sizes_b = tree.sizes[tree.box[a, 3]], tree.sizes[tree.box[b, 3]]
    x = _overlap(tree.box[a, 0], sizes_a[0], tree.box[b, 0], sizes_b[0])
    y = _overlap(tree.box[a, 1], sizes_a[0], tree.box[b, 1], sizes_b[0])
    if x < 0 or y < 0 or (x == 0 and y == 0):
        return
    t = _angle_overlap(tree.box[a, 2], sizes_a[1], tree.box[b, 2], sizes_b[1])
    if t < 0 or (t == 0 and (x == 0 or y == 0)) or tree.links[0] + 2 > len(tree.link):
        return
    at = tree.links[0]
    tree.links[0] += 2
    tree.link[at, 0], tree.link[at, 1], tree.head[a] = b, tree.head[a], at
    tree.link[at + 1, 0], tree.link[at + 1, 1], tree.head[b] = a, tree.head[b], at + 1


@bare
def next_link_to_leaf(child: Ints, head: Ints, link: Ints, cell: int, at: int) -> int:
    """Return the next link of a cell that leads to a leaf, after link `at`, or its first if `at` is -1."""
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
    """Return the length of the overlap of two intervals: 0 if they touch, negative if they are apart."""
    return min(a + size_a, b + size_b) - max(a, b)


@bare
def _angle_overlap(a: int, size_a: int, b: int, size_b: int) -> int:
    """Return the overlap of two intervals on the circle of angles: 0 if they touch, negative if they are apart."""
    best = _overlap(a, size_a, b, size_b)
    best = max(best, _overlap(a + ROOT_UNITS, size_a, b, size_b))
    return max(best, _overlap(a, size_a, b + ROOT_UNITS, size_b))
