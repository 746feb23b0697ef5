"""Whether steps of the robot may be done: each in the state to which those before it lead, and by users' rules."""

from collections.abc import Sequence

from utak.planner.question import Atoms, Question
from utak.planner.situation import Situation

# The predicates of planner/asp/deciding about the steps of the robot alone.
STEP_PREDICATES = (("offered", 2), ("step", 2), ("begun", 0), ("in_hand", 2), ("there", 3), ("holds", 1))


def are_ruled(situation: Situation) -> bool:
    """Return whether users' rules speak of the steps of the robot."""
    return situation.question.speaks_of(STEP_PREDICATES)


def refusal(steps: Sequence[str], situation: Situation, question: Question | None = None, last: bool = False) -> str:
    """Return why some steps, first the next one, may not be done, in words; "" where they may."""
    # question : where what was chosen before has one of its own. last : whether the answer is to be recorded.
    held = situation.model.held
    given = (question or situation.question).adding(f"offered({number},{step})" for number, step in enumerate(steps))
    given = given.adding([f"holds({held})"] * (held is not None))
    answer = given.recorded() if last else given.answer()
    if _are_begun(answer or ()):
        return ""
    blamed = given.blamed(lambda atoms: not _are_begun(atoms))
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


def _are_begun(answer: Atoms) -> bool:
    """Return whether steps are begun, by an answer."""
    return any(atom.name == "begun" for atom in answer)
