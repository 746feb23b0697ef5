"""What explanations say of a run is so: confidences, refutations, plans under way, questions with names in quotes."""

from pathlib import Path

import pytest

from utak.kb.evidence.reason import Depth, ReasonKind
from utak.kb.language.atoms import atom_parts
from utak.simulator.cli.main import main
from utak.simulator.episode.episode import Episode, read_episode
from utak.simulator.explaining.questions import Questions, questions_of_episode

pytestmark = pytest.mark.long

ROOT = Path(__file__).resolve().parents[3]
CLASSES = ("square", "brick", "l_shape", "t_shape", "u_shape", "triangle", "disc")  # those that exclude each other


def episode_of(name: str, folder: Path) -> Episode:
    """The episode of an example."""
    log = folder / f"{name}.jsonl"
    assert main(["run", str(ROOT / "examples" / name), "--log", str(log)]) == 0
    return read_episode(log)


@pytest.fixture(scope="module")
def blocked(tmp_path_factory: pytest.TempPathFactory) -> Episode:
    """An episode in which a brick is seen of which no square is surely covered."""
    return episode_of("push_square_blocked_door", tmp_path_factory.mktemp("episodes"))


@pytest.fixture
def questions(blocked: Episode) -> Questions:
    """Questions about that episode."""
    return questions_of_episode(blocked)


def test_exclusive_classes_have_100_percent_together_and_the_best_one_is_the_likeliest(questions: Questions) -> None:
    for step in questions.beliefs.record.steps:
        shapes: dict[str, dict[str, int]] = {}
        for fact in step.facts:
            name, parts = atom_parts(fact)
            if name == "shape" and len(parts) == 3:
                shapes.setdefault(parts[0], {})[parts[1]] = int(parts[2])
        for found in shapes.values():
            assert sum(found.get(name, 0) for name in CLASSES) <= 100
            assert found["rectangle"] >= max(found["square"], found["brick"])
            assert found["polygon"] + found["disc"] <= 100
    assert shapes  # the last step says something
    first = {fact for fact in questions.beliefs.record.steps[0].facts if fact.startswith("shape(o2,")}
    (brick,) = (fact for fact in first if fact.startswith("shape(o2,brick,"))
    assert all(
        int(atom_parts(fact)[1][2]) <= int(atom_parts(brick)[1][2])
        for fact in first
        if atom_parts(fact)[1][1] in CLASSES
    )


def test_a_question_with_variables_takes_the_surest(questions: Questions) -> None:
    found = questions.why("shape(X,brick,C)")
    sure = [fact for fact in questions.beliefs.record.steps[-1].facts if ",brick," in fact]
    assert found.claim == max(sure, key=lambda fact: int(atom_parts(fact)[1][2]))
    assert f"1 of {len(sure)} that fit" in found.because


def test_a_goal_that_depends_on_where_its_thing_was_at_first_says_where(questions: Questions) -> None:
    last, steps = questions.last_step, questions.beliefs.record.steps
    (first,) = [one for one in questions.why("in(x,room(next))", last).rests_on if "was at first" in one.because]
    node = steps[last].bound["x"]
    places = [fact for one in steps for fact in one.facts if fact.startswith(f"offset({node},")]
    assert first.claim == places[0] != places[-1]


def test_a_refutation_says_what_it_rests_on_and_what_geometry_found(tmp_path: Path) -> None:
    questions = questions_of_episode(episode_of("push_row_away", tmp_path))
    at = next(n for n, step in enumerate(questions.beliefs.record.steps) if any("refuted(" in f for f in step.facts))
    found = questions.why("refuted(S,R)", at)
    assert "while o1 is where it was" in found.because and "whatever else" not in found.because
    assert "squares wide" in found.text(Depth.LONG)


def test_why_not_of_a_door_that_is_not_there_names_those_that_are(questions: Questions) -> None:
    last = questions.last_step
    assert questions.why_not("door(d7, C)", last).because.startswith(
        "no door d7 is believed to be there at this step; d1"
    )
    assert questions.why_not("door(d7, C)", 0).because.endswith("; none is")


def test_a_verdict_is_given_at_the_last_step_alone(questions: Questions) -> None:
    verdict = questions.why("verdict(V)").claim
    assert f"given at step {questions.last_step} alone" in questions.why_not(verdict, 2).because


def test_what_the_robot_decided_is_not_called_measured(questions: Questions) -> None:
    kinds = {one.claim.partition("(")[0]: one.kind for one in questions.why_step(2).walk() if not one.rests_on}
    decided = {"horizon", "planned", "missing", "came_to", "place"} & kinds.keys()
    assert decided and all(kinds[name] == ReasonKind.DECIDED for name in decided)


def test_a_plan_is_shown_while_a_thing_is_held_askew(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    steps = episode_of("push_l_tight_door", tmp_path).steps
    for number, step in enumerate(steps[1:-1], 1):
        assert any(fact.startswith("plan(0,") for fact in step["belief"]["facts"]), number
