"""Loops are detected, and noted of the subgoals that lead in them."""

from dataclasses import replace

import numpy as np

from tests.kb.drawings import known_model
from tests.planner.screen.test_projection import HALL
from utak.kb.body import Move, Push, Release
from utak.planner.navigation.loop_guard import LoopGuard
from utak.planner.navigation.subgoals import Subgoal

MODEL = known_model(HALL)


def test_the_same_command_in_the_same_state_is_noticed() -> None:
    guard = LoopGuard()
    assert not guard.noticed(MODEL, Move(1.0, 0.0))
    assert not guard.noticed(MODEL, Move(0.0, 1.0))
    assert guard.noticed(MODEL, Move(1.0, 0.0))
    assert guard.noticed(MODEL, Move(1.0 + 4e-9, -4e-9))  # equal after rounding
    assert not guard.noticed(MODEL, Push(1.0, 0.0))
    assert not guard.noticed(MODEL, Release()) and guard.noticed(MODEL, Release())


def test_more_knowledge_or_another_place_makes_no_loop() -> None:
    guard = LoopGuard()
    guard.noticed(MODEL, Move(1.0, 0.0))
    assert not guard.noticed(replace(MODEL, place=(1.5, 0.5)), Move(1.0, 0.0))
    assert not guard.noticed(replace(MODEL, held="o1"), Move(1.0, 0.0))
    assert not guard.noticed(replace(MODEL, barred=frozenset({(3, 3)})), Move(1.0, 0.0))
    state = MODEL.view.state.copy()
    state[0, 0] = -1
    assert not guard.noticed(replace(MODEL, view=MODEL.view._replace(state=state)), Move(1.0, 0.0))


def test_a_loop_is_noted_of_its_subgoal_until_more_is_known() -> None:
    guard = LoopGuard()
    row, column = MODEL.view.locate(2.5, 0.5)
    there = Subgoal("explore", np.array([row * MODEL.labels.shape[1] + column]), "")
    other = Subgoal("explore", there.squares + 1, "")
    assert guard.told([there, other], MODEL) == [there, other]
    guard.give_up(there, MODEL)
    assert [one.in_vain for one in guard.told([there, other], MODEL)] == [True, False]
    more = replace(MODEL, barred=frozenset({(3, 3)}))
    assert guard.told([there, other], more) == [there, other]
