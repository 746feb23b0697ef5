"""Loop detection: the same command in the same state of belief leads where it led before.

Then the walk has not shown what it was made for, and the robot would make it again. It is counted how often that was so
for a subgoal, until more is known; planner/asp/deciding/subgoals.lp says what follows.
"""

from collections import Counter
from collections.abc import Sequence
from dataclasses import astuple

from utak.geometry.kernels.arrays import Square
from utak.kb.body import Command
from utak.kb.mapping.occupancy import OPEN
from utak.kb.world.model import WorldModel
from utak.planner.navigation.sticky_route import to_map_squares
from utak.planner.navigation.subgoals import Subgoal

STATE_DIGITS = 3  # decimals of places and commands, in squares or degrees; smaller differences count as none
StateKey = tuple[object, ...]


class LoopGuard:
    """Remembers which command was given in which state of belief, and which subgoals led in a loop."""

    def __init__(self) -> None:
        """Remember no command and no loop yet."""
        self._given: set[tuple[StateKey, StateKey]] = set()
        self._loops: Counter[Square] = Counter()  # by square of a subgoal, map frame
        self._known: StateKey = ()  # the state of knowledge in which the loops were counted

    def noticed(self, model: WorldModel, command: Command) -> bool:
        """Return whether a command was given before at this place with the same knowledge, and remember it."""
        x, y = model.place
        values = tuple(round(v, STATE_DIGITS) if isinstance(v, float) else v for v in astuple(command))
        state = (round(x, STATE_DIGITS), round(y, STATE_DIGITS), model.held, _knowledge(model))
        key = state, (type(command).__name__, *values)
        again = key in self._given
        self._given.add(key)
        return again

    def tire(self, squares: frozenset[Square]) -> None:
        """Count one more loop for a subgoal with these squares (x, y) of the map frame."""
        self._loops.update(squares)

    def counted(self, subgoals: Sequence[Subgoal], model: WorldModel) -> list[Subgoal]:
        """Return the subgoals, each with how often it led in a loop, as far as what is known is the same."""
        known = _knowledge(model)
        if known != self._known:
            self._known = known
            self._loops.clear()
        if not self._loops:
            return list(subgoals)
        squares = (to_map_squares(subgoal.squares, model) for subgoal in subgoals)
        times = [max((self._loops[square] for square in there), default=0) for there in squares]
        return [one._replace(in_vain=often) for one, often in zip(subgoals, times, strict=True)]


def _knowledge(model: WorldModel) -> StateKey:
    """Return what changes when something new is known, as a tuple to be compared."""
    settled = int((model.view.state != OPEN).sum())
    things = tuple(
        (node.name, node.stuck, node.patch.west, node.patch.south) for node in model.objects if node.moved or node.stuck
    )
    return int(model.view.seen.sum()), settled, len(model.barred), things
