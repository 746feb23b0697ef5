"""The problem of a stage: its goals with the places where they hold, and the things that may be carried."""

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from utak.geometry.kernels.arrays import XY
from utak.geometry.manipulation.goals import End
from utak.geometry.motion.se2 import Pose
from utak.kb.language.goal_words import ROBOT, TRACK_GOALS
from utak.kb.language.terms import Fact
from utak.kb.objects.held_object import is_grid_aligned
from utak.kb.reasoning.user_rules import rules_reach
from utak.kb.world.model import Node
from utak.kb.world.rooms import NO_ROOM
from utak.planner.goals.joint import OriginFunction, PlaceFunction
from utak.planner.goals.placement import Placement, meets_any_end, to_view_frame
from utak.planner.goals.robot_goals import Destination, jointly, robot_stands_on
from utak.planner.oracles.problem import HERE, Lying, PlacedGoal, TableState, TaskProblem
from utak.planner.situation import Situation
from utak.planner.stages import Stage
from utak.planner.tasking.history import DoneErrands

NOTHING_DONE = DoneErrands()  # of a run in which nothing was done
RULED_ENCODING = "task"  # the encoding of task plans, without `.lp`
DestinationFunction = Callable[[Fact, Situation], Destination]


class WhereGoalsHold(NamedTuple):
    """The functions that tell where goals hold."""

    # Returns where a goal holds for an object, from the goal, the object, where its middle was at first (map frame) and
    # the situation
    place: PlaceFunction
    # Returns where the object of a parameter lay at first, from the parameter, the object and the situation
    origin: OriginFunction
    # Returns the squares on which a goal holds for the robot, from the goal and the situation
    destination: DestinationFunction

    def of(self, goal: Fact, node: Node, situation: Situation) -> Placement:
        """Return where a goal holds for an object that its parameter means."""
        return self.place(goal, node, self.origin(str(goal.args[0]), node, situation), situation)


def problem_of(
    stage: Stage, situation: Situation, where: WhereGoalsHold, history: DoneErrands = NOTHING_DONE
) -> TaskProblem | None:
    """Return the problem of a stage; None while a thing that is askew is in hand: it is set down first."""
    model = situation.model
    held = model.object(model.held or "")
    if held is not None and held.polygon is not None and not is_grid_aligned(held.polygon):
        return None  # amid a turn: a plan is made for things as they are set down
    things = {node.name: node for node in model.objects if _can_be_carried(node)}
    ruled = rules_reach(RULED_ENCODING, situation.rules)
    put, unmoved = history.places(situation) if ruled else {}, Pose(0.0, 0.0, 0.0)
    lying = {x: Lying(to_view_frame(node.polygon, situation), unmoved, put.get(x, HERE)) for x, node in things.items()}
    state = TableState(lying, model.place_on_view, model.held)
    goals: list[PlacedGoal] = []
    places: dict[tuple[str, str], End] = {}
    fulfils: dict[tuple[str, str], tuple[str, ...]] = {}
    open_goals: list[str] = []
    waiting: list[str] = []
    as_it_lies = where._replace(origin=_where_it_lies)
    unlike: set[tuple[str, str]] = set()  # parameters with objects for which it is open where a goal holds
    for name, goal, weight in _numbered(stage):
        node = things.get(situation.binding.get(str(goal.args[0]), ""))
        ends, is_open, holds = (
            ({}, True, False) if node is None else _ends(where.of(goal, node, situation), node, state)
        )
        is_open = is_open and not holds
        if node is None or not (holds or ends) or (weight is None and is_open and not ruled):
            if weight is None:  # else it is a wish of which nothing is known yet
                subject = "" if node is None else node.name
                goals.append(waiting_goal(name, goal, subject))
                waiting.append(name)
            continue
        open_goals += [name] * (is_open and weight is None)
        goals.append(PlacedGoal(name, str(goal), node.name, holds, weight, str(goal.args[0])))
        for other in _also_meant(goal, things, situation):
            other_ends, other_open, other_holds = _ends(as_it_lies.of(goal, other, situation), other, state)
            if (other_open and not other_holds) or not (other_ends or other_holds):
                unlike.add((str(goal.args[0]), other.name))
                continue
            here = other.name, state.things[other.name].place
            fulfils |= {here: (*fulfils.get(here, ()), name)} if other_holds else {}
            for end_name, end in other_ends.items():
                places[other.name, place_name(name, end_name)] = end
                fulfils[other.name, place_name(name, end_name)] = (name,)
        for end_name, end in ends.items():
            places[node.name, place_name(name, end_name)] = end
            fulfils[node.name, place_name(name, end_name)] = (name,)
    stands: dict[str, Any] = {}
    own = [goal for goal in stage.own if goal.name not in TRACK_GOALS]
    squares = _common_squares(own, situation, where.destination) if own else None
    own_name = f"g{len(stage.carried) + 1}"
    if squares is not None and len(squares):
        goals.append(PlacedGoal(own_name, " and ".join(map(str, own)), ROBOT, robot_stands_on(squares, model)))
        parts = _by_room(squares, situation)
        stands |= {place_name(own_name, room): part for room, part in parts.items()}
        fulfils |= {(ROBOT, place_name(own_name, room)): (own_name,) for room in parts}
    for name, goal, weight in _numbered_wishes(stage):
        wished = _common_squares([*own, goal], situation, where.destination) if str(goal.args[0]) == ROBOT else None
        if wished is not None and len(wished):
            goals.append(PlacedGoal(name, str(goal), ROBOT, robot_stands_on(wished, model), weight))
            parts, names = _by_room(wished, situation), (name, own_name) if own else (name,)
            stands |= {place_name(name, room): part for room, part in parts.items()}
            fulfils |= {(ROBOT, place_name(name, room)): names for room in parts}
    meanings = _meanings(things, unlike, situation)
    is_open, placed = bool(open_goals), _goals_before_wishes(goals)
    return TaskProblem(things, placed, places, fulfils, stands, state, is_open, meanings, tuple(waiting))


