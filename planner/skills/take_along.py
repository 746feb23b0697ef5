"""Taking an object along to where the robot wants to look: a walk there without it would need a walk back.

Pushes are of the held object, straight, (dx, dy) in squares along the axes of the map; None when no such push is free.
"""

import math
from collections.abc import Mapping, Sequence
from itertools import product

import numpy as np

from utak.geometry.kernels.arrays import Bools, Floats
from utak.geometry.manipulation.goals import End
from utak.geometry.manipulation.plan_carrying import Inside
from utak.geometry.manipulation.workspace import Workspace
from utak.geometry.motion.first_contact import ContactBody
from utak.geometry.motion.se2 import Translate
from utak.geometry.raster.components import components
from utak.geometry.raster.runs import mask_to_polygon
from utak.kb.body import Push
from utak.kb.objects.movability import way_of
from utak.kb.world.model import Node
from utak.planner.goals.placement import floor_leads_away, forbidden_squares, meets_any_end, to_view_frame
from utak.planner.screen.moves import CARRYING_PACE
from utak.planner.screen.projection import SquareIndices, dilate, indices_to_mask
from utak.planner.situation import Situation
from utak.planner.subgoal_kind import SubgoalKind

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


def detour_push(
    node: Node,
    looks: Sequence[SquareIndices],
    ends: Mapping[str, End],
    pushes: Sequence[Translate],
    situation: Situation,
) -> Translate | None:
    """Return the first of one or two pushes to an end with which the robot halts on the way where it looks from."""
    # It takes the place of `pushes`, which lead to an end without that. Each look that is left afterwards counts as a
    # push, and so does the release before those. It is the shortest of the ways that cost least, and no more than
    # `pushes`. ends : regions where the object may end instead.
    x, y = situation.model.place_on_view
    shape, workspace = to_view_frame(node.polygon, situation), _workspace(node, situation)
    squares = np.unique(np.concatenate(list(looks)))
    halts = _pushes_to(squares, situation)
    seen = np.array([[_square_at(situation, x + dx, y + dy) in look for look in looks] for dx, dy in halts])
    last = [n for n, (dx, dy) in enumerate(halts.tolist()) if meets_any_end(ends, Translate(dx, dy).carry(shape))]
    end = np.sum([(push.dx, push.dy) for push in pushes], axis=0)

    def cost(number: int, felt: Bools) -> int:
        """Return what pushes cost with which some of the looks are done, in commands."""
        left = len(looks) - int(felt.sum())
        return number + left + (left > 0)

    found: list[tuple[int, float, float, tuple[float, float]]] = []
    for n in np.flatnonzero(workspace.far(ContactBody(shape, [(x, y)]), halts)).tolist() if len(halts) else ():
        first = Translate(*halts[n].tolist())
        length, body = math.hypot(first.dx, first.dy), ContactBody(first.carry(shape), [(x + first.dx, y + first.dy)])
        if n in last:
            found.append((cost(1, seen[n]), length, length, (first.dx, first.dy)))
        onward = np.vstack([end, halts[last]]) - halts[n]
        for number in np.flatnonzero(workspace.far(body, onward)).tolist():
            felt = seen[n] | seen[last[number - 1]] if number else seen[n]
            way = length + float(np.hypot(*onward[number]))
            found.append((cost(2, felt), way, length, (first.dx, first.dy)))
    best = min(found, default=None)
    return Translate(*best[-1]) if best is not None and best[0] <= cost(len(pushes), np.zeros(0, np.bool_)) else None


def escape_push(node: Node, situation: Situation) -> Translate | None:
    """Return the shortest push, by whole squares, after which the held object does not shut the robot in."""
    # No push leads a way in which the object did not move.
    model = situation.model
    x, y = model.place_on_view
    steps = np.array([step for step in product(range(-MAX_ESCAPE, MAX_ESCAPE + 1), repeat=2) if any(step)])
    steps = steps[np.argsort(np.hypot(*steps.T), kind="stable")]
    covered, workspace = model.mask(node.patch), _workspace(node, situation)
    free = workspace.far(ContactBody(to_view_frame(node.polygon, situation), [(x, y)]), steps.astype(float))
    for dx, dy in steps[free].tolist():
        if way_of(Push(*model.frame.to_utak(dx, dy))) in node.resisted:
            continue
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


def _square_at(situation: Situation, x: float, y: float) -> int:
    """Return the flat index of the square at a point (x, y) of the view frame."""
    return math.floor(y) * int(situation.model.labels.shape[1]) + math.floor(x)


def _workspace(node: Node, situation: Situation) -> Workspace:
    """Return what is surely free for an object and the robot that holds it, as a workspace in squares, view frame."""
    free = situation.cost_maps.free(0) & ~forbidden_squares(node, situation)
    return Workspace(free | situation.model.mask(node.patch))
