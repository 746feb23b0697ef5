"""The pathgraph of the believed floor as facts: junctions, the links between them, and the doors that links cross."""

from collections.abc import Iterator

from utak.geometry import Screen
from utak.kb.world.model import WorldModel, hundredths
from utak.kb.world.rooms import Rooms, count_crossings


def pathgraph_facts(model: WorldModel, rooms: Rooms) -> Iterator[str]:
    """Yield the pathgraph of the floor on which the robot stands, without full stops."""
    if not model.floor.any():
        return
    graph = Screen(model.floor).pathgraph_arrays
    for number, ((x, y), clearance) in enumerate(zip(graph.nodes, graph.node_clearances, strict=True), 1):
        east, north = model.place_to_utak(x, y)
        yield f"junction(j{number},{hundredths(east)},{hundredths(north)},{hundredths(clearance)})"
    for number, (first, last) in enumerate(graph.edges.tolist()):
        name, length, clearance = f"l{number + 1}", graph.lengths[number], graph.edge_clearances[number]
        yield f"link({name},j{first + 1},j{last + 1},{hundredths(length)},{hundredths(clearance)})"
        points = graph.points_of(number)
        yield from (f"crosses({name},{door.name})" for door in rooms.sure if count_crossings(points, door) % 2)
