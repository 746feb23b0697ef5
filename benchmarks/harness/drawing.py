"""A world drawn in letters, one character a square, north above."""

from collections.abc import Mapping

import numpy as np
from shapely import Polygon
from shapely.geometry.base import BaseGeometry

from benchmarks.worlds.placing import digital
from benchmarks.worlds.scenes import RandomScenario

ARROWS = "^<v>"  # north, west, south, east


def drawing(
    scenario: RandomScenario,
    utak: tuple[float, float] | None = None,
    objects: Mapping[str, Polygon] | None = None,
    marks: Mapping[str, BaseGeometry] | None = None,
) -> str:
    """Return the table as lines of text.

    Parameters
    ----------
    scenario : the world.
    utak : where the robot is, if not where it began; drawn as an arrow near to its heading.
    objects : polygons of objects by name, if not those of the scenario.
    marks : regions to be drawn with a character of their own on free squares.
    """
    plan, moved = scenario.plan, objects or {}
    picture = np.full((plan.height, plan.width), ".")
    for mark, region in (marks or {}).items():
        picture[digital(region, plan.width, plan.height)] = mark
    picture[digital(plan.verge, plan.width, plan.height)] = "b"
    for thing in scenario.things:
        squares = digital(moved.get(thing.name, thing.polygon), plan.width, plan.height)
        picture[squares] = thing.colour.upper() if thing.fixed else thing.colour
    x, y = utak or (scenario.utak.x, scenario.utak.y)
    picture[int(y), int(x)] = ARROWS[round(scenario.heading / 90) % 4]
    return "\n".join("".join(row) for row in picture[::-1]) + "\n"
