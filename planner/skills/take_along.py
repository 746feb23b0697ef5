"""Taking an object along to where the robot wants to look: a walk there without it would need a walk back.

Pushes are of the held object, straight, (dx, dy) in squares along the axes of the map; None when no such push is free.
"""

import math
from itertools import product

import numpy as np

from geometry.kernels.arrays import XY, Floats
from geometry.manipulation.plan_carrying import Inside
from geometry.manipulation.workspace import Workspace
from geometry.motion.first_contact import ContactBody
from geometry.motion.se2 import Translate
from geometry.raster.components import components
from geometry.raster.runs import mask_to_polygon
from kb.world.model import Node
from planner.goals.placement import floor_leads_away, forbidden_squares, to_view_frame
from planner.screen.moves import CARRYING_PACE
from planner.screen.projection import SquareIndices, dilate, indices_to_mask
from planner.situation import Situation
from planner.subgoal_kind import SubgoalKind

VIEWPOINT_RADIUS = 4  # squares from a viewpoint within which an object is brought; a convention
MAX_TRIED_PUSHES = 64  # squares of a viewpoint that are tried; a bound on time
MIN_PUSH = 0.5  # squares: a shorter push stays in the robot's square
MAX_ESCAPE = 8  # squares along each axis by which an object that shuts the robot in is led out; a bound on time


def shortest_push(node: Node, squares: SquareIndices, situation: Situation) -> Translate | None:
    """Return the shortest push that brings the robot to the centre of one of some squares."""
    pushes = _pushes_to(squares, situation)
    body = ContactBody(to_view_frame(node.polygon, situation), [situation.model.place_on_view])
    free = pushes[_workspace(node, situation).far(body, pushes)]
    return Translate(*free[0].tolist()) if len(free) else None


def detour_push(node: Node, squares: SquareIndices, end: XY, situation: Situation) -> Translate | None:
    """Return the first of two pushes to an end, so that the robot comes to one of some squares between them."""
    x, y = situation.model.place_on_view
    pushes = _pushes_to(squares, situation)
    length = np.hypot(*pushes.T) + np.hypot(*(np.array(end) - pushes).T)
    pushes = pushes[np.argsort(length, kind="stable")]
    shape, workspace = to_view_frame(node.polygon, situation), _workspace(node, situation)
    for dx, dy in pushes[workspace.far(ContactBody(shape, [(x, y)]), pushes)].tolist():
        push, onward = Translate(dx, dy), Translate(end[0] - dx, end[1] - dy)
        if workspace.lets(push.carry(shape), (x + dx, y + dy), onward):
            return push
    return None


def escape_push(node: Node, situation: Situation) -> Translate | None:
    """Return the shortest push, by whole squares, after which the held object does not shut the robot in."""
    model = situation.model
    x, y = model.place_on_view
    steps = np.array([step for step in product(range(-MAX_ESCAPE, MAX_ESCAPE + 1), repeat=2) if any(step)])
    steps = steps[np.argsort(np.hypot(*steps.T), kind="stable")]
    covered, workspace = model.mask(node.patch), _workspace(node, situation)
    free = workspace.far(ContactBody(to_view_frame(node.polygon, situation), [(x, y)]), steps.astype(float))
    for dx, dy in steps[free].tolist():
        here = math.floor(y) + dy, math.floor(x) + dx
        moved = np.roll(covered, (dy, dx), (0, 1))
        left = workspace.free & ~moved
        left[here] = True
        rooms = components(left).labels
        if floor_leads_away(rooms == rooms[here], moved):
            return Translate(float(dx), float(dy))
    return None


def region_near(squares: SquareIndices, situation: Situation) -> Inside | None:
    """Return the free region near some squares, as an end for an object; None when nothing is free there."""
    free = situation.cost_maps.free(0) & dilate(
        indices_to_mask(squares, situation.model.labels.shape), VIEWPOINT_RADIUS
    )
    return Inside(mask_to_polygon(free)) if free.any() else None


def _pushes_to(squares: SquareIndices, situation: Situation) -> Floats:
    """Return the pushes that bring the robot to the middles of some squares, the shortest first, (n, 2) float64."""
    model = situation.model
    rows, columns = np.divmod(squares, model.labels.shape[1])
    x, y = model.place_on_view
    pushes = np.column_stack([columns + 0.5 - x, rows + 0.5 - y])
    length = np.hypot(*pushes.T)
    longest = CARRYING_PACE.most(SubgoalKind.EXPLORE, model)
    able = np.flatnonzero((length > MIN_PUSH) & (np.abs(pushes).max(axis=1) <= longest))
    able = able[np.argsort(length[able], kind="stable")]
    spread = np.unique(np.linspace(0, len(able) - 1, MAX_TRIED_PUSHES).astype(int)) if len(able) else able
    chosen: Floats = pushes[able[spread]]
    return chosen


def _workspace(node: Node, situation: Situation) -> Workspace:
    """Return what is surely free for an object and the robot that holds it, as a workspace in squares, view frame."""
    free = situation.cost_maps.free(0) & ~forbidden_squares(node, situation)
    return Workspace(free | situation.model.mask(node.patch))
