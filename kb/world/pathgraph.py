"""The pathgraph of the believed floor as facts: junctions, links, and what doors and things links pass."""

from collections.abc import Iterator

import numpy as np

from utak.geometry import Screen
from utak.geometry.kernels.arrays import Bools, Floats
from utak.kb.world.model import WorldModel, hundredths
from utak.kb.world.rooms import Rooms, count_crossings

BORDER_MARGIN = (
    0.75  # squares: what is further than the nearest obstacle by no more bounds a link, too; half a diagonal, rounded
)


def pathgraph_facts(model: WorldModel, rooms: Rooms) -> Iterator[str]:
    """Yield the pathgraph of the floor on which the robot stands, without full stops."""
    if not model.floor.any():
        return
    screen = Screen(model.floor)
    graph = screen.pathgraph_arrays

    for number, ((x, y), clearance) in enumerate(zip(graph.nodes, graph.node_clearances, strict=True), 1):
        east, north = model.place_to_utak(x, y)
        yield f"junction(j{number},{hundredths(east)},{hundredths(north)},{hundredths(clearance)})"
    columns, rows = np.floor(graph.points).astype(int).T
    beside = bordering(graph.points, screen.clearance[rows, columns], model)
    for number, (first, last) in enumerate(graph.edges.tolist()):
        name, length, clearance = f"l{number + 1}", graph.lengths[number], graph.edge_clearances[number]
        yield f"link({name},j{first + 1},j{last + 1},{hundredths(length)},{hundredths(clearance)})"
        points = graph.points_of(number)
        yield from (f"crosses({name},{door.name})" for door in rooms.sure if count_crossings(points, door) % 2)
        along = beside[graph.offsets[number] : graph.offsets[number + 1]].any(0)
        yield from (f"borders({name},{model.objects[thing].name})" for thing in np.flatnonzero(along))


def bordering(points: Floats, clearances: Floats, model: WorldModel) -> Bools:
    """Return which things are nearest to which squares, or hardly further than what is: (squares, objects) bool."""
    # points : centres (x, y), view frame. clearances : of each, in squares.
    corner, reach = np.array([model.view.west, model.view.south]), clearances + BORDER_MARGIN
    beside: Bools = np.zeros((len(points), len(model.objects)), np.bool_)
    for number, (west, south, mask) in enumerate(node.patch for node in model.objects):
        low = np.array([west, south]) - corner
        outside = np.maximum(np.maximum(low - points, points - low - mask.shape[::-1]), 0.0)
        near = np.flatnonzero(np.hypot(*outside.T) <= reach)  # to the rectangle about it
        if len(near):
            away = np.maximum(np.abs(points[near, None] - (np.argwhere(mask)[:, ::-1] + low + 0.5)) - 0.5, 0.0)
            beside[near, number] = np.hypot(away[..., 0], away[..., 1]).min(1) <= reach[near]
    return beside
