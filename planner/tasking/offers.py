"""Places that a search offers for things in the way: aside, and apart from each other within a goal's region."""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from utak.geometry.kernels.arrays import Bools, Ints
from utak.geometry.manipulation.goals import End, Inside
from utak.geometry.motion.se2 import Translate
from utak.geometry.raster.rasterize import squares
from utak.geometry.raster.runs import mask_to_polygon
from utak.kb.world.rooms import NO_ROOM
from utak.planner.oracles.carry import FloorKind, Floors
from utak.planner.oracles.problem import TaskProblem
from utak.planner.oracles.spots import (
    SPOT_SLACK,
    KeptWay,
    corner_spots,
    covered_by,
    kept_way_of,
    spots,
    turned_corner_outlines,
)


def with_returns(problem: TaskProblem) -> TaskProblem:
    """Return the problem with ends for things that are where they shall be, so that they can be brought back there."""
    there = [goal.subject for goal in problem.goals if goal.holds and goal.subject in problem.nodes]
    there += [name for name, place in problem.fulfils if place == problem.here(name) and name in problem.nodes]
    ends = {(name, problem.here(name)): end_about(problem.state.things[name].outline) for name in there}
    return replace(problem, places={**problem.places, **ends})


def end_about(outline: Any) -> Inside:
    """Return the end of a thing at one spot: the squares that its outline there covers, with SPOT_SLACK about them."""
    west, south, east, north = outline.bounds
    x, y = math.floor(west), math.floor(south)
    mask = squares(Translate(-float(x), -float(y)).carry(outline), math.ceil(east) - x, math.ceil(north) - y)
    covered = Translate(float(x), float(y)).carry(mask_to_polygon(mask))
    return Inside(covered.buffer(SPOT_SLACK, join_style="mitre"))


