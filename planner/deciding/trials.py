"""Trials: what seems one thing may be several that touch, and what did not move one way may move another way."""

from collections.abc import Sequence

from utak.geometry.manipulation.goals import At
from utak.geometry.motion.se2 import Pose
from utak.kb.language.terms import Fact
from utak.kb.objects.movability import square_ways
from utak.planner.deciding.bringing import another_way, bring_to_end, carry_on
from utak.planner.deciding.feeling import feel_rims, feeling_scope, walls_to_feel
from utak.planner.deciding.stage_turn import StageTurn
from utak.planner.decision import Decision, nothing_to_do
from utak.planner.sights.things import things_in_question, unfelt_rims
from utak.planner.situation import Situation


class Trials:
    """Finds out whether what seems one thing is several, and remembers which thing is moved for that."""

    def __init__(self) -> None:
        """Make one that moves nothing."""
        self._moving = ""

    def is_pushing(self, situation: Situation) -> bool:
        """Return whether a thing is in hand that is to be moved, to see whether it moves another way."""
        return bool(self._moving) and situation.model.held == self._moving

    def go_on(self, turn: StageTurn) -> Decision:
        """Return the next command for the thing in hand that is moved by a square; nothing when that is done."""
        node = turn.situation.model.object(self._moving)
        carried = None if node is None else carry_on(node, turn) or another_way(node, turn)
        if carried is None:
            gone, self._moving = self._moving, ""
            return nothing_to_do(f"{gone} is no longer tried")
        return carried

    def next(self, goals: Sequence[Fact], turn: StageTurn) -> Decision:
        """Return the next command to find out whether what seems one thing is several; nothing when nothing is left."""
        situation, scope = turn.situation, feeling_scope(turn)
        felt = feel_rims(unfelt_rims(situation.cost_maps, scope), turn)
        if felt is not None:
            return felt
        # While walls are left that were never felt, the verdict rests on these.
        several = [] if walls_to_feel(turn).any() else things_in_question(situation.cost_maps, scope)
        meant = situation.named_by(goals)
        ways = {way: At(Pose(float(x), float(y), 0.0)) for way, (x, y) in square_ways(situation.model.frame).items()}
        for node in situation.model.objects:
            moved = None if node.name in meant else another_way(node, turn)
            if node in several and node.name not in situation.binding.values() and not (node.moved or node.resisted):
                moved = bring_to_end(node, ways, turn)  # by a square: it is seen to be one thing, or to be several
            if moved is not None:
                self._moving = node.name
                return moved
        return nothing_to_do("no thing is left to try")
