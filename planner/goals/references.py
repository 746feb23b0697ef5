"""Goals that name two things, or a thing and a place: which of the two is moved, and in which order they are met.

That x is beside y is met by moving x or y, whichever no other goal puts in a place. Where the robot shall be at a thing
and somewhere else at once, and cannot, the thing is brought there.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from functools import reduce

import numpy as np

from utak.geometry.raster.runs import mask_to_polygon
from utak.kb.language.goal_words import ROBOT, TRACK_GOALS
from utak.kb.language.terms import Fact, Symbol
from utak.kb.world.model import Node
from utak.planner.goals.near_goal import touching
from utak.planner.goals.placement import Placement, RegionEnds, to_view_frame
from utak.planner.goals.robot_goals import Destination, destination, jointly
from utak.planner.navigation.encircle import encircling_routes
from utak.planner.screen.projection import dilate, indices_to_mask
from utak.planner.situation import Situation
from utak.planner.stages import TOUCHING_GOALS, Stage

READY_GOAL = "ready"  # ready(x, G): thing x lies so that goal G of the robot can hold
MAX_SPOT_SQUARES = 9  # squares of a place of the robot beside which a thing is brought; of a larger one it is part


def is_about_two_things(goal: Fact, parameters: Iterable[str]) -> bool:
    """Return whether a goal relates its subject to a thing of the task that a parameter means."""
    return goal.name in TOUCHING_GOALS and str(goal.args[1]) in parameters


def is_moved_for_others_only(parameter: str, goals: Iterable[Fact], parameters: Iterable[str]) -> bool:
    """Return whether all goals about a thing relate it to other things, which may be moved in its place."""
    return all(is_about_two_things(goal, parameters) for goal in goals if str(goal.args[0]) == parameter)


def as_meant(stage: Stage, situation: Situation, holds: Callable[[Fact], bool], other_way: bool = False) -> Stage:
    """Return a stage with its goals in the order in which they are met, each about what is moved for it."""
    track = [goal for goal in stage.own if goal.name in TRACK_GOALS]
    ready = _ready_to_be_circled(track, situation) if track else ()
    if not track and all(map(holds, stage.carried)):
        ready = _ready_for_robot(stage.own, situation)
    parameters = situation.task.parameters
    relations = [goal for goal in (*stage.carried, *ready) if is_about_two_things(goal, parameters)]
    if not relations and not ready:
        return stage
    others = [goal for goal in (*stage.carried, *ready) if goal not in relations]
    placed = {str(goal.args[0]) for goal in others}
    placed |= {x for x in parameters if (node := situation.object_of(x)) is not None and not node.movable}
    turned = list[Fact]()
    while relations:
        goal = next((one for one in relations if len(placed & set(map(str, one.args))) == 1), relations[0])
        relations.remove(goal)
        x, y = map(str, goal.args)
        swap = (x in placed and y not in placed) != other_way
        turned.append(replace(goal, args=goal.args[::-1]) if swap else goal)
        placed |= {x, y}
    now = [goal for goal in turned if all(map(holds, _goals_of(str(goal.args[1]), others)))]
    later = tuple(goal for goal in turned if goal not in now)
    return replace(stage, goals=(*others, *now, *stage.own), later=later)


def _goals_of(parameter: str, goals: Sequence[Fact]) -> list[Fact]:
    """Return those of some goals that are about a parameter."""
    return [goal for goal in goals if str(goal.args[0]) == parameter]


def _ready_for_robot(own: Sequence[Fact], situation: Situation) -> tuple[Fact, ...]:
    """Return goals for things beside which the robot cannot be where else it shall be; () while that is not known."""
    about = [goal for goal in own if is_about_two_things(goal, situation.task.parameters)]
    fixed = {goal for goal in about if (node := situation.object_of(str(goal.args[1]))) is None or not node.movable}
    found = {goal: destination(goal, situation) for goal in own}
    if not about or len(own) < 2 or any(one.missing for one in found.values()) or _meet(found.values()):
        return ()
    places = [goal for goal in own if goal not in about]
    if not places:
        first, *rest = about
        rest = [goal for goal in rest if not {goal, first} <= fixed]
        return tuple(replace(goal, args=(goal.args[1], first.args[1])) for goal in rest)
    least = min(places, key=lambda goal: len(found[goal].squares))
    return tuple(_ready(goal, least) for goal in about if goal not in fixed and not _meet([found[goal], found[least]]))


def _ready(goal: Fact, place: Fact) -> Fact:
    """Return that the thing of a goal of the robot lies where another goal of it can hold, too."""
    return Symbol(READY_GOAL, (goal.args[1], place), goal.span)


def _meet(places: Iterable[Destination]) -> bool:
    """Return whether some square is in all destinations."""
    return bool(reduce(np.intersect1d, [place.squares for place in jointly(list(places))]).size)


def _ready_to_be_circled(track: Sequence[Fact], situation: Situation) -> tuple[Fact, ...]:
    """Return the goal that a thing is brought where a way leads round it; () where one does, or it cannot be moved."""
    goal = track[0]
    node = situation.object_of(str(goal.args[1]))
    if node is None or node.polygon is None or not node.movable:
        return ()
    if encircling_routes(situation.cost_maps, situation.track[-1:], node):
        return ()
    return (_ready(goal, goal),)


def ready_placement(goal: Fact, node: Node, situation: Situation) -> Placement:
    """Return where a thing lies so that a goal of the robot can hold: ready(x, G)."""
    inner = goal.args[1]
    assert isinstance(inner, Symbol)
    own = situation.model.mask(node.patch)
    if inner.name in TRACK_GOALS:
        free = situation.cost_maps.free(0) | own
        return Placement(RegionEnds({"free": free & ~dilate(~free, 1)}).ends())
    where = destination(inner, situation)
    if not len(where.squares):
        return Placement({}, where.missing)
    squares = indices_to_mask(where.squares, situation.model.labels.shape)
    if len(where.squares) > MAX_SPOT_SQUARES:
        return Placement(RegionEnds({"within": squares | own if (squares & own).any() else squares}).ends())
    return touching(to_view_frame(node.polygon, situation), mask_to_polygon(squares), ROBOT, stays_free=True)
