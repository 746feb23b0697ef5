"""Isolation of our processes: no file of a user is executed as a module, and child processes end with their parent."""

import json
import os
import re
import signal
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path

import pytest

from utak.launcher import isolated_command

ROOT = Path(__file__).resolve().parents[2]
UTAK = [
    sys.executable,
    "-c",
    f"import sys; sys.path[0] = {str(ROOT)!r}; from utak.launcher import main; sys.exit(main())",
]
BAIT = (
    "json", "clingo", "resource", "numpy", "shapely", "numba", "networkx", "queue", "threading", "ctypes", "select",
    "subprocess", "runpy", "sitecustomize", "usercustomize", "readline", "cffi", "llvmlite", "difflib", "fcntl",
)  # fmt: skip
PACKAGES = ("kb", "planner", "geometry", "simulator", "utak")
WORLD = "bbbbbbbb\nb......b\nb.gg...b\nb.gg.U.b\nb......b\nbbbbbbbb\n"
FILES = {
    "world.txt": WORLD,
    "start.lp": "object(x).\n",
    "goal.lp": "at(utak, x).\n",
    "expect.lp": "within(50).\n",
    "rules.lp": "kind(R, verge, 60) :- region(R, nonzero, _), extent(R, N), N > 2000.\n",
}
COMMANDS = {
    "run": ["run", ".", "--kb", "rules.lp", "--max-steps", "1"],
    "test": ["test", ".", "--max-steps", "1"],
    "check": ["check", "."],
    "show": ["show", "."],
    "new": ["new", "fresh"],
    "query": ["query", ".", "object(X)", "--at", "0"],
    "repl": ["repl", "."],
    "routes": ["routes", ".", "--from", "1.5,1.5", "--to", "6.5,4.5", "--svg", "out.svg"],
    "warming": [],
}


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Return a scenario in a folder with modules that record their own execution."""
    place = tmp_path / "here"
    for name in PACKAGES:
        (place / name).mkdir(parents=True)
        (place / name / "__init__.py").write_text(executed(tmp_path))
    for name in BAIT:
        (place / f"{name}.py").write_text(executed(tmp_path))
    for name, text in FILES.items():
        (place / name).write_text(text)
    return place


def executed(place: Path) -> str:
    """Return the source of a module that writes its name into a file and exits."""
    return f"open({str(place / 'executed')!r}, 'a').write(__name__ + '\\n')\nraise SystemExit(99)\n"


def cold_cache(place: Path) -> dict[str, str]:
    """Return an environment without compiled kernels, in which a second process compiles them."""
    return {"NUMBA_CACHE_DIR": str(place / "cache")}


@pytest.mark.long
@pytest.mark.parametrize("command", COMMANDS)
def test_nothing_in_the_working_directory_is_executed(command: str, folder: Path) -> None:
    arguments = UTAK + COMMANDS[command] if command != "warming" else isolated_command("utak.simulator.run.warming")
    environment = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
    environment["PYTHONSTARTUP"] = str(folder / "json.py")
    done = subprocess.run(
        arguments, cwd=folder, env=environment, input=b"?- object(X).\n", capture_output=True, check=False
    )
    assert not (folder.parent / "executed").exists(), (folder.parent / "executed").read_text()
    assert done.returncode in (0, 1, 75), done.stderr.decode()


@pytest.mark.long
def test_users_packages_on_the_path_are_not_executed(folder: Path) -> None:
    for name in BAIT:
        (folder / f"{name}.py").unlink()
    environment = os.environ | {"PYTHONPATH": str(folder)}
    command = [*UTAK, *COMMANDS["run"]]
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, check=False)
    assert not (folder.parent / "executed").exists(), (folder.parent / "executed").read_text()
    assert done.returncode in (0, 75), done.stderr.decode()


def test_every_process_is_started_in_isolation() -> None:
    """Python started with `-m` or `-c` would import modules from the working directory."""
    for package in (*PACKAGES, "benchmarks"):
        for path in sorted((ROOT / package).rglob("*.py")):
            text = path.read_text()
            assert not re.search(r"sys\.executable,\s*(\"-[mc]|'-[mc])", text), path
            assert package == "benchmarks" or path.name == "launcher.py" or "sys.executable" not in text, path
            safe = "PYTHONSAFEPATH" in text or 'get_context("fork")' in text  # a fork imports nothing anew
            assert "multiprocessing" not in text or safe, path


ENDLESS = "X = 1..100000000, Y = 1..100000000"


def workers(of: int) -> list[int]:
    """Return the processes that a process has started."""
    found = Path(f"/proc/{of}/task/{of}/children")
    return [int(word) for word in found.read_text().split()] if found.exists() else []


def runs(process: int) -> bool:
    """Return whether a process exists and is no zombie."""
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def episode(place: Path) -> Path:
    """Return an episode of one step."""
    path = place / "ep.jsonl"
    done = subprocess.run([*UTAK, "run", ".", "--max-steps", "0", "--log", str(path)], cwd=place, capture_output=True)
    assert done.returncode == 75, done.stderr
    return path


@pytest.mark.long
@pytest.mark.skipif(not Path("/proc/self/task").exists(), reason="needs /proc")
def test_a_worker_ends_with_its_parent(tmp_path: Path) -> None:
    for name, text in FILES.items():
        (tmp_path / name).write_text(text)
    path = episode(tmp_path)
    for number in (signal.SIGKILL, signal.SIGTERM, signal.SIGHUP):
        asking = subprocess.Popen([*UTAK, "query", str(path), ENDLESS], stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        until = time.monotonic() + 600
        while not workers(asking.pid) and time.monotonic() < until:
            time.sleep(0.02)
        time.sleep(0.3)
        [worker] = workers(asking.pid)
        asking.send_signal(number)
        asking.communicate()
        until = time.monotonic() + 600
        while runs(worker) and time.monotonic() < until:
            time.sleep(0.02)
        left = runs(worker)
        with suppress(ProcessLookupError):
            os.kill(worker, signal.SIGKILL)
        assert not left, number


@pytest.mark.parametrize("module", ["utak.kb.reasoning.query_worker", "utak.simulator.run.warming"])
def test_an_isolated_process_ends_with_its_input_while_it_works(module: str, tmp_path: Path) -> None:
    """The end of the input is noticed on systems without a signal for the parent's end."""
    names = ["search", "carry"] if module == "utak.simulator.run.warming" else []
    environment = os.environ | cold_cache(tmp_path)
    pipe = subprocess.PIPE
    with subprocess.Popen(
        isolated_command(module, *names), stdin=pipe, stdout=pipe, stderr=pipe, env=environment
    ) as worker:
        assert worker.stdin is not None
        assert worker.stdout is not None
        if not names:
            assert worker.stdout.readline() == b"ready\n"
            request = {"facts": [], "query": ENDLESS, "rules": []}
            worker.stdin.write(json.dumps(request).encode() + b"\n")
            worker.stdin.flush()
        time.sleep(0.3)
        assert worker.poll() is None
        worker.stdin.close()
        try:
            worker.wait(600)
        finally:
            worker.kill()


def test_an_isolated_process_finds_packages_installed_for_one_user(tmp_path: Path) -> None:
    """Isolated Python ignores the user's folder of packages, so the folders of dependencies are passed on."""
    (tmp_path / "of_the_user.py").write_text("")
    program = (
        "import sys; from importlib.util import find_spec; from utak.launcher import run_module; here = sys.argv[1]\n"
        "run_module(here, 'utak.kb.language.terms')\n"
        "assert here not in sys.path\n"
        "run_module(here, 'utak.kb.language.terms', dependencies=('of_the_user',))\n"
        "assert find_spec('of_the_user') is not None\n"
    )
    subprocess.run([sys.executable, "-c", program, str(tmp_path)], cwd=ROOT, check=True)
    assert str(ROOT) not in isolated_command("utak.kb.reasoning.query_worker")[3].split(os.pathsep)


def test_an_isolated_process_ends_with_exit_code_0_after_its_work() -> None:
    """Its input is still open at that time, and a thread waits for it."""
    with subprocess.Popen(
        isolated_command("utak.simulator.run.warming"), stdin=subprocess.PIPE, stderr=subprocess.PIPE
    ) as worker:
        assert worker.wait(30) == 0, worker.stderr and worker.stderr.read().decode()
