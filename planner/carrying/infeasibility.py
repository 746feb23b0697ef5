"""Infeasibility certificates: why an object cannot be carried to where it should be, and how far that is proved."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from utak.geometry.cspace.bottleneck import Bottleneck
from utak.geometry.kernels.arrays import XY
from utak.geometry.manipulation.plan_carrying import CarryingPlan
from utak.kb.objects.held_object import is_grid_aligned
from utak.kb.world.model import Node, WorldModel
from utak.planner.goals.placement import is_off_quarter_turn

ONE_NUMBER = 0.05  # squares: a missing width that is known this well is told as one number; a convention


@dataclass(frozen=True, eq=False)
class Refutation:
    """A refutation by geometry: no way leads to any of the ends of an object."""

    name: str  # of the object
    # Each refuted plan (squares, view frame) with the certainty level of the squares that it was asked for, in the
    # order of asking; at least one. Level 0 allows the surest squares only; the higher, the more squares it allows.
    plans: tuple[tuple[int, CarryingPlan], ...]
    model: WorldModel  # what was believed

    @property
    def closest(self) -> CarryingPlan:
        """The refuted plan that comes closest to leading somewhere, view frame."""
        return closest_refuted(self.plans)

    def reason(self) -> str:
        """Return why the object cannot be carried there, in words: a clause without full stop."""
        closest, passage = self.closest, self.closest.passage
        if passage is None:
            return f"{self.name} cannot be carried there"
        where = f"{passage.width:.2f} squares wide at {self.model.point_in_words(passage.place)}"
        if not closest.opens:
            return f"{self.name} cannot be carried there: the passage, {where}, {how_narrow(closest)}"
        return f"the passage for {self.name}, {where}, {how_narrow(closest)}"


@dataclass(frozen=True)
class Infeasibility:
    """No way was found to carry an object; perhaps with a certificate that there is none."""

    proved: bool  # whether there is none, whatever the unseen squares hold
    message: str = ""  # why, in words, without full stop; "" where the refutation tells it
    # What geometry refuted; None when nothing was proved, or when it needed no geometry
    refutation: Refutation | None = None

    def reason(self) -> str:
        """Return why nothing can be done, in words, without full stop. It may take time, to find the narrow passage."""
        return self.message or (self.refutation.reason() if self.refutation is not None else "")

    def proof(self) -> tuple[str, ...]:
        """Return the facts that prove it, in words: what geometry refuted, or what was looked at; () for nothing."""
        if not self.proved:
            return ()
        return (f"geometry refuted every plan for {self.refutation.name}" if self.refutation else self.message,)

    @property
    def passage(self) -> Bottleneck | None:
        """The passage that is too narrow, view frame; None for none."""
        return None if self.refutation is None else self.refutation.closest.passage

    def neck(self) -> XY | None:
        """Return the middle (x, y) of the passage that is too narrow, in squares, view frame; None for none."""
        return None if self.passage is None else self.passage.place

    def unless(self) -> str:
        """Return the open fact by which the passage may be wide enough, in words, without full stop; "" for none."""
        # Also "" when no passage is too narrow, or a wider one would not help.
        closest = None if self.refutation is None else self.refutation.closest
        if self.refutation is None or closest is None or closest.passage is None or _is_blocked_elsewhere(closest):
            return ""
        where, passage = self.refutation.model.point_in_words(closest.passage.place), closest.passage
        return possible_width(passage.width, closest.missing_between[0], passage.sides, where)


def possible_width(width: float, missing: float, sides: tuple[XY, XY], where: str) -> str:
    """Return the open fact that a passage is wide enough, in words; "" when it is too narrow in any case."""
    (x, y), (other_x, other_y) = sides
    most = width + 2 * (abs(x - other_x) + abs(y - other_y)) / max(math.dist(*sides), 1e-9)
    if width + missing >= most:
        return ""
    return f"the passage at {where}, which is between {width:.2f} and {most:.2f} squares wide, is wide enough"


def certify(node: Node, plans: Sequence[tuple[int, CarryingPlan]], model: WorldModel) -> Infeasibility:
    """Return why no way was found for an object."""
    if not plans:
        return Infeasibility(False, f"it is not known where {node.name} could be carried")
    if any(plan.status != "impossible" for _, plan in plans):
        return Infeasibility(False, f"no way was found to carry {node.name} there, and no proof that there is none")
    if doubt := _doubt(node, plans, model):
        return Infeasibility(False, f"it is not known well where {node.name} lies: {doubt}")
    return Infeasibility(True, refutation=Refutation(node.name, tuple(plans), model))


def _doubt(node: Node, plans: Sequence[tuple[int, CarryingPlan]], model: WorldModel) -> str:
    """Return why an object may lie elsewhere than believed, in words; "" for no reason."""
    askew = node.polygon is not None and not is_grid_aligned(node.polygon)
    closest = closest_refuted(plans)
    doubts = (
        (plans[-1][1].reason == "start", "it would overlap a wall"),  # nothing lies in a wall
        (node.dubious, "what is seen does not agree with it"),
        (node.stuck and not model.view.sure, "it did not move where there seemed to be room"),
        (is_off_quarter_turn(node), "it was turned askew"),  # then the walls beside it are not known well either
        # After a restart it is forgotten which objects were moved. One that lies askew may have been turned, against
        # walls.
        (model.anew and askew, "it lies askew, and may have been turned before all was forgotten"),
        # The robot has brought it there. When no wider passage surely lets it go on, it is more likely elsewhere.
        (node.moved and askew and closest.passage and not closest.opens, "it was stopped on its way there"),
    )
    return next((why for doubtful, why in doubts if doubtful), "")


def closest_refuted(plans: Sequence[tuple[int, CarryingPlan]]) -> CarryingPlan:
    """Return the refuted plan that comes closest to leading somewhere."""
    # It is the last one of the most permissive level that a wider passage would make possible; if there is none, the
    # last one of that level.
    most_permissive = max(level for level, _ in plans)
    asked = [plan for level, plan in reversed(plans) if level == most_permissive]
    return next((plan for plan in asked if plan.opens), asked[0])


def how_narrow(plan: CarryingPlan) -> str:
    """Return by how much the passage of a refuted plan is too narrow, in words, as far as that is proved."""
    # Where a wider one would not help, it need not be narrow: something else stops the body, too.
    if _is_blocked_elsewhere(plan):
        return "is not all that stops it: a wider one would not help"
    if not plan.opens:
        return "is too narrow"
    least, _, most = plan.missing_between
    between = f" (between {least:.2f} and {most:.2f})" if most - least > ONE_NUMBER else ""
    return f"is too narrow by {plan.missing:.2f} squares{between}"


def _is_blocked_elsewhere(plan: CarryingPlan) -> bool:
    """Return whether a passage is too narrow for a refuted plan, and to widen it alone surely would not help."""
    return plan.missing == math.inf
