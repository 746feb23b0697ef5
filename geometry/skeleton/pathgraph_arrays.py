"""The pathgraph in arrays: places and clearances of nodes, ends, lengths and points of edges.

The contracted skeleton (graph.py) knows the cells of nodes and the lowest cell of each chain. One pass over it walks
every chain again and writes the places of its cells straight into one block of points.
"""

from typing import Any, NamedTuple

import numpy as np

from utak.geometry.kernels.arrays import Floats, Ints, SquaredDistances
from utak.geometry.kernels.jit import bare
from utak.geometry.skeleton.graph import SkeletonGraph
from utak.geometry.skeleton.skeleton import LINKS, Flags, Heights, States


class PathgraphArrays(NamedTuple):
    """A pathgraph of n nodes and m edges whose chains have p points in all, as numpy arrays.

    Nodes are the junctions and ends of the skeleton, edges the chains between them. Lengths, clearances and
    coordinates are in squares; points are (x, y) in the frame of the screen, where the square in column i and row j
    has its centre at (i + 0.5, j + 0.5), row 0 in the south. Nodes come in ascending order of (y, x), edges in
    ascending order of their first node. The clearance of a point is its distance to the nearest point of a square that
    is not free. The arrays of a ``Screen`` are read-only.

    Attributes
    ----------
    nodes : (n, 2) float64
        Place (x, y) of each node.
    node_clearances : (n,) float64
        Distance from each node to the nearest square that is not free.
    edges : (m, 2) int32
        Numbers of the first and the last node of each edge: rows of ``nodes``. Parallel edges occur, and loops, whose
        first node is also the last.
    lengths : (m,) float64
        Length of the polyline through the points of each edge: a whole number, because it leads from square to square
        over their sides.
    edge_clearances : (m,) float64
        Least clearance of the points of each edge.
    points : (p, 2) float64
        Centres (x, y) of the squares of all edges, one edge after the other, each from its first node to its last, both
        included.
    offsets : (m + 1,) int32
        Rows of ``points``: those of edge e are ``points[offsets[e]:offsets[e + 1]]``.

    Examples
    --------
    A floor around one blocked square has one node, and one edge that leads around the square back to it:

    >>> import numpy as np
    >>> from utak.geometry import Screen
    >>> free = np.ones((3, 3), dtype=bool)
    >>> free[1, 1] = False
    >>> graph = Screen(free).pathgraph_arrays
    >>> graph.nodes.tolist(), graph.edges.tolist(), graph.lengths.tolist(), graph.edge_clearances.tolist()
    ([[0.5, 0.5]], [[0, 0]], [8.0], [0.5])
    >>> graph.points_of(0).tolist()[:4]
    [[0.5, 0.5], [1.5, 0.5], [2.5, 0.5], [2.5, 1.5]]

    Edges with room for a body of radius 0.6:

    >>> np.flatnonzero(graph.edge_clearances >= 0.6).tolist()
    []
    """

    nodes: Floats
    node_clearances: Floats
    edges: Ints
    lengths: Floats
    edge_clearances: Floats
    points: Floats
    offsets: Ints

    def points_of(self, edge: int) -> Floats:
        """Return the points of an edge as a view.

        Parameters
        ----------
        edge : int
            Number of the edge, from 0 on: its row of ``edges``.

        Returns
        -------
        (k, 2) float64
            Centres (x, y) of its squares in squares, from its first node to its last, both included.
        """
        return self.points[self.offsets[edge] : self.offsets[edge + 1]]


def build_pathgraph_arrays(square: SquaredDistances, state: States, bones: SkeletonGraph) -> PathgraphArrays:
    """Return the pathgraph of a skeleton as new arrays, which share no memory with the arguments."""
    n, m = len(bones.node), len(bones.steps)
    offsets = np.zeros(m + 1, np.int32)
    np.cumsum(bones.steps + 1, out=offsets[1:])
    graph = PathgraphArrays(
        nodes=np.empty((n, 2)),
        node_clearances=np.empty(n),
        edges=np.empty((m, 2), np.int32),
        lengths=np.empty(m),
        edge_clearances=np.empty(m),
        points=np.empty((offsets.item(m), 2)),
        offsets=offsets,
    )
    arrays: Any = graph
    fill_arrays(square.reshape(-1), state.reshape(-1), state.shape[1], *bones, *arrays)
    return graph


@bare
def fill_arrays(
    heights: Heights,
    states: Flags,
    width: int,
    node: Ints,
    port: Ints,
    lowest: Ints,
    steps: Ints,
    nodes: Floats,
    node_clearances: Floats,
    edges: Ints,
    lengths: Floats,
    edge_clearances: Floats,
    points: Floats,
    offsets: Ints,
) -> None:
    """Fill the arrays of a ``PathgraphArrays`` (all but ``offsets``) from those of a ``SkeletonGraph``."""
    fill_nodes(heights, width, node, nodes, node_clearances)
    for edge in range(port.shape[0]):
        edges[edge, 0], edges[edge, 1], lengths[edge] = port[edge, 0] >> 2, port[edge, 1] >> 2, steps[edge]
        edge_clearances[edge] = 0.5 * np.sqrt(float(heights[lowest[edge]]))
    fill_points(states, width, node, port, nodes, offsets, points)


@bare
def fill_nodes(heights: Heights, width: int, node: Ints, nodes: Floats, clearances: Floats) -> None:
    """Fill places and clearances of nodes."""
    row, first = 0, 0
    for k in range(node.shape[0]):
        cell = int(node[k])
        while cell >= first + width:
            first += width
            row += 1
        nodes[k, 0], nodes[k, 1] = cell - first - 0.5, row - 0.5
        clearances[k] = 0.5 * np.sqrt(float(heights[cell]))


@bare
def fill_points(
    states: Flags, width: int, node: Ints, port: Ints, nodes: Floats, offsets: Ints, points: Floats
) -> None:
    """Walk every chain from its first end and fill ``points``."""
    for edge in range(port.shape[0]):
        first = port[edge, 0] >> 2
        cell, way, x, y = int(node[first]), 1 << (port[edge, 0] & 3), nodes[first, 0], nodes[first, 1]
        begin, end = int(offsets[edge]), int(offsets[edge + 1])
        points[begin, 0], points[begin, 1] = x, y
        for k in range(begin + 1, end):
            east, north = (way & 1) - (way >> 2 & 1), (way >> 1 & 1) - (way >> 3)
            cell += east + north * width
            x += east
            y += north
            points[k, 0], points[k, 1] = x, y
            way = int(states[cell]) & LINKS ^ (way >> 2 | (way & 3) << 2)
