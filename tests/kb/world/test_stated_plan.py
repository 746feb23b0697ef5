"""The task plan as facts, and read back: nothing is lost, and damaged facts are refused."""

import re

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from utak.kb.language.diagnostics import BadInputError
from utak.kb.language.goal_words import ROBOT
from utak.kb.language.vocabulary import PLAN_PREDICATES, SETTLING_STEPS
from utak.kb.world.stated_plan import StatedPlan, stated_plan
from utak.planner.oracles.carry import Certainty
from utak.planner.oracles.problem import HERE, PlacedGoal
from utak.planner.tasking.task_plan import Errand, RefutedStep, TaskPlan

GOALS = (
    PlacedGoal("g1", "in(x,room(next))", "o1", False),
    PlacedGoal("g2", 'pose(y,"POINT (8.0 14.0)",0)', "o2", False),
    PlacedGoal("g3", "at(utak,start) and in(utak,r)", ROBOT, False),
)
DOORS = st.lists(st.sampled_from(["d1", "d2", "d10"]), max_size=2, unique=True).map(lambda doors: tuple(sorted(doors)))
PLACES = st.sampled_from(["g1_r2", "g1_r2_3", "g2_pose", "spot1", "spot12"])
OBJECTS = st.sampled_from(["o1", "o2", "o11"])


@st.composite
def errands(draw: st.DrawFn) -> Errand:
    """Return a step of a plan, as the search makes it."""
    if draw(st.integers(0, 3)) == 0:
        return Errand(
            draw(st.sampled_from(sorted(SETTLING_STEPS))), draw(st.sampled_from(["g1", "g3", "all", "robot"]))
        )
    certainty = draw(st.sampled_from([None, Certainty.SURE, Certainty.HOPED]))
    commands = 0 if certainty is None else draw(st.integers(1, 99))
    if draw(st.booleans()):
        return Errand("arrive", ROBOT, "g3_there", draw(DOORS), certainty, commands)
    place = draw(PLACES)
    return Errand(
        "clear" if place.startswith("spot") else "carry", draw(OBJECTS), place, draw(DOORS), certainty, commands
    )


@st.composite
def refutations(draw: st.DrawFn) -> RefutedStep:
    """Return a refutation, as the search makes it."""
    subject = draw(OBJECTS)
    others = draw(st.dictionaries(OBJECTS, st.one_of(st.just(HERE), PLACES), max_size=2))
    others.pop(subject, None)
    stood = draw(st.sampled_from([None, "start", "o2"]))
    place = draw(PLACES)
    return RefutedStep(subject, HERE, place, tuple(sorted(others.items())), stood, draw(DOORS))


PLANS = st.builds(
    TaskPlan,
    st.lists(errands(), max_size=12).map(tuple),
    unmet=st.sampled_from([(), ("g2",), ("g1", "g3")]),
    cost=st.integers(0, 500),
    least=st.integers(0, 500),
    proved=st.booleans(),
    refutations=st.lists(refutations(), max_size=12).map(tuple),
    rounds=st.just(1),
    goals=st.just(GOALS),
)


@settings(max_examples=30)
@given(PLANS, st.randoms())
def test_a_plan_comes_back_from_its_facts_in_any_order(plan: TaskPlan, chance: object) -> None:
    facts = [f"{fact}." for fact in plan.facts]
    chance.shuffle(facts)  # type: ignore[attr-defined]
    found = stated_plan(["node(org).", "held(o1).", *facts])
    assert found is not None
    assert [step.step for step in found.steps] == [str(errand) for errand in plan.errands]
    assert [set(step.doors) for step in found.steps] == [set(errand.doors) for errand in plan.errands]
    asked = [errand.commands if errand.certainty else None for errand in plan.errands]
    assert [step.commands for step in found.steps] == asked
    words = {None: "not asked", Certainty.SURE: "verified", Certainty.HOPED: "hoped"}
    assert [step.certainty for step in found.steps] == [words[errand.certainty] for errand in plan.errands]
    reckoned = not plan.unmet and (plan.cost or not plan.errands)
    assert (found.cost, found.least) == ((plan.cost, plan.least) if reckoned else (None, None))
    assert found.proved is (plan.proved and not plan.unmet)
    assert found.found is not bool(plan.unmet)
    assert ("cost: about" in str(found)) is bool(plan.cost and not plan.unmet)
    assert found.unmet == plan.unmet
    assert [" and ".join(goal.means) for goal in found.goals] == [goal.words for goal in GOALS]
    assert [one.step for one in found.refutations] == [one.step for one in plan.refutations]
    for told, meant in zip(found.refutations, plan.refutations, strict=True):
        others = {f"at({name},{place})" for name, place in meant.given}
        assert others < set(told.circumstances)  # and where its own thing was
        assert all((name in told.words) == (f"door {name} " in told.words) for name in meant.shut)


