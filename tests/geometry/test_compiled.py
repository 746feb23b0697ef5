"""Kernels compile on their first call, call each other, and cost nothing at import."""

import os
import subprocess
import sys

import numpy as np

from geometry import Screen, questions
from geometry.compiled import compiled


@compiled
def double(x: int) -> int:
    return 2 * x


@compiled
def total(values: np.ndarray) -> int:
    out = 0
    for i in range(values.shape[0]):
        out += double(values[i])
    return out


def test_a_kernel_calls_another() -> None:
    assert total(np.array([1, 2, 3])) == 12
    assert total(np.array([1, 2, 3], dtype=np.int32)) == 12


def test_importing_geometry_loads_neither_numba_nor_networkx() -> None:
    code = "import sys, geometry; print([m for m in ('numba', 'networkx') if m in sys.modules])"
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert found.stdout.strip() == "[]"


def test_routes_are_rehearsed_with_the_types_they_are_played_with() -> None:
    questions.rehearse()
    assert len(Screen(np.ones((4, 4), bool)).routes((0.5, 0.5), (3.5, 3.5), k=4)) == 1
    assert len(getattr(questions.itineraries.machine(), "overloads", [None])) == 1


def test_whole_numbers_of_all_widths_share_one_copy() -> None:
    assert [double(np.int32(3)), double(np.uint8(4)), double(5)] == [6, 8, 10]
    assert len(getattr(double.machine() if hasattr(double, "machine") else double, "overloads", [None])) == 1


def test_kernels_also_run_uncompiled() -> None:
    code = (
        "import numpy as np; from geometry import Screen; free = np.ones((9, 12), bool); free[4, 3:9] = False; "
        "screen = Screen(free).changed([4, 0, 1], [6, 5, 5], [True, False, False]); "
        "print(len(screen.routes((0.5, 4.5), (11.5, 4.5), k=4)), screen.shortest((0.5, 4.5), (11.5, 4.5)).length > 11)"
    )
    plain = {**os.environ, "NUMBA_DISABLE_JIT": "1"}
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, env=plain)
    assert found.stdout.split() == ["4", "True"]
