"""The problem of a stage: its goals with the places where they hold, and the things that may be carried."""

import re
from collections.abc import Callable

import numpy as np

from geometry.kernels.arrays import XY
from geometry.manipulation.goals import End
from geometry.motion.se2 import Pose
from kb.language.terms import Fact
from kb.objects.held_object import is_grid_aligned
from kb.world.model import Node
from planner.goals.placement import CERTAIN_OBJECT, Placement, meets_any_end, to_view_frame
from planner.goals.robot_goals import Destination, robot_stands_on
from planner.oracles.problem import ROBOT, Lying, PlacedGoal, TableState, TaskProblem
from planner.situation import Situation
from planner.stages import TRACK_GOALS, Stage

PlaceFunction = Callable[[Fact, Node, XY, Situation], Placement]
OriginFunction = Callable[[str, Node, Situation], XY]
DestinationFunction = Callable[[Fact, Situation], Destination]


def problem_of(
    stage: Stage, situation: Situation, place: PlaceFunction, origin: OriginFunction, where: DestinationFunction
) -> TaskProblem | None:
    """Return the problem of a stage; None while it is open what a goal means or where it holds.

    None, too, while a thing that is askew is in hand: it is set down first.

    Parameters
    ----------
    stage : of the task: the goals that shall hold now.
    situation : what is believed: world model, rooms, doors, corners and track.
    place : returns where a goal holds for an object, from the goal, the object, where its middle was at first (map
        frame) and the situation.
    origin : returns where the object of a parameter lay at first, from the parameter, the object and the situation.
    where : returns the squares on which a goal holds for the robot, from the goal and the situation.
    """
    model = situation.model
    held = model.object(model.held or "")
    if held is not None and held.polygon is not None and not is_grid_aligned(held.polygon):
        return None  # amid a turn: a plan is made for things as they are set down
    things = {node.name: node for node in model.objects if _can_be_carried(node)}
    state = TableState(
        {name: Lying(to_view_frame(node.polygon, situation), Pose(0.0, 0.0, 0.0)) for name, node in things.items()},
        model.place_on_view,
        model.held,
    )
    goals: list[PlacedGoal] = []
    places: dict[tuple[str, str], End] = {}
    fulfils: dict[tuple[str, str], tuple[str, ...]] = {}
    for number, goal in enumerate(stage.carried, 1):
        node = things.get(situation.binding.get(str(goal.args[0]), ""))
        if node is None:
            return None
        land = place(goal, node, origin(str(goal.args[0]), node, situation), situation)
        ends = {**land.ends, **land.loose}
        outline = state.things[node.name].outline
        holds = land.holds or meets_any_end(land.loose, outline)
        if not holds and (not ends or land.missing):
            return None
        goals.append(PlacedGoal(f"g{number}", str(goal), node.name, holds))
        for name, end in ends.items():
            places[node.name, place_name(f"g{number}", name)] = end
            fulfils[node.name, place_name(f"g{number}", name)] = (f"g{number}",)
    stands = {}
    own = [goal for goal in stage.own if goal.name not in TRACK_GOALS]
    found = [where(goal, situation) for goal in own]
    if own and not any(one.missing for one in found):
        squares = found[0].squares
        for one in found[1:]:
            squares = np.intersect1d(squares, one.squares)
        if len(squares):
            name = f"g{len(goals) + 1}"
            words = " and ".join(map(str, own))
            goals.append(PlacedGoal(name, words, ROBOT, robot_stands_on(squares, model)))
            stands[place_name(name, "there")] = squares
            fulfils[ROBOT, place_name(name, "there")] = (name,)
    return TaskProblem(things, tuple(goals), places, fulfils, stands, state)


def _can_be_carried(node: Node) -> bool:
    """Return whether an object may be carried in a plan: its outline is known, and nothing shows that it is fixed."""
    return node.polygon is not None and node.movable > 0 and node.confidence >= CERTAIN_OBJECT


def place_name(goal: str, end: str) -> str:
    """Return the name of a place of a goal, as the encoding can write it."""
    return f"{goal}_{re.sub('[^a-z0-9_]', '_', end.lower())}"
