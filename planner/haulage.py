"""Asking geometry how something can be carried, in the order that planner/asp/transport.lp chooses.

Choices are tried one after the other: what geometry proves impossible comes back as a fact, and rules out all that is
harder still. What it finds may lead over squares that are not surely free: then they are what must be seen first.
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from geometry.carrying import At, Carrying, InCorner, Inside, plan_carrying
from geometry.digital import squares, squares_after
from geometry.ends import End
from geometry.rigid import Translate
from kb.encodings import solve
from kb.lattice import AROUND
from kb.loads import is_whole
from kb.worldmodel import Node, WorldModel
from planner.aims import ASP
from planner.destinations import Situation
from planner.landing import in_view, lies_askew
from planner.screen import UNSEEN, grown

Mask = NDArray[np.bool_]
Place = tuple[float, float]
LEVELS = (0, 2, UNSEEN)  # of certainty, that are tried
MOST_ROUNDS = 12  # choices that geometry is asked to verify
STRIDE = 0.25  # squares between the places at which the squares of a motion are taken down
MARGIN = 0.3  # squares kept free about a thing whose outline is not whole
WIDEST = 0.6  # at most: what is kept free on either side must leave a way through doors


@dataclass(frozen=True)
class Haul:
    """A way to carry something that geometry verified.

    Attributes
    ----------
    plan : frame of the view's arrays. target : where to. level : of certainty of the squares it needs.
    swept : (rows, columns) the squares that the object or Utak holding it cross.
    aside : nodes that must be moved out of the way first.
    """

    plan: Carrying
    target: str
    level: int
    swept: Mask
    aside: tuple[str, ...] = ()

    @property
    def short(self) -> bool:
        """Is it done by one hold and a push or two?"""
        legs = self.plan.legs
        return len(legs) == 1 and len(legs[0].motions) <= 2 and all(isinstance(m, Translate) for m in legs[0].motions)


@dataclass(frozen=True)
class Refusal:
    """No way was found.

    proved : there is none, whatever the unseen holds. reason : in words; neck : the middle of the passage that is too
    narrow, in the view's frame, if it is for want of one. Both are worked out when asked.
    """

    proved: bool
    reason: Callable[[], str]
    neck: Callable[[], Place | None] = lambda: None


@dataclass(frozen=True)
class Request:
    """What is to be carried, and where to. avoid : holds that failed. last : the target chosen last.

    tight : how often it stood against something unawares: the more room is wanted about it. held : whether Utak has
    hold of it and may go on so. turn : how many commands a turn counts for.
    """

    node: Node
    ends: Mapping[str, End]
    avoid: tuple[tuple[float, float], ...] = ()
    last: str = ""
    tight: int = 0
    held: bool = False
    turn: float = 1.0


class Hauler:
    """Finds ways to carry things, and remembers what it was last told for the same question."""

    def __init__(self, pull: bool = True) -> None:
        self._pull = pull
        self._known: dict[tuple[Any, ...], Carrying] = {}
        self._hopeless = False

    def find(self, request: Request, situation: Situation) -> Haul | Refusal:
        """The way that is chosen and verified, or why there is none."""
        shape = in_view(request.node.polygon, situation)
        floors = {(level, aside): _free(request.node, situation, level, aside) for level, aside in _kinds(situation)}
        options = [
            f"option({name},{level},{aside},{round(10 * _way(end, shape))})"
            for name, end in sorted(request.ends.items())
            for level, aside in floors
        ]
        options += [f"last({request.last})"] * (request.last in request.ends)
        verdicts: list[str] = []
        plans: list[tuple[int, Carrying]] = []  # each with the level that it was asked for
        for _ in range(MOST_ROUNDS):
            choice = _choice([*options, *verdicts, *["hopeless"] * self._hopeless])
            if choice is None:
                break
            name, level, aside = choice
            plan = self._plan(request, shape, floors[level, aside], situation.screens.free(level), name, situation)
            if plan.status == "found" and self._hopeless:
                self._hopeless = False  # what was hopeless is no more: now the best way is asked for
                continue
            if plan.status == "found":
                return _haul(plan, shape, name, level, situation, request.node)
            plans.append((level, plan))
            fact = "refuted" if plan.status == "impossible" else "undecided"
            verdicts.append(f"{fact}({name},{level},{aside})")
        self._hopeless = True
        return _refusal(request.node, plans, situation.model)

    def _plan(self, request: Request, shape: Any, free: Mask, walk: Mask, name: str, situation: Situation) -> Carrying:
        x, y = situation.model.place
        view = situation.model.view
        utak = (x - view.west, y - view.south)
        avoid = (
            request.avoid if request.held else (*request.avoid, *sorted(_untouchable(request.node, situation.model)))
        )
        key = (
            shape.wkb,
            free.tobytes(),
            free.shape,
            name,
            repr(request.ends[name]),
            utak,
            avoid,
            request.tight,
            request.held,
            request.turn,
        )
        if key not in self._known:
            if len(self._known) > 64:
                self._known.clear()
            margin = min(MARGIN * (request.tight + (not is_whole(shape))), WIDEST)
            end, held, turn = request.ends[name], request.held, request.turn
            self._known[key] = plan_carrying(
                shape, free, utak, end, margin, self._pull, avoid, walk, held=held, turn=turn
            )
        return self._known[key]


def _untouchable(node: Node, model: WorldModel) -> Iterator[tuple[float, float]]:
    """Holds by which no direction of his frame surely names a square of an object: at a corner, as the lattice lies."""
    covered, ways, middle = node.patch.squares(), model.lattice.directions(), node.polygon.centroid
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

    What lies only about where it is believed to may cover what seems to be another thing right beside it: nothing is
    proved by that.
    """
    model = situation.model
    own = model.mask(node.patch)
    free = situation.screens.free(level) | own
    if level == UNSEEN and node.inexact:
        for other in model.objects:
            beside = model.mask(other.patch)
            if (grown(own, 1) & beside).any():
                free |= beside
    if aside == "aside":
        for other in model.objects:
            if other.movable > 0 and other.confidence >= 95:
                free |= model.mask(other.patch)
    return free


