"""Who may import whom (docs/architecture.md): enforced on the source, so that the truth never leaks to the robot."""

import ast
import io
import subprocess
import sys
import tokenize
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
HOUSE = {"geometry", "kb", "planner", "simulator"}
START = {"utak_command"}  # finds the packages, for every process that is started; knows none of them
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
    source = "def f():\n    from simulator.world.physics import Tabletop\n    import kb.task.task\n"
    assert imported_packages(source) == {"simulator", "kb"}


def names_and_words(path: Path) -> Iterator[str]:
    """The names and the words of strings and comments of a module."""
    for token in tokenize.generate_tokens(io.StringIO(path.read_text()).readline):
        if token.type in (tokenize.NAME, tokenize.STRING, tokenize.COMMENT):
            yield token.string


@pytest.mark.parametrize("package", ["geometry", "kb", "planner"])
def test_nothing_below_speaks_of_the_simulator(package: str) -> None:
    for path in sorted((ROOT / package).rglob("*.py")):
        assert not [word for word in names_and_words(path) if "simulator" in word], path.relative_to(ROOT)


def third_parties(source: str) -> set[str]:
    """Top-level packages of others that a module imports, at whatever depth."""
    names: set[str] = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            names |= {alias.name.split(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.level == 0 and node.module:
            names.add(node.module.split(".")[0])
    return names - HOUSE - START - set(sys.stdlib_module_names)


MAY_USE = {
    "geometry": {"numba", "numpy", "shapely", "networkx"},
    "kb": {"clingo", "numpy", "shapely"},
    "planner": {"numpy", "shapely"},
    "simulator": {"numpy", "shapely"},
}


@pytest.mark.parametrize("package", sorted(HOUSE))
def test_packages_use_only_what_they_may(package: str) -> None:
    for path in sorted((ROOT / package).rglob("*.py")):
        found = third_parties(path.read_text())
        assert found <= MAY_USE[package], f"{path.relative_to(ROOT)} uses {sorted(found)}"
        if "numba" in found:
            assert path.relative_to(ROOT) == Path("geometry/kernels/jit.py")


def test_clingo_is_met_in_few_places() -> None:
    met = {p.stem for p in (ROOT / "kb").rglob("*.py") if "clingo" in third_parties(p.read_text())}
    in_the_worker = {"clauses", "inference", "naming", "rule_reading", "ruling", "tallying", "uncertain", "wording"}
    assert met <= {"encodings", "query", "query_worker", "userrules", "explaining", "proofs"} | in_the_worker


MODULES = sorted(
    ".".join(path.relative_to(ROOT).with_suffix("").parts)
    for package in ("geometry", "kb", "planner")
    for path in (ROOT / package).glob("*.py")
    if path.stem not in ("__init__", "__main__")
)


def test_imports_are_light() -> None:
    """Whoever imports geometry, kb and planner waits for neither numba nor networkx."""
    program = (
        "import importlib, sys\n"
        "sys.path.insert(0, sys.argv[1])\n"
        "for name in sys.argv[2:]: importlib.import_module(name)\n"
        "print([n for n in ('numba', 'networkx', 'scipy', 'matplotlib', 'simulator') if n in sys.modules])\n"
    )
    command = [sys.executable, "-c", program, str(ROOT), *MODULES]
    found = subprocess.run(command, capture_output=True, text=True, timeout=60, check=True)
    assert found.stdout.strip() == "[]"


def test_the_command_line_starts_light() -> None:
    program = "import sys; sys.path.insert(0, sys.argv[1]); import simulator.cli.main; print(sorted(sys.modules))"
    found = subprocess.run(
        [sys.executable, "-c", program, str(ROOT)], capture_output=True, text=True, timeout=60, check=True
    )
    loaded = ast.literal_eval(found.stdout)
    assert not {"numpy", "shapely", "clingo", "numba", "networkx"} & set(loaded)


def test_packages_have_no_code_in_their_front() -> None:
    for package in sorted(HOUSE):
        body = ast.parse((ROOT / package / "__init__.py").read_text()).body
        allowed = (ast.Expr, ast.ImportFrom, ast.Assign) if package == "geometry" else (ast.Expr,)
        assert all(isinstance(node, allowed) for node in body), package


@pytest.mark.parametrize("package", sorted(HOUSE))
def test_no_module_is_too_long_or_without_a_concept(package: str) -> None:
    for path in sorted((ROOT / package).rglob("*.py")):
        assert len(path.read_text().splitlines()) <= 400, path
        assert path.stem not in ("utils", "helpers", "common", "misc", "core", "manager")
        assert ast.get_docstring(ast.parse(path.read_text())), f"{path} does not say what it is"


def test_encodings_ground_no_files() -> None:
    for path in sorted([*(ROOT / "kb" / "asp").glob("*.lp"), *(ROOT / "planner" / "asp").glob("*.lp")]):
        assert "#include" not in path.read_text()
        assert "#script" not in path.read_text()
