"""Goals for the robot itself: what is said where it stands on their squares."""

from dataclasses import replace

import numpy as np
import pytest

from tests.planner.situations import BESIDE_A_THING, all_felt, known_situation, situation_of, turn_of
from utak.kb.language.reader import facts_from_text
from utak.planner.agenda.own_goals import OwnGoals
from utak.planner.deciding.verification import robot_square
from utak.planner.decision import TaskVerdict
from utak.planner.goals.robot_goals import Destination, destination
from utak.planner.stages import Stage
from utak.planner.tasking.intention import Intention
from utak.planner.tasking.setting import WhereGoalsHold


@pytest.mark.parametrize(
    ("goal", "told"), [("at(utak, start)", False), ("circled(utak, x)", False), ("beside(utak, x)", True)]
)
def test_a_robot_that_was_lost_does_not_say_that_it_is_back(goal: str, told: bool) -> None:
    """Where it woke is squares away from where it believes that, once it was lost; what it sees is not."""
    model = all_felt(known_situation(BESIDE_A_THING).model)
    x, y = model.place
    middle = model.objects[0].polygon.centroid
    ring = [(middle.x + a * abs(x - middle.x), middle.y + b * 4) for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    track = [(x, y), *ring, (x, y)]
    for anew, verdict in ((False, TaskVerdict.DONE), (True, TaskVerdict.DONE if told else TaskVerdict.LIMIT)):
        situation = situation_of(replace(model, anew=anew, interrupted=anew), {"x": "g"})
        turn = replace(turn_of(Stage(facts_from_text(f"{goal}.")), situation), track=track)
        found = OwnGoals(destination).go(turn, Intention(WhereGoalsHold(None, None, destination)))  # type: ignore[arg-type]
        assert found.verdict == verdict, found.why
        assert ("the robot was lost since it woke" in found.why) == (verdict == TaskVerdict.LIMIT)


@pytest.mark.parametrize("goal", ["rest(utak)", "among(utak, start, x)"])
def test_each_thing_that_a_goal_names_is_made_sure_of(goal: str) -> None:
    """A goal word has one argument or several: what any of them means is looked at before the goal is said to hold."""
    model = all_felt(known_situation(BESIDE_A_THING).model)
    model = replace(model, objects=tuple(replace(node, open=1, vague=1) for node in model.objects))
    turn = turn_of(Stage(facts_from_text(f"{goal}.")), situation_of(model, {"x": "g"}))
    goals = OwnGoals(lambda _goal, situation: Destination(np.flatnonzero(robot_square(situation.model))))
    found = goals.go(turn, Intention(WhereGoalsHold(None, None, destination)))  # type: ignore[arg-type]
    assert (found.verdict == TaskVerdict.DONE) == ("x" not in goal), found.why


@pytest.mark.parametrize("settled", [False, True])
def test_where_a_thing_ends_that_touches_another_is_felt_before_the_robot_is_there(settled: bool) -> None:
    model = all_felt(
        known_situation(["bbbbbbbbb", "b.....U.b", "b..ggcc.b", "b..ggcc.b", "b.......b", "bbbbbbbbb"]).model
    )
    seam = model.mask(next(node for node in model.objects if node.name == "g").patch)
    model = replace(model, unsettled_seams=() if settled else (seam,))
    turn = turn_of(Stage(facts_from_text("beside(utak, x).")), situation_of(model, {"x": "c"}))
    found = OwnGoals(destination).go(turn, Intention(WhereGoalsHold(None, None, destination)))  # type: ignore[arg-type]
    assert (found.verdict == TaskVerdict.DONE) == settled, found.why
