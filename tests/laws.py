"""The laws of the house (docs/architecture.md, "Laws"): each is a function that yields a sentence for each violation.

A law looks at the source under a root folder and imports none of it, so it can be tried on a small planted house.
"""

import ast
import io
import re
import sys
import tokenize
from collections import defaultdict
from collections.abc import Iterator
from contextlib import suppress
from functools import cache
from pathlib import Path

HOUSE = ("geometry", "kb", "planner", "simulator", "utak")
MEASURED = (*HOUSE, "benchmarks")
PATCHED_PACKAGES = MEASURED  # in which tests patch nothing
MAY_IMPORT = {
    "geometry": set[str](),
    "kb": {"geometry"},
    "planner": {"geometry", "kb"},
    "simulator": {"geometry", "kb", "planner"},
    "utak": {"geometry", "kb", "planner", "simulator"},  # the face for Python, imported by nobody
}
MAY_USE = {
    "geometry": {"numba", "numpy", "shapely", "networkx"},
    "kb": {"clingo", "numpy", "shapely"},
    "planner": {"numpy", "shapely"},
    "simulator": {"numpy", "shapely"},
    "utak": {"numpy", "shapely"},
}
PURE_WORLD = "simulator/world"  # the simulated world: besides itself it may import geometry alone
# Libraries of extras, each met in its places alone and imported when it is used.
OPTIONAL_IN = {
    "pytest": ("utak/pytest_plugin.py",),
    "PIL": ("simulator/replay/gif.py", "simulator/importing/ros_map.py"),
    "yaml": ("simulator/importing/ros_head.py",),
    "svg": ("simulator/importing/svg_outlines.py",),
    "distributed": ("simulator/sweep/executors/cluster.py",),
    "gymnasium": ("utak/gym",),
    "prompt_toolkit": ("simulator/repl",),
    "rich": ("simulator/repl",),
}
NUMBA_IN = ("geometry/kernels/jit.py", "geometry/kernels/cache.py")
CLINGO_IN = ("kb/reasoning", "kb/three_valued", "kb/tracing")  # where rules are solved, asked and traced
# What stands in fronts besides a docstring: public names are what users of Python import.
FRONTS_WITH_CODE: dict[str, tuple[type[ast.stmt], ...]] = {
    "geometry/__init__.py": (ast.ImportFrom, ast.Assign),  # public names
    "utak/__init__.py": (
        ast.Import,
        ast.ImportFrom,
        ast.Assign,
        ast.If,
        ast.FunctionDef,
    ),  # public names, loaded when they are used
    "utak/gym/__init__.py": (ast.ImportFrom,),  # importing it makes the environment known to Gymnasium
}
LAUNCHER = "utak.launcher"  # the one module of the face that all may import: it starts our processes
FACE = "utak"  # its classes bear the names of what they show: utak.Scenario stands for a scenario
MAX_MODULES = 12  # in a folder: what a reader keeps in mind at once
MAX_LINES = 400  # of a module, its docstrings left out
PERSON_PER_THOUSAND = 1.0  # "he", "his", "him" in 1,000 words of comments and docstrings
EMPTY_NAMES = {"utils", "helpers", "common", "misc", "core", "manager"}
RIDDLE = re.compile(r"(That|Who|What|By|Where|Whose|Whom|When|How|If|So|And|Of|To)\b")
PERSON = re.compile(r"\b(he|his|him|himself)\b", re.IGNORECASE)
VAGUE_WORDS = """
    MOST LEAST NEAR FAR BESIDE LIKELY FULL FEW SOME ABOUT STILL EDGE LOOSE WIDEST MAYBE SHY BARE LAST SURE CLEAR LONG
    SHORT OTHERS UNSEEN
"""
VAGUE = set(VAGUE_WORDS.split())


@cache
def tree_of(path: Path) -> ast.Module:
    """Return the syntax tree of a module."""
    return ast.parse(path.read_text())


@cache
def nodes_of(path: Path) -> tuple[ast.AST, ...]:
    """Return all nodes of the syntax tree of a module; many laws go through them."""
    return tuple(ast.walk(tree_of(path)))


def modules(root: Path, packages: tuple[str, ...] = HOUSE) -> Iterator[Path]:
    """Yield the modules of some packages, sorted."""
    for package in packages:
        yield from sorted((root / package).rglob("*.py"))


def short(path: Path, root: Path) -> str:
    """Return a path below the root, with slashes."""
    return path.relative_to(root).as_posix()


