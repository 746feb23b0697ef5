"""`utak sweep`: what it writes, what it goes on with, what it refuses, and how it ends when it is interrupted."""

import json
import os
import signal
import subprocess
import sys
import time
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest

from benchmarks.episodes.killing import descendants_of, still_there
from utak.simulator.cli.main import main

ROOT = Path(__file__).resolve().parents[4]


@pytest.fixture
def scenario(tmp_path: Path) -> Path:
    """Return a scenario that takes two steps."""
    assert main(["new", str(tmp_path / "small")]) == 0
    return tmp_path / "small"


def rows(path: Path) -> list[dict[str, object]]:
    """Return the lines of a file."""
    return [json.loads(line) for line in path.read_text().splitlines()]


def without_seconds(found: list[dict[str, object]]) -> list[dict[str, object]]:
    """Return rows in the order of their runs, without what differs from machine to machine."""
    return sorted(({**row, "seconds": 0} for row in found), key=lambda row: (row["noise"], row["seed"]))


@pytest.mark.long
def test_a_sweep_is_the_same_in_shards_with_any_number_of_processes_and_after_a_break(
    scenario: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    capsys.readouterr()
    options = ["small", "--seeds", "0:2", "--noise", "0,0.05", "--max-steps", "4"]
    one, two, picture = (tmp_path / name for name in ("one.jsonl", "two.jsonl", "picture.svg"))
    assert main(["sweep", *options, "--jobs", "2", "-o", "one.jsonl", "--svg", str(picture)]) == 0
    seen = capsys.readouterr()
    assert seen.err == "" and seen.out.splitlines()[-1].split()[:2] == ["all", "4"]
    found = without_seconds(rows(one))
    assert [(row["scenario"], row["noise"], row["seed"]) for row in found] == [
        ("small", noise, seed) for noise in (0.0, 0.05) for seed in (0, 1)
    ]
    assert len({row["run"] for row in found}) == 4 and all(row["result"]["steps"] > 0 for row in found)  # type: ignore[index]
    assert "noise 0.05" in {text.text for text in ET.parse(picture).iter()}
    lines = one.read_bytes().splitlines(keepends=True)
    two.write_bytes(lines[3] + lines[2][:-9])  # as a kill may leave it
    assert main(["sweep", *options, "-o", "two.jsonl", "--shard", "1/2", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["planned"] == 2
    assert main(["sweep", *options, "-o", "two.jsonl", "--json"]) == 0
    assert without_seconds(rows(two)) == found
    summary = json.loads(capsys.readouterr().out)
    assert summary["planned"] == summary["all"]["runs"] == 4
    assert [group["noise"] for group in summary["groups"]] == [0.0, 0.05]
    before = one.read_bytes()
    assert main(["sweep", *options, "-o", "one.jsonl"]) == 0
    assert one.read_bytes() == before, "a complete sweep is not repeated"


def test_what_is_wrong_is_refused_before_anything_is_run(
    scenario: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    results = tmp_path / "results.jsonl"
    results.write_text('{"run":"0123456789abcdef","seed":7}\n')
    before = results.read_bytes()
    assert main(["sweep", str(scenario), "-o", str(results)]) == 65
    assert "results.jsonl:1:1-1: error: this line is no result" in capsys.readouterr().err
    assert main(["sweep", str(scenario), "-o", str(scenario / "goal.lp")]) == 66
    assert main(["sweep", str(scenario), "--svg", str(scenario / "goal.lp")]) == 66
    assert main(["sweep", str(tmp_path / "nowhere"), "-o", str(results)]) == 66
    (scenario / "goal.lp").write_text("at(utak, cornr(northeast)).")
    assert main(["sweep", str(scenario), "-o", str(results)]) == 65
    assert "did you mean corner" in capsys.readouterr().err
    assert results.read_bytes() == before


@pytest.mark.parametrize(
    "wrong",
    [
        ["--seeds", "5:5"],
        ["--seeds", "0:2000000"],
        ["--noise", "0,2"],
        ["--noise", ""],
        ["--jobs", "-1"],
        ["--jobs", "2", "--dask", "tcp://127.0.0.1:1"],
        ["--seconds", "0"],
        *(["--shard", shard] for shard in ("0/3", "4/3", "2", "1/0", "1/2/3", "-1/2")),
        ["--json", "-o", "-"],
    ],
)
def test_options_without_meaning_are_refused(wrong: list[str], scenario: Path) -> None:
    assert main(["sweep", str(scenario), *wrong]) == 2


def test_runs_that_take_too_long_are_recorded_and_the_exit_code_says_so(
    scenario: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["sweep", str(scenario), "--seconds", "0.01", "-o", "-"]) == 75
    seen = capsys.readouterr()
    row = json.loads(seen.out)
    assert row["failed"] == {"how": "time", "reason": "it took more than 0.01 seconds"} and row["passed"] is False
    assert "took too long: small --seed 0 --noise 0: it took more than 0.01 seconds" in seen.err


@pytest.mark.long
@pytest.mark.skipif(os.name == "nt", reason="Ctrl-C is sent in another way")
def test_an_interrupt_keeps_what_is_done_and_leaves_no_process(scenario: Path, tmp_path: Path) -> None:
    results = tmp_path / "results.jsonl"
    hear = "import signal, sys; signal.signal(signal.SIGINT, signal.default_int_handler)"  # a parent may ignore it
    code = f"{hear}; sys.path.insert(0, {str(ROOT)!r}); from utak.simulator.cli.main import main; sys.exit(main())"
    options = ["sweep", str(scenario), "--noise", "0.05", "--seeds", "0:500", "-o", str(results)]
    with subprocess.Popen([sys.executable, "-c", code, *options], stderr=subprocess.PIPE, text=True) as process:
        while not results.exists() or results.read_bytes().count(b"\n") < 1:
            assert process.poll() is None
            time.sleep(0.02)
        started = list(descendants_of(process.pid))
        process.send_signal(signal.SIGINT)
        errors = process.communicate()[1]
    done = len(rows(results))
    assert process.returncode == 130 and done >= 1
    assert f"utak: interrupted: {done} of 500 runs are done; the same command goes on from there\n" == errors
    assert started and still_there(started) == []


def test_no_temporary_folders_stay_after_a_request_to_end(scenario: Path, tmp_path: Path) -> None:
    place = tmp_path / "temporary"
    place.mkdir()
    environment = os.environ | {"PYTHONPATH": str(ROOT), "TMPDIR": str(place)}
    command = [sys.executable, "-m", "utak.simulator.cli", "sweep", str(scenario), "--seeds", "0:5000"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=environment) as sweep:
        while not list(place.glob("*/*/world.txt")) and sweep.poll() is None:
            time.sleep(0.01)
        sweep.send_signal(signal.SIGTERM)
        _, said = sweep.communicate()
    assert sweep.returncode == -signal.SIGTERM, said
    assert list(place.iterdir()) == []
