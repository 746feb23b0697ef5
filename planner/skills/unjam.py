"""Unjamming: an object that stands against something is drawn back, and so far aside that it can go on."""

import itertools
import math

import numpy as np
import shapely

from utak.geometry.motion.first_contact import ContactBody, Obstacles
from utak.geometry.motion.se2 import Translate
from utak.kb.mapping.occupancy import OCCUPIED
from utak.kb.world.model import Node, WorldModel

RETREAT = 1.0  # squares by which an object is drawn back; a convention: one square shows whether it moved
ROOM_AHEAD = 3.0  # squares beyond the stop for which there must be room afterwards; a convention
ASIDE_STEP = 0.1  # squares between the ways aside that are tried; a convention
MAX_ASIDE_STEPS = 10  # ways aside that are tried to either side: up to one square
ROOM_TO_SPARE = 0.3  # squares further aside than just passes, if there is so much room; tuned on random worlds
SEARCH_RIM = 4  # squares about an object in which something may stand in its way


def retreat_push(node: Node, pushed: Translate, model: WorldModel, doubted: bool = False) -> Translate:
    """Return the push that frees an object stopped in a push, (dx, dy) in squares along the axes of the map."""
    if not any(pushed):
        return pushed
    back = min(RETREAT, math.hypot(*pushed))

    def retreat(aside: float) -> Translate:
        """Return the push back and aside, in squares along the axes of the map."""
        return pushed.steered(-back, aside)

    if not (node.inexact or doubted):
        return retreat(0.0)
    walls, body, onward = _walls_near(node, model), ContactBody(node.polygon), pushed.steered(back + ROOM_AHEAD, 0.0)

    def passes(aside: float) -> bool:
        """Return whether the object can be drawn back so, then pushed on until ROOM_AHEAD squares beyond the stop."""
        push = retreat(aside)
        free = walls.first_contact(body, push) == 1
        return free and walls.first_contact(body.after(push), onward) == 1

    sides = sorted((ASIDE_STEP * n for n in range(-MAX_ASIDE_STEPS, MAX_ASIDE_STEPS + 1)), key=abs)
    least = next((aside for aside in sides if passes(aside)), None)
    if least is None or (least == 0.0 and not doubted):  # no way aside helps, or nothing known stands in the way
        return retreat(0.0)
    if least == 0.0:
        steps = range(MAX_ASIDE_STEPS + 1)
        left, right = (list(itertools.takewhile(passes, (s * ASIDE_STEP * n for n in steps))) for s in (-1, 1))
        return retreat((left[-1] + right[-1]) / 2)
    side = math.copysign(1.0, least)
    further = (least + side * ASIDE_STEP * n for n in range(1, 2 * round(ROOM_TO_SPARE / ASIDE_STEP) + 1))
    free = [least, *itertools.takewhile(passes, further)]
    return retreat(free[len(free) // 2])


def _walls_near(node: Node, model: WorldModel) -> Obstacles:
    """Return all squares near an object that are surely occupied, but for its own, as obstacles in squares."""
    view, reach = model.view, SEARCH_RIM + ROOM_AHEAD
    x0, y0, x1, y1 = node.polygon.bounds
    rows, columns = np.nonzero((view.state == OCCUPIED) & ~model.mask(node.patch))
    x, y = columns + view.west, rows + view.south
    near = (x0 - reach < x) & (x < x1 + reach) & (y0 - reach < y) & (y < y1 + reach)
    return Obstacles(list(shapely.box(x[near], y[near], x[near] + 1, y[near] + 1)))
