"""`utak import`: write the scenario of a file of another format."""

import argparse
import re
import sys
from importlib import import_module
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

from utak.kb.language.diagnostics import BadInputError, CannotOpenError
from utak.kb.language.source_text import source_from_bytes
from utak.simulator.importing.imported import Imported, ImportOptions
from utak.simulator.scenario.folder_writer import write_folder
from utak.simulator.scenario.scenario import read_scenario
from utak.simulator.terminal import exits
from utak.simulator.terminal.outcome import UsageError


class ImportFormat(NamedTuple):
    """A format that can be read."""

    module: str  # the name of the module in simulator.importing that reads it.
    takes: tuple[str, ...] = ()  # the options that it heeds, besides --scale, --goal and --untrusted
    shrinks: bool = False  # whether --scale may be 1/N


# What the extra `import` installs: the package, by the module that is missing without it.
LIBRARIES = {"yaml": "PyYAML", "PIL": "pillow", "svg": "svg.path"}
FORMATS = {  # by the end of a file's name
    ".pwp": ImportFormat("pushworld"),
    **dict.fromkeys((".xsb", ".sok", ".txt"), ImportFormat("sokoban", ("level",))),
    ".map": ImportFormat("movingai_map", ("start", "origin"), True),
    ".svg": ImportFormat("namosim"),
    **dict.fromkeys((".yaml", ".yml", ".pgm", ".png", ".bmp"), ImportFormat("ros_map", ("start", "unknown"), True)),
}


def execute(options: argparse.Namespace) -> int:
    """Read the file, check the scenario, and write it; what it does not say as the file does goes to stderr."""
    path = Path(options.file)
    form = FORMATS.get(path.suffix.lower())
    wrong = _misused(options, form)
    if form is None or wrong:
        raise UsageError(wrong)
    heeded = ImportOptions(
        scale=options.scale,
        level=options.level or 1,
        start=options.start,
        from_top=options.origin == "top",
        unknown_is_floor=options.unknown == "floor",
        untrusted=options.untrusted,
    )
    try:
        reader = import_module(f"utak.simulator.importing.{form.module}")
    except ImportError as missing:
        name = LIBRARIES[str(missing.name).partition(".")[0]]
        raise CannotOpenError(
            options.file, f"{name} is not installed: pip install {' '.join(LIBRARIES.values())}"
        ) from None
    imported: Imported = reader.read(path, heeded)
    files = scenario_files(imported, path.name, options.goal)
    _check(files, options.file, options.goal)
    write_folder(Path(options.folder), files, options.force)
    print(f"{options.folder}: {', '.join(files)}")
    for note in imported.notes:
        print(f"utak import: {note}", file=sys.stderr)
    return exits.SUCCESS


def _misused(options: argparse.Namespace, form: ImportFormat | None) -> str:
    """Return why the command line does not fit the format; '' when it does."""
    if form is None:
        return f"{options.file}: the end of the name tells no format; known are {', '.join(FORMATS)}"
    for name in ("level", "start", "origin", "unknown"):
        if getattr(options, name) is not None and name not in form.takes:
            return f"--{name} says nothing about {Path(options.file).suffix} files"
    if options.scale is not None and options.scale < 1 and not form.shrinks:
        return f"--scale {options.scale}: a cell of a {Path(options.file).suffix} file needs one square at least"
    return ""


def scenario_files(imported: Imported, name: str, goal: str | None = None) -> dict[str, str]:
    """Return the texts of a scenario's files by their names."""
    comments = [f"{imported.title}, from {name}", *imported.notes]
    head = "".join(f"% {_printable(comment)}\n" for comment in comments)
    files = {
        imported.world_file: imported.world_text,
        "start.lp": head + "".join(f"{fact}\n" for fact in imported.start),
        "goal.lp": "".join(f"{fact}\n" for fact in ((goal,) if goal is not None else imported.goal)),
    }
    if imported.expect and goal is None:
        files["expect.lp"] = "".join(f"{fact}\n" for fact in imported.expect)
    return files


def _printable(text: str) -> str:
    """Return a text with a question mark for every character that a comment of a fact file cannot have."""
    return re.sub(r"[^ -~]", "?", text)


def _check(files: dict[str, str], name: str, goal: str | None) -> None:
    """Raise BadInputError when files make no scenario that can be run. name : the file that was read."""
    if goal is not None:
        source_from_bytes("--goal", goal.encode("utf-8", "surrogateescape"))
        files = files | {"goal.lp": goal}  # without a line end: an error at its end is on its line
    with TemporaryDirectory(prefix="utak-import-") as place:
        folder = Path(place) / "scenario"
        write_folder(folder, files)
        try:
            read_scenario(folder)
        except BadInputError as bad:
            given = [problem for problem in bad.problems if goal is not None and Path(problem.file).name == "goal.lp"]
            if given:
                raise BadInputError(problem._replace(file="--goal") for problem in given) from None
            raise BadInputError.at(name, f"what it shows is no scenario: {bad.problems[0].what}") from None
