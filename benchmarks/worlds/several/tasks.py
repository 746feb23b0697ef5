"""Tasks about several things: what is wanted in which stage, the files that say so, and whether the truth meets it."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from shapely import Point, Polygon, box, union_all
from shapely.affinity import rotate, translate
from shapely.geometry.base import BaseGeometry

from benchmarks.worlds.floorplans import FloorPlan
from benchmarks.worlds.scenes import PlacedThing, TaskTexts, wkt, world_text
from benchmarks.worlds.walking import corner_box, furthest_corner
from utak.kb.language.goal_words import ROBOT

PARAMETERS = "xyzw"  # of the first, second, ... thing of a task
TRUTH_TOLERANCE = 1e-3  # squares; the same as for expect.lp
# Squares by which a region of expect.lp is larger than what the goal says: a robot that misses it was wrong.
CORNER_SLACK = 1.25  # about the containing rectangle of what lies in a corner; the goal allows 1
POSE_SLACK = 0.5  # about what lies at a pose; the goal allows a quarter of a square and a small rotation
AT_SLACK = 2.1  # about what the robot is to be at; the goal allows 1 from the squares that it covers
START_SLACK = 2.0  # about where the robot woke; the goal allows 1
ROBOT_CORNER_SIDE = 1.5  # of the box in a corner where the robot is to be; the goal allows 1


@dataclass(frozen=True)
class Want:
    """One thing that a task wants.

    Attributes
    ----------
    subject : the name of the thing in the world, or "utak".
    goal : the fact of goal.lp, without full stop.
    region : the region that holds all of the subject when it is so, squares, table frame.
    move : (dx, dy, degrees) from where the thing lay at first, about its centroid; None unless it is to lie at a pose.
    """

    subject: str
    goal: str
    region: BaseGeometry
    move: tuple[float, float, float] | None = None

    @property
    def fact(self) -> str:
        """The fact of expect.lp that it is so at the end."""
        return f'inside({self.subject}, "{wkt(self.region)}").\n'

    def holds(self, shapes: Mapping[str, Any]) -> bool:
        """Return whether it is so when the things and the robot lie as `shapes` say, by name, squares, table frame."""
        return bool(self.region.buffer(TRUTH_TOLERANCE).covers(shapes[self.subject]))


@dataclass(frozen=True)
class SeveralWorld:
    """A world with a task about several things.

    Attributes
    ----------
    kind, seed : what it is made from. variant : what it is within its kind.
    things : those of the task first, in the order of PARAMETERS, then others.
    utak : the place where the robot wakes, squares, table frame.
    heading : the direction that it faces, degrees counter-clockwise from table north.
    claims : the text of start.lp.
    stages : what is wanted, one stage after the other; what one stage wants holds at once when it ends.
    """

    kind: str
    seed: int
    variant: str
    plan: FloorPlan
    things: tuple[PlacedThing, ...]
    utak: Point
    heading: int
    claims: str
    stages: tuple[tuple[Want, ...], ...]

    @property
    def name(self) -> str:
        """The name of its folder."""
        return f"{self.kind}-{self.seed:04d}"

    @property
    def world(self) -> str:
        """The text of world.lp."""
        return world_text(self.plan, self.utak, self.heading, self.things)

    @property
    def texts(self) -> TaskTexts:
        """The texts of start.lp, goal.lp and expect.lp."""
        return TaskTexts(self.claims, goal_text(self.stages), "".join(want.fact for want in self.stages[-1]))


def goal_text(stages: Sequence[Sequence[Want]]) -> str:
    """Return goal.lp: goals that hold together, or steps when there is more than one stage (of one want each)."""
    if len(stages) == 1:
        return "".join(f"{want.goal}.\n" for want in stages[0])
    words = ["first", *["then"] * (len(stages) - 1)]
    return "".join(f"{word}({want.goal}).\n" for word, stage in zip(words, stages, strict=True) for want in stage)


def stages_reached(stages: Sequence[Sequence[Want]], track: Sequence[Mapping[str, Any]]) -> int:
    """Return how many stages were reached one after the other; the last one counts only when it holds at the end.

    track : how the things lay and where the robot was (a point) at each step, by name, squares, table frame.
    """
    reached = 0
    for step in track:
        while reached < len(stages) - 1 and all(want.holds(step) for want in stages[reached]):
            reached += 1
    last = reached == len(stages) - 1 and all(want.holds(track[-1]) for want in stages[-1])
    return reached + last


def claims_of(things: Sequence[PlacedThing], by_colour: bool) -> str:
    """Return start.lp for the things of a task: their shapes, and their colours when these tell them apart."""
    lines = []
    for parameter, thing in zip(PARAMETERS, things, strict=False):
        colour = f" colour({parameter}, {thing.colour})." if by_colour else ""
        lines.append(f"object({parameter}). shape({parameter}, {thing.shape}).{colour}\n")
    return "".join(lines)


def to_room(parameter: str, thing: PlacedThing, rooms: BaseGeometry) -> Want:
    """Return the want that a thing is in the next room. rooms : those that share a door with the one where it is."""
    return Want(thing.name, f"in({parameter}, room(next))", rooms)


def to_corner(parameter: str, thing: PlacedThing, plan: FloorPlan, compass: str, heading: int) -> Want | None:
    """Return the want that a thing is in a corner of the robot's frame; None when two corners are nearly as far out."""
    corner = furthest_corner(plan.floor, compass, heading)
    if corner is None:
        return None
    west, south, east, north = thing.polygon.bounds
    sides = (east - west + CORNER_SLACK, north - south + CORNER_SLACK)
    x, y, inward_x, inward_y = corner
    boxes = [Point(x, y).union(Point(x + a * inward_x, y + b * inward_y)).envelope for a, b in (sides, sides[::-1])]
    return Want(thing.name, f"at({parameter}, corner({compass}))", union_all(boxes).simplify(0))


