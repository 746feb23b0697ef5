"""Work without the features that other operating systems lack; their modules are hidden here."""

import subprocess
import sys
from pathlib import Path

import pytest
from random_scenes import write_scene

from utak.kb.language import operating_system

ROOT = Path(__file__).resolve().parents[3]
HIDDEN = """
import os, sys
for name in {modules!r}:
    sys.modules[name] = None
for name in {names!r}:
    if hasattr(os, name):
        delattr(os, name)
import signal
for name in ("SIGHUP", "SIGALRM"):
    if hasattr(signal, name):
        delattr(signal, name)
sys.path.insert(0, {root!r})
{more}
"""
SYSTEMS = {
    "windows": (["resource", "fcntl", "readline", "termios", "pwd", "msvcrt"], ["O_NONBLOCK", "O_CLOEXEC", "getppid"]),
    "macos": (["msvcrt"], []),
}
NO_LIMITS = """
def refused(*_): raise ValueError("current limit exceeds maximum limit")
import resource; resource.setrlimit = refused
"""
MORE = {"windows": "", "macos": NO_LIMITS}


def hidden(system: str, code: str, *arguments: str) -> "subprocess.CompletedProcess[str]":
    """Run Python code with the modules and names hidden that a system lacks."""
    modules, names = SYSTEMS[system]
    before = HIDDEN.format(modules=modules, names=names, root=str(ROOT), more=MORE[system])
    command = [sys.executable, "-c", before + code, *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=False, input="?- node(X).\nquit\n")


UTAK = """
from tests_of import scripted_robot
scripted_robot.install()
from utak.simulator.cli.main import main
sys.exit(main(sys.argv[1:]))
""".replace("from tests_of import", f"sys.path.insert(0, {str(Path(__file__).parents[1])!r}); import")


@pytest.mark.long
@pytest.mark.parametrize("system", SYSTEMS)
def test_the_commands_work(system: str, tmp_path: Path) -> None:
    folder, log = str(write_scene(tmp_path / "s", 1)), str(tmp_path / "ep.jsonl")
    for command, code in (
        (["show", folder], 0),
        (["run", folder, "--log", log, "--max-steps", "3"], 75),
        (["run", folder, "--log", log, "--resume"], 75),
        (["query", log, "node(X)"], 0),
        (["repl", log], 0),
    ):
        done = hidden(system, UTAK, *command)
        assert done.returncode == code, done.stderr
        assert "bug" not in done.stderr


@pytest.mark.parametrize("system", SYSTEMS)
def test_a_worker_answers_without_limits(system: str) -> None:
    code = "from utak.kb.reasoning.query_worker import main; main()"
    request = '{"facts": [["node", "o1"]], "query": "node(X)", "rules": []}\n'
    modules, names = SYSTEMS[system]
    before = HIDDEN.format(modules=modules, names=names, root=str(ROOT), more=MORE[system])
    pipe = subprocess.PIPE
    with subprocess.Popen([sys.executable, "-c", before + code], stdin=pipe, stdout=pipe, text=True) as worker:
        assert worker.stdin is not None
        assert worker.stdout is not None
        assert worker.stdout.readline() == "ready\n"
        worker.stdin.write(request)
        worker.stdin.flush()
        assert '"rows": [["o1"]]' in worker.stdout.readline()
        worker.stdin.close()
        assert worker.wait(5) == 0


def test_missing_features_are_listed() -> None:
    code = "from utak.kb.language.operating_system import missing_features; print(*missing_features(), sep='\\n')"
    assert "memory of a question is not limited" in hidden("windows", code).stdout
    assert "not locked" in hidden("windows", code).stdout
    assert hidden("macos", code).stdout.strip() == ""


def test_nothing_is_missing_here() -> None:
    assert operating_system.missing_features() == []


def test_only_one_module_uses_features_that_some_systems_lack() -> None:
    for package in ("kb", "planner", "simulator", "geometry"):
        for path in sorted((ROOT / package).rglob("*.py")):
            if path.name == "operating_system.py":
                continue
            text = path.read_text()
            for name in ("import resource", "import fcntl", "import select", "O_NONBLOCK", "O_CLOEXEC", "SIGALRM"):
                assert name not in text, f"{path}: {name}"
