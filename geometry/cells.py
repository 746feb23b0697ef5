"""A tree of cells of poses: boxes of places and angles that are split where it is not yet known whether a body fits.

Plain loops for numba. A cell is a square of places times an interval of angles; all cells of one depth have the same
size. Splitting halves what contributes most to how far a point of the body may move in the cell: the place (four
children) or the angle (two). Corners of cells are whole numbers, so neighbours are found without rounding; angles wrap.

Source: soft subdivision search: Zhu and Latombe 1989; Wang, Chiang and Yap 2013; Zhou, Chiang and Yap 2018.
"""

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from geometry.compiled import compiled
from geometry.separation import FULL, Ground, Mover, classify

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int32]
FINEST = 24  # halvings of place or angle at most
WHOLE = 1 << FINEST
DEEPEST = 2 * FINEST


class Tree(NamedTuple):
    """Cells, numbered from 0, the root.

    box: (capacity, 4) the least corner as whole numbers x, y, angle, and the depth. child: first child or -1 for a
    leaf. kind: as separation.classify tells. used: (1,) how many cells there are. sizes: (depths, 2) the whole-number
    sizes of place and angle by depth. frame: x, y of the corner, unit of place, unit of angle, resolution.
    """

    box: Ints
    child: Ints
    kind: npt.NDArray[np.int8]
    used: npt.NDArray[np.int64]
    sizes: Ints
    frame: Floats


def new_tree(x: float, y: float, side: float, radius: float, resolution: float, capacity: int) -> Tree:
    """A tree of one cell: the square of places at (x, y) and all angles. resolution: cells are not split below it."""
    sizes = [(WHOLE, WHOLE)]
    for _ in range(DEEPEST):
        place, angle = sizes[-1]
        spread = side * (place / WHOLE) / math.sqrt(2)
        swing = 2 * radius * math.sin(math.pi * min(angle / WHOLE, 1.0) / 2)
        sizes.append((place // 2, angle) if spread >= swing else (place, angle // 2))
    tree = Tree(
        np.empty((capacity, 4), np.int32),
        np.empty(capacity, np.int32),
        np.empty(capacity, np.int8),
        np.ones(1, np.int64),
        np.array(sizes, np.int32),
        np.array([x, y, side / WHOLE, 2 * math.pi / WHOLE, resolution]),
    )
    tree.box[0], tree.child[0], tree.kind[0] = 0, -1, 2
    return tree


@compiled
def centre(tree: Tree, cell: int) -> tuple[float, float, float]:
    """The pose in the middle of a cell: x, y, angle in radians from 0 to a whole turn."""
    depth = tree.box[cell, 3]
    place, angle = tree.sizes[depth, 0], tree.sizes[depth, 1]
    x = tree.frame[0] + (tree.box[cell, 0] + 0.5 * place) * tree.frame[2]
    y = tree.frame[1] + (tree.box[cell, 1] + 0.5 * place) * tree.frame[2]
    return x, y, (tree.box[cell, 2] + 0.5 * angle) * tree.frame[3]


@compiled
def splittable(tree: Tree, cell: int, mover: Mover) -> bool:
    """Whether a cell is larger than the resolution and there is room for its children."""
    depth = tree.box[cell, 3]
    if depth + 1 >= len(tree.sizes) or tree.used[0] + 4 > len(tree.child):
        return False
    spread = tree.sizes[depth, 0] * tree.frame[2] / math.sqrt(2.0)
    swing = 2.0 * mover.radius * math.sin(min(tree.sizes[depth, 1] * tree.frame[3] / 2, math.pi) / 2)
    return bool(spread + swing > tree.frame[4])


@compiled
def split(tree: Tree, cell: int, mover: Mover, ground: Ground) -> None:
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
        tree.child[new] = -1
        x, y, turn = centre(tree, new)
        tree.kind[new] = classify(mover, ground, x, y, turn, spread, half)


@compiled
def leaf_at(tree: Tree, x: float, y: float, angle: float) -> int:
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


@compiled
def neighbours(tree: Tree, cell: int, found: Ints, stack: Ints) -> int:
    """The leaves, FULL ones left out, that share a face with a cell: written to `found`; how many there are."""
    depth = tree.box[cell, 3]
    x, y, t = tree.box[cell, 0], tree.box[cell, 1], tree.box[cell, 2]
    place, angle = tree.sizes[depth, 0], tree.sizes[depth, 1]
    count = 0
    stack[0] = 0
    top = 1
    while top > 0:
        top -= 1
        other = stack[top]
        deep = tree.box[other, 3]
        size, span = tree.sizes[deep, 0], tree.sizes[deep, 1]
        ox = _overlap(x, place, tree.box[other, 0], size)
        oy = _overlap(y, place, tree.box[other, 1], size)
        if ox < 0 or oy < 0:
            continue
        ot = _turned_overlap(t, angle, tree.box[other, 2], span)
        if ot < 0 or (ox == 0) + (oy == 0) + (ot == 0) > 1:
            continue
        first = tree.child[other]
        if first < 0:
            if other != cell and tree.kind[other] != FULL:
                found[count] = other
                count += 1
            continue
        pieces = 4 if tree.sizes[deep + 1, 0] < size else 2
        for n in range(pieces):
            stack[top] = first + n
            top += 1
    return count


@compiled
def _overlap(a: int, size_a: int, b: int, size_b: int) -> int:
    """By how much two intervals overlap: 0 when they touch, negative when they are apart."""
    return min(a + size_a, b + size_b) - max(a, b)


@compiled
def _turned_overlap(a: int, size_a: int, b: int, size_b: int) -> int:
    """The same on the circle of angles."""
    best = _overlap(a, size_a, b, size_b)
    best = max(best, _overlap(a + WHOLE, size_a, b, size_b))
    return max(best, _overlap(a, size_a, b + WHOLE, size_b))
