"""Goals that cannot hold at once, by the regions in which an object lies when each of them holds."""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import combinations, product
from typing import Any

import shapely

from utak.geometry.kernels.arrays import XY
from utak.geometry.manipulation.goals import At, Between, End, InCorner, Inside, Roomy, shape_at_pose
from utak.kb.language.goal_words import CORNER_NAMES
from utak.kb.language.terms import Fact
from utak.kb.task.described import BESIDE_DISTANCE
from utak.kb.world.model import Node
from utak.planner.decision import Decision, impossible, nothing_to_do
from utak.planner.goals.corner_goal import corner_may_move
from utak.planner.goals.placement import KnownEnds, Placement, to_view_frame
from utak.planner.goals.robot_goals import along, corner_side, hidden_from
from utak.planner.screen.projection import dilate
from utak.planner.situation import Situation
from utak.planner.stages import DOOR_GOALS, FIXED_GOALS, TOUCHING_GOALS, Stage, is_at_start, rests_on_waking

PlaceFunction = Callable[[Fact, Node, XY, Situation], Placement]
OriginFunction = Callable[[str, Node, Situation], XY]
REGION_ROUNDING = 1e-6  # squares, or squares of area, that rounding errors of shapely may make (convention)
CORNER_REACH = (1.0, 1.0)  # squares east and north of a corner within which the robot is at it (meaning of the goal)
CLEAR_OF_DOORS = 2  # squares between a doorway and what is in the midst of a room, at least; a convention
OPPOSITE_CORNER = dict(zip(CORNER_NAMES, reversed(CORNER_NAMES), strict=True))


def conflict(stage: Stage, situation: Situation, place: PlaceFunction, origin: OriginFunction) -> Decision:
    """Return the verdict `impossible` when two goals of a stage cannot hold for one object at once; else nothing.

    Parameters
    ----------
    stage : the goals.
    situation : what is believed.
    place : tells where a goal holds for an object that began at a point (x, y) in squares, map frame.
    origin : tells where the object of a parameter began.
    """
    for x in sorted({str(goal.args[0]) for goal in stage.carried}):
        goals = [goal for goal in stage.carried if str(goal.args[0]) == x]
        node = situation.object_of(x)
        if len(goals) < 2 or node is None or node.polygon is None:
            continue
        shape, began = to_view_frame(node.polygon, situation), origin(x, node, situation)
        lands = {str(goal): place(goal, node, began, situation) for goal in goals}
        regions = {str(goal): end.polygon for goal in goals for end in _where_task_says(goal, lands[str(goal)])}
        length = 2 * float(shapely.minimum_bounding_radius(shape))
        if far := too_far_reason(goals, situation, length, regions):
            # Only a longer thing than what is meant would reach both; none is looked for.
            return impossible(f"{stage} cannot be attained: {far}", far, unless=None)
        if any(corner_may_move(goal, situation) for goal in goals):
            continue
        kept = dict[Fact, list[Fact]]()  # by goal beside a thing: the goals of that thing
        for goal in goals:
            for own, other, end in _of_thing_beside(goal, stage, situation, place, origin):
                kept.setdefault(goal, []).append(own)
                lands[str(goal)] = beside_what_is_kept(lands[str(goal)], end, other, length)
        found = conflicting_goals(list(lands.values()), shape)
        if found is not None:
            one, other = (goals[number] for number in found)
            besides = tuple(dict.fromkeys(own for goal in (one, other) for own in kept.get(goal, ())))
            holds = f" where {' and '.join(map(str, besides))} holds" if besides else ""
            why = f"{one} and {other} cannot hold at once{holds}: their places are too far apart"
            said = {str(one), str(other)} <= regions.keys() or is_apart_from_start((one, other), began, situation)
            proof, refuses = f"no place lies in both {one} and {other}", _meant((one, other, *besides), situation)
            return impossible(why, proof, unless=None if said else "", refuses=refuses)
    return nothing_to_do("no two goals are known to contradict each other")


def _meant(goals: Sequence[Fact], situation: Situation) -> frozenset[tuple[str, str]]:
    """Return the (parameter, node) pairs on which it rests that goals cannot hold at once; none for given poses."""
    if all(goal.name in FIXED_GOALS for goal in goals):
        return frozenset()
    words = {str(term) for goal in goals for term in goal.args}
    return frozenset((x, name) for x, name in situation.binding.items() if x in words)


def _of_thing_beside(
    goal: Fact, stage: Stage, situation: Situation, place: PlaceFunction, origin: OriginFunction
) -> Iterator[tuple[Fact, Any, Placement]]:
    """Yield a goal of the thing beside which a goal asks for another one, with its outline and where that holds."""
    # None that is about a third thing.
    name = str(goal.args[1]) if goal.name in TOUCHING_GOALS else ""
    node = situation.object_of(name)
    if node is not None and node.polygon is not None:
        own = (one for one in stage.carried if str(one.args[0]) == name)
        for one in (one for one in own if one.name not in TOUCHING_GOALS or is_at_start(one)):
            there = place(one, node, origin(name, node, situation), situation)
            yield one, to_view_frame(node.polygon, situation), there


def _where_task_says(goal: Fact, land: Placement) -> list[Inside]:
    """Return the region in which an object lies where a goal holds, if the task says where, whatever is found."""
    said = land.must_reach.ends().values() if rests_on_waking(goal) else ()
    return [end for end in said if isinstance(end, Inside)]


