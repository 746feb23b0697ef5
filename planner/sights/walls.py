"""Walls that were seen and never felt, and the floor from which they are felt.

A movable thing that fills a doorway looks like wall; only its colour tells. Geometry says here which squares of wall
may belong to such a thing, and how much of them is felt from where; planner/asp/deciding chooses where it is felt next.

Masks are (rows, columns) bool on the arrays of the view, row 0 in the south.
"""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from enum import StrEnum
from typing import NamedTuple

import numpy as np

from utak.geometry.kernels.arrays import Bools, Square
from utak.geometry.raster.components import components, with_edge_neighbours
from utak.geometry.raster.runs import runs_along_rows
from utak.kb.perception.interpretation import LONGEST_OBJECT
from utak.kb.task.stretches import MAX_THICK_WALL
from utak.kb.world.model import WorldModel
from utak.planner.screen.projection import CostMaps, dilate, shift_mask
from utak.planner.sights.frontiers import MIN_UNREACHED_SQUARES

EDGE_STEPS = ((1, 0), (0, 1), (-1, 0), (0, -1))  # map frame: east, north, west, south
DOORWAY_WIDTH = 3  # squares in a row that are felt at once; a thing as wide as a usual doorway covers so many (derived)
MAX_THIN_WALL = 5  # squares: a wall up to so thick is thin; a convention
MAX_NICHE_WIDTH = 8  # squares: the floor of a niche is at most so wide; a convention
NICHE_SHARE = 2  # times as wide is the room before a niche, at least: as a room is beside a door
MAX_NICHE_DEPTH = 3  # squares: a niche widens to a room within so many; a convention
MIN_LIKELY_OBJECT = 20  # percent: what is less likely an object is felt as wall (as in planner.goals.placement)


class WallKind(StrEnum):
    """The reason why a stretch of wall may be a thing that can be moved, the likeliest first."""

    # See planner/asp/deciding/subgoals.lp.

    THING = "thing"  # it is beside a thing that was felt in the wall, and may belong to it
    NICHE = "niche"  # it is the back of a niche, as a recessed thing leaves it
    RIM = "rim"  # behind it the wall has a niche or sticks out, as a thing leaves it on the far side
    THIN = "thin"  # floor that is not reached was seen behind it, at most MAX_THIN_WALL squares away
    UNSEEN = "unseen"  # squares that were never seen lie behind it, or such floor, at most MAX_THICK_WALL squares away
    PARTING = "parting"  # behind it lies floor that is reached already
    PLAIN = "plain"  # nothing but wall was seen behind it


class FeelingPlace(NamedTuple):
    """A square from which walls are felt, and what is felt there."""

    square: int  # its flat index (row * columns + column) on the arrays of the view
    # How many stretches of DOORWAY_WIDTH unfelt squares, by kind, are told from it: none of them is one thing if one of
    # its squares is wall
    doorways: Counter[WallKind]
    squares: Counter[WallKind]  # how many unfelt squares, by kind, are felt from it


class FeelingScope(NamedTuple):
    """The walls that matter for a task."""

    # Whether walls between two parts of the floor that is reached count. They lead to no new floor, but may give an
    # object, or a robot that must avoid a door, another way.
    parting: bool = True
    # (rows, columns) bool on the arrays of the view, the only place to which a way is wanted; None when it is not known
    # where. Then walls count alone behind which that place lies, with no reached floor all around.
    wanted: Bools | None = None
    # (rows, columns) bool, the floor on which the robot may go; None for all that it reaches
    allowed: Bools | None = None
    # Whether the task speaks of objects: what seems to be one thing may be two, and one of them the one meant
    things: bool = True


ALL_WALLS = FeelingScope()


def unfelt_walls(model: WorldModel) -> Bools:
    """Return the squares where a wall was seen and never felt, beside floor to which the robot comes."""
    seen_wall = model.view.seen & ~model.space & ~model.felt_verge
    mask: Bools = with_edge_neighbours(_ground(model)) & seen_wall & ~_things(model)
    return mask


