"""The pathgraph as a networkx graph, for showing, exporting and reasoning; searches use arrays.

networkx adds nodes and edges one at a time. Here its dictionaries are filled directly, which takes 0.3 to 0.4 of the
time of ``add_nodes_from`` and ``add_edges_from`` (measured on three Moving AI maps). The garbage collector is paused
meanwhile: on a map with 48,000 edges its passes over objects none of which is garbage took half of the time.
"""

import gc
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from utak.geometry.skeleton.pathgraph_arrays import PathgraphArrays

if TYPE_CHECKING:
    import networkx


def networkx_graph(arrays: PathgraphArrays) -> "networkx.MultiGraph[int]":
    """Return a pathgraph as a networkx graph."""
    import networkx

    graph: networkx.MultiGraph[Any] = networkx.MultiGraph()
    with paused_collection():
        graph._node.update(enumerate(node_attributes(arrays)))
        graph._adj.update(enumerate(adjacency(arrays)))
    return graph


def node_attributes(arrays: PathgraphArrays) -> list[dict[str, float]]:
    """Return for each node of ``arrays``, by number, a dictionary of ``x``, ``y`` and ``clearance``, all in squares."""
    x, y = arrays.nodes.T.tolist()
    places = zip(x, y, arrays.node_clearances.tolist(), strict=True)
    return [{"x": east, "y": north, "clearance": clearance} for east, north, clearance in places]


def adjacency(arrays: PathgraphArrays) -> list[dict[int, dict[int, dict[str, Any]]]]:
    """Return for each node its neighbours, for each of these the edges between by number, for each its attributes."""
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
    """Keep the garbage collector from running inside a ``with`` while many objects are made, none of it garbage."""
    enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if enabled:
            gc.enable()
