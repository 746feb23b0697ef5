"""The public names of `utak`: each can be had, is documented, and comes without the rest."""

import importlib
import inspect
import subprocess
import sys
from pathlib import Path

import pytest

import utak

ROOT = Path(__file__).resolve().parents[2]


@pytest.mark.parametrize("name", utak.__all__)
def test_each_public_name_is_there_and_documented(name: str) -> None:
    thing = getattr(utak, name)
    assert inspect.isclass(thing)
    assert thing.__name__ == name
    assert len((thing.__doc__ or "").split()) > 5
    assert name in dir(utak)


def test_an_unknown_name_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="no attribute 'Robbot'"):
        _ = utak.Robbot


def test_the_modules_hold_what_the_face_names() -> None:
    for name, module in utak._MODULES.items():
        assert name in utak.__all__
        assert getattr(importlib.import_module(module), name) is getattr(utak, name)


def test_packages_of_others_under_the_names_of_our_parts_do_no_harm(tmp_path: Path) -> None:
    for name in ("geometry", "kb", "planner", "simulator"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "__init__.py").write_text("MINE = True\n")
    program = (
        f"import sys; sys.path[:0] = [{str(tmp_path)!r}, {str(ROOT)!r}]\n"
        "import geometry, kb, planner, simulator, utak, utak.geometry\n"
        "assert geometry.MINE and kb.MINE and planner.MINE and simulator.MINE\n"
        "print(utak.Run.__module__, utak.geometry.Screen.__module__)"
    )
    done = subprocess.run(
        [sys.executable, "-I", "-c", program], capture_output=True, text=True, timeout=600, check=True
    )
    assert done.stdout.split() == ["utak.run", "utak.geometry.screen"]