def floor_apart(model: WorldModel, reached: Bools, things: bool = True) -> Bools:
    """Return the floor that was seen and that nothing but wall parts from where the robot is, (rows, columns) bool."""
    floor = model.space | reached
    if things:
        floor |= np.any([model.mask(node.patch) for node in model.objects], axis=0)
    labels = components(floor).labels
    large = np.bincount(labels.ravel()) >= MIN_UNREACHED_SQUARES
    row, column = model.view.locate(*model.place)
    apart: Bools = large[labels] & model.space & (labels != labels[row, column])
    return apart


def is_ringed(model: WorldModel, reached: Bools) -> bool:
    """Return whether one thing alone lies all round the floor that the robot reaches, such as a ring about it."""
    beside = with_edge_neighbours(reached) & ~reached
    return any(not (beside & ~model.mask(node.patch)).any() for node in model.objects)


def walls_in_question(model: WorldModel, reached: Bools, scope: FeelingScope = ALL_WALLS) -> dict[WallKind, Bools]:
    """Return the unfelt walls that may be a thing whose removal leads on, by kind; each square has one kind."""
    ground, space, seen = _ground(model), model.space, model.view.seen
    unfelt = unfelt_walls(model) & _leading(model, reached, scope)
    kinds = {kind: np.zeros_like(unfelt) for kind in WallKind}
    near = with_edge_neighbours(reached)
    beyond = [part for part in model.protruding if not (part & near).any()]  # what sticks out into floor not reached
    sticking = np.any(beyond, axis=0) if beyond else np.zeros_like(unfelt)
    things = _things(model, embedded=True)
    niches = _niches(space)
    for step in EDGE_STEPS:
        front = unfelt & shift_mask(ground, *step)
        behind = _behind(front, space, reached, seen, step)
        back = (-step[0], -step[1])
        found = {
            **behind,
            WallKind.THING: front & dilate(things, 1) & ~behind[WallKind.PARTING],
            WallKind.NICHE: front & niches[step] & ~behind[WallKind.PARTING],
            WallKind.RIM: front & _cast(niches[back] | sticking, back, MAX_THIN_WALL) & ~behind[WallKind.PARTING],
        }
        for kind, mask in found.items():
            kinds[kind] |= mask
    taken = np.zeros_like(unfelt)
    for kind in WallKind:
        kinds[kind] &= ~taken
        taken |= kinds[kind]
    if not scope.parting:
        kinds[WallKind.PARTING][:] = False
    return kinds


def feeling_places(cost_maps: CostMaps, scope: FeelingScope = ALL_WALLS) -> list[FeelingPlace]:
    """Return the reachable squares from which walls in question are felt, with what is felt there; [] for none."""
    model, floor = cost_maps.model, cost_maps.floor
    offsets = tuple(model.frame.directions())
    places: dict[int, FeelingPlace] = {}
    stand = floor & ~cost_maps.looked_from
    if scope.allowed is not None:
        stand &= scope.allowed
    for kind, stretch in stretches_in_question(walls_in_question(model, floor, scope)):
        about = {(row - dy, column - dx) for row, column in stretch for dx, dy in offsets}
        for row, column in about:
            if 0 <= row < floor.shape[0] and 0 <= column < floor.shape[1] and stand[row, column]:
                index = row * floor.shape[1] + column
                place = places.setdefault(index, FeelingPlace(index, Counter(), Counter()))
                (place.squares if len(stretch) == 1 else place.doorways)[kind] += 1
    return [places[index] for index in sorted(places)]


def stretches_in_question(kinds: Mapping[WallKind, Bools]) -> Iterator[tuple[WallKind, Sequence[tuple[int, int]]]]:
    """Yield where things may begin in some walls in question, each with the likeliest kind of its squares.

    These are each square (row, column) alone, and each DOORWAY_WIDTH squares in a row, the southernmost or westernmost
    first.
    """
    names, number = list(kinds), np.zeros_like(next(iter(kinds.values())), np.int64)
    high, wide = number.shape
    for rank, mask in enumerate(kinds.values(), 1):
        number[mask] = rank
    for row, column in np.argwhere(number).tolist():
        ahead = [[(row + dy * n, column + dx * n) for n in range(DOORWAY_WIDTH)] for dy, dx in ((0, 1), (1, 0))]
        for stretch in ([(row, column)], *ahead):
            north, east = stretch[-1]
            if north < high and east < wide and all(ranks := [int(number[square]) for square in stretch]):
                yield names[min(ranks) - 1], stretch


