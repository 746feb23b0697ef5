"""Which tasks are asked for: worlds of benchmarks.worlds.several by kind and seed, and puzzles in scenario folders."""

from itertools import product
from pathlib import Path
from typing import NamedTuple

from utak.simulator.scenario.scenario import Scenario, read_scenario

PUZZLE_KIND = "pushworld"
TOUCHING_KIND_SUFFIX = "_touching"  # of puzzles in which a thing of the task touches another one at the start
AT_WALL_VARIANT = "at wall"  # puzzles in which a thing of the task touches the verge at the start, and no other thing
SOLVABLE_FILE = "SOLVABLE.tsv"  # beside the puzzles: name, verdict, ...; a head line first
SOLVABLE_WORD = "solvable"  # the verdict of a puzzle that can be solved, pulling allowed
MAX_TOUCHING_GAP = 1e-6  # squares between things that touch


class AskedRun(NamedTuple):
    """A task to be run.

    Attributes
    ----------
    kind : of benchmarks.worlds.several.kinds, or "pushworld", or "pushworld_touching".
    name : its seed, or the name of the puzzle's folder.
    folder : the folder of a puzzle; "" for a random world.
    solvable : whether a puzzle is known to be solvable when the robot may pull; False for a random world.
    variant : "at wall" of a puzzle in which a thing of the task touches the verge at the start; else "".
    """

    kind: str
    name: str
    folder: str = ""
    solvable: bool = False
    variant: str = ""


def random_tasks(kinds: list[str], seed: int, count: int) -> list[AskedRun]:
    """Return `count` random worlds of each kind from a seed on, the kinds in turn."""
    return [AskedRun(kind, str(number)) for number, kind in product(range(seed, seed + count), kinds)]


def puzzles(folder: Path) -> list[AskedRun]:
    """Return the puzzles in a folder, sorted by name; those in which a thing of the task touches another one last.

    Raises OSError when the folder cannot be read or holds no puzzles, BadInputError when a scenario has errors.
    """
    solvable = set()
    table = folder / SOLVABLE_FILE
    if table.is_file():
        cells = [line.split("\t") for line in table.read_text().splitlines()[1:]]
        solvable = {line[0] for line in cells if len(line) > 1 and line[1] == SOLVABLE_WORD}
    asked = []
    for place in sorted(folder.iterdir()):
        if (place / "goal.lp").is_file():
            scenario = read_scenario(place)
            kind = PUZZLE_KIND + TOUCHING_KIND_SUFFIX * is_touching(scenario)
            variant = AT_WALL_VARIANT * is_at_wall(scenario)
            asked.append(AskedRun(kind, place.name, str(place.resolve()), place.name in solvable, variant))
    if not asked:
        raise FileNotFoundError(f"no puzzles in {folder}: a puzzle is a folder with goal.lp")
    return sorted(asked)


def is_touching(scenario: Scenario) -> bool:
    """Return whether a thing that expect.lp names touches another thing (not the verge) at the start."""
    things = [*scenario.world.movable, *scenario.world.fixed]
    meant = _things_meant(scenario)
    return any(
        one.polygon.distance(other.polygon) <= MAX_TOUCHING_GAP
        for one, other in product(things, things)
        if one.name in meant and one is not other
    )


def is_at_wall(scenario: Scenario) -> bool:
    """Return whether a thing that expect.lp names touches the verge at the start."""
    world, meant = scenario.world, _things_meant(scenario)
    return any(t.polygon.distance(world.verge) <= MAX_TOUCHING_GAP for t in world.movable if t.name in meant)


def _things_meant(scenario: Scenario) -> set[str]:
    """Return the names that expect.lp mentions."""
    return {str(term) for fact in scenario.expectations or () for term in fact.args}
