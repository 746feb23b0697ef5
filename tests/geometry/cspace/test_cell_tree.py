"""The tree of cells against brute force: its links are the faces that leaves share; chains exist when they should."""

import math
from itertools import pairwise

import networkx as nx
import numpy as np
import pytest
from shapely import box

from geometry.cspace.cell_tree import WHOLE, CellTree, leaf_at, new_tree, next_neighbour, split, splittable
from geometry.cspace.channel import find_chain, new_hunt
from geometry.motion.body import new_mover
from geometry.motion.cell_clearance import FULL
from geometry.motion.obstacle_field import ObstacleField

BODY = box(-2, -0.5, 2, 0.5)
WALLS = box(-1, -1, 11, 11).difference(box(0, 0, 10, 10)).union(box(4.5, 0, 5.5, 7.5))
FLOOR = ObstacleField(WALLS, (0, 0, 10, 10))
MOVER = new_mover(BODY)
GROUND = FLOOR.ground(MOVER)


def grown(seed: int, splits: int) -> CellTree:
    """A tree in which leaves were split at random."""
    rng = np.random.default_rng(seed)
    tree = new_tree(0.0, 0.0, 10.0, MOVER.radius, 0.05, 5000)
    for _ in range(splits):
        cell = int(rng.choice(leaves(tree)))
        if splittable(tree, cell, MOVER):
            split(tree, cell, MOVER, GROUND)
    return tree


def leaves(tree: CellTree) -> list[int]:
    return [n for n in range(tree.used[0]) if tree.child[n] < 0 and tree.kind[n] != FULL]


def share_a_face(tree: CellTree, a: int, b: int) -> bool:
    """Two boxes that touch along more than an edge; angles wrap."""
    common = []
    for k in range(3):
        size_a, size_b = (int(tree.sizes[tree.box[n, 3], k // 2]) for n in (a, b))
        low_a, low_b = int(tree.box[a, k]), int(tree.box[b, k])
        turns = (-WHOLE, 0, WHOLE) if k == 2 else (0,)
        common.append(max(min(low_a + size_a, low_b + t + size_b) - max(low_a, low_b + t) for t in turns))
    return min(common) >= 0 and sum(c == 0 for c in common) <= 1


def linked(tree: CellTree, cell: int) -> set[int]:
    found, link = set(), next_neighbour(tree.child, tree.head, tree.link, cell, -1)
    while link >= 0:
        found.add(int(tree.link[link, 0]))
        link = next_neighbour(tree.child, tree.head, tree.link, cell, link)
    return found


@pytest.mark.parametrize("seed", range(4))
def test_links_are_the_shared_faces(seed: int) -> None:
    tree = grown(seed, 60)
    alive = leaves(tree)
    for a in alive:
        assert linked(tree, a) == {b for b in alive if b != a and share_a_face(tree, a, b)}


def test_the_leaf_at_a_pose_holds_it() -> None:
    tree, rng = grown(5, 200), np.random.default_rng(6)
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
def test_a_repaired_search_finds_a_chain_when_there_is_one(seed: int) -> None:
    """Splits between searches, anywhere: the kept tree must say what a fresh graph says."""
    rng = np.random.default_rng(seed)
    tree = new_tree(0.0, 0.0, 10.0, MOVER.radius, 0.05, 5000)
    hunt = new_hunt(5000, FLOOR.ways(FLOOR.pixel_of(8.0, 2.0), 0.5), np.zeros(2))
    for nth in range(1, 60):
        first, last = leaf_at(tree, 2.0, 2.0, 1.5), leaf_at(tree, 8.0, 2.0, 1.5)
        length = find_chain(tree, MOVER, GROUND, GROUND, hunt, first, last, nth, False)
        alive = leaves(tree)
        graph = nx.Graph([(a, b) for a in alive for b in linked(tree, a)])
        graph.add_nodes_from(alive)
        ends_alive = first in graph and last in graph
        assert (length > 0) == (ends_alive and nx.has_path(graph, first, last))
        if length == 0:
            break
        chain = [int(n) for n in hunt.chain[:length]]
        assert (chain[0], chain[-1]) == (first, last)
        assert all(graph.has_edge(a, b) for a, b in pairwise(chain))
        for cell in {*rng.choice(chain, min(3, length)), rng.choice(alive)}:
            if tree.child[cell] < 0 and splittable(tree, int(cell), MOVER):
                split(tree, int(cell), MOVER, GROUND)
