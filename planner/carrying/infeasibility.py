"""Why something cannot be carried to where it should be: what geometry proved, and what speaks against the proof."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from geometry.manipulation.plan_carrying import CarryingPlan
from kb.objects.held_object import is_whole
from kb.world.model import Node, WorldModel
from planner.carrying.open_facts import width_open
from planner.goals.placement import lies_askew

Place = tuple[float, float]


@dataclass(frozen=True)
class Infeasibility:
    """No way was found.

    proved : there is none, whatever the unseen holds. reason : in words; neck : the middle of the passage that is too
    narrow, in the view's frame, if it is for want of one; unless : the open fact by which it may be wide enough, in
    words, "" for none. All three are worked out when asked.
    """

    proved: bool
    reason: Callable[[], str]
    neck: Callable[[], Place | None] = lambda: None
    unless: Callable[[], str] = lambda: ""


def refusal(node: Node, plans: Sequence[tuple[int, CarryingPlan]], model: WorldModel) -> Infeasibility:
    """Why nothing was found. It is proved when every target was refuted, whatever lies in the unseen."""
    if not plans:
        return Infeasibility(False, lambda: f"nothing is known of where {node.name} could be carried")
    if any(plan.status != "impossible" for _, plan in plans):
        return Infeasibility(
            False, lambda: f"no way was found to carry {node.name} there, and no proof that there is none"
        )
    doubt = _doubt(node, plans, model)
    if doubt:
        return Infeasibility(False, lambda: f"where {node.name} lies is not known well: {doubt}")

    def neck() -> Place | None:
        passage = nearest_to_done(plans).passage
        return None if passage is None else passage.place

    def reason() -> str:
        closest = nearest_to_done(plans)
        passage = closest.passage
        if passage is None:
            return f"{node.name} cannot be carried there"
        where = f"{passage.width:.2f} squares wide at {model.point_in_words(passage.place)}"
        if _hopeless(closest):
            return f"{node.name} cannot be carried there: even were the passage, {where}, as wide as it, it could not"
        return f"the passage for {node.name}, {where}, is too narrow by {closest.missing:.2f} squares"

    def unless() -> str:
        closest = nearest_to_done(plans)
        passage = closest.passage
        if passage is None or _hopeless(closest):
            return ""
        return width_open(passage.width, closest.missing, passage.sides, model.point_in_words(passage.place))

    return Infeasibility(True, reason, neck, unless)


def _doubt(node: Node, plans: Sequence[tuple[int, CarryingPlan]], model: WorldModel) -> str:
    """What speaks against that a thing lies where it is believed to, in words; nothing when nothing does.

    plans : all that are impossible, the last one asked for last.
    """
    _, last = plans[-1]
    if last.reason == "start":  # nothing lies in a wall
        return "it would overlap a wall"
    if node.dubious:
        return "what is seen does not agree with it"
    if node.stuck and not model.view.sure:
        return "it did not move where there seemed to be room"
    if lies_askew(node):  # and what is wall beside it is not known well either
        return "it was turned askew"
    # Who began anew forgot what he had moved. What lies askew he may have turned himself, against walls, too.
    if model.anew and node.polygon is not None and not is_whole(node.polygon):
        return "it lies askew, and may have been turned before all was forgotten"
    # He has brought it there. When no wider passage would let it go on, it rather is elsewhere.
    amid_squares = node.moved and not is_whole(node.polygon)
    return "it was stopped on its way there" if amid_squares and _hopeless(nearest_to_done(plans)) else ""


def nearest_to_done(plans: Sequence[tuple[int, CarryingPlan]]) -> CarryingPlan:
    """Of plans that are impossible the last that is so by a passage, over as many squares as any of them."""
    widest = max(level for level, _ in plans)
    asked = [plan for level, plan in reversed(plans) if level == widest]
    return next((plan for plan in asked if plan.opens), asked[0])


def _hopeless(plan: CarryingPlan) -> bool:
    """Is there a passage that is too narrow, and it is not for want of that alone?"""
    return plan.passage is not None and not plan.opens
