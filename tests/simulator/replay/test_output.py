"""Pages, moving pictures and text on the command line."""

import hashlib
import json
import os
import re
import subprocess
import sys
from base64 import b64encode
from contextlib import redirect_stderr, suppress
from pathlib import Path
from types import SimpleNamespace

import pytest
from replay_episodes import HOSTILE, ROOT, body_of, hostile

from utak.simulator.cli.main import main
from utak.simulator.episode.episode import Episode, encode
from utak.simulator.explaining.trees import trees_of_episode
from utak.simulator.replay.page import replay_page
from utak.simulator.replay.transcript import transcript
from utak.simulator.replay.watching import TableWatch
from utak.simulator.scenario.scenario import read_any_world as read_world
from utak.simulator.terminal.streams import GuardedStream


def write(folder: Path, episode: Episode) -> str:
    """Write an episode to a file and return its name."""
    path = folder / "written.jsonl"
    end = [] if episode.result is None else [{"result": episode.result}]
    path.write_text("".join(encode(line) for line in (episode.header, *episode.steps, *end)))
    return str(path)


@pytest.mark.long
def test_a_page_is_written_and_no_other_file_is_overwritten(
    carried: tuple[Path, Episode], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    page, other = tmp_path / "run.html", tmp_path / "notes"
    other.write_text("mine")
    assert main(["replay", str(carried[0]), "--html", str(page)]) == 0
    assert main(["replay", str(carried[0]), "--html", str(page)]) == 0
    written = replay_page(carried[1], trees_of_episode(carried[1]), name=carried[0].stem)
    assert page.read_text(encoding="utf-8") == written
    assert main(["replay", str(carried[0]), "--html", str(other)]) == 66
    assert (other.read_text(), capsys.readouterr().out) == ("mine", "")
    assert main(["replay", str(carried[0]), "--html", str(other), "--force"]) == 0
    assert other.read_text(encoding="utf-8") == written


@pytest.mark.long
def test_run_writes_the_page_that_its_log_gives(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    log, page, again = (tmp_path / name for name in ("go_to_square.jsonl", "a.html", "b.html"))
    scenario, certified = str(ROOT / "examples" / "go_to_square"), ["--certificate", str(tmp_path / "c.json")]
    for given in ([], certified):
        assert main(["run", scenario, "--log", str(log), "--html", str(page), *given]) == 0
        assert main(["replay", str(log), "--html", str(again), *given]) == 0
        assert page.read_text() == again.read_text()
    assert main(["replay", str(log), *certified]) == 2  # only pages give reasons
    assert main(["replay", str(log), "--html", str(again), "--certificate", str(log)]) == 65
    (tmp_path / "notes").write_text("mine")
    capsys.readouterr()
    assert main(["run", scenario, "--html", str(tmp_path / "notes")]) == 66
    assert capsys.readouterr().out == ""


def test_the_page_allows_just_its_own_script_and_style(carried: tuple[Path, Episode]) -> None:
    page = replay_page(carried[1])
    policy = re.search(r'Content-Security-Policy" content="([^"]*)"', page)
    loader = re.search(r"<script>(.*?)</script>", page, re.DOTALL)
    assert policy and loader
    assert policy[1].startswith("default-src 'none'; script-src 'sha256-")
    assert b64encode(hashlib.sha256(loader[1].encode()).digest()).decode() in policy[1]
    assert "unsafe" not in policy[1]
    assert re.findall(r"https?://|\bsrc=|\bhref=", page) == []


def test_no_text_of_an_episode_stands_in_the_page_as_it_is(carried: tuple[Path, Episode]) -> None:
    page = replay_page(hostile(carried[1]))
    assert HOSTILE[:20] not in page
    assert page.count("</script>") == 3
    assert "\x1b" not in page
    page.encode("utf-8")


def test_damaged_episodes_are_refused(
    carried: tuple[Path, Episode], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "no.jsonl"
    for text in ("", "{}\n", '{"utak":"episode","version":1}\n', "\x00\xff"):
        path.write_text(text)
        for form in (["--html", str(tmp_path / "x.html")], ["--text"], []):
            assert main(["replay", str(path), *form]) == 65
    assert main(["replay", str(tmp_path / "absent")]) == 66
    deep = Episode(carried[1].header, ({**carried[1].steps[0], "odd": json.loads("[" * 300 + "]" * 300)},), None)
    assert main(["replay", write(tmp_path, deep), "--html", str(tmp_path / "x.html")]) == 65
    assert "nested more than" in capsys.readouterr().err
    assert not (tmp_path / "x.html").exists()
    assert "Traceback" not in capsys.readouterr().err


def test_an_episode_that_was_cut_short_has_a_page(carried: tuple[Path, Episode], tmp_path: Path) -> None:
    cut = Episode(carried[1].header, carried[1].steps[:3], None)
    assert "cut short" not in body_of(replay_page(carried[1]))
    assert main(["replay", write(tmp_path, cut), "--html", str(tmp_path / "cut.html")]) == 0
    assert "cut short after step 2" in body_of((tmp_path / "cut.html").read_text())
    with pytest.raises(ValueError, match="without a step"):
        replay_page(Episode(cut.header, (), None))


def test_text_tells_actions_reasons_tables_and_changed_facts(
    carried: tuple[Path, Episode], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    episode = carried[1]
    assert main(["replay", str(carried[0]), "--text"]) == 0
    out = capsys.readouterr().out
    assert out.count("\nstep ") + 1 == len(episode.steps)
    assert out.startswith("step 0: wake: ")
    for number, (before, after) in enumerate(zip(episode.steps, episode.steps[1:], strict=False), 1):
        part = out.partition(f"\nstep {number}: ")[2].partition("\nstep ")[0]
        assert after["why"] in part
        come = sorted(set(after["belief"]["facts"]) - set(before["belief"]["facts"]))
        for fact in [fact for fact in come if not fact.startswith("segment(")][:10]:
            assert f"+ {fact}" in part or f"~ {fact}" in part or "more" in part
    bad = "".join(transcript("x", hostile(Episode(episode.header, episode.steps[:2], None))))
    assert not {"\x1b", "\u202e"} & set(bad)


def test_moving_pictures(carried: tuple[Path, Episode], tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    image = pytest.importorskip("PIL.Image")
    path = tmp_path / "run.gif"
    assert main(["replay", str(carried[0]), "--gif", str(path)]) == 0
    with image.open(path) as picture:
        assert picture.n_frames == len(carried[1].steps)
        assert picture.size[0] > picture.size[1] > 100
        frames = []
        for number in (0, picture.n_frames - 1):
            picture.seek(number)
            frames.append(picture.convert("RGB").tobytes())
    assert frames[0] != frames[1]
    from utak.simulator.replay.gif import animation

    assert animation(hostile(carried[1])).startswith(b"GIF89a")
    (tmp_path / "notes").write_text("mine")
    assert main(["replay", str(carried[0]), "--gif", str(tmp_path / "notes")]) == 66


def test_moving_pictures_without_pillow_say_what_is_missing(carried: tuple[Path, Episode], tmp_path: Path) -> None:
    """Pillow is hidden from a process of its own."""
    program = (
        "import sys; sys.modules['PIL'] = None; sys.path.insert(0, sys.argv[1])\n"
        "from utak.simulator.cli.main import main; sys.exit(main(sys.argv[2:]))"
    )
    path = tmp_path / "run.gif"
    command = [sys.executable, "-c", program, str(ROOT), "replay", str(carried[0]), "--gif", str(path)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=600, check=False)
    assert (done.returncode, done.stdout) == (66, "")
    assert "pip install pillow" in done.stderr
    assert not path.exists()


@pytest.mark.skipif(sys.platform == "win32", reason="pseudo terminals are of Unix")
@pytest.mark.parametrize(("rows", "columns", "in_place"), [(60, 100, True), (10, 100, False), (60, 30, False)])
def test_watch_draws_in_place_where_the_table_has_room(
    monkeypatch: pytest.MonkeyPatch, rows: int, columns: int, in_place: bool
) -> None:
    import fcntl
    import pty
    import struct
    import termios

    ours, terminal = pty.openpty()
    fcntl.ioctl(terminal, termios.TIOCSWINSZ, struct.pack("HHHH", rows, columns, 0, 0))
    monkeypatch.setenv("TERM", "xterm")
    watch = TableWatch()
    table = SimpleNamespace(now=read_world(ROOT / "examples" / "go_to_square").moved({}, (5.5, 5.5)))
    with os.fdopen(terminal, "w") as stream, redirect_stderr(GuardedStream(stream, "the terminal", False)):
        for number in (0, 1, 1, 2):
            line = {"step": number, "action": None, "why": "because " * 20 + "\x1b[2J"}
            watch.tell(SimpleNamespace(line=line, table=table))
    parts = []
    with suppress(OSError):  # the end of what a terminal that was closed has
        while part := os.read(ours, 4096):
            parts.append(part)
    os.close(ours)
    seen = b"".join(parts).decode()
    height = table.now.height + 2
    assert seen.count("the true table") == 3
    assert seen.count(f"\x1b[{height}F\x1b[J") == (2 if in_place else 0)
    assert "\x1b[2J" not in seen
    assert not in_place or max(map(len, seen.splitlines())) < columns + 8


def test_every_part_of_the_page_is_in_the_package() -> None:
    """The parts lie within a package, which hatchling takes as a whole; `.ci/run` tries the built wheel."""
    from importlib.resources import files

    parts = files("utak.simulator.replay") / "page_parts"
    assert {part.name for part in parts.iterdir()} >= {"page.html", "body.html", "style.css", "player.js", "episode.js"}
    assert all(part.read_text(encoding="utf-8") for part in parts.iterdir())
