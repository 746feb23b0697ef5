"""The restatements of encodings as a least price: what they choose, and how they are counted."""

import json
from pathlib import Path

import pytest

from benchmarks.episodes.restated import RESTATED, main


@pytest.mark.parametrize(
    ("encoding", "facts", "chosen"),
    [
        ("aims", {"aim": [("0", "explore", "50"), ("1", "explore", "70")]}, "choose(0)"),
        ("aims", {"aim": [("0", "explore", "50"), ("1", "attain", "900")]}, "choose(1)"),
        ("aims", {"aim": [("0", "explore", "50"), ("1", "explore", "70")], "last": [("1",)]}, "choose(1)"),
        ("feel", {"halt": [("0", "9", "1"), ("1", "2", "2")], "tells": [("0", "thing", "doorway", "1")]}, "feel(0)"),
        ("walks", {"tight": [("0", "500", "200", "0"), ("1", "400", "200", "9")]}, "walked(0)"),
        ("agenda", {"stage_goal": [("g1", "1")], "came_to": [("agree", "idle"), ("errand", "idle")]}, "do(pursue(g1))"),
        ("task", {"fulfils": [("o1", "p", "g1")], "estimate": [("o1", "here", "p", "4")]}, "occurs(carry(o1,p),0)"),
        ("task", {}, ""),
    ],
)
def test_a_restatement_chooses_the_least(encoding: str, facts: dict[str, list[tuple[str, ...]]], chosen: str) -> None:
    assert RESTATED[encoding](facts) == chosen


def test_decisions_are_counted(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    given = ["aim(0,explore,50)", "aim(1,explore,70)"]
    solved = [
        ["aims", given, ["choose(0)"], []],
        ["aims", given, ["choose(1)"], []],
        ["aims", [0, 0]],
        ["rooms", [], [], []],
    ]
    (tmp_path / "one.jsonl").write_text(json.dumps({"step": 0, "belief": {"solved": solved}}) + "\n")
    assert main([str(tmp_path)]) == 0
    rows = {line.split()[0]: line.split()[1:] for line in capsys.readouterr().out.splitlines()[1:]}
    assert rows["aims"] == ["2", "1"] and rows["walks"] == ["0", "0"]
