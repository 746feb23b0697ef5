"""A scenario as a folder of files, from its values."""

from pathlib import Path
from typing import Any

import shapely

from utak.kb.task.task import start_facts_of
from utak.simulator.episode.record import fact_lines
from utak.simulator.scenario.folder_writer import whole_folder
from utak.simulator.scenario.scenario import Scenario, read_scenario


def write_scenario(scenario: Scenario, folder: Path | str) -> None:
    """Write a scenario as a folder that `utak check` accepts; an existing folder must be empty."""
    with whole_folder(Path(folder)) as part:
        for name, text in scenario_files(scenario).items():
            (part / name).write_text(text)
        read_scenario(part)


def scenario_files(scenario: Scenario) -> dict[str, str]:
    """Return the files of a scenario: text by name. Reading them gives the same numbers."""
    world = scenario.world
    facts = [f"table({world.width},{world.height})", f'verge("{_wkt(world.verge)}")']
    for kind, things in (("object", world.movable), ("fixed", world.fixed)):
        facts += [f'{kind}({thing.name},{thing.colour},"{_wkt(thing.polygon)}")' for thing in things]
    files = {
        "world.lp": fact_lines([*facts, f'utak("{_wkt(shapely.Point(world.utak))}",{world.heading})']),
        "start.lp": fact_lines(start_facts_of(scenario.task)),
        "goal.lp": fact_lines(scenario.task.goals),
    }
    return files | ({"expect.lp": fact_lines(scenario.expectations)} if scenario.expectations else {})


def _wkt(shape: Any) -> str:
    """Return a shape as WKT, with all digits."""
    text: str = shapely.to_wkt(shape, rounding_precision=-1, trim=True)
    return text