def conflicting_goals(placements: Sequence[Placement], shape: Any) -> tuple[int, int] | None:
    """Find two of some goals that cannot hold at once for one object."""
    known = [(number, _all_ends(one)) for number, one in enumerate(placements) if one.ends and not one.missing]
    for (one, a), (other, b) in combinations(known, 2):
        if a and b and not any(_may_share(first, second, shape) for first, second in product(a, b)):
            return one, other
    return None


def _all_ends(placement: Placement) -> Sequence[End]:
    """Return ends of which an object meets one where its goal holds; () where it may hold elsewhere, too."""
    if placement.some:
        return tuple(placement.must_reach.ends().values())
    return (*placement.ends.values(), *placement.loose.values())


def beside_what_is_kept(placement: Placement, kept: Placement, kept_shape: Any, length: float) -> Placement:
    """Return a placement beside a thing that shall lie as another goal says, for what is so long, in squares."""
    # The same while it is not known where that goal holds.
    ends = () if kept.missing else _all_ends(kept)
    if not ends:
        return placement
    region = shapely.union_all([enclosing_region(end, kept_shape) for end in ends]).buffer(length + BESIDE_DISTANCE)
    return replace(placement, must_reach=KnownEnds({"beside": Inside(region)}))


def too_far_reason(
    goals: Sequence[Fact], situation: Situation, length: float = 0.0, fixed: Mapping[str, Any] | None = None
) -> str:
    """Return in words why nothing can be at a corner and elsewhere at once, whatever floor is found; "" if it may be.

    Parameters
    ----------
    goals : of one thing, of which those for a corner count: more floor puts a corner further out, never further in.
    situation : what is believed.
    length : in squares, no two points of the thing are further apart.
    fixed : by other goals in words, the region (shapely Polygon, squares, view frame) in which the thing lies then.
    """
    model, wanted = situation.model, {side for side in map(corner_side, goals) if side}
    far = {side: along(side, *model.place_to_utak(*situation.corners[side].point)) for side in wanted}
    for side, least in ((side, far[side] - sum(CORNER_REACH)) for side in sorted(wanted)):
        other = OPPOSITE_CORNER[side]
        if other in wanted and least > sum(CORNER_REACH) - far[other] + 2 * length:
            return f"the {side} and the {other} corner are too far apart to be at both at once"
        for goal, region in (fixed or {}).items():
            points = shapely.get_coordinates(region.envelope)
            if least > max(along(side, *model.place_to_utak(x, y)) for x, y in points.tolist()):
                return f"the {side} corner is too far from where {goal} holds"
    return ""


def is_apart_from_start(goals: Sequence[Fact], began: XY, situation: Situation) -> bool:
    """Return whether nothing can be where the robot woke and, as other goals ask, away from where it began itself.

    Parameters
    ----------
    goals : of one thing.
    began : (x, y) where it began, in squares, map frame.
    situation : what is believed.
    """
    # That is so where all floor about the place of waking is in sight of where the thing began, or in the midst of the
    # room in which it began.
    model, names = situation.model, {goal.name for goal in goals}
    row, column = model.view.locate(*model.frame.origin)
    if not any(map(is_at_start, goals)) or model.anew or min(row, column) < 1:
        return False
    near = (slice(row - 1, row + 2), slice(column - 1, column + 2))  # what is at the start touches it
    if not model.space[near].all():
        return False
    if "around" in names and not hidden_from(model.verge | ~model.view.seen, model, began)[near].any():
        return True
    if names.isdisjoint(DOOR_GOALS):
        return False
    own = model.view.locate(*began)
    partitions = (situation.rooms, situation.rooms_by_sure_walls)
    apart = (dilate(one.doorways, CLEAR_OF_DOORS) | (one.labels != one.labels[own]) for one in partitions)
    return not any(elsewhere[near].any() for elsewhere in apart)


def _may_share(one: End, other: End, shape: Any) -> bool:
    """Return whether the regions of two ends have enough area in common for a shape: a necessary condition only."""
    room = enclosing_region(one, shape).intersection(enclosing_region(other, shape))
    return bool(room.area >= shape.area - REGION_ROUNDING)


def enclosing_region(end: End, shape: Any) -> Any:
    """Compute a region that holds a shape wholly wherever it meets an end, at any orientation."""
    # Raises ValueError for a Roomy end, which no goal of a task has.
    if isinstance(end, Inside):
        return end.polygon.buffer(REGION_ROUNDING)
    if isinstance(end, At):
        return shape_at_pose(shape, end.pose).buffer(REGION_ROUNDING)
    if isinstance(end, Roomy):
        raise ValueError("a place on the way is no goal of a task")
    longest = 2 * shapely.minimum_bounding_radius(shape)
    if isinstance(end, Between):
        return end.about(longest + end.slack)
    return _corner_region(end, longest)


def _corner_region(end: InCorner, longest: float) -> Any:
    """Return the box (shapely Polygon) in a corner that holds any shape that meets the end."""
    reach = end.slack + end.press + longest + REGION_ROUNDING
    far_x, far_y = end.x - math.copysign(reach, end.sx), end.y - math.copysign(reach, end.sy)
    near_x, near_y = end.x + math.copysign(REGION_ROUNDING, end.sx), end.y + math.copysign(REGION_ROUNDING, end.sy)
    return shapely.box(min(far_x, near_x), min(far_y, near_y), max(far_x, near_x), max(far_y, near_y))
