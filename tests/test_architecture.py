"""The laws of the house hold, and each of them fires when it is broken (docs/architecture.md, "Laws")."""

import ast
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from tests import laws

ROOT = Path(__file__).resolve().parent.parent
Law = Callable[[Path], Iterator[str]]

# For each law the files of a small house in which it is broken, and what the law must name.
PLANTED: dict[str, tuple[dict[str, str], str]] = {
    "package_imports": ({"kb/task.py": "def f():\n    from simulator.world import table\n"}, "simulator.world"),
    "relative_imports": ({"kb/task.py": "from . import other\n"}, "kb/task.py"),
    "others_used": ({"planner/cycle.py": "import clingo\n"}, "clingo"),
    "circles": ({"kb/a/one.py": "from kb.b.two import x\n", "kb/b/two.py": "from kb.a.one import y\n"}, "kb.a"),
    "crowded_folders": ({f"geometry/room/m{n}.py": '"""M."""\n' for n in range(13)}, "geometry/room"),
    "names_with_two_meanings": ({"kb/a.py": "SIZE = 3\n", "planner/b.py": "class SIZE:\n    pass\n"}, "SIZE"),
    "vague_constants": ({"kb/a.py": "MOST = 3\n"}, "MOST"),
    "riddles": ({"kb/a.py": 'def f():\n    """That it is so."""\n'}, "That it is so"),
    "persons": ({"kb/a.py": "# he sees it\n"}, "kb"),
    "shapeless_modules": ({"kb/utils.py": '"""Useful small things."""\n'}, "kb/utils.py"),
    "code_in_fronts": ({"kb/__init__.py": '"""What is known."""\nimport kb.task\n'}, "kb/__init__.py"),
    "unlisted_modules": ({"kb/__init__.py": '"""What is known."""\n', "kb/task.py": ""}, "task"),
    "inherited_classes": ({"kb/a.py": "class A:\n    pass\nclass B(A):\n    pass\n"}, "B inherits from A"),
    "thunks": (
        {"kb/a.py": "@dataclass(frozen=True)\nclass A:\n    why: Callable[[], str]\n"},
        "A.why",
    ),
    "words_of_simulator": ({"kb/a.py": "x = 'see simulator'\n"}, "kb/a.py"),
    "encodings_that_include": ({"kb/asp/a.lp": '#include "b.lp".\n'}, "#include"),
    "patched_globals": (
        {
            "kb/a.py": "",
            "tests/test_a.py": "from kb import a\ndef test(monkeypatch):\n    monkeypatch.setattr(a, 'f', 1)\n",
        },
        "patches a",
    ),
}


@pytest.mark.parametrize("law", laws.LAWS, ids=lambda law: law.__name__)
def test_the_law_holds(law: Law) -> None:
    assert list(law(ROOT)) == []


@pytest.mark.parametrize("law", laws.LAWS, ids=lambda law: law.__name__)
def test_the_law_fires_when_it_is_broken(law: Law, tmp_path: Path) -> None:
    for package in (*laws.MEASURED, "tests"):
        (tmp_path / package).mkdir()
    assert list(law(tmp_path)) == []  # an empty house breaks no law
    files, named = PLANTED[law.__name__]
    for name, text in files.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    found = list(law(tmp_path))
    assert found
    assert named in "\n".join(found)


def test_the_laws_look_at_a_house_that_is_there() -> None:
    for package in laws.MEASURED:
        assert len(list(laws.modules(ROOT, (package,)))) > 30, package
    assert (ROOT / laws.PURE_WORLD).is_dir()
    assert (ROOT / laws.NUMBA_IN).exists()
    assert all((ROOT / room).is_dir() for room in laws.CLINGO_IN)


def run(program: str, *arguments: str) -> str:
    """Return what a program prints in a Python of its own."""
    command = [sys.executable, "-c", "import sys; sys.path.insert(0, sys.argv[1])\n" + program, str(ROOT), *arguments]
    return subprocess.run(command, capture_output=True, text=True, timeout=60, check=True).stdout.strip()


def test_whatever_is_imported_waits_for_neither_numba_nor_networkx() -> None:
    names = [
        laws.short(path, ROOT)[:-3].replace("/", ".").removesuffix(".__init__")
        for path in laws.modules(ROOT, ("geometry", "kb", "planner"))
    ]
    program = (
        "import importlib\n"
        "for name in sys.argv[2:]: importlib.import_module(name)\n"
        "print([n for n in ('numba', 'networkx', 'scipy', 'matplotlib', 'simulator') if n in sys.modules])\n"
    )
    assert run(program, *names) == "[]"
    assert run("import networkx\n" + program) == "['networkx']"  # the program sees what is loaded


def test_the_command_line_starts_light() -> None:
    loaded = ast.literal_eval(run("import simulator.cli.main; print(sorted(sys.modules))"))
    assert not {"numpy", "shapely", "clingo", "numba", "networkx"} & set(loaded)
    assert "simulator.cli.main" in loaded
