"""Carrying by whole squares and quarter turns: all stays on the lattice on which it began, so places stay certain."""

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache, partial
from itertools import product
from typing import NamedTuple

import numpy as np
import shapely

from utak.geometry.kernels.arrays import Bools
from utak.geometry.manipulation.extract_legs import CENTRE_TOLERANCE, LegExtraction
from utak.geometry.manipulation.goals import end_costs
from utak.geometry.manipulation.legs import Leg, commands, may_push, only_pushes, round_motion, verified
from utak.geometry.manipulation.query import ManipulationQuery, query_after
from utak.geometry.manipulation.workspace import padded_shape
from utak.geometry.motion.se2 import Rotate, Translate
from utak.geometry.state_lattice.astar import ADMISSIBLE_WEIGHT, costs_to_first_grasp, find_carrying_path
from utak.geometry.state_lattice.footprints import PUSH_DIRECTIONS, Footprints, new_footprints
from utak.geometry.state_lattice.heuristic import can_reach_end, cost_to_go
from utak.geometry.state_lattice.lattice import (
    COMMAND_COST,
    CORNER_GRASP_COST,
    REGRASP_COST,
    Costs,
    LatticeBody,
    new_lattice_body,
    new_lattice_floor,
    new_lattice_grid,
    new_state_lattice,
)

