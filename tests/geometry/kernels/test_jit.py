"""Kernels compile on their first call, call each other, and cost nothing at import."""

import ast
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import geometry
from geometry.kernels.jit import compiled


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
from simulator.run.warming import carry, survey
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
        "import numpy as np; from geometry import Screen; from geometry.homotopy import landmarks; "
        "from geometry.pathfinders import polyanya; from geometry.routes import queries, router; "
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


def test_compiling_prints_a_notice_and_loading_does_not(tmp_path):
    code = (
        "import numpy as np; from geometry.kernels import jit; jit.PROGRESS.notice_delay = 0.0; "
        "from geometry.homotopy.funnel import measure_line; measure_line(np.zeros((2, 2)), 2)"
    )
    noticed = []
    for _ in range(2):
        cache = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)}
        found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, env=cache)
        noticed.append("compiling" in found.stderr)
    assert noticed == [os.environ.get("NUMBA_DISABLE_JIT", "0") == "0", False]


def test_kernels_also_run_uncompiled() -> None:
    code = (
        "import numpy as np; from geometry import Screen; free = np.ones((9, 12), bool); "
        "free[4, 3:6] = free[4, 7:9] = free[0:2, 5] = False; screen = Screen(free); "
        "print(len(screen.routes((0.5, 4.5), (11.5, 4.5), k=4)), screen.shortest((0.5, 4.5), (11.5, 4.5)).length > 11)"
    )
    plain = {**os.environ, "NUMBA_DISABLE_JIT": "1"}
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, env=plain)
    assert found.stdout.split() == ["4", "True"]


MAKERS = {"empty", "zeros", "ones", "full", "arange", "array", "copy", "concatenate", "where", "unique", "append"}
NUMBERS = {"None", "int", "float", "bool", "np.uint8", "tuple", "Anchor", "Block", "FirstContactHit", "SkinHit"}


def kernels(path, decorator):
    """Return all kernels of a module with a decorator, by name."""
    functions = [node for node in ast.walk(ast.parse(path.read_text())) if isinstance(node, ast.FunctionDef)]
    return {f.name: f for f in functions if decorator in [getattr(d, "id", "") for d in f.decorator_list]}


@pytest.mark.parametrize("path", sorted(Path(geometry.__file__).parent.rglob("*.py")), ids=lambda path: path.stem)
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
