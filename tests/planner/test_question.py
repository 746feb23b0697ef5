"""The question what to do: without rules of users each choice rests on its own parts of planner/asp/deciding alone."""

import pytest

from tests.encoding_cases import Case, cases_of
from tests.tables import few
from utak.planner.question import DECIDING_ENCODING, Question

# Where rules are given, all parts are solved together.
ALL = [case for case in cases_of(DECIDING_ENCODING) if ":-" not in case.facts]
# By the parts of the program that make a choice: the predicates that tell it.
CHOICES = {
    ("activities", "verdicts"): {"do", "stuck", "stage_attained", "suppose", "depends", "verdict"},
    ("subgoals",): {"choose"},
    ("senses",): {"sense"},
    ("hand",): {"react"},
    ("bring",): {"bring"},
    ("senses", "steps"): {"begun", "sense"},
    ("walks",): {"step", "walked"},
}


@pytest.mark.parametrize("case", few([(case,) for case in ALL], 30), ids=lambda case: case.title)
def test_a_choice_is_the_same_by_its_own_parts_as_by_the_whole_program(case: Case) -> None:
    facts = case.facts.strip().removesuffix(".")
    question = Question(facts=(facts,) if facts else ())
    whole = question.answer()
    if whole is None:
        return
    for parts, predicates in CHOICES.items():
        of_parts = question.answer(*parts)
        assert of_parts is not None
        of_whole = [atom for atom in whole if atom.name in predicates]
        assert [atom for atom in of_parts if atom.name in predicates] == of_whole, parts
