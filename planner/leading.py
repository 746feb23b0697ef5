"""Taking a thing along to where Utak wants to look: who walks there without it must come back for it."""

import math
from itertools import product

import numpy as np

from geometry.carrying import Inside
from geometry.components import components
from geometry.contact import Body
from geometry.rigid import Translate
from geometry.yard import Yard
from kb.worldmodel import Node
from planner.destinations import Situation
from planner.landing import in_view, leads_away, region_of
from planner.screen import Squares, grown, marked
from planner.walking import HURRY

NEARBY = 4  # squares from where he wants to look within which a thing is brought
TRIED = 64  # squares of an aim that are tried
OUT = 8  # squares by which what shuts him in is led out, at most


def lead(node: Node, squares: Squares, situation: Situation) -> Translate | None:
    """The shortest straight push with what he holds by which Utak comes to one of some squares (flat indices).

    On the lattice; None when none is free.
    """
    model = situation.model
    x, y = model.place[0] - model.view.west, model.place[1] - model.view.south
    rows, columns = np.divmod(squares, model.labels.shape[1])
    vectors = np.column_stack([columns + 0.5 - x, rows + 0.5 - y])
    far = np.hypot(*vectors.T)
    able = np.flatnonzero((far > 0.5) & (np.abs(vectors).max(axis=1) <= HURRY.most("explore", model)))
    able = able[np.argsort(far[able], kind="stable")]
    if not len(able):
        return None
    able = able[np.unique(np.linspace(0, len(able) - 1, TRIED).astype(int))]
    yard = Yard(situation.screens.free(0) | model.mask(node.patch))
    free = able[yard.far(Body(in_view(node.polygon, situation), [(x, y)]), vectors[able])]
    return Translate(*(float(v) for v in vectors[free[0]])) if len(free) else None


def out(node: Node, situation: Situation) -> Translate | None:
    """The shortest straight push with what shuts him in by which it no longer does, by whole squares; None for none."""
    model = situation.model
    x, y = model.place[0] - model.view.west, model.place[1] - model.view.south
    steps = np.array([step for step in product(range(-OUT, OUT + 1), repeat=2) if any(step)])
    steps = steps[np.argsort(np.hypot(*steps.T), kind="stable")]
    lies = model.mask(node.patch)
    free = situation.screens.free(0) | lies
    within = Yard(free).far(Body(in_view(node.polygon, situation), [(x, y)]), steps.astype(float))
    for dx, dy in steps[within].tolist():
        here = math.floor(y) + dy, math.floor(x) + dx
        beside = np.roll(lies, (dy, dx), (0, 1))
        left = free & ~beside
        left[here] = True
        rooms = components(left).labels
        if leads_away(rooms == rooms[here], beside):
            return Translate(float(dx), float(dy))
    return None


def near(squares: Squares, situation: Situation) -> Inside | None:
    """What is free near to some squares (flat indices), as an end for what is carried; None when nothing is."""
    free = situation.screens.free(0) & grown(marked(squares, situation.model.labels.shape), NEARBY)
    return Inside(region_of(free)) if free.any() else None
