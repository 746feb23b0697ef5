"""Compilation before the first run: what is compiled, where it is cached, and what is announced."""

import gc
import os
import pty
import subprocess
import sys
from contextlib import suppress
from pathlib import Path
from shutil import copytree, ignore_patterns

import pytest

from utak.simulator.run import warming

ROOT = Path(__file__).resolve().parents[3]
COMPILED = os.environ.get("NUMBA_DISABLE_JIT", "0") == "0"


class RecordingCompiler(warming.KernelCompiler):
    """A compiler that notes what it is asked to do, and whose second process does nothing.

    `missing` are the uses that it takes for not compiled yet; None for all that it is asked about.
    """

    def __init__(self, missing=None, packages=()):
        super().__init__(packages)
        self.missing, self.compiled, self.announcements, self.passed_on = missing, [], 0, []

    def uncompiled(self, uses):
        return list(uses) if self.missing is None else self.missing

    def announce(self):
        self.announcements += 1

    def compile_for(self, uses):
        self.compiled.extend(uses)

    def second_process_command(self, uses):
        self.passed_on.extend(uses)
        return [sys.executable, "-I", "-c", ""]


def test_each_use_works_by_itself() -> None:
    for use in {use for halves in warming.PROCESS_SPLIT.values() for half in halves for use in half}:
        use()


def test_two_processes_share_the_work() -> None:
    walking, carrying = ([use for half in warming.PROCESS_SPLIT[kind] for use in half] for kind in (False, True))
    assert len(set(walking)) == len(walking)
    assert len(set(carrying)) == len(carrying)
    assert set(carrying) - set(walking) == {warming.carry}
    assert set(walking) <= set(carrying)


def test_the_second_process_compiles_its_uses() -> None:
    for halves in warming.PROCESS_SPLIT.values():
        compiler = RecordingCompiler()
        warming.main([use.__name__ for use in halves[1]], compiler)
        assert compiler.compiled == list(halves[1])


def test_the_first_run_announces_the_compilation(monkeypatch) -> None:
    monkeypatch.delenv("NUMBA_DISABLE_JIT", raising=False)
    compiler = RecordingCompiler()
    warming.warm(carrying=False, compiler=compiler)
    assert compiler.announcements == 1
    assert (compiler.compiled, compiler.passed_on) == tuple(map(list, warming.PROCESS_SPLIT[False]))
    compiler = RecordingCompiler(missing=[])
    warming.warm(carrying=True, compiler=compiler)
    assert (compiler.announcements, compiler.compiled, compiler.passed_on) == (0, [], [])


def test_the_announcement_is_printed_once_in_a_process() -> None:
    code = "from utak.simulator.run.warming import THIS_INSTALLATION as here; here.announce(); here.announce()"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stderr.count("compiling geometry kernels") == 1


def test_the_compiler_calls_each_use_and_collects_garbage_again() -> None:
    called = []
    warming.THIS_INSTALLATION.compile_for([lambda: called.append(gc.isenabled())])
    assert called == [False]
    assert gc.isenabled()


def test_bytecode_is_kept_where_python_keeps_none(monkeypatch, tmp_path) -> None:
    (tmp_path / "part").mkdir()
    (tmp_path / "part" / "module.py").write_text("ANSWER = 42\n")
    (tmp_path / "broken.py").write_text("ANSWER =\n")
    compiler = RecordingCompiler(packages=[tmp_path, tmp_path / "absent"])
    monkeypatch.delenv("NUMBA_DISABLE_JIT", raising=False)
    for no_bytecode, cached in ((False, 0), (True, 1)):
        monkeypatch.setattr(sys, "dont_write_bytecode", no_bytecode)
        warming.warm(carrying=False, compiler=compiler)
        assert len(list(tmp_path.rglob("module.*.pyc"))) == cached


def test_every_package_of_the_robot_is_among_those_whose_bytecode_is_kept() -> None:
    assert warming.THIS_INSTALLATION.packages == warming.PACKAGES
    assert all((package / "__init__.py").is_file() for package in warming.PACKAGES)


def test_each_kernel_that_is_looked_for_in_the_cache_is_there() -> None:
    for name in warming.LONGEST_KERNEL.values():
        module, function = name.split(".")
        texts = [path.read_text() for path in (ROOT / "geometry").rglob(f"{module}.py")]
        assert any(f"\ndef {function}(" in text for text in texts), name


