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
    "imports_from_the_top": ({"kb/task.py": "from kb.other import f\n"}, "not utak.kb.other"),
    "relative_imports": ({"kb/task.py": "from . import other\n"}, "kb/task.py"),
    "others_used": ({"planner/cycle.py": "import clingo\n"}, "clingo"),
    "circles": ({"kb/a/one.py": "from kb.b.two import x\n", "kb/b/two.py": "from kb.a.one import y\n"}, "kb.a"),
    "crowded_folders": ({f"geometry/room/m{n}.py": '"""M."""\n' for n in range(13)}, "geometry/room"),
    "names_with_two_meanings": ({"kb/a.py": "SIZE = 3\n", "planner/b.py": "class SIZE:\n    pass\n"}, "SIZE"),
    "vague_constants": ({"kb/a.py": "MOST = 3\n"}, "MOST"),
    "riddles": ({"kb/a.py": 'def f():\n    """That it is so."""\n'}, "That it is so"),
    "long_docstrings": ({"kb/a.py": 'def _f():\n    """Return it.\n\n    And more.\n    """\n'}, "_f has more"),
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

LAUNCHER = "utak.launcher"  # not written out below, since this module, too, is searched for programs that patch
# Ways to put something in the place of what a module of a small house defines, and what the law must name.
PATCHES = {
    "from kb import a\ndef test(monkeypatch):\n    monkeypatch.setattr(a, 'f', 1)\n": "a",
    "import kb.a\ndef test(monkeypatch):\n    monkeypatch.setattr(kb.a, 'f', 1)\n": "kb.a",
    "import kb.a as part\nmonkeypatch.delattr(part, 'f')\n": "part",
    "from kb.task import room\nwith pytest.MonkeyPatch.context() as mp:\n    mp.setattr(room, 'f', 1)\n": "room",
    "import benchmarks.run as run\nmonkeypatch.setattr(run, 'f', 1)\n": "run",
    f"import {LAUNCHER}\nmonkeypatch.setattr({LAUNCHER}, 'f', 1)\n": LAUNCHER,
    "monkeypatch.setattr('kb.a.f', 1)\n": "kb.a.f",
    "from kb import a\nmonkeypatch.setattr(target=a, name='f', value=1)\n": "a",
    "from kb import a\npart = a\npart.f = 1\n": "part",
    "import importlib\npart = importlib.import_module('kb.a')\npart.f = 1\n": "part",
    "from kb import a\nsetattr(a, 'f', 1)\n": "a",
    "from kb import a\na.f = 1\n": "a",
    "from kb import a\nx, a.f = 1, 2\n": "a",
    "from kb import a\na.f += 1\n": "a",
    "from kb import a\ndel a.f\n": "a",
    "from kb import a\na.__dict__['f'] = 1\n": "a.__dict__",
    "from kb import a\nvars(a)['f'] = 1\n": "vars(a)",
    "from kb import a\nmonkeypatch.setitem(a.__dict__, 'f', 1)\n": "a.__dict__",
    "from kb.a import Thing\nmonkeypatch.setattr(Thing, 'f', 1)\n": "Thing",
    "from kb import a\na.Thing.f = 1\n": "a.Thing",
    "import sys\nsys.modules['kb.a'].f = 1\n": "sys.modules['kb.a']",
    "from unittest import mock\nwith mock.patch('kb.a.f'):\n    pass\n": "kb.a.f",
    "from unittest.mock import patch\n@patch('kb.a.f')\ndef test(f):\n    pass\n": "kb.a.f",
    "from kb import a\nfrom unittest.mock import patch\n@patch.object(a, 'f')\ndef test(f):\n    pass\n": "a",
    "from kb import a\nimport unittest.mock\nunittest.mock.patch.multiple(a, f=1)\n": "a",
    "CODE = 'from kb import a; a.f = 1'\n": "a",
    "CODE = f'from kb import a; a.f = {1}'\n": "a",
    "def test(mocker):\n    mocker.patch('kb.a.f')\n": "kb.a.f",
}
# Seams: attributes of objects, of modules of others, and of the tests' own classes.
SEAMS = (
    "from kb.a import LIMITS\nLIMITS.seconds = 1\n",
    "from kb import a\nthing = a.Thing()\nthing.f = 1\nmonkeypatch.setattr(thing, 'f', 1)\n",
    "from kb import a\na.TABLE.entries['f'] = 1\na.Thing().f = 1\n",
    "import sys\nmonkeypatch.setattr(sys, 'platform', 'darwin')\nmonkeypatch.setattr('sys.stdin', None)\n",
    "from tests.stand_in import Robot\nmonkeypatch.setattr(Robot, 'f', 1)\n",
    "monkeypatch.setenv('kb.a', '1')\n",
)


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


