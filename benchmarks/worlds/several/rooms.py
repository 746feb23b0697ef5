"""Worlds of two rooms: two things that change rooms, and three things that all belong into the next room."""

import numpy as np

from benchmarks.worlds.plain import two_rooms
from benchmarks.worlds.several.scene import (
    Scene,
    beyond,
    door_range,
    finished,
    loads,
    placed,
    quarter_heading,
    robot_place,
)
from benchmarks.worlds.several.tasks import PARAMETERS, SeveralWorld, to_pose, to_room

SWAP_KIND = "swap"
THREE_KIND = "three"
POSES_SHARE = 0.5  # of the worlds with two things that change rooms say where each shall lie


def swap_world(rng: np.random.Generator, seed: int) -> SeveralWorld | None:
    """Return a world in which x belongs into y's room and y into x's, or each to where the other one lies."""
    carried, by_colour = loads(rng, 2)
    plan = two_rooms(rng, door_range(carried))
    names = [str(name) for name in rng.permutation([room.name for room in plan.rooms])]
    things = placed(rng, carried, [plan.room(name) for name in names], [door.polygon for door in plan.doors])
    utak = things and robot_place(rng, plan.room(names[int(rng.integers(2))]), things)
    if not things or utak is None:
        return None
    scene = Scene(plan, things, by_colour, utak, quarter_heading(rng))
    if rng.random() < POSES_SHARE:
        a, b = (thing.polygon.centroid for thing in things)
        east, north = float(round(b.x - a.x)), float(round(b.y - a.y))
        moves = [(east, north, 0.0), (-east, -north, 0.0)]
        wants = [to_pose(PARAMETERS[k], things[k], moves[k], utak, scene.heading) for k in range(2)]
        return finished(SWAP_KIND, seed, "poses", scene, [wants], 2)
    wants = [to_room(PARAMETERS[k], things[k], beyond(plan, names[k])) for k in range(2)]
    return finished(SWAP_KIND, seed, "rooms", scene, [wants], 2)


def three_world(rng: np.random.Generator, seed: int) -> SeveralWorld | None:
    """Return a world in which x, y and z belong into the next room."""
    carried, by_colour = loads(rng, 3)
    plan = two_rooms(rng, door_range(carried))
    home = f"r{int(rng.integers(1, 3))}"
    things = placed(rng, carried, [plan.room(home)] * 3, [door.polygon for door in plan.doors])
    utak = things and robot_place(rng, plan.room(home), things)
    if not things or utak is None:
        return None
    scene = Scene(plan, things, by_colour, utak, quarter_heading(rng))
    wants = [to_room(PARAMETERS[k], things[k], beyond(plan, home)) for k in range(3)]
    return finished(THREE_KIND, seed, "", scene, [wants], 3)
