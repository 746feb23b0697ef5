"""The pathgraph as a networkx graph, for showing, exporting and reasoning; searches use the arrays of chains.py."""

from typing import TYPE_CHECKING, Any

import numpy as np

from geometry.kernels.arrays import Floats, SquaredDistances
from geometry.skeleton.chains import Chains

if TYPE_CHECKING:
    import networkx


def networkx_graph(square: SquaredDistances, chains: Chains) -> "networkx.MultiGraph[int]":
    """Junctions and ends as nodes, chains as edges.

    Nodes are numbered from 0 and carry ``x``, ``y`` and ``clearance``; an edge's key is the number of its chain, and it
    carries ``points`` (n, 2), the centres of its squares from end to end, ``length``, that of the line through them,
    ``clearance`` (the least along it) and ``neck`` (where that is), in squares. A chain goes from square to square over
    their edges, so the length is a whole number, and no shorter than the shortest way of its class between its ends.
    """
    import networkx

    heights, width = square.reshape(-1), square.shape[1]
    graph: networkx.MultiGraph[Any] = networkx.MultiGraph()
    places = centres(chains.node, width).tolist()
    clearances = (0.5 * np.sqrt(heights[chains.node], dtype=np.float64)).tolist()
    for node, ((x, y), clearance) in enumerate(zip(places, clearances, strict=True)):
        graph.add_node(node, x=x, y=y, clearance=clearance)
    points = centres(chains.cells, width)
    least = (0.5 * np.sqrt(heights[chains.cells[chains.neck]], dtype=np.float64)).tolist()
    necks, start = points[chains.neck].tolist(), chains.start.tolist()
    for chain, (a, b) in enumerate(chains.ends.tolist()):
        graph.add_edge(
            a,
            b,
            key=chain,
            length=float(start[chain + 1] - start[chain] - 1),
            clearance=least[chain],
            neck=tuple(necks[chain]),
            points=points[start[chain] : start[chain + 1]],
        )
    return graph


def centres(cells: np.ndarray[Any, Any], width: int) -> Floats:
    """(n, 2) the centres of padded cells, in squares."""
    return np.stack([cells % width - 0.5, cells // width - 0.5], axis=-1)
