"""Looks by which he makes sure: of a thing before he carries it, of how the squares lie, of a passage that is said to
be too narrow, and of what he believes when the last look contradicts it.

Each is an aim to go to first, or None where there is nothing to make sure of.
"""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from geometry.raster.components import edged
from kb.world.doors import jamb
from kb.world.model import Node, WorldModel
from kb.world.rooms import SURE, Door, rooms_of
from planner.carrying.infeasibility import Infeasibility
from planner.goals.robot_goals import contains, out_of_sight
from planner.navigation.subgoals import Subgoal
from planner.screen.moves import is_open
from planner.sights import frontiers
from planner.sights.viewpoints import TAKE, inspection
from planner.situation import Situation

Place = tuple[float, float]
Mask = NDArray[np.bool_]
Floats = NDArray[np.float64]
THIN = 4  # squares that a wall between rooms is thick at most
FEW = 4  # squares looked from by one who has hardly looked


class Verifier:
    """Remembers what he has begun to look at, and which passages he has looked at again."""

    def __init__(self) -> None:
        self._doubted: set[str] = set()  # objects that are being looked at until they are settled
        self._narrow: list[Place] = []  # passages that were looked at again, points of the lattice

    def doubted(self, node: Node) -> bool:
        """Has he begun to look at an object that was not settled?"""
        return node.name in self._doubted

    def inspection(self, node: Node, situation: Situation) -> Subgoal | None:
        """A look at an object that is not settled yet; None when no look is left that may tell more.

        Once begun it is gone on with.
        """
        self._doubted.discard(node.name)
        if node.polygon is not None and not node.open:
            return None
        look = inspection(situation.cost_maps, node, chance=1.0, to=TAKE)
        if not len(look.squares):
            return None
        self._doubted.add(node.name)
        return Subgoal("inspect", *look)

    def narrow_again(self, refusal: Infeasibility, situation: Situation) -> Subgoal | None:
        """A look at the passage that is said to be too narrow, from close by, before one says so who is not sure of his
        map: where looks were received he may misjudge, but how the squares of one look lie beside each other he knows.
        """
        model = situation.model
        neck = None if model.view.sure else refusal.neck()
        if neck is None:
            return None
        where = (neck[0] + model.view.west, neck[1] + model.view.south)
        near = frontiers.close_to(situation.cost_maps, *where)
        if contains(near, model):
            self._narrow.append(where)
        if any(math.dist(where, looked) <= frontiers.CLOSE for looked in self._narrow):
            return None
        return Subgoal("inspect", near, "whether the passage is that narrow is not sure")


def before_taking(node: Node, turns: bool, situation: Situation) -> Subgoal | None:
    """A look at how the squares lie before an object is taken to be turned, by who has looked but a few times.

    A thing that was turned askew, and the map with it, are hard to set right again; a push leaves it as it lies.
    But when it did not move by a push he may have misjudged where it is, or what stands about it.
    """
    model = situation.model
    if not (is_open(model) and (turns or node.stuck) and len(model.looked_from) <= FEW + node.stuck):
        return None
    aside = frontiers.sight_of(situation.cost_maps, model.mask(node.patch), "how the squares lie is not clear")
    return Subgoal("inspect", *aside) if len(aside.squares) else None


def misgiving(situation: Situation) -> Subgoal | None:
    """A look from elsewhere before a goal is held for attained, when the last look contradicts what is believed.

    What contradicts was withdrawn, so the new look agrees with the rest if that is right.
    """
    model = situation.model
    if not model.contradicted:
        return None
    look = frontiers.sight_of(situation.cost_maps, here(model), "what is seen is not as it is believed to be")
    return Subgoal("inspect", *look)


def here(model: WorldModel) -> Mask:
    """(rows, columns): the square in which Utak stands."""
    return model.squares([(math.floor(model.place[0]), math.floor(model.place[1]))])


def more_of(node: Node, situation: Situation) -> Subgoal | None:
    """Where to feel whether an object that stands against a wall goes on in what seems to be part of that."""
    model = situation.model
    beside = edged(model.mask(node.patch))
    standing = [model.verge, *(model.mask(other.patch) for other in model.objects if other.name != node.name)]
    alone = node.moved or model.held == node.name or not any((beside & mask).any() for mask in standing)
    for mask in () if alone else model.protruding:
        look = frontiers.against_the_wall(situation.cost_maps, mask)
        if (mask & beside).any() and len(look.squares):
            return Subgoal("inspect", *look)
    return None


