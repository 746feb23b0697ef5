"""The exercises: as they are given they earn nothing and do not pass; with their solutions they earn all."""

import re
import shutil
from pathlib import Path

import pytest

from utak.simulator.cli.main import main
from utak.simulator.run.trial import run_trial
from utak.simulator.scenario.untrusted import SCENARIO_FILES

EXERCISES = Path(__file__).resolve().parent.parent / "docs" / "exercises"
FOLDERS = sorted(path.parent for path in EXERCISES.glob("*/expect.lp"))


def test_there_are_twelve_exercises_at_three_levels() -> None:
    index = (EXERCISES / "README.md").read_text()
    assert [folder.name[:2] for folder in FOLDERS] == [f"{number:02}" for number in range(1, 13)]
    levels = []
    for folder in FOLDERS:
        row = next(line for line in index.splitlines() if f"({folder.name}/README.md)" in line)
        page = (folder / "README.md").read_text()
        title, level = re.findall(r"^# (.*)$", page, re.MULTILINE)[0], re.findall(r"^Level (\d)", page, re.MULTILINE)[0]
        assert f"| [{title}]" in row
        assert f"| {level} |" in row
        levels.append(int(level))
    assert levels == sorted(levels)
    assert set(levels) == {1, 2, 3}


def test_the_files_of_all_exercises_are_as_they_must_be(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", str(EXERCISES)]) == 0
    assert capsys.readouterr().out.count(": ok\n") == 12


@pytest.mark.parametrize("folder", FOLDERS, ids=lambda folder: folder.name)
def test_a_page_says_what_to_change_and_what_it_earns(folder: Path) -> None:
    page = (folder / "README.md").read_text()
    assert 10 <= len(page.splitlines()) <= 30
    changed = {path.name for path in (folder / "solution").iterdir()}
    assert changed <= {path.name for path in folder.iterdir()} & {*SCENARIO_FILES, "rules.lp"}
    assert changed.isdisjoint({"expect.lp", "trial.lp"})
    first = page.split("## The task")[0]
    assert changed <= set(re.findall(r"`([\w.]+)`", first))
    points = sum(int(n) for n in re.findall(r"\((\d+)(?: points?)?\)", page.split("## How it is checked")[1]))
    points += sum(int(n) for n in re.findall(r"earns (\d+)\.", page.split("## How it is checked")[1]))
    assert points == _possible(folder)


def _possible(folder: Path) -> int:
    """Return the points of an exercise, by the weights in its files; a question without one counts 1."""
    text = "".join((folder / name).read_text() for name in ("expect.lp", "trial.lp") if (folder / name).exists())
    text = re.sub(r"^\s*%.*$", "", text, flags=re.MULTILINE)
    asked = len(re.findall(r"^asks\(", text, re.MULTILINE))
    weighed = len(re.findall(r"^weight\(asks\(", text, re.MULTILINE))
    return sum(int(n) for n in re.findall(r"^weight\(.*, (\d+)\)\.$", text, re.MULTILINE)) + asked - weighed


@pytest.mark.long
@pytest.mark.parametrize("folder", FOLDERS, ids=lambda folder: folder.name)
def test_an_exercise_earns_all_points_when_it_is_solved_and_none_before(folder: Path, tmp_path: Path) -> None:
    given = run_trial(shutil.copytree(folder, tmp_path / "given"))
    assert not given.passed
    assert given.weighed
    assert given.score == (0, _possible(folder))
    solved = shutil.copytree(folder, tmp_path / "solved")
    shutil.copytree(folder / "solution", solved, dirs_exist_ok=True)
    trial = run_trial(solved)
    assert trial.passed, trial.faults
    assert trial.score == (trial.score.possible, _possible(folder))
