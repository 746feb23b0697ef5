"""Carrying by whole squares and quarter turns: all stays on the lattice on which it began, so beliefs stay certain."""

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache
from itertools import product

import numpy as np
import shapely

from geometry.kernels.arrays import Bools
from geometry.manipulation.extract_legs import MIDDLE, LegExtraction
from geometry.manipulation.goals import prices
from geometry.manipulation.legs import Leg, commands, may_push, only_pushes, rounded, verified
from geometry.manipulation.query import ManipulationQuery, after
from geometry.manipulation.workspace import padded
from geometry.motion.se2 import Rotate, Translate
from geometry.state_lattice.astar import CALM, first_walk, haul
from geometry.state_lattice.footprints import DIRECTIONS, Footprints, new_stencil
from geometry.state_lattice.heuristic import NEVER, STILL, guess
from geometry.state_lattice.lattice import AWKWARD, COMMAND, REGRASP, Costs, new_board, new_grid

EXACT = 8  # digits of places: what is off by less, after motions whose numbers were rounded, is not off
SEARCHES = ((CALM, 60_000), (2 * CALM, 400_000))  # haste, and nodes looked at before giving up
BENDS = (COMMAND, COMMAND // 2)  # the price of another direction in the same push: another push, or half of one
NUDGES = 2  # pushes to the middle of a square that are tried


def _stencils(errand: ManipulationQuery) -> tuple[Footprints, Footprints]:
    """The stencils of the shape and of the shape with its margin."""
    shape = errand.shape
    home = (math.floor(shape.centroid.x), math.floor(shape.centroid.y))
    near = shapely.transform(shape, lambda p: np.round(p - np.array(home), EXACT))
    own = (errand.square[0] - home[0], errand.square[1] - home[1]) if errand.held else None
    body, wide = _stencils_near(shapely.to_wkb(near), errand.margin, own)
    return replace(body, home=home), body if wide is body else replace(wide, home=home)


@lru_cache(maxsize=32)
def _stencils_near(wkb: bytes, margin: float, own: tuple[int, int] | None) -> tuple[Footprints, Footprints]:
    """The stencils of a shape whose centroid lies in the square (0, 0)."""
    shape = shapely.from_wkb(wkb)
    body = new_stencil(shape, own)
    return body, new_stencil(padded(shape, margin), holds=body.holds) if margin > 0.0 else body


def carry_squarewise(errand: ManipulationQuery) -> list[Leg] | None:
    """The cheapest legs by whole squares, or some in haste where that takes long; None when none are found.

    Who has hold of the shape off the middle of a square pushes it by whole squares all the same, as long as he does not
    turn it; or he comes to the middle with his first push, or a push more, where that takes fewer commands: both are
    cheaper than to let go and take it again.
    """
    if not errand.held:
        return _fewest(errand)
    nudges = _nudges(errand)
    straight = _pushed_off_the_middle(errand) if any(nudges[0]) else None
    if straight is not None and len(straight) == len(straight[0].motions) == 1:
        return straight
    for nudge in nudges:
        first = Leg(errand.utak, (0, 0), (rounded(nudge),), errand.hold_from(errand.utak), taken=True)
        legs = _fewest(after(errand, [first], held=True), errand)
        if legs is not None and legs[0].taken and _may_begin(errand, legs[0]):
            return min((found for found in (straight, legs) if found), key=lambda found: _price(errand, found))
    return straight or _fewest(replace(errand, held=False))


def _pushed_off_the_middle(errand: ManipulationQuery) -> list[Leg] | None:
    """The cheapest legs by whole squares of one who stands off the middle of his square, if the first only pushes."""
    x, y = errand.utak
    legs = _fewest(replace(errand, utak=(math.floor(x) + 0.5, math.floor(y) + 0.5)))
    if legs is None or not legs[0].taken or any(isinstance(motion, Rotate) for motion in legs[0].motions):
        return None
    if not (errand.pull or only_pushes(errand.shape, errand.utak, legs[0].motions)):
        return None
    legs = [replace(legs[0], place=errand.utak, hold=errand.hold_from(errand.utak)), *legs[1:]]
    return legs if verified(errand.yard, errand.shape, legs) is not None else None


def _nudges(errand: ManipulationQuery) -> list[Translate]:
    """The pushes that bring Utak to the middle of a square, the shortest first; one of no length when he is there."""
    x, y = (sorted((math.floor(v - 0.5) + 0.5 - v, math.floor(v - 0.5) + 1.5 - v), key=abs) for v in errand.utak)
    x, y = ([0.0] if abs(near) <= MIDDLE else [near, far] for near, far in (x, y))
    pushes = [Translate(dx, dy) for dx, dy in product(x, y)]
    return sorted(pushes, key=lambda push: math.hypot(*push))[:NUDGES]


def _may_begin(errand: ManipulationQuery, leg: Leg) -> bool:
    """Whether Utak, with hold of the shape, can and may make the first motion of a leg."""
    motion = leg.motions[0] if leg.motions else Translate(0.0, 0.0)
    pushes = errand.pull or only_pushes(errand.shape, errand.utak, [motion])
    return pushes and errand.yard.lets(errand.shape, errand.utak, motion)


def _price(errand: ManipulationQuery, legs: Sequence[Leg]) -> float:
    """About how many commands legs take, a turn for as many as it counts for."""
    turns = sum(isinstance(motion, Rotate) for leg in legs for motion in leg.motions)
    return commands(legs) + (errand.turn - 1.0) * turns


def _fewest(errand: ManipulationQuery, begun: ManipulationQuery | None = None) -> list[Leg] | None:
    """The legs of one who stands in the middle of a square when he has hold of the shape.

    A push that turns may come to be one straight push, or two: both prices are tried, and the fewer commands taken.

    begun : the errand before he was pushed there, None when he was not.
    """
    search = _Search(errand, begun or errand)
    best: list[Leg] | None = None
    for bend in BENDS if search.sensible else ():
        legs = search.legs(bend)
        best = min((found for found in (best, legs) if found), key=lambda told: _price(errand, told), default=None)
        if best is None or [len(leg.motions) for leg in best] == [1]:
            break
    return best


class _Search:
    """A search by whole squares: what does not depend on its prices is made once."""

    def __init__(self, errand: ManipulationQuery, begun: ManipulationQuery) -> None:
        self.errand, self.begun = errand, begun
        self.body, wide = _stencils(errand)
        rows, columns = errand.walk.shape
        x, y = self.body.home
        self.sensible = 0 <= x < columns and 0 <= y < rows
        if not self.sensible:
            return
        self.grid, free = new_grid(errand.walk, self.body, wide), errand.yard.free
        grips, allowed = _grips(errand, self.body), _allowed(errand, self.body)
        self.board = new_board(
            self.grid, free, errand.walk, self.body, wide, grips, allowed, round(COMMAND * errand.turn)
        )
        self.place = self.grid.number(x, y)
        self.ends = prices(errand.goal, errand.shape, self.body, self.board, self.grid)
        walk = first_walk(self.board, self.place, self.grid.number(*errand.square))
        self.begin = _begin(errand, self.body, walk)

    def legs(self, bend: int) -> list[Leg] | None:
        """The cheapest legs when it costs so much to go on in another direction in the same push."""
        left = guess(self.board, self.ends, bend)
        if not 0 <= left[0, STILL, self.place] < NEVER:
            return None
        count = 36 * len(self.begin) * len(self.board.solid)
        for haste, most in SEARCHES:
            cost, parent = np.zeros(count, np.int32), np.empty(count, np.int32)
            nodes = haul(self.board, left, self.ends, self.begin, self.place, bend, haste, most, cost, parent)
            if len(nodes):
                return LegExtraction(self.errand, self.begun, self.body, self.grid, self.ends).legs(nodes)
        return None


def _begin(errand: ManipulationQuery, body: Footprints, walk: Costs) -> Costs:
    """The price of the first grasp at each hold: nothing for the hold that he has, who must let go for any other."""
    if not errand.held:
        return walk
    begin = np.where(walk >= 0, walk + REGRASP, -1).astype(np.int32)
    begin[(body.holds + body.home == errand.square).all(axis=1)] = 0
    return begin


def _grips(errand: ManipulationQuery, body: Footprints) -> Costs:
    """The price of a grasp at each hold, -1 where it is to be avoided."""
    lying = {(int(x), int(y)) for x, y in body.lying}
    grips = []
    for x, y in body.holds.tolist():
        beside = any((x + dx, y + dy) in lying for dx, dy in DIRECTIONS[::2])
        away = errand.hold_from((x + body.home[0] + 0.5, y + body.home[1] + 0.5))
        grips.append(-1 if errand.avoids(*away) else 0 if beside else AWKWARD)
    return np.array(grips, np.int32)


def _allowed(errand: ManipulationQuery, body: Footprints) -> Bools:
    """In which directions one may push from each hold, in each quarter turn: (4, holds, 8)."""
    allowed = np.ones((4, len(body.holds), 8), np.bool_)
    if errand.pull:
        return allowed
    for n, (x, y) in enumerate(body.holds.tolist()):
        utak = (x + body.home[0] + 0.5, y + body.home[1] + 0.5)
        for d, (dx, dy) in enumerate(DIRECTIONS):
            fine = may_push(errand.shape, utak, dx, dy)
            for k in range(4):
                allowed[k, n, (d + 2 * k) % 8] = fine
    return allowed
