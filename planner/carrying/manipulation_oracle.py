"""Manipulation oracle: geometry is asked how an object can be carried.

The cheapest option is asked first. What geometry proves impossible rules out every harder option. A plan that is found
may lead over squares that are not surely free: then these must be seen first.
"""

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from enum import StrEnum
from itertools import product
from typing import Any, NamedTuple

import numpy as np
import shapely

from utak.geometry.kernels.arrays import XY, Bools
from utak.geometry.manipulation.goals import End, goal_key, moved
from utak.geometry.manipulation.legs import shifted
from utak.geometry.manipulation.plan_carrying import At, Between, CarryingPlan, InCorner, Inside, Leg, plan_carrying
from utak.geometry.motion.se2 import Motion, Rotate, Translate
from utak.geometry.raster.rasterize import squares, squares_after
from utak.geometry.raster.runs import mask_to_polygon
from utak.kb.language.goal_words import ROBOT
from utak.kb.localisation.propose.larger_object import MAX_HIDDEN_DEPTH, SIDE_DIRECTIONS
from utak.kb.objects.held_object import is_grid_aligned
from utak.kb.perception.frame import ADJACENT_OFFSETS
from utak.kb.world.model import Node, WorldModel
from utak.planner.carrying.infeasibility import Infeasibility, certify
from utak.planner.goals.optimistic import OPTIMISTIC_LEVEL, UNSEEN_MARGIN, optimistic_floor
from utak.planner.goals.placement import (
    POSSIBLE_OBJECT,
    forbidden_squares,
    possible_extension,
    to_view_frame,
)
from utak.planner.screen.moves import is_at, orientation_is_uncertain
from utak.planner.screen.projection import UNSEEN_LEVEL, dilate
from utak.planner.situation import Situation
from utak.planner.steps import are_ruled, of_legs, refusal, release
from utak.planner.under_way import UNDER_WAY

EndsFunction = Callable[[], Mapping[str, End]]  # ends by their names; it is called only where they are needed
TRIED_LEVELS = (0, OPTIMISTIC_LEVEL, UNSEEN_LEVEL)  # certainty levels of squares, the surest first
MIN_PLAN_COMMANDS = 2  # commands of the shortest plan with an object in hand: one push and the release (derived)
MAX_ORACLE_ROUNDS = 12  # options that geometry is asked about for one request; a bound on time
MOTION_PARTS = (1, 2, 4)  # parts in which a motion is made where users' rules forbid it otherwise; a convention
SWEEP_STRIDE = 0.25  # squares between the sampled places of a motion; a convention, well below one square
CONTACTS_FOR_CLEARANCE = 2  # unexpected contacts of an object, from which on its plan must keep WALL_CLEARANCE; tuned
WALL_CLEARANCE = 0.15  # squares that such a plan keeps from walls; tuned on random worlds (benchmarks.campaign)
INEXACT_MARGIN = 0.3  # squares kept free about an object off the grid, and for each contact; tuned likewise
MAX_MARGIN = 0.6  # squares: the most that is kept free, so that doors stay passable; tuned likewise
TURN_ARM = 0.4  # squares that a point of an object moves for each degree that it is turned, about; a convention
DOUBT_COST = 10.0  # squares that each level of doubt costs: the robot looks before it relies on squares; tuned likewise
ASIDE_COST = 25.0  # squares that it costs to move others aside, about fifteen commands; tuned likewise
SWITCH_COST = 4.0  # squares that it costs to turn to another end than last time; tuned likewise
MAX_REMEMBERED = 512  # answers of geometry that are remembered; a bound on memory


class OtherObjects(StrEnum):
    """The treatment of other objects by a plan."""

    CLEAR = "clear"  # lead round all of them
    ASIDE = "aside"  # lead as if those that may be moved were not there; they are then moved aside first


class Option(NamedTuple):
    """A question that geometry may be asked: how an object is carried to one end over squares of one certainty."""

    end: str  # the name of the end
    level: int  # the certainty level of the squares that may be used, 0 the surest
    others: OtherObjects
    way: float  # a lower bound of the way, in squares, and what it costs to turn to another end

    def cost(self) -> float:
        """Return the way, with what doubtful squares and others in the way cost, in squares."""
        return self.way + DOUBT_COST * self.level + ASIDE_COST * (self.others == OtherObjects.ASIDE)

    def most_telling(self) -> tuple[int, float]:
        """Return the key by which the option comes first of which a refutation rules out most others."""
        return (self.others == OtherObjects.CLEAR) - self.level, self.cost()

    def is_harder_than(self, refuted: "Option") -> bool:
        """Return whether it allows no square, and moves nothing aside, that a refuted one did not."""
        clearer = self.others == refuted.others or refuted.others == OtherObjects.ASIDE
        return self.end == refuted.end and self.level <= refuted.level and clearer


