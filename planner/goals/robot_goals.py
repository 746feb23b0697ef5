"""What a goal means on the screen: the squares on which it holds for Utak, or what is missing to tell."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from geometry.raster.components import edged
from kb.language.terms import Fact, Symbol, Term
from kb.world.model import WorldModel
from kb.world.rooms import Rooms
from planner.screen.projection import Squares, grown
from planner.sights.frontiers import APART, Viewpoint, frontiers, gaps, jambs, promised, rooms_beyond, short_of
from planner.situation import Situation

Mask = NDArray[np.bool_]
# How much further towards a corner what is not seen may go, in squares east and north added:
FURTHEST = 45  # at most
BARE, A_PERCENT = 12, 2  # behind floor that goes on: so many for each percent that it promises more than BARE
GAP, WIDEST_DOOR = 36, 6  # behind a stretch of floor no wider than a door: at least so many
WIDELY = 24  # behind floor of another room that goes on more widely: at least so many
CUT_OFF = 30  # floor that no way leads to yet
ONWARD = 30  # straight on behind where the floor goes on
ASIDE = 28  # to either side behind that
BESIDE_DOOR = 41  # to either side behind what is no wider than a door: over a room, and most of the next
RAYS = 192  # places along a line of sight at which it may meet the verge


@dataclass(frozen=True)
class Destination:
    """Where a goal holds.

    Attributes
    ----------
    squares : flat indices, empty while it is not known where.
    missing : what must be known first, in words; "" when nothing is. Where there are squares, it may hold elsewhere.
    lookouts : places where just that may be seen; when there are none, any place worth a look is.
    """

    squares: Squares
    missing: str = ""
    viewpoints: tuple[Viewpoint, ...] = ()


def no_way(where: Sequence[Destination]) -> str:
    """Return why nothing is left when it is known where each of some goals holds, in words."""
    both = [set(d.squares.tolist()) for d in where]
    return "no way leads there" if set.intersection(*both) else "there is no place where all of it holds at once"


def nowhere(missing: str, viewpoints: tuple[Viewpoint, ...] = ()) -> Destination:
    """It is not known yet where."""
    return Destination(np.zeros(0, np.int64), missing, viewpoints)


def corner_side(goal: Fact) -> str:
    """Return the side of the corner that a goal is about, such as northeast; "" when it is about none."""
    where = goal.args[1] if len(goal.args) > 1 else None
    is_corner = goal.name == "at" and isinstance(where, Symbol) and where.name == "corner"
    return str(where.args[0]) if is_corner and isinstance(where, Symbol) else ""


def destination(goal: Fact, situation: Situation) -> Destination:
    """The squares on which a goal of place (at, in, beside, through with utak) holds."""
    where = goal.args[1]
    if side := corner_side(goal):
        return corner(side, situation)
    if goal.name == "at" and str(where) == "start":
        return Destination(_within(situation.model, situation.model.frame.origin, 1.0))
    if goal.name in ("at", "beside", "circled"):
        return beside(str(where), situation)
    if goal.name in ("in", "through"):
        return _room(goal, where, situation)
    if goal.name == "around":
        return around_corner(situation)
    raise ValueError(f"not a goal of place: {goal}")


def corner(side: str, situation: Situation) -> Destination:
    """The convex corner of the known floor that lies furthest towards a side of Utak's frame.

    Where a room is not seen that may go further, it may be another one.
    """
    unknown = unknown_corner(side, situation, situation.cost_maps.floor)
    if unknown is not None:
        return unknown
    column, row = situation.corners[side].square
    rooms = rooms_to_see(side, situation)
    best = np.array([row * situation.model.labels.shape[1] + column])
    return Destination(best, rooms[0].what if rooms else "", rooms)


def unknown_corner(side: str, situation: Situation, floor: Mask) -> Destination | None:
    """What is missing to tell where the corner towards a side is; None when that is known.

    It is not where the floor goes on unseen at its furthest, or is seen beyond walls. floor : (rows, columns) that can
    be reached.
    """
    model, cost_maps = situation.model, situation.cost_maps
    column, row = situation.corners[side].square
    best = row * model.labels.shape[1] + column
    if not floor[row, column]:
        rooms = tuple(room for room in rooms_beyond(cost_maps) if best in room.squares)
        return nowhere(f"the floor towards the {side} lies beyond a passage that is not seen yet", rooms)
    around = (slice(max(row - 1, 0), row + 2), slice(max(column - 1, 0), column + 2))
    if not model.view.seen[around].all():
        viewpoint = Viewpoint(short_of(cost_maps, np.array([best])), f"the floor goes on to the {side}, unseen")
        return nowhere(viewpoint.what, (viewpoint,))
    return None


def rooms_to_see(side: str, situation: Situation) -> tuple[Viewpoint, ...]:
    """Rooms that are not seen and may go further towards a side than all that is.

    The floor goes on unseen behind what may be a door, or would be one if what may yet be an object is no wall; or
    behind what is likely a gap; or it is seen where no way leads yet, but one may.
    """
    cost_maps, model = situation.cost_maps, situation.model
    divided = [rooms.labels.ravel() for rooms in (situation.rooms, situation.supposed) if rooms.doors]
    doorways = (situation.rooms.doorways | situation.supposed.doorways).ravel()
    column, row = situation.corners[side].square
    best = np.array([row * model.labels.shape[1] + column])
    known = _towards(side, best, model)

    def short(look: Viewpoint) -> float:
        return known - _towards(side, look.squares, model)

    def apart(look: Viewpoint) -> bool:
        return any((labels[look.squares] != labels[best]).any() for labels in divided)

    def narrow(look: Viewpoint) -> bool:
        return bool(max(np.ptp(v) for v in np.divmod(look.squares, model.labels.shape[1])) < WIDEST_DOOR)

    def reach(look: Viewpoint, least: int, aside: int) -> float:
        promise = max(A_PERCENT * (look.chance - BARE), least)
        onward = _onward(side, look.squares, model)
        sideways = math.sqrt(max(2 - onward**2, 0.0))
        return min(promise, FURTHEST, ONWARD * max(onward, 0.0) + aside * sideways)

    cut_off = [look for look in rooms_beyond(cost_maps) if short(look) <= CUT_OFF]
    looks = [look for look in cut_off if cost_maps.nearest(look.squares) is not None]
    open_ends = [look for look in frontiers(cost_maps, APART) if short(look) <= FURTHEST]
    likely_ends = [look for look in gaps(cost_maps) if short(look) <= FURTHEST and narrow(look)]
    ends = promised(cost_maps, [*open_ends, *likely_ends])
    for look in ends[: len(open_ends)]:
        if doorways[look.squares].any():
            least, aside = FURTHEST, BESIDE_DOOR
        elif narrow(look):
            least, aside = GAP, BESIDE_DOOR
        elif apart(look):
            least, aside = WIDELY, ASIDE
        else:
            continue
        if short(look) <= reach(look, least, aside):
            looks.append(look)
    for look in ends[len(open_ends) :]:
        near = short_of(cost_maps, look.squares)
        if len(near) and short(look) <= reach(look, FURTHEST, BESIDE_DOOR):
            looks.append(look._replace(squares=near))
    what = f"a room is not seen that may go further to the {side}"
    return tuple(look._replace(what=what) for look in looks)


def _onward(side: str, squares: Squares, model: WorldModel) -> float:
    """How much further towards a corner, east and north added, a step of one square on from some squares leads.

    On is the mean of the directions in which nothing is seen; 1 where they cancel out.
    """
    rows, columns = np.divmod(squares, model.labels.shape[1])
    unseen = np.pad(~model.view.seen, 1, constant_values=True)
    steps = np.array([(x, y) for x in (-1, 0, 1) for y in (-1, 0, 1)])
    x, y = np.array([unseen[rows + 1 + y, columns + 1 + x].sum() for x, y in steps]) @ steps
    far = math.hypot(x, y)
    return float(_measured(side, *model.frame.to_utak(x / far, y / far))) if far else 1.0


def _measured(side: str, east: Any, north: Any) -> Any:
    """How far something lies towards a corner of Utak's frame: east and north added, for northeast."""
    return (east if "east" in side else -east) + (north if "north" in side else -north)


