"""Navigation among movable obstacles (NAMO, Stilman and Kuffner 2005): what blocks the robot is moved aside.

It is asked only when nothing else is left to do, for an object that was moved no longer is where it was meant to be.
"""

from collections.abc import Iterable, Sequence

from utak.geometry.manipulation.goals import End
from utak.kb.language.terms import Fact
from utak.kb.world.model import Node
from utak.planner.deciding.bringing import ASIDE_TARGET, another_way, bring_to_end, carry_on
from utak.planner.deciding.feeling import Passages, feel_rim, feel_walls, feeling_scope, walls_to_feel
from utak.planner.deciding.obstacles import Obstacle, before_walls, hidden_in_walls, obstacles
from utak.planner.deciding.stage_turn import StageTurn
from utak.planner.decision import Decision, TaskVerdict, nothing_to_do
from utak.planner.goals.embedded import Supposition, suppose
from utak.planner.goals.placement import POSSIBLE_OBJECT
from utak.planner.sights.walls import is_ringed
from utak.planner.situation import Situation


class ObstacleClearer:
    """Moves obstacles out of the robot's way, and remembers which one it is moving and what must stay meanwhile."""

    def __init__(self) -> None:
        """Make a clearer that is moving nothing."""
        self._moving = ""
        self._supposed: Supposition | None = None  # how the object that is being moved is supposed to lie in a wall
        self._stays: frozenset[str] = frozenset()  # what the goals speak of that were asked about last
        self._passages = Passages()
        self._feeling = False  # whether the robot is feeling walls, because nothing else was left to do

    def is_moving(self, _situation: Situation) -> bool:
        """Return whether an obstacle is being moved aside."""
        return bool(self._moving)

    def is_feeling(self, situation: Situation) -> bool:
        """Return whether the robot is feeling walls, because nothing else was left to do."""
        self._feeling &= situation.model.held is None  # what is in hand was led out instead: goals are asked about anew
        return self._feeling

    def clear_on(self, turn: StageTurn) -> Decision:
        """Return the next command for the obstacle that is being moved; nothing when it blocks no longer."""
        # Nothing, too, when its command would close a loop: then it is no longer being moved.
        node, held = turn.situation.model.object(self._moving), turn.situation.model.held
        decided = nothing_to_do(f"{self._moving} is no longer moved aside")
        if node is not None and held == node.name:
            last = self._supposed
            again = None if last is None else suppose(node, last.side, last.depth, turn.situation)
            decided = carry_on(node, turn if again is None else turn.within(again.situation))
        serves = held in (None, self._moving) or turn.executor.serves(self._moving)  # what is in its way, too
        if node is not None and serves:
            decided = decided or self._move_first(self._movable(turn.situation), turn, node.name)
            decided = decided or another_way(node, turn)
        if not decided:
            self._moving = ""
        return decided

    def feel_on(self, turn: StageTurn) -> Decision:
        """Return the next command to clear what was found in a wall, or to feel on; nothing when nothing is left."""
        found = self._pull(turn)
        felt = found or feel_walls(turn)
        self._feeling = bool(felt) and not found
        return felt

    def clear(self, goals: Sequence[Fact], turn: StageTurn) -> Decision:
        """Return the next command to move aside what blocks the robot's way."""
        self._stays = turn.situation.named_by(goals)
        ringed = is_ringed(turn.situation.model, turn.situation.cost_maps.floor)
        passed = self._passages.next(turn) if ringed else None
        return passed or self._move_first(self._movable(turn.situation), turn)

    def pull(self, goals: Sequence[Fact], turn: StageTurn) -> Decision:
        """Return the next command to move what may go on in a wall, as far as that was seen."""
        self._stays = turn.situation.named_by(goals)
        return self._pull(turn)

    def feel(self, goals: Sequence[Fact], turn: StageTurn) -> Decision:
        """Return the next command to feel walls that may be things; nothing when none is left that can be reached."""
        self._stays = turn.situation.named_by(goals)
        felt = feel_walls(turn)
        self._feeling |= bool(felt)
        return felt if felt or feeling_scope(turn).parting else self._passages.next(turn)

    def bare(self, goals: Sequence[Fact], turn: StageTurn) -> Decision:
        """Return the next command to move away what stands before walls that were never felt; nothing for none."""
        self._stays = turn.situation.named_by(goals)
        self._stays -= {node.name for node in turn.situation.model.objects if node.moved}  # it was put there by chance
        return self._move_first_of(
            before_walls(self._movable(turn.situation), turn.situation, walls_to_feel(turn)), turn
        )

    def blame(self, situation: Situation) -> Decision:
        """Return the verdict `limit` with the objects that block the robot's way still; nothing when there is none."""
        things = [node for node in situation.model.objects if node.confidence >= POSSIBLE_OBJECT]
        blocking = [
            f"{one.node.name} blocks the robot's way, and {_how_often_tried(one.node)}"
            for one in obstacles(things, situation)
        ]
        if not blocking:
            return nothing_to_do("no object blocks the robot's way")
        return Decision(None, "; ".join(dict.fromkeys(blocking)), TaskVerdict.LIMIT)

    def _pull(self, turn: StageTurn) -> Decision:
        """Return the next command to move what may go on in a wall; nothing for no such thing."""
        parting = feeling_scope(turn).parting
        found = self._move_first_of(hidden_in_walls(self._movable(turn.situation), turn.situation, parting), turn)
        return found or nothing_to_do("nothing that may go on in a wall can be moved")

    def _movable(self, situation: Situation) -> list[Node]:
        """Return the objects that may be moved aside, in the order of the model; [] for none."""
        # Only those that are objects with at least POSSIBLE_OBJECT percent, not known to be immovable, and need not
        # stay.
        things = (node for node in situation.model.objects if node.movable > 0 and node.confidence >= POSSIBLE_OBJECT)
        return [node for node in things if node.name not in self._stays]

    def _move_first(self, things: Sequence[Node], turn: StageTurn, name: str = "") -> Decision:
        """Return the next command to move aside the first object that blocks, and remember which it is."""
        parting = feeling_scope(turn).parting
        found = obstacles(things, turn.situation, walls_to_feel(turn), parting)
        return self._move_first_of((one for one in found if name in ("", one.node.name)), turn)

    def _move_first_of(self, found: Iterable[Obstacle], turn: StageTurn) -> Decision:
        """Return the next command to move aside the first obstacle that can be, and remember it; nothing for none."""
        for one in found:
            if instead := _move_aside(one.node, one.aside, turn.within(one.situation)):
                self._moving, self._supposed = one.node.name, one.supposed
                return instead
        return nothing_to_do("nothing that blocks the robot's way can be moved aside")


def _how_often_tried(node: Node) -> str:
    """Return in words in how many ways an object was moved in vain, last of all."""
    ways = len(set(node.resisted))
    return (
        f"did not move in {ways} way{'s' * (ways > 1)} that {'were' if ways > 1 else 'was'} tried"
        if ways
        else "was not moved aside"
    )


def _move_aside(node: Node, aside: End, turn: StageTurn) -> Decision:
    """Return the next command to move an object aside, or to find out what it is; nothing when there is none."""
    purpose = f"{node.name} blocks the robot's way: "
    return feel_rim(node, turn) or bring_to_end(node, {ASIDE_TARGET: aside}, turn, purpose)
