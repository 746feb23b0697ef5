"""A search that knows the true world: in which order, and whereto, things can be carried so that a task is done.

It looks for few carries first (best first; a carry is everything from a walk to a thing until it is left where it shall
be). Carries are planned by geometry.manipulation.plan_carrying. What is found can be done, which
benchmarks.orders.carried_out makes sure of in the simulated world; that nothing is found proves nothing: of the many
places where a thing could be put down only some are tried.
"""

import heapq
import itertools
import math
import time
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
import shapely
from shapely import Point, Polygon, box
from shapely.geometry.base import BaseGeometry

from benchmarks.orders.relaxed import is_in_reach, may_pass, swept
from benchmarks.worlds.floorplans import convex_corners
from benchmarks.worlds.placing import digital
from benchmarks.worlds.several.tasks import SeveralWorld, Want, moved_polygon
from benchmarks.worlds.walking import corner_box
from utak.geometry.kernels.arrays import XY, Bools
from utak.geometry.manipulation.goals import At, End, InCorner, Inside
from utak.geometry.manipulation.legs import Leg
from utak.geometry.manipulation.plan_carrying import plan_carrying
from utak.geometry.motion.se2 import Pose, Translate
from utak.geometry.raster.components import components
from utak.kb.language.goal_words import ROBOT

FOUND, EXHAUSTED, SEARCH_LIMIT = "found", "exhausted", "limit"
MAX_DETOURS = 3  # carries to places that nothing wants, at most; a convention, for time
POINT_DECIMALS = 3  # of places that are taken for the same


class Carry(NamedTuple):
    """A thing is carried. thing : its number. legs : what the robot does, in order."""

    thing: int
    legs: tuple[Leg, ...]


@dataclass(frozen=True)
class Layout:
    """A state of the world after some carries.

    Attributes
    ----------
    shapes : the polygons of all things, in the order of the world, squares, table frame.
    turns : by how many degrees each has been turned from how it lay at first.
    utak : (x, y) of the robot. stage : the number of stages that are reached.
    way : the carries so far, and (x, y) where the robot was to walk, in order.
    """

    shapes: tuple[Polygon, ...]
    turns: tuple[float, ...]
    utak: XY
    stage: int = 0
    way: tuple[Carry | XY, ...] = ()

    @cached_property
    def carries(self) -> int:
        """The number of carries so far."""
        return sum(isinstance(part, Carry) for part in self.way)

    @property
    def key(self) -> tuple[Any, ...]:
        """Equal for layouts that are taken for the same."""
        points = tuple(tuple(shapely.get_coordinates(shape).round(POINT_DECIMALS).ravel()) for shape in self.shapes)
        return self.stage, points, tuple(math.floor(v) for v in self.utak)


class SearchAnswer(NamedTuple):
    """The answer of a search.

    Attributes
    ----------
    answer : "found", "exhausted" (of all that is tried nothing leads to the end) or "limit".
    way : the carries, and (x, y) where the robot walks in between; () unless found.
    carries : how many carries there are; 0 unless found.
    """

    answer: str
    way: tuple[Carry | XY, ...] = ()
    carries: int = 0


def search(world: SeveralWorld, seconds: float, pull: bool = True) -> SearchAnswer:
    """Search for few carries that do the task of a world. seconds : of this process. pull : whether it may pull."""
    return _Search(world, pull).run(seconds)


