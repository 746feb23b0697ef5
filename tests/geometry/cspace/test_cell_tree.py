"""The tree of cells against brute force: links are the faces that leaves share, and channels exist when they should."""

import math
from itertools import pairwise

import networkx as nx
import numpy as np
import pytest
from shapely import box

from utak.geometry.cspace.cell_tree import (
    ROOT_UNITS,
    CellTree,
    is_splittable,
    leaf_at,
    new_cell_tree,
    next_link_to_leaf,
    split_cell,
)
from utak.geometry.cspace.channel import find_channel, new_channel_search
from utak.geometry.motion.body import new_moving_body
from utak.geometry.motion.cell_clearance import CELL_BLOCKED
from utak.geometry.motion.obstacle_field import ObstacleField

SHAPE = box(-2, -0.5, 2, 0.5)
WALLS = box(-1, -1, 11, 11).difference(box(0, 0, 10, 10)).union(box(4.5, 0, 5.5, 7.5))
FIELD = ObstacleField(WALLS, (0, 0, 10, 10))
BODY = new_moving_body(SHAPE)
NEARBY = FIELD.ground(BODY)


def random_tree(seed: int, splits: int) -> CellTree:
    """Return a tree in which leaves were split at random."""
    rng = np.random.default_rng(seed)
    tree = new_cell_tree(0.0, 0.0, 10.0, BODY.radius, 0.05, 5000)
    for _ in range(splits):
        cell = int(rng.choice(leaves(tree)))
        if is_splittable(tree, cell, BODY):
            split_cell(tree, cell, BODY, NEARBY)
    return tree


def leaves(tree: CellTree) -> list[int]:
    """Return the leaves that are not blocked."""
    return [n for n in range(tree.used[0]) if tree.child[n] < 0 and tree.kind[n] != CELL_BLOCKED]


def share_a_face(tree: CellTree, a: int, b: int) -> bool:
    """Return whether two boxes touch along more than an edge; angles wrap."""
    common = []
    for k in range(3):
        size_a, size_b = (int(tree.sizes[tree.box[n, 3], k // 2]) for n in (a, b))
        low_a, low_b = int(tree.box[a, k]), int(tree.box[b, k])
        turns = (-ROOT_UNITS, 0, ROOT_UNITS) if k == 2 else (0,)
        common.append(max(min(low_a + size_a, low_b + t + size_b) - max(low_a, low_b + t) for t in turns))
    return min(common) >= 0 and sum(c == 0 for c in common) <= 1


def linked(tree: CellTree, cell: int) -> set[int]:
    """Return the leaves that a cell is linked to."""
    found, link = set(), next_link_to_leaf(tree.child, tree.head, tree.link, cell, -1)
    while link >= 0:
        found.add(int(tree.link[link, 0]))
        link = next_link_to_leaf(tree.child, tree.head, tree.link, cell, link)
    return found


@pytest.mark.parametrize("seed", range(4))
def test_links_are_the_shared_faces(seed: int) -> None:
    tree = random_tree(seed, 60)
    current = leaves(tree)
    for a in current:
        assert linked(tree, a) == {b for b in current if b != a and share_a_face(tree, a, b)}


def test_the_leaf_at_a_pose_contains_the_pose() -> None:
    tree, rng = random_tree(5, 200), np.random.default_rng(6)
    for _ in range(200):
        x, y, angle = *rng.uniform(0, 10, 2), rng.uniform(-9, 9)
        cell = leaf_at(tree, x, y, angle)
        place, span = (int(v) for v in tree.sizes[tree.box[cell, 3]])
        half_place, half_angle = place * tree.frame[2] / 2, span * tree.frame[3] / 2
        assert abs(tree.middle[cell, 0] - x) <= half_place + 1e-9
        assert abs(tree.middle[cell, 1] - y) <= half_place + 1e-9
        assert abs(math.remainder(tree.middle[cell, 2] - angle, 2 * math.pi)) <= half_angle + 1e-9
    assert leaf_at(tree, -1.0, 5.0, 0.0) == -1


@pytest.mark.parametrize("seed", range(6))
def test_a_repaired_search_finds_a_channel_when_there_is_one(seed: int) -> None:
    """After splits anywhere between searches the kept search tree must agree with a fresh graph."""
    rng = np.random.default_rng(seed)
    tree = new_cell_tree(0.0, 0.0, 10.0, BODY.radius, 0.05, 5000)
    search = new_channel_search(5000, FIELD.disc_distances(FIELD.pixel_mask(8.0, 2.0), 0.5), np.zeros(2))
    for _ in range(59):
        first, last = leaf_at(tree, 2.0, 2.0, 1.5), leaf_at(tree, 8.0, 2.0, 1.5)
        length = find_channel(tree, BODY, NEARBY, NEARBY, search, first, last, False)
        current = leaves(tree)
        graph = nx.Graph([(a, b) for a in current for b in linked(tree, a)])
        graph.add_nodes_from(current)
        ends_are_leaves = first in graph and last in graph
        assert (length > 0) == (ends_are_leaves and nx.has_path(graph, first, last))
        if length == 0:
            break
        channel = [int(n) for n in search.channel[:length]]
        assert (channel[0], channel[-1]) == (first, last)
        assert all(graph.has_edge(a, b) for a, b in pairwise(channel))
        for cell in {*rng.choice(channel, min(3, length)), rng.choice(current)}:
            if tree.child[cell] < 0 and is_splittable(tree, int(cell), BODY):
                split_cell(tree, int(cell), BODY, NEARBY)
