"""The command line: exit codes, streams and errors."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
import scripted_robot
from random_scenes import write_scene

from utak.planner.navigation.walks import SINGLE_PATH_FINDERS
from utak.simulator.cli.main import main
from utak.simulator.scenario.settings import PATH_CHOICES

ROOT = Path(__file__).resolve().parents[3]


@pytest.fixture
def scene(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return a scenario that the scripted robot will run."""
    monkeypatch.setitem(sys.modules, "utak.planner.cycle", sys.modules.get("utak.planner.cycle"))
    scripted_robot.install()
    return write_scene(tmp_path / "scene", 1)


def test_run_prints_one_result(scene: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", str(scene)]) == 75
    assert capsys.readouterr().out == "limit in 30 steps, not achieved: the script has ended\n"
    assert main(["run", str(scene), "--json", "--max-steps", "3"]) == 75
    result = json.loads(capsys.readouterr().out)
    assert (result["verdict"], result["achieved"], result["steps"]) == ("limit", False, 3)


def test_watch_draws_on_stderr(scene: Path, capsys: pytest.CaptureFixture[str]) -> None:
    main(["run", str(scene), "--watch", "--max-steps", "2"])
    seen = capsys.readouterr()
    assert seen.out.count("\n") == 1
    assert seen.err.count("U") == 3
    assert "step 2: " in seen.err


@pytest.mark.parametrize(
    "arguments",
    [
        [],
        ["fly"],
        ["run"],
        ["run", "x", "--noise", "2"],
        ["run", "x", "--seed", "-1"],
        ["run", "x", "--paths", "magic"],
    ],
)
def test_usage(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(arguments) == 2
    assert capsys.readouterr().err.startswith("usage:")


def test_help_is_no_error(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--help"]) == 0
    assert "exit codes" in capsys.readouterr().out


def test_bad_input_and_what_cannot_be_opened(scene: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", str(scene / "none")]) == 66
    assert main(["run", str(scene), "--kb", str(scene)]) == 66
    assert main(["run", str(scene), "--log", str(scene / "no" / "ep.jsonl")]) == 66
    assert main(["run", str(scene), "--log", str(scene)]) == 66
    assert main(["run", str(scene), "--log", "/dev/full"]) == 66
    assert main(["run", str(scene), "--resume"]) == 2
    (scene / "goal.lp").write_text("at(utak, x).")
    (scene / "world.lp").write_text("table(4, 4)")
    assert main(["check", str(scene)]) == 65
    err = capsys.readouterr().err
    assert "world.lp:1:11-11: error: a full stop was expected" in err
    assert "goal.lp:1:10-10: error: x is not introduced in start.lp" in err


def test_check_knows_files_by_their_names(scene: Path, capsys: pytest.CaptureFixture[str]) -> None:
    files = [str(scene / name) for name in ("world.lp", "start.lp", "goal.lp", "expect.lp")]
    assert main(["check", str(scene), *files]) == 0
    assert capsys.readouterr().out.count(": ok\n") == 5
    assert main(["check", str(scene.parent)]) == 0
    assert capsys.readouterr().out == f"{scene}: ok\n"
    (scene / "more.lp").write_text("")
    assert main(["check", str(scene / "more.lp")]) == 65
    assert main(["check", str(scene / "goal.txt")]) == 66


def test_a_bug_gives_a_message_and_no_traceback(
    scene: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(scripted_robot.Robot, "step", lambda self: 1 // 0)
    assert main(["run", str(scene)]) == 70
    err = capsys.readouterr().err
    assert "a bug of ours: ZeroDivisionError" in err
    assert "Traceback" not in err
    monkeypatch.setenv("UTAK_DEBUG", "1")
    with pytest.raises(ZeroDivisionError):
        main(["run", str(scene)])


def test_interrupted(scene: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    def interrupt(self: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(scripted_robot.Robot, "step", interrupt)
    assert main(["run", str(scene)]) == 130


def test_show_ends_quietly_when_its_reader_ends(scene: Path) -> None:
    command = f"{sys.executable} -m utak.simulator.cli show {scene} | true"
    done = subprocess.run(["bash", "-c", command], cwd=ROOT, capture_output=True, check=False)
    assert b"Traceback" not in done.stderr
    assert b"Broken" not in done.stderr


def test_help_imports_nothing_heavy() -> None:
    code = (
        "import sys; from utak.simulator.cli.main import main; main(['--help']); print(*sys.modules, file=sys.stderr)"
    )
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    heavy = {"numpy", "shapely", "clingo", "networkx", "numba", "multiprocessing", "difflib", "utak.geometry"}
    assert not heavy & set(done.stderr.split())


def test_installed_name_and_environment() -> None:
    done = subprocess.run(
        [sys.executable, "-m", "utak.simulator.cli", "--help"],
        cwd=ROOT,
        env=os.environ | {"NO_COLOR": "1"},
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.startswith("usage: utak")


def test_the_command_line_offers_every_path_finder_of_the_planner() -> None:
    assert set(PATH_CHOICES) == {"skeleton", *SINGLE_PATH_FINDERS}
