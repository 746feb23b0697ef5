"""Carrying plans: how the robot brings a body to a goal, releasing and grasping it again where it must.

    plan = plan_carrying(brick, free, (3.5, 3.5), Inside(room))
    for leg in plan.legs:
        ...  # walk to leg.place, grasp, push and turn, release

# Strategy: first by whole squares and quarter turns (geometry.manipulation.lattice_planner): all stays on the lattice,
and the robot's estimate of places stays certain. Only where that finds nothing, the body alone is planned (a proof when
it cannot pass), and then any place and angle.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from typing import Any

import numpy as np

from utak.geometry.cspace.bottleneck import Bottleneck
from utak.geometry.cspace.plan_motion import MotionPlan
from utak.geometry.kernels.arrays import XY, Bools
from utak.geometry.manipulation.align import plan_aligned
from utak.geometry.manipulation.free_body import plan_body_alone
from utak.geometry.manipulation.goals import At, Between, End, InCorner, Inside, Roomy, is_goal_met
from utak.geometry.manipulation.lattice_planner import plan_on_lattice
from utak.geometry.manipulation.legs import Leg, commands, shifted, verified
from utak.geometry.manipulation.press import press_into_corner
from utak.geometry.manipulation.query import ManipulationQuery
from utak.geometry.manipulation.single_grasp import plan_by_freeing, plan_with_one_grasp
from utak.geometry.manipulation.workspace import workspace_of
from utak.geometry.motion.first_contact import boundary_edges
from utak.geometry.motion.se2 import Pose, Rotate, Translate
from utak.geometry.motion.validation import require_bounded, valid_polygons

MIN_WALLS_SINE = 0.1  # sine of the angle between the two walls of a corner, at least; convention
# Commands; derived: with the extra cost of a tight turn it stays below geometry.kernels.bucket_queue.BUCKETS.
MAX_TURN_COST = 2.5
__all__ = ["At", "Between", "CarryingPlan", "InCorner", "Inside", "Leg", "Pose", "plan_carrying"]


@dataclass(frozen=True)
class CarryingPlan:
    """The result of plan_carrying.

    Attributes
    ----------
    status : "found"; "impossible": proved, the body cannot be moved there even by itself; "limit": not found, and not
        proved either.
    legs : what the robot does, in order; () unless found, or when the goal holds already.
    pose : the end of the body relative to how it lies: turned about its centroid by degrees, then moved by (x, y)
        squares, as in At; None unless found.
    polygon : shapely Polygon, table frame, the body as it ends; None unless found.
    reason : when not found, what was in the way: "body" (the body by itself cannot pass, or was not found to), "hold"
        (it could, but the robot with it was not found to), "start" (it overlaps a wall where it lies), "goal" (no such
        end); else "".
    body : the motion plan of the body by itself, when that was planned; else None.
    held : whether the robot held the body when the plan was asked for. Unless the first leg goes on with that grasp
        (`Leg.taken`) it releases first.
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
        """Return whether the plan begins with the grasp that the robot has; False without legs."""
        return len(self.legs) > 0 and self.legs[0].taken

    @property
    def commands(self) -> int:
        """Return about how many commands the plan takes: walks, grasps, pushes, turns, releases; 0 without legs."""
        lets_go_first = self.held and len(self.legs) > 0 and not self.goes_on
        return commands(self.legs) + int(lets_go_first)

    @property
    def length(self) -> float:
        """Return how far the body's centroid is pushed, in squares, turns left out; nan unless found."""
        if self.status != "found":
            return math.nan
        pushes = [m for leg in self.legs for m in leg.motions if isinstance(m, Translate)]
        return math.fsum(math.hypot(push.dx, push.dy) for push in pushes)

    def shifted(self, dx: float, dy: float) -> "CarryingPlan":
        """Return the same plan translated by (dx, dy) squares, table frame: its legs and its polygon. `body` stays."""
        polygon = None if self.polygon is None else Translate(dx, dy).carry(self.polygon)
        return replace(self, legs=tuple(shifted(leg, dx, dy) for leg in self.legs), polygon=polygon)

    @cached_property
    def passage(self) -> Bottleneck | None:
        """Return the bottleneck that is too narrow for the body; None unless the plan is impossible because of one.

        It holds its middle (x, y), the two points (x, y) of walls that make it, and their distance, in squares, table
        frame. Computed on first access.
        """
        return None if self.body is None else self.body.passage

    @cached_property
    def opens(self) -> bool:
        """Return whether widening the passage alone surely lets the body through by itself.

        False without one. Computed on first access.
        """
        return self.body is not None and self.body.opens

    @cached_property
    def missing(self) -> float:
        """Return the width that the passage lacks, in squares; inf if widening it would not be enough.

        nan without a passage, or if that is undecided. Computed on first access.
        """
        return math.nan if self.body is None else self.body.missing

    @property
    def missing_between(self) -> tuple[float, float, float]:
        """Return the width that the passage lacks: more than the first number, about the second, at most the third.

        In squares. All nan without a passage, all inf if widening it would not be enough, (0, nan, inf) where that is
        undecided.
        """
        return (math.nan,) * 3 if self.body is None else self.body.missing_between


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
    on_lattice: bool = False,
) -> CarryingPlan:
    """Return a plan by which the robot carries a body to a goal.

    Parameters
    ----------
    shape : shapely Polygon where it lies, in squares, table frame.
    free : (rows, columns) bool, row 0 in the south: squares that nothing but the body may cover. All else, and all
        outside the array, is wall for the body and for the robot.
    utak : (x, y) of the robot, in squares, table frame.
    goal : At(pose), Inside(polygons), InCorner(x, y, sx, sy) or Between(x, y, walls).
    margin : squares of clearance that pushes and turns of the body should keep from walls; kept where that needs no
        long detour.
    pull : False: every push must have a component from the robot towards the body's centroid.
    avoid : offsets (x, y) of grasps that must not be used, as in `Leg.hold`: the robot's place relative to the body's
        centroid, squares.
    walk : (rows, columns) bool, where the robot may walk with empty hands, from square to square by their edges; None
        for `free`. The squares under the body are closed wherever it then lies; where it lay they open when it has
        gone.
    walls : shapely geometry, squares, table frame, the walls where they are known better than by squares; `free` are
        then the squares that they leave whole. None for all that is not free.
    held : whether the robot, where it stands, holds the body. The plan then goes on with that grasp where that costs no
        more than to release, walk and grasp; `taken` of its first leg says so, which begins at the robot's place. A
        grasp in `avoid` is released.
    turn : how many commands a turn counts for, 1 to MAX_TURN_COST: more where turns should be avoided. Only plans by
        whole squares depend on it.
    on_lattice : whether to look only for plans by whole squares and quarter turns. That is much faster where there is
        none; then nothing is proved, and the status is "limit".

    Returns
    -------
    CarryingPlan : its status is "found", "impossible" (proved for the body alone) or "limit". When found it holds the
        legs in order (walk to a place, grasp, push and turn, release), the end pose of the body relative to how it
        lies, and the polygon of the body there, squares, table frame; otherwise the reason. Every motion is free by
        exact first contact for body and robot as one, with its numbers as they are commanded. When the goal holds
        already it is "found" without legs.

    Raises
    ------
    ValueError : the body has no area, or shapes of arrays or numbers do not make sense.
    """
    free = np.ascontiguousarray(free, dtype=bool)
    _check(free, utak, margin, avoid, walk, turn)
    shape, walls = _body(shape), valid_polygons(walls, "walls")
    _check_goal(goal)
    x0, y0, x1, y1 = shape.bounds
    if x0 <= -1.0 or y0 <= -1.0 or x1 >= free.shape[1] + 1.0 or y1 >= free.shape[0] + 1.0:
        return CarryingPlan("impossible", reason="start", held=held)
    margin = min(margin, float(max(free.shape)))
    walk = free if walk is None else np.ascontiguousarray(walk, dtype=bool)
    query = ManipulationQuery(shape, workspace_of(free, walls), utak, goal, margin, pull, tuple(avoid), walk, turn=turn)
    query = replace(query, held=held and not query.is_avoided(*query.grasp_offset(utak)))
    if is_goal_met(goal, shape, shape):
        return CarryingPlan("found", pose=Pose(0.0, 0.0), polygon=shape, held=held)
    return replace(first_plan(query, on_lattice), held=held)


