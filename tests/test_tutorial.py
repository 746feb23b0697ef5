"""The tutorial as it is typed: every command works, and prints what stands below it."""

import io
import re
import shlex
import shutil
from pathlib import Path

import pytest

from utak.simulator.cli.main import main

ROOT = Path(__file__).resolve().parent.parent
TUTORIAL = (ROOT / "docs" / "tutorial.md").read_text()


def blocks(kind: str) -> list[str]:
    """The fenced blocks of a kind."""
    return re.findall(rf"^```{kind}\n(.*?)^```$", TUTORIAL, re.MULTILINE | re.DOTALL)


@pytest.mark.long
def test_the_commands_print_what_stands_below_them(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    shutil.copytree(ROOT / "examples" / "push_l_tight_door", "examples/push_l_tight_door")
    *typed, prompt = blocks("text")
    for block in typed:
        for part in re.split(r"^\$ utak ", block, flags=re.MULTILINE)[1:]:
            command, _, printed = part.partition("\n")
            assert main(shlex.split(command)) == 0, command
            assert not printed or capsys.readouterr().out == printed
            capsys.readouterr()
        if "utak new mine" in block:
            for line in blocks("prolog")[0].splitlines():
                text, name = line.rsplit("%", 1)
                (Path("mine") / name.strip()).write_text(text + "\n")
    monkeypatch.setattr("sys.stdin", io.TextIOWrapper(io.BytesIO(prompt.encode())))
    assert main(["repl", "mine"]) == 0
    said = capsys.readouterr()
    assert "verdict(done)" in said.out
    assert "error" not in said.out + said.err
