"""Episodes that are compared before and after a change are written with the noises that are asked for."""

import argparse
import json
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from benchmarks.unchanged import NOISES, jobs_of, main, noises_named


def test_each_scenario_is_run_with_each_noise(tmp_path: Path) -> None:
    """Jobs are the product of scenarios and noises, each with a file of its own; the noises of old are the default."""
    usual, other = list(jobs_of(0, 1, tmp_path)), list(jobs_of(0, 1, tmp_path, (0.05,)))
    assert {noise for _, noise, _ in usual} == set(NOISES)
    assert len(usual) == len(NOISES) * len(other)
    assert {asked for asked, _, _ in usual} == {asked for asked, _, _ in other}
    assert [noise for _, noise, _ in other] == [0.05] * len(other)
    files = [file for _, _, file in [*usual, *other]]
    assert len(set(files)) == len(files)


def test_commands_can_be_compared_alone(tmp_path: Path) -> None:
    """What is believed is left out with --commands, and nothing else."""
    for folder, fact, command in (("a", "door(d1).", 1), ("b", "door(d1,99).", 1), ("c", "door(d1).", 2)):
        (tmp_path / folder).mkdir()
        step = {"step": 0, "action": {"do": "turn", "degrees": command}, "belief": {"facts": [fact]}, "why": folder}
        (tmp_path / folder / "one.jsonl").write_text(json.dumps(step) + "\n")
    a, b, c = (str(tmp_path / folder) for folder in "abc")
    assert main(["compare", a, b]) == 1 and main(["compare", a, b, "--commands"]) == 0
    assert main(["compare", a, c, "--commands"]) == 1


@given(st.lists(st.floats(0, 1), min_size=1, max_size=5))
def test_noises_are_read_as_written(noises: list[float]) -> None:
    """Noises with commas between them are read in their order, each once."""
    assert noises_named(",".join(map(str, noises))) == tuple(dict.fromkeys(noises))


@pytest.mark.parametrize("text", ["", "a", "0,,1", "-0.1", "1.01", "nan", "0;1"])
def test_what_is_no_noise_is_refused(text: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """What is no number from 0 to 1 is an error of usage, and nothing is written."""
    with pytest.raises(argparse.ArgumentTypeError):
        noises_named(text)
    with pytest.raises(SystemExit) as ended:
        main(["write", str(tmp_path / "out"), f"--noises={text}"])
    assert ended.value.code == 2
    assert "--noises" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()
