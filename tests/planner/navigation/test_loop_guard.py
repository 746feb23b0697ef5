"""One who goes in circles notices it, and goes elsewhere."""

from dataclasses import replace

import numpy as np

from kb.body import Move, Push, Release
from planner.navigation.loop_guard import LOOP_COST, LoopGuard
from planner.navigation.subgoals import Subgoal
from tests.kb.drawings import seen_whole
from tests.planner.screen.test_projection import HALL

MODEL = seen_whole(HALL)


def test_the_same_command_in_the_same_state_is_noticed() -> None:
    circles = LoopGuard()
    assert not circles.noticed(MODEL, Move(1.0, 0.0))
    assert not circles.noticed(MODEL, Move(0.0, 1.0))
    assert circles.noticed(MODEL, Move(1.0, 0.0))
    assert circles.noticed(MODEL, Move(1.0 + 4e-9, -4e-9))  # but for the rounding of the place
    assert not circles.noticed(MODEL, Push(1.0, 0.0))
    assert not circles.noticed(MODEL, Release()) and circles.noticed(MODEL, Release())


def test_who_knows_more_or_is_elsewhere_does_not_go_in_circles() -> None:
    circles = LoopGuard()
    circles.noticed(MODEL, Move(1.0, 0.0))
    assert not circles.noticed(replace(MODEL, place=(1.5, 0.5)), Move(1.0, 0.0))
    assert not circles.noticed(replace(MODEL, held="o1"), Move(1.0, 0.0))
    assert not circles.noticed(replace(MODEL, barred=frozenset({(3, 3)})), Move(1.0, 0.0))
    state = MODEL.view.state.copy()
    state[0, 0] = -1
    assert not circles.noticed(replace(MODEL, view=MODEL.view._replace(state=state)), Move(1.0, 0.0))


def test_an_aim_in_vain_gets_dearer_and_is_given_up() -> None:
    circles = LoopGuard()
    row, column = MODEL.view.locate(2.5, 0.5)
    there = Subgoal("explore", np.array([row * MODEL.labels.shape[1] + column]), "")
    other = Subgoal("explore", there.squares + 1, "")
    assert circles.priced([there, other], MODEL) == [there, other]
    circles.tire(frozenset({(2, 0)}))
    dearer, same = circles.priced([there, other], MODEL)
    assert (dearer.price, same.price) == (LOOP_COST, 0.0)
    for _ in range(9):
        circles.tire(frozenset({(2, 0), (900, 900)}))
    assert circles.priced([there, other], MODEL) == [other]
