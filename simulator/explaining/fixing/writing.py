"""A scenario as a folder of files, from its values."""

from pathlib import Path
from typing import Any

from utak.simulator.explaining.fixing.recorded import start_text
from utak.simulator.scenario.folder_writer import whole_folder
from utak.simulator.scenario.scenario import Scenario, read_scenario
from utak.simulator.world.world import World


def write_scenario(scenario: Scenario, folder: Path | str) -> None:
    """Write a scenario as a folder that `utak check` accepts; an existing folder must be empty."""
    with whole_folder(Path(folder)) as part:
        for name, text in scenario_files(scenario).items():
            (part / name).write_text(text)
        read_scenario(part)


def scenario_files(scenario: Scenario) -> dict[str, str]:
    """Return the files of a scenario: text by name."""
    task = scenario.task
    parameters = {name: parameter.kind for name, parameter in task.parameters.items()}
    files = {
        "world.lp": world_text(scenario.world),
        "start.lp": start_text(parameters, [(claim.fact, claim.confidence) for claim in task.claims]),
        "goal.lp": "".join(f"{goal}.\n" for goal in task.goals),
    }
    if scenario.expectations:
        files["expect.lp"] = "".join(f"{fact}.\n" for fact in scenario.expectations)
    return files


def world_text(world: World) -> str:
    """Return world.lp for a world; reading it gives the same numbers."""
    rows = [f"table({world.width},{world.height}).", f'verge("{_wkt(world.verge)}").']
    for kind, things in (("object", world.movable), ("fixed", world.fixed)):
        rows += [f'{kind}({thing.name},{thing.colour},"{_wkt(thing.polygon)}").' for thing in things]
    x, y = world.utak
    rows.append(f'utak("POINT ({_number(x)} {_number(y)})",{world.heading}).')
    return "\n".join(rows) + "\n"


def _wkt(shape: Any) -> str:
    """Return a polygon or several as WKT, with all digits."""
    if shape.geom_type == "Polygon":
        return f"POLYGON {_rings(shape)}"
    return f"MULTIPOLYGON ({', '.join(_rings(part) for part in shape.geoms)})"


def _rings(polygon: Any) -> str:
    """Return the rings of a polygon as WKT has them."""
    rings = [
        ", ".join(f"{_number(x)} {_number(y)}" for x, y in ring.coords)
        for ring in (polygon.exterior, *polygon.interiors)
    ]
    return "(" + ", ".join(f"({ring})" for ring in rings) + ")"


def _number(value: float) -> str:
    """Return a number with all its digits; whole ones without a point."""
    return str(int(value)) if float(value).is_integer() else repr(float(value))
