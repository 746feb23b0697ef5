"""Why facts of places are believed, or known, or not, in a run of two rooms; both names of the robot, both forms."""

from pathlib import Path

import pytest

from utak.kb.evidence.reason import Reason
from utak.kb.language.atoms import atom_parts, short_form
from utak.kb.language.diagnostics import BadInputError
from utak.kb.language.vocabulary import BELIEF_PREDICATES
from utak.simulator.cli.main import main
from utak.simulator.episode.episode import read_episode
from utak.simulator.explaining.questions import Questions, questions_of_episode

EXAMPLE = Path(__file__).resolve().parents[3] / "examples" / "push_square_next_room"
PLACES = ("door", "connects", "width", "in", "corner", "adjacent", "region", "part_of")


@pytest.fixture(scope="module")
def questions(tmp_path_factory: pytest.TempPathFactory) -> Questions:
    """The questions about a run in which a thing is pushed through a door."""
    folder = tmp_path_factory.mktemp("run")
    (folder / "rules.lp").write_text("felt(X) :- adjacent(utak, X).\n")
    assert main(["run", str(EXAMPLE), "--log", str(folder / "ep.jsonl")]) == 0
    return questions_of_episode(read_episode(folder / "ep.jsonl"), [str(folder / "rules.lp")])


def claims(reason: Reason) -> list[str]:
    return [one.claim for one in reason.walk()]


def test_each_fact_of_places_has_its_reason_and_the_short_form_rests_on_the_long_one(questions: Questions) -> None:
    told = set()
    for step in (0, questions.last_step // 2, questions.last_step):
        for fact in questions.beliefs.record.steps[step].facts:
            name, arguments = atom_parts(fact)
            if name not in PLACES:
                continue
            told.add((name, len(arguments)))
            why = questions.why(fact, step)
            assert why.claim == fact and why.rests_on
            if short := short_form(fact):
                assert fact in claims(questions.why(short, step))
                assert "percent" not in questions.why(short, step).because
            if name in ("adjacent", "in") and "org" in arguments:
                assert questions.why(fact.replace("org", "utak"), step).claim == fact
    assert {(name, n) for name, n in told if not BELIEF_PREDICATES[name, n].long} == {
        ("door", 2), ("connects", 4), ("width", 2), ("width", 3), ("in", 3), ("corner", 4), ("adjacent", 3),
        ("region", 3), ("part_of", 2),
    }  # fmt: skip


def test_what_is_believed_and_not_known_is_told_apart_from_what_is_not_believed(questions: Questions) -> None:
    last = questions.last_step
    for fact in questions.beliefs.record.steps[last].long_facts:
        name, arguments = atom_parts(fact)
        declared = BELIEF_PREDICATES[name, len(arguments)]
        if name in PLACES and declared.short and arguments[-1] != "100":
            not_known = questions.why_not(f"{name}({','.join(arguments[:-1])})", last)
            assert fact in not_known.because and fact in claims(not_known)
    for asked, named in (("door(d99)", "door d99"), ("in(o1, r99)", "room r99"), ("adjacent(o1, o99)", "object o99")):
        assert questions.why_not(asked, last).because.startswith(f"no {named} is believed to be there")
    for asked in ("corner(northeast, 1, 1)", "region(part999, zero)"):
        found = questions.why_not(asked, last)
        assert found.claim.startswith("not ") and "is not believed" in found.because and found.rests_on
    for asked in ("width(d1, 1, 2)", "part_of(part1, verge)"):
        assert "this is believed instead" in questions.why_not(asked, last).because


def test_a_door_that_is_less_sure_than_its_neck_says_why(questions: Questions) -> None:
    facts = questions.beliefs.record.steps[questions.last_step].facts
    door = next(fact for fact in facts if fact.startswith("door(d1,"))
    assert not door.endswith(",100)")
    assert "it is not beyond doubt" in claims(questions.why(door))


def test_what_is_known_is_no_question_for_whynot(questions: Questions) -> None:
    known = next(fact for fact in questions.beliefs.record.steps[-1].facts if fact.startswith("adjacent(org,"))
    for asked in (known, known.replace("org", "utak")):
        with pytest.raises(BadInputError, match="this is believed"):
            questions.why_not(asked)


def test_rules_for_queries_know_both_names(questions: Questions) -> None:
    step = next(one.number for one in questions.beliefs.record.steps if "adjacent(org,o1)" in one.fact_set)
    found = questions.why("felt(o1)", step)
    assert "adjacent(org,o1)" in claims(found) and "adjacent(org,o1,100)" in claims(found)
