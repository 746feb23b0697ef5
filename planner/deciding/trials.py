"""Trials: what seems one thing may be several that touch, and what did not move one way may move another way."""

from collections.abc import Sequence
from itertools import product

from utak.geometry.manipulation.goals import At
from utak.geometry.motion.se2 import Pose
from utak.kb.body import Push
from utak.kb.language.terms import Fact
from utak.kb.world.model import Node
from utak.planner.deciding.bringing import bring_to_end, carry_on
from utak.planner.deciding.feeling import feel_rims, feeling_scope
from utak.planner.deciding.stage_turn import StageTurn
from utak.planner.decision import Decision, nothing_to_do
from utak.planner.sights.things import things_in_question, unfelt_rims
from utak.planner.sights.walls import EDGE_STEPS
from utak.planner.situation import Situation

TRIAL_TARGET = "trial"  # the ends of plans that move a thing by a square, with the number of the direction after it

Trial = tuple[str, int]  # the name of a thing, and the number of the direction in EDGE_STEPS


class Trials:
    """Finds out whether what seems one thing is several, and remembers which way things were pushed for that."""

    def __init__(self) -> None:
        """Make one that tried nothing."""
        self._begun: Trial | None = None
        self._made: set[Trial] = set()  # trials in which the thing was pushed

    def is_pushing(self, situation: Situation) -> bool:
        """Return whether a thing is in hand that is to be moved, to see whether it moves another way."""
        return self._begun is not None and situation.model.held == self._begun[0]

    def go_on(self, turn: StageTurn) -> Decision:
        """Return the next command for the thing in hand that is moved by a square; nothing when that is done."""
        assert self._begun is not None
        name = self._begun[0]
        node = turn.situation.model.object(name)
        carried = None if node is None or self._begun in self._made else carry_on(node, turn, turn.situation)
        if carried is None:
            self._begun = None
            return nothing_to_do(f"{name} is no longer tried")
        return self._noted(self._begun, carried)

    def next(self, goals: Sequence[Fact], turn: StageTurn) -> Decision:
        """Return the next command to find out whether what seems one thing is several; nothing when nothing is left."""
        situation = turn.situation
        scope = feeling_scope(turn)
        felt = feel_rims(unfelt_rims(situation.cost_maps, scope), turn)
        if felt is not None:
            return felt
        meant = situation.named_by(goals)
        asked = things_in_question(situation.cost_maps, scope)
        moved = self._move_by_a_square([node for node in asked if node.stuck and node.name not in meant], turn)
        return moved or nothing_to_do("no thing is left to try")

    def _move_by_a_square(self, things: Sequence[Node], turn: StageTurn) -> Decision | None:
        """Return the next command to move one of some things by a square, each way once; None where none can be."""
        for node, number in product(things, range(len(EDGE_STEPS))):
            trial, (dx, dy) = (node.name, number), EDGE_STEPS[number]
            if trial in self._made:
                continue
            purpose = f"{node.name} did not move, and may move another way: "
            moved = bring_to_end(node, f"{TRIAL_TARGET}{number}", At(Pose(float(dx), float(dy), 0.0)), turn, purpose)
            if moved is not None:
                self._begun = trial
                return self._noted(trial, moved)
        return None

    def _noted(self, trial: Trial, decision: Decision) -> Decision:
        """Return a decision, and remember that the thing is pushed if it is."""
        if isinstance(decision.command, Push):
            self._made.add(trial)
        return decision
