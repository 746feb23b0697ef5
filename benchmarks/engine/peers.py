"""The libraries that screens are compared with: same map, same ends, same process, prepared beforehand.

scikit-image (Zhang and Suen 1984), sknw, scipy, networkx and w9-pathfinding; they come with the extra `bench`.
"""

import os
from collections.abc import Callable
from itertools import islice

import networkx as nx
import numpy as np
from scipy.ndimage import distance_transform_edt, label
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import dijkstra
from skimage.morphology import skeletonize
from sknw import build_sknw

from utak.geometry.kernels.arrays import XY

Finder = Callable[[XY, XY], object]


def skeleton_graph(free: np.ndarray) -> tuple[nx.MultiGraph, np.ndarray]:
    """Return a pathgraph by skimage.skeletonize and sknw, and clearances by scipy's distance transform.

    Parameters
    ----------
    free : (rows, columns) bool
        Free squares.

    Returns
    -------
    graph : networkx.MultiGraph
        As sknw has it: nodes with ``pts`` and ``o``, edges with ``pts`` and ``weight``.
    distances : (rows + 2, columns + 2) float64
        From each square's centre to that of the nearest blocked square, in squares.
    """
    padded = np.pad(free, 1)
    return build_sknw(skeletonize(padded).astype(np.uint16), multi=True), distance_transform_edt(padded)


def in_child(call: Callable[[], np.ndarray]) -> np.ndarray | None:
    """Return the float64 array that a call returns, run in a child process; None when the child dies.

    On some maps sknw corrupts the memory of its process, which then dies sooner or later.
    """
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            os.write(writing, call().tobytes())
            os._exit(0)
        finally:
            os._exit(1)
    os.close(writing)
    with os.fdopen(reading, "rb") as pipe:
        answer = pipe.read()
    return np.frombuffer(answer) if os.waitpid(child, 0)[1] == 0 else None


def components_and_holes(free: np.ndarray) -> tuple[int, int]:
    """Return the number of edge-connected components and of holes, which every pathgraph of free space must have."""
    padded = np.pad(free, 1)
    return label(padded)[1], label(~padded, np.ones((3, 3)))[1] - 1


def w9_astar(free: np.ndarray) -> Finder:
    """Return w9-pathfinding's A* for a map; diagonal steps lead only between two free squares."""
    from w9_pathfinding.envs import DiagonalMovement, Grid
    from w9_pathfinding.pf import AStar

    grid = Grid(
        np.where(free, 1.0, -1.0).tolist(),
        diagonal_movement=DiagonalMovement.only_when_no_obstacle,
        diagonal_movement_cost_multiplier=2**0.5,
    )
    finder = AStar(grid)
    return lambda p, q: finder.find_path((int(p[0]), int(p[1])), (int(q[0]), int(q[1])))


def grid_edges(free: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the legal steps to four of the eight neighbours: flat indices of both squares, and lengths in squares."""
    rows, columns = free.shape
    padded = np.pad(free, 1)
    own = np.arange(rows * columns).reshape(rows, columns)
    tails, heads, lengths = [], [], []
    for dy, dx in ((0, 1), (1, 0), (1, 1), (1, -1)):
        there = padded[1 + dy : 1 + dy + rows, 1 + dx : 1 + dx + columns]
        ok = free & there
        if dx and dy:
            ok &= padded[1 : 1 + rows, 1 + dx : 1 + dx + columns] & padded[1 + dy : 1 + dy + rows, 1 : 1 + columns]
        tails.append(own[ok])
        heads.append(own[ok] + dy * columns + dx)
        lengths.append(np.full(ok.sum(), np.hypot(dx, dy)))
    return np.concatenate(tails), np.concatenate(heads), np.concatenate(lengths)


def scipy_dijkstra(free: np.ndarray) -> Finder:
    """Return scipy's Dijkstra on the eight-connected grid, which also traces the path back."""
    tails, heads, lengths = grid_edges(free)
    size, columns = free.size, free.shape[1]
    graph = coo_matrix((lengths, (tails, heads)), (size, size)).tocsr()

    def find(p: XY, q: XY) -> list[int]:
        start, cell = (int(v[1]) * columns + int(v[0]) for v in (p, q))
        _, before = dijkstra(graph, directed=False, indices=start, return_predecessors=True)
        way = [cell]
        while cell != start:
            cell = before[cell]
            way.append(cell)
        return way

    return find


def simple_graph(pathgraph: nx.MultiGraph) -> nx.Graph:
    """Return the pathgraph for networkx's k shortest paths, which knows no parallel edges: edges get a middle node."""
    graph = nx.Graph()
    graph.add_nodes_from(pathgraph)
    for a, b, key, edge in pathgraph.edges(keys=True, data=True):
        graph.add_edge(a, ("middle", key), weight=0.5 * edge["length"])
        graph.add_edge(("middle", key), b, weight=0.5 * edge["length"])
    return graph


def networkx_ways(graph: nx.Graph, a: int, b: int, k: int) -> list[list[object]]:
    """Return networkx's k shortest simple paths between two nodes."""
    return list(islice(nx.shortest_simple_paths(graph, a, b, "weight"), k))
