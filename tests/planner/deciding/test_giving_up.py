"""Who is at a loss with what looks contradicted gives up what he believes, and begins anew."""

from collections.abc import Mapping
from dataclasses import replace
from typing import cast

import shapely

from kb.body import Command, Impression, Move, Release
from kb.objects.held_object import HeldObject
from kb.world.corners import Corner
from kb.world.model import WorldModel
from kb.world.rooms import rooms_of
from planner.cycle import Options, Robot
from planner.deciding.decider import Decider
from planner.decision import Decision
from tests.planner.test_cycle import EMPTY, SQUARE, DrawnBody


class Handed(DrawnBody):
    """The same, with hands that may let go of what nobody sees."""

    def act(self, command: Command) -> Impression:
        return super().act(Move(0.0, 0.0) if isinstance(command, Release) else command)


class Undecided:
    """Is at a loss whenever he is asked, and counts that."""

    bound: Mapping[str, str] = {}
    corners: Mapping[str, Corner] = {}

    def __init__(self) -> None:
        self.asked: list[bool] = []  # for each time, whether he had begun anew

    def decide(self, model: WorldModel, _track: object) -> Decision:
        self.asked.append(model.anew)
        self.rooms = rooms_of(model)
        return Decision(None, "nobody knows", "limit")


def at_a_loss(slipped: bool) -> tuple[Robot, Undecided]:
    """One who looks once more and then is at a loss; if he slipped before with a thing in hand."""
    robot, undecided = Robot(Handed(EMPTY), SQUARE, Options()), Undecided()
    robot.wake()
    robot.decision, robot.finished = Decision(Move(0.0, 0.0), "he looks"), False
    robot.decider = cast(Decider, undecided)
    robot.knowledge.tracker.state = replace(robot.knowledge.memory, slipped=slipped)
    if slipped:
        thing = shapely.box(4, 2, 8, 4)
        robot.knowledge.tracker.grasp(HeldObject("o1", thing, thing))
    robot.step()
    return robot, undecided


def test_who_is_at_a_loss_begins_anew_once_if_looks_contradicted_what_he_believes() -> None:
    robot, undecided = at_a_loss(slipped=True)
    assert not robot.finished and isinstance(robot.decision.command, Release)
    assert "o1 is let go, to begin anew; nobody knows" in robot.decision.why
    report = robot.step()
    assert report.belief["pose"] == "anew"
    assert undecided.asked == [False, True]
    assert robot.model.anew and not robot.model.shaken and not robot.model.object("o1")
    assert robot.finished and robot.verdict.verdict == "limit"
    robot.knowledge.tracker.state = replace(robot.knowledge.memory, slipped=True)
    robot.decision, robot.finished = Decision(Move(0.0, 0.0), "he looks"), False
    robot.step()
    assert robot.finished and undecided.asked == [False, True, True]


def test_who_is_at_a_loss_and_believes_nothing_that_was_contradicted_has_no_reason_to_begin_anew() -> None:
    robot, undecided = at_a_loss(slipped=False)
    assert robot.finished and robot.verdict.verdict == "limit" and undecided.asked == [False]
