"""CarryingPlan: how Utak brings a body to a goal, letting go of it and taking it again where he must.

    plan = plan_carrying(brick, free, (3.5, 3.5), Inside(room))
    for leg in plan.legs:
        ...  # walk to leg.place, grasp, push and turn, release

# Strategy: first by whole squares and quarter turns (geometry.manipulation.lattice_planner): all stays on the
# lattice, and what Utak
# believes of places stays certain. Only where that finds nothing are the body alone (a proof when it cannot pass) and
# any place and angle tried.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from geometry.cspace.bottleneck import Bottleneck
from geometry.cspace.plan_motion import MotionPlan
from geometry.kernels.arrays import XY, Bools
from geometry.manipulation.align import carry_straightened
from geometry.manipulation.free_body import move_alone
from geometry.manipulation.goals import At, Between, End, InCorner, Inside, Roomy, met
from geometry.manipulation.lattice_planner import carry_squarewise
from geometry.manipulation.legs import Leg, commands, shifted, verified
from geometry.manipulation.press import pressed
from geometry.manipulation.query import ManipulationQuery
from geometry.manipulation.single_grasp import carry_freed, carry_held
from geometry.manipulation.workspace import Workspace
from geometry.motion.first_contact import boundary_edges
from geometry.motion.se2 import Pose, Rotate, Translate
from geometry.motion.validation import check, sound

LEAST_ANGLE = 0.1  # the sine of that at which two walls of a corner meet
DEAREST_TURN = 2.5  # commands: with what a tight one costs besides, still below geometry.kernels.bucket_queue.RING
__all__ = ["At", "Between", "CarryingPlan", "InCorner", "Inside", "Leg", "Pose", "plan_carrying"]


@dataclass(frozen=True)
class CarryingPlan:
    """What plan_carrying found.

    Attributes
    ----------
    status : "found"; "impossible": proved, the body cannot be moved there even by itself; "limit": not found, and not
        proved either.
    legs : what Utak does, in order; () unless found, or when the goal is met already.
    pose : how the body ends: turned about its centroid by degrees, then moved by (x, y), as in At.
    polygon : the body as it ends. Both None unless found.
    reason : when not found, what was in the way: "body" (the body by itself cannot pass), "hold" (it could, but Utak
        with it was not found to), "start" (it overlaps a wall where it lies), "goal" (no such end); else "".
    body : the plan of the body by itself, when that was asked; None else.
    held : whether Utak had hold of the body when the plan was asked for. Unless the first leg goes on with that hold
        (Leg.taken) he lets go first.
    """

    status: str
    legs: tuple[Leg, ...] = ()
    pose: Pose | None = None
    polygon: Any = None
    reason: str = ""
    body: MotionPlan | None = field(default=None, repr=False, compare=False)
    held: bool = False

    @property
    def goes_on(self) -> bool:
        """Does it begin with the hold that Utak has?"""
        return len(self.legs) > 0 and self.legs[0].taken

    @property
    def commands(self) -> int:
        """About how many commands this takes: walks, grasps, pushes, turns, releases."""
        lets_go_first = self.held and len(self.legs) > 0 and not self.goes_on
        return commands(self.legs) + int(lets_go_first)

    @property
    def length(self) -> float:
        """How far the body's centroid is pushed, in squares, turns left out; nan unless found."""
        if self.status != "found":
            return math.nan
        pushes = [m for leg in self.legs for m in leg.motions if isinstance(m, Translate)]
        return math.fsum(math.hypot(push.dx, push.dy) for push in pushes)

    def shifted(self, dx: float, dy: float) -> "CarryingPlan":
        """The same plan so much further east and north; for one that was found."""
        polygon = None if self.polygon is None else Translate(dx, dy).carry(self.polygon)
        return replace(self, legs=tuple(shifted(leg, dx, dy) for leg in self.legs), polygon=polygon)

    @cached_property
    def passage(self) -> Bottleneck | None:
        """The neck that is too narrow for the body; None unless impossible for want of one. Worked out when asked."""
        return None if self.body is None else self.body.passage

    @cached_property
    def opens(self) -> bool:
        """Would widening it alone help? Worked out when asked."""
        return self.body is not None and self.body.opens

    @cached_property
    def missing(self) -> float:
        """By how much it is too narrow, in squares: see MotionPlan.missing. nan unless there is a passage."""
        return math.nan if self.body is None else self.body.missing


