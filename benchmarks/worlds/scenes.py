"""A scenario as a frozen value, with the truth about it, and its four files."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Protocol

import numpy as np
import shapely
from shapely import Point, Polygon
from shapely.geometry.base import BaseGeometry

from benchmarks.worlds.floorplans import FloorPlan

RULES_FILE = "rules.lp"  # beside the four files of a scenario: rules for `--kb`


@dataclass(frozen=True)
class PlacedThing:
    """An object of the world: name, colour, the class of its shape, and its polygon in squares of the table."""

    name: str
    colour: str
    shape: str
    polygon: Polygon
    fixed: bool = False


@dataclass(frozen=True)
class TaskTexts:
    """The texts of start.lp, goal.lp and expect.lp.

    `unable` says why the task cannot be done, empty when it can. `rules` are a user's rules for the run, mostly none.
    """

    start: str
    goal: str
    expect: str
    unable: str = ""
    rules: str = ""


@dataclass(frozen=True)
class RandomScenario:
    """One random world with its task.

    `heading` is the direction that the robot faces, degrees counter-clockwise from table north. `target` is the region
    that a point must reach (tasks 1 to 3; empty otherwise), in squares, table frame. `missing` is by how much a door is
    too narrow for the object to be carried (0 where no door is).
    """

    task: int
    seed: int
    plan: FloorPlan
    things: tuple[PlacedThing, ...]
    utak: Point
    heading: int
    texts: TaskTexts
    target: BaseGeometry
    missing: float = 0.0

    @property
    def name(self) -> str:
        """The name of its folder."""
        return f"task{self.task}-{self.seed:03d}"

    @property
    def possible(self) -> bool:
        """Whether the task can be done."""
        return not self.texts.unable

    @property
    def world(self) -> str:
        """The text of world.lp."""
        return world_text(self.plan, self.utak, self.heading, self.things)


def random_scenario(
    task: int,
    seed: int,
    plan: FloorPlan,
    things: tuple[PlacedThing, ...],
    utak: Point | None,
    heading: int,
    texts: TaskTexts,
    target: BaseGeometry,
    missing: float = 0.0,
) -> RandomScenario | None:
    """Return the scenario, with `fails` expected where the task cannot be done; None without a place for the robot."""
    if utak is None:
        return None
    if texts.unable:
        texts = replace(texts, expect=f"% {texts.unable}\nfails.\n{texts.expect}")
    return RandomScenario(task, seed, plan, things, utak, heading, texts, target, missing)


# Makes a world of (random numbers, seed, whether the task cannot be done); None when the things find no place.
Maker = Callable[[np.random.Generator, int, bool], RandomScenario | None]


class LaidFloor(Protocol):
    """A floor on a table of width x height squares."""

    @property
    def width(self) -> int:
        """The width of the table, in squares."""
        ...

    @property
    def height(self) -> int:
        """The height of the table, in squares."""
        ...

    @property
    def verge(self) -> BaseGeometry:
        """All that is not floor, in squares, table frame."""
        ...


class WorldWithTask(Protocol):
    """A world with a task, whatever made it."""

    @property
    def world(self) -> str:
        """The text of world.lp."""
        ...

    @property
    def texts(self) -> TaskTexts:
        """The texts of start.lp, goal.lp and expect.lp."""
        ...


def world_text(plan: LaidFloor, utak: Point, heading: int, things: Iterable[PlacedThing]) -> str:
    """Return the text of world.lp."""
    lines = [
        f"table({plan.width}, {plan.height}).",
        f'verge("{wkt(plan.verge)}").',
        f'utak("{wkt(utak)}", {heading}).',
    ]
    for thing in things:
        kind = "fixed" if thing.fixed else "object"
        lines.append(f'{kind}({thing.name}, {thing.colour}, "{wkt(thing.polygon)}").')
    return "\n".join(lines) + "\n"


def write(scenario: WorldWithTask, folder: Path) -> Path:
    """Write a scenario's four files, and RULES_FILE, into a folder, made when it is not there; return the folder."""
    folder.mkdir(parents=True, exist_ok=True)
    texts = scenario.texts
    files = {"world": scenario.world, "start": texts.start, "goal": texts.goal, "expect": texts.expect}
    for name, text in files.items():
        (folder / f"{name}.lp").write_text(text)
    if texts.rules:
        (folder / RULES_FILE).write_text(texts.rules)
    return folder


def wkt(shape: BaseGeometry) -> str:
    """Return well-known text with up to six decimals and no needless zeros."""
    return str(shapely.to_wkt(shape, rounding_precision=6, trim=True))
