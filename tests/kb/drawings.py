"""World models of drawn worlds: seen from some places, or known completely."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from tests.kb.eyes import impression, utak_in, world_of
from utak.kb.body import Move
from utak.kb.knowledge import Knowledge
from utak.kb.mapping.occupancy import FREE, OCCUPIED, OPEN, MapView, OccupancyMap
from utak.kb.mapping.patch import patch_of
from utak.kb.perception.frame import Frame
from utak.kb.perception.interpretation import interpret_regions
from utak.kb.perception.regions import label_of, map_regions
from utak.kb.perception.retina import count_ranges
from utak.kb.world.model import Node, WorldModel

LARGE_ROOM = ["b" * 44, *["b" + "." * 42 + "b"] * 42, "b" * 44]


def drawing(east: int, north: int, wide: int, high: int) -> list[str]:
    """Return a drawing of the large room with an object of `wide` x `high` squares, (east, north) its southwest one."""
    rows = [list(row) for row in LARGE_ROOM]
    for row in range(north, north + high):
        for column in range(east, east + wide):
            rows[len(rows) - 1 - row][column] = "g"
    return ["".join(row) for row in rows]


def looked(rows: list[str], squares: list[tuple[int, int]]) -> OccupancyMap:
    """Return the occupancy map of observations from some squares of a drawing; the first one is (0, 0) of the map."""
    occupied, occupancy = world_of(rows), OccupancyMap()
    samples = Frame().samples()
    for number, (x, y) in enumerate(squares):
        seen = count_ranges(impression(occupied, (x, y), 0).retina)
        at = (x - squares[0][0], y - squares[0][1])
        occupancy.observe(samples, seen, *at, number)
        occupancy.stand(*at, number)
    return occupancy


def known_model(rows: list[str], objects: bool = True) -> WorldModel:
    """Return the world model of a drawing that is known completely and for certain. rows : the north row first.

    `.` floor, `b` verge, other letters objects, `?` never seen, `U` Utak, on floor.
    """
    marks = np.array([list(row) for row in reversed(rows)])
    seen, occupied = marks != "?", ~np.isin(marks, [".", "U", "?"])
    probability = np.where(seen, occupied, 0.5).astype(np.float32)
    state = np.where(~seen, -1, np.where(occupied, OCCUPIED, FREE)).astype(np.int8)
    x, y = utak_in(rows)
    view = MapView(-x, -y, probability, state, seen, np.where(seen, 0, -1).astype(np.int16))
    percept, labels = map_regions(occupied & seen, seen, seen)
    model = WorldModel(Frame(), (0.5, 0.5), view, labels, percept, interpret_regions(percept), ())
    nodes = [
        Node(f"o{n}", "object", 95, region.name, patch_of(labels == label_of(region.name), view), 0)
        for n, region in enumerate((r for r in percept.regions if model.kinds.of(r.name, "object") > 50), 1)
    ]
    return WorldModel(Frame(), (0.5, 0.5), view, labels, percept, model.kinds, tuple(nodes) if objects else ())


def unclear(model: WorldModel, rows: slice, columns: slice, chance: float) -> WorldModel:
    """Return a world model in which some squares of the view are open. chance : that each is occupied, 0 to 1."""
    probability, state = model.view.probability.copy(), model.view.state.copy()
    probability[rows, columns], state[rows, columns] = chance, OPEN
    return replace(model, view=model.view._replace(probability=probability, state=state))


class Walk(NamedTuple):
    """The knowledge after a walk, the last world model, and the kind of explanation of each observation."""

    knowledge: Knowledge
    model: WorldModel
    poses: tuple[str, ...]


def walked(rows: list[str], way: list[tuple[int, int]], colour: str = "b") -> Walk:
    """Return the walk of a robot that wakes on the U of a drawing, faces north, and makes moves (east, north)."""
    occupied, (x, y), knowledge = world_of(rows), utak_in(rows), Knowledge()
    model, accommodated = knowledge.wake(impression(occupied, (x, y), colour=colour))
    poses = [accommodated.explanation.how]
    for east, north in way:
        x, y = x + east, y + north
        model, accommodated = knowledge.perceive(Move(east, north), impression(occupied, (x, y), colour=colour))
        poses.append(accommodated.explanation.how)
    return Walk(knowledge, model, tuple(poses))
