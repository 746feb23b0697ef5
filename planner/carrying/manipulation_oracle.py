"""Asking geometry how something can be carried, in the order that planner/asp/transport.lp chooses.

Choices are tried one after the other: what geometry proves impossible comes back as a fact, and rules out all that is
harder still. What it finds may lead over squares that are not surely free: then they are what must be seen first.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray

from geometry.manipulation.goals import End, moved
from geometry.manipulation.plan_carrying import At, Between, CarryingPlan, InCorner, Inside, plan_carrying
from geometry.motion.se2 import Rotate, Translate
from geometry.raster.rasterize import squares, squares_after
from kb.localisation.propose.larger_object import DEEPEST, SIDES
from kb.objects.held_object import is_whole
from kb.perception.frame import AROUND
from kb.reasoning.solver import solve
from kb.world.model import Node, WorldModel
from planner.carrying.infeasibility import Infeasibility, refusal
from planner.goals.optimistic import BEYOND, BOLD, framed, hoped_floor
from planner.goals.placement import LIKELY, SURELY, Ends, barred, hidden_behind, in_view, region_of
from planner.navigation.subgoals import ASP
from planner.screen.moves import is_open
from planner.screen.projection import UNSEEN, grown
from planner.situation import Situation

Mask = NDArray[np.bool_]
Place = tuple[float, float]
LEVELS = (0, BOLD, UNSEEN)  # of certainty, that are tried
FEWEST = 2  # commands of a plan: to push once, and to let go
MOST_ROUNDS = 12  # choices that geometry is asked to verify
STRIDE = 0.25  # squares between the places at which the squares of a motion are taken down
OFTEN = 2  # times that a thing stood against something unawares before its way must leave room for its being otherwise
KEPT = 0.15  # squares that it keeps from walls then
MARGIN = 0.3  # squares kept free about a thing whose outline is not whole
WIDEST = 0.6  # at most: what is kept free on either side must leave a way through doors


@dataclass(frozen=True)
class ManipulationPlan:
    """A way to carry something that geometry verified.

    Attributes
    ----------
    plan : frame of the view's arrays. target : where to. level : of certainty of the squares it needs.
    swept : (rows, columns) the squares that the object or Utak holding it cross.
    aside : nodes that must be moved out of the way first. hopes : it leads over squares that are hoped to be free, and
    is begun without a look at them.
    """

    plan: CarryingPlan
    target: str
    level: int
    swept: Mask
    aside: tuple[str, ...] = ()
    hopes: bool = False

    @property
    def askew(self) -> bool:
        """Is the thing turned otherwise than by quarter turns?"""
        turns = (m for leg in self.plan.legs for m in leg.motions if isinstance(m, Rotate))
        return any(turn.degrees % 90.0 != 0.0 for turn in turns)

    @property
    def short(self) -> bool:
        """Is it done by one hold and a push or two?"""
        legs = self.plan.legs
        return len(legs) == 1 and len(legs[0].motions) <= 2 and all(isinstance(m, Translate) for m in legs[0].motions)


@dataclass(frozen=True)
class Request:
    """What is to be carried, and where to. avoid : holds that failed. last : the target chosen last.

    tight : how often it stood against something unawares: the more room is wanted about it. held : whether Utak has
    hold of it and may go on so. turn : how many commands a turn counts for. hoped : the ends, if the floor goes on as
    it is hoped to; by their names, worked out when asked.
    """

    node: Node
    ends: Mapping[str, End]
    avoid: tuple[tuple[float, float], ...] = ()
    last: str = ""
    tight: int = 0
    held: bool = False
    turn: float = 1.0
    hoped: Ends = dict


class CarryingFloor(NamedTuple):
    """Where a thing and Utak are, and which squares they may use: all in one frame.

    shape : of the thing. utak : his place. free, walk : (rows, columns) squares for the thing and him with it, and for
    him alone.
    """

    shape: Any
    utak: Place
    free: Mask
    walk: Mask


class ManipulationOracle:
    """Finds ways to carry things, and remembers what it was last told for the same question."""

    def __init__(self, pull: bool = True) -> None:
        self._pull = pull
        self._known: dict[tuple[Any, ...], CarryingPlan] = {}
        self._hopeless = False

    def find(self, request: Request, situation: Situation) -> ManipulationPlan | Infeasibility:
        """The way that is chosen and verified, or why there is none."""
        shape, utak = in_view(request.node.polygon, situation), situation.model.place_on_view
        floors = {(level, aside): _free(request.node, situation, level, aside) for level, aside in _kinds(situation)}
        options = [
            f"option({name},{level},{aside},{round(10 * _way(end, shape))})"
            for name, end in sorted(request.ends.items())
            for level, aside in floors
        ]
        options += [f"last({request.last})"] * (request.last in request.ends)
        verdicts: list[str] = []
        plans: list[tuple[int, CarryingPlan]] = []  # each with the level that it was asked for
        for _ in range(MOST_ROUNDS):
            choice = _choice([*options, *verdicts, *["hopeless"] * self._hopeless])
            if choice is None:
                break
            name, level, aside = choice
            ground = CarryingFloor(shape, utak, floors[level, aside], situation.cost_maps.free(level))
            plan = self._plan(request, request.ends[name], ground, situation.model)
            if plan.status == "found" and self._hopeless:
                self._hopeless = False  # what was hopeless is no more: now the best way is asked for
                continue
            if plan.status == "found":
                return self._bolder(request, _haul(plan, shape, name, level, situation, request.node), situation)
            plans.append((level, plan))
            fact = "refuted" if plan.status == "impossible" else "undecided"
            verdicts.append(f"{fact}({name},{level},{aside})")
        self._hopeless = True
        told = refusal(request.node, plans, situation.model)
        own = situation.forbidden(request.node.name)
        unsure = len(own) > 1 or (not own and situation.forbidden("utak"))  # which door; it may go where he may not
        return replace(told, proved=False) if unsure else told

    def _bolder(self, request: Request, haul: ManipulationPlan, situation: Situation) -> ManipulationPlan:
        """What planner/asp/boldness.lp chooses of a way that was found and of those over what is hoped to be floor.

        A way that is surely free is compared with bolder ones, if one may take fewer commands. One that is not is begun
        without a look too, where the thing lies as straight after it as before.
        """
        if haul.level == BOLD:
            return replace(haul, hopes=not haul.askew)
        least = FEWEST if request.held else FEWEST + 1
        further = isinstance(request.hoped().get(haul.target), InCorner | Between)
        if haul.level or haul.aside or (haul.plan.commands <= least and not further):
            return haul
        hauls = [haul, *self._hoped(request, situation)]
        facts = []
        for number, one in enumerate(hauls):
            facts.append(f"plan({number},{one.plan.commands})")
            short = further and not one.hopes
            told = {"hopes": one.hopes, "askew": one.askew, "aside": bool(one.aside), "short": short}
            facts += [f"{fact}({number})" for fact, so in told.items() if so]
        answer = solve([ASP / "boldness.lp"], facts)
        return hauls[answer[0].arguments[0].number] if answer else haul

    def _hoped(self, request: Request, situation: Situation) -> Iterator[ManipulationPlan]:
        """Ways over squares that are hoped to be free, those beyond all that was seen among them: one for each end.

        There are none where nothing is hoped for. While it is open how the lattice lies they end in what was seen:
        beyond it no look tells well where he was stopped.
        """
        model, node = situation.model, request.node
        own, walk = framed(model.mask(node.patch)), framed(situation.cost_maps.free(0))
        free = (hoped_floor(situation) | own) & ~framed(barred(node, situation))
        if (free == walk | own).all():
            return
        shape, (x, y) = in_view(node.polygon, situation), model.place_on_view
        ground = CarryingFloor(Translate(BEYOND, BEYOND).carry(shape), (x + BEYOND, y + BEYOND), free, walk)
        ends = {**request.ends, **({} if is_open(model) else request.hoped())}
        for name, end in sorted(ends.items()):
            plan = self._plan(request, moved(end, BEYOND, BEYOND), ground, model)
            if plan.legs:
                found = _haul(plan.shifted(-BEYOND, -BEYOND), shape, name, UNSEEN, situation, node)
                yield replace(found, hopes=True)

    def _plan(self, request: Request, end: End, ground: CarryingFloor, model: WorldModel) -> CarryingPlan:
        """What geometry says of one end; from memory where it was asked before."""
        shape, utak, free, walk = ground
        held, turn, tight = request.held, request.turn, request.tight
        avoid = request.avoid if held else (*request.avoid, *sorted(_untouchable(request.node, model)))
        where = end.polygon.wkb if isinstance(end, Inside) else end
        key = (shape.wkb, free.tobytes(), free.shape, walk.tobytes(), where, utak, avoid, tight, held, turn)
        if key not in self._known:
            if len(self._known) > 64:
                self._known.clear()
            margin = min(MARGIN * (tight + (not is_whole(shape))), WIDEST)

            def ask(free: Mask, walls: Any = None) -> CarryingPlan:
                return plan_carrying(
                    shape, free, utak, end, margin, self._pull, avoid, walk, walls=walls, held=held, turn=turn
                )

            roomy = ask(*_with_room(free, shape)) if tight >= OFTEN else None
            self._known[key] = roomy if roomy is not None and roomy.legs else ask(free)
        return self._known[key]


def _with_room(free: Mask, shape: Any) -> tuple[Mask, Any]:
    """The squares and the walls for a thing that shall keep its distance, but for where it does not now."""
    rows, columns = free.shape
    walls = shapely.box(0, 0, columns, rows).difference(region_of(free))
    thick = walls.union(walls.buffer(KEPT, join_style="mitre").difference(shape.buffer(2 * KEPT, join_style="mitre")))
    return free & ~grown(~np.pad(free, 1), 1)[1:-1, 1:-1], thick


def _untouchable(node: Node, model: WorldModel) -> Iterator[tuple[float, float]]:
    """Holds by which no direction of his frame surely names a square of an object: at a corner, as the lattice lies."""
    covered, ways, middle = node.patch.squares(), model.frame.directions(), node.polygon.centroid
    about = {(x + dx, y + dy) for x, y in covered for dx, dy in AROUND} - covered
    for x, y in about:
        if not any((x + dx, y + dy) in covered for dx, dy in ways):
            yield x + 0.5 - middle.x, y + 0.5 - middle.y


def _kinds(situation: Situation) -> list[tuple[int, str]]:
    """The levels of certainty that differ, with other things where they are and without them."""
    others = len(situation.model.objects) > 1
    return [(level, aside) for level in LEVELS for aside in (("clear", "aside") if others else ("clear",))]


def _free(node: Node, situation: Situation, level: int, aside: str) -> Mask:
    """The squares that may be used for carrying an object: those of the level, its own, and those of movable things.

    What lies only about where it is believed to may cover what seems to be another thing right beside it, and what
    cannot be moved may cover the squares at its rim in part: nothing is proved by those. Nor by what may be a thing and
    no piece of wall, or go on in what seems to be wall, in which it is wedged if it did not move.
    """
    model = situation.model
    own = model.mask(node.patch)
    free = situation.cost_maps.free(level) | own
    if level == UNSEEN:
        for other in (other for other in model.objects if other.name != node.name):
            mask = model.mask(other.patch)
            if other.movable == 0:
                free |= mask & grown(~mask, 1)
            if node.inexact and (grown(own, 1) & mask).any():
                free |= mask
    if aside == "aside":
        for other in (other for other in model.objects if other.name != node.name):
            if other.movable > 0 and other.confidence >= SURELY:
                free |= model.mask(other.patch)
            if level == UNSEEN and other.confidence >= LIKELY:
                hidden = np.any([hidden_behind(other, side, DEEPEST, model) for side in SIDES], axis=0)
                if other.movable > 0 or hidden.any():
                    free |= hidden | model.mask(other.patch)
    return free & ~barred(node, situation)


def _way(end: End, shape: Any) -> float:
    """The least way to a target as the crow flies, in squares."""
    if isinstance(end, At):
        return math.hypot(end.pose.x, end.pose.y)
    if isinstance(end, InCorner | Between):
        return float(shape.distance(shapely.Point(end.x, end.y)))
    return float(shape.distance(end.polygon)) if isinstance(end, Inside) else 0.0


def _choice(facts: Sequence[str]) -> tuple[str, int, str] | None:
    answer = solve([ASP / "transport.lp"], facts)
    if not answer:
        return None
    name, level, aside = answer[0].arguments
    return str(name), level.number, str(aside)


def _haul(plan: CarryingPlan, shape: Any, name: str, level: int, situation: Situation, node: Node) -> ManipulationPlan:
    model = situation.model
    swept = swept_squares(plan, shape, model.labels.shape)
    # What seems to stand where the object itself is, is not in its way, nor is what may not be there at all.
    needed = swept & ~model.mask(node.patch) & ~situation.cost_maps.free(level)
    others = (other for other in model.objects if other.name != node.name)
    aside = tuple(other.name for other in others if (model.mask(other.patch) & needed).any())
    return ManipulationPlan(plan, name, level, swept, aside)


def swept_squares(plan: CarryingPlan, shape: Any, size: tuple[int, ...]) -> Mask:
    """(rows, columns): the squares that an object, and Utak with it in his hand, cross on a plan."""
    rows, columns = size
    mask: Mask = squares(shape, columns, rows)
    for leg in plan.legs:
        x, y = leg.place
        for motion in leg.motions:
            far = math.hypot(motion.dx, motion.dy) if isinstance(motion, Translate) else 0.4 * abs(motion.degrees)
            steps = max(1, math.ceil(far / STRIDE))
            shares = [step / steps for step in range(1, steps + 1)]
            mask |= squares_after(shape, [motion.part(share) for share in shares], columns, rows)
            shape = motion.carry(shape)
            if isinstance(motion, Translate):
                for share in shares:
                    here = x + motion.dx * share, y + motion.dy * share
                    mask[min(max(int(here[1]), 0), rows - 1), min(max(int(here[0]), 0), columns - 1)] = True
                x, y = x + motion.dx, y + motion.dy
    return mask
