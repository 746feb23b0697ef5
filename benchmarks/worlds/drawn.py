"""Situations of drawn worlds that are known completely: what is planned in them depends on no perception."""

from collections.abc import Mapping, Sequence

import numpy as np
import shapely

from utak.geometry.manipulation.goals import End
from utak.geometry.motion.se2 import Pose
from utak.kb.mapping.occupancy import FREE, OCCUPIED, MapView
from utak.kb.mapping.patch import Patch
from utak.kb.perception.frame import Frame
from utak.kb.perception.interpretation import interpret_regions
from utak.kb.perception.regions import map_regions
from utak.kb.task.task import Task
from utak.kb.world.corners import corners
from utak.kb.world.model import Node, WorldModel
from utak.kb.world.rooms import rooms_of
from utak.planner.goals.placement import to_view_frame
from utak.planner.oracles.problem import Lying, PlacedGoal, TableState, TaskProblem
from utak.planner.screen.projection import CostMaps
from utak.planner.situation import Situation

NO_TASK = Task({}, (), ())


def drawn_situation(rows: Sequence[str]) -> Situation:
    """Return the situation of a robot that knows a drawing: `.` floor, `b` verge, `U` Utak, other letters objects.

    Parameters
    ----------
    rows : the north row first; each letter but b and U is one object, whose outline is its bounding rectangle.
    """
    marks = np.array([list(row) for row in reversed(rows)])
    occupied, seen = ~np.isin(marks, [".", "U"]), np.ones(marks.shape, np.bool_)
    south, west = (int(v) for v in np.argwhere(marks == "U")[0])
    state = np.where(occupied, OCCUPIED, FREE).astype(np.int8)
    view = MapView(-west, -south, occupied.astype(np.float32), state, seen, np.zeros(marks.shape, np.int16))
    percept, labels = map_regions(occupied, seen, seen)
    felt = [
        (f"part{number}", "b") for number in np.unique(labels[marks == "b"])
    ]  # walls that stand alone are walls, too
    nodes = []
    for letter in sorted(set(marks.ravel()) - set("b.U")):
        low, high = np.argwhere(marks == letter).min(0), np.argwhere(marks == letter).max(0) + 1
        patch = Patch(int(low[1]) - west, int(low[0]) - south, (marks == letter)[low[0] : high[0], low[1] : high[1]])
        box = shapely.box(patch.west, patch.south, patch.west + high[1] - low[1], patch.south + high[0] - low[0])
        nodes.append(Node(str(letter), "object", 100, "part1", patch, 0, polygon=box))
    model = WorldModel(Frame(), (0.5, 0.5), view, labels, percept, interpret_regions(percept, felt), tuple(nodes))
    return Situation(model, CostMaps(model), {}, rooms_of(model), corners(model), NO_TASK)


def drawn_problem(situation: Situation, ends: Mapping[str, End]) -> TaskProblem:
    """Return the problem that some things are brought to one end each.

    Parameters
    ----------
    situation : the situation; all its objects may be carried.
    ends : by the name of an object, where it shall lie, in squares, view frame.
    """
    nodes = {node.name: node for node in situation.model.objects}
    here = Pose(0.0, 0.0, 0.0)
    things = {name: Lying(to_view_frame(node.polygon, situation), here) for name, node in nodes.items()}
    goals = tuple(PlacedGoal(f"g{n}", f"pose({x})", x, False) for n, x in enumerate(ends, 1))
    places = {(goal.subject, f"{goal.name}_pose"): ends[goal.subject] for goal in goals}
    fulfils = {(goal.subject, f"{goal.name}_pose"): (goal.name,) for goal in goals}
    return TaskProblem(nodes, goals, places, fulfils, {}, TableState(things, situation.model.place_on_view))
