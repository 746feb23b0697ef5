"""Placements beside another object, at the start, and at a pose.

Ends and outlines are in squares, view frame.
"""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import shapely

from utak.geometry.kernels.arrays import XY
from utak.geometry.manipulation.goals import shape_at_pose
from utak.geometry.manipulation.plan_carrying import At, Inside
from utak.geometry.motion.se2 import Pose
from utak.geometry.raster.runs import mask_to_polygon
from utak.kb.language.terms import Fact, Number, Text
from utak.kb.language.wkt import parse_wkt
from utak.kb.task.described import BESIDE_DISTANCE
from utak.kb.world.model import Node
from utak.planner.goals.placement import ANGLE_TOLERANCE, KnownEnds, Placement, to_view_frame
from utak.planner.situation import Situation

BESIDE_AXIS_DISTANCE = 0.7  # squares in each axis: less than BESIDE_DISTANCE across a corner, too (derived)
POSE_TOLERANCE = 0.25  # squares from a pose within which it is attained (the meaning of the goal)


def start_placement(node: Node, situation: Situation) -> Placement:
    """Return where an object is at the start: within one square of the unit square around where the robot woke."""
    place = to_view_frame(shapely.Point(*situation.model.frame.origin), situation)
    return touching(to_view_frame(node.polygon, situation), place.buffer(0.5, cap_style="square"), "start")


def beside_placement(goal: Fact, node: Node, situation: Situation) -> Placement:
    """Return where an object is beside the one that a goal names: within one square of its squares."""
    other = str(goal.args[1])
    target = situation.object_of(other)
    if target is None:
        return Placement({}, situation.nothing_is(other))
    squares = mask_to_polygon(situation.model.mask(target.patch))
    found = touching(to_view_frame(node.polygon, situation), squares, target.name)
    return replace(found, must_reach=KnownEnds()) if target.movable else found  # it may be brought elsewhere


def touching(shape: Any, target: Any, name: str, stays_free: bool = False) -> Placement:
    """Return where a shape is within one square of a target; both are shapely geometries in squares, one frame."""
    # stays_free : whether the shape may not cover any of the target.
    west, south, east, north = shape.bounds
    x0, y0, x1, y1 = target.bounds
    level = ((x0 + x1) - (west + east)) / 2, ((y0 + y1) - (south + north)) / 2
    along = {"": (float(np.rint(level[0])), float(np.rint(level[1])))}
    if stays_free:  # a target beside walls leaves no room for what is longer to reach past it on both sides
        along |= {"_low": (x0 - west, y0 - south), "_high": (x1 - east, y1 - north)}
    shifts: dict[str, XY] = {}
    for where, (dx, dy) in along.items():
        shifts |= {f"east{where}": (x1 - west, dy), f"north{where}": (dx, y1 - south)}
        shifts |= {f"west{where}": (x0 - east, dy), f"south{where}": (dx, y0 - north)}
    ends = {f"{name}_{side}": At(Pose(dx, dy, 0.0)) for side, (dx, dy) in shifts.items()}
    near = target.envelope.buffer(min(east - west, north - south) + BESIDE_AXIS_DISTANCE, join_style="mitre")
    covers = stays_free and shape.intersection(target).area > 0.0
    near = near.difference(target) if stays_free else near
    far = Inside(target.buffer(math.hypot(east - west, north - south) + BESIDE_DISTANCE))
    return Placement(
        ends,
        holds=shape.distance(target) <= BESIDE_DISTANCE and not covers,
        loose={name: Inside(near)},
        must_reach=KnownEnds({name: far}),
        some=True,
    )


def pose_placement(goal: Fact, node: Node, situation: Situation) -> Placement:
    """Return where an object is at the pose of a goal: one end, "pose"."""
    place, degrees = goal.args[1:]
    assert isinstance(place, Text)
    assert isinstance(degrees, Number)
    point = parse_wkt(place.value)
    x, y = situation.model.frame.place_from_utak(point.x, point.y)
    middle = node.polygon.centroid
    left = (degrees.value - node.turned + 180.0) % 360.0 - 180.0
    holds = math.dist((x, y), (middle.x, middle.y)) <= POSE_TOLERANCE and abs(left) <= ANGLE_TOLERANCE
    there = Pose(x - middle.x, y - middle.y, left)
    outline = shape_at_pose(to_view_frame(node.polygon, situation), there)
    west, south, east, north = outline.bounds
    margin = POSE_TOLERANCE + math.hypot(east - west, north - south) * math.radians(ANGLE_TOLERANCE)
    near = Inside(outline.buffer(margin, join_style="mitre"))
    return Placement({"pose": At(there)}, holds=holds, must_reach=KnownEnds({"pose": near}), some=True)
