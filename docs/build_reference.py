"""The pages under docs/reference, made from the code, the encodings and the command line.

python docs/build_reference.py            write them
python docs/build_reference.py --check    exit 1 when one is stale
"""

import argparse
import ast
import importlib
import importlib.util
import inspect
import re
import sys
import textwrap
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from types import ModuleType

ROOT = Path(__file__).resolve().parent.parent
REFERENCE = ROOT / "docs" / "reference"
PACKAGES = ("geometry", "kb", "planner", "simulator", "utak", "benchmarks")
MADE = "Made from the code by `python docs/build_reference.py`; do not edit.\n"
# What a program that uses the geometry alone calls, by module, in reading order.
GEOMETRY = {
    "utak.geometry.screen": ["Screen"],
    "utak.geometry.skeleton.pathgraph_arrays": ["PathgraphArrays"],
    "utak.geometry.routes.route": ["Route"],
    "utak.geometry.passages.necks": ["Passage"],
    "utak.geometry.cspace.plan_motion": ["plan_motion", "MotionPlan"],
    "utak.geometry.cspace.solver": ["Inside"],
    "utak.geometry.motion.se2": ["Pose", "Translate", "Rotate"],
    "utak.geometry.motion.first_contact": ["ContactBody", "Obstacles"],
    "utak.geometry.manipulation.plan_carrying": ["plan_carrying", "CarryingPlan"],
    "utak.geometry.raster.rasterize": ["squares"],
    "utak.geometry.shapes.fit": ["fit_shapes", "Fit"],
    "utak.geometry.io.movingai": ["parse_map"],
}
# What a program that uses Utak from Python calls, in reading order.
PYTHON = {
    "utak.scenario": ["Scenario"],
    "utak.run": ["Run", "Plan"],
    "utak.episode": ["Episode", "Step"],
    "utak.beliefs": ["World", "Answer"],
    "utak.explaining": ["ReasonTree"],
    "utak.mind": ["Mind", "Verdict"],
    "utak.kb.body": ["Impression", "Move", "Push", "Turn", "Grasp", "Release"],
    "utak.simulator.run.session": ["RunNotRepeatedError"],
    "utak.simulator.certificates.search": ["NoCertificateError"],
    "utak.gym.environment": ["TabletopEnv"],
}


def modules_page() -> str:
    """Return the page that lists every room and module with its first line."""
    lines = ["# Rooms and modules", "", MADE]
    for package in PACKAGES:
        lines += [f"## {package}", "", first_line(ROOT / package / "__init__.py"), ""]
        rooms = {path.parent for path in (ROOT / package).rglob("*.py")}
        for folder in sorted(rooms):
            files = sorted(path for path in folder.glob("*.py") if path.name != "__init__.py")
            if not files:
                continue
            if folder != ROOT / package:
                name = folder.relative_to(ROOT).as_posix().replace("/", ".")
                lines += [f"### {name}", "", first_line(folder / "__init__.py"), ""]
            lines += ["| module | what |", "|---|---|"]
            lines += [f"| `{path.stem}` | {cell(first_line(path))} |" for path in files]
            lines.append("")
    return "\n".join(lines).rstrip() + "\n"


def first_line(path: Path) -> str:
    """Return the first paragraph of a module's docstring, on one line; "" when there is no such module."""
    if not path.exists():
        return ""
    return " ".join((ast.get_docstring(ast.parse(path.read_text())) or "").split("\n\n")[0].split())


def cell(text: str) -> str:
    """Return a text as it may stand in a table."""
    return text.replace("|", "\\|")


def commands_page() -> str:
    """Return the page with every command of `utak` and its options."""
    from utak.simulator.cli.parsing import EXIT_CODES, build_parser

    parts = next(action for action in build_parser()._actions if isinstance(action, argparse._SubParsersAction))
    helps = {choice.dest: choice.help for choice in parts._choices_actions}
    lines = ["# Commands", "", MADE, EXIT_CODES[0].upper() + EXIT_CODES[1:] + "."]
    for name in parts.choices:
        lines += ["", f"## utak {name}", "", f"{str(helps[name])[0].upper()}{str(helps[name])[1:]}.", ""]
        lines += ["| argument | what |", "|---|---|"]
        lines += [f"| `{form(action)}` | {cell(wording(action))} |" for action in parts.choices[name]._actions]
    return "\n".join(lines) + "\n"


