"""Explanations of an observation: where it was made, in which frame, and what that means for everything else."""

import math
import statistics
from collections.abc import Sequence
from typing import NamedTuple

from utak.kb.localisation.hypotheses.carry_outcomes import CarryOutcome
from utak.kb.localisation.hypotheses.correction import WalkCorrection
from utak.kb.localisation.hypotheses.frames import Hypothesis, OriginBox, Position
from utak.kb.objects.held_object import HeldObject, Square
from utak.kb.perception.frame import CENTRE, Frame
from utak.kb.reasoning.encodings import KB_ENCODINGS
from utak.kb.reasoning.solver import solve

PRICE_PER_NAT = 2  # prices of kb/asp/accommodation.lp for a factor of e in probability: the scale of that encoding
CONTRADICTION_WEIGHT = 2  # fields that a contradiction of observations counts as: more than any other frame costs
MIN_PRICED_CHANCE = 1e-9  # probability below which an end of a motion is no less likely, so that its price is finite


class TableChange(NamedTuple):
    """A change of the table by others between two observations."""

    gone: tuple[str, ...]  # the names of the things that are no longer where they lay, sorted
    squares: frozenset[Square]  # where something changed, map frame: earlier observations say nothing of these
    new: int  # the number of things that stand where floor was


class Explanation(NamedTuple):
    """An explanation of an observation."""

    # Its kind, as in kb/asp/accommodation.lp: predicted (the motion went as commanded), blocked (it ended early),
    # slipped (it ended beside the predicted end), turned (the frame is another one), misled (an earlier motion, or this
    # one in another frame, ended early), stuck (nothing moved), smaller (as commanded, or until something known stopped
    # it, but the held object does not fill its squares), larger (as commanded, but the held object is larger than it
    # seemed), parted (as commanded, but the held object is only a part of what seemed one thing), changed (others moved
    # things), lifted (others put the robot elsewhere), lost (it is not known where); or lost or anew after a new
    # beginning.
    how: str
    place: Position  # where the observation was made, (x, y) in squares, map frame of `frame`
    frame: Frame  # the frame by this explanation
    residual: int  # number of fields that it leaves unexplained (they contradict the map or an object by it); 0 is best
    # From the predicted end of the motion, in squares; for misled by how far ends are corrected in all, for larger how
    # far the object goes on beyond what was seen; for changed how many things others moved, took or brought
    distance: float
    outcome: CarryOutcome | None = None  # of the motion of the object in hand; None when nothing was to be moved
    hypotheses: tuple[Hypothesis, ...] = ()  # the frame hypotheses that are left; empty where they stay
    correction: WalkCorrection | None = None  # of a motion that ended elsewhere than believed; None when none did
    contact_known: bool = False  # whether something known stands where that motion was blocked
    # The probability (0 to 1) of this end of the motion before the observation; None when it was not asked
    chance: float | None = None
    # By how much the simplest map costs more than by the best explanation, in log odds (natural logarithm)
    prior_cost: float = 0.0
    # The open squares (not settled as free or occupied) one of which blocked the motion, map frame
    contact_squares: frozenset[Square] = frozenset()
    origin_weighed: bool = False  # whether `prior_cost` contains the log odds against the origin of `frame`
    # The object before the motion, if it was larger than was seen, or only a part of it; else None
    instead: HeldObject | None = None
    # The squares of what seemed part of the object and stayed where it was, map frame; empty for none
    left: frozenset[Square] = frozenset()
    # Whether it cannot be so though no single field contradicts it: the counts of several observations together do
    contradicted: bool = False
    change: TableChange | None = None  # what others changed on the table, if they did
    # How far the robot may be from `place` where it was put elsewhere, in squares: west, south, east, north
    place_error: OriginBox = (0.0, 0.0, 0.0, 0.0)
    cramped: bool = False  # whether it leaves the origin of the frame suspiciously little room in the square of waking

    @property
    def unexplained(self) -> int:
        """The fields that count against it: the residual, CONTRADICTION_WEIGHT where contradicted, 1 where cramped."""
        return self.residual + CONTRADICTION_WEIGHT * self.contradicted + self.cramped

    @property
    def remaps(self) -> bool:
        """Return whether the frame, or where earlier observations were made, is another one than believed."""
        return self.how in ("turned", "misled", "lost", "anew") or self.correction is not None

    @property
    def is_end(self) -> bool:
        """Return whether it is an end of the newest motion in the believed frame, with its chance."""
        return self.how in ("predicted", "blocked") and self.chance is not None

    @property
    def odds(self) -> float:
        """The log odds (natural logarithm) against it by its map and its chance."""
        return self.prior_cost - math.log(max(self.chance or 0.0, MIN_PRICED_CHANCE))

    @property
    def is_odd(self) -> bool:
        """Return whether both the angle of the frame (not 0) and its origin (no square's middle) are unusual."""
        return self.frame.angle != 0 and self.frame.origin != CENTRE and not self.origin_weighed


def likeliest_first(found: Sequence[Explanation]) -> list[Explanation]:
    """Return re-estimations with all hypotheses of them: known contacts, then the median orientation first."""
    left = tuple(dict.fromkeys(hypothesis for one in found for hypothesis in one.hypotheses))
    middle = statistics.median(hypothesis.angle for hypothesis in left) if left else 0
    ordered = sorted(found, key=lambda one: (not one.contact_known, abs(one.frame.angle - middle)))
    return [one._replace(hypotheses=left) for one in ordered]


def cheapest(explanations: Sequence[Explanation], facts: Sequence[str]) -> Explanation:
    """Return the explanation that kb/asp/accommodation.lp chooses: one of those given, unchanged."""
    offered = [
        f"explanation({number},{e.how},{e.residual},{math.ceil(e.distance)})" for number, e in enumerate(explanations)
    ]
    offered += [f"contradicted({number})" for number, e in enumerate(explanations) if e.contradicted]
    offered += [f"cramped({number})" for number, e in enumerate(explanations) if e.cramped]
    offered += [f"odd({number})" for number, e in enumerate(explanations) if e.is_odd]
    for number, e in enumerate(explanations):
        offered += [f"crooked({number},{round(PRICE_PER_NAT * e.prior_cost)})"] * (e.prior_cost > 0)
        if e.chance is not None:
            price = round(-PRICE_PER_NAT * math.log(max(e.chance, MIN_PRICED_CHANCE)))
            offered.append(f"unlikely({number},{price})")
    about = [_in_words(explanation) for explanation in explanations]
    answer = solve([KB_ENCODINGS / "accommodation.lp"], [*offered, *facts], about=about)
    if not answer:
        raise AssertionError("accommodation.lp always has an answer")
    return explanations[answer[0].arguments[0].number]


def _in_words(explanation: Explanation) -> str:
    """Return an explanation as text: its kind, and where the observation was made, in squares, robot frame."""
    east, north = explanation.frame.place_to_utak(*explanation.place)
    return f"{explanation.how} at ({east:.2f}, {north:.2f})"
