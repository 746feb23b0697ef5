"""The plugin of pytest: what it collects in a user's project, what it says of failures, and how it is switched off."""

import os
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]
EXERCISE = ROOT / "docs" / "exercises" / "01_change_the_goal"
QUIET = ("-p", "utak.pytest_plugin", "-p", "no:cacheprovider")


def project(pytester: pytest.Pytester) -> Path:
    """Return a user's project with a test of its own, an unsolved and a solved scenario, a broken one, and no more."""
    pytester.makepyfile(test_mine="def test_mine():\n    assert True\n")
    scenes = pytester.path / "scenes"
    shutil.copytree(EXERCISE, scenes / "unsolved")
    shutil.copytree(EXERCISE / "solution", shutil.copytree(EXERCISE, scenes / "solved"), dirs_exist_ok=True)
    (shutil.copytree(EXERCISE, scenes / "broken") / "world.txt").unlink()
    (pytester.path / "notes").mkdir()
    (pytester.path / "notes" / "expect.lp").write_text("no scenario lies beside this file\n")
    return scenes


def collected(pytester: pytest.Pytester, *arguments: str) -> list[str]:
    """Return the tests that pytest collects."""
    found = pytester.runpytest_inprocess(*QUIET, "--collect-only", "-q", *arguments)
    return [line for line in found.outlines if "::" in line]


def test_scenario_folders_are_collected_and_nothing_else(pytester: pytest.Pytester) -> None:
    project(pytester)
    scenes = [f"scenes/{name}/expect.lp::{name}" for name in ("broken", "solved", "unsolved")]
    assert collected(pytester) == [*scenes, "test_mine.py::test_mine"]
    assert collected(pytester, "scenes") == scenes
    assert collected(pytester, "scenes/solved") == scenes[1:2]
    assert collected(pytester, "-m", "utak", "--strict-markers") == scenes
    assert collected(pytester, "-k", "solved and not unsolved") == scenes[1:2]


def test_the_plugin_is_switched_off_in_three_ways(pytester: pytest.Pytester) -> None:
    project(pytester)
    mine = ["test_mine.py::test_mine"]
    assert collected(pytester, "--no-utak") == mine
    assert collected(pytester, "-p", "no:utak.pytest_plugin") == mine
    pytester.makeini("[pytest]\nutak_scenarios = false\n")
    assert collected(pytester) == mine


@pytest.mark.long
def test_reports_say_what_was_expected_what_came_and_how_to_repeat_it(
    pytester: pytest.Pytester, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PYTHONPATH", str(ROOT))
    project(pytester)
    junit = pytester.path / "junit.xml"
    found = pytester.runpytest_subprocess(*QUIET, "-W", "error", "--utak-seed", "3", f"--junitxml={junit}", "scenes")
    found.assert_outcomes(passed=1, failed=2)
    found.stdout.fnmatch_lines(
        [
            "*scenario broken*",
            "utak: *broken: cannot open: there is neither world.lp nor world.txt in it",
            "repeat it: utak test *broken --seed 3",
            "*scenario unsolved*",
            "the scenario did not end as expected, 0 of 6 points",
            "  NOT MET: inside(utak,*  (6 points)",
            "    what came: utak is at POINT (* at the end, * squares away from the region",
            "  met: verdict(done)  (0 points)",
            "the robot's verdict: done after 2 steps: at(utak,corner(northeast)) holds",
            "its last steps:",
            "  step 2: move(*",
            f"repeat it: utak test {Path('scenes', 'unsolved')} --seed 3",
            "FAILED scenes/broken/expect.lp::broken*",
        ]
    )
    found.stdout.no_fnmatch_line("*Traceback*")
    found.stdout.no_fnmatch_line("*pytest_plugin.py*")
    assert '<property name="points_earned" value="0" />' in junit.read_text()


@pytest.mark.parametrize("option", ["--utak-seed=-1", "--utak-noise=2", "--utak-noise=x", "--utak-noise=nan"])
def test_options_are_checked(option: str, pytester: pytest.Pytester) -> None:
    pytester.makepyfile("def test_mine():\n    assert True\n")
    found = pytester.runpytest_inprocess(*QUIET, option)
    assert found.ret == pytest.ExitCode.USAGE_ERROR


@pytest.mark.long
def test_an_installed_plugin_is_found_and_leaves_packages_of_the_users_alone(tmp_path: Path) -> None:
    """The folder `site` is as an installation leaves it; the project has packages under the names of ours."""
    site, here = tmp_path / "site", tmp_path / "here"
    entries = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["entry-points"]["pytest11"]
    information = site / "utak-0.dist-info"
    information.mkdir(parents=True)
    (information / "METADATA").write_text("Metadata-Version: 2.1\nName: utak\nVersion: 0\n")
    lines = [f"{name} = {module}" for name, module in entries.items()]
    (information / "entry_points.txt").write_text("\n".join(["[pytest11]", *lines, ""]))
    (site / "utak").mkdir()
    for part in (*(ROOT / "utak").iterdir(), *(ROOT / name for name in ("geometry", "kb", "planner", "simulator"))):
        (site / "utak" / part.name).symlink_to(part)
    shutil.copytree(EXERCISE / "solution", shutil.copytree(EXERCISE, here / "scene"), dirs_exist_ok=True)
    for name in ("planner", "simulator", "kb"):
        (here / name).mkdir()
        (here / name / "__init__.py").write_text("MINE = True\n")
    (here / "test_mine.py").write_text(
        "import sys\nimport kb, planner, simulator\n\n\ndef test_mine():\n"
        "    assert kb.MINE and planner.MINE and simulator.MINE\n"
        "    assert not {'numpy', 'shapely', 'clingo', 'numba', 'utak.geometry'} & set(sys.modules)\n"
    )
    environment = {name: value for name, value in os.environ.items() if not name.startswith("PYTEST")}
    command = [
        sys.executable,
        "-m",
        "pytest",
        "-q",
        "-p",
        "no:cacheprovider",
        "-p",
        "no:hypothesispytest",
        "-p",
        "no:xdist",
    ]
    done = subprocess.run(
        command, cwd=here, env=environment | {"PYTHONPATH": str(site)}, capture_output=True, text=True, check=False
    )
    assert "2 passed" in done.stdout, done.stdout + done.stderr
