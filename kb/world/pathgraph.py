"""The pathgraph of the believed floor as facts: junctions, links, and what doors and things links pass."""

from collections.abc import Iterator

import numpy as np

from utak.geometry import Screen
from utak.geometry.kernels.arrays import Floats
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
    for number, (first, last) in enumerate(graph.edges.tolist()):
        name, length, clearance = f"l{number + 1}", graph.lengths[number], graph.edge_clearances[number]
        yield f"link({name},j{first + 1},j{last + 1},{hundredths(length)},{hundredths(clearance)})"
        points = graph.points_of(number)
        columns, rows = np.floor(points).astype(int).T
        yield from (f"crosses({name},{door.name})" for door in rooms.sure if count_crossings(points, door) % 2)
        yield from (f"borders({name},{thing})" for thing in bordering(points, screen.clearance[rows, columns], model))


def bordering(points: Floats, clearances: Floats, model: WorldModel) -> list[str]:
    """Return the names of the things that bound a chain of squares: those nearest to some square of it."""
    # points : centres (x, y), view frame. clearances : of each, in squares.
    corner = np.array([model.view.west, model.view.south])
    found = []
    for node in model.objects:
        squares = np.array(sorted(node.patch.squares())) - corner
        away = np.maximum(np.abs(points[:, None] - squares - 0.5) - 0.5, 0.0)
        if (np.hypot(*np.moveaxis(away, -1, 0)).min(1, initial=np.inf) <= clearances + BORDER_MARGIN).any():
            found.append(node.name)
    return found
