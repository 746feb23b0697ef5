"""trial.lp: options, rules and questions; what is wrong with it is said with its place."""

from pathlib import Path

import pytest

from utak.kb.language.diagnostics import BadInputError
from utak.kb.language.vocabulary import PREDICATES_BY_FILE
from utak.simulator.scenario.trialfile import TRIAL_VOCABULARY, answers_as_wanted, read_trial_plan


def written(folder: Path, text: str) -> Path:
    (folder / "trial.lp").write_text(text)
    return folder / "trial.lp"


def test_hints_know_what_belongs_in_this_file() -> None:
    assert set(PREDICATES_BY_FILE["trial.lp"]) == set(TRIAL_VOCABULARY)


def test_a_plan_has_options_rules_and_questions(tmp_path: Path) -> None:
    text = """seed(3). noise("0.05"). paths(grid). max_steps(9). no_pull. rules("r.lp").
    asks("p(X)", rows(2)). asks("q", yes). weight(asks("q", yes), 4)."""
    plan = read_trial_plan(written(tmp_path, text))
    assert plan.options == {"seed": 3, "noise": 0.05, "paths": "grid", "max_steps": 9, "pull": False}
    assert plan.rules == (str(tmp_path / "r.lp"),)
    assert {str(fact): points for fact, points in plan.asks.items()} == {
        'asks("p(X)",rows(2))': 1,
        'asks("q",yes)': 4,
    }
    assert read_trial_plan(written(tmp_path, "% nothing")) == ({}, (), {})


BAD = {
    "seed(-1).": "a seed must be from 0 to",
    'noise("2").': "a noise must be from 0 to 1",
    "noise(x).": "a noise must be a number, not x",
    "paths(gird).": "unknown path-finder gird",
    "seed(1). seed(2).": "1:10-16: error: stated twice: seed(2)",
    'rules("../r.lp").': "a file in this folder was expected",
    'rules("/r.lp").': "a file in this folder was expected",
    'rules("r.py").': "a file in this folder was expected",
    "rules(r).": "a file in this folder was expected, not r",
    "asks(p, yes).": "a query must be a quoted text, not p",
    'asks(" ", yes).': "a query must be a quoted text",
    'asks("p", perhaps).': "unknown answer perhaps",
    'asks("p", rows(-1)).': "a number of rows must be from 0",
    'asks("p", rows(1, 2)).': "unknown answer rows(1,2)",
    'asks("p", row).': "unknown answer row",
    'asks("p", yes). weight(asks("p", no), 1).': 'asks("p",no) is weighed, but not asked',
    'asks("p", yes). weight(asks("p", yes), 1). weight(asks("p", yes), 2).': "stated twice",
    "within(3).": "within belongs in expect.lp",
}


@pytest.mark.parametrize("text", BAD)
def test_errors_of_a_plan_are_reported(text: str, tmp_path: Path) -> None:
    with pytest.raises(BadInputError) as caught:
        read_trial_plan(written(tmp_path, text))
    assert BAD[text] in str(caught.value)
    assert f"{tmp_path / 'trial.lp'}:1:" in str(caught.value)


@pytest.mark.parametrize(
    ("wanted", "kind", "rows", "more", "came"),
    [
        ("yes", "yes", (), False, ""),
        ("yes", "bindings", (("o1",),), False, ""),
        ("yes", "don't know", (), False, "the answer is don't know"),
        ("dont_know", "don't know", (), False, ""),
        ("no", "don't know", (), False, "the answer is don't know"),
        ("rows(1)", "bindings", (("o1",),), False, ""),
        ("rows(1)", "bindings", (("o1",),), True, "the answer has 1 row or more: o1"),
        ("rows(0)", "no", (), False, ""),
        ("rows(1)", "no", (), False, "the answer is no"),
        ("row(o2, 3)", "bindings", (("o1", 2), ("o2", 3)), False, ""),
        ("row(o2, 4)", "bindings", (("o1", 2), ("o2", 3)), False, "the answer has 2 rows: o1, 2; o2, 3"),
        ("row(o2)", "bindings", (("o2", 3),), False, "the answer has 1 row: o2, 3"),
    ],
)
def test_answers_are_compared(
    wanted: str, kind: str, rows: tuple[tuple[int | str, ...], ...], more: bool, came: str, tmp_path: Path
) -> None:
    asked = next(iter(read_trial_plan(written(tmp_path, f'asks("q", {wanted}).')).asks))
    assert answers_as_wanted(asked, kind, rows, more) == came