def test_uncompiled_uses_are_found_one_by_one(monkeypatch, tmp_path) -> None:
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    uses = list(warming.LONGEST_KERNEL)
    assert warming.THIS_INSTALLATION.uncompiled(uses) == uses
    (tmp_path / "geometry_1234").mkdir()
    (tmp_path / "geometry_1234" / "router.itineraries-17.py311.nbi").touch()
    assert warming.THIS_INSTALLATION.uncompiled(uses) == [warming.carry, warming.sightlines]
    (tmp_path / "geometry_1234" / "astar.find_carrying_path-20.py311.nbi").touch()
    (tmp_path / "other.function-1.py311.nbi").touch()
    assert warming.THIS_INSTALLATION.uncompiled([warming.search, warming.carry]) == []
    assert warming.count_cached_kernels() == 2


def test_only_uncompiled_uses_are_compiled(monkeypatch) -> None:
    monkeypatch.delenv("NUMBA_DISABLE_JIT", raising=False)
    for use, asked in ((warming.carry, (True, "skeleton")), (warming.sightlines, (False, "visibility"))):
        compiler = RecordingCompiler(missing=[use])
        warming.warm(*asked, compiler)
        assert (compiler.compiled, compiler.passed_on) == ([use], [])


CODE = """
import numpy as np
from utak.geometry.kernels import jit
jit.PROGRESS.notice_delay, jit.PROGRESS.interval = 0.0, 0.0
from utak.geometry.homotopy.funnel import measure_line
measure_line(np.zeros((2, 2)), 2)
print(*jit.kernel_status())
"""


def compiling(**environment: str) -> "subprocess.CompletedProcess[str]":
    """Start a process that compiles a kernel."""
    settings = {**os.environ, **environment}
    settings.pop("NUMBA_CACHE_DIR", None)
    return subprocess.run([sys.executable, "-c", CODE], capture_output=True, text=True, check=True, env=settings)


@pytest.mark.long
@pytest.mark.skipif(not COMPILED, reason="nothing is compiled")
def test_kernels_are_kept_in_the_users_cache_where_the_installation_cannot_be_written(monkeypatch, tmp_path) -> None:
    # A copy: kernels that the installation keeps already would be read.
    for name in ("utak", "geometry", "kb", "planner", "simulator"):
        copytree(ROOT / name, tmp_path / "code" / name, ignore=ignore_patterns("__pycache__"))
    place = {"XDG_CACHE_HOME": str(tmp_path), "NUMBA_CACHE_LOCATOR_CLASSES": "UserWideCacheLocator"}
    place |= {"PYTHONPATH": str(tmp_path / "code"), "PYTHONSAFEPATH": "1"}
    assert "compiling" in compiling(**place).stderr
    assert "compiling" not in compiling(**place).stderr
    monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert tmp_path / "numba" in warming._caches()
    assert list((tmp_path / "numba").rglob("funnel.measure_line-*.nbi"))


@pytest.mark.long
@pytest.mark.skipif(not COMPILED, reason="nothing is compiled")
def test_a_message_says_when_no_cache_can_be_written() -> None:
    done = compiling(NUMBA_CACHE_LOCATOR_CLASSES="IPythonCacheLocator")
    assert "they cannot be kept for the next run: set NUMBA_CACHE_DIR" in done.stderr
    assert done.stdout.split()[1] == "False"


@pytest.mark.long
@pytest.mark.skipif(not COMPILED, reason="nothing is compiled")
def test_a_terminal_shows_the_progress(tmp_path) -> None:
    ours, theirs = pty.openpty()
    with suppress(OSError):  # on systems where reading a closed pseudo-terminal fails
        environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)}
        subprocess.run(
            [sys.executable, "-c", CODE], stdout=subprocess.DEVNULL, stderr=theirs, check=True, env=environment
        )
    os.close(theirs)
    said = os.read(ours, 10_000).decode()
    os.close(ours)
    assert "once per installation" in said
    assert "kernels compiled so far: 1, in " in said


@pytest.mark.long
def test_kernels_of_skeletons_that_are_rings_are_warmed() -> None:
    """Exercises and examples once compiled kernels that `utak warm` had left out."""
    code = """
import sys
from utak.simulator.run import warming
seen = set()
sys.setprofile(lambda frame, event, _: seen.add(frame.f_code.co_name) if event == "call" else None)
for use in warming.RARE_USES[-1:]:
    use()
sys.setprofile(None)
left_out = "first_on_ring halt_rings walk_rings fill_arrays fill_nodes fill_points"
print(sorted(set(left_out.split()) - seen))
"""
    environment = os.environ | {"NUMBA_DISABLE_JIT": "1", "PYTHONPATH": str(ROOT)}
    run = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=False)
    assert run.stdout.strip() == "[]", run.stdout + run.stderr