class _Search:
    """A search in one world."""

    def __init__(self, world: SeveralWorld, pull: bool) -> None:
        self._world, self._pull = world, pull
        self._numbers = {thing.name: number for number, thing in enumerate(world.things)}
        plan = world.plan
        self._floor: Bools = ~digital(plan.verge, plan.width, plan.height)
        fixed = [digital(thing.polygon, plan.width, plan.height) for thing in world.things if thing.fixed]
        self._still: Bools = ~np.logical_or.reduce([~self._floor, *fixed])
        self._ways: dict[tuple[Any, ...], BaseGeometry] = {}

    def run(self, seconds: float) -> SearchAnswer:
        """Search for so many seconds of the processor's time of this process."""
        begun = time.process_time()
        answer = self._best_first(begun + seconds / 2, 0)
        return answer if answer.way else self._best_first(begun + seconds, MAX_DETOURS)

    def _best_first(self, end: float, detours: int) -> SearchAnswer:
        """Search until the processor's time is `end`, with at most so many carries more than seem to be needed."""
        shapes = tuple(thing.polygon for thing in self._world.things)
        begin = self._advanced(Layout(shapes, (0.0,) * len(shapes), (self._world.utak.x, self._world.utak.y)))
        count, seen = itertools.count(), {begin.key}
        queue: list[tuple[int, int, int, Layout, int, End]] = []

        def reached(layout: Layout) -> SearchAnswer | None:
            if layout.stage == len(self._world.stages):
                return SearchAnswer(FOUND, layout.way, layout.carries)
            in_the_way = self._in_the_way(layout) if detours else set[int]()
            left = self._carries_left(layout) + len(in_the_way)
            for number, target, detour in self._choices(layout):
                guess = layout.carries + left + (detour and number not in in_the_way)
                if detours or not detour:
                    heapq.heappush(queue, (guess, -layout.carries, next(count), layout, number, target))
            return None

        if found := reached(begin):
            return found
        most = self._carries_left(begin) + (len(self._in_the_way(begin)) + detours if detours else 0)
        while queue:
            guess, _, _, layout, number, target = heapq.heappop(queue)
            if guess > most:
                break
            if time.process_time() >= end:
                return SearchAnswer(SEARCH_LIMIT)
            after = self._carried(layout, number, target)
            if after is None or (after := self._advanced(after)).key in seen:
                continue
            seen.add(after.key)
            if found := reached(after):
                return found
        return SearchAnswer(EXHAUSTED)

    def _advanced(self, layout: Layout) -> Layout:
        """Return a layout after all stages that are reached by walking alone."""
        while layout.stage < len(self._world.stages):
            wants = self._world.stages[layout.stage]
            if any(want.subject != ROBOT and not self._holds(want, layout) for want in wants):
                break
            place = self._place_to_go(layout, [want for want in wants if want.subject == ROBOT])
            if place is None:
                break
            way = layout.way if place == layout.utak else (*layout.way, place)
            layout = replace(layout, utak=place, way=way, stage=layout.stage + 1)
        return layout

    def _holds(self, want: Want, layout: Layout) -> bool:
        return want.holds({want.subject: layout.shapes[self._numbers[want.subject]]})

    def _place_to_go(self, layout: Layout, wants: list[Want]) -> XY | None:
        """Return where the robot can walk so that wants about it hold; None for nowhere."""
        if all(want.holds({ROBOT: shapely.Point(layout.utak)}) for want in wants):
            return layout.utak
        labels = components(self._free(layout)).labels
        column, row = (math.floor(v) for v in layout.utak)
        rows, columns = np.nonzero(labels == labels[row, column])
        points = shapely.points(columns + 0.5, rows + 0.5)
        good = np.logical_and.reduce([shapely.covers(want.region, points) for want in wants])
        if not labels[row, column] or not good.any():
            return None
        at = min(np.nonzero(good)[0].tolist(), key=lambda k: math.dist(layout.utak, (points[k].x, points[k].y)))
        return float(points[at].x), float(points[at].y)

    def _free(self, layout: Layout, without: int = -1) -> Bools:
        """Return the squares that no wall and no thing covers, but for one thing (by its number)."""
        free = self._floor.copy()
        for number, shape in enumerate(layout.shapes):
            if number != without:
                free &= ~digital(shape, self._world.plan.width, self._world.plan.height)
        return free

    def _carries_left(self, layout: Layout) -> int:
        """Return a number of carries that are needed at least: of all wants those that something else must precede."""
        left, before = 0, dict[str, Any]()
        for stage in self._world.stages[layout.stage :]:
            for want in stage:
                if want.subject == ROBOT:
                    continue
                earlier = before.get(want.subject)
                left += not self._holds(want, layout) if earlier is None else not earlier.intersects(want.region)
                before[want.subject] = want.region
        return left

    def _in_the_way(self, layout: Layout) -> set[int]:
        """Return the numbers of the things that nothing is wanted of now, but lie in the way of what is wanted."""
        wants = [want for want in self._world.stages[layout.stage] if want.subject != ROBOT]
        wanted = {self._numbers[want.subject] for want in wants}
        others = [k for k, thing in enumerate(self._world.things) if k not in wanted and not thing.fixed]
        found = set[int]()
        for want in wants if others else ():
            if not self._holds(want, layout):
                way = self._way_alone(want, layout)
                found |= {k for k in others if layout.shapes[k].intersects(way)}
        return found

    def _way_alone(self, want: Want, layout: Layout) -> BaseGeometry:
        """Return what a thing sweeps on its way to where it is wanted where walls and fixed things alone are."""
        number = self._numbers[want.subject]
        key = (want, *shapely.get_coordinates(layout.shapes[number]).round(POINT_DECIMALS).ravel().tolist())
        if key not in self._ways:
            end = next(self._ends(want, number, layout))
            plan = plan_carrying(layout.shapes[number], self._still, layout.utak, end, pull=self._pull)
            self._ways[key] = swept(layout.shapes[number], plan.legs)
        return self._ways[key]

    def _choices(self, layout: Layout) -> Iterator[tuple[int, End, int]]:
        """Yield (thing, where it is carried, 1 if that is a detour): what is wanted now, and places out of the way."""
        wants = {want.subject: want for want in self._world.stages[layout.stage] if want.subject != ROBOT}
        for number, thing in enumerate(self._world.things):
            want = wants.get(thing.name)
            if want is not None and not self._holds(want, layout):
                yield from ((number, end, 0) for end in self._ends(want, number, layout))
            if not thing.fixed:
                yield from ((number, end, 1) for end in self._aside())

    def _ends(self, want: Want, number: int, layout: Layout) -> Iterator[End]:
        """Yield ends that a want can mean: a pose, or anywhere in its region, or the corners of that region."""
        shape = layout.shapes[number]
        if want.move is not None:
            there = moved_polygon(self._world.things[number].polygon, want.move).centroid
            degrees = (want.move[2] - layout.turns[number] + 180.0) % 360.0 - 180.0
            yield At(Pose(there.x - shape.centroid.x, there.y - shape.centroid.y, degrees))
            return
        rooms = [room.polygon for room in self._world.plan.rooms if want.region.covers(room.polygon)]
        region = shapely.union_all(rooms) if rooms else want.region  # the whole room, without a part of its neck
        yield Inside(region)
        west, south, east, north = shape.bounds
        side = min(east - west, north - south)
        for corner in convex_corners(region):
            if region.covers(corner_box(corner, side)):
                yield InCorner(corner[0], corner[1], -int(corner[2]), -int(corner[3]))

    def _aside(self) -> Iterator[End]:
        """Yield places where a thing is out of the way: the quarters of each room's rectangle."""
        for room in self._world.plan.rooms:
            west, south, east, north = room.polygon.bounds
            x, y = (west + east) / 2, (south + north) / 2
            for quarter in (
                box(west, south, x, y),
                box(x, south, east, y),
                box(west, y, x, north),
                box(x, y, east, north),
            ):
                yield Inside(quarter)

    def _carried(self, layout: Layout, number: int, target: End) -> Layout | None:
        """Return the layout after a thing was carried to an end; None when that is not found."""
        shape, free = layout.shapes[number], self._free(layout, number)
        if not is_in_reach(shape, free, layout.utak) or not may_pass(shape, free, _region_of(target, shape)):
            return None
        plan = plan_carrying(shape, free, layout.utak, target, pull=self._pull)
        if plan.status != "found" or not plan.legs or plan.pose is None:
            return None
        shapes = (*layout.shapes[:number], plan.polygon, *layout.shapes[number + 1 :])
        turn = layout.turns[number] + plan.pose.degrees
        turns = (*layout.turns[:number], turn, *layout.turns[number + 1 :])
        x, y = plan.legs[-1].place
        pushes = [motion for motion in plan.legs[-1].motions if isinstance(motion, Translate)]
        utak = (x + sum(push.dx for push in pushes), y + sum(push.dy for push in pushes))
        return Layout(shapes, turns, utak, layout.stage, (*layout.way, Carry(number, plan.legs)))


def _region_of(end: End, shape: Polygon) -> BaseGeometry:
    """Return a region in which the centre of the largest circle in a thing must lie at an end."""
    reach = Point(shape.centroid).hausdorff_distance(shape)
    if isinstance(end, At):
        return Point(shape.centroid.x + end.pose.x, shape.centroid.y + end.pose.y).buffer(reach)
    if isinstance(end, InCorner):
        return Point(end.x, end.y).buffer(2 * reach + end.slack + 1.0)
    assert isinstance(end, Inside)
    region: BaseGeometry = end.polygon
    return region
