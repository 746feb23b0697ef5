"""The benchmark of explanations: which decisions it reads from an episode, and what it prints."""

import json
from pathlib import Path

import pytest

from benchmarks.timing.explaining import decisions, in_words, main

SOLVED = [
    ["interpretation", ["region(a,zero,100)"], ["kind(a,floor,100)"], []],
    ["deciding", ["aim(1,explore,30)", "aim(2,explore,40)"], ["choose(1)", "do(errand)"], []],
    ["deciding", [0, 1]],
    ["rooms", [], []],
    ["deciding", ["chance(1,5)"], None, []],
]


def episode(tmp_path: Path) -> Path:
    path = tmp_path / "episode.jsonl"
    lines = [{"utak": "episode"}, {"step": 0, "belief": {"solved": SOLVED}}, {"result": {}}]
    path.write_text("".join(f"{json.dumps(line)}\n" for line in lines))
    return path


def test_decisions_with_an_answer_are_read(tmp_path: Path) -> None:
    assert [name for name, _, _ in decisions(episode(tmp_path))] == ["interpretation", "deciding"]


def test_each_encoding_has_a_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([str(episode(tmp_path)), "--absences", "1"]) == 0
    rows = {line.split()[0]: line.split() for line in capsys.readouterr().out.splitlines()[1:]}
    assert rows.keys() == {"interpretation", "deciding"}
    assert rows["deciding"][1] == "1" and rows["deciding"][-1] != "-" and rows["interpretation"][-1] == "-"


def test_times_in_words() -> None:
    assert (in_words([]), in_words([1.0, 3.0, 2.0])) == ("-", "2.0, 3.0")
