"""Who may import whom (docs/architecture.md): enforced on the source, so that the truth never leaks to the robot."""

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
HOUSE = {"geometry", "kb", "planner", "simulator"}
MAY_IMPORT = {
    "geometry": set(),
    "kb": {"geometry"},
    "planner": {"geometry", "kb"},
    "simulator": {"geometry", "kb", "planner"},
}
SIMULATED_WORLD = ["contents", "tabletop", "physics", "senses"]  # physics and senses know geometry alone


def imported_packages(source: str) -> set[str]:
    """Our own top-level packages that a module's source imports, at whatever depth."""
    names: set[str] = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            names |= {alias.name.split(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.level == 0 and node.module:
            names.add(node.module.split(".")[0])
    return names & HOUSE


@pytest.mark.parametrize("package", sorted(HOUSE))
def test_packages_import_only_what_they_may(package: str) -> None:
    for path in sorted((ROOT / package).rglob("*.py")):
        foreign = imported_packages(path.read_text()) - {package}
        assert foreign <= MAY_IMPORT[package], f"{path.relative_to(ROOT)} imports {sorted(foreign)}"


def test_physics_and_senses_know_geometry_alone() -> None:
    for name in SIMULATED_WORLD:
        path = ROOT / "simulator" / f"{name}.py"
        if path.exists():
            assert imported_packages(path.read_text()) - {"simulator"} <= {"geometry"}, name


def test_the_check_sees_a_forbidden_import() -> None:
    source = "def f():\n    from simulator.tabletop import Tabletop\n    import kb.task\n"
    assert imported_packages(source) == {"simulator", "kb"}
