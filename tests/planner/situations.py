"""Situations, rooms and robots for the tests of the planner."""

from collections.abc import Mapping
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import shapely

from tests.kb.drawings import known_model
from utak.geometry.kernels.arrays import Bools
from utak.kb.body import Body
from utak.kb.mapping.patch import Patch
from utak.kb.task.binding import Reconciliation
from utak.kb.task.task import Task
from utak.kb.world.corners import corners
from utak.kb.world.model import Node, WorldModel
from utak.kb.world.rooms import rooms_of
from utak.planner.agenda.decider import Decider
from utak.planner.carrying.plan_executor import PlanExecutor
from utak.planner.carrying.remaining_plan import PlanOperations
from utak.planner.cycle import Options, Robot
from utak.planner.deciding.pursuit import Pursuer
from utak.planner.deciding.stage_turn import StageTurn
from utak.planner.deciding.verification import Verifier
from utak.planner.question import Question
from utak.planner.screen.projection import CostMaps
from utak.planner.sights.walls import unfelt_walls
from utak.planner.situation import Situation
from utak.planner.stages import Stage
from utak.simulator.run.session import RobotMaker
from utak.simulator.run.warming import warm
from utak.simulator.scenario.settings import Settings

NOTHING_DOUBTFUL = Reconciliation({}, (), (), ())

NO_TASK = Task({}, (), ())
BESIDE_A_THING = [  # a room, and Utak right beside the only object in it
    "b" * 20,
    *["b" + "." * 18 + "b"] * 6,
    "b....ggg" + "." * 11 + "b",
    "b...Uggg" + "." * 11 + "b",
    "b....ggg" + "." * 11 + "b",
    *["b" + "." * 18 + "b"] * 6,
    "b" * 20,
]


def situation_of(model: WorldModel, bound: Mapping[str, str] | None = None, task: Task = NO_TASK) -> Situation:
    """Return the situation of a world model, with its rooms and corners. bound : what the task's parameters mean."""
    situation = Situation(model, CostMaps(model), bound or {}, rooms_of(model), corners(model), task)
    held = () if model.held is None else (f"holds({model.held})",)  # as the agenda tells it
    return replace(situation, question=Question(facts=held))


def known_situation(rows: list[str], moved: bool = False, movable: int = 50, held: str | None = None) -> Situation:
    """Return the situation of a robot that has seen a drawing, `?` left out; each letter but b is an object."""
    marks, model = np.array([list(row) for row in reversed(rows)]), known_model(rows, objects=False)
    nodes = []
    for letter in sorted(set(marks.ravel()) - set("b.U?")):
        south, west = np.argwhere(marks == letter).min(0)
        north, east = np.argwhere(marks == letter).max(0) + 1
        mask = marks[south:north, west:east] == letter
        patch = Patch(int(west) + model.view.west, int(south) + model.view.south, mask)
        box = shapely.box(patch.west, patch.south, patch.west + mask.shape[1], patch.south + mask.shape[0])
        nodes.append(
            Node(letter, "object", 95, "part1", patch, 0, polygon=box, moved=moved, whole=moved, movable=movable)
        )
    return situation_of(replace(model, objects=tuple(nodes), held=held))


def all_felt(model: WorldModel) -> WorldModel:
    """Return a world model in which every wall that can be felt was felt to be wall, and every object all round."""
    felt: dict[tuple[int, int], str] = {}
    for node in model.objects:
        felt |= dict.fromkeys(_squares(model.mask(node.patch), model), node.colour or "g")
    walls = dict.fromkeys(_squares(unfelt_walls(model), model), "b")
    return replace(model, felt={**felt, **walls, **model.felt})


def _squares(mask: Bools, model: WorldModel) -> list[tuple[int, int]]:
    """Return the squares (x, y) of a mask on the arrays of the view, map frame."""
    rows, columns = np.nonzero(mask)
    return list(zip((columns + model.view.west).tolist(), (rows + model.view.south).tolist(), strict=True))


class Tools(NamedTuple):
    """The tools of decisions, as planner.deciding.stage_turn.StageTurn has them."""

    executor: PlanExecutor
    pursuer: Pursuer
    verifier: Verifier


def tools_with(executor: PlanExecutor | None = None) -> Tools:
    """Return the tools of one decision, new ones where none are given."""
    return Tools(executor or PlanExecutor(), Pursuer("skeleton"), Verifier())


def turn_of(
    stage: Stage, situation: Situation, tools: Tools | None = None, reconciled: Reconciliation = NOTHING_DOUBTFUL
) -> StageTurn:
    """Return what a decision is worked out with. tools : new ones if None."""
    return StageTurn(stage, situation, reconciled, (), *(tools or tools_with()))


def watched_robot(operations: PlanOperations) -> RobotMaker:
    """Return a maker of robots whose plan executor uses some functions on remaining plans."""

    def make(body: Body, task: Task, settings: Settings) -> Robot:
        warm(carrying=True, paths=settings.paths)
        decider = Decider(task, settings.paths, (), settings.pull)
        decider.executor = PlanExecutor(settings.pull, operations=operations)
        return Robot(body, task, Options(settings.paths, (), settings.max_steps, settings.pull), decider)

    return make