def to_pose(parameter: str, thing: PlacedThing, move: tuple[float, float, float], utak: Point, heading: int) -> Want:
    """Return the want that a thing lies moved by (dx, dy) and turned by degrees about its centroid, from its start."""
    dx, dy, degrees = move
    lying = moved_polygon(thing.polygon, move)
    c, s = math.cos(math.radians(-heading)), math.sin(math.radians(-heading))
    x, y = lying.centroid.x - utak.x, lying.centroid.y - utak.y
    place = wkt(Point(round(x * c - y * s, 4) + 0.0, round(x * s + y * c, 4) + 0.0))
    region = lying.buffer(POSE_SLACK, join_style="mitre")
    return Want(thing.name, f'pose({parameter}, "{place}", {degrees:g})', region, (dx, dy, degrees))


def moved_polygon(polygon: Polygon, move: tuple[float, float, float]) -> Polygon:
    """Return a polygon turned about its centroid, then moved. move : (dx, dy) in squares, and degrees."""
    dx, dy, degrees = move
    return translate(rotate(polygon, degrees, origin=polygon.centroid), dx, dy)


def robot_to_corner(plan: FloorPlan, compass: str, heading: int) -> Want | None:
    """Return the want that the robot is at a corner of its frame; None when two corners are nearly as far out."""
    corner = furthest_corner(plan.floor, compass, heading)
    return corner and Want(ROBOT, f"at(utak, corner({compass}))", corner_box(corner, ROBOT_CORNER_SIDE))


def robot_to_thing(parameter: str, lying: BaseGeometry) -> Want:
    """Return the want that the robot is at a thing. lying : the region that holds the thing at that time."""
    return Want(ROBOT, f"at(utak, {parameter})", lying.buffer(AT_SLACK, join_style="mitre"))


def robot_back(utak: Point) -> Want:
    """Return the want that the robot is where it woke."""
    return Want(ROBOT, "at(utak, start)", box(*utak.buffer(START_SLACK).bounds))