def first_plan(query: ManipulationQuery, on_lattice: bool = False) -> CarryingPlan:
    """Return the plan of the first planner that finds one, or a plan without legs that says why none does."""
    plan = query.workspace.once(("on lattice", *query.key), partial(_pressed_plan_on_lattice, query))
    if plan is None and isinstance(query.goal, InCorner) and query.goal.press:
        query = replace(query, goal=replace(query.goal, press=0.0))
        plan = _plan_of(query, plan_on_lattice(query))
    if plan is None and not on_lattice:
        plan = _plan_of(query, plan_aligned(query))
    if plan is not None or on_lattice:
        return plan or CarryingPlan("limit", reason="hold")
    body = plan_body_alone(query)
    if body.status == "impossible":
        return CarryingPlan("impossible", reason=body.reason or "body", body=body)
    if body.status == "found":  # else the body and the robot as one thing, which is larger, would not be found to pass
        plan = _plan_of(query, plan_with_one_grasp(query, body.track))
    plan = plan or _plan_of(query, plan_by_freeing(query))
    return plan or CarryingPlan("limit", reason="hold" if body.status == "found" else "body", body=body)


def _pressed_plan_on_lattice(query: ManipulationQuery) -> CarryingPlan | None:
    """Return the plan by whole squares and quarter turns, pressed into a corner where that is wished; None for none."""
    return _plan_of(query, press_into_corner(query, plan_on_lattice(query)))