def _way(end: End, shape: Any) -> float:
    """The least way to a target as the crow flies, in squares."""
    if isinstance(end, At):
        return math.hypot(end.pose.x, end.pose.y)
    if isinstance(end, InCorner):
        return float(shape.distance(shapely.Point(end.x, end.y)))
    return float(shape.distance(end.polygon)) if isinstance(end, Inside) else 0.0


def _choice(facts: Sequence[str]) -> tuple[str, int, str] | None:
    answer = solve([ASP / "transport.lp"], facts)
    if not answer:
        return None
    name, level, aside = answer[0].arguments
    return str(name), level.number, str(aside)


def _haul(plan: Carrying, shape: Any, name: str, level: int, situation: Situation, node: Node) -> Haul:
    model = situation.model
    swept = swept_squares(plan, shape, model.labels.shape)
    needed = swept & ~model.mask(node.patch)  # what seems to stand where the object itself is, is not in its way
    others = (other for other in model.objects if other.name != node.name)
    aside = tuple(other.name for other in others if (model.mask(other.patch) & needed).any())
    return Haul(plan, name, level, swept, aside)


def swept_squares(plan: Carrying, shape: Any, size: tuple[int, ...]) -> Mask:
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


def _refusal(node: Node, plans: Sequence[tuple[int, Carrying]], model: WorldModel) -> Refusal:
    """Why nothing was found. It is proved when every target was refuted, whatever lies in the unseen."""
    if not plans:
        return Refusal(False, lambda: f"nothing is known of where {node.name} could be carried")
    _, last = plans[-1]
    if any(plan.status != "impossible" for _, plan in plans):
        return Refusal(False, lambda: f"no way was found to carry {node.name} there, and no proof that there is none")
    doubt = _doubt(node, last, model)
    if doubt:
        return Refusal(False, lambda: f"where {node.name} lies is not known well: {doubt}")

    def neck() -> Place | None:
        passage = _nearest_to_done(plans).passage
        return None if passage is None else passage.place

    def reason() -> str:
        closest = _nearest_to_done(plans)
        passage = closest.passage
        if passage is None:
            return f"{node.name} cannot be carried there"
        x, y = passage.place
        east, north = model.lattice.place_to_utak(x + model.view.west, y + model.view.south)
        where = f"{passage.width:.2f} squares wide at POINT ({east:.1f} {north:.1f})"
        if math.isinf(closest.missing):
            return f"{node.name} cannot be carried there: even were the passage, {where}, as wide as it, it could not"
        return f"the passage for {node.name}, {where}, is too narrow by {closest.missing:.2f} squares"

    return Refusal(True, reason, neck)


def _doubt(node: Node, plan: Carrying, model: WorldModel) -> str:
    """What speaks against that a thing lies where it is believed to, in words; nothing when nothing does.

    plan : one that is impossible.
    """
    if plan.reason == "start":  # nothing lies in a wall
        return "it would overlap a wall"
    if node.dubious:
        return "what is seen does not agree with it"
    if node.stuck and not model.view.sure:
        return "it did not move where there seemed to be room"
    return "it was turned askew" if lies_askew(node) else ""  # and what is wall beside it is not known well either


def _nearest_to_done(plans: Sequence[tuple[int, Carrying]]) -> Carrying:
    """Of plans that are impossible the last that is so by a passage, over as many squares as any of them."""
    widest = max(level for level, _ in plans)
    asked = [plan for level, plan in reversed(plans) if level == widest]
    return next((plan for plan in asked if math.isfinite(plan.missing)), asked[0])
