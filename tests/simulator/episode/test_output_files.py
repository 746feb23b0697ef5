"""Files that are written: no file of another kind is overwritten, and no two runs write to one file."""

import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
import scripted_robot
from random_scenes import write_scene

from utak.kb.language.diagnostics import CannotOpenError
from utak.simulator.cli.main import main
from utak.simulator.episode.episode import EpisodeLog, read_episode
from utak.simulator.episode.output_files import is_episode, is_junit, is_svg, write_whole
from utak.simulator.replay.page import is_page

ROOT = Path(__file__).resolve().parents[3]


@pytest.fixture
def scene(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return a scenario that the scripted robot will run."""
    monkeypatch.setitem(sys.modules, "utak.planner.cycle", sys.modules.get("utak.planner.cycle"))
    scripted_robot.install()
    return write_scene(tmp_path / "scene", 1)


OTHERS = {
    "goal.lp": b"at(utak, start).\n",
    "notes.json": b'{"a": 1}\n',
    "diary": b"my diary",
    "binary": bytes(range(256)),
    "like": b'{"utak": "query"}\n',
}


@pytest.mark.parametrize("name", OTHERS)
@pytest.mark.parametrize("more", [[], ["--resume"]])
def test_a_log_overwrites_nothing_but_an_episode(name: str, more: list[str], scene: Path, tmp_path: Path) -> None:
    path = tmp_path / name
    path.write_bytes(OTHERS[name])
    assert main(["run", str(scene), "--log", str(path), *more]) in (65, 66)
    assert path.read_bytes() == OTHERS[name]
    assert main(["run", str(scene), "--log", str(path), "--force"]) == 75
    assert read_episode(path).result is not None


def test_an_episode_or_an_empty_file_is_overwritten(scene: Path, tmp_path: Path) -> None:
    path = tmp_path / "ep.jsonl"
    path.write_text("")
    for steps in (5, 2):
        assert main(["run", str(scene), "--log", str(path), "--max-steps", str(steps)]) == 75
        assert len(read_episode(path).steps) == steps + 1
    path.write_bytes(path.read_bytes()[:9])  # a run that was killed while it wrote its first line
    assert main(["run", str(scene), "--log", str(path)]) == 75


def test_a_second_run_on_one_log_is_refused(scene: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "ep.jsonl"
    with EpisodeLog(path) as log:
        log.write({"utak": "episode", "version": 1})
        before = path.read_bytes()
        for more in ([], ["--resume", "--seed", "0"], ["--force"]):
            assert main(["run", str(scene), "--log", str(path), *more]) in (65, 66), more
        assert path.read_bytes() == before
    assert "another process is writing to it" in capsys.readouterr().err
    assert main(["run", str(scene), "--log", str(path)]) == 75


def test_two_processes_cannot_write_to_one_log(scene: Path, tmp_path: Path) -> None:
    command = [sys.executable, scripted_robot.__file__, "run", str(scene), "--log", str(tmp_path / "ep.jsonl")]
    environment = os.environ | {"PYTHONPATH": str(ROOT), "SCRIPTED_PAUSE": "0.02"}
    pipe = subprocess.PIPE
    runs = [subprocess.Popen(command, env=environment, stdout=pipe, stderr=pipe, text=True) for _ in range(2)]
    said = "".join(run.communicate()[1] for run in runs)
    assert sorted(run.returncode for run in runs) == [66, 75], said
    assert "another process is writing to it" in said
    assert read_episode(tmp_path / "ep.jsonl").result is not None


def test_a_missing_episode_cannot_be_resumed(scene: Path, tmp_path: Path) -> None:
    path = tmp_path / "absent.jsonl"
    assert main(["run", str(scene), "--log", str(path), "--resume"]) == 66
    assert not path.exists()


def test_a_dash_is_the_standard_output(
    scene: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    main(["run", str(scene), "--log", "ep.jsonl"])
    capsys.readouterr()
    assert main(["run", str(scene), "--log", "-", "--json"]) == 75
    seen = capsys.readouterr()
    assert seen.out == Path("ep.jsonl").read_text()
    assert json.loads(seen.err)["verdict"] == "limit"
    assert not Path("-").exists()
    assert main(["run", str(scene), "--log", "-", "--resume"]) == 2


def test_a_pipe_or_device_is_written_directly(scene: Path) -> None:
    assert main(["run", str(scene), "--log", os.devnull]) == 75


def test_a_picture_overwrites_nothing_but_a_picture(tmp_path: Path) -> None:
    path = tmp_path / "a.map"
    path.write_text("type octile\nheight 2\nwidth 3\nmap\n...\n...\n")
    ways = ["routes", str(path), "--from", "0.5,0.5", "--to", "2.5,0.5"]
    before = path.read_text()
    assert main([*ways, "--svg", str(path)]) == 66
    assert path.read_text() == before
    picture = tmp_path / "out.svg"
    for _ in range(2):
        assert main([*ways, "--svg", str(picture)]) == 0
        assert is_svg(picture.read_bytes())
        picture.write_text('<?xml version="1.0"?>\n<!-- old -->\n<svg/>' + " " * 100_000)
    (tmp_path / "notes").write_text("mine")
    assert main([*ways, "--svg", str(tmp_path / "notes")]) == 66
    assert main([*ways, "--svg", str(tmp_path / "notes"), "--force"]) == 0
    assert is_svg((tmp_path / "notes").read_bytes())


def test_a_file_that_cannot_be_written_is_reported(tmp_path: Path) -> None:
    for path in (tmp_path, tmp_path / "no" / "file", "/dev/full"):
        with pytest.raises(CannotOpenError):
            write_whole(path, b"x" * 9, is_svg, "picture")
    assert is_episode(b'{"utak": "episode", "version": 1')


@pytest.mark.parametrize(
    ("start", "end"), [(b"<!-- a -->\n", b"-->"), (b"<!---->", b""), (b"<!-->-->", b"<"), (b" ", b"")]
)
@pytest.mark.parametrize("tell", [is_page, is_svg, is_junit])
def test_the_kind_of_a_file_is_told_in_linear_time(tell: Callable[[bytes], bool], start: bytes, end: bytes) -> None:
    """Sixty comments took a regular expression longer than anybody waits: this test ends, or it hangs."""
    assert not tell((start * 400)[:4000] + end)
    assert tell((start * 60) + {is_page: b"<html>", is_svg: b"<svg>", is_junit: b"<testsuites>"}[tell])


def test_what_is_written_at_once_is_there_whole_or_not_at_all(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "a.svg"

    def fail(_: int) -> None:
        raise OSError(28, "No space left on device")

    for old in (None, b"<svg/>"):
        if old is not None:
            path.write_bytes(old)
        with monkeypatch.context() as full:
            full.setattr(os, "fsync", fail)
            with pytest.raises(CannotOpenError, match="No space left"):
                write_whole(path, b"<svg>new</svg>", is_svg, "picture")
        assert [one.read_bytes() for one in tmp_path.iterdir()] == ([] if old is None else [old])
    path.chmod(0o640)
    link = tmp_path / "link"
    link.symlink_to(path)
    write_whole(link, b"<svg>new</svg>", is_svg, "picture")
    assert path.read_bytes() == b"<svg>new</svg>" and path.stat().st_mode & 0o777 == 0o640 and link.is_symlink()


def test_a_refused_run_leaves_no_files_and_keeps_old_ones(scene: Path, tmp_path: Path) -> None:
    rules = tmp_path / "rules.lp"
    rules.write_text("this is no rule")
    page, log, dump = (tmp_path / "out" / name for name in ("page.html", "ep.jsonl", "asp"))
    page.parent.mkdir()
    options = ["run", str(scene), "--kb", str(rules), "--html", str(page), "--log", str(log), "--dump-asp", str(dump)]
    assert main(options) == 65
    assert list(page.parent.iterdir()) == []
    page.write_text("<html>old")
    assert main(["run", str(scene), "--log", str(log), "--max-steps", "2"]) == 75
    before = log.read_bytes()
    assert main(options) == 65
    assert (page.read_text(), log.read_bytes()) == ("<html>old", before)


def test_a_new_scenario_is_written_whole_or_not_at_all(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write, calls = Path.write_text, []

    def fail(self: Path, *args: object, **options: object) -> int:
        calls.append(self)
        if len(calls) > 2:
            raise OSError(28, "No space left on device")
        return write(self, *args, **options)  # type: ignore[arg-type]

    monkeypatch.setattr(Path, "write_text", fail)
    assert main(["new", str(tmp_path / "a" / "b")]) == 66
    assert len(calls) == 3 and list(tmp_path.iterdir()) == []
