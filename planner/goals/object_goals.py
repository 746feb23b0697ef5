"""The places where a carried object must end for a goal to hold, or what must be seen first to tell.

Ends (geometry.manipulation.goals) are in the view frame, in squares, as all manipulation planning is.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

from utak.geometry.kernels.arrays import XY, Bools
from utak.geometry.manipulation.goals import End, moved
from utak.geometry.manipulation.plan_carrying import Between, InCorner, Inside
from utak.kb.language.terms import Fact
from utak.kb.world.model import Node
from utak.kb.world.rooms import Rooms
from utak.planner.goals.bounds import BoundsByTheWay
from utak.planner.goals.corner_goal import corner_placement
from utak.planner.goals.near_goal import beside_placement, pose_placement, start_placement
from utak.planner.goals.optimistic import UNSEEN_MARGIN, spread_into_unseen
from utak.planner.goals.placement import Placement, RegionEnds, meets_any_end, to_view_frame
from utak.planner.goals.references import READY_GOAL, ready_placement
from utak.planner.goals.robot_goals import corner_side, door_viewpoints, hidden_from, next_room_missing, room_numbers
from utak.planner.situation import Situation
from utak.planner.stages import is_at_start

REGION_RIM = 1.0  # squares from the edge of a region in which an object may not be within it after all (convention)


@dataclass(frozen=True, eq=False)
class OptimisticEnds:
    """Deferred ends inside some squares, or inside the unseen squares that these lead to."""

    masks: Mapping[str, Bools]  # (rows, columns) bool on the arrays of the view, by the name of the end
    situation: Situation  # what is believed

    def ends(self) -> Mapping[str, End]:
        """Compute each end as if the floor went on as optimistic planning assumes; it may reach beyond the view."""
        wider = {name: spread_into_unseen(mask, self.situation) for name, mask in self.masks.items()}
        return {name: moved(end, -UNSEEN_MARGIN, -UNSEEN_MARGIN) for name, end in RegionEnds(wider).ends().items()}


def goal_placement(goal: Fact, node: Node, began: XY, situation: Situation) -> Placement:
    """Compute where a goal holds for an object."""
    found = PLACEMENTS[goal.name](goal, node, began, situation)
    if not situation.model.view.sure:
        found = replace(found, ends={name: _without_rim(end) for name, end in found.ends.items()})
    in_corner = any(isinstance(end, InCorner | Between) for end in found.ends.values())  # `holds` is exact there
    return replace(found, holds=found.holds or (not in_corner and _meets_one(found.ends, node, situation)))


def _without_rim(end: End) -> End:
    """Shrink a region by REGION_RIM squares, unless nothing would be left; return other ends unchanged."""
    if not isinstance(end, Inside):
        return end
    inner = Inside(end.polygon.buffer(-REGION_RIM, join_style="mitre"))
    return end if inner.polygon.is_empty else inner


def _at(goal: Fact, node: Node, began: XY, situation: Situation) -> Placement:
    """Return the placement at a corner, at the robot's start or at a thing."""
    if side := corner_side(goal):
        return corner_placement(side, node, situation)
    return start_placement(node, situation) if is_at_start(goal) else beside_placement(goal, node, situation)


def _meets_one(ends: Mapping[str, End], node: Node, situation: Situation) -> bool:
    """Return whether an object meets one of some ends as it is now."""
    return meets_any_end(ends, to_view_frame(node.polygon, situation))


def _next_room(goal: Fact, node: Node, began: XY, situation: Situation) -> Placement:
    """Return the placement in the rooms that are meant, for what began at a point (x, y) of the map frame."""
    rooms = situation.rooms
    beyond, viewpoints = situation.rooms_beyond(goal, began)
    if beyond.any():
        parts = _room_parts(rooms, beyond)
        ends = RegionEnds(parts).ends()
        if viewpoints and _meets_one(ends, node, situation):
            return Placement({}, viewpoints[0].what, viewpoints, there=True)
        by_the_way = BoundsByTheWay(goal, began, beyond, situation)
        return Placement(ends, hoped=OptimisticEnds(parts, situation), by_the_way=by_the_way)
    missing, viewpoints = next_room_missing(goal, situation), door_viewpoints(situation)
    parts = _room_parts(*situation.likely_rooms_beyond(goal, began))
    likely = RegionEnds(parts).ends()
    if _meets_one(likely, node, situation):
        return Placement({}, missing, viewpoints, there=True)
    return Placement(likely, missing, viewpoints, hoped=OptimisticEnds(parts, situation))


def _room_parts(rooms: Rooms, mask: Bools) -> dict[str, Bools]:
    """Return the parts of a mask that belong to each room, by the name of the room: r1, r2, ..."""
    return {f"r{n}": mask & (rooms.labels == n) for n in room_numbers(rooms, mask)}


def _around_corner(goal: Fact, node: Node, began: XY, situation: Situation) -> Placement:
    """Return the placement out of sight of `began`, a point (x, y) of the map frame, behind a corner of the verge."""
    model = situation.model
    hidden = hidden_from(model.verge, model, began) & (model.space | model.mask(node.patch))
    if hidden.sum() < node.polygon.area:
        # Wherever the object ends, it lies on squares that are hidden or were never seen.
        rest = {"hidden": hidden | ~model.view.seen} if hidden.any() else {}
        missing = "no corner is seen yet that hides a place for it"
        return Placement({}, missing, must_reach=RegionEnds(rest))
    return Placement(RegionEnds({"hidden": hidden}).ends(), hoped=OptimisticEnds({"hidden": hidden}, situation))


# By goal word: where it holds for a thing that was first believed at a point (x, y) of the map frame.
PLACEMENTS: Mapping[str, Callable[[Fact, Node, XY, Situation], Placement]] = {
    "at": _at,
    "beside": lambda goal, node, began, situation: beside_placement(goal, node, situation),
    "in": _next_room,
    "through": _next_room,
    "around": _around_corner,
    "pose": lambda goal, node, began, situation: pose_placement(goal, node, situation),
    READY_GOAL: lambda goal, node, began, situation: ready_placement(goal, node, situation),
}