def waiting_goal(name: str, goal: Fact, subject: str = "") -> PlacedGoal:
    """Return a goal of which it is open what it is about or where it holds."""
    return PlacedGoal(name, str(goal), subject, False, None, str(goal.args[0]))


def _also_meant(goal: Fact, things: Mapping[str, Node], situation: Situation) -> list[Node]:
    """Return the things that the parameter of a goal may mean besides the one that it is bound to."""
    parameter, held = str(goal.args[0]), situation.model.held
    if held is not None and situation.binding.get(parameter) == held:
        return []
    return [things[name] for name in situation.as_well.get(parameter, ()) if name in things]


def _meanings(
    things: Mapping[str, Node], unlike: set[tuple[str, str]], situation: Situation
) -> Mapping[str, tuple[str, ...]]:
    """Return the objects that each parameter may mean where that are several, the one that it is bound to first."""
    model = situation.model
    found: dict[str, tuple[str, ...]] = {}
    for parameter, bound in sorted(situation.binding.items()):
        if model.object(bound) is not None:
            others = () if model.held == bound else situation.as_well.get(parameter, ())
            also = [name for name in others if name in things and (parameter, name) not in unlike]
            found |= {parameter: (bound, *also)} if also else {}
    return found


def _where_it_lies(_parameter: str, node: Node, _situation: Situation) -> XY:
    """Return where a thing that was not moved lay at first: where it lies, the middle (x, y) in squares, map frame."""
    return float(node.polygon.centroid.x), float(node.polygon.centroid.y)


def _numbered(stage: Stage) -> Iterator[tuple[str, Fact, int | None]]:
    """Yield the goals and wishes of a stage for objects: name, goal, and the weight of a wish or None."""
    yield from ((f"g{number}", goal, None) for number, goal in enumerate(stage.carried, 1))
    yield from (one for one in _numbered_wishes(stage) if str(one[1].args[0]) != ROBOT)


def _numbered_wishes(stage: Stage) -> Iterator[tuple[str, Fact, int]]:
    """Yield the wishes of a stage: name, goal and weight."""
    yield from ((f"w{number}", goal, weight) for number, (goal, weight) in enumerate(stage.wishes, 1))


def goal_of_place(place: str, stage: Stage) -> tuple[str, Fact] | None:
    """Return the goal or wish for an object that a place belongs to, with its name; None for a spot aside."""
    return next(((name, goal) for name, goal, _ in _numbered(stage) if place.startswith(f"{name}_")), None)


def wish_of_place(place: str, stage: Stage) -> Fact | None:
    """Return the wish that a place belongs to; None when it is the place of a goal, or a spot."""
    return next((goal for name, goal, _ in _numbered_wishes(stage) if place.startswith(f"{name}_")), None)


def _goals_before_wishes(goals: list[PlacedGoal]) -> tuple[PlacedGoal, ...]:
    """Return goals in order, those that must hold first."""
    return tuple(sorted(goals, key=lambda goal: goal.weight is not None))


def _ends(land: Placement, node: Node, state: TableState) -> tuple[Mapping[str, End], bool, bool]:
    """Return the ends of a goal for an object, whether it is open where exactly these are, and whether it holds."""
    ends = {**land.ends, **land.loose}
    holds = land.holds or meets_any_end(land.loose, state.things[node.name].outline)
    return ends, bool(land.missing), holds


def _by_room(squares: Any, situation: Situation) -> dict[str, Any]:
    """Return the parts of some squares (flat indices) in each room, by its name; "there" for those in none."""
    numbers = situation.rooms.labels.ravel()[squares]
    return {f"r{n}" if n != NO_ROOM else "there": squares[numbers == n] for n in np.unique(numbers)}


def _common_squares(goals: Sequence[Fact], situation: Situation, where: DestinationFunction) -> Any:
    """Return the squares on which all of some goals hold for the robot, flat indices; None while that is open."""
    found = jointly([where(goal, situation) for goal in goals])
    if any(one.missing for one in found):
        return None
    squares = found[0].squares
    for one in found[1:]:
        squares = np.intersect1d(squares, one.squares)
    return squares


def _can_be_carried(node: Node) -> bool:
    """Return whether an object may be carried in a plan: its outline is known, and nothing shows that it is fixed."""
    return node.polygon is not None and node.movable > 0 and not node.felt_first


def place_name(goal: str, end: str) -> str:
    """Return the name of a place of a goal, as the encoding can write it."""
    return f"{goal}_{re.sub('[^a-z0-9_]', '_', end.lower())}"
