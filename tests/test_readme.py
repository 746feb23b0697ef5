"""What README promises is there: links, commands, and the example of a first task."""

import re
from pathlib import Path

import pytest

from simulator.cli import main
from simulator.scenario import read_scenario

ROOT = Path(__file__).resolve().parent.parent
README = (ROOT / "README.md").read_text()
PAGES = ["README.md", *(f"docs/{page.name}" for page in sorted((ROOT / "docs").glob("*.md")))]


@pytest.mark.parametrize("page", PAGES)
def test_links_lead_somewhere(page: str) -> None:
    path = ROOT / page
    for link in re.findall(r"\]\(([^)#:\s]+)\)", path.read_text()):
        assert (path.parent / link).exists(), link


def test_there_are_two_commands_each_one_line() -> None:
    commands = re.findall(r"^```sh\n(.*?)\n```$", README, re.MULTILINE | re.DOTALL)
    assert len(commands) == 2
    assert not any("\n" in command for command in commands)
    assert "utak run examples/go_northeast" in commands[0]
    assert "pytest" in commands[1]


def test_every_command_named_exists() -> None:
    named = set(re.findall(r"^\$ utak (\w+)", README, re.MULTILINE)) | set(re.findall(r"`utak (\w+)", README))
    assert {"run", "new", "show", "test", "check", "query", "repl", "routes"} <= named
    for command in sorted(named):
        assert main([command, "--help"]) == 0, command


def test_modules_named_by_the_docs_exist() -> None:
    text = (ROOT / "docs" / "architecture.md").read_text()
    for package, module in re.findall(r"\b(geometry|kb|planner|simulator)\.([a-z_]+)\b", text):
        assert (ROOT / package / f"{module}.py").exists(), f"{package}.{module}"
    for path in re.findall(r"\b(?:kb|planner)/asp/\w+\.lp", text):
        assert (ROOT / path).exists(), path


def test_the_first_task_can_be_read(tmp_path: Path) -> None:
    drawn = re.search(r"```text\n(b{16}.*?)```", README, re.DOTALL)
    facts = re.search(r"```prolog\n(.*?)```", README, re.DOTALL)
    assert drawn is not None
    assert facts is not None
    (tmp_path / "world.txt").write_text("".join(f"{line[:16]}\n" for line in drawn[1].splitlines()))
    for line in facts[1].splitlines():
        text, name = line.rsplit("%", 1)
        (tmp_path / name.strip()).write_text(text + "\n")
    scenario = read_scenario(tmp_path)
    assert [str(goal) for goal in scenario.task.goals] == ["at(utak,x)"]
    assert main(["run", str(tmp_path)]) == 0
