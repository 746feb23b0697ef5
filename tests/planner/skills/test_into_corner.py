"""The robot comes near to the walls of a corner, wherever in their squares these lie."""

import math
from dataclasses import replace

import pytest

from tests.kb.drawings import known_model
from tests.planner.goals.test_object_goals import facts_from_text
from tests.planner.situations import situation_of
from utak.kb.body import Grasp, Move
from utak.planner.decision import Decision
from utak.planner.situation import Situation
from utak.planner.skills.into_corner import (
    HALT_DISTANCE,
    PRESS_LENGTH,
    IntoCorner,
    halt_beside_walls,
    halting_place,
    lies_straight,
)
from utak.planner.stages import Stage

STRAIGHT_ROOM = ["bbbbbbbb", "b......b", "b......b", "b......b", "b.U....b", "b......b", "bbbbbbbb"]
ASKEW_ROOM = ["bbbbbbbb", "bbb.bbbb", "bb...bbb", "bb....bb", "b.U....b", "b......b", "bbbbbbbb"]
NORTHEAST = Stage(facts_from_text("at(utak, corner(northeast))."))
SOUTHWEST = Stage(facts_from_text("at(utak, corner(southwest))."))


def standing(rows: list[str], x: float, y: float) -> Situation:
    """Return a situation in a drawn room, with the robot so far from where it woke, in squares."""
    model = replace(known_model(rows), place=(0.5 + x, 0.5 + y))
    return situation_of(model)


def test_a_move_into_the_square_of_a_corner_ends_beside_its_outer_lines() -> None:
    situation = standing(STRAIGHT_ROOM, 0.0, 0.0)
    x, y = halting_place(situation.corners["northeast"], situation)
    assert (x, y) == pytest.approx((5.0 - HALT_DISTANCE, 4.0 - HALT_DISTANCE))
    command = beside_walls(Move(4.0, 3.0), NORTHEAST, situation)
    assert isinstance(command, Move) and (command.east, command.north) == pytest.approx((x - 0.5, y - 0.5))
    assert halting_place(situation.corners["southwest"], situation) == pytest.approx(
        (-1.0 + HALT_DISTANCE, -1.0 + HALT_DISTANCE)
    )


def beside_walls(command: Move | Grasp | None, stage: Stage, situation: Situation) -> object:
    """Return the command that is given in place of one."""
    return halt_beside_walls(Decision(command, ""), stage, situation).command


@pytest.mark.parametrize("command", [Move(3.0, 3.0), Grasp("east"), None])
def test_other_commands_are_kept(command: Move | Grasp | None) -> None:
    assert beside_walls(command, NORTHEAST, standing(STRAIGHT_ROOM, 0.0, 0.0)) == command


def test_a_move_for_another_goal_is_kept() -> None:
    stage = Stage(facts_from_text("at(utak, start)."))
    assert beside_walls(Move(4.0, 3.0), stage, standing(STRAIGHT_ROOM, 0.0, 0.0)) == Move(4.0, 3.0)


def test_from_the_middle_of_the_square_the_robot_goes_up_to_the_lines_once() -> None:
    leading, situation = IntoCorner(), standing(STRAIGHT_ROOM, 4.0, 3.0)
    command = leading.next(NORTHEAST, situation).command
    assert isinstance(command, Move) and (command.east, command.north) == pytest.approx(
        (0.5 - HALT_DISTANCE, 0.5 - HALT_DISTANCE)
    )
    assert not leading.next(NORTHEAST, situation)
    assert not IntoCorner().next(NORTHEAST, standing(STRAIGHT_ROOM, 4.5 - HALT_DISTANCE, 3.5 - HALT_DISTANCE))


def test_walls_along_the_grid_are_told_from_others() -> None:
    straight, askew = standing(STRAIGHT_ROOM, 0.0, 0.0), standing(ASKEW_ROOM, 0.0, 0.0)
    assert all(lies_straight(corner, straight) for corner in straight.corners.values())
    assert not lies_straight(askew.corners["northeast"], askew)
    assert lies_straight(askew.corners["southwest"], askew) == lies_straight(askew.corners["southeast"], askew)


def test_the_robot_presses_against_askew_walls_once_from_each_square() -> None:
    situation = standing(ASKEW_ROOM, 0.0, 0.0)
    column, row = situation.corners["northeast"].square
    place = halting_place(situation.corners["northeast"], situation)
    there = replace(situation, model=replace(situation.model, place=place))
    leading = IntoCorner()
    assert not leading.is_pressing(NORTHEAST, there)
    moves = [leading.next(NORTHEAST, there).command for _ in range(4)]
    assert [(m.east, m.north) for m in moves if isinstance(m, Move)] == [
        (PRESS_LENGTH, PRESS_LENGTH),
        (PRESS_LENGTH, 0.0),
        (0.0, PRESS_LENGTH),
    ]
    assert moves[3] is None and leading.is_pressing(NORTHEAST, there)
    further = replace(situation, model=replace(situation.model, place=(place[0], place[1] + 1.0)))
    assert leading.is_pressing(NORTHEAST, further) and leading.next(NORTHEAST, further)
    assert not leading.is_pressing(SOUTHWEST, there)
    away = replace(situation, model=replace(situation.model, place=(place[0] - 3.0, place[1])))
    assert not leading.is_pressing(NORTHEAST, away)
    assert (column, row) == situation.corners["northeast"].square


def test_while_the_frame_is_open_the_robot_does_not_halt_beside_lines() -> None:
    situation = standing(STRAIGHT_ROOM, 4.0, 3.0)
    unsure = replace(situation, model=replace(situation.model, likely_spread=math.pi))
    assert not IntoCorner().next(NORTHEAST, unsure)
    assert beside_walls(Move(4.0, 3.0), NORTHEAST, unsure) == Move(4.0, 3.0)