PLACE_DIGITS = 8  # decimal digits of places; rounding of motions moves a body by less than the last one
# Weight of the heuristic and greatest number of nodes of each stage; bounds on time, no measurement on record.
SEARCH_STAGES = ((ADMISSIBLE_WEIGHT, 60_000), (2 * ADMISSIBLE_WEIGHT, 400_000))
BEND_COSTS = (COMMAND_COST, COMMAND_COST // 2)  # of a bend within a push: as much as a push, or half of it
MAX_KEPT_BODIES = 32  # bodies whose footprints are remembered; a bound on memory
MAX_NUDGES = 2  # pushes to the centre of a square that are tried; convention, for time


class _BodyKey(NamedTuple):
    """All that the footprints of a body depend on, wherever it lies."""

    # Well-known binary of its outline, a shapely Polygon, moved so that the square of the centroid is (0, 0)
    wkb: bytes
    margin: float  # squares of clearance that it should keep
    own: tuple[int, int] | None  # (column, row) of the robot relative to that square when it holds the body, else None


def _key_of(query: ManipulationQuery) -> tuple[_BodyKey, tuple[int, int]]:
    """Return what the footprints of the body depend on, and the square (column, row) of its centroid in the table."""
    home = math.floor(query.middle[0]), math.floor(query.middle[1])
    shape_near = shapely.transform(query.shape, lambda p: np.round(p - np.array(home), PLACE_DIGITS))
    own = (query.square[0] - home[0], query.square[1] - home[1]) if query.held else None
    return _BodyKey(shapely.to_wkb(shape_near), query.margin, own), home


@lru_cache(maxsize=MAX_KEPT_BODIES)
def _footprints_near(key: _BodyKey) -> tuple[Footprints, Footprints]:
    """Return the footprints of a shape whose centroid lies in the square (0, 0), without and with its margin."""
    shape = shapely.from_wkb(key.wkb)
    body = new_footprints(shape, key.own)
    wide = new_footprints(padded_shape(shape, key.margin), holds=body.holds) if key.margin > 0.0 else body
    return body, wide


@lru_cache(maxsize=MAX_KEPT_BODIES)
def _body_on_table(key: _BodyKey, columns: int, rows: int) -> LatticeBody:
    """Return a body on the grid of a table of `columns` and `rows` squares. `key` : as for `_footprints_near`."""
    body, wide = _footprints_near(key)
    return new_lattice_body(new_lattice_grid(columns, rows, body, wide), body, wide)


def plan_on_lattice(query: ManipulationQuery) -> list[Leg] | None:
    """Return the cheapest legs by whole squares, or a quick solution where that takes long."""
    if not query.held:
        return _cheapest_legs(query)
    nudges = _nudges(query)
    straight = _legs_off_centre(query) if any(nudges[0]) else None
    if straight is not None and len(straight) == len(straight[0].motions) == 1:
        return straight
    for nudge in nudges:
        first = Leg(query.utak, (0, 0), (round_motion(nudge),), query.grasp_offset(query.utak), taken=True)
        legs = _cheapest_legs(query_after(query, [first], held=True), query)
        if legs is not None and legs[0].taken and _may_begin(query, legs[0]):
            return min((found for found in (straight, legs) if found), key=lambda found: _leg_cost(query, found))
    return straight or _cheapest_legs(replace(query, held=False))


def _legs_off_centre(query: ManipulationQuery) -> list[Leg] | None:
    """Return the cheapest legs of a robot off the centre of its square, if the first leg only pushes; else None."""
    x, y = query.utak
    legs = _cheapest_legs(replace(query, utak=(math.floor(x) + 0.5, math.floor(y) + 0.5)))
    if legs is None or not legs[0].taken or any(isinstance(motion, Rotate) for motion in legs[0].motions):
        return None
    if not (query.pull or only_pushes(query.shape, query.utak, legs[0].motions)):
        return None
    legs = [replace(legs[0], place=query.utak, hold=query.grasp_offset(query.utak)), *legs[1:]]
    return legs if verified(query.workspace, query.shape, legs) is not None else None


def _nudges(query: ManipulationQuery) -> list[Translate]:
    """Return the pushes that bring the robot to the centre of a square, shortest first, MAX_NUDGES at most."""
    x, y = (sorted((math.floor(v - 0.5) + 0.5 - v, math.floor(v - 0.5) + 1.5 - v), key=abs) for v in query.utak)
    x, y = ([0.0] if abs(near) <= CENTRE_TOLERANCE else [near, far] for near, far in (x, y))
    pushes = [Translate(dx, dy) for dx, dy in product(x, y)]
    return sorted(pushes, key=lambda push: math.hypot(*push))[:MAX_NUDGES]


def _may_begin(query: ManipulationQuery, leg: Leg) -> bool:
    """Return whether the robot, holding the shape, can and may make the first motion of a leg."""
    motion = leg.motions[0] if leg.motions else Translate(0.0, 0.0)
    pushes = query.pull or only_pushes(query.shape, query.utak, [motion])
    return pushes and query.workspace.lets(query.shape, query.utak, motion)


def _leg_cost(query: ManipulationQuery, legs: Sequence[Leg]) -> float:
    """Return about how many commands legs take, each turn counted as query.turn commands."""
    turns = sum(isinstance(motion, Rotate) for leg in legs for motion in leg.motions)
    return commands(legs) + (query.turn - 1.0) * turns


def _cheapest_legs(query: ManipulationQuery, before_nudge: ManipulationQuery | None = None) -> list[Leg] | None:
    """Return the cheapest legs of a robot that stands at the centre of a square when it holds the shape, or None."""
    # None when none are found, or the centroid of the shape is off the table.
    search = _LatticeSearch(query, before_nudge or query)
    best: list[Leg] | None = None
    for bend_cost in BEND_COSTS if search.on_grid else ():
        legs = search.legs(bend_cost)
        best = min(
            (found for found in (best, legs) if found), key=lambda candidate: _leg_cost(query, candidate), default=None
        )
        if best is None or [len(leg.motions) for leg in best] == [1]:
            break
    return best


class _LatticeSearch:
    """A search on the state lattice: what does not depend on the cost of bends is made once."""

    def __init__(self, query: ManipulationQuery, before_nudge: ManipulationQuery) -> None:
        self.query, self.before_nudge = query, before_nudge
        key, home = _key_of(query)
        self.body = replace(_footprints_near(key)[0], home=home)
        rows, columns = query.walk.shape
        x, y = home
        self.on_grid = 0 <= x < columns and 0 <= y < rows
        if not self.on_grid:
            return
        body = _body_on_table(key, columns, rows)
        self.grid = body.grid
        floor = query.workspace.once(
            ("floor", key.wkb, key.margin, body.grid), partial(new_lattice_floor, query.workspace.free, body)
        )
        grips, allowed = _grasp_costs(query, self.body), _allowed_pushes(query, self.body)
        self.lattice = new_state_lattice(floor, body, query.walk, grips, allowed, round(COMMAND_COST * query.turn))
        self.place = self.grid.number(x, y)
        self.ends = end_costs(query.goal, query.shape, self.body, self.lattice, self.grid)
        walk = costs_to_first_grasp(self.lattice, self.place, self.grid.number(*query.square))
        self.first_costs = _first_grasp_costs(query, self.body, walk)

    def legs(self, bend_cost: int) -> list[Leg] | None:
        """Return the cheapest legs, given the cost of another direction within one push; None when none are found."""
        if not can_reach_end(self.lattice, self.ends, self.place):
            return None
        to_go = cost_to_go(self.lattice, self.ends, bend_cost)
        for weight, max_nodes in SEARCH_STAGES:
            nodes = find_carrying_path(
                self.lattice, to_go, self.ends, self.first_costs, self.place, bend_cost, weight, max_nodes
            )
            if len(nodes):
                return LegExtraction(self.query, self.before_nudge, self.body, self.grid, self.ends).legs(nodes)
        return None


def _first_grasp_costs(query: ManipulationQuery, body: Footprints, walk: Costs) -> Costs:
    """Return the cost of the first grasp at each of body.holds: 0 for the present one."""
    # Any other needs a release first.
    if not query.held:
        return walk
    first_costs = np.where(walk >= 0, walk + REGRASP_COST, -1).astype(np.int32)
    first_costs[(body.holds + body.home == query.square).all(axis=1)] = 0
    return first_costs


def _grasp_costs(query: ManipulationQuery, body: Footprints) -> Costs:
    """Return the cost of a grasp at each of body.holds, -1 where it must be avoided."""
    lying = {(int(x), int(y)) for x, y in body.lying}
    grips = []
    for x, y in body.holds.tolist():
        beside = any((x + dx, y + dy) in lying for dx, dy in PUSH_DIRECTIONS[::2])
        away = query.grasp_offset((x + body.home[0] + 0.5, y + body.home[1] + 0.5))
        grips.append(-1 if query.is_avoided(*away) else 0 if beside else CORNER_GRASP_COST)
    return np.array(grips, np.int32)


def _allowed_pushes(query: ManipulationQuery, body: Footprints) -> Bools:
    """Return in which directions the robot may push from each grasp in each quarter turn: (4, grasps, 8) bool."""
    allowed = np.ones((4, len(body.holds), 8), np.bool_)
    if query.pull:
        return allowed
    for n, (x, y) in enumerate(body.holds.tolist()):
        utak = (x + body.home[0] + 0.5, y + body.home[1] + 0.5)
        for d, (dx, dy) in enumerate(PUSH_DIRECTIONS):
            fine = may_push(query.shape, utak, dx, dy)
            for k in range(4):
                allowed[k, n, (d + 2 * k) % 8] = fine
    return allowed
