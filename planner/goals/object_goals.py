"""Where something that is carried must end for a goal to hold, or what must be seen first to tell.

Goals of geometry.manipulation.plan_carrying are in the frame of the view's arrays, as all of planning on a screen is.
"""

from collections.abc import Mapping
from dataclasses import replace
from functools import partial

from geometry.manipulation.goals import End, moved
from geometry.manipulation.plan_carrying import Between, InCorner, Inside
from kb.language.terms import Fact
from kb.world.model import Node
from kb.world.rooms import Rooms
from planner.goals.corner_goal import cornered
from planner.goals.near_goal import around_start, beside, posed
from planner.goals.optimistic import BEYOND, spread
from planner.goals.placement import Mask, Placement, in_view, lands_in_one, region_of
from planner.goals.robot_goals import corner_side, doorsteps, no_next_room, numbers, out_of_sight
from planner.situation import Situation

Place = tuple[float, float]
RIM = 1.0  # squares from the edge of a region within which he is not sure that something is in it


def landing(goal: Fact, node: Node, began: Place, situation: Situation) -> Placement:
    """Where an object must end. began : the point of the lattice where its middle lay at first."""
    found = _landing(goal, node, began, situation)
    if not situation.model.view.sure:
        found = replace(found, ends={name: _well_in(end) for name, end in found.ends.items()})
    in_corner = any(isinstance(end, InCorner | Between) for end in found.ends.values())  # of which it is told already
    return replace(found, holds=found.holds or (not in_corner and _lies_in(found.ends, node, situation)))


def _well_in(end: End) -> End:
    """A region without its rim: for one who may be a little elsewhere than he believes."""
    if not isinstance(end, Inside):
        return end
    inner = Inside(end.polygon.buffer(-RIM, join_style="mitre"))
    return end if inner.polygon.is_empty else inner


def _landing(goal: Fact, node: Node, began: Place, situation: Situation) -> Placement:
    where = goal.args[1]
    if side := corner_side(goal):
        return cornered(side, node, situation)
    if goal.name == "at" and str(where) == "start":
        return around_start(node, situation)
    if goal.name in ("at", "beside"):
        return beside(str(where), node, situation)
    if goal.name in ("in", "through"):
        return _next_room(began, node, situation)
    if goal.name == "around":
        return _around_corner(began, node, situation)
    if goal.name == "pose":
        return posed(goal, node, situation)
    raise ValueError(f"not a goal for something carried: {goal}")


def _lies_in(ends: Mapping[str, End], node: Node, situation: Situation) -> bool:
    """Does an object lie where a goal holds?"""
    return lands_in_one(ends, in_view(node.polygon, situation))


def _next_room(began: Place, node: Node, situation: Situation) -> Placement:
    """Beyond a door; one that is only likely will do to begin with, for the way there shows whether it is one.

    What goes on unseen, and might make other rooms of these, is only looked at when it is there.
    """
    rooms = situation.rooms
    beyond, looks = situation.beyond(began)
    if beyond.any():
        ends = _insides(rooms, beyond)
        if looks and _lies_in(ends, node, situation):
            return Placement({}, looks[0].what, looks, there=True)
        return Placement(ends, hoped=partial(_insides, rooms, beyond, situation))
    missing, viewpoints = no_next_room(situation), doorsteps(situation)
    likely_rooms = situation.likely_beyond(began)
    likely = _insides(*likely_rooms)
    if _lies_in(likely, node, situation):
        return Placement({}, missing, viewpoints, there=True)
    return Placement(likely, missing, viewpoints, hoped=partial(_insides, *likely_rooms, situation))


def _hoped(mask: Mask, situation: Situation) -> End:
    """Inside squares of the view, or those never seen that they lead to."""
    return moved(Inside(region_of(spread(mask, situation))), -BEYOND, -BEYOND)


def _insides(rooms: Rooms, beyond: Mask, hoping: Situation | None = None) -> dict[str, End]:
    """Inside each of the rooms that have squares of a mask. hoping : then with what is hoped to be more of them."""
    parts = {f"r{n}": beyond & (rooms.labels == n) for n in numbers(rooms, beyond)}
    return {name: _hoped(part, hoping) if hoping else Inside(region_of(part)) for name, part in parts.items()}


def _around_corner(began: Place, node: Node, situation: Situation) -> Placement:
    model = situation.model
    hidden = out_of_sight(model.verge, model, began) & (model.space | model.mask(node.patch))
    if hidden.sum() < node.polygon.area:
        # Where it ends it lies on what is hidden, as far as that is seen, and on what never was.
        rest = {"hidden": hidden | ~model.view.seen} if hidden.any() else {}
        missing = "no corner is seen yet that hides a place for it"
        return Placement({}, missing, must_reach=lambda: {name: Inside(region_of(mask)) for name, mask in rest.items()})
    return Placement({"hidden": Inside(region_of(hidden))}, hoped=lambda: {"hidden": _hoped(hidden, situation)})
