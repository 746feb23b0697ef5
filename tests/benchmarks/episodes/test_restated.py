"""The restatements of encodings as a least price: what they choose, and how they are counted."""

import json
from pathlib import Path

import pytest

from benchmarks.episodes.restated import PARTS, RESTATED, main


@pytest.mark.parametrize(
    ("part", "facts", "chosen"),
    [
        ("subgoal", {"aim": [("0", "explore", "50"), ("1", "explore", "70")]}, "choose(0)"),
        ("subgoal", {"aim": [("0", "explore", "50"), ("1", "attain", "900")]}, "choose(1)"),
        ("subgoal", {"aim": [("0", "explore", "50"), ("1", "explore", "70")], "last": [("1",)]}, "choose(1)"),
        ("halt", {"halt": [("0", "9", "1"), ("1", "2", "2")], "tells": [("0", "thing", "doorway", "1")]}, "choose(0)"),
        ("way", {"tight": [("0", "500", "200", "0"), ("1", "400", "200", "9")]}, "walked(0)"),
        (
            "activity",
            {"stage_goal": [("g1", "1")], "came_to": [("agree", "idle"), ("errand", "idle")]},
            "do(pursue(g1))",
        ),
    ],
)
def test_a_restatement_chooses_the_least(part: str, facts: dict[str, list[tuple[str, ...]]], chosen: str) -> None:
    assert PARTS[part][1](facts) == chosen
    assert chosen in RESTATED["deciding"]({"aim": [("0", "explore", "50")], **facts}) or part == "halt"


def test_an_errand_is_the_nearest_place() -> None:
    facts = {"fulfils": [("o1", "p", "g1")], "estimate": [("o1", "here", "p", "4")]}
    assert RESTATED["task"](facts) == {"occurs(carry(o1,p),0)"}
    assert RESTATED["task"]({}) == {""}


def test_decisions_are_counted(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    given = ["aim(0,explore,50)", "aim(1,explore,70)", "stage_goal(g1,1)"]
    solved = [
        ["deciding", given, ["choose(0)", "do(agree)"], []],
        ["deciding", given, ["choose(1)", "do(agree)"], []],
        ["deciding", [0, 0]],
        ["rooms", [], [], []],
    ]
    (tmp_path / "one.jsonl").write_text(json.dumps({"step": 0, "belief": {"solved": solved}}) + "\n")
    assert main([str(tmp_path)]) == 0
    rows = {line.split()[0]: line.split()[1:] for line in capsys.readouterr().out.splitlines()[1:]}
    assert rows["deciding"] == rows["subgoal"] == ["2", "1"]
    assert rows["activity"] == ["2", "2"] and rows["way"] == ["0", "0"]
