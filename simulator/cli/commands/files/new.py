"""`utak new`: write a small scenario to start from."""

import argparse
from pathlib import Path
from typing import Any

from utak.simulator.terminal import exits

# The files of the new scenario: text by name.
NEW_SCENARIO_FILES = {
    "world.txt": """\
bbbbbbbbbbbbbbbbbbbbbbbb
b......................b
b......................b
b..........cccc........b
b..........cccc........b
b......................b
b......................b
b...ggg................b
b...ggg................b
b...ggg................b
b......................b
b......................b
b................U.....b
b......................b
b......................b
bbbbbbbbbbbbbbbbbbbbbbbb
""",
    "start.lp": """\
% The objects that the task mentions, and what is claimed about them.
object(x).
shape(x, square).
""",
    "goal.lp": """\
% What shall hold at the end.
at(utak, x).
""",
    "expect.lp": """\
% What a test checks, in squares of the table: x to the east, y to the north, (0, 0) in the southwest.
near(utak, "POLYGON ((4 6, 7 6, 7 9, 4 9, 4 6))", 2).
""",
}


def add(parts: Any) -> None:
    """Declare the subcommand."""
    part = parts.add_parser("new", help="write a small scenario to start from")
    part.add_argument("folder", metavar="FOLDER", help="the folder to make")
    part.set_defaults(execute=execute)


def execute(options: argparse.Namespace) -> int:
    """Write the scenario; existing files are not overwritten."""
    from utak.simulator.scenario.folder_writer import write_folder

    folder = Path(options.folder)
    write_folder(folder, NEW_SCENARIO_FILES)
    print(f"{folder}: {', '.join(NEW_SCENARIO_FILES)}")
    return exits.SUCCESS
