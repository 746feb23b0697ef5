"""Which expectations of expect.lp are met, halt after halt; the same as `simulator.scenario.expectation` says at once.

Each expectation is a watch that sees every halt and keeps what it needs, so that a halt costs little. What an
expectation means at one halt is said in `simulator.scenario.expectation` alone.
"""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import shapely

from kb.language.terms import Fact
from simulator.scenario.expectation import (
    MIN_CIRCLING_DEGREES,
    Snapshot,
    is_near,
    number_of,
    region_of,
    unmet,
    weights_of,
    winding_of_step,
    with_tolerance,
)
from simulator.world.world import World, outer_ring

NOT_OF_THE_TABLE = ("fails", "verdict")  # expectations about what a mind says
TIME_LIMIT = "within"  # the expectation about the number of commands
Watch = Callable[[Snapshot], bool]  # sees one halt after the other, and returns whether the expectation is met now


class ExpectationProgress:
    """The progress of one play towards what is expected.

    Parameters
    ----------
    expectations : the facts of expect.lp; () when nothing is expected.
    world : the table at the start.

    Attributes
    ----------
    share : the part of the points that is earned now, 0 to 1; limits of time, and what a mind shall say, do not count.
    achieved : whether all that is expected of the table holds now; False when nothing is.
    """

    def __init__(self, expectations: Sequence[Fact], world: World) -> None:
        points = {
            fact: number for fact, number in weights_of(expectations).items() if fact.name not in NOT_OF_THE_TABLE
        }
        self._fixed = {thing.name: thing.polygon for thing in world.fixed}
        self._watches = [
            (_watch(fact, world), 0 if fact.name == TIME_LIMIT else number) for fact, number in points.items()
        ]
        self._most = sum(number for _, number in self._watches)
        self._failing = any(fact.name == "fails" for fact in expectations)
        self.share, self.achieved = 0.0, False

    def see(self, step: int, utak: tuple[float, float], polygons: Mapping[str, Any]) -> None:
        """Take in a halt; step 0 is that of waking.

        Parameters
        ----------
        step : the number of commands so far.
        utak : where the robot is, squares, table frame.
        polygons : the outlines of the movable things by name.
        """
        halt = Snapshot(step, utak, {**self._fixed, **polygons} if self._fixed else polygons)
        met = [(watch(halt), number) for watch, number in self._watches]
        earned = sum(number for is_met, number in met if is_met)
        self.share = earned / self._most if self._most else 0.0
        self.achieved = bool(met) and not self._failing and all(is_met for is_met, _ in met)


def time_limit(expectations: Sequence[Fact]) -> int | None:
    """Return the least number of commands that `within` allows; None without one."""
    return min((number_of(fact) for fact in expectations if fact.name == TIME_LIMIT), default=None)


def _watch(fact: Fact, world: World) -> Watch:
    """Return the watch of an expectation."""
    makers: dict[str, Callable[[Fact], Watch]] = {
        "inside": _inside,
        "near": _near,
        "visits": _visits,
        "avoids": _avoids,
        "circles": _circles,
        "unmoved": _unmoved,
        "within": _within,
    }
    return makers[fact.name](fact) if fact.name in makers else _whole_track(fact, world)


def _inside(fact: Fact) -> Watch:
    """Return the watch whether all of a thing, or the robot, is in a region."""
    region = with_tolerance(region_of(fact))
    return _there(str(fact.args[0]), region, region.covers)


def _near(fact: Fact) -> Watch:
    """Return the watch whether a thing, or the robot, is near a shape."""
    return _remembering(str(fact.args[0]), lambda thing: is_near(fact, thing))


def _visits(fact: Fact) -> Watch:
    """Return the watch whether the centre of a thing, or the robot, was in a region at some halt."""
    return _ever(_centre_there(fact))


def _avoids(fact: Fact) -> Watch:
    """Return the watch whether the centre of a thing, or the robot, was in a region at no halt."""
    was_there = _ever(_centre_there(fact))
    return lambda halt: not was_there(halt)


def _circles(fact: Fact) -> Watch:
    """Return the watch whether the track of the robot winds about a thing."""
    name = str(fact.args[1])
    total, before = 0.0, (0.0, 0.0)

    def watch(halt: Snapshot) -> bool:
        nonlocal total, before
        if halt.step:
            total += winding_of_step(before, halt.utak, halt.polygons[name].centroid)
        before = halt.utak
        return abs(total) >= MIN_CIRCLING_DEGREES

    return watch


def _unmoved(fact: Fact) -> Watch:
    """Return the watch whether a thing is exactly where it was at the start."""
    name = str(fact.args[0])
    first: list[Any] = []

    def watch(halt: Snapshot) -> bool:
        polygon = halt.polygons[name]
        if not first:
            first.append(polygon)
        return polygon is first[0] or outer_ring(polygon) == outer_ring(first[0])

    return watch


def _within(fact: Fact) -> Watch:
    """Return the watch whether no more commands were given than allowed."""
    most = number_of(fact)
    return lambda halt: halt.step <= most


def _whole_track(fact: Fact, world: World) -> Watch:
    """Return the watch of an expectation that is judged anew from the whole track at every halt."""
    track: list[Snapshot] = []

    def watch(halt: Snapshot) -> bool:
        track.append(Snapshot(halt.step, halt.utak, dict(halt.polygons)))
        return not unmet([fact], world, track)

    return watch


def _centre_there(fact: Fact) -> Watch:
    """Return the watch whether the centre of a thing, or the robot, is in a region now."""
    region = region_of(fact)
    return _there(str(fact.args[0]), region, lambda thing: region.covers(thing.centroid))


def _there(name: str, region: Any, covers: Callable[[Any], bool]) -> Watch:
    """Return the watch whether a thing is in a region, which is tested at once for the robot, a point."""
    shapely.prepare(region)
    if name == "utak":
        return lambda halt: bool(shapely.intersects_xy(region, *halt.utak))
    return _remembering(name, covers)


def _remembering(name: str, holds: Callable[[Any], bool]) -> Watch:
    """Return the watch whether something holds of a thing, or of the robot as a point; asked when it has moved only."""
    asked: list[Any] = [None, False]

    def watch(halt: Snapshot) -> bool:
        now = halt.utak if name == "utak" else halt.polygons[name]
        if now is not asked[0]:
            asked[:] = now, bool(holds(shapely.Point(now) if name == "utak" else now))
        return bool(asked[1])

    return watch


def _ever(now: Watch) -> Watch:
    """Return the watch whether something held at some halt so far."""
    held = False

    def watch(halt: Snapshot) -> bool:
        nonlocal held
        held = held or now(halt)
        return held

    return watch
