"""The value that readers of other formats return, and the options that they are given."""

from collections.abc import Iterable
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, NamedTuple

import numpy as np
import shapely

# Squares by which a thing may end beside its goal in expect.lp. A `pose` holds within a quarter of a square
# (docs/files.md).
GOAL_MARGIN = 0.3
MAX_CELL_SCALE = 64  # the greatest N of N squares along a cell, and of N cells along a square; a convention
COLOUR_LETTERS = "acdefghijklmnopqrstuvwxyz"  # the colours of objects: all letters but b, which is the verge's


@dataclass(frozen=True)
class ImportOptions:
    """Options of reading a file of another format."""

    # Squares for one cell of the source; below 1 only where docs/importing.md allows it. None for the default of the
    # format.
    scale: Fraction | None = None
    level: int = 1  # the number of the level in a file of several, from 1
    # Where the robot wakes (x, y), in the units of the source; None for the default of the format
    start: tuple[float, float] | None = None
    from_top: bool = False  # whether y of `start` counts from the north edge to the south
    unknown_is_floor: bool = False  # whether cells of which the source says nothing are floor; else they are verge
    untrusted: bool = False  # whether files beside the source must lie in its folder


@dataclass(frozen=True)
class Imported:
    """A scenario as it was read of a file of another format."""

    title: str  # what it is, in one line
    world_file: str  # the name of its world's file, world.txt or world.lp.
    world_text: str  # the text of that file
    # The facts of start.lp, goal.lp and expect.lp, each with its full stop; no `expect` for a task whose end cannot be
    # judged.
    start: tuple[str, ...]
    goal: tuple[str, ...]
    expect: tuple[str, ...]
    notes: tuple[str, ...] = ()  # what the scenario does not say as the source does, a sentence each


class DrawnObject(NamedTuple):
    """A movable object of a scenario's world."""

    name: str
    colour: str
    outline: Any  # shapely Polygon, where it lies at first; squares, table frame
    # Whether it alone has its colour. Else nothing tells it from the others, and expect.lp leaves it out.
    unique: bool = True


class ObjectGoal(NamedTuple):
    """An object that shall be brought elsewhere."""

    parameter: str  # the parameter of the task that means it
    thing: DrawnObject
    shift: tuple[float, float]  # how far it shall be brought (x, y), in squares of the table


class TaskFacts(NamedTuple):
    """The facts of a task: those of start.lp, of goal.lp and of expect.lp."""

    start: tuple[str, ...]
    goal: tuple[str, ...]
    expect: tuple[str, ...]


def task_of_objects(goals: Iterable[ObjectGoal], utak: tuple[float, float]) -> TaskFacts:
    """Return the facts of a task that brings objects to places, unturned."""
    start, goal, expect = [], [], []
    for parameter, thing, shift in goals:
        there = shapely.transform(thing.outline, lambda points, shift=shift: points + shift)
        east, north = (decimal(value) for value in there.centroid.coords[0] - np.array(utak))
        start.append(f"object({parameter}). colour({parameter}, {thing.colour}).")
        goal.append(f'pose({parameter}, "POINT ({east} {north})", 0).')
        if thing.unique:
            region = there.buffer(GOAL_MARGIN, join_style="mitre")
            expect.append(f'inside({thing.name}, "{region_text(region)}").')
    return TaskFacts(tuple(start), tuple(goal), tuple(expect))


def decimal(value: float) -> str:
    """Return a coordinate with at most four decimals.

    >>> decimal(-0.00001), decimal(2.5)
    ('0', '2.5')
    """
    return f"{round(value, 4) + 0.0:.4f}".rstrip("0").rstrip(".")


def region_text(region: Any, decimals: int = 6) -> str:
    """Return a shapely geometry as well-known text with at most so many decimals, in squares."""
    text: str = shapely.to_wkt(region, rounding_precision=decimals, trim=True)
    return text