@dataclass(frozen=True)
class ManipulationPlan:
    """A manipulation plan: a way to carry an object that geometry verified."""

    # What geometry found, in squares, view frame: legs, each a walk, a grasp, pushes and turns, a release
    plan: CarryingPlan
    target: str  # the name of the end that it leads to
    level: int  # the certainty level of the squares that it needs, 0 the surest
    # (rows, columns) bool on the arrays of the view, the squares that the object, or the robot holding it, crosses
    swept: Bools
    aside: tuple[str, ...] = ()  # the names of objects that must be moved out of the way first
    hopes: bool = False  # whether it is begun over squares that are only hoped to be free, without a look at them first

    @property
    def askew(self) -> bool:
        """Return whether some turn of the plan is no multiple of a quarter turn (90 degrees); False without turns."""
        turns = (m for leg in self.plan.legs for m in leg.motions if isinstance(m, Rotate))
        return any(turn.degrees % 90.0 != 0.0 for turn in turns)

    @property
    def is_simple(self) -> bool:
        """Return whether the plan takes one grasp, at most two pushes and no turn."""
        legs = self.plan.legs
        return len(legs) == 1 and len(legs[0].motions) <= 2 and all(isinstance(m, Translate) for m in legs[0].motions)


@dataclass(frozen=True)
class Request:
    """A question to the oracle: how an object can be carried to one of several ends."""

    node: Node  # the object; its outline is known
    ends: Mapping[str, End]  # where it shall lie, by name, in squares, view frame
    # Grasps that failed, as (x, y) of the robot from the middle of the object, in squares along the axes of the map
    avoid: tuple[XY, ...] = ()
    last_target: str = ""  # the name of the end that was chosen last time; "" for none
    # How often the object stood against something unexpectedly. Each time more room is wanted about it.
    contacts: int = 0
    held: bool = False  # whether the robot holds it and may go on with that grasp
    turn_cost: float = 1.0  # how many commands a turn counts for
    on_lattice: bool = False  # whether only ways by whole squares and quarter turns are looked for


class CarryingFloor(NamedTuple):
    """The places of an object and the robot, and the squares that they may use, all in one frame."""

    shape: Any  # the outline of the object, shapely Polygon, in squares
    utak: XY  # the place (x, y) of the robot, in squares
    free: Bools  # (rows, columns) bool, squares for the object and the robot holding it
    walk: Bools  # (rows, columns) bool, squares for the robot alone


