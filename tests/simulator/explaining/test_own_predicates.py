"""Questions about predicates that users' rules define: why they hold, and why they do not."""

import pytest

from benchmarks.harness.reasons import complaints
from utak.kb.language.diagnostics import BadInputError
from utak.simulator.cli.commands.files.new import NEW_SCENARIO_FILES
from utak.simulator.cli.main import main
from utak.simulator.episode.episode import Episode, read_episode
from utak.simulator.explaining.questions import Questions, questions_of_episode

pytestmark = pytest.mark.long

RULES = """\
big(X) :- object(X), rect(X, W, S, E, N), E - W > 300.
small(X) :- object(X), not big(X), rect(X, W, S, E, N), E - W < 200.
long(R) :- extent(R, N), N > 20.
"""


@pytest.fixture(scope="module")
def asked(tmp_path_factory: pytest.TempPathFactory) -> tuple[Questions, Episode, list[str]]:
    """Return questions about a run with rules, its episode, and the command that asks the same."""
    folder = tmp_path_factory.mktemp("own")
    for name, text in NEW_SCENARIO_FILES.items():
        (folder / name).write_text(text)
    rules, log = folder / "rules.lp", folder / "ep.jsonl"
    rules.write_text(RULES)
    assert main(["run", str(folder), "--kb", str(rules), "--log", str(log)]) == 0
    episode = read_episode(log)
    return questions_of_episode(episode, [str(rules)]), episode, ["explain", str(log), "--kb", str(rules)]


def test_an_atom_for_queries_is_explained_and_so_is_its_absence(
    asked: tuple[Questions, Episode, list[str]], capsys: pytest.CaptureFixture[str]
) -> None:
    """Each object is big or is not: one of the two questions is answered, the other refused."""
    questions, episode, command = asked
    facts = [fact for fact in episode.steps[-1]["belief"]["facts"] if fact.startswith("kind(o") and ",object," in fact]
    assert facts
    for fact in facts:
        node = fact.removeprefix("kind(").split(",")[0]
        try:
            assert questions.why(f"big({node})").claim == f"big({node})"
            with pytest.raises(BadInputError, match="certainly holds"):
                questions.why_not(f"big({node})")
        except BadInputError:
            reason = questions.why_not(f"big({node})")
            assert reason.claim == f"not big({node})"
            assert reason.data["encoding"] == "belief"
            assert list(complaints(episode.steps, reason.as_dict())) == []
    assert questions.why("big(_)").claim.startswith("big(o")  # a variable stands for anything
    assert main([*command, "--whynot", "big(floor)", "--depth", "short"]) == 0
    said = capsys.readouterr().out
    assert "it would if kind(floor,object," in said


def test_an_atom_of_an_encoding_is_explained_and_so_is_its_absence(
    asked: tuple[Questions, Episode, list[str]],
) -> None:
    """A predicate that users' rules define in an encoding alone is answered from what the encoding was given."""
    questions, episode, _ = asked
    last = questions.beliefs.record.decisions(len(episode.steps) - 1)
    call = next(one for one in reversed(last) if one.encoding == "interpretation")
    extents = {parts[0]: int(parts[1]) for parts in (f[7:-1].split(",") for f in call.facts if f.startswith("extent("))}
    assert {length > 20 for length in extents.values()} == {True, False}
    for region, length in extents.items():
        if length > 20:
            reason = questions.why(f"long({region})")
            assert (reason.claim, reason.rests_on[0].claim) == (f"long({region})", f"extent({region},{length})")
            with pytest.raises(BadInputError, match="holds"):
                questions.why_not(f"long({region})")
        else:
            reason = questions.why_not(f"long({region})")
            assert f"(given is extent({region},{length}))" in reason.because


@pytest.mark.parametrize(
    ("question", "message"),
    [
        ("bigg(o1)", r"unknown predicate bigg/1\n.*\n.*\n  hint: did you mean big\?"),
        ("big(o1, o2)", r"unknown predicate big/2\n.*\n.*\n  hint: there is big/1$"),
        ("door(d1, 3, 4)", r"unknown predicate door/3\n.*\n.*\n  hint: there is door/1, door/2$"),
    ],
)
def test_unknown_predicates_are_refused_with_a_hint(
    question: str, message: str, asked: tuple[Questions, Episode, list[str]]
) -> None:
    """Nothing is said of a predicate that nobody defines."""
    for ask in (asked[0].why, asked[0].why_not):
        with pytest.raises(BadInputError, match=message):
            ask(question)


def test_objects_are_asked_about_one_by_one(asked: tuple[Questions, Episode, list[str]]) -> None:
    """`object(N)` stands for a kind: what is believed is not denied."""
    questions, _, _ = asked
    believed = questions.why("object(X)").claim
    with pytest.raises(BadInputError, match="this is believed"):
        questions.why_not(believed)
    for open_question in ("object(X)", "big(X)"):
        with pytest.raises(BadInputError, match="one atom at a time"):
            questions.why_not(open_question)
    reason = questions.why_not("object(floor)")
    assert reason.rests_on[0].claim == "not kind(floor,object,C)"
