"""What is said of the step of the plan that is done is so, in a run in which things are brought into two corners."""

from itertools import pairwise
from pathlib import Path

import pytest

from utak.kb.language.atoms import atom_parts
from utak.simulator.cli.main import main
from utak.simulator.episode.episode import read_episode
from utak.simulator.explaining.questions import Questions, questions_of_episode

EXAMPLE = Path(__file__).resolve().parents[3] / "examples" / "push_only_two_corners"


@pytest.fixture(scope="module")
def questions(tmp_path_factory: pytest.TempPathFactory) -> Questions:
    """The questions about the run."""
    log = tmp_path_factory.mktemp("run") / "ep.jsonl"
    assert main(["run", str(EXAMPLE), "--log", str(log)]) == 0
    return questions_of_episode(read_episode(log))


def test_a_goal_that_the_steps_under_way_attain_is_not_stated_unmet_and_no_search_is_told(questions: Questions) -> None:
    steps = questions.beliefs.record.steps
    brought = [now for now, then in pairwise(steps) if "to its place (northeast)" in then.why]
    assert len(brought) > 1
    for now in brought:
        assert {"plan(0,pursue(g1))", "serves(0,g1)"} <= now.fact_set
        assert not {atom_parts(fact)[0] for fact in now.facts} & {"unmet", "price"}
        assert any(fact.startswith("step(") and ",push(o1," in fact for fact in now.facts)


def test_what_is_looked_at_first_leaves_its_goal_unmet_and_the_next_command_says_why(questions: Questions) -> None:
    steps = questions.beliefs.record.steps
    looking = [now.number for now in steps if "unmet(g1)" in now.facts]
    assert looking
    for step in looking:
        why = questions.why("unmet(g1)", step)
        assert "was found" not in why.because and "unmet(g1)" not in [one.claim for one in why.rests_on]
        assert any(one.because == steps[step + 1].why for one in why.rests_on)


def test_a_step_of_the_robot_is_told_with_what_it_serves_and_in_squares(questions: Questions) -> None:
    for now in questions.beliefs.record.steps[:-1]:
        fact = next(fact for fact in now.facts if fact.startswith("step(0,"))
        why = questions.why(fact, now.number)
        assert [atom_parts(one.claim)[0] for one in why.rests_on[:-1]] == ["plan"]
        assert "00" not in why.because and why.rests_on[-1].because


def test_a_step_that_no_search_planned_is_dated_by_the_step_at_which_it_is_done(questions: Questions) -> None:
    for now in questions.beliefs.record.steps[:-1]:
        (fact,) = (fact for fact in now.facts if fact.startswith("plan(0,"))
        assert questions.why(fact, now.number).source == f"step {now.number}"


def test_a_corner_is_believed_also_where_a_thing_was_put_into_it(questions: Questions) -> None:
    last = [atom_parts(fact)[1] for fact in questions.beliefs.record.steps[-1].long_facts if fact.startswith("corner(")]
    sure = {name: int(share) for name, _, _, share in last}
    assert min(sure["northeast"], sure["southwest"]) >= 89
    assert "by what was counted" in questions.why(f"corner({','.join(last[0])})").text()
