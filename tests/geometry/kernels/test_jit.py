"""Kernels compile on their first call, call each other, and cost nothing at import."""

import ast
import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import utak.geometry
from utak.geometry.kernels.jit import compiled


@compiled
def double(x: int) -> int:
    """Return twice a number."""
    return 2 * x


@compiled
def total(values: np.ndarray) -> int:
    """Return the sum of the doubled values."""
    out = 0
    for i in range(values.shape[0]):
        out += double(values[i])
    return out


def test_a_kernel_calls_another() -> None:
    assert total(np.array([1, 2, 3])) == 12
    assert total(np.array([1, 2, 3], dtype=np.int32)) == 12


def test_kernels_do_not_import_scipy_but_other_code_can() -> None:
    pytest.importorskip("scipy")
    code = """
import sys, numba, numpy
from utak.simulator.run.warming import carry, survey
survey()
carry()
print("scipy.linalg" in sys.modules)
square = numpy.eye(2)
print(numba.njit(lambda a: numpy.cov(a @ a))(square).tolist() == numpy.cov(square).tolist())
"""
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert found.stdout.split() == ["False", "True"]


def test_importing_geometry_loads_neither_numba_nor_networkx() -> None:
    code = "import sys, geometry; print([m for m in ('numba', 'networkx') if m in sys.modules])"
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert found.stdout.strip() == "[]"


def test_kernels_of_routes_are_compiled_in_advance_for_the_types_of_screens() -> None:
    code = (
        "import numpy as np; from utak.geometry import Screen; from utak.geometry.homotopy import landmarks; "
        "from utak.geometry.pathfinders import polyanya; from utak.geometry.routes import queries, router; "
        "queries.compile_route_kernels(); "
        "screen = Screen(np.ones((4, 4), bool)); print(len(screen.routes((0.5, 0.5), (3.5, 3.5), k=4)), "
        "screen.shortest((0.5, 0.5), (3.5, 3.5)) is not None); "
        "kernels = router.itineraries, polyanya.shortest_line, landmarks.measure_chains; "
        "dispatchers = [kernel.dispatcher() if hasattr(kernel, 'dispatcher') else kernel for kernel in kernels]; "
        "print(*(len(getattr(dispatcher, 'overloads', [None])) for dispatcher in dispatchers))"
    )  # in a process of its own, where no other screen has had other types
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert found.stdout.split() == ["1", "True", "1", "1", "1"]


def test_integers_of_all_widths_share_one_compiled_copy() -> None:
    assert [double(np.int32(3)), double(np.uint8(4)), double(5)] == [6, 8, 10]
    assert len(getattr(double.dispatcher() if hasattr(double, "dispatcher") else double, "overloads", [None])) == 1


@pytest.mark.long
def test_compiling_prints_a_notice_and_loading_does_not(tmp_path):
    code = (
        "import numpy as np; from utak.geometry.kernels import jit; jit.PROGRESS.notice_delay = 0.0; "
        "from utak.geometry.homotopy.funnel import measure_line; measure_line(np.zeros((2, 2)), 2)"
    )
    noticed = []
    for _ in range(2):
        cache = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)}
        found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, env=cache)
        noticed.append("compiling" in found.stderr)
    assert noticed == [os.environ.get("NUMBA_DISABLE_JIT", "0") == "0", False]


UNCOMPILED = """
import numpy as np, shapely
from utak.geometry import Screen
from utak.geometry.counts.gibbs import DRAWN, Counts, pictures
from utak.geometry.manipulation.plan_carrying import Inside, plan_carrying
free = np.ones((9, 12), bool)
free[4, 3:6] = free[4, 7:9] = free[0:2, 5] = False
screen, ends = Screen(free), ((0.5, 4.5), (11.5, 4.5))
print([route.points for route in screen.routes(*ends, k=4)], screen.shortest(*ends).points)
fields = np.arange(48, dtype=np.int32).reshape(3, 2, 4, 2).swapaxes(1, 2).reshape(12, 4)
random = np.random.default_rng(1)
count = random.integers(0, 5, 12).astype(np.int16)
first = random.integers(0, 2, (4, 6, 8)).astype(np.int8)
counts = Counts(fields, np.ones((12, 4), np.int16), count, count)
print(pictures(np.full((6, 8), DRAWN, np.int8), counts, first, 9, 0.5).tolist())
plan = plan_carrying(shapely.box(3, 2, 5, 3), np.ones((6, 16), bool), (1.5, 1.5), Inside(shapely.box(10, 0, 16, 6)))
print(plan.status, plan.legs)
"""


@pytest.mark.long
def test_kernels_give_the_same_uncompiled() -> None:
    """Numpy keeps narrow types where numba widens them: what is computed in these would differ."""
    plain, said = {**os.environ, "NUMBA_DISABLE_JIT": "1"}, []
    for environment in (None, plain):
        command = [sys.executable, "-c", UNCOMPILED]
        found = subprocess.run(command, capture_output=True, text=True, check=True, env=environment)
        said.append(found.stdout)
    assert said[0] == said[1]
    assert "found" in said[0]


