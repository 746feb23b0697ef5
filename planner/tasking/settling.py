"""The task plan where something is open: steps that find, see, feel or move away what is not settled."""

from collections.abc import Sequence
from typing import Any

from utak.kb.reasoning.user_rules import rules_to_blame
from utak.planner.oracles.problem import TaskProblem
from utak.planner.situation import Situation
from utak.planner.stages import Stage
from utak.planner.tasking.facts import Answers, answer_facts, goal_facts, overlaps_of, problem_facts
from utak.planner.tasking.proposal import TASK_ENCODING, UNMET_PLAN, propose
from utak.planner.tasking.setting import waiting_goal
from utak.planner.tasking.task_plan import Errand, RefutedStep, TaskPlan


def plan_that_settles(
    problem: TaskProblem | None,
    stage: Stage,
    situation: Situation,
    given: Sequence[str],
    refuted: tuple[RefutedStep, ...] = (),
) -> tuple[TaskPlan, str]:
    """Return the plan of the encoding where something is open, and words for what users' rules keep out of it."""
    # The words name the steps that may settle something, and the rules because of which there is none; "" where there
    # is one.
    facts = [*given, *["shaken"] * situation.model.shaken]
    if situation.model.held is not None:
        facts.append(f"holds({situation.model.held})")
    if problem is None:
        goals = [waiting_goal(f"g{number}", goal) for number, goal in enumerate(stage.carried, 1)]
        facts += [*goal_facts(goals, [goal.name for goal in goals]), *situation.facts_for_rules("task")]
    else:
        facts += problem_facts(problem, (), situation, frozenset(), overlaps_of(problem))
        facts += answer_facts(Answers(refutations=refuted))
    horizon = max(1, len(stage.goals) + sum(fact.startswith("stuck(") for fact in given))
    placed = () if problem is None else problem.goals
    about = [*(f"{goal.name}: {goal.words}" for goal in placed), *Answers(refutations=refuted).found]
    without: tuple[str, ...] = ()
    begins = 0 if problem is None else problem.begins
    given_facts = (f"horizon({begins + horizon})", *facts)
    found = propose(given_facts, situation.rules, about)
    while situation.rules and found.unmet == (UNMET_PLAN,) and found.proved:
        more = rules_to_blame(TASK_ENCODING, situation.rules, given_facts, lambda _atoms: False, without)
        if not more:
            break
        without += more  # what they demand of the end cannot be had before this is settled
        found = propose(given_facts, situation.rules, about, without)
    hoped = [errand.goal for errand in found.errands if errand.settles and errand.goal]
    unmet = tuple(dict.fromkeys([*hoped, *found.unmet]))
    plan = TaskPlan(found.errands, unmet, proved=found.proved, rounds=1, goals=placed, refutations=refuted)
    if not situation.rules or not found.left or step_that_settles(plan, True) is not None:
        return plan, ""
    blamed = rules_to_blame(TASK_ENCODING, situation.rules, given_facts, _settles_nothing, without)
    return plan, f"{' and '.join(found.left)}, by the rule at {' and '.join(blamed)}" if blamed else ""


def _settles_nothing(atoms: Sequence[Any]) -> bool:
    """Return whether a plan, given by the shown atoms, has no step that settles something."""
    steps = (str(atom.arguments[0]) for atom in atoms if atom.name == "occurs")
    return not {str(atom.arguments[0]) for atom in atoms if atom.name == "left"}.intersection(steps)


def step_that_settles(plan: TaskPlan, stuck: bool) -> Errand | None:
    """Return the first step of a plan that settles something; None for none."""
    for errand in plan.errands:
        if errand.settles:
            return errand
        if errand.goal and errand.action == "carry" and not stuck:
            return Errand("pursue", errand.goal)
    return None