class Offers:
    """Remembers what is in the way of what, and for which things places were offered."""

    def __init__(self, floors: Floors, rooms: Ints | None = None) -> None:
        """Make offers for some floors; nothing is in the way."""
        self._rooms = None if rooms is None else np.pad(rooms, floors.margin)
        sure = floors.by_kind[FloorKind.SURE]
        self.aside: list[tuple[str, str]] = []
        self.spots: set[tuple[str, str]] = set()
        self.shape = (sure.shape[0], sure.shape[1])
        self._floors = floors
        self._needed: Bools = np.zeros(self.shape, np.bool_)  # squares that ways of things need
        self._kept: dict[str, list[KeptWay]] = {}  # ways that must stay possible, by the thing that goes there
        self._in_way: list[str] = []
        self._offered: set[str] = set()
        self._further: set[str] = set()  # the things for which places past others were offered, too

    def keep_clear(self, way: Bools) -> None:
        """Note the squares that a thing would cross if no other thing were there, (rows, columns) bool."""
        self._needed |= way

    def keep_way(self, name: str, start: Any, end: Any) -> None:
        """Note that a thing must find a way from an outline to another one, shapely Polygons, frame of the floors."""
        ways = (kept_way_of(start, end, self._floors.by_kind[kind]) for kind in FloorKind)
        found = next((way for way in ways if way is not None and way.is_open), None)
        noted = self._kept.setdefault(name, [])
        if found is not None and not any(one.start == found.start and one.end == found.end for one in noted):
            noted.append(found)

    def note_in_way(self, names: Sequence[str]) -> None:
        """Note that things are in the way of others where a plan leaves them."""
        self._in_way += [name for name in names if name not in self._in_way]

    def places(self, problem: TaskProblem) -> TaskProblem | None:
        """Return the problem with places for things that are in the way; None when none is new."""
        new: dict[tuple[str, str], End] = {}
        fulfils = dict(problem.fulfils)
        for name in [name for name in self._in_way if name not in self._offered]:
            self._offered.add(name)
            for number, end in enumerate(self._spots_aside(name, problem), 1):
                new[name, f"spot{number}"] = end
                self.aside.append((name, f"spot{number}"))
            for (thing, place), region in problem.places.items():
                if thing == name and place != problem.here(name) and isinstance(region, Inside):
                    for number, end in enumerate(self._spots_within(name, region, problem), 1):
                        new[name, f"{place}_{number}"] = end
                        fulfils[name, f"{place}_{number}"] = problem.fulfils[name, place]
        self.spots |= new.keys()
        return replace(problem, places={**problem.places, **new}, fulfils=fulfils) if new else None

    def further_places(self, problem: TaskProblem) -> TaskProblem | None:
        """Return the problem with places that things in the way reach less easily; None for no new ones."""
        new: dict[tuple[str, str], End] = {}
        fulfils = dict(problem.fulfils)
        floor = self._floors.by_kind[FloorKind.SURE]
        for name in [name for name in self._in_way if name not in self._further]:
            self._further.add(name)
            for (thing, place), region in problem.places.items():
                offered = (thing, place) in self.spots or place == problem.here(name)
                if thing == name and not offered and isinstance(region, Inside):
                    for number, end in enumerate(self._turned_within(name, region, problem), 1):
                        new[name, f"{place}_turned{number}"] = end
                        fulfils[name, f"{place}_turned{number}"] = problem.fulfils[name, place]
            known = [problem.places[key] for key in self.aside if key[0] == name]
            found = [end for end in self._spots(name, problem, floor, floor) if end not in known]
            for number, end in enumerate(found, len(known) + 1):
                new[name, f"spot{number}"] = end
                self.aside.append((name, f"spot{number}"))
        self.spots |= new.keys()
        return replace(problem, places={**problem.places, **new}, fulfils=fulfils) if new else None

    def _spots_aside(self, name: str, problem: TaskProblem) -> list[Inside]:
        """Return places on sure floor, off the ways of others where that can be, and off other things."""
        floor = self._floors.by_kind[FloorKind.SURE]
        others = [self._carry(one.outline) for other, one in problem.state.things.items() if other != name]
        open_floor = floor & ~covered_by(others, self.shape)
        found = self._spots_over(name, problem, open_floor, open_floor, floor)
        if self._rooms is None:
            return found
        own = squares(self._carry(problem.state.things[name].outline), self.shape[1], self.shape[0])
        rooms = np.unique(self._rooms[own & (self._rooms != NO_ROOM)])
        in_rooms = open_floor & np.isin(self._rooms, rooms)
        within = self._spots_over(name, problem, in_rooms, open_floor, floor)
        return found + [end for end in within if end not in found]

    def _spots_over(
        self, name: str, problem: TaskProblem, where: Bools, open_floor: Bools, floor: Bools
    ) -> list[Inside]:
        """Return places on some squares to which a thing can be pushed past others; else over all of the floor."""
        return self._spots(name, problem, where, open_floor) or self._spots(name, problem, where, floor)

    def _spots_within(self, name: str, region: Inside, problem: TaskProblem) -> list[Inside]:
        """Return places within the region of a goal: in its corners, where others find room, and at places apart."""
        floor = self._floors.by_kind[FloorKind.LIKELY]
        inside = floor & squares(self._carry(region.polygon), self.shape[1], self.shape[0])
        outline = problem.state.things[name].outline
        corners = corner_spots(self._carry(outline), inside, floor)
        moves = list(dict.fromkeys(corners + spots(self._carry(outline), inside, floor, self._needed)))
        return [end_about(Translate(float(columns), float(rows)).carry(outline)) for columns, rows in moves]

    def _turned_within(self, name: str, region: Inside, problem: TaskProblem) -> list[Inside]:
        """Return the places of a thing, turned by quarters, in the corners of the region of a goal."""
        floor = self._floors.by_kind[FloorKind.LIKELY]
        inside = floor & squares(self._carry(region.polygon), self.shape[1], self.shape[0])
        back = Translate(-float(self._floors.margin), -float(self._floors.margin))
        outlines = turned_corner_outlines(self._carry(problem.state.things[name].outline), inside)
        return [end_about(back.carry(outline)) for outline in outlines]

    def _spots(self, name: str, problem: TaskProblem, floor: Bools, around: Bools) -> list[Inside]:
        """Return the ends of an object at spots on a floor to which it can be pushed over squares of another one."""
        outline = problem.state.things[name].outline
        kept = [way for other, ways in self._kept.items() if other != name for way in ways]
        moves = spots(self._carry(outline), floor, around, self._needed, kept)
        shapes = [Translate(float(columns), float(rows)).carry(outline) for columns, rows in moves]
        return [end_about(shape) for shape in shapes]

    def _carry(self, shape: Any) -> Any:
        """Return a shape (shapely geometry, view frame) in the frame of the floors."""
        return Translate(float(self._floors.margin), float(self._floors.margin)).carry(shape)
