"""Broken streams, strange locales and control characters: one line of message, the right code, safe output."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
import scripted_robot
from hypothesis import given
from hypothesis import strategies as st
from random_scenes import write_scene

from utak.simulator.cli.main import main
from utak.simulator.terminal.streams import GuardedStream, StreamError, escape_controls, one_line

ROOT = Path(__file__).resolve().parents[3]
HOSTILE = "\x1b[2J\x1b]0;owned\x07\r\x9b31m\u202egnp.exe\u2066\x7f\b\u2028"
OBEYED = re.compile("[\x00-\x09\x0b-\x1f\x7f-\x9f\u202a-\u202e\u2066-\u2069\u2028]")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with an umlaut in its name, a scenario, a bad scenario and an episode."""
    place = tmp_path_factory.mktemp("m\u00f6bel")
    write_scene(place / "scene", 1)
    write_scene(place / "bad", 1)
    (place / "bad" / "goal.lp").write_text("at(utak, corner(northeast).\n")
    done = utak("run scene --log ep.jsonl", place)
    assert done.returncode == 75, done.stderr
    return place


def utak(
    arguments: str, place: Path, redirect: str = "", *, stdin: str = "", **environment: str
) -> "subprocess.CompletedProcess[bytes]":
    """Run `utak` with the scripted robot and its streams redirected by the shell."""
    command = f"{sys.executable} {scripted_robot.__file__} {arguments} {redirect}"
    env = os.environ | {"PYTHONPATH": str(ROOT)} | environment
    return subprocess.run(["bash", "-c", command], cwd=place, env=env, input=stdin.encode(), capture_output=True)


QUIET = ["show scene", "check scene", "query ep.jsonl 'node(X)'", "run scene --max-steps 2", "repl ep.jsonl", "--help"]
CASES = [
    *((command, ">/dev/full", 74) for command in QUIET),
    *((command, ">&-", 74) for command in QUIET[:2]),
    ("show scene", "| true", 0),
    ("run scene --log - --max-steps 9", ">/dev/full", 74),
    ("check bad", ">/dev/full", 65),
    ("check bad", "2>/dev/full", 65),
    ("check bad", "2>&-", 65),
    ("run scene --watch --max-steps 2", "2>/dev/full", 75),
    ("show scene --plain", "2>/dev/full", 74),  # the message about the heading was lost
    ("check scene", "2>/dev/full", 0),
    ("show scene", "2>&- <&-", 0),
    ("repl ep.jsonl", "<&-", 74),
    ("repl ep.jsonl", "0>/dev/null", 74),
    ("fly", "2>/dev/full", 2),
]


@pytest.mark.long
@pytest.mark.parametrize(("command", "redirect", "code"), CASES)
def test_a_broken_stream_gives_a_message_of_one_line(command: str, redirect: str, code: int, folder: Path) -> None:
    done = utak(command, folder, redirect, stdin="help\n")
    said = done.stderr.decode()
    assert done.returncode == code, said
    assert "Traceback" not in said
    assert "bug" not in said
    assert "Exception ignored" not in said
    if code == 74 and "2>" not in redirect:
        assert said.count("\n") == 1 + ("fewer" in said), said
        assert "the standard " in said


def test_no_file_takes_the_place_of_a_closed_stream(folder: Path) -> None:
    assert utak("run scene --log other.jsonl --max-steps 3", folder, ">&- 2>&- <&-").returncode == 74
    assert all(json.loads(line) for line in (folder / "other.jsonl").read_text().splitlines())


def test_a_command_ends_quietly_when_its_reader_ends(folder: Path) -> None:
    done = utak("repl ep.jsonl", folder, "| true; exit ${PIPESTATUS[0]}", stdin="help\nfacts\nshow\n" * 9000)
    assert done.returncode in (0, 141)
    assert done.stderr == b""


ASCII = {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}


@pytest.mark.long
@pytest.mark.parametrize("environment", [ASCII, {"PYTHONIOENCODING": "ascii"}])
@pytest.mark.parametrize(
    ("command", "code"),
    [("check {}/scene {}/bad {}/none", 66), ("run {}/scene --log {}/a.jsonl", 75)],
)
def test_an_umlaut_in_a_name_is_no_bug(command: str, code: int, environment: dict[str, str], folder: Path) -> None:
    done = utak(command.replace("{}", f"'{folder}'"), folder, **environment)
    assert done.returncode == code, done.stderr
    assert b"bug" not in done.stderr


@given(st.text())
def test_escaped_text_has_no_control_characters_and_stays_json(text: str) -> None:
    assert not OBEYED.search(escape_controls(text))
    assert escape_controls(json.dumps(text)) == json.dumps(text).replace("\x7f", "\\u007f")
    assert json.loads(escape_controls(json.dumps(text))) == text
    assert "\n" not in one_line(text)


def test_a_closed_vital_stream_raises_and_another_is_noted() -> None:
    with pytest.raises(StreamError, match="standard output cannot be written: it is closed"):
        GuardedStream(None, "the standard output", True).write("x")
    note = GuardedStream(None, "the standard error", False)
    note.write("x")
    assert note.lost == ""
    with Path("/dev/full").open("w", buffering=1) as full:
        note = GuardedStream(full, "the standard error", False)
        note.write("x\n")
    assert note.lost == "No space left on device"


def hostile_episode(folder: Path) -> Path:
    """Return an episode with control characters in every text."""
    rows = [json.loads(line) for line in (folder / "ep.jsonl").read_text().splitlines()]
    for row in rows[1:-1]:
        row["why"] = HOSTILE + "\ndone after 3 steps: spoofed"
    rows[-1]["result"]["reason"] = HOSTILE
    path = folder / "hostile.jsonl"
    path.write_text("".join(json.dumps(row) + "\n" for row in rows))
    return path


def test_control_characters_in_an_episode_are_escaped(folder: Path) -> None:
    done = utak(f"repl {hostile_episode(folder)}", folder, stdin=f"step\nrun\nshow\nfacts\n{HOSTILE}\n?- {HOSTILE}\n")
    text = done.stdout.decode()
    assert done.returncode == 0
    assert not OBEYED.search(text)
    assert "\\u001b[2J" in text
    assert not [line for line in text.splitlines() if line.startswith("done after")]


def test_control_characters_on_the_command_line_are_escaped(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    (tmp_path / "goal.lp").write_bytes(HOSTILE.encode())
    for command in (["fly" + HOSTILE], ["show", HOSTILE], ["check", str(tmp_path)], ["run", "x", "--seed", HOSTILE]):
        assert main(command) in (2, 65, 66)
        seen = capsys.readouterr()
        assert not OBEYED.search(seen.err + seen.out)
