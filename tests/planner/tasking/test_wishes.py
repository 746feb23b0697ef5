"""Wishes: attained where they are cheap enough, left where they are not, and never the end of a task."""

from dataclasses import replace
from pathlib import Path

import pytest

from tests.planner.situations import known_situation
from tests.planner.tasking.test_search import SWAPPED, WALLED_IN
from utak.kb.language.goal_words import ROBOT
from utak.kb.language.reader import facts_from_text
from utak.kb.task.task import Task
from utak.planner.goals.object_goals import goal_placement
from utak.planner.goals.robot_goals import destination
from utak.planner.oracles.carry import CarryOracle
from utak.planner.situation import Situation
from utak.planner.stages import Stage, stages
from utak.planner.tasking.intention import Intention
from utak.planner.tasking.search import MadePlan, make_plan
from utak.planner.tasking.setting import WhereGoalsHold, goal_of_place, problem_of, wish_of_place


def stage_of(text: str) -> Stage:
    """Return the last stage of a task. text : as in goal.lp."""
    return stages(Task({}, (), facts_from_text(text)))[-1]


def origin(parameter: str, node: object, situation: Situation) -> tuple[float, float]:
    """Return where a thing lay at first."""
    found = situation.model.object(situation.binding[parameter])
    assert found is not None
    return found.polygon.centroid.x, found.polygon.centroid.y


WHERE = WhereGoalsHold(goal_placement, origin, destination)


def planned(rows: list[str], text: str) -> MadePlan:
    """Return the plan for a task in a drawn world, whose things g and h the task calls x and y."""
    situation = replace(known_situation(rows), binding={"x": "g", "y": "h"})
    problem = problem_of(stage_of(text), situation, WHERE)
    assert problem is not None
    return make_plan(problem, situation, CarryOracle(problem, situation))


def subjects(made: MadePlan) -> list[str]:
    """Return what the steps of a plan bring."""
    return [errand.subject for errand in made.plan.errands]


# g lies with its middle at (-6.5, 0), h at (8.5, 0) from where the robot woke.
GOAL, WISH = 'pose(x, "POINT (-6 2)", 0).', 'pose(y, "POINT (8 2)", 0)'


def test_a_wish_is_attained_up_to_its_price_and_not_beyond() -> None:
    free = planned(SWAPPED, f"{GOAL} prefer({WISH}, 1000).")
    assert sorted(subjects(free)) == ["g", "h"] and free.plan.missed == ()
    alone = planned(SWAPPED, GOAL)
    assert subjects(alone) == ["g"]
    more = free.plan.cost - alone.plan.cost
    assert planned(SWAPPED, f"{GOAL} prefer({WISH}, {more}).").plan.missed == ()
    dear = planned(SWAPPED, f"{GOAL} prefer({WISH}, {more - 1}).")
    assert subjects(dear) == ["g"] and dear.plan.missed == ("w1",) and not dear.plan.unmet


def test_a_wish_that_cannot_be_attained_leaves_the_plan_whole() -> None:
    made = planned(WALLED_IN, f'{GOAL} prefer(pose(y, "POINT (9 1)", 0), 1000).')
    assert subjects(made) == ["g"] and made.plan.missed == ("w1",) and not made.plan.unmet


def test_a_wish_against_a_goal_is_left() -> None:
    made = planned(SWAPPED, f'{GOAL} prefer(pose(x, "POINT (-6 -2)", 0), 1000).')
    assert subjects(made) == ["g"] and made.plan.missed == ("w1",) and not made.plan.unmet


def test_the_robot_goes_home_last() -> None:
    made = planned(SWAPPED, f"{GOAL} prefer(at(utak, start), 1).")
    assert subjects(made) == ["g", ROBOT]
    assert subjects(planned(SWAPPED, f"{GOAL} prefer(at(utak, start), 0).")) == ["g"]


def test_only_the_last_stage_has_wishes() -> None:
    found = stages(Task({}, (), facts_from_text(f"first({GOAL[:-1]}). prefer({WISH}, 3). then(at(utak, start)).")))
    assert [len(stage.wishes) for stage in found] == [0, 1]
    assert [str(stage) for stage in found] == ['pose(x,"POINT (-6 2)",0)', "at(utak,start)"]


def test_places_name_their_goals_and_wishes() -> None:
    stage = stage_of(f"{GOAL} prefer({WISH}, 3).")
    assert goal_of_place("g1_pose", stage) == ("g1", stage.goals[0])
    assert goal_of_place("w1_pose_2", stage) == ("w1", stage.wishes[0][0]) and goal_of_place("spot1", stage) is None
    assert wish_of_place("w1_pose", stage) == stage.wishes[0][0] and wish_of_place("g1_pose", stage) is None


def test_a_wish_that_failed_is_dropped_for_good() -> None:
    situation = replace(known_situation(SWAPPED), binding={"x": "g", "y": "h"})
    x, y = origin("x", None, situation)
    east, north = situation.model.frame.place_to_utak(x, y)
    stage, intention = stage_of(f'pose(x, "POINT ({east} {north})", 0). prefer({WISH}, 50).'), Intention(WHERE)
    intention.update(stage, situation, {}, 1.0)
    found = intention.next_errand(stage, situation)
    assert found is not None and found.goal == stage.wishes[0][0]
    intention.failed(found.errand, situation, "")
    intention.update(stage, situation, {}, 1.0)
    assert intention.next_errand(stage, situation) is None


FILLED = [  # things fill the corridor through which g must go: more ways to clear it than geometry is asked about
    "b" * 34,
    "b......." + "b" * 26,
    *["b.ggg...hhh.kkk.mmm.nnn.ooo......b"] * 2,
    "b.ggg.U.hhh.kkk.mmm.nnn.ooo......b",
    "b......." + "b" * 26,
    "b" * 34,
]


@pytest.mark.parametrize(("rows", "goal", "by_whole_squares"), [(FILLED, "g", True), (WALLED_IN, "h", False)])
def test_a_search_that_asked_too_much_is_not_made_again_with_exact_ways(
    rows: list[str], goal: str, by_whole_squares: bool
) -> None:
    situation = replace(known_situation(rows), binding={"x": goal})
    east, north = situation.model.frame.place_to_utak(*origin("x", None, situation))
    intention = Intention(WHERE)
    intention.update(stage_of(f'pose(x, "POINT ({east + 24} {north})", 0).'), situation, {}, 1.0)
    assert intention.attempt is not None
    refuted = intention.attempt.refutations
    assert refuted
    assert all(one.found.startswith("by whole squares") == by_whole_squares for one in refuted)


@pytest.mark.parametrize("weight", [0, 3])
def test_a_wish_of_which_nothing_is_known_changes_nothing(weight: int, tmp_path: Path) -> None:
    situation = replace(known_situation(SWAPPED), binding={"x": "g"})
    problem = problem_of(stage_of(f"{GOAL} prefer({WISH}, {weight})."), situation, WHERE)
    assert problem is not None and [goal.name for goal in problem.goals] == ["g1"]