@settings(max_examples=20)
@given(PLANS)
def test_a_plan_is_told_with_each_of_its_steps_and_its_present_one_marked(plan: TaskPlan) -> None:
    found = stated_plan(plan.facts)
    assert found is not None
    steps = [line for line in found.lines() if line[:2] in ("> ", "  ")]
    assert len(steps) == len(plan.errands)
    assert [line.startswith(">") for line in steps] == [number == 0 for number in range(len(steps))]
    for line, errand in zip(steps, plan.errands, strict=True):
        assert str(errand) in line
        assert all(f"{door}" in line for door in errand.doors)
    assert ("best found, not proved" in str(found)) is (not plan.proved and not plan.unmet)
    assert (re.search("attains? all goals", str(found)) is not None) is bool(plan.unmet)
    assert all(f"goal {name}: " in str(found) and "not attained" in str(found) for name in plan.unmet)


def test_of_a_step_for_which_no_plan_was_sought_no_search_and_no_cost_is_told() -> None:
    for unmet in ((), ("g1",)):
        plan = TaskPlan((Errand("pursue", "g1"),), unmet, goals=GOALS[:1])
        found = stated_plan(plan.facts)
        assert found is not None and (found.found, found.cost, found.cost_words) == (not unmet, None, "")
        assert "was found" not in str(found) and "proved" not in str(found)
        assert ("not attained" in str(found)) is bool(unmet)


def test_facts_without_a_plan_state_none() -> None:
    assert stated_plan(["node(org).", "bound(x,o1).", "plan(1,2,3)."]) is None


@pytest.mark.parametrize(
    "fact",
    [
        "plan(x,carry(o1,p)).",
        "plan(0,carry(o1)).",
        "plan(0,eat(o1,p)).",
        "price(1,2,perhaps).",
        "refuted(o1,0).",
        "plan(0,",
    ],
)
def test_damaged_facts_of_a_plan_are_refused(fact: str) -> None:
    with pytest.raises(BadInputError):
        stated_plan(["plan(0,carry(o1,g1_r2)).", "price(5,5,proved).", fact])


@given(st.lists(st.text(max_size=30).map(lambda rest: f"plan({rest}"), max_size=3))
def test_any_facts_are_a_plan_or_refused(facts: list[str]) -> None:
    try:
        found = stated_plan(facts)
    except BadInputError:
        return
    assert found is None or isinstance(found, StatedPlan)


@settings(max_examples=20)
@given(PLANS)
def test_facts_of_plans_fit_the_vocabulary(plan: TaskPlan) -> None:
    names = {name for name, _ in PLAN_PREDICATES}
    assert {fact.partition("(")[0] for fact in plan.facts} <= names


@given(PLANS)
@settings(max_examples=20)
def test_where_no_plan_was_found_the_goals_and_refutations_are_told(plan: TaskPlan) -> None:
    found = stated_plan(plan.failure_facts)
    if not plan.unmet:
        assert found is None
        return
    assert found is not None
    assert (found.found, found.steps, found.cost, found.gap) == (False, (), None, None)
    assert found.unmet == plan.unmet
    assert len(found.refutations) == len(plan.refutations)
    assert "no plan that was found attains all goals" in str(found)