def in_house(dotted: str) -> str:
    """Return a module's name as its place in the checkout has it: `kb.task` for `utak.kb.task`."""
    inner = dotted.removeprefix(f"{FACE}.")
    return inner if inner.split(".")[0] in set(HOUSE) - {FACE} else dotted


def imports(path: Path, as_written: bool = False) -> Iterator[tuple[str, str]]:
    """Yield (module, name) for each import at whatever depth; the name is "" for `import module`."""
    name_of = str if as_written else in_house
    for node in nodes_of(path):
        if isinstance(node, ast.Import):
            yield from ((name_of(alias.name), "") for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.level == 0 and node.module:
            yield from ((name_of(node.module), alias.name) for alias in node.names)


def package_imports(root: Path) -> Iterator[str]:
    """Packages import only packages below them: geometry, kb, planner, simulator."""
    for path in modules(root):
        own = short(path, root).split("/")[0]
        below = MAY_IMPORT[own] | {own}
        for module, _ in imports(path):
            if module.split(".")[0] in {*HOUSE, "benchmarks", "tests"} - below and module != LAUNCHER:
                yield f"{short(path, root)} imports {module}"
            ours = module.split(".")[0] in HOUSE and not module.startswith(("geometry", PURE_WORLD.replace("/", ".")))
            if ours and short(path, root).startswith(PURE_WORLD):
                yield f"{short(path, root)} imports {module}: the simulated world knows geometry alone"


def imports_from_the_top(root: Path) -> Iterator[str]:
    """Our packages are imported as parts of `utak`, as they are where Utak is installed."""
    for path in modules(root, (*MEASURED, "tests")):
        for module, _ in imports(path, as_written=True):
            if module.split(".")[0] in set(HOUSE) - {FACE}:
                yield f"{short(path, root)} imports {module}, not {FACE}.{module}"


def relative_imports(root: Path) -> Iterator[str]:
    """Every import is absolute, so that a reader sees which room it comes from."""
    for path in modules(root, MEASURED):
        if any(isinstance(node, ast.ImportFrom) and node.level for node in nodes_of(path)):
            yield f"{short(path, root)} has a relative import"


def others_used(root: Path) -> Iterator[str]:
    """Packages use only the libraries that they may; optional ones and numba are met in one place each."""
    for path in modules(root):
        name = short(path, root)
        for library in {module.split(".")[0] for module, _ in imports(path)}:
            if library in set(HOUSE) | set(sys.stdlib_module_names):
                continue
            if library in OPTIONAL_IN:
                if not name.startswith(OPTIONAL_IN[library]):
                    yield f"{name} uses {library}, which {' and '.join(OPTIONAL_IN[library])} alone may"
            elif library not in MAY_USE[name.split("/")[0]]:
                yield f"{name} uses {library}"
            if library == "numba" and name not in NUMBA_IN:
                yield f"{name} uses numba, which {' and '.join(NUMBA_IN)} alone may"
            if library == "clingo" and not name.startswith(CLINGO_IN):
                yield f"{name} uses clingo, which {' and '.join(CLINGO_IN)} alone may"


def rooms(root: Path, packages: tuple[str, ...] = MEASURED) -> dict[str, set[str]]:
    """Return which rooms each room imports. A room is a folder of modules, or a module beside such folders."""
    known = {short(path, root)[:-3].replace("/", ".").removesuffix(".__init__") for path in modules(root, packages)}
    folders = {module for module in known if (root / module.replace(".", "/")).is_dir()}

    def room(module: str) -> str:
        return module if module in folders or module.count(".") == 1 else module.rpartition(".")[0]

    edges: dict[str, set[str]] = defaultdict(set)
    for path in modules(root, packages):
        own = room(short(path, root)[:-3].replace("/", ".").removesuffix(".__init__"))
        edges[own] |= set()
        for module, name in imports(path):
            target = f"{module}.{name}" if f"{module}.{name}" in known else module
            if target in known and room(target) != own:
                edges[own].add(room(target))
    return dict(edges)


def circles(root: Path) -> Iterator[str]:
    """Imports among packages and among rooms form no circle."""
    edges, done = rooms(root), set[str]()

    def visit(room: str, way: tuple[str, ...]) -> Iterator[str]:
        if room in way:
            yield " -> ".join((*way[way.index(room) :], room))
        elif room not in done:
            for other in sorted(edges.get(room, ())):
                yield from visit(other, (*way, room))
            done.add(room)

    for room in sorted(edges):
        yield from visit(room, ())


def crowded_folders(root: Path) -> Iterator[str]:
    """A folder holds at most a dozen modules."""
    count: dict[Path, int] = defaultdict(int)
    for path in modules(root, MEASURED):
        count[path.parent] += path.name != "__init__.py"
    for folder, number in sorted(count.items()):
        if number > MAX_MODULES:
            yield f"{short(folder, root)} holds {number} modules, at most {MAX_MODULES}"


def public_values(path: Path) -> Iterator[str]:
    """Yield the public classes, constants and type aliases that a module defines."""
    for node in tree_of(path).body:
        if isinstance(node, ast.ClassDef):
            names = [node.name]
        elif isinstance(node, ast.Assign | ast.AnnAssign):
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            flat = [part for t in targets for part in (t.elts if isinstance(t, ast.Tuple) else [t])]
            names = [t.id for t in flat if isinstance(t, ast.Name) and t.id[0].isupper()]
        else:
            continue
        yield from (name for name in names if not name.startswith("_"))


def names_with_two_meanings(root: Path) -> Iterator[str]:
    """No two public classes, constants or type aliases bear one name; the face is a house of its own."""
    for packages in (tuple(package for package in MEASURED if package != FACE), (FACE,)):
        places: dict[str, list[str]] = defaultdict(list)
        for path in modules(root, packages):
            for name in public_values(path):
                # A type variable stands for nothing of the project's, and Python gives the other name its meaning.
                if len(name) > 1 and name != "TYPE_CHECKING":
                    places[name].append(short(path, root))
        for name, where in sorted(places.items()):
            if len(where) > 1:
                yield f"{name} stands in {', '.join(where)}"


def vague_constants(root: Path) -> Iterator[str]:
    """A constant is named by what it bounds."""
    for path in modules(root, MEASURED):
        for name in set(public_values(path)) & VAGUE:
            yield f"{short(path, root)}: {name} does not say what it bounds"


def docstrings(path: Path) -> Iterator[tuple[int, str]]:
    """Yield (line, text) of each docstring of a module, its classes and functions."""
    for node in nodes_of(path):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef):
            text = ast.get_docstring(node)
            if text:
                yield getattr(node, "lineno", 1), text