def _towards(side: str, squares: Squares, model: WorldModel) -> float:
    """How far the furthest of some squares lies towards a corner of Utak's frame: east and north added."""
    rows, columns = np.divmod(squares, model.labels.shape[1])
    points = np.stack([columns + model.view.west + 0.5, rows + model.view.south + 0.5])
    east, north = np.column_stack(model.frame.place_to_utak(*points)).T
    return float(_measured(side, east, north).max())


def beside(parameter: str, situation: Situation) -> Destination:
    """The squares from which an object is at most one square away.

    Of those, the ones that share an edge with it, for its outline may end short of the corner of a square; and the
    ones nearest to its believed outline.
    """
    node = situation.model.object(situation.binding.get(parameter, ""))
    if node is None:
        return nowhere(f"nothing seen so far is {parameter}")
    mask = situation.model.mask(node.patch)
    about = grown(mask, 1)
    near = about & situation.cost_maps.floor
    touching = near & edged(mask)
    if touching.any():
        near = touching
    squares = np.flatnonzero(near)
    if not len(squares):
        what = f"no way is seen yet that leads to {parameter}"
        return nowhere(what, (Viewpoint(np.flatnonzero(about & situation.model.space), what),))
    if node.polygon is not None:
        rows, columns = np.divmod(squares, near.shape[1])
        view = situation.model.view
        away = shapely.distance(node.polygon, shapely.points(columns + view.west + 0.5, rows + view.south + 0.5))
        squares = squares[away <= max(1.0, float(away.min()))]
    return Destination(squares)


