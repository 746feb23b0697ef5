"""What is said when a pursuit gives up is so, also of a robot that did not move."""

import numpy as np

from tests.planner.situations import BESIDE_A_THING, known_situation
from utak.planner.deciding.pursuit import Pursuer
from utak.planner.decision import TaskVerdict
from utak.planner.navigation.subgoals import Subgoal
from utak.planner.stages import Stage


def test_of_a_robot_that_stood_still_it_is_not_said_that_it_went_round_in_circles() -> None:
    situation = known_situation(BESIDE_A_THING)
    there = Subgoal("inspect", np.flatnonzero(situation.cost_maps.floor)[-1:], "it is not clear what is there")
    pursuer = Pursuer("skeleton")
    told = [pursuer.pursue([there], Stage(()), situation, lambda: "something is missing") for _ in range(9)]
    assert told[0].command is not None and told[-1].verdict == TaskVerdict.LIMIT
    assert "circles" not in told[-1].why and "nothing is left" not in told[-1].why
    assert "tried from the same place" in told[-1].why
