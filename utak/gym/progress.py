"""Which expectations of expect.lp are met, halt after halt; as `utak.simulator.scenario.expectation` says at once.

Each expectation is a watch that sees every halt and keeps what it needs, so that a halt costs little. What an
expectation means at one halt is said in `utak.simulator.scenario.expectation` alone.
"""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any

import shapely

from utak.kb.language.terms import Fact
from utak.simulator.scenario.expectation import (
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
from utak.simulator.world.world import World, outer_ring

NOT_OF_THE_TABLE = ("fails", "verdict")  # expectations about what a mind says
TIME_LIMIT = "within"  # the expectation about the number of commands
Watch = Callable[[Snapshot], bool]  # sees one halt after the other, and returns whether the expectation is met now


class ExpectationProgress:
    """The progress of one play towards what is expected."""

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
        """Take in a halt; step 0 is that of waking."""
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
    return partial(_remembered, str(fact.args[0]), partial(is_near, fact), [None, False])


def _visits(fact: Fact) -> Watch:
    """Return the watch whether the centre of a thing, or the robot, was in a region at some halt."""
    return partial(_held_once, _centre_there(fact), [False])


def _avoids(fact: Fact) -> Watch:
    """Return the watch whether the centre of a thing, or the robot, was in a region at no halt."""
    return partial(_fails, _visits(fact))


def _circles(fact: Fact) -> Watch:
    """Return the watch whether the track of the robot winds about a thing."""
    return partial(_has_wound, str(fact.args[1]), [0.0, (0.0, 0.0)])


def _unmoved(fact: Fact) -> Watch:
    """Return the watch whether a thing is exactly where it was at the start."""
    return partial(_is_as_at_first, str(fact.args[0]), [])


def _within(fact: Fact) -> Watch:
    """Return the watch whether no more commands were given than allowed."""
    return partial(_is_in_time, number_of(fact))


def _whole_track(fact: Fact, world: World) -> Watch:
    """Return the watch of an expectation that is judged anew from the whole track at every halt."""
    return partial(_judged, fact, world, [])


def _centre_there(fact: Fact) -> Watch:
    """Return the watch whether the centre of a thing, or the robot, is in a region now."""
    region = region_of(fact)
    return _there(str(fact.args[0]), region, partial(_covers_centre, region))


def _there(name: str, region: Any, covers: Callable[[Any], bool]) -> Watch:
    """Return the watch whether a thing is in a region, which is tested at once for the robot, a point."""
    shapely.prepare(region)
    return partial(_robot_there, region) if name == "utak" else partial(_remembered, name, covers, [None, False])


# What watches do at a halt: functions of the module and a list of what was seen, so that copies of a game are apart.


def _robot_there(region: Any, halt: Snapshot) -> bool:
    """Return whether the robot is in a region."""
    return bool(shapely.intersects_xy(region, *halt.utak))


def _covers_centre(region: Any, thing: Any) -> bool:
    """Return whether the centre of a thing is in a region."""
    return bool(region.covers(thing.centroid))


def _remembered(name: str, holds: Callable[[Any], bool], asked: list[Any], halt: Snapshot) -> bool:
    """Return whether something holds of a thing, or of the robot as a point; asked when it has moved only."""
    now = halt.utak if name == "utak" else halt.polygons[name]
    if now is not asked[0]:
        asked[:] = now, bool(holds(shapely.Point(now) if name == "utak" else now))
    return bool(asked[1])


def _held_once(now: Watch, held: list[bool], halt: Snapshot) -> bool:
    """Return whether something held at some halt so far."""
    held[0] = held[0] or now(halt)
    return held[0]


def _fails(watch: Watch, halt: Snapshot) -> bool:
    """Return whether a watch says no."""
    return not watch(halt)


def _has_wound(name: str, so_far: list[Any], halt: Snapshot) -> bool:
    """Return whether the track has wound about a thing. so_far : the degrees, and the robot's last place."""
    if halt.step:
        so_far[0] += winding_of_step(so_far[1], halt.utak, halt.polygons[name].centroid)
    so_far[1] = halt.utak
    return bool(abs(so_far[0]) >= MIN_CIRCLING_DEGREES)


def _is_as_at_first(name: str, first: list[Any], halt: Snapshot) -> bool:
    """Return whether a thing is where it was. first : its outline at the first halt."""
    polygon = halt.polygons[name]
    first += [] if first else [polygon]
    return polygon is first[0] or outer_ring(polygon) == outer_ring(first[0])


def _is_in_time(most: int, halt: Snapshot) -> bool:
    """Return whether at most so many commands were given."""
    return halt.step <= most


def _judged(fact: Fact, world: World, track: list[Snapshot], halt: Snapshot) -> bool:
    """Return whether an expectation is met by the whole track, to which the halt is added."""
    track.append(Snapshot(halt.step, halt.utak, dict(halt.polygons)))
    return not unmet([fact], world, track)