def _room(goal: Fact, where: Term, situation: Situation) -> Destination:
    beyond, looks = situation.beyond(situation.model.frame.origin)
    if looks:
        return nowhere(looks[0].what, looks)
    squares = np.flatnonzero(beyond & situation.cost_maps.floor)
    if len(squares):
        return Destination(squares)
    what = no_next_room(situation)
    likely = _likely_rooms(situation)
    return nowhere(what, (*likely, *doorsteps(situation, tried=bool(likely))))


def no_next_room(situation: Situation) -> str:
    """Why no next room is known, in words: no door is, and what comes nearest to be one; or none can be reached."""
    model, opening = situation.model, situation.rooms.opening
    if situation.rooms.sure:
        return "no next room is seen yet that can be reached"
    if opening is None:
        return "no door is seen yet"
    origin = model.frame.origin[0] - model.view.west, model.frame.origin[1] - model.view.south
    where = "behind" if math.dist(origin, opening.narrow) > math.dist(origin, opening.wide) else "before"
    at = model.point_in_words(opening.place)
    return (
        f"no door is seen yet: the opening {opening.width:.1f} squares wide at {at} is none, "
        f"for the floor {where} it is nowhere wider than {opening.least:.1f}, less than twice as wide"
    )


def _likely_rooms(situation: Situation) -> list[Viewpoint]:
    """What lies beyond likely doors, until he has been there: on his way he sees whether they are some."""
    model = situation.model
    rooms, beyond = situation.likely_beyond(model.frame.origin)
    beyond &= situation.cost_maps.floor
    if (beyond & situation.cost_maps.looked_from).any():
        return []
    found = [np.flatnonzero(beyond & (rooms.labels == n)) for n in numbers(rooms, beyond)]
    return [Viewpoint(squares, "a door seems to lead there") for squares in found]


def numbers(rooms: Rooms, mask: Mask) -> list[int]:
    """The rooms that have squares of a mask."""
    return [int(number) for number in np.unique(rooms.labels[mask])]


def doorsteps(situation: Situation, tried: bool = False) -> tuple[Viewpoint, ...]:
    """Where to look for a door: at what may be one, and for a way to floor that is seen and cannot be reached yet.

    tried : likely doors are gone through, and not looked at.
    """
    doubtful = jambs(situation.cost_maps, [door for door in situation.rooms.doors if not (tried and door.likely)])
    return (*doubtful, *rooms_beyond(situation.cost_maps))


def around_corner(situation: Situation) -> Destination:
    """The squares wholly out of sight of the place where Utak woke: a corner of the verge lies in between."""
    model = situation.model
    squares = np.flatnonzero(out_of_sight(model.verge, model, model.frame.origin) & situation.cost_maps.floor)
    return Destination(squares) if len(squares) else nowhere("no corner is seen yet that hides a place")


def out_of_sight(verge: Mask, model: WorldModel, place: tuple[float, float]) -> Mask:
    """(rows, columns): squares none of whose corners is seen from a point of the lattice past a verge."""
    height, width = verge.shape
    x, y = place[0] - model.view.west, place[1] - model.view.south
    corners = np.stack(np.meshgrid(np.arange(width + 1), np.arange(height + 1)), axis=-1).astype(float)
    hidden = np.zeros(corners.shape[:2], np.bool_)
    for part in (np.arange(RAYS) + 0.5) / RAYS:
        columns, rows = np.moveaxis(np.floor((1 - part) * np.array([x, y]) + part * corners).astype(int), -1, 0)
        hidden |= verge[np.clip(rows, 0, height - 1), np.clip(columns, 0, width - 1)]
    mask: Mask = hidden[:-1, :-1] & hidden[1:, :-1] & hidden[:-1, 1:] & hidden[1:, 1:]
    return mask


def _within(model: WorldModel, point: tuple[float, float], reach: float) -> Squares:
    """The squares whose centres are within so many squares of a point, in each axis."""
    row, column = model.view.locate(*point)
    rows, columns = np.ogrid[: model.labels.shape[0], : model.labels.shape[1]]
    x, y = point[0] - model.view.west, point[1] - model.view.south
    near = (abs(columns + 0.5 - x) < reach) & (abs(rows + 0.5 - y) < reach)
    near[row, column] = True
    return np.flatnonzero(near)


def contains(squares: Squares, model: WorldModel) -> bool:
    """Does Utak stand on one of these squares?"""
    row, column = model.view.locate(*model.place)
    return bool((squares == row * model.labels.shape[1] + column).any())