@pytest.mark.parametrize(
    ("name", "program"),
    [
        ("utak/run.py", "import gymnasium\n"),
        ("simulator/play.py", "def f():\n    from gymnasium import Env\n"),
        ("simulator/face.py", "def f():\n    import utak\n"),
        ("utak/gym/__init__.py", "def f():\n    pass\n"),
    ],
)
def test_the_face_for_python_keeps_to_itself(name: str, program: str, tmp_path: Path) -> None:
    (tmp_path / name).parent.mkdir(parents=True)
    (tmp_path / name).write_text(program)
    found = [*laws.others_used(tmp_path), *laws.package_imports(tmp_path), *laws.code_in_fronts(tmp_path)]
    assert len(found) == 1
    assert found[0].startswith(name)


def planted_tests(root: Path, program: str) -> list[str]:
    """Return what patches globals in a small house whose only test is a program."""
    for name in ("kb/a.py", "kb/task/room.py", "benchmarks/run.py", "utak/launcher.py", "tests/test_a.py"):
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).write_text(program if name.startswith("tests/") else "")
    return list(laws.patched_globals(root))


@pytest.mark.parametrize("program", PATCHES)
def test_each_way_to_patch_a_global_is_seen(program: str, tmp_path: Path) -> None:
    (found,) = planted_tests(tmp_path, program)
    assert found.endswith(f" patches {PATCHES[program]}")


@pytest.mark.parametrize("program", SEAMS)
def test_seams_may_be_given_other_parts(program: str, tmp_path: Path) -> None:
    assert planted_tests(tmp_path, program) == []


def test_the_laws_look_at_a_house_that_is_there() -> None:
    for package in laws.MEASURED:
        assert len(list(laws.modules(ROOT, (package,)))) > (10 if package == laws.FACE else 30), package
    assert (ROOT / laws.PURE_WORLD).is_dir()
    assert all((ROOT / name).exists() for name in laws.NUMBA_IN)
    assert all((ROOT / place).exists() for places in laws.OPTIONAL_IN.values() for place in places)
    assert all((ROOT / front).exists() for front in laws.FRONTS_WITH_CODE)
    assert all((ROOT / room).is_dir() for room in laws.CLINGO_IN)


def run(program: str, *arguments: str) -> str:
    """Return what a program prints in a Python of its own."""
    command = [sys.executable, "-c", "import sys; sys.path.insert(0, sys.argv[1])\n" + program, str(ROOT), *arguments]
    return subprocess.run(command, capture_output=True, text=True, timeout=600, check=True).stdout.strip()


def test_whatever_is_imported_waits_for_neither_numba_nor_networkx() -> None:
    names = [
        "utak." + laws.short(path, ROOT)[:-3].replace("/", ".").removesuffix(".__init__")
        for path in laws.modules(ROOT, ("geometry", "kb", "planner"))
        if laws.short(path, ROOT) != laws.NUMBA_IN[1]  # which the first call of a kernel imports
    ]
    program = (
        "import importlib\n"
        "for name in sys.argv[2:]: importlib.import_module(name)\n"
        "print([n for n in ('numba', 'networkx', 'scipy', 'matplotlib', 'utak.simulator') if n in sys.modules])\n"
    )
    assert run(program, *names) == "[]"
    assert run("import networkx\n" + program) == "['networkx']"  # the program sees what is loaded


def test_nobody_imports_the_face_for_python_and_it_starts_light() -> None:
    loaded = ast.literal_eval(run("import utak; print(sorted(sys.modules))"))
    assert {"utak"} == {name for name in loaded if laws.in_house(name).split(".")[0] in laws.HOUSE}
    assert not {"numpy", "shapely", "clingo", "numba", "networkx", "typing", "gymnasium"} & set(loaded)
    names = [
        f"utak.{name}" for name in ("simulator.cli.main", "simulator.run.session", "planner.cycle", "kb.knowledge")
    ]
    program = "import importlib\nfor name in sys.argv[2:]: importlib.import_module(name)\nprint(sorted(sys.modules))"
    face = {f"utak.{path.stem}" for path in (ROOT / "utak").glob("*.py")} - {laws.LAUNCHER}
    assert not face & set(ast.literal_eval(run(program, *names)))


def test_the_command_line_starts_light() -> None:
    loaded = ast.literal_eval(run("import utak.simulator.cli.main; print(sorted(sys.modules))"))
    assert not {"numpy", "shapely", "clingo", "numba", "networkx"} & set(loaded)
    assert "utak.simulator.cli.main" in loaded
