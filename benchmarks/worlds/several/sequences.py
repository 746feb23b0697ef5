"""Worlds with sequences of four steps: things are carried to places, and the robot goes to places, in turn."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from shapely.geometry.base import BaseGeometry

from benchmarks.worlds.plain import two_rooms
from benchmarks.worlds.several.corners import single_room
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
from benchmarks.worlds.several.tasks import (
    PARAMETERS,
    SeveralWorld,
    Want,
    robot_back,
    robot_to_corner,
    robot_to_thing,
    to_corner,
    to_room,
)
from benchmarks.worlds.walking import CORNER_DIRECTIONS

SEQUENCE_KIND = "sequence"
SEQUENCE_STEPS = 4  # of a sequence
ROOMS_SHARE = 0.5  # of the worlds have two rooms
BACK_SHARE = 0.5  # of the sequences end where the robot woke
ROBOT_STEP_SHARE = 0.3  # of the other steps are the robot's alone


def sequence_world(rng: np.random.Generator, seed: int) -> SeveralWorld | None:
    """Return a world with a sequence of four steps about two things; None for no place."""
    carried, by_colour = loads(rng, 2)
    plan = two_rooms(rng, door_range(carried)) if rng.random() < ROOMS_SHARE else single_room(rng)
    homes = [plan.rooms[int(rng.integers(len(plan.rooms)))] for _ in carried]
    things = placed(rng, carried, [room.polygon for room in homes], [door.polygon for door in plan.doors])
    utak = things and robot_place(rng, homes[0].polygon, things)
    if not things or utak is None:
        return None
    scene = Scene(plan, things, by_colour, utak, quarter_heading(rng))
    lying: list[BaseGeometry] = [
        thing.polygon for thing in things
    ]  # the regions that hold the things from step to step
    stages: list[list[Want | None]] = []
    back = bool(rng.random() < BACK_SHARE)
    for _ in range(SEQUENCE_STEPS - back):
        k = int(rng.integers(2))
        if rng.random() < ROBOT_STEP_SHARE:
            stages.append([_robot_step(rng, scene, k, lying)])
            continue
        want = _thing_step(rng, scene, k, homes[k].name)
        if want is None or want.region.equals(lying[k]):
            return None
        lying[k] = want.region
        stages.append([want])
    stages += [[robot_back(utak)]] if back else []
    if not any(want is not None and want.subject != "utak" for stage in stages for want in stage):
        return None
    if any(one[0] == other[0] for one, other in pairwise(stages)):
        return None
    return finished(SEQUENCE_KIND, seed, "back" if back else "", scene, stages, 2)


def _thing_step(rng: np.random.Generator, scene: Scene, number: int, home: str) -> Want | None:
    """Return the want that a thing is in a corner or in the next room; None when the corner is not clear."""
    thing, parameter = scene.things[number], PARAMETERS[number]
    if scene.plan.doors and rng.random() < 0.5:
        return to_room(parameter, thing, beyond(scene.plan, home))
    return to_corner(parameter, thing, scene.plan, str(rng.choice(sorted(CORNER_DIRECTIONS))), scene.heading)


def _robot_step(rng: np.random.Generator, scene: Scene, number: int, lying: Sequence[BaseGeometry]) -> Want | None:
    """Return the want that the robot is in a corner or at a thing. lying : the regions that hold the things."""
    if rng.random() < 0.5:
        return robot_to_thing(PARAMETERS[number], lying[number])
    return robot_to_corner(scene.plan, str(rng.choice(sorted(CORNER_DIRECTIONS))), scene.heading)
