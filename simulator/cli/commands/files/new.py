"""`utak new`: write a small scenario to start from."""

import argparse
from importlib.resources import files
from pathlib import Path

from utak.simulator.scenario.folder_writer import write_folder
from utak.simulator.terminal import exits

# The files of the new scenario, which lie in a folder here: text by name.
NEW_SCENARIO_FILES = {
    name: (files(__package__) / "new_scenario" / name).read_text(encoding="ascii")
    for name in ("world.txt", "start.lp", "goal.lp", "expect.lp")
}


def execute(options: argparse.Namespace) -> int:
    """Write the scenario; existing files are not overwritten."""
    folder = Path(options.folder)
    write_folder(folder, NEW_SCENARIO_FILES)
    print(f"{folder}: {', '.join(NEW_SCENARIO_FILES)}")
    return exits.SUCCESS
