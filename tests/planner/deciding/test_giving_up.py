"""A robot that finds nothing to do, and whose beliefs were contradicted, forgets them and begins anew."""

from collections.abc import Mapping
from dataclasses import replace
from typing import cast

import shapely

from tests.planner.test_cycle import EMPTY, SQUARE, DrawnBody
from utak.kb.body import Command, Impression, Move, Release
from utak.kb.objects.held_object import HeldObject
from utak.kb.task.task import Task
from utak.kb.world.corners import Corner
from utak.kb.world.model import WorldModel
from utak.kb.world.rooms import rooms_of
from utak.planner.agenda.decider import Decider
from utak.planner.cycle import Options, Robot
from utak.planner.decision import Decision, TaskVerdict
from utak.planner.tasking.task_plan import Errand, TaskPlan


class Handed(DrawnBody):
    """The same body, with a hand that may release what is not drawn."""

    def act(self, command: Command) -> Impression:
        return super().act(Move(0.0, 0.0) if isinstance(command, Release) else command)


class Undecided:
    """A decider that looks once, and then gives up whenever it is asked.

    Attributes
    ----------
    asked : for each time after the first, whether the robot had begun anew.
    """

    task = Task({}, (), ())
    bound: Mapping[str, str] = {}
    corners: Mapping[str, Corner] = {}
    attempt = None
    alternatives: tuple[str, ...] = ()
    plan = TaskPlan((Errand("pursue", "robot"),))

    def __init__(self) -> None:
        self.asked: list[bool] = []
        self._has_looked = False

    def decide(self, model: WorldModel, _track: object) -> Decision:
        self.rooms = rooms_of(model)
        if not self._has_looked:
            self._has_looked = True
            return Decision(Move(0.0, 0.0), "the robot looks")
        self.asked.append(model.anew)
        return Decision(None, "nothing is known", TaskVerdict.LIMIT)


def at_a_loss(slipped: bool) -> tuple[Robot, Undecided]:
    """Return a robot that looked once and then gave up, and its decider. slipped : with an object held before."""
    undecided = Undecided()
    robot = Robot(Handed(EMPTY), SQUARE, Options(), cast(Decider, undecided))
    robot.wake()
    robot.knowledge.tracker.state = replace(robot.knowledge.memory, slipped=slipped)
    if slipped:
        thing = shapely.box(4, 2, 8, 4)
        robot.knowledge.tracker.grasp(HeldObject("o1", thing, thing))
    robot.step()
    return robot, undecided


def test_a_robot_that_gives_up_with_contradicted_beliefs_begins_anew_once() -> None:
    robot, undecided = at_a_loss(slipped=True)
    assert not robot.finished and isinstance(robot.decision.command, Release)
    assert "o1 is released, because the robot forgets its map and begins anew; nothing is known" in robot.decision.why
    report = robot.step()
    assert report.belief["pose"] == "anew"
    assert undecided.asked == [False, True]
    assert robot.model.anew and not robot.model.shaken and not robot.model.object("o1")
    assert robot.finished and robot.verdict.verdict == "limit"
    robot.knowledge.tracker.state = replace(robot.knowledge.memory, slipped=True)
    robot.decision, robot.finished = Decision(Move(0.0, 0.0), "the robot looks"), False
    robot.step()
    assert robot.finished and undecided.asked == [False, True, True]


def test_a_robot_that_gives_up_with_beliefs_in_agreement_does_not_begin_anew() -> None:
    robot, undecided = at_a_loss(slipped=False)
    assert robot.finished and robot.verdict.verdict == "limit" and undecided.asked == [False]
