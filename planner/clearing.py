"""What stands in Utak's own way and can be moved: navigation among movable obstacles (Stilman and Kuffner 2005).

Asked only when nothing else is left to do: who meant that it stays where it is will not find it there.
"""

from collections.abc import Iterator, Sequence
from itertools import product
from typing import NamedTuple

import numpy as np

from geometry.carrying import At, Inside
from geometry.ends import End
from geometry.reach import UNREACHED
from geometry.rigid import Pose
from kb.worldmodel import Node, WorldModel
from planner.aims import Aim
from planner.carrier import Act, Carrier
from planner.destinations import Situation
from planner.exploring import inspection
from planner.goals import Stage
from planner.lying import leads_away, region_of
from planner.pursuing import Decision, Pursuer
from planner.screen import UNSEEN, Mask, Screens
from planner.verifying import Verifier
from planner.ways import Way, ways

SURELY = 95  # percent: what is a thing with less may be a piece of wall, and is felt before it is taken
LIKELY = 20  # percent: with less it is hardly one
DEEPEST = 2  # squares by which a thing may stand in what seems to be wall
SIDES = ((1, 0), (0, 1), (-1, 0), (0, -1))
ASIDE = "aside"  # the target of what he moves out of his way


class Obstacle(NamedTuple):
    """A thing that shuts him off from somewhere. aside : where it shall lie to see, or so that his way is free."""

    node: Node
    aside: End


def obstacles(things: Sequence[Node], situation: Situation) -> Iterator[Obstacle]:
    """Which of some things shut him off from floor, known or not seen yet, that he would come to without them.

    The one with the shortest way first. Each alone, or where that does not help the first of several that stand behind
    each other; else what stands in a door, and goes on in what seems to be wall.
    """
    model = situation.model
    under = [model.mask(thing.patch) for thing in things]
    found = [(thing, way) for thing, mask in zip(things, under, strict=True) for way in _ways(mask, situation)]
    if not found and things:
        found = [(_first_on(way, things, model), way) for way in _ways(np.any(under, axis=0), situation)]
    for thing, way in sorted(found, key=lambda pair: pair[1].length):
        columns, rows = np.array(way.squares).T
        room = situation.screens.free(0) | model.mask(thing.patch)
        room[rows, columns] = False
        yield Obstacle(thing, Inside(region_of(room)))
    for depth, thing in product(range(1, 1 + DEEPEST), things if not found else []):
        yield from _in_doors(thing, depth, situation)


def _ways(under: Mask, situation: Situation) -> list[Way]:
    """The way to where he would come were some squares free, and cannot now; none where they shut off but a nook."""
    without, screens = Screens(situation.model, under), situation.screens
    beyond = (without.distances[UNSEEN] != UNREACHED) & (screens.distances[UNSEEN] == UNREACHED) & ~under
    if not leads_away(beyond, under):
        return []
    return ways(without, UNSEEN, np.flatnonzero(beyond), "grid")


def _first_on(way: Way, things: Sequence[Node], model: WorldModel) -> Node:
    """The first of some things that a way over their squares comes to."""
    masks = [(thing, model.mask(thing.patch)) for thing in things]
    return next(thing for column, row in way.squares for thing, mask in masks if mask[row, column])


def _in_doors(thing: Node, depth: int, situation: Situation) -> Iterator[Obstacle]:
    """A thing that was never moved, where it shuts him off if it goes on so deep in what seems to be wall.

    It is drawn out by as much as it may be in there and one square more, where that is free: so it is seen whole.
    """
    model, mask = situation.model, situation.model.mask(thing.patch)
    room = np.pad(situation.screens.free(0) | mask, DEEPEST + 1)
    rows, columns = np.nonzero(np.pad(mask, DEEPEST + 1))
    for dx, dy in () if thing.moved else SIDES:
        steps = ((step * dx, step * dy) for step in range(1, depth + 1))
        behind = np.any([_shifted(mask, *step) & model.verge for step in steps], axis=0)
        if not behind.any() or not _ways(mask | behind, situation):
            continue
        out = (step for step in range(1, DEEPEST + 2) if not room[rows - step * dy, columns - step * dx].all())
        far = next(out, DEEPEST + 2) - 1
        if far:
            yield Obstacle(thing, At(Pose(-float(far * dx), -float(far * dy), 0.0)))


def _shifted(mask: Mask, dx: int, dy: int) -> Mask:
    """A mask so many columns and rows further on."""
    rows, columns = mask.shape
    wide = np.pad(mask, DEEPEST)
    return wide[DEEPEST - dy : DEEPEST - dy + rows, DEEPEST - dx : DEEPEST - dx + columns]


class Clearer:
    """Moves things out of Utak's way, and remembers which one he is moving."""

    def __init__(self, carrier: Carrier, pursuer: Pursuer, verifier: Verifier) -> None:
        self._carrier, self._pursuer, self._verifier = carrier, pursuer, verifier
        self._moving = ""

    def going_on(self, stage: Stage, situation: Situation) -> Decision | None:
        """The next command for what he has got hold of to move it aside; None when that is nothing, or done."""
        node = situation.model.object(self._moving) if situation.model.held == self._moving else None
        act = None if node is None else self._carrier.gone_on(node, situation)
        if act is None or self._pursuer.noticed(situation.model, act.command):
            self._moving = ""
            return None
        return Decision(act.command, f"{act.why}; {stage}")

    def cleared(self, decision: Decision, stage: Stage, situation: Situation) -> Decision:
        """What is decided; rather than give up, to move aside what shuts him off.

        While that stands there, that he cannot come further proves nothing; nor where it did not move, for it may be
        wedged in between walls.
        """
        if not decision.verdict:
            return decision
        model, shut_off = situation.model, ""
        stays = {situation.binding.get(str(term), "") for goal in stage.goals for term in goal.args}
        movable = [n for n in model.objects if n.movable > 0 and n.confidence >= LIKELY and n.name not in stays]
        for node, aside in obstacles(movable, situation):
            instead = self._moved_aside(node, aside, stage, situation)
            if instead is not None:
                return instead
            shut_off = node.name
        if decision.verdict != "impossible":
            return decision
        wedged = [n for n in model.objects if n.movable == 0 and n.confidence >= SURELY]
        shut_off = shut_off or next((node.name for node, _ in obstacles(wedged, situation)), "")
        why = f"{decision.why}; {shut_off} shuts him off, and was not moved aside"
        return Decision(None, why, "limit") if shut_off else decision

    def _moved_aside(self, node: Node, aside: End, stage: Stage, situation: Situation) -> Decision | None:
        """The next command to move a thing aside, if it is one; None when none is known."""
        if node.confidence < SURELY:
            touch = inspection(situation.screens, node, touch=True, chance=1.0, arrive=False)
            look = self._pursuer.look(Aim("inspect", *touch), stage, situation)
            return None if look is None or look.command is None else look
        if node.polygon is None or node.vague:
            look = self._pursuer.look(self._verifier.inspection(node, situation), stage, situation)
            if look is not None and look.command is not None:
                return look
        if node.polygon is None:
            return None
        advice = self._carrier.advise(node, {ASIDE: aside}, situation)
        if not isinstance(advice, Act):
            return self._pursuer.prepared(advice, stage, situation)
        if self._pursuer.noticed(situation.model, advice.command):
            return None
        self._moving = node.name
        return Decision(advice.command, f"{node.name} shuts him off: {advice.why}; {stage}")