def _ground(model: WorldModel) -> Bools:
    """Return the floor to which the robot comes if all things that can be moved are moved away, theirs included."""
    ground: Bools = model.space.copy()
    for node in model.objects:
        if node.confidence >= MIN_LIKELY_OBJECT and node.movable > 0:
            ground |= model.mask(node.patch)
    row, column = model.view.locate(*model.place)
    ground[row, column] = True
    labels = components(ground).labels
    mask: Bools = labels == labels[row, column]
    return mask


def _leading(model: WorldModel, reached: Bools, scope: FeelingScope) -> Bools:
    """Return the squares through which a way may lead on: no reached floor parts them from what they may lead to."""
    if scope.parting and scope.wanted is None:
        return np.ones_like(reached)
    parts = components(np.pad(~reached, 1, constant_values=True))  # what lies beyond the arrays was never seen
    target = np.pad((model.space & ~reached) | ~model.view.seen, 1, constant_values=True)
    if scope.wanted is not None:
        target = np.pad(scope.wanted, 1)
    leads = np.zeros(parts.number + 1, np.bool_)
    leads[parts.labels[target]] = True
    leads[0] = False
    mask: Bools = leads[parts.labels][1:-1, 1:-1]
    return mask


def _things(model: WorldModel, embedded: bool = False) -> Bools:
    """Return the squares of objects that are likely enough; with `embedded` only of those that were never moved."""
    mask: Bools = np.zeros(model.labels.shape, np.bool_)
    for node in model.objects:
        if node.confidence >= MIN_LIKELY_OBJECT and not (embedded and (node.moved or node.colour is None)):
            mask |= model.mask(node.patch)
    return mask


def _behind(front: Bools, space: Bools, reached: Bools, seen: Bools, step: Square) -> dict[WallKind, Bools]:
    """Return which of some squares of wall have what behind them."""
    kinds = {kind: np.zeros_like(front) for kind in WallKind}
    left, back = front.copy(), (-step[0], -step[1])
    new, solid = space & ~reached, seen & ~space
    ground = reached & space
    for depth in range(1, LONGEST_OBJECT + 1):
        ground, new, solid = (shift_mask(mask, *back) for mask in (ground, new, solid))
        unseen = ~(ground | new | solid)  # what lies beyond the arrays was never seen
        kinds[WallKind.PARTING] |= left & ground
        beyond = WallKind.UNSEEN if depth <= MAX_THICK_WALL else WallKind.PLAIN
        kinds[WallKind.THIN if depth <= MAX_THIN_WALL else beyond] |= left & new
        kinds[beyond] |= left & unseen
        left &= ~(ground | new | unseen)
        if not left.any():
            break
    kinds[WallKind.PLAIN] |= left
    return kinds


def _cast(mask: Bools, step: Square, far: int) -> Bools:
    """Return the squares from which a square of a mask is met within `far` steps against `step`."""
    found, last = mask.copy(), mask
    for _ in range(far):
        last = shift_mask(last, *step)
        found |= last
    return found


def _niches(space: Bools) -> dict[Square, Bools]:
    """Return for each direction (columns, rows) the squares of wall at the back of a niche of floor, seen that way."""
    across = _run_lengths(space), _run_lengths(space.T).T  # along rows, along columns
    found = {}
    for step in EDGE_STEPS:
        width = across[0] if step[1] else across[1]
        narrow = space & (width <= MAX_NICHE_WIDTH)
        niche, here = np.zeros_like(space), width
        for _ in range(MAX_NICHE_DEPTH):
            here = shift_mask(here, *step)
            niche |= narrow & (here >= NICHE_SHARE * width)
        found[step] = shift_mask(niche, *step) & ~space
    return found


def _run_lengths(mask: Bools) -> "np.ndarray[tuple[int, ...], np.dtype[np.int32]]":
    """Return for each True square the number of True squares in a row with it along its row; 0 for others."""
    lengths = np.zeros(mask.shape, np.int32)
    for row, start, stop in runs_along_rows(mask).each():
        lengths[row, start:stop] = stop - start
    return lengths
