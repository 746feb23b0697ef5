"""Loose worlds: snug worlds for carrying, with objects off the grid, rotated, or with one thinner arm.

These changes leave every possible task possible. An object is moved by less than a square, or rotated where it stands
clear of all else. One arm of an L is made thinner, which passes wherever the whole L passed.
"""

from dataclasses import replace
from functools import partial

import numpy as np
from shapely import Polygon, box
from shapely.affinity import rotate, translate

from benchmarks.worlds.carrying import CARRYING_SNUG
from benchmarks.worlds.furniture import rounded
from benchmarks.worlds.scenes import Maker, PlacedThing, RandomScenario

OFF_GRID_SHARE = 0.7  # of all things lie between the squares
ROTATED_SHARE = 0.25  # of what is carried is turned by any angle
UNEVEN_SHARE = 0.4  # of all Ls have arms of two widths
MIN_LOOSE_GAP = 1.0  # squares from a thing to all else, and to Utak's square


def loosened(rng: np.random.Generator, seed: int, unable: bool, maker: Maker) -> RandomScenario | None:
    """Return a world of another maker with its objects moved, rotated or thinned; None where none fits."""
    made = maker(rng, seed, unable)
    if made is None:
        return None
    things: list[PlacedThing] = []
    for number, thing in enumerate(made.things):
        polygon = thing.polygon
        if number == 0:
            if thing.shape == "l_shape" and not unable and rng.random() < UNEVEN_SHARE:
                polygon = thinned(rng, polygon)
            if made.task != 5 and rng.random() < ROTATED_SHARE:
                polygon = rotate(polygon, float(rng.uniform(0, 360)), origin="center")
        if rng.random() < OFF_GRID_SHARE:
            polygon = translate(polygon, *(float(part) for part in rng.uniform(-0.5, 0.5, 2)))
        things.append(replace(thing, polygon=rounded(polygon)))
    return replace(made, things=tuple(things)) if clear(made, things) else None


def thinned(rng: np.random.Generator, ell: Polygon) -> Polygon:
    """Return an L on whole squares with one of its arms a square thinner, on the inside."""
    bounds = ell.envelope
    notch = bounds.difference(ell)
    west, south, east, north = notch.bounds
    ways = [(1, 0), (-1, 0), (0, 1), (0, -1)]
    inner = [(dx, dy) for dx, dy in ways if bounds.covers(translate(notch, dx, dy))]
    dx, dy = inner[int(rng.integers(len(inner)))]
    grown = box(min(west, west + dx), min(south, south + dy), max(east, east + dx), max(north, north + dy))
    left = ell.difference(grown)
    assert isinstance(left, Polygon)
    return left.simplify(0)


def clear(world: RandomScenario, things: list[PlacedThing]) -> bool:
    """Return whether all objects stand apart from the walls, each other and the robot."""
    x, y = int(world.utak.x), int(world.utak.y)
    square = box(x, y, x + 1, y + 1)
    solid = [world.plan.verge, square]
    for thing in things:
        if any(thing.polygon.distance(other) < MIN_LOOSE_GAP for other in solid):
            return False
        solid.append(thing.polygon)
    return True


LOOSE_MAKERS: dict[int, Maker] = {task: partial(loosened, maker=maker) for task, maker in CARRYING_SNUG.items()}
