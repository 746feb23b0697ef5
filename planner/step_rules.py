"""Whether steps of the robot may be done: each in the state to which those before it lead, and by users' rules."""

from collections.abc import Sequence

from utak.kb.reasoning.solver import solve
from utak.kb.reasoning.user_rules import rules_reach, rules_to_blame
from utak.kb.tracing.decisions import record_decisions
from utak.planner.navigation.subgoals import PLANNER_ASP
from utak.planner.situation import Situation

STEPS_ENCODING = PLANNER_ASP / "steps.lp"


def are_ruled(situation: Situation) -> bool:
    """Return whether users' rules speak of the steps of the robot."""
    return rules_reach(STEPS_ENCODING.stem, situation.rules)


def refusal(steps: Sequence[str], situation: Situation) -> str:
    """Return why some steps, first the next one, may not be done, in words; "" where they may."""
    held, files = situation.model.held, situation.rules if are_ruled(situation) else ()
    facts = [f"offered({number},{step})" for number, step in enumerate(steps)]
    facts += [f"holds({held})"] * (held is not None)
    facts += situation.facts_for_rules(STEPS_ENCODING.stem) if files else ()
    with record_decisions():
        begun = solve([STEPS_ENCODING, *files], facts)
    if begun:
        return ""
    blamed = rules_to_blame(STEPS_ENCODING, files, facts, lambda atoms: not atoms) if files else ()
    if not blamed:
        return f"{', '.join(steps)} cannot be done one after the other"
    return forbidden_by(blamed, ", ".join(steps))


def forbidden_by(rules: Sequence[str], what: str) -> str:
    """Return in words that users' rules, such as `rules.lp:3`, forbid something."""
    return (
        f"the rule at {rules[0]} forbids {what}"
        if len(rules) == 1
        else f"the rules at {' and '.join(rules)} forbid {what}"
    )
