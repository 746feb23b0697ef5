"""Loop detection: the same command in the same state of belief leads where it led before.

Then the walk has not shown what it was made for, and the robot would make it again. The subgoal is given up until more
is known (planner/asp/deciding/subgoals.lp).
"""

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
        self._vain: set[Square] = set()  # squares of the subgoals that led in a loop, map frame
        self._known: StateKey = ()  # the state of knowledge in which they did

    def noticed(self, model: WorldModel, command: Command) -> bool:
        """Return whether a command was given before at this place with the same knowledge, and remember it."""
        x, y = model.place
        values = tuple(round(v, STATE_DIGITS) if isinstance(v, float) else v for v in astuple(command))
        state = (round(x, STATE_DIGITS), round(y, STATE_DIGITS), model.held, _knowledge(model))
        key = state, (type(command).__name__, *values)
        again = key in self._given
        self._given.add(key)
        return again

    def give_up(self, subgoal: Subgoal, model: WorldModel) -> None:
        """Note that a subgoal led in a loop."""
        self._vain |= to_map_squares(subgoal.squares, model)

    def told(self, subgoals: Sequence[Subgoal], model: WorldModel) -> list[Subgoal]:
        """Return the subgoals, each with whether it led in a loop, as far as what is known is the same."""
        known = _knowledge(model)
        if known != self._known:
            self._known = known
            self._vain.clear()
        if not self._vain:
            return list(subgoals)
        return [one._replace(in_vain=not self._vain.isdisjoint(to_map_squares(one.squares, model))) for one in subgoals]


def _knowledge(model: WorldModel) -> StateKey:
    """Return what changes when something new is known, as a tuple to be compared."""
    settled = int((model.view.state != OPEN).sum())
    things = tuple(
        (node.name, node.stuck, node.patch.west, node.patch.south) for node in model.objects if node.moved or node.stuck
    )
    return int(model.view.seen.sum()), settled, len(model.barred), things
