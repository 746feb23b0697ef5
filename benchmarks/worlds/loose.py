"""Loose worlds: the snug ones to carry in, with things that lie between the squares, turned, or with an arm thinner.

What such a change leaves can be done as before: a thing is moved by less than a square, turned where it stands clear of
all else, and of an L the one arm is made thinner, which passes wherever the whole passed.
"""

from dataclasses import replace
from functools import partial

import numpy as np
from shapely import Polygon, box
from shapely.affinity import rotate, translate

from benchmarks.worlds.carrying import CARRYING_SNUG
from benchmarks.worlds.furniture import rounded
from benchmarks.worlds.scenes import Maker, PlacedThing, RandomScenario

BETWEEN = 0.7  # of all things lie between the squares
TURNED = 0.25  # of what is carried is turned by any angle
UNEVEN = 0.4  # of all Ls have arms of two widths
CLEAR = 1.0  # squares from a thing to all else, and to Utak's square


def loosened(rng: np.random.Generator, seed: int, unable: bool, maker: Maker) -> RandomScenario | None:
    """A world of another maker with its things moved by parts of squares, turned or thinned; None where none fits."""
    made = maker(rng, seed, unable)
    if made is None:
        return None
    things: list[PlacedThing] = []
    for number, thing in enumerate(made.things):
        polygon = thing.polygon
        if number == 0:
            if thing.shape == "l_shape" and not unable and rng.random() < UNEVEN:
                polygon = thinned(rng, polygon)
            if made.task != 5 and rng.random() < TURNED:
                polygon = rotate(polygon, float(rng.uniform(0, 360)), origin="center")
        if rng.random() < BETWEEN:
            polygon = translate(polygon, *(float(part) for part in rng.uniform(-0.5, 0.5, 2)))
        things.append(replace(thing, polygon=rounded(polygon)))
    return replace(made, things=tuple(things)) if clear(made, things) else None


def thinned(rng: np.random.Generator, ell: Polygon) -> Polygon:
    """An L on whole squares with one of its arms a square thinner, on the inside."""
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
    """Whether all things stand apart from the walls, each other and Utak."""
    x, y = int(world.utak.x), int(world.utak.y)
    square = box(x, y, x + 1, y + 1)
    solid = [world.plan.verge, square]
    for thing in things:
        if any(thing.polygon.distance(other) < CLEAR for other in solid):
            return False
        solid.append(thing.polygon)
    return True


LOOSE: dict[int, Maker] = {task: partial(loosened, maker=maker) for task, maker in CARRYING_SNUG.items()}
