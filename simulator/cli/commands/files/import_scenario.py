"""`utak import`: write the scenario of a file of another format."""

import argparse
import re
import sys
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from utak.kb.language.diagnostics import BadInputError, Problem, SourceSpan
from utak.simulator.terminal import exits
from utak.simulator.terminal.numbers import parse_decimal, parse_whole

if TYPE_CHECKING:
    from utak.simulator.importing.imported import Imported, ImportOptions

MAX_LEVEL_NUMBER = 1_000_000  # the greatest --level; a convention
MAX_START_COORDINATE = 1e7  # the greatest coordinate of --start, in absolute value; a convention
UNKNOWN_CHOICES = ("verge", "floor")  # what cells are of which the source says nothing
# The end of the help text.
FORMATS_HELP = (
    "Formats, by the end of the name: .pwp PushWorld; .xsb, .sok, .txt Sokoban; .map Moving AI; .svg NAMOSIM; "
    ".yaml, .yml, .pgm ROS maps. docs/importing.md says what becomes of each."
)


class ImportFormat(NamedTuple):
    """A format that can be read."""

    module: str  # the name of the module in simulator.importing that reads it.
    takes: tuple[str, ...] = ()  # the options that it heeds, besides --scale, --goal and --untrusted
    shrinks: bool = False  # whether --scale may be 1/N


FORMATS = {  # by the end of a file's name
    ".pwp": ImportFormat("pushworld"),
    **dict.fromkeys((".xsb", ".sok", ".txt"), ImportFormat("sokoban", ("level",))),
    ".map": ImportFormat("movingai_map", ("start", "origin"), True),
    ".svg": ImportFormat("namosim"),
    **dict.fromkeys((".yaml", ".yml", ".pgm"), ImportFormat("ros_map", ("start", "unknown"), True)),
}


def add(parts: Any) -> None:
    """Declare the subcommand."""
    part = parts.add_parser(
        "import",
        help="write the scenario of a file of another format (PushWorld, Sokoban, Moving AI, NAMOSIM, ROS)",
        description="Write the scenario of a file of another format.",
        epilog=FORMATS_HELP,
    )
    part.add_argument("file", metavar="FILE", help="the file; the end of its name tells the format")
    part.add_argument("folder", metavar="FOLDER", help="the folder to make")
    part.add_argument(
        "--scale", type=_scale, metavar="N|1/N", help="squares along a cell; 1/N (maps): one square for N x N cells"
    )
    part.add_argument("--level", type=_level, metavar="N", help="the level of a Sokoban file (default 1)")
    part.add_argument(
        "--goal", metavar="FACT", help="another goal than that of the file, such as 'in(utak, room(next)).'"
    )
    part.add_argument(
        "--start",
        type=_point,
        metavar="X,Y",
        help="where the robot wakes: cells of a .map, metres of a ROS map",
    )
    part.add_argument(
        "--origin", choices=("bottom", "top"), help="the edge of a .map from which --start counts y (default bottom)"
    )
    part.add_argument("--unknown", choices=UNKNOWN_CHOICES, help="what unknown pixels of a ROS map are (default verge)")
    what = "refuse links that lead out of the file's folder, and images of ROS maps beyond it"
    part.add_argument("--untrusted", action="store_true", help=what)
    part.add_argument("--force", action="store_true", help="replace the scenario in a folder that is not empty")
    part.set_defaults(execute=execute)


def execute(options: argparse.Namespace) -> int:
    """Read the file, check the scenario, and write it; what it does not say as the file does goes to stderr."""
    from importlib import import_module

    from utak.simulator.scenario.folder_writer import write_folder

    path = Path(options.file)
    form = FORMATS.get(path.suffix.lower())
    wrong = _misused(options, form)
    if form is None or wrong:
        print(f"utak import: {wrong}", file=sys.stderr)
        return exits.USAGE
    imported: Imported = import_module(f"utak.simulator.importing.{form.module}").read(path, _options(options))
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


def _options(options: argparse.Namespace) -> "ImportOptions":
    """Return the options for the reader."""
    from utak.simulator.importing.imported import ImportOptions

    return ImportOptions(
        scale=options.scale,
        level=options.level or 1,
        start=options.start,
        from_top=options.origin == "top",
        unknown_is_floor=options.unknown == "floor",
        untrusted=options.untrusted,
    )


def scenario_files(imported: "Imported", name: str, goal: str | None = None) -> dict[str, str]:
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
    from tempfile import TemporaryDirectory

    from utak.kb.language.source_text import source_from_bytes
    from utak.simulator.scenario.folder_writer import write_folder
    from utak.simulator.scenario.scenario import read_scenario

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
            problems = [problem._replace(file="--goal") for problem in given] or [
                Problem(name, SourceSpan(1, 1, 1), f"what it shows is no scenario: {problem.what}")
                for problem in bad.problems[:1]
            ]
            raise BadInputError(problems) from None


def _scale(text: str) -> Fraction:
    """Return the number for `--scale`."""
    from utak.simulator.importing.imported import MAX_CELL_SCALE

    if text.startswith("1/"):
        return Fraction(1, parse_whole(text[2:], 1, MAX_CELL_SCALE))
    return Fraction(parse_whole(text, 1, MAX_CELL_SCALE))


def _level(text: str) -> int:
    """Return the number for `--level`."""
    return parse_whole(text, 1, MAX_LEVEL_NUMBER)


def _point(text: str) -> tuple[float, float]:
    """Return the point for `--start`."""
    parts = text.split(",")
    if len(parts) != 2:
        raise argparse.ArgumentTypeError(f"{text[:40]!r} is no point: write X,Y")
    x, y = (parse_decimal(part, -MAX_START_COORDINATE, MAX_START_COORDINATE) for part in parts)
    return x, y
