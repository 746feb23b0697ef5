"""The pathgraph as a networkx graph, for showing, exporting and reasoning; searches use arrays.

networkx adds nodes and edges one at a time. Here its dictionaries are filled directly, which takes 0.3 to 0.4 of the
time of ``add_nodes_from`` and ``add_edges_from`` (measured on three Moving AI maps). The garbage collector is paused
meanwhile: on a map with 48,000 edges its passes over objects none of which is garbage took half of the time.
"""

import gc
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from geometry.skeleton.pathgraph_arrays import PathgraphArrays

if TYPE_CHECKING:
    import networkx


def networkx_graph(arrays: PathgraphArrays) -> "networkx.MultiGraph[int]":
    """Return a pathgraph as a networkx graph.

    Parameters
    ----------
    arrays : PathgraphArrays
        The pathgraph: places and clearances of nodes, ends, lengths and points of edges. The points of edges become
        views of its block of points.

    Returns
    -------
    networkx.MultiGraph
        An ordinary graph that may be changed, copied and pickled. Nodes are numbered as in ``arrays`` and carry ``x``,
        ``y`` and ``clearance``. The key of an edge is its number in ``arrays``; edges carry ``length``, ``clearance``
        and ``points``, a (k, 2) array of float64. All in squares, in the frame of the screen.
    """
    import networkx

    graph: networkx.MultiGraph[Any] = networkx.MultiGraph()
    with paused_collection():
        graph._node.update(enumerate(node_attributes(arrays)))
        graph._adj.update(enumerate(adjacency(arrays)))
    return graph


def node_attributes(arrays: PathgraphArrays) -> list[dict[str, float]]:
    """Return for each node of ``arrays``, by number, a dictionary of ``x``, ``y`` and ``clearance``, all in squares.

    The frame is that of the screen: x to the east, y to the north, (0, 0) at the south-west corner.
    """
    x, y = arrays.nodes.T.tolist()
    places = zip(x, y, arrays.node_clearances.tolist(), strict=True)
    return [{"x": east, "y": north, "clearance": clearance} for east, north, clearance in places]


def adjacency(arrays: PathgraphArrays) -> list[dict[int, dict[int, dict[str, Any]]]]:
    """Return for each node its neighbours, for each of these the edges between by number, for each its attributes.

    The list has a dictionary for each node of ``arrays``, by number: neighbour to (number of the edge to attributes).
    Attributes are ``length`` and ``clearance`` in squares and ``points``, (k, 2) float64, x and y in squares, in the
    frame of the screen. A node without edges has an empty one. Both ends of an edge share the dictionaries of the edge,
    as networkx has it.
    """
    rows: list[dict[int, dict[int, dict[str, Any]]]] = [{} for _ in range(len(arrays.nodes))]
    points, offsets = arrays.points, arrays.offsets.tolist()
    first, last = arrays.edges.T.tolist()
    values = arrays.lengths.tolist(), arrays.edge_clearances.tolist(), offsets[:-1], offsets[1:]
    for edge, (a, b, length, clearance, begin, end) in enumerate(zip(first, last, *values, strict=True)):
        attributes = {"length": length, "clearance": clearance, "points": points[begin:end]}
        row = rows[a]
        if b in row:
            row[b][edge] = attributes
        else:
            row[b] = rows[b][a] = {edge: attributes}
    return rows


@contextmanager
def paused_collection() -> Iterator[None]:
    """Keep the garbage collector from running inside a ``with`` while many objects are made, none of which is garbage.

    At the end it runs again, if it did before.
    """
    enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if enabled:
            gc.enable()