class ManipulationOracle:
    """Finds manipulation plans, and remembers what geometry answered to the same question."""

    def __init__(self, pull: bool = True) -> None:
        """Make an oracle that has been asked nothing."""
        self._pull = pull
        self._answers: dict[tuple[Any, ...], CarryingPlan] = {}
        self._found_nothing = False  # whether the last request had no plan

    def __deepcopy__(self, _memo: dict[int, Any]) -> "ManipulationOracle":
        """Return a copy that remembers the same answers: these are frozen, so that they need not be copied."""
        copied = ManipulationOracle(self._pull)
        copied._answers, copied._found_nothing = dict(self._answers), self._found_nothing
        return copied

    def find(
        self, request: Request, situation: Situation, hoped: EndsFunction = dict
    ) -> ManipulationPlan | Infeasibility:
        """Return the plan that is chosen and verified, or why there is none."""
        shape, utak = to_view_frame(request.node.polygon, situation), situation.model.place_on_view
        floors = {option: usable_squares(request.node, situation, *option) for option in _floor_options(situation)}
        left = [
            Option(name, level, others, round(_least_way(end, shape), 1) + SWITCH_COST * _is_switch(name, request))
            for name, end in sorted(request.ends.items())
            for level, others in floors
        ]
        forbidden: list[str] = []  # what users' rules say of plans that were found
        refuted: list[tuple[int, CarryingPlan]] = []  # each with the level that it was asked for
        for number in range(1, MAX_ORACLE_ROUNDS + 1):
            UNDER_WAY.words = f"carrying {request.node.name}, way {number} of at most {MAX_ORACLE_ROUNDS}"
            if not left:
                break
            asked = min(left, key=Option.most_telling if self._found_nothing else Option.cost)
            name, level, others, _ = asked
            floor = CarryingFloor(shape, utak, floors[level, others], situation.cost_maps.free(level))
            plan = self._ask_geometry(request, request.ends[name], floor, situation.model)
            if plan.status == "found" and self._found_nothing:
                self._found_nothing = False  # the order for a hopeless request ends: now the best way is asked for
                continue
            if plan.status == "found":
                found = _manipulation_plan(plan, shape, name, level, situation, request.node)
                bolder = self._bolder(request, found, situation, hoped)
                why = ""
                for parts in MOTION_PARTS:
                    in_parts = _moved_in_parts(bolder, parts)
                    why = _refusal(in_parts, situation, request.node)
                    if not why:
                        return in_parts
                forbidden.append(why)  # it may be grasped otherwise
                request = replace(request, avoid=(*request.avoid, *(leg.hold for leg in bolder.plan.legs)), held=False)
                continue
            refuted.append((level, plan))
            proved = plan.status == "impossible"
            left = [one for one in left if one != asked and not (proved and one.is_harder_than(asked))]
        if forbidden:
            return Infeasibility(False, f"{request.node.name} may not be carried there: {forbidden[-1]}")
        self._found_nothing = True
        answer = certify(request.node, refuted, situation.model)
        return replace(answer, proved=False) if _may_use_other_ways(request.node, situation) else answer

    def through(self, request: Request, opened: Bools, situation: Situation) -> ManipulationPlan | None:
        """Return a plan by whole squares over sure floor, and some squares of wall that are supposed to be free."""
        # None for no such plan. The robot itself keeps off these squares.
        request = replace(request, on_lattice=True)
        node, shape = request.node, to_view_frame(request.node.polygon, situation)
        free = usable_squares(node, situation, 0, OtherObjects.CLEAR) | opened
        floor = CarryingFloor(shape, situation.model.place_on_view, free, situation.cost_maps.free(0))
        for name, _ in product(sorted(request.ends), range(MAX_ORACLE_ROUNDS)):
            plan = self._ask_geometry(request, request.ends[name], floor, situation.model)
            within = [leg.hold for leg in plan.legs if (robot_squares(leg, opened.shape) & opened).any()]
            if plan.legs and not within:
                found = _manipulation_plan(plan, shape, name, UNSEEN_LEVEL, situation, node)
                return replace(found, swept=found.swept & ~opened, aside=(), hopes=True)
            request = replace(request, avoid=(*request.avoid, *within))
        return None

    def _bolder(
        self, request: Request, found: ManipulationPlan, situation: Situation, hoped: EndsFunction
    ) -> ManipulationPlan:
        """Return the plan of fewest commands: the one that was found, or a more optimistic one."""
        # Nothing is moved aside or left askew for a plan that may fail: a failure with it would prove nothing.
        if found.level == OPTIMISTIC_LEVEL:
            return replace(found, hopes=not found.askew)
        fewest = MIN_PLAN_COMMANDS if request.held else MIN_PLAN_COMMANDS + 1
        further = isinstance(hoped().get(found.target), InCorner | Between)
        if found.level or found.aside or (found.plan.commands <= fewest and not further):
            return found
        others = self._optimistic_plans(request, situation, hoped)
        bold = (one for one in others if not one.askew and not one.aside)
        # Where the thing may end further on, what was found likely ends short, and it must be pushed once more.
        return min([found, *bold], key=lambda one: one.plan.commands + (further and not one.hopes))

    def _optimistic_plans(
        self, request: Request, situation: Situation, hoped: EndsFunction
    ) -> Iterator[ManipulationPlan]:
        """Yield a plan for each end over squares that are hoped to be free, also beyond all that was seen."""
        model, node = situation.model, request.node
        own, walk = (np.pad(mask, UNSEEN_MARGIN) for mask in (model.mask(node.patch), situation.cost_maps.free(0)))
        free = (optimistic_floor(situation) | own) & ~forbidden_squares(node, situation, UNSEEN_MARGIN)
        if (free == walk | own).all():
            return
        shape, (x, y) = to_view_frame(node.polygon, situation), model.place_on_view
        floor = CarryingFloor(
            Translate(UNSEEN_MARGIN, UNSEEN_MARGIN).carry(shape), (x + UNSEEN_MARGIN, y + UNSEEN_MARGIN), free, walk
        )
        ends = {**request.ends, **({} if orientation_is_uncertain(model) else hoped())}
        for name, end in sorted(ends.items()):
            plan = self._ask_geometry(request, moved(end, UNSEEN_MARGIN, UNSEEN_MARGIN), floor, model)
            if plan.legs:
                shifted = plan.shifted(-UNSEEN_MARGIN, -UNSEEN_MARGIN)
                yield replace(_manipulation_plan(shifted, shape, name, UNSEEN_LEVEL, situation, node), hopes=True)

    def _ask_geometry(self, request: Request, end: End, floor: CarryingFloor, model: WorldModel) -> CarryingPlan:
        """Return what geometry says of one end; from memory where the same was asked before."""
        shape, utak, free, walk = floor
        held, turn, contacts, on_lattice = request.held, request.turn_cost, request.contacts, request.on_lattice
        avoid = request.avoid if held else (*request.avoid, *sorted(_ambiguous_grasps(request.node, model)))
        asked = shape.wkb, free.tobytes(), free.shape, walk.tobytes(), goal_key(end)
        key = (*asked, utak, avoid, contacts, held, turn, on_lattice)
        if key not in self._answers:
            if len(self._answers) >= MAX_REMEMBERED:
                del self._answers[next(iter(self._answers))]  # the oldest
            margin = min(INEXACT_MARGIN * (contacts + (not is_grid_aligned(shape))), MAX_MARGIN)

            def ask(free: Bools, walls: Any = None) -> CarryingPlan:
                """Return what geometry says for some free squares and walls."""
                # None for all that is not free.
                return plan_carrying(
                    shape, free, utak, end, margin, self._pull, avoid, walk, walls, held, turn, on_lattice
                )

            roomy = ask(*_with_clearance(free, shape)) if contacts >= CONTACTS_FOR_CLEARANCE else None
            self._answers[key] = roomy if roomy is not None and roomy.legs else ask(free)
        return self._answers[key]


