"""Keeping: whether the constraints on the way were kept, by the believed tracks of the robot and of the things.

What was moved is remembered in the robot's own frame. The robot's commands are given in it, so its own track there does
not depend on where the map believes it to have woken.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import shapely

from utak.geometry.kernels.arrays import XY
from utak.geometry.raster.runs import mask_to_polygon
from utak.kb.body import Command, Move, Push
from utak.kb.language.goal_words import ROBOT
from utak.kb.language.terms import Fact
from utak.kb.task.task import Task
from utak.kb.world.model import Node, WorldModel
from utak.planner.constraints import SAME_PLACE, avoidances, in_robot_frame, region_of, swept_region
from utak.planner.decision import Decision, TaskVerdict, impossible, nothing_to_do
from utak.planner.situation import Situation

OUTLINE_DOUBT = 0.25  # squares by which a measured outline may lie elsewhere, as for poses (planner.goals.near_goal)
SHAKEN_DOUBT = 0.5  # squares by which the robot may be elsewhere after impressions contradicted each other: half a one


@dataclass(frozen=True)
class ThingTrack:
    """The track of a thing, in squares, robot frame."""

    outline: Any  # its newest outline, a shapely Polygon
    turned: float  # by how many degrees it was turned until then
    robot: XY  # where the robot stood then
    swept: Any = None  # what it has covered since it was first moved; None while it was not
    middles: tuple[XY, ...] = ()  # where its middle was, oldest first


@dataclass
class ConstraintKeeper:
    """Remembers where things were, and tells whether the constraints on the way were kept."""

    task: Task  # whose constraints are meant
    renamed: dict[str, str] = field(default_factory=dict)  # of things that were moved: the next name, by the one before
    _tracks: dict[str, ThingTrack] = field(default_factory=dict)

    def note(self, model: WorldModel) -> None:
        """Remember where all things are believed to be now; what lies where a thing was that has gone is that thing."""
        gone = sorted(name for name, track in self._tracks.items() if track.swept and model.object(name) is None)
        for node in (one for one in model.objects if one.polygon is not None):
            if node.name not in self._tracks:
                outline = in_robot_frame(node.polygon, model.frame)
                if before := next((name for name in gone if _lie_alike(self._tracks[name].outline, outline)), None):
                    gone.remove(before)
                    self.renamed[before], self._tracks[node.name] = node.name, self._tracks.pop(before)
            self._tracks[node.name] = _continued(self._tracks.get(node.name), node, model)

    def middles(self, model: WorldModel) -> dict[str, tuple[XY, ...]]:
        """Return where the middle of each thing has been, by its name: points (x, y) in squares, map frame."""
        return {
            name: tuple(model.frame.place_from_utak(*middle) for middle in track.middles)
            for name, track in self._tracks.items()
        }

    def broken_at_start(self, situation: Situation) -> Decision:
        """Return the verdict that a region was touched from the beginning; nothing when no such thing is known."""
        model = situation.model
        for name, fact in avoidances(self.task):
            region = region_of(fact)
            if name == ROBOT and region.intersects(shapely.Point(0.0, 0.0)):
                why = f"{fact} cannot hold: the robot wakes in that region"
                return impossible(why, "the robot wakes in that region", unless=None)
            node = situation.object_of(name)
            if node is None or node.polygon is None or node.moved or node.vague or not model.view.sure:
                continue
            surely = in_robot_frame(node.polygon, model.frame).buffer(-_doubt(model, region) - 1.0)
            if not surely.is_empty and surely.intersects(region):
                lies = f"{node.name} lies in that region"
                return impossible(f"{fact} cannot hold: {lies}", lies)
        return nothing_to_do("no constraint is known to be broken from the beginning")

    def guarded(self, decision: Decision, situation: Situation) -> Decision:
        """Return a decision; the verdict `limit` instead of a command that surely leads into a forbidden region."""
        for name, fact in avoidances(self.task):
            way = _way_of(decision.command, name, situation)
            if way is not None and way.intersects(region_of(fact)):
                why = f"{fact} would be broken by the next command; {decision.why}"
                return Decision(None, why, TaskVerdict.LIMIT)
        return decision

    def doubt_of_done(self, situation: Situation) -> str:
        """Return why the constraints may not have been kept, in words; "" when they surely were, as is believed."""
        return next(self._doubts(situation), "")

    def _doubts(self, situation: Situation) -> Iterator[str]:
        """Yield a reason for each constraint of which it cannot be told that it was kept."""
        for name, fact in avoidances(self.task):
            doubt = _robot_doubt(fact, situation) if name == ROBOT else self._thing_doubt(fact, name, situation)
            if doubt:
                yield doubt
        for fact, actors in situation.kept_from_doors:
            if not situation.avoided(fact):
                who = " and ".join("the robot" if actor == ROBOT else actor for actor in actors) or "some thing"
                yield f"it cannot be told whether {fact} holds: {who} went through every door that is sure"

    def _thing_doubt(self, fact: Fact, name: str, situation: Situation) -> str:
        """Return why the thing of avoid(x, "WKT") may have touched the region; "" when it surely did not."""
        model, region = situation.model, region_of(fact)
        node = situation.object_of(name)
        if node is None:
            return f"it cannot be told whether {fact} holds: {situation.nothing_is(name)}"
        if model.anew and node.moved:
            return f"it cannot be told whether {fact} holds: the robot was lost"
        track = self._tracks.get(node.name)
        if track is None:
            covered = mask_to_polygon(model.mask(node.patch))
            moved = shapely.transform(covered, lambda points: points + np.array([model.view.west, model.view.south]))
            covered = in_robot_frame(moved, model.frame)
        else:
            covered = track.outline if track.swept is None else track.swept
        if covered.intersects(region):
            return f"{fact} does not hold: {node.name} touched that region"
        if covered.distance(region) <= _doubt(model, region):
            return f"it cannot be told whether {fact} holds: {node.name} came close to that region"
        return ""


def _continued(known: ThingTrack | None, node: Node, model: WorldModel) -> ThingTrack:
    """Return what is remembered of a thing after an impression."""
    outline = in_robot_frame(node.polygon, model.frame)
    robot = model.frame.place_to_utak(*model.place)
    middle = outline.centroid.x, outline.centroid.y
    if known is None or not (node.moved or known.swept):
        return ThingTrack(outline, node.turned, robot, None, (middle,))
    if outline.equals_exact(known.outline, SAME_PLACE):
        return known
    step = swept_region(known.outline, outline, node.turned - known.turned, known.robot)
    swept = step if known.swept is None else shapely.union_all([known.swept, step])
    return ThingTrack(outline, node.turned, robot, swept, (*known.middles, middle))


def _lie_alike(one: Any, other: Any) -> bool:
    """Return whether two outlines share more than half of the smaller one."""
    return bool(2 * one.intersection(other).area > min(one.area, other.area))


def _doubt(model: WorldModel, region: Any) -> float:
    """Return by how many squares a thing may be elsewhere than believed, near a region of the robot frame."""
    west, south, east, north = model.leeway
    woke = math.hypot(max(-west, east), max(-south, north))
    far = region.hausdorff_distance(shapely.Point(0.0, 0.0))
    return OUTLINE_DOUBT + woke + model.spread * float(far) + SHAKEN_DOUBT * model.shaken


def _robot_doubt(fact: Fact, situation: Situation) -> str:
    """Return why the robot may have touched the region of avoid(utak, "WKT"); "" when it surely did not."""
    model, region = situation.model, region_of(fact)
    if model.interrupted:
        return f"it cannot be told whether {fact} holds: the robot was lost"
    track = _line([model.frame.place_to_utak(x, y) for x, y in situation.track])
    if track.intersects(region):
        return f"{fact} does not hold: the robot touched that region"
    if track.distance(region) <= SHAKEN_DOUBT * model.shaken:
        return f"it cannot be told whether {fact} holds: the robot came close to that region"
    return ""


def _way_of(command: Command | None, name: str, situation: Situation) -> Any:
    """Return what the robot or the object of a parameter would touch by a command; None for nothing, robot frame."""
    model = situation.model
    if not isinstance(command, Move | Push):
        return None
    x, y = model.frame.place_to_utak(*model.place)
    if name == ROBOT:
        return _line([(x, y), (x + command.east, y + command.north)])
    held = model.object(model.held or "")
    if held is None or held.polygon is None or situation.binding.get(name) != held.name:
        return None
    before = in_robot_frame(held.polygon, model.frame)
    after = shapely.transform(before, lambda points: points + np.array([command.east, command.north]))
    return swept_region(before, after, 0.0, (x, y))


def _line(points: Sequence[XY]) -> Any:
    """Return the line through points (x, y), or the point itself when all are one."""
    line = shapely.LineString([points[0], *points])
    return line if line.length else shapely.Point(points[0])
