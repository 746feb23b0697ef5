"""World models of drawn worlds: looked at from many places, or seen whole at once."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from kb.body import Move
from kb.knowledge import Knowledge
from kb.mapping.occupancy import FREE, FULL, OPEN, MapView, OccupancyMap
from kb.mapping.patch import patch_of
from kb.perception.frame import Frame
from kb.perception.interpretation import interpret_regions
from kb.perception.regions import label_of, map_regions
from kb.perception.retina import count_ranges
from kb.world.model import Node, WorldModel
from tests.kb.eyes import impression, utak_in, world_of

LARGE_ROOM = ["b" * 44, *["b" + "." * 42 + "b"] * 42, "b" * 44]


def drawing(east: int, north: int, wide: int, high: int) -> list[str]:
    """A room with a thing whose lower left square is (east, north)."""
    rows = [list(row) for row in LARGE_ROOM]
    for row in range(north, north + high):
        for column in range(east, east + wide):
            rows[len(rows) - 1 - row][column] = "g"
    return ["".join(row) for row in rows]


def looked(rows: list[str], squares: list[tuple[int, int]]) -> OccupancyMap:
    """The evidence of looks from some squares; the first one is (0, 0) of the lattice."""
    occupied, occupancy = world_of(rows), OccupancyMap()
    samples = Frame().samples()
    for number, (x, y) in enumerate(squares):
        seen = count_ranges(impression(occupied, (x, y), 0).retina)
        at = (x - squares[0][0], y - squares[0][1])
        occupancy.observe(samples, seen, *at, number)
        occupancy.stand(*at, number)
    return occupancy


def seen_whole(rows: list[str], objects: bool = True) -> WorldModel:
    """The model of one who has seen all of a drawing, its north row first, and knows it for certain.

    `.` floor, `b` verge, other letters objects, `?` never seen, `U` Utak, on floor.
    """
    marks = np.array([list(row) for row in reversed(rows)])
    seen, occupied = marks != "?", ~np.isin(marks, [".", "U", "?"])
    probability = np.where(seen, occupied, 0.5).astype(np.float32)
    state = np.where(~seen, -1, np.where(occupied, FULL, FREE)).astype(np.int8)
    x, y = utak_in(rows)
    view = MapView(-x, -y, probability, state, seen, np.where(seen, 0, -1).astype(np.int16))
    percept, labels = map_regions(occupied & seen, seen, seen)
    model = WorldModel(Frame(), (0.5, 0.5), view, labels, percept, interpret_regions(percept), ())
    nodes = [
        Node(f"o{n}", "object", 95, region.name, patch_of(labels == label_of(region.name), view), 0)
        for n, region in enumerate((r for r in percept.regions if model.kinds.of(r.name, "object") == 95), 1)
    ]
    return WorldModel(Frame(), (0.5, 0.5), view, labels, percept, model.kinds, tuple(nodes) if objects else ())


def unclear(model: WorldModel, rows: slice, columns: slice, chance: float) -> WorldModel:
    """The same, where no count settles some squares of the view. chance : that one is occupied."""
    probability, state = model.view.probability.copy(), model.view.state.copy()
    probability[rows, columns], state[rows, columns] = chance, OPEN
    return replace(model, view=model.view._replace(probability=probability, state=state))


class Walk(NamedTuple):
    """What one knows who walked, the last world model, and how each pose was explained."""

    knowledge: Knowledge
    model: WorldModel
    poses: tuple[str, ...]


def walked(rows: list[str], way: list[tuple[int, int]], colour: str = "b") -> Walk:
    """One wakes on the U of a drawing, faces north, and goes by these moves (east, north)."""
    occupied, (x, y), knowledge = world_of(rows), utak_in(rows), Knowledge()
    model, accommodated = knowledge.wake(impression(occupied, (x, y), colour=colour))
    poses = [accommodated.explanation.how]
    for east, north in way:
        x, y = x + east, y + north
        model, accommodated = knowledge.perceive(Move(east, north), impression(occupied, (x, y), colour=colour))
        poses.append(accommodated.explanation.how)
    return Walk(knowledge, model, tuple(poses))