def _moved_in_parts(found: ManipulationPlan, parts: int) -> ManipulationPlan:
    """Return a plan with each push and turn made in some equal parts, one after the other."""
    if parts == 1:
        return found
    legs = [
        replace(leg, motions=tuple(m.part(1 / parts) for m in leg.motions for _ in range(parts)))
        for leg in found.plan.legs
    ]
    return replace(found, plan=replace(found.plan, legs=tuple(legs)))


def _refusal(found: ManipulationPlan, situation: Situation, node: Node) -> str:
    """Return why users' rules forbid the steps of a plan, in words; "" where they do not."""
    if not are_ruled(situation):
        return ""
    model = situation.model
    legs = [shifted(leg, model.view.west, model.view.south) for leg in found.plan.legs]
    grasped = model.held == node.name and is_at(model, legs[0].place)
    first = () if model.held is None or grasped else (release(model.held),)
    return refusal((*first, *of_legs(node.name, legs, grasped, model)), situation)


def _may_use_other_ways(node: Node, situation: Situation) -> bool:
    """Return whether what is forbidden here proves nothing."""
    own = situation.forbidden(node.name)
    kept_off = not situation.lenient and any(situation.region_kept_off(actor).any() for actor in (ROBOT, node.name))
    several = len(situation.rooms.doors) > 1
    return bool(kept_off or (own and several) or (not own and situation.forbidden(ROBOT)))


def _with_clearance(free: Bools, shape: Any) -> tuple[Bools, Any]:
    """Return the free squares and the walls (shapely) for an object that keeps WALL_CLEARANCE, but where it touches."""
    rows, columns = free.shape
    walls = shapely.box(0, 0, columns, rows).difference(mask_to_polygon(free))
    near_shape = shape.buffer(2 * WALL_CLEARANCE, join_style="mitre")
    thick = walls.union(walls.buffer(WALL_CLEARANCE, join_style="mitre").difference(near_shape))
    return free & ~dilate(~np.pad(free, 1), 1)[1:-1, 1:-1], thick


def _ambiguous_grasps(node: Node, model: WorldModel) -> Iterator[XY]:
    """Yield the grasps, as (x, y) from the object's middle, from which no compass point surely names its squares."""
    # In squares along the axes of the map, from the middle of the outline to the centre of the square where the robot
    # would stand.
    covered, ways, middle = node.patch.squares(), model.frame.directions(), node.polygon.centroid
    about = {(x + dx, y + dy) for x, y in covered for dx, dy in ADJACENT_OFFSETS} - covered
    for x, y in about:
        if not any((x + dx, y + dy) in covered for dx, dy in ways):
            yield x + 0.5 - middle.x, y + 0.5 - middle.y