def riddles(root: Path) -> Iterator[str]:
    """A docstring begins with what is returned or done, not with a subordinate clause."""
    for path in modules(root, MEASURED):
        for line, text in docstrings(path):
            if RIDDLE.match(text):
                yield f"{short(path, root)}:{line}: {text.splitlines()[0]}"


def long_docstrings(root: Path) -> Iterator[str]:
    """A docstring that no user reads has one line, examples aside: the name and the types say the rest."""
    for path in modules(root):
        for node in nodes_of(path):
            if isinstance(node, ast.FunctionDef) and node.name.startswith("_") and not node.name.endswith("__"):
                text = ast.get_docstring(node) or ""
                if "\n" in text and ">>>" not in text:
                    yield f"{short(path, root)}:{node.lineno}: the docstring of {node.name} has more than one line"


def persons(root: Path) -> Iterator[str]:
    """Comments and docstrings speak of the robot, not of him."""
    for package in MEASURED:
        words = found = 0
        for path in modules(root, (package,)):
            tokens = tokenize.generate_tokens(io.StringIO(path.read_text()).readline)
            texts = [token.string for token in tokens if token.type == tokenize.COMMENT]
            texts += [text for _, text in docstrings(path)]
            words += sum(len(text.split()) for text in texts)
            found += sum(len(PERSON.findall(text)) for text in texts)
        if found > PERSON_PER_THOUSAND * words / 1000:
            yield f"{package}: he, his or him {found} times in {words} words"
    for path in sorted((root / "examples").rglob("*.lp")):
        if PERSON.search(path.read_text()):
            yield f"{short(path, root)} speaks of him"


def shapeless_modules(root: Path) -> Iterator[str]:
    """A module has a concept: a docstring, a name, and no more than 400 lines beside docstrings."""
    for path in modules(root, MEASURED):
        name = short(path, root)
        documented = sum(text.count("\n") + 1 for _, text in docstrings(path))
        lines = len(path.read_text().splitlines()) - documented
        if lines > MAX_LINES:
            yield f"{name} has {lines} lines beside its docstrings, at most {MAX_LINES}"
        if path.stem in EMPTY_NAMES:
            yield f"{name} is named after no concept"
        if len((ast.get_docstring(tree_of(path)) or "").split()) < 3:
            yield f"{name} does not say what it is"


