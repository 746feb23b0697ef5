"""What README promises is there: links, commands, and the example of a first task."""

import importlib.util
import io
import re
import shlex
from pathlib import Path

import pytest

from utak.simulator.cli.main import main

ROOT = Path(__file__).resolve().parent.parent
README = (ROOT / "README.md").read_text()


def test_there_are_two_commands_each_one_line() -> None:
    commands = re.findall(r"^```sh\n(.*?)\n```$", README, re.MULTILINE | re.DOTALL)
    assert len(commands) == 2
    assert not any("\n" in command for command in commands)
    assert "utak run examples/go_northeast" in commands[0]
    assert "pytest" in commands[1]


def test_every_command_named_exists() -> None:
    named = set(re.findall(r"^\$ utak (\w+)", README, re.MULTILINE)) | set(re.findall(r"`utak (\w+)", README))
    assert {
        "run",
        "new",
        "show",
        "test",
        "check",
        "query",
        "repl",
        "explain",
        "replay",
        "sweep",
        "routes",
        "warm",
    } <= named
    for command in sorted(named):
        assert main([command, "--help"]) == 0, command


def fences(kind: str) -> list[str]:
    """The blocks of one kind in README."""
    return re.findall(rf"^```{kind}\n(.*?)^```$", README, re.MULTILINE | re.DOTALL)


def write_facts(folder: Path, block: str) -> None:
    """Write each line of a block into the file that its comment names."""
    for line in block.splitlines():
        text, name = line.rsplit("%", 1)
        (folder / name.strip()).write_text(text + "\n")


def typed(block: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    """Type every command of a block; what stands below one is what it prints."""
    for part in re.split(r"^\$ utak ", block, flags=re.MULTILINE)[1:]:
        command, _, printed = part.partition("\n")
        monkeypatch.setattr("sys.stdin", io.TextIOWrapper(io.BytesIO(b"help\nstep\n?- shape(X, square, C).\nquit\n")))
        code = main(shlex.split(command, comments=True))
        seen = capsys.readouterr()
        if printed:
            said = [line for line in seen.err.splitlines(keepends=True) if "compil" not in line]  # of a first run
            assert seen.out + "".join(said) == printed
        assert code == (65 if "error:" in printed else 0), command


def test_the_first_task_as_it_is_typed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    begin, first_world, second_world, change, wrong = fences("text")
    first_facts, second_facts = fences("prolog")
    folder = Path("mytask")
    typed(begin, capsys, monkeypatch)
    assert (folder / "world.txt").read_text() == first_world
    written = [(folder / name).read_text() for name in ("start.lp", "goal.lp", "expect.lp")]
    facts = ["".join(re.sub(r"%.*", "", text).split()) for text in written]
    assert facts == ["".join(line.rpartition("%")[0].split()) for line in first_facts.splitlines()]
    (folder / "world.txt").write_text(second_world)
    write_facts(folder, second_facts)
    typed(change, capsys, monkeypatch)
    (folder / "goal.lp").write_text("at(utak, cornr(northeast)).\n")
    typed(wrong, capsys, monkeypatch)


@pytest.mark.long
def test_the_picture_is_of_this_robot(tmp_path: Path) -> None:
    """docs/run.svg, which README shows, is what docs/build_picture.py makes of a run of today's robot."""
    spec = importlib.util.spec_from_file_location("build_picture", ROOT / "docs" / "build_picture.py")
    assert spec is not None
    assert spec.loader is not None
    build = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(build)
    path = tmp_path / "run.jsonl"
    assert main(["run", str(ROOT / "examples" / "go_to_square_unseen"), "--log", str(path)]) == 0
    drawn = tmp_path / "run.svg"
    build.main([str(path), "-o", str(drawn)])
    stale = "docs/run.svg is stale: the first lines of docs/build_picture.py say how to make it again"
    assert drawn.read_text() == (ROOT / "docs" / "run.svg").read_text(), stale


def test_it_says_how_the_command_is_called() -> None:
    assert ". .venv/bin/activate" in README
    assert README.index(". .venv/bin/activate") < README.index("$ utak ")
