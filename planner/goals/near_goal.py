"""Near to something, or right at a pose: where something that is carried must end."""

import math
from typing import Any

import numpy as np
import shapely

from geometry.manipulation.goals import placed
from geometry.manipulation.plan_carrying import At, Inside
from geometry.motion.se2 import Pose
from kb.language.terms import Fact, Number, Text
from kb.language.wkt import parse_wkt
from kb.world.model import Node
from planner.goals.placement import TURNED, Placement, in_view, region_of
from planner.situation import Situation

BESIDE = 1.0  # squares from a thing within which it is reached
NEAR = 0.7  # squares in each axis within which something surely is that near, across a corner too
POSED = 0.25  # squares within which a pose is attained


def around_start(node: Node, situation: Situation) -> Placement:
    """At the place where Utak woke: within one square of it."""
    place = in_view(shapely.Point(*situation.model.frame.origin), situation)
    return _touching(in_view(node.polygon, situation), place.buffer(0.5, cap_style="square"), "start")


def beside(other: str, node: Node, situation: Situation) -> Placement:
    """Within one square of another object, on one of its four sides."""
    target = situation.model.object(situation.binding.get(other, ""))
    if target is None:
        return Placement({}, f"nothing seen so far is {other}")
    squares = region_of(situation.model.mask(target.patch))
    return _touching(in_view(node.polygon, situation), squares, target.name)


def _touching(shape: Any, target: Any, name: str) -> Placement:
    """Within one square of a target: best with the containing rectangles against each other, on one of four sides.

    Where it cannot be brought to any of these, anywhere near will do; further than by its own length it is nowhere so.
    """
    west, south, east, north = shape.bounds
    x0, y0, x1, y1 = target.bounds
    level = ((x0 + x1) - (west + east)) / 2, ((y0 + y1) - (south + north)) / 2
    level = (float(np.rint(level[0])), float(np.rint(level[1])))
    shifts = {"east": (x1 - west, level[1]), "north": (level[0], y1 - south)}
    shifts |= {"west": (x0 - east, level[1]), "south": (level[0], y0 - north)}
    ends = {f"{name}_{side}": At(Pose(dx, dy, 0.0)) for side, (dx, dy) in shifts.items()}
    about = target.envelope.buffer(min(east - west, north - south) + NEAR, join_style="mitre")
    far = Inside(target.buffer(math.hypot(east - west, north - south) + BESIDE))
    return Placement(
        ends,
        holds=shape.distance(target) <= BESIDE,
        loose={name: Inside(about)},
        must_reach=lambda: {name: far},
        some=True,
    )


def posed(goal: Fact, node: Node, situation: Situation) -> Placement:
    """The middle at a point of Utak's frame, turned by so many degrees from how it lay at first."""
    place, degrees = goal.args[1:]
    assert isinstance(place, Text)
    assert isinstance(degrees, Number)
    point = parse_wkt(place.value)
    x, y = situation.model.frame.place_from_utak(point.x, point.y)
    middle = node.polygon.centroid
    left = (degrees.value - node.turned + 180.0) % 360.0 - 180.0
    holds = math.dist((x, y), (middle.x, middle.y)) <= POSED and abs(left) <= TURNED
    there = Pose(x - middle.x, y - middle.y, left)
    lying = placed(in_view(node.polygon, situation), there)
    west, south, east, north = lying.bounds
    about = lying.buffer(POSED + math.hypot(east - west, north - south) * math.radians(TURNED), join_style="mitre")
    return Placement({"pose": At(there)}, holds=holds, must_reach=lambda: {"pose": Inside(about)}, some=True)