def _check(free: Bools, utak: XY, margin: float, avoid: Sequence[XY], walk: Bools | None, turn: float) -> None:
    """Raise ValueError for arguments of plan_carrying that make no sense; return None otherwise."""
    if free.ndim != 2 or free.size == 0 or (walk is not None and walk.shape != free.shape):
        raise ValueError("free and walk must be arrays of the same rows and columns, of which there must be some")
    require_bounded([*utak, *(v for hold in avoid for v in hold)], "utak and avoid")
    if not math.isfinite(margin) or margin < 0.0:
        raise ValueError("the margin must be finite and not negative")
    if not 1.0 <= turn <= MAX_TURN_COST:
        raise ValueError(f"a turn counts for 1 to {MAX_TURN_COST} commands, not {turn}")


def _body(shape: Any) -> Any:
    """Return the body `shape` as a valid shapely Polygon with an area, squares, table frame, or raise ValueError."""
    body = valid_polygons(shape, "the body")
    if body is None or body.geom_type != "Polygon" or not len(boundary_edges(body)):
        raise ValueError("the body must be a polygon with an area")
    return body


def _check_goal(goal: End) -> None:
    """Raise ValueError for a goal that makes no sense; return None otherwise."""
    if isinstance(goal, At):
        require_bounded(goal.pose, "the goal")
    elif isinstance(goal, InCorner):
        require_bounded([goal.x, goal.y, goal.slack, goal.press], "the goal")
        if abs(goal.sx) != 1 or abs(goal.sy) != 1 or min(goal.slack, goal.press) < 0.0:
            raise ValueError("a corner's sx and sy must be 1 or -1, its slack and press not negative")
        if not goal.within[0] <= goal.within[1]:
            raise ValueError("within must be the lesser and the greater distance in this order")
    elif isinstance(goal, Between):
        require_bounded([goal.x, goal.y, goal.slack, *goal.walls[0], *goal.walls[1]], "the goal")
        if goal.slack < 0.0 or abs(float(np.linalg.det(np.array(goal.walls)))) < MIN_WALLS_SINE:
            raise ValueError("two walls must meet at an angle, and the slack must not be negative")
    elif not isinstance(goal, Inside | Roomy):
        raise ValueError(f"the goal must be At, Inside, InCorner or Between, not {goal!r}")


def _plan_of(query: ManipulationQuery, legs: Sequence[Leg] | None) -> CarryingPlan | None:
    """Return the plan of some legs, status "found", when they are free and lead to the goal; else None."""
    shape = query.shape
    end = None if legs is None else verified(query.workspace, shape, legs)
    if legs is None or end is None or not is_goal_met(query.goal, shape, end):
        return None
    degrees = math.fsum(m.degrees for leg in legs for m in leg.motions if isinstance(m, Rotate))
    dx, dy = end.centroid.x - shape.centroid.x, end.centroid.y - shape.centroid.y
    return CarryingPlan("found", tuple(legs), Pose(dx, dy, degrees), end)
