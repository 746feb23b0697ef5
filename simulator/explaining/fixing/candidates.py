"""Which changes are tried: read from the true world, the task and the run."""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import shapely

from utak.geometry.kernels.arrays import XY, Bools
from utak.geometry.raster.components import components
from utak.planner.stages import stages
from utak.simulator.explaining.fixing.bounds import cannot_pass
from utak.simulator.explaining.fixing.changes import Away, Dropped, Led, Wider, dropped_goals
from utak.simulator.explaining.fixing.gaps import (
    GAP_LENGTH_TOLERANCE,
    WIDTH_STEP,
    Gap,
    GapSide,
    new_doors_of,
    passages_of,
    widened,
)
from utak.simulator.explaining.fixing.leading import free_squares
from utak.simulator.run.session import Result
from utak.simulator.scenario.scenario import Scenario
from utak.simulator.world.world import Thing, World

WALKER_WIDTH = 4.0  # squares; a walking robot passes any doorway so wide: one square, and walls anywhere in 2 others
CARRYING_MARGIN = 3.0  # squares that a doorway may be wider than what is carried, and still be called too narrow
CLOSE_SIGHT = 8  # squares; what is so near is seen through fields of at most 2 x 2 squares (docs/files.md)
MAX_GAPS = 12  # gaps that are tried, the narrowest first; a convention: a cluttered floor has hundreds
GAPS_LOOKED_AT = 4 * MAX_GAPS  # gaps of which it is found out whether they can be wider; a convention
MAX_LED_PLACES = 6  # places to which the robot is led; a convention
SIGHT_DISTANCE = 4.0  # squares; a place from which something is seen closely is at most so far from it; a convention


@dataclass(frozen=True)
class GapRange:
    """The widths of a gap that are tried on one side."""

    gap: Gap  # the gap, and which of its walls gives way
    side: GapSide
    least: int  # about the fewest steps with which what must be carried may pass, by geometry alone; at least 1
    most: int  # the most steps that are tried
    # Whether what must be carried may pass when nothing else is changed; else the gap is tried in pairs alone
    alone: bool = True

    def change(self, steps: int) -> Wider:
        """Return the change by so many steps."""
        return Wider(self.gap, self.side, steps)


@dataclass(frozen=True)
class Candidates:
    """The changes that are tried."""

    dropped: tuple[Dropped, ...]  # goals and constraints
    away: tuple[Away, ...]  # things
    # By gap, the widths on each side where it can be made wider; a gap without any is left out
    ranges: tuple[tuple[GapRange, ...], ...]
    led: tuple[Led, ...]  # places to be seen first


def candidates_of(scenario: Scenario, carried: tuple[Thing, ...], seen_from: list[XY]) -> Candidates:
    """Return the changes that are tried."""
    world = scenario.world
    away = tuple(Away(thing.name) for thing in (*world.movable, *world.fixed))
    size = max((2 * shapely.minimum_bounding_radius(thing.polygon) for thing in carried), default=0.0)
    widest = max(WALKER_WIDTH, size + CARRYING_MARGIN) if carried else WALKER_WIDTH
    passages = passages_of(world)
    ranges: list[tuple[GapRange, ...]] = []
    for gap in (*new_doors_of(world)[:MAX_GAPS], *passages[:GAPS_LOOKED_AT]):
        if gap.width < widest - GAP_LENGTH_TOLERANCE and len(ranges) < MAX_GAPS:
            found = _ranges_of(world, carried, gap, widest)
            ranges += [found] if found else []
    led = tuple(_led_places(scenario, passages, seen_from))
    return Candidates(tuple(dropped_goals(scenario.task)), away, tuple(ranges), led)


def carried_things(scenario: Scenario, held: set[str]) -> tuple[Thing, ...]:
    """Return the things of which one must be carried: those that were held, else all that can be moved."""
    if not any(stage.carried for stage in stages(scenario.task)):
        return ()
    movable = scenario.world.movable
    return tuple(thing for thing in movable if thing.name in held) or movable