def code_in_fronts(root: Path) -> Iterator[str]:
    """An `__init__.py` holds a docstring alone; those in FRONTS_WITH_CODE also what is said there."""
    for path in modules(root):
        if path.name == "__init__.py":
            allowed = (ast.Expr, *FRONTS_WITH_CODE.get(short(path, root), ()))
            if not all(isinstance(node, allowed) for node in tree_of(path).body):
                yield f"{short(path, root)} has code"


def unlisted_modules(root: Path) -> Iterator[str]:
    """The docstring of a room's `__init__.py` names each of its modules."""
    for path in modules(root):
        if path.name == "__init__.py":
            text = ast.get_docstring(tree_of(path)) or ""
            for other in sorted(path.parent.iterdir()):
                room = other.is_dir() and (other / "__init__.py").exists()
                if (room or (other.suffix == ".py" and other != path)) and not re.search(rf"\b{other.stem}\b", text):
                    yield f"{short(path, root)} does not list {other.stem}"


def inherited_classes(root: Path) -> Iterator[str]:
    """No class of ours inherits from another one of ours: parts are put together, not mixed in."""
    ours = {node.name for path in modules(root) for node in tree_of(path).body if isinstance(node, ast.ClassDef)}
    for path in modules(root):
        for node in nodes_of(path):
            if isinstance(node, ast.ClassDef) and not node.name.endswith("Error"):
                for base in node.bases:
                    if isinstance(base, ast.Name) and base.id in ours:
                        yield f"{short(path, root)}: {node.name} inherits from {base.id}"


def is_frozen(node: ast.ClassDef) -> bool:
    """Return whether a class is a NamedTuple or a frozen dataclass."""
    marks = [ast.unparse(part) for part in (*node.decorator_list, *node.bases)]
    return any(mark == "NamedTuple" or ("dataclass" in mark and "frozen=True" in mark) for mark in marks)


def thunks(root: Path) -> Iterator[str]:
    """A frozen value holds values, not functions that are still to be called."""
    for path in modules(root, ("kb", "planner", "simulator", "utak")):
        aliases = {
            target.id
            for node in tree_of(path).body
            if isinstance(node, ast.Assign) and ast.unparse(node.value).startswith("Callable[[],")
            for target in node.targets
            if isinstance(target, ast.Name)
        }
        for node in nodes_of(path):
            if isinstance(node, ast.ClassDef) and is_frozen(node):
                for field in node.body:
                    if isinstance(field, ast.AnnAssign):
                        written = ast.unparse(field.annotation)
                        if "Callable[[]," in written or set(re.findall(r"\w+", written)) & aliases:
                            yield f"{short(path, root)}: {node.name}.{ast.unparse(field.target)} is still to be called"


def words_of_simulator(root: Path) -> Iterator[str]:
    """Nothing below the simulator speaks of it, in a name, a string or a comment."""
    for path in modules(root, ("geometry", "kb", "planner")):
        kinds = (tokenize.NAME, tokenize.STRING, tokenize.COMMENT)
        text = path.read_text()
        for token in tokenize.generate_tokens(io.StringIO(text).readline) if "simulator" in text else ():
            if token.type in kinds and "simulator" in token.string:
                yield f"{short(path, root)}:{token.start[0]} speaks of the simulator"


def encodings_that_include(root: Path) -> Iterator[str]:
    """Encodings are loaded by one loader: none includes another or runs a script."""
    for path in sorted([*(root / "kb").rglob("*.lp"), *(root / "planner").rglob("*.lp")]):
        for word in ("#include", "#script"):
            if word in path.read_text():
                yield f"{short(path, root)} has {word}"


def patched_globals(root: Path) -> Iterator[str]:
    """Tests give another part at a seam; they put nothing in the place of what a module or a class of ours defines.

    Programs in the strings of tests, which run in processes of their own, are tests, too. Not meant is the robot of
    tests/simulator/scripted_robot.py: it takes the place of a whole module in `sys.modules`.
    """
    for path in sorted((root / "tests").rglob("*.py")):
        for line, program in [(0, tree_of(path)), *_programs_in(tree_of(path))]:
            named = _bound_names(program)
            for node in ast.walk(program):
                for target in _patched(node):
                    text = target.value if isinstance(target, ast.Constant) else ast.unparse(target)
                    if _is_ours(root, target, named):
                        yield f"{short(path, root)}:{line or node.lineno} patches {text}"


