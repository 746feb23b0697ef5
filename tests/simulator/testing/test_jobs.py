"""Several scenarios at once, each process with the real robot: the same outcomes as one after the other."""

import json
import shutil
from pathlib import Path

import pytest

from simulator.cli.main import main
from simulator.testing.handle import WorkerEndedError, WorkerHandle

EXERCISES = Path(__file__).resolve().parents[3] / "docs" / "exercises"


def test_several_jobs_give_the_outcomes_of_one(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for name in ("01_change_the_goal", "02_say_what_you_mean"):
        shutil.copytree(EXERCISES / name, tmp_path / "class" / name)
    (shutil.copytree(EXERCISES / "01_change_the_goal", tmp_path / "class" / "bad") / "goal.lp").write_text("at(utak")
    found = []
    for jobs in ("1", "3"):
        assert main(["test", str(tmp_path / "class"), "--json", "--jobs", jobs]) == 65
        seen = capsys.readouterr()
        assert "goal.lp:1:7-7: error" in seen.err
        found.append(json.loads(seen.out))
    assert found[0] == found[1]
    assert [one["outcome"] for one in found[0]["scenarios"]] == ["failed", "failed", "bad"]


def test_a_process_that_ends_is_reported_and_another_one_is_started() -> None:
    handle = WorkerHandle()
    try:
        with pytest.raises(WorkerEndedError, match="ended with exit code"):
            handle.ask({"nonsense": 1})  # no wish: an error that the process does not survive
        record = handle.ask({"folder": "no/where", "root": "no/where", "given": {}})
        assert (record["outcome"], record["exit_code"]) == ("absent", 66)
        assert "no such folder" in record["report"]
        assert "repeat it: utak test no/where" in record["report"]
    finally:
        handle.close()
