"""The robot pursues what the task plan means, keeps to it, and gives no verdict before all that is meant was tried."""

from dataclasses import replace

import pytest

from tests.planner.situations import all_felt, known_situation
from tests.planner.tasking.test_meanings import ACROSS, ACROSS_GOALS, IN_POCKET, POCKET_GOAL, pose
from utak.geometry.manipulation.goals import At
from utak.geometry.motion.se2 import Pose
from utak.kb.body import Move
from utak.kb.task.task import task_from_texts
from utak.kb.tracing.decisions import SolverCall, record_decisions
from utak.kb.world.model import WorldModel
from utak.planner.advice import Act, Go
from utak.planner.agenda.decider import Decider
from utak.planner.carrying.plan_executor import PlanExecutor
from utak.planner.decision import Decision, TaskVerdict


def decided(decider: Decider, model: WorldModel) -> tuple[Decision, list[SolverCall]]:
    """Return the decision in a model, and the reconciliations that led to it."""
    with record_decisions() as record:
        decision = decider.decide(model, [model.place])
    return decision, [call for call in record if call.encoding == "reconciliation"]


def test_what_the_plan_means_is_bound_and_stays_bound_as_the_robot_walks() -> None:
    model = all_felt(known_situation(IN_POCKET).model)
    decider = Decider(task_from_texts("object(x).", POCKET_GOAL))
    decision, calls = decided(decider, model)
    assert decider.bound == {"x": "h"} and isinstance(decision.command, Move)
    assert [call.answer[0] for call in calls if call.answer] == ["as_well(x,h)", "as_well(x,g)"]
    assert "planned(x,h)" in calls[-1].facts
    nearer = replace(model, place=(model.place[0] + 2.0, model.place[1]))  # the other one is still nearer
    decided(decider, nearer)
    assert decider.bound == {"x": "h"}


def test_two_parameters_change_what_they_mean_together() -> None:
    decider = Decider(task_from_texts("object(x). object(y).", ACROSS_GOALS))
    decided(decider, all_felt(known_situation(ACROSS).model))
    assert decider.bound == {"x": "h", "y": "g"} and decider.plan is not None


def test_claims_tell_things_apart_so_that_nothing_is_chosen() -> None:
    model = known_situation(ACROSS).model
    colours = {"g": "r", "h": "w"}
    objects = tuple(replace(node, colour=colours[node.name]) for node in model.objects)
    task = task_from_texts("object(x). colour(x, r). object(y). colour(y, w).", ACROSS_GOALS)
    decider = Decider(task)
    _, calls = decided(decider, all_felt(replace(model, objects=objects)))
    assert decider.bound == {"x": "g", "y": "h"}
    assert not any(atom.startswith("as_well") for call in calls for atom in call.answer or ())


def test_all_that_may_be_meant_is_tried_before_a_verdict() -> None:
    at_two_places = f"{pose('x', 28, 13, IN_POCKET)} {pose('x', 28, 3, IN_POCKET)}"
    decider = Decider(task_from_texts("object(x).", at_two_places))
    decision, calls = decided(decider, all_felt(known_situation(IN_POCKET).model))
    assert decision.command is None and decision.verdict in (TaskVerdict.IMPOSSIBLE, TaskVerdict.POSSIBLE_IF)
    given_up = [fact for fact in calls[-1].facts if fact.startswith("given_up")]
    bound = decider.bound["x"]
    assert len(given_up) == 1 and bound not in given_up[0]
    assert f"x may be {'h' if bound == 'g' else 'g'} as well, and that was no better" in decision.why


@pytest.mark.parametrize("second", ["there", "elsewhere"])
def test_a_plan_under_way_for_another_thing_is_dropped_when_this_one_is_meant(second: str) -> None:
    """The end of the plan may be meant for both, or for the other thing alone."""
    situation, executor = known_situation(ACROSS), PlanExecutor()
    one, other = situation.model.objects
    for node, end in ((one, "there"), (other, second)):
        advice = executor.advise(node, {end: At(Pose(0.0, -1.0, 0.0))}, situation)
        assert isinstance(advice, Act | Go) and advice.why.startswith(node.name)
