"""Checks of places: whether a thing or the robot may be put there, on the table, on floor, over nothing else."""

from collections.abc import Iterable, Sequence
from typing import Any

import shapely

from utak.simulator.world.world import World

MAX_TOUCHING_AREA = 1e-9  # square squares; shapes with a smaller common area only touch (docs/files.md)
# Squares; a narrower gap between shapes is no floor, because the physics does not resolve it (docs/files.md).
MIN_GAP_WIDTH = 1e-6
# Squares; shrinking and cutting corners moves the edge of the floor by less than this from its true place.
MAX_DISTANCE_TO_FLOOR = 1e-4

NamedShape = tuple[str, Any]  # what stands on the table, as messages name it, and its shape in squares, table frame


def standing(world: World) -> list[NamedShape]:
    """Return what never moves on a table."""
    return [("the verge", world.verge), *((thing.name, thing.polygon) for thing in world.fixed)]


def thing_misplaced(world: World, name: str, polygon: Any, others: Iterable[NamedShape]) -> str:
    """Return why a thing cannot lie at `polygon` among others, in words; "" when it can."""
    if polygon.difference(shapely.box(0, 0, world.width, world.height)).area > MAX_TOUCHING_AREA:
        x0, y0, x1, y1 = (f"{value:g}" for value in polygon.bounds)
        return f"{name} would reach beyond the table: ({x0}, {y0}) to ({x1}, {y1})"
    for other, shape in others:
        common = polygon.intersection(shape).area
        if common > MAX_TOUCHING_AREA:
            return f"{name} would overlap {other} by {common:.3g} squares"
    return ""


def robot_misplaced(world: World, here: Any, others: Sequence[NamedShape]) -> str:
    """Return why the robot cannot stand at a point among others, in words; "" when it can."""
    where = f"({here.x:g}, {here.y:g})"
    if not (0 <= here.x <= world.width and 0 <= here.y <= world.height):
        return f"Utak would stand off the table, at {where}"
    for other, shape in others:
        if shape.contains(here):
            return f"Utak would stand inside {other}, at {where}"
    if not touches_floor(here, [shape for _, shape in others], world.width, world.height):
        return f"Utak would stand where no floor is, at {where}"
    return ""


def touches_floor(here: Any, shapes: Sequence[Any], width: int, height: int) -> bool:
    """Return whether a point lies on the floor or on its edge; gaps narrower than `MIN_GAP_WIDTH` are no floor."""
    # Only shapes within one square of the point are examined, so that the test is fast on a large table.
    about = shapely.box(0, 0, width, height).intersection(shapely.box(*here.buffer(1.0).bounds))
    floor = about.difference(shapely.union_all([shape.intersection(about) for shape in shapes]))
    wide = floor.buffer(-MIN_GAP_WIDTH / 2, join_style="mitre")
    return not wide.is_empty and bool(wide.distance(here) <= MAX_DISTANCE_TO_FLOOR)
