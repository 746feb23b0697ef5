"""Freeing a thing that stands against something: it is drawn back, and aside so far that it can go on."""

import itertools
import math

import numpy as np
import shapely

from geometry.motion.first_contact import ContactBody, Obstacles
from geometry.motion.se2 import Translate
from kb.mapping.occupancy import FULL
from kb.world.model import Node, WorldModel

BACK = 1.0  # squares by which it is drawn back
ONWARD = 3.0  # squares further on for which there must be room
STEP, MOST = 0.1, 10  # squares between the ways aside that are tried, and how many there are to either side
ROOM = 0.3  # squares more than what just lets it pass, if there is so much room to either side
ABOUT = 4  # squares about it in which something may stand in its way


def drawn_back(node: Node, pushed: Translate, model: WorldModel, doubted: bool = False) -> Translate:
    """The push that frees a thing which was stopped in a push: aside as well when it lies only about where he believes.

    Where it is known exactly nothing that he knows can have stopped it.

    doubted : it was stopped again where nothing known is in its way, so it lies, or is, otherwise than he believes. It
    is drawn back to the middle of the room that there is to either side, then.
    """
    if not any(pushed):
        return pushed
    far = min(BACK, math.hypot(*pushed))

    def way(aside: float) -> Translate:
        return pushed.steered(-far, aside)

    if not (node.inexact or doubted):
        return way(0.0)
    walls, body, onward = _walls(node, model), ContactBody(node.polygon), pushed.steered(far + ONWARD, 0.0)

    def passes(aside: float) -> bool:
        back = way(aside)
        free = walls.first_contact(body, back).fraction == 1
        return free and walls.first_contact(body.after(back), onward).fraction == 1

    sides = sorted((STEP * n for n in range(-MOST, MOST + 1)), key=abs)
    least = next((aside for aside in sides if passes(aside)), None)
    if least is None or (least == 0.0 and not doubted):  # there is no such way, or nothing known stands in its way
        return way(0.0)
    if least == 0.0:
        left, right = (list(itertools.takewhile(passes, (s * STEP * n for n in range(MOST + 1)))) for s in (-1, 1))
        return way((left[-1] + right[-1]) / 2)
    side = math.copysign(1.0, least)
    further = (least + side * STEP * n for n in range(1, 2 * round(ROOM / STEP) + 1))
    free = [least, *itertools.takewhile(passes, further)]
    return way(free[len(free) // 2])


def _walls(node: Node, model: WorldModel) -> Obstacles:
    """All that surely stands about a thing, square by square."""
    view, reach = model.view, ABOUT + ONWARD
    x0, y0, x1, y1 = node.polygon.bounds
    rows, columns = np.nonzero((view.state == FULL) & ~model.mask(node.patch))
    x, y = columns + view.west, rows + view.south
    near = (x0 - reach < x) & (x < x1 + reach) & (y0 - reach < y) & (y < y1 + reach)
    return Obstacles(list(shapely.box(x[near], y[near], x[near] + 1, y[near] + 1)))