# The calls of Python, of pytest's MonkeyPatch under whatever name, and of unittest.mock that put in or take away.
PATCHING = re.compile(
    r"(.*\.)?(set|del)(attr|item)|(unittest\.)?(mock\.|mocker\.)?patch(\.(object|multiple|dict))?", re.DOTALL
)
PATCHING_NAMES = {"setattr", "delattr", "setitem", "delitem", "patch", "object", "multiple", "dict"}  # their last words
PATCHED_ARGUMENTS = ("target", "dic", "in_dict")  # the names of their first arguments


def _programs_in(tree: ast.Module) -> Iterator[tuple[int, ast.Module]]:
    """Yield (line, tree) of each string of a module that is a program with an import."""
    for node in ast.walk(tree):
        parts = node.values if isinstance(node, ast.JoinedStr) else [node]
        text = "".join(str(part.value) if isinstance(part, ast.Constant) else "_" for part in parts)
        if "import " in text and isinstance(node, ast.JoinedStr | ast.Constant):
            with suppress(SyntaxError):
                yield node.lineno, ast.parse(text)


def _patched(node: ast.AST) -> Iterator[ast.expr]:
    """Yield the expressions for that in which a statement or a call puts something else."""
    last = getattr(node.func, "attr", getattr(node.func, "id", "")) if isinstance(node, ast.Call) else ""
    if isinstance(node, ast.Call) and last in PATCHING_NAMES and PATCHING.fullmatch(ast.unparse(node.func)):
        yield from node.args[:1]
        yield from (word.value for word in node.keywords if word.arg in PATCHED_ARGUMENTS)
    elif isinstance(node, ast.Attribute | ast.Subscript) and isinstance(node.ctx, ast.Store | ast.Del):
        yield node.value


def _bound_names(tree: ast.Module) -> dict[str, str]:
    """Return the dotted names of ours that a program, at whatever depth, binds to names."""
    named = {}
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            for alias in node.names:
                whole = alias.name if alias.asname else alias.name.split(".")[0]
                named[alias.asname or whole] = whole
        elif isinstance(node, ast.ImportFrom) and node.module:
            named |= {alias.asname or alias.name: f"{node.module}.{alias.name}" for alias in node.names}
    for node in ast.walk(tree):
        if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name):
            value = node.value
            if isinstance(value, ast.Call) and ast.unparse(value.func).endswith("import_module") and value.args:
                named.setdefault(node.targets[0].id, str(getattr(value.args[0], "value", "")))
            elif isinstance(value, ast.Name | ast.Attribute):
                first, dot, rest = ast.unparse(value).partition(".")
                named.setdefault(node.targets[0].id, named.get(first, "") + dot + rest)
    return {name: whole for name, whole in named.items() if in_house(whole).split(".")[0] in PATCHED_PACKAGES}


def _is_ours(root: Path, target: ast.expr, named: dict[str, str]) -> bool:
    """Return whether an expression is a module or class of ours or its `__dict__`, or a string names a part of one."""
    if isinstance(target, ast.Constant):
        return _is_module_or_class(root, str(target.value).rpartition(".")[0])
    if isinstance(target, ast.Subscript) and ast.unparse(target.value) == "sys.modules":
        return isinstance(target.slice, ast.Constant) and _is_module_or_class(root, str(target.slice.value))
    if isinstance(target, ast.Call) and ast.unparse(target.func) == "vars" and target.args:
        return _is_ours(root, target.args[0], named)
    first, dot, rest = ast.unparse(target).removesuffix(".__dict__").partition(".")
    return first in named and _is_module_or_class(root, named[first] + dot + rest)


def _is_module_or_class(root: Path, dotted: str) -> bool:
    """Return whether a dotted name is that of a module or package of ours, or of a class in one."""
    module, _, last = in_house(dotted).rpartition(".")
    written_as_class = re.fullmatch(r"[A-Z]\w*[a-z]\w*", last)
    return _is_module(root, dotted) or (written_as_class is not None and _is_module(root, module))


def _is_module(root: Path, dotted: str) -> bool:
    """Return whether a dotted name is that of a module or package of ours."""
    dotted = in_house(dotted)
    place = root / dotted.replace(".", "/")
    return dotted.split(".")[0] in PATCHED_PACKAGES and (place.is_dir() or place.with_suffix(".py").exists())


LAWS = (
    package_imports,
    imports_from_the_top,
    relative_imports,
    others_used,
    circles,
    crowded_folders,
    names_with_two_meanings,
    vague_constants,
    riddles,
    long_docstrings,
    persons,
    shapeless_modules,
    code_in_fronts,
    unlisted_modules,
    inherited_classes,
    thunks,
    words_of_simulator,
    encodings_that_include,
    patched_globals,
)