def form(action: argparse.Action) -> str:
    """Return how an argument is written on the command line."""
    value = action.metavar or ("|".join(map(str, action.choices)) if action.choices else action.dest.upper())
    words = " ".join(value) if isinstance(value, tuple) else str(value)
    if not action.option_strings:
        return words + (" ..." if action.nargs in ("*", "+") else "")
    name = ", ".join(action.option_strings)
    return name if action.nargs == 0 else f"{name} {words}".replace("|", "\\|")


def wording(action: argparse.Action) -> str:
    """Return the help of an argument with its default filled in."""
    return str(action.help or "").replace("%(default)s", str(action.default))


def geometry_page() -> str:
    """Return the page with signatures and docstrings of the public geometry."""
    lines = ["# Geometry: all public calls", "", MADE]
    lines += ["Points are (x, y) in squares; arrays are indexed [row, column], row 0 in the south.", ""]
    for module, names in GEOMETRY.items():
        lines += [f"## {module}", ""]
        for name in names:
            lines += described(name, getattr(importlib.import_module(module), name), 3)
    return "\n".join(lines).rstrip() + "\n"


def python_page() -> str:
    """Return the page with signatures and docstrings of the face for Python."""
    lines = ["# Python: all public calls", "", MADE]
    lines += [
        "All names but those of `utak.gym` are imported from `utak` itself. [The tutorial](../python.md) shows",
        "",
    ]
    lines[-2] += " how they go together."
    for module, names in PYTHON.items():
        lines += [f"## {module}", ""]
        for name in names:
            lines += described(name, getattr(importlib.import_module(module), name), 3)
    return "\n".join(lines).rstrip() + "\n"


def described(name: str, thing: object, level: int) -> Iterator[str]:
    """Yield the lines for a class with its public members, or for a function."""
    yield f"{'#' * level} {name}"
    yield ""
    if callable(thing) and not inspect.isclass(thing):
        yield from ["```python", signature(name, thing), "```", ""]
    yield from ["```text", inspect.cleandoc(inspect.getdoc(thing) or ""), "```", ""]
    if inspect.isclass(thing):
        made = vars(thing).get("__init__")
        if inspect.isfunction(made) and made.__doc__ and "Parameters\n" in inspect.cleandoc(made.__doc__):
            yield from ["```python", signature(name, made), "```", ""]
            yield from ["```text", inspect.cleandoc(made.__doc__), "```", ""]
        for member, value in vars(thing).items():
            inner = getattr(value, "func", None) or getattr(value, "fget", None) or value
            inner = value.__func__ if isinstance(value, staticmethod) else inner
            if not member.startswith("_") and inspect.isfunction(inner) and inner.__doc__:
                called = inner is value or isinstance(value, staticmethod)
                yield from ["```python", signature(f"{name}.{member}", inner, called), "```", ""]
                yield from ["```text", inspect.cleandoc(inner.__doc__), "```", ""]


def signature(name: str, function: Callable[..., object], call: bool = True) -> str:
    """Return how a function is called, or the name of a property with its type."""
    source = textwrap.dedent(inspect.getsource(inspect.unwrap(getattr(function, "function", function))))
    node = next(n for n in ast.walk(ast.parse(source)) if isinstance(n, ast.FunctionDef))
    returned = f" -> {ast.unparse(node.returns)}" if node.returns else ""
    if not call:
        return f"{name}{returned}"
    arguments = re.sub(r"^(self|cls)(, )?", "", ast.unparse(node.args))
    return "\n".join(textwrap.wrap(f"{name}({arguments}){returned}", 110, subsequent_indent="    "))


def vocabulary() -> ModuleType:
    """Return the program that makes the page of the predicates."""
    spec = importlib.util.spec_from_file_location("build_vocabulary", ROOT / "docs" / "build_vocabulary.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def pages() -> Mapping[str, str]:
    """Return the text of each page by its file's name."""
    return {
        "modules.md": modules_page(),
        "commands.md": commands_page(),
        "geometry.md": geometry_page(),
        "python.md": python_page(),
        "vocabulary.md": str(vocabulary().page()),
    }


def main(arguments: Sequence[str] | None = None) -> int:
    """Write the pages, or check them."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true", help="only say whether the pages are as they must be")
    check = parser.parse_args(arguments).check
    sys.path.insert(0, str(ROOT))
    stale = []
    for name, text in pages().items():
        path = REFERENCE / name
        if check and (not path.exists() or path.read_text() != text):
            stale.append(name)
            print(f"docs/reference/{name} is stale: run python docs/build_reference.py", file=sys.stderr)
        elif not check:
            path.write_text(text)
    return int(bool(stale))


if __name__ == "__main__":
    sys.exit(main())