def plan_carrying(
    shape: Any,
    free: Bools,
    utak: XY,
    goal: End,
    margin: float = 0.0,
    pull: bool = True,
    avoid: Sequence[XY] = (),
    walk: Bools | None = None,
    walls: Any = None,
    held: bool = False,
    turn: float = 1.0,
) -> CarryingPlan:
    """MotionPlan how Utak carries a body to a goal.

    Parameters
    ----------
    shape : shapely Polygon where it lies, in squares, table frame.
    free : (rows, columns) bool, row 0 in the south: squares that nothing but the body may cover. All else, and all
        outside the array, is wall for the body and for Utak.
    utak : (x, y) where he stands.
    goal : At(pose), Inside(polygons), InCorner(x, y, sx, sy) or Between(x, y, walls).
    margin : squares of clearance that pushes and turns of the body should keep from walls; kept where that is possible
        without going far out of the way.
    pull : False: every push must have a component from Utak towards the body's centroid.
    avoid : holds not to be used, as told by Leg.hold.
    walk : (rows, columns) bool: where Utak may walk with empty hands, from square to square by their edges; None for
        `free`. The squares under the body are closed wherever it then lies; where it lay they open when it has gone.
    walls : shapely geometry, the walls where they are known better than by squares; `free` are then the squares that
        they leave whole. None for all that is not free.
    held : whether Utak, where he stands, has hold of the body. The plan then goes on with that hold where that is no
        dearer than to let go, walk and grasp, and says so by `taken` of its first leg, which begins just there. A hold
        named in `avoid` is let go.
    turn : how many commands a turn counts for, 1 to DEAREST_TURN: more where turns had better be avoided. Only plans by
        whole squares go by it.

    Returns
    -------
    CarryingPlan : every motion free by exact first contact for body and Utak as one, with its numbers as they are told.

    Raises
    ------
    ValueError : when the body has no area, or shapes of arrays or numbers do not make sense.
    """
    free = np.ascontiguousarray(free, dtype=bool)
    _check(free, utak, margin, avoid, walk, turn)
    shape, walls = _body(shape), sound(walls, "walls")
    _check_goal(goal)
    x0, y0, x1, y1 = shape.bounds
    if x0 <= -1.0 or y0 <= -1.0 or x1 >= free.shape[1] + 1.0 or y1 >= free.shape[0] + 1.0:
        return CarryingPlan("impossible", reason="start", held=held)
    margin = min(margin, float(max(free.shape)))
    walk = free if walk is None else np.ascontiguousarray(walk, dtype=bool)
    errand = ManipulationQuery(shape, Workspace(free, walls), utak, goal, margin, pull, tuple(avoid), walk, turn=turn)
    errand = replace(errand, held=held and not errand.avoids(*errand.hold_from(utak)))
    if met(goal, shape, shape):
        return CarryingPlan("found", pose=Pose(0.0, 0.0), polygon=shape, held=held)
    return replace(_planned(errand), held=held)


def _planned(errand: ManipulationQuery) -> CarryingPlan:
    """The word of the first planner that finds something, or why none does."""
    plan = _told(errand, pressed(errand, carry_squarewise(errand)))
    if plan is None and isinstance(errand.goal, InCorner) and errand.goal.press:
        errand = replace(errand, goal=replace(errand.goal, press=0.0))
        plan = _told(errand, carry_squarewise(errand))
    plan = plan or _told(errand, carry_straightened(errand))
    if plan is not None:
        return plan
    body = move_alone(errand)
    if body.status == "impossible":
        return CarryingPlan("impossible", reason=body.reason or "body", body=body)
    if body.status == "found":
        plan = _told(errand, carry_held(errand, body.track)) or _told(errand, carry_freed(errand))
    else:  # where it lies too tightly to be told what it can do, it had better be brought out first
        plan = _told(errand, carry_freed(errand)) or _told(errand, carry_held(errand, body.track))
    return plan or CarryingPlan("limit", reason="hold" if body.status == "found" else "body", body=body)


def _check(free: Bools, utak: XY, margin: float, avoid: Sequence[XY], walk: Bools | None, turn: float) -> None:
    """Raise for what makes no sense."""
    if free.ndim != 2 or free.size == 0 or (walk is not None and walk.shape != free.shape):
        raise ValueError("free and walk must be arrays of the same rows and columns, of which there must be some")
    check([*utak, *(v for hold in avoid for v in hold)], "utak and avoid")
    if not math.isfinite(margin) or margin < 0.0:
        raise ValueError("the margin must be finite and not negative")
    if not 1.0 <= turn <= DEAREST_TURN:
        raise ValueError(f"a turn counts for 1 to {DEAREST_TURN} commands, not {turn}")


def _body(shape: Any) -> Any:
    """The body, when it makes sense."""
    body = sound(shape, "the body")
    if body is None or body.geom_type != "Polygon" or not len(boundary_edges(body)):
        raise ValueError("the body must be a polygon with an area")
    return body


def _check_goal(goal: End) -> None:
    """Raise for a goal that makes no sense."""
    if isinstance(goal, At):
        check(goal.pose, "the goal")
    elif isinstance(goal, InCorner):
        check([goal.x, goal.y, goal.slack, goal.press], "the goal")
        if abs(goal.sx) != 1 or abs(goal.sy) != 1 or min(goal.slack, goal.press) < 0.0:
            raise ValueError("a corner's sx and sy must be 1 or -1, its slack and press not negative")
        if not goal.within[0] <= goal.within[1]:
            raise ValueError("the lesser and the greater way within a corner must be told in this order")
    elif isinstance(goal, Between):
        check([goal.x, goal.y, goal.slack, *goal.walls[0], *goal.walls[1]], "the goal")
        if goal.slack < 0.0 or abs(float(np.linalg.det(np.array(goal.walls)))) < LEAST_ANGLE:
            raise ValueError("two walls must meet at an angle, and the slack must not be negative")
    elif not isinstance(goal, Inside | Roomy):
        raise ValueError(f"the goal must be At, Inside, InCorner or Between, not {goal!r}")


def _told(errand: ManipulationQuery, legs: Sequence[Leg] | None) -> CarryingPlan | None:
    """The plan of some legs, when they are free and lead to the goal; else None."""
    shape = errand.shape
    end = None if legs is None else verified(errand.yard, shape, legs)
    if legs is None or end is None or not met(errand.goal, shape, end):
        return None
    degrees = math.fsum(m.degrees for leg in legs for m in leg.motions if isinstance(m, Rotate))
    dx, dy = end.centroid.x - shape.centroid.x, end.centroid.y - shape.centroid.y
    return CarryingPlan("found", tuple(legs), Pose(dx, dy, degrees), end)
