"""The identity of the code: it changes with programs and encodings, and with nothing else."""

from pathlib import Path

import pytest

from utak.simulator.sweep.executors.cluster import run_task
from utak.simulator.sweep.executors.code_identity import (
    DECIDING_PACKAGES,
    code_digest,
    code_identity,
    difference,
    utak_version,
)
from utak.simulator.sweep.executors.tasks import WorkerTask

ROOT = Path(__file__).resolve().parents[4]


def house(folder: Path) -> Path:
    """Write a small project and return its folder."""
    for name, text in {"kb/asp/a.lp": "a.\n", "planner/b.py": "b = 1\n", "simulator/c.py": "", "kb/d.md": "d"}.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(text.encode())
    return folder


def digest_of(folder: Path) -> str:
    """Return the digest of a small project."""
    return code_digest([folder / name for name in DECIDING_PACKAGES])


def test_the_digest_changes_with_programs_and_encodings_alone(tmp_path: Path) -> None:
    one, two = house(tmp_path / "one"), house(tmp_path / "two")
    before = digest_of(one)
    assert digest_of(two) == before, "the place has no meaning"
    (two / "kb" / "d.md").write_text("other")
    (two / "planner" / "b.py").write_bytes(b"b = 1\r\n")
    (two / "kb" / "b.pyc").write_text("bytecode")
    assert digest_of(two) == before
    for name, text in {"kb/asp/a.lp": "b.\n", "planner/b.py": "b = 2\n", "geometry/new.py": ""}.items():
        changed = house(tmp_path / name.replace("/", "-"))
        (changed / name).parent.mkdir(exist_ok=True)
        (changed / name).write_text(text)
        assert digest_of(changed) != before


def test_the_identity_names_this_code_and_its_libraries() -> None:
    found = code_identity()
    assert {"utak", "code", "python", "clingo", "numpy", "shapely", "numba"} <= set(found)
    assert found["code"] == code_digest([ROOT / name for name in DECIDING_PACKAGES])
    assert found["utak"] == utak_version() != "?"


def test_another_state_of_the_code_is_refused_by_a_worker() -> None:
    other = {**code_identity(), "code": "0123"}
    with pytest.raises(RuntimeError, match=f"another state of utak: code {code_identity()['code']}, not 0123"):
        run_task("sweep", other, None, WorkerTask("operator:neg", 1))
    assert difference(other, other) == ""