def before_elsewhere(goal: str, began: Place, lying: Mask, situation: Situation) -> Subgoal | None:
    """What to look at or to feel, before one says that something is elsewhere than it began.

    goal : in, through or around. began : where it began, a point of the lattice. lying : (rows, columns) where it lies.
    """
    return unseen_beyond(goal, began, lying, situation) or unfelt_wall(goal, began, lying, situation)


def unfelt_wall(goal: str, began: Place, lying: Mask, situation: Situation) -> Subgoal | None:
    """Where to feel whether something is part of a wall, before one says that something is elsewhere than it began.

    If it were a thing that stands against the wall, the goal would hold no more. All as of before_elsewhere.
    """
    holds_by = _holding(goal, began, lying, situation)
    for mask in situation.model.protruding:
        if any(_jambs_in_line(mask, door, situation.model) for door in situation.rooms.sure):
            continue
        look = frontiers.against_the_wall(situation.cost_maps, mask)
        if not len(look.squares):  # whatever lies askew must be seen better before one can stand right beside it
            look = frontiers.sight_of(situation.cost_maps, mask, look.what)
        if len(look.squares) and holds_by(mask):
            return Subgoal("inspect", *look)
    return None


def unseen_beyond(goal: str, began: Place, lying: Mask, situation: Situation) -> Subgoal | None:
    """Where to see how wide the floor is beyond a door, before one says that something is there.

    A door is a neck, and what was never seen counts as floor: behind an arm of the room there may be nothing but that.
    All as of before_elsewhere.
    """
    model, view = situation.model, situation.model.view
    if goal == "around":
        return None
    shut = view._replace(probability=np.where(view.seen, view.probability, 1.0).astype(np.float32))
    rooms = rooms_of(replace(model, view=shut), situation.rules, model.verge | ~view.seen)
    if (situation.next_to(began, rooms, SURE) & lying).any():
        return None
    rows, columns = np.nonzero(lying)

    def far(look: frontiers.Viewpoint) -> float:
        there = np.unravel_index(look.squares, lying.shape)
        return float(np.hypot(there[0] - rows.mean(), there[1] - columns.mean()).min())

    nearest = min(frontiers.frontiers(situation.cost_maps, frontiers.APART), key=far, default=None)
    return None if nearest is None else Subgoal("inspect", *nearest)


def _jambs_in_line(mask: Mask, door: Door, model: WorldModel) -> bool:
    """Is something one jamb of a door, and the other one a thin wall, too? Then they are hardly but one wall."""
    for end, other in ((door.a, door.b), (door.b, door.a)):
        if len(jamb(mask, end)[0]):
            x, y = np.subtract(other, end) / max(door.width, 1e-9)
            place = np.add(other, (0.5 * x, 0.5 * y))
            return all(_floor_beside(place, way, model) for way in ((-y, x), (y, -x)))
    return False


def _floor_beside(place: Floats, way: tuple[float, float], model: WorldModel) -> bool:
    """Is there floor not far from a place in a direction?"""
    steps = np.arange(1, THIN + 1)[:, None] * np.array(way) + place
    columns, rows = np.floor(steps).astype(int).T
    height, width = model.space.shape
    inside = (rows >= 0) & (rows < height) & (columns >= 0) & (columns < width)
    return bool(model.space[rows[inside], columns[inside]].any())


def _holding(goal: str, began: Place, lying: Mask, situation: Situation) -> Callable[[Mask], bool]:
    """Whether a goal holds only if some squares of what bounds the floor are wall. All as of before_elsewhere."""
    model = situation.model
    if goal == "around":
        hidden = lying & out_of_sight(model.verge, model, began)
        return lambda mask: bool((hidden & ~out_of_sight(model.verge & ~mask, model, began)).any())
    beyond = situation.next_to(began, situation.rooms, SURE)

    def elsewhere(mask: Mask) -> bool:
        other = situation.next_to(began, rooms_of(model, situation.rules, model.verge & ~mask), SURE)
        return bool(other.any() and not (other & beyond).any())

    return elsewhere