def is_out_of_commands(result: Result, max_steps: int) -> bool:
    """Return whether a run ended because no more commands were allowed."""
    return result.verdict == "limit" and result.steps >= max_steps


def _ranges_of(world: World, carried: tuple[Thing, ...], gap: Gap, widest: float) -> tuple[GapRange, ...]:
    """Return the widths of a gap that are tried, by side; () when it cannot be made wider."""
    # So is the lower end, on the side where the gap can be widest, because what cannot pass a gap cannot pass a
    # narrower one; for other sides it is a guess.
    limit = min(widest, max(gap.room, gap.width + 1.0))
    most_wanted = math.floor((limit - gap.width) / WIDTH_STEP + GAP_LENGTH_TOLERANCE)
    most_by_side = {}
    for side in [GapSide.LEFT] if gap.is_new else GapSide:
        low, high = 0, most_wanted + 1
        while high - low > 1:
            middle = high - 1 if high > most_wanted else (low + high) // 2
            cannot = widened(world, gap, side, middle * WIDTH_STEP) is None
            low, high = (low, middle) if cannot else (middle, high)
        if low > 0:
            most_by_side[side] = low
    if not most_by_side:
        return ()
    best = max(most_by_side, key=lambda side: most_by_side[side])

    def is_too_narrow(steps: int) -> bool:
        changed = widened(world, gap, best, steps * WIDTH_STEP)
        return changed is None or (bool(carried) and all(cannot_pass(world, changed, gap, one) for one in carried))

    low, high = 0, most_by_side[best]
    alone = not is_too_narrow(high)
    while alone and high - low > 1:
        middle = (low + high) // 2
        low, high = (middle, high) if is_too_narrow(middle) else (low, middle)
    return tuple(
        GapRange(gap, side, min(high, most) if alone else 1, most, alone) for side, most in most_by_side.items()
    )


def _led_places(scenario: Scenario, passages: list[Gap], seen_from: list[XY]) -> Iterator[Led]:
    """Yield places from which something is seen that was never seen closely, the nearest to where it woke first."""
    world = scenario.world
    free = _reachable(free_squares(world), world.utak)
    rows, columns = free.nonzero()
    if not len(rows):
        return
    centres = np.column_stack([columns + 0.5, rows + 0.5])
    points = shapely.points(centres)
    wanted = [(f"the thing {thing.name}", thing.polygon) for thing in (*world.movable, *world.fixed)]
    wanted += [("the passage", shapely.LineString([gap.left, gap.right])) for gap in passages]
    found = []
    for what, shape in wanted:
        if any(_seen_closely(shape, place) for place in seen_from):
            continue
        distances = shapely.distance(points, shape)
        nearest = int(np.argmin(distances))
        if distances[nearest] <= SIGHT_DISTANCE:
            place = (float(centres[nearest, 0]), float(centres[nearest, 1]))
            found.append((math.dist(place, world.utak), place, what))
    yield from (Led(place, what) for _, place, what in sorted(found)[:MAX_LED_PLACES])


def _seen_closely(shape: object, place: XY) -> bool:
    """Return whether a shape was within `CLOSE_SIGHT` squares of a place, in both axes."""
    x, y = place
    return bool(shapely.box(x - CLOSE_SIGHT, y - CLOSE_SIGHT, x + CLOSE_SIGHT, y + CLOSE_SIGHT).intersects(shape))


def _reachable(free: Bools, place: XY) -> Bools:
    """Return the free squares that hang together with those at a place, (rows, columns) bool."""
    labels = components(free).labels
    column, row = int(place[0]), int(place[1])
    about = labels[max(0, row - 1) : row + 2, max(0, column - 1) : column + 2]
    here = set(np.unique(about[about > 0]).tolist())
    found: Bools = np.isin(labels, sorted(here))
    return found