def _floor_options(situation: Situation) -> list[tuple[int, OtherObjects]]:
    """Return each certainty level that is tried, with other objects where they are and, if there are any, without."""
    several = len(situation.model.objects) > 1
    choices = (OtherObjects.CLEAR, OtherObjects.ASIDE) if several else (OtherObjects.CLEAR,)
    return [(level, others) for level in TRIED_LEVELS for others in choices]


def usable_squares(node: Node, situation: Situation, level: int, others: OtherObjects) -> Bools:
    """Return the squares that may be used to carry an object, (rows, columns) bool on the arrays of the view."""
    model = situation.model
    own = model.mask(node.patch)
    free = situation.cost_maps.free(level) | own
    aside, proves = others == OtherObjects.ASIDE, level == UNSEEN_LEVEL
    for other in (other for other in model.objects if other.name != node.name):
        mask = model.mask(other.patch)
        if aside and other.movable > 0 and not other.felt_first:
            free |= mask
        if aside and proves and other.confidence >= POSSIBLE_OBJECT:
            parts = [possible_extension(other, side, MAX_HIDDEN_DEPTH, model) for side in SIDE_DIRECTIONS]
            hidden = np.any(parts, axis=0)
            if other.movable > 0 or hidden.any():
                free |= hidden | mask
        if proves and other.movable == 0:
            free |= mask & dilate(~mask, 1)
        if proves and node.inexact and (dilate(own, 1) & mask).any():
            free |= mask
    return free & ~forbidden_squares(node, situation)


def _least_way(end: End, shape: Any) -> float:
    """Return the straight distance from a shape to an end, in squares: a lower bound of the way."""
    if isinstance(end, At):
        return math.hypot(end.pose.x, end.pose.y)
    if isinstance(end, InCorner | Between):
        return float(shape.distance(shapely.Point(end.x, end.y)))
    return float(shape.distance(end.polygon)) if isinstance(end, Inside) else 0.0


def _is_switch(name: str, request: Request) -> bool:
    """Return whether an end is another one than that which was chosen last time."""
    return request.last_target in request.ends and name != request.last_target


def _manipulation_plan(
    plan: CarryingPlan, shape: Any, name: str, level: int, situation: Situation, node: Node
) -> ManipulationPlan:
    """Return the manipulation plan of what geometry found for the end `name` over squares of a level."""
    model = situation.model
    swept = swept_squares(plan, shape, model.labels.shape)
    # What seems to stand where the object itself lies is not in its way, nor is what may not be there at all.
    needed = swept & ~model.mask(node.patch) & ~situation.cost_maps.free(level)
    others = (other for other in model.objects if other.name != node.name)
    aside = tuple(other.name for other in others if (model.mask(other.patch) & needed).any())
    return ManipulationPlan(plan, name, level, swept, aside)


def swept_squares(plan: CarryingPlan, shape: Any, size: tuple[int, ...]) -> Bools:
    """Return the mask of squares that an object, and the robot holding it, cross on a plan, (rows, columns) bool."""
    rows, columns = size
    mask: Bools = squares(shape, columns, rows)
    for leg in plan.legs:
        for motion in leg.motions:
            mask |= squares_after(shape, [motion.part(share) for share in _shares(motion)], columns, rows)
            shape = motion.carry(shape)
        mask |= robot_squares(leg, size)
    return mask


def robot_squares(leg: Leg, size: tuple[int, ...]) -> Bools:
    """Return the mask of squares to which the robot comes while it pushes on a leg, (rows, columns) bool."""
    mask, (x, y) = np.zeros(size, np.bool_), leg.place
    for push in (motion for motion in leg.motions if isinstance(motion, Translate)):
        for share in _shares(push):
            column, row = int(x + push.dx * share), int(y + push.dy * share)
            mask[min(max(row, 0), size[0] - 1), min(max(column, 0), size[1] - 1)] = True
        x, y = x + push.dx, y + push.dy
    return mask


def _shares(motion: Motion) -> list[float]:
    """Return the shares of a motion at which its places are sampled, the whole motion last."""
    length = TURN_ARM * abs(motion.degrees) if isinstance(motion, Rotate) else math.hypot(motion.dx, motion.dy)
    steps = max(1, math.ceil(length / SWEEP_STRIDE))
    return [step / steps for step in range(1, steps + 1)]