MAKERS = {"empty", "zeros", "ones", "full", "arange", "array", "copy", "concatenate", "where", "unique", "append"}
NUMBERS = {"None", "int", "float", "bool", "np.uint8", "tuple", "Anchor", "Block", "FirstContactHit", "SkinHit"}


def kernels(path, decorator):
    """Return all kernels of a module with a decorator, by name."""
    functions = [node for node in ast.walk(ast.parse(path.read_text())) if isinstance(node, ast.FunctionDef)]
    return {f.name: f for f in functions if decorator in [getattr(d, "id", "") for d in f.decorator_list]}


@pytest.mark.parametrize("path", sorted(Path(utak.geometry.__file__).parent.rglob("*.py")), ids=lambda path: path.stem)
def test_bare_kernels_make_and_return_no_arrays(path):
    """Numba would neither free them nor keep them alive."""
    bare, counting = kernels(path, "bare"), set(kernels(path, "compiled"))
    for name, function in bare.items():
        annotations = (
            ast.walk(function.returns) if function.returns else ()
        )  # without annotations only the body is checked
        returned = {ast.unparse(n) for n in annotations if isinstance(n, ast.Name | ast.Attribute)}
        assert returned - {"np"} <= NUMBERS, name
        for node in ast.walk(function):
            assert not isinstance(node, ast.List | ast.ListComp), name
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute):
                assert node.func.attr not in MAKERS, name
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
                assert node.func.id not in counting, name


ROOT = Path(__file__).resolve().parents[3]
KERNEL = """
import sys
import numpy
from utak.geometry.kernels.jit import PROGRESS
sys.path.insert(0, sys.argv[1])
from own_kernel import shifted
print(shifted(2), PROGRESS.compiled_count)
"""
UNWRITABLE = """
from numba.core import caching
def refuse(self):
    raise PermissionError(13, "no")
caching.InTreeCacheLocator.ensure_cache_path = refuse
"""
OWN_KERNEL = """
from utak.geometry.kernels.jit import compiled
@compiled
def shifted(x: int) -> int:
    return x + 40
"""


@pytest.mark.long
@pytest.mark.skipif(os.environ.get("NUMBA_DISABLE_JIT", "0") != "0", reason="nothing is compiled")
def test_damaged_files_in_the_cache_are_made_anew(tmp_path: Path) -> None:
    cache = tmp_path / "cache"
    (tmp_path / "own_kernel.py").write_text(OWN_KERNEL)
    environment = os.environ | {"NUMBA_CACHE_DIR": str(cache), "PYTHONPATH": str(ROOT)}

    def called() -> str:
        command = [sys.executable, "-c", KERNEL, str(tmp_path)]
        return subprocess.run(command, env=environment, capture_output=True, text=True, check=True).stdout.strip()

    assert called() == "42 1"
    assert called() == "42 0"
    for end in ("nbi", "nbc"):
        (file,) = cache.rglob(f"*.{end}")
        whole = file.read_bytes()
        middle = len(whole) // 2
        flipped = whole[:middle] + bytes([whole[middle] ^ 4]) + whole[middle + 1 :]
        for damaged in (b"", whole[:middle], flipped, flipped.replace(b"seal of utak", b"seal of utok")):
            file.write_bytes(damaged)
            assert called() == "42 1", (end, len(damaged))
        assert called() == "42 0"


@pytest.mark.long
@pytest.mark.skipif(os.environ.get("NUMBA_DISABLE_JIT", "0") != "0", reason="nothing is compiled")
def test_kernels_of_an_installation_that_cannot_be_written_are_read(tmp_path: Path) -> None:
    installation = tmp_path / "here"
    for name in ("utak", "geometry"):
        shutil.copytree(ROOT / name, installation / name, ignore=shutil.ignore_patterns("__pycache__"))
    (installation / "geometry" / "own_kernel.py").write_text(OWN_KERNEL)
    environment = {name: value for name, value in os.environ.items() if name != "NUMBA_CACHE_DIR"}
    environment |= {"PYTHONPATH": str(installation), "XDG_CACHE_HOME": str(tmp_path / "users")}
    no_user = UNWRITABLE + "caching.UserWideCacheLocator.ensure_cache_path = refuse\n"
    for before, expected in (("", "42 1"), (UNWRITABLE, "42 0"), (no_user, "42 0")):
        code = before + KERNEL.replace("from own_kernel", "from utak.geometry.own_kernel")
        command = [sys.executable, "-c", code, str(installation)]
        run = subprocess.run(command, env=environment, capture_output=True, text=True, check=False, cwd=installation)
        assert run.stdout.strip() == expected, run.stderr
