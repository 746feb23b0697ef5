"""Taking a thing along to where Utak wants to look: who walks there without it must come back for it."""

import math
from itertools import product

import numpy as np
from numpy.typing import NDArray

from geometry.manipulation.plan_carrying import Inside
from geometry.manipulation.workspace import Workspace
from geometry.motion.first_contact import ContactBody
from geometry.motion.se2 import Translate
from geometry.raster.components import components
from kb.world.model import Node
from planner.goals.placement import barred, in_view, leads_away, region_of
from planner.screen.moves import HURRY
from planner.screen.projection import Squares, grown, marked
from planner.situation import Situation

Floats = NDArray[np.float64]
NEARBY = 4  # squares from where he wants to look within which a thing is brought
TRIED = 64  # squares of an aim that are tried
OUT = 8  # squares by which what shuts him in is led out, at most


def lead(node: Node, squares: Squares, situation: Situation) -> Translate | None:
    """The shortest straight push with what he holds by which Utak comes to one of some squares (flat indices).

    On the lattice; None when none is free.
    """
    pushes = _pushes_to(squares, situation)
    body = ContactBody(in_view(node.polygon, situation), [situation.model.place_on_view])
    free = pushes[_yard(node, situation).far(body, pushes)]
    return Translate(*free[0].tolist()) if len(free) else None


def by_way(node: Node, squares: Squares, end: tuple[float, float], situation: Situation) -> Translate | None:
    """The straight push by which Utak comes to one of some squares (flat indices) and from where one more leads to an
    end, so that both are as short as can be. end : how far it lies from where the thing is. None when there is none.
    """
    x, y = situation.model.place_on_view
    pushes = _pushes_to(squares, situation)
    way = np.hypot(*pushes.T) + np.hypot(*(np.array(end) - pushes).T)
    pushes = pushes[np.argsort(way, kind="stable")]
    shape, yard = in_view(node.polygon, situation), _yard(node, situation)
    for dx, dy in pushes[yard.far(ContactBody(shape, [(x, y)]), pushes)].tolist():
        push, on = Translate(dx, dy), Translate(end[0] - dx, end[1] - dy)
        if yard.lets(push.carry(shape), (x + dx, y + dy), on):
            return push
    return None


def out(node: Node, situation: Situation) -> Translate | None:
    """The shortest straight push with what shuts him in by which it no longer does, by whole squares; None for none."""
    model = situation.model
    x, y = model.place_on_view
    steps = np.array([step for step in product(range(-OUT, OUT + 1), repeat=2) if any(step)])
    steps = steps[np.argsort(np.hypot(*steps.T), kind="stable")]
    lies, yard = model.mask(node.patch), _yard(node, situation)
    within = yard.far(ContactBody(in_view(node.polygon, situation), [(x, y)]), steps.astype(float))
    for dx, dy in steps[within].tolist():
        here = math.floor(y) + dy, math.floor(x) + dx
        beside = np.roll(lies, (dy, dx), (0, 1))
        left = yard.free & ~beside
        left[here] = True
        rooms = components(left).labels
        if leads_away(rooms == rooms[here], beside):
            return Translate(float(dx), float(dy))
    return None


def _pushes_to(squares: Squares, situation: Situation) -> Floats:
    """(n, 2): the pushes by which he comes to the middles of some squares (flat indices), a choice of TRIED of them.

    The shortest first; none that is longer than he goes before he looks.
    """
    model = situation.model
    rows, columns = np.divmod(squares, model.labels.shape[1])
    x, y = model.place_on_view
    pushes = np.column_stack([columns + 0.5 - x, rows + 0.5 - y])
    far = np.hypot(*pushes.T)
    able = np.flatnonzero((far > 0.5) & (np.abs(pushes).max(axis=1) <= HURRY.most("explore", model)))
    able = able[np.argsort(far[able], kind="stable")]
    spread = np.unique(np.linspace(0, len(able) - 1, TRIED).astype(int)) if len(able) else able
    chosen: Floats = pushes[able[spread]]
    return chosen


def _yard(node: Node, situation: Situation) -> Workspace:
    """What is surely free for a thing and him who holds it."""
    free = situation.cost_maps.free(0) & ~barred(node, situation)
    return Workspace(free | situation.model.mask(node.patch))


def near(squares: Squares, situation: Situation) -> Inside | None:
    """What is free near to some squares (flat indices), as an end for what is carried; None when nothing is."""
    free = situation.cost_maps.free(0) & grown(marked(squares, situation.model.labels.shape), NEARBY)
    return Inside(region_of(free)) if free.any() else None
