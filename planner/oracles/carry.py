"""The oracle of carrying: whether an object can be brought to a place in a state that a plan leads to.

It certifies: `sure`, a way by exact first contact over squares that are surely free; `hoped`, the same over squares
that are not known to be occupied; `refuted`, that none was found over any square that is not known to be occupied.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Any, NamedTuple

import numpy as np

from utak.geometry.kernels.arrays import XY, Bools
from utak.geometry.manipulation.goals import End, goal_key, moved
from utak.geometry.manipulation.plan_carrying import CarryingPlan, plan_carrying
from utak.geometry.motion.se2 import Pose, Rotate, Translate
from utak.geometry.raster.components import components
from utak.geometry.raster.geodesic import GEODESIC_UNREACHED, reach
from utak.geometry.raster.rasterize import squares
from utak.kb.language.goal_words import ROBOT
from utak.kb.world.model import Node
from utak.planner.carrying.infeasibility import how_narrow
from utak.planner.carrying.manipulation_oracle import swept_squares
from utak.planner.goals.optimistic import UNSEEN_MARGIN, optimistic_floor
from utak.planner.oracles.problem import Lying, TableState, TaskProblem
from utak.planner.screen.projection import UNSEEN_LEVEL, dilate
from utak.planner.situation import Situation, neck_squares

MAX_MARGIN_SQUARES = 48  # squares that the floor is extended beyond the view for ends that lie there; a bound on time


REFUSALS = {  # CarryingPlan.reason in words
    "body": "no way was found for it, even by itself",
    "hold": "no way was found for it with the robot that holds it",
    "start": "it would overlap a wall where it lies",
    "goal": "there is no such end on the floor",
}


class Certainty(StrEnum):
    """The kinds of answers of the oracle: a sure way, a way over floor that is hoped to be free, or none."""

    SURE = "sure"
    HOPED = "hoped"
    REFUTED = "refuted"


class FloorKind(StrEnum):
    """The floors on which a way is looked for, the surest first."""

    SURE = "sure"  # squares that are surely free
    LIKELY = "likely"  # those, and the ones that optimistic planning assumes to be free
    POSSIBLE = "possible"  # all squares that are not known to be occupied

    @property
    def certainty(self) -> Certainty:
        """The certainty of a way over this floor."""
        return Certainty.SURE if self == FloorKind.SURE else Certainty.HOPED


class OracleAnswer(NamedTuple):
    """An answer of the oracle."""

    certainty: Certainty  # how sure the way is
    commands: int = 0  # about how many commands it takes; 0 when it is refuted
    after: TableState | None = None  # the state that it leads to; None when it is refuted
    # The way of an object, in squares, view frame moved by the margin of the floors; None for the robot alone, and when
    # it is refuted
    plan: CarryingPlan | None = None
    # Grasps of the object as it lay before, as (x, y) of the robot from its middle, that the plan does not use: with
    # them the object would shut the robot in at its place
    avoid: tuple[XY, ...] = ()


class _Carrying(NamedTuple):
    """A plan of geometry, and the grasps that it must not use: with them the object would shut the robot in."""

    plan: CarryingPlan
    avoid: tuple[XY, ...] = ()


@dataclass(frozen=True)
class Floors:
    """The squares that may be used, without any thing of the problem, by the kind of floor; all with a margin."""

    by_kind: Mapping[FloorKind, Bools]  # (rows, columns) bool each
    margin: int  # squares that were added on each side of the arrays of the view


def floors_of(problem: TaskProblem, situation: Situation) -> Floors:
    """Return the squares that may be used as if no thing of a problem were there, with a margin for unseen floor."""
    model = situation.model
    covered = np.zeros(model.labels.shape, np.bool_)
    for node in problem.nodes.values():
        covered |= model.mask(node.patch)
    margin = max(UNSEEN_MARGIN, _margin_needed(problem, covered.shape))
    sure = np.pad(situation.cost_maps.free(0) | covered, margin)
    likely = np.pad(optimistic_floor(situation), margin - UNSEEN_MARGIN) | np.pad(covered, margin) | sure
    possible = np.pad(situation.cost_maps.free(UNSEEN_LEVEL) | covered, margin, constant_values=True) | likely
    return Floors({FloorKind.SURE: sure, FloorKind.LIKELY: likely, FloorKind.POSSIBLE: possible}, margin)


def _margin_needed(problem: TaskProblem, shape: tuple[int, ...]) -> int:
    """Return how many squares beyond the view the ends of a problem lie, at most MAX_MARGIN_SQUARES."""
    rows, columns = shape
    beyond = 0.0
    for (name, _), end in problem.places.items():
        outline = problem.state.things[name].outline
        pose = getattr(end, "pose", None)
        if pose is not None:
            west, south, east, north = outline.bounds
            reach_ = max(east - west, north - south)
            x, y = outline.centroid.x + pose.x, outline.centroid.y + pose.y
            beyond = max(beyond, reach_ - x, reach_ - y, x + reach_ - columns, y + reach_ - rows)
    return min(MAX_MARGIN_SQUARES, max(0, int(np.ceil(beyond)) + 1))


class CarryOracle:
    """Answers whether objects can be brought to places; remembers its answers for one situation."""

    def __init__(
        self,
        problem: TaskProblem,
        situation: Situation,
        pull: bool = True,
        avoid: Mapping[str, Sequence[XY]] | None = None,
        turn: float = 1.0,
        on_lattice: bool = False,
    ) -> None:
        """Make an oracle for a situation."""
        self.asked = 0
        self.floors = floors_of(problem, situation)
        self._problem, self._situation = problem, situation
        self._pull, self._avoid, self._turn, self._on_lattice = pull, avoid or {}, turn, on_lattice
        self._answers: dict[Any, OracleAnswer] = {}
        self._plans: dict[Any, CarryingPlan] = {}

    def is_refuted_from_anywhere(self, state: TableState, name: str, end: End, shut: frozenset[str]) -> bool:
        """Return whether an object cannot be brought to an end in a state wherever the robot stands; see `bring`."""
        return self._plan(state, name, end, FloorKind.POSSIBLE, shut, anywhere=True).status != "found"

    def refusal(self, state: TableState, name: str, end: End, shut: frozenset[str]) -> str:
        """Return in words what geometry found where an object cannot be brought to an end in a state; see `bring`."""
        refused = self._plan(state, name, end, FloorKind.POSSIBLE, shut)
        by = "by whole squares and quarter turns, " if self._on_lattice else ""
        if refused.status == "found" or refused.passage is None:
            return by + REFUSALS.get(refused.reason, "the robot would shut itself in with it")
        (x, y), margin = refused.passage.place, self.floors.margin
        where = self._situation.model.point_in_words((x - margin, y - margin))
        wide = f"{by}the passage at {where}, {refused.passage.width:.2f} squares wide,"
        return f"{wide} {how_narrow(refused)}"

    def is_refuted(self, state: TableState, name: str, end: End, shut: frozenset[str]) -> bool:
        """Return whether no way over any floor brings an object to an end in a state; this asks less than `bring`."""
        return self._plan(state, name, end, FloorKind.POSSIBLE, shut).status != "found"

    def bring(
        self, state: TableState, name: str, end: End, place: str, shut: frozenset[str] = frozenset()
    ) -> OracleAnswer:
        """Return whether an object can be brought to an end in a state, and the state that this leads to."""
        key = (_key(state), name, place, shut)
        if key not in self._answers:
            self._answers[key] = self._bring(state, name, end, place, shut)
        return self._answers[key]

    def arrive(self, state: TableState, stand: Any, shut: frozenset[str] = frozenset()) -> OracleAnswer:
        """Return whether the robot can walk to some squares in a state, and the state that this leads to."""
        columns = self._situation.model.labels.shape[1]
        rows_of, columns_of = np.divmod(stand, columns)
        for kind in FloorKind:
            free = self._free(state, None, kind, shut)
            x, y = (int(v) + self.floors.margin for v in state.robot)
            far = reach(free, x, y)[rows_of + self.floors.margin, columns_of + self.floors.margin]
            if (far != GEODESIC_UNREACHED).any():
                best = int(np.flatnonzero(far == far[far != GEODESIC_UNREACHED].min())[0])
                robot = float(columns_of[best]) + 0.5, float(rows_of[best]) + 0.5
                return OracleAnswer(kind.certainty, 1, replace(state, robot=robot, held=None))
        return OracleAnswer(Certainty.REFUTED)

    def _bring(self, state: TableState, name: str, end: End, place: str, shut: frozenset[str]) -> OracleAnswer:
        """Return the answer of geometry; the surest way counts."""
        sure = self._free_handed(state, name, end, FloorKind.SURE, shut)
        if sure.plan.status == "found":
            return self._found(state, name, place, Certainty.SURE, sure)
        possible = self._free_handed(state, name, end, FloorKind.POSSIBLE, shut)  # where this fails, all floors do
        if possible.plan.status != "found":
            return OracleAnswer(Certainty.REFUTED)
        likely = self._free_handed(state, name, end, FloorKind.LIKELY, shut)
        return self._found(state, name, place, Certainty.HOPED, likely if likely.plan.status == "found" else possible)

    def _found(self, state: TableState, name: str, place: str, certainty: Certainty, found: _Carrying) -> OracleAnswer:
        """Return the answer for a plan that was found."""
        after = self._after(state, name, found.plan, place)
        return OracleAnswer(certainty, found.plan.commands, after, plan=found.plan, avoid=found.avoid)

    def _free_handed(self, state: TableState, name: str, end: End, kind: FloorKind, shut: frozenset[str]) -> _Carrying:
        """Return a plan after which the object does not shut the robot in; any plan where there is no such plan."""
        plan = self._plan(state, name, end, kind, shut)
        if not plan.legs:
            return _Carrying(plan)
        after = self._after(state, name, plan, "")
        inner = self._inner_grasps(after, name, plan, state, kind, shut)
        if not inner:
            return _Carrying(plan)
        other = self._plan(state, name, end, kind, shut, inner)
        return _Carrying(other, inner) if other.legs else _Carrying(plan)

    def _inner_grasps(
        self,
        after: TableState,
        name: str,
        plan: CarryingPlan,
        before: TableState,
        kind: FloorKind,
        shut: frozenset[str],
    ) -> tuple[XY, ...]:
        """Return the grasps of an object that end off most of the floor, once it lies."""
        margin = self.floors.margin
        square = int(after.robot[1]) + margin, int(after.robot[0]) + margin  # row, column
        sure = self._free(after, None, FloorKind.SURE, shut)
        outside = _largest_part(sure)  # most of the floor that can surely be walked on
        if outside[square]:
            return ()
        walk = sure
        if kind != FloorKind.SURE:
            walk = self._free(after, None, kind, shut)
            outline = Translate(margin, margin).carry(before.things[name].outline)
            outside = _largest_part(sure | (walk & swept_squares(plan, outline, walk.shape)))
            if outside[square]:
                return ()
        under = self._covered(name, after.things[name], (walk.shape[0], walk.shape[1]))
        rows, columns = np.nonzero(dilate(under, 1) & walk & ~outside)
        middle = after.things[name].outline.centroid
        assert plan.pose is not None
        offsets = np.column_stack([columns + 0.5 - margin - middle.x, rows + 0.5 - margin - middle.y])
        return tuple((float(dx), float(dy)) for dx, dy in Rotate(-plan.pose.degrees, (0.0, 0.0)).points(offsets))

    def _plan(
        self,
        state: TableState,
        name: str,
        end: End,
        kind: FloorKind,
        shut: frozenset[str],
        inner: tuple[XY, ...] = (),
        anywhere: bool = False,
    ) -> CarryingPlan:
        """Return what geometry finds over a kind of floor without some grasps, in the frame with the margin."""
        lying, margin = state.things[name], self.floors.margin
        outline = Translate(margin, margin).carry(lying.outline)
        free = self._free(state, name, kind, shut)
        free |= squares(outline, free.shape[1], free.shape[0])
        goal, held = moved(lying.reach(end), margin, margin), state.held == name
        walk = np.ones_like(free) if anywhere else self._free(state, name, kind, shut, alone=True)
        key = (outline.wkb, free.tobytes(), walk.tobytes(), goal_key(goal), state.robot, held, inner)
        if key not in self._plans:
            self.asked += 1
            utak = state.robot[0] + margin, state.robot[1] + margin
            failed = np.array(self._avoid.get(name, ())).reshape(-1, 2)
            failed = Rotate(lying.pose.degrees, (0.0, 0.0)).points(failed)
            avoid = (*((float(dx), float(dy)) for dx, dy in failed), *inner)
            self._plans[key] = plan_carrying(
                outline,
                free,
                utak,
                goal,
                0.0,
                self._pull,
                avoid,
                walk,
                held=held,
                turn=self._turn,
                on_lattice=self._on_lattice,
            )
        return self._plans[key]

    def _after(self, state: TableState, name: str, plan: CarryingPlan, place: str) -> TableState:
        """Return the state after a plan, given in the frame with the margin."""
        lying, margin = state.things[name], self.floors.margin
        if not plan.legs:
            return replace(state, things={**state.things, name: replace(lying, place=place)})
        back = plan.shifted(-margin, -margin)
        assert back.pose is not None
        x, y, degrees = back.pose
        pose = Pose(lying.pose.x + x, lying.pose.y + y, lying.pose.degrees + degrees)
        leg = back.legs[-1]
        robot = leg.place
        for motion in leg.motions:
            if isinstance(motion, Translate):
                robot = robot[0] + motion.dx, robot[1] + motion.dy
        return state.after(name, Lying(back.polygon, pose, place), robot)

    def _free(
        self, state: TableState, name: str | None, kind: FloorKind, shut: frozenset[str], alone: bool = False
    ) -> Bools:
        """Return the squares that other things of a state, shut doors and forbidden regions leave free."""
        free = self.floors.by_kind[kind].copy()
        rows, columns = free.shape
        margin = self.floors.margin
        for other, lying in state.things.items():
            if other != name:
                free &= ~self._covered(other, lying, (rows, columns))
        actors = (ROBOT,) if alone or name is None else (ROBOT, name)
        names = shut | {door.name for actor in actors for door in self._situation.shut(actor)}
        doors = [door for door in self._situation.rooms.doors if door.name in names]
        free &= ~neck_squares(doors, self._situation.model.labels.shape, margin)
        for actor in actors:
            free &= ~self._situation.region_kept_off(actor, margin)
        x, y = (int(v) + margin for v in state.robot)
        if 0 <= x < columns and 0 <= y < rows:
            free[y, x] = True
        return free

    def _covered(self, name: str, lying: Lying, shape: tuple[int, int]) -> Bools:
        """Return the squares that an object covers as it lies; those that were seen while it was not moved."""
        margin, model = self.floors.margin, self._situation.model
        if lying.pose == (0.0, 0.0, 0.0):
            node: Node = self._problem.nodes[name]
            return np.pad(model.mask(node.patch), margin)
        return squares(Translate(margin, margin).carry(lying.outline), shape[1], shape[0])


def _largest_part(free: Bools) -> Bools:
    """Return the largest connected part of some free squares, (rows, columns) bool; all False without free squares."""
    labels = components(free).labels
    sizes = np.bincount(labels.ravel())
    sizes[0] = 0
    largest: Bools = free & (labels == sizes.argmax())
    return largest


def _key(state: TableState) -> Any:
    """Return what distinguishes a state: where everything lies, where the robot stands, what it holds."""
    lying = tuple(sorted((name, tuple(one.pose), one.place) for name, one in state.things.items()))
    return lying, state.robot, state.held
