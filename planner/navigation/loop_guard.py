"""Going round in circles: the same command in the same state of belief leads where it led before.

What a walk was to show it has not shown then, and whatever made it seem worth while will do so again. So the aim that
leads there gets dearer, until another one is chosen; what is chosen all the same is given up, until more is known.
"""

from collections import Counter
from collections.abc import Sequence
from dataclasses import astuple

import numpy as np

from kb.body import Command
from kb.mapping.occupancy import OPEN
from kb.world.model import WorldModel
from planner.navigation.subgoals import Subgoal
from planner.screen.sweeps import Square

WEARY = 25.0  # squares that an aim gets dearer each time
MOST = 4  # times that an aim may lead in circles before it is given up
DIGITS = 3  # of places and commands: what differs by less is the same
State = tuple[object, ...]


class LoopGuard:
    """Remembers what was done in which state of belief, and which squares were aimed at in vain."""

    def __init__(self) -> None:
        self._done: set[tuple[State, State]] = set()
        self._vain: Counter[Square] = Counter()  # of the lattice
        self._known: State = ()  # when they were

    def noticed(self, model: WorldModel, command: Command) -> bool:
        """Was this command given before when just as much was known? It is remembered that it is given now."""
        x, y = model.place
        told = tuple(round(v, DIGITS) if isinstance(v, float) else v for v in astuple(command))
        key = (round(x, DIGITS), round(y, DIGITS), model.held, _known(model)), (type(command).__name__, *told)
        again = key in self._done
        self._done.add(key)
        return again

    def tire(self, squares: frozenset[Square]) -> None:
        """An aim at these squares of the lattice led in circles."""
        self._vain.update(squares)

    def priced(self, subgoals: Sequence[Subgoal], model: WorldModel) -> list[Subgoal]:
        """The aims, dearer by what was aimed at in vain; without those that were so too often."""
        known = _known(model)
        if known != self._known:
            self._known = known
            self._vain.clear()
        if not self._vain:
            return list(subgoals)
        rows, columns = model.labels.shape
        vain = np.zeros((rows, columns), np.int64)
        for (x, y), times in self._vain.items():
            row, column = y - model.view.south, x - model.view.west
            if 0 <= row < rows and 0 <= column < columns:
                vain[row, column] = times
        found = []
        for subgoal in subgoals:
            times = int(vain.ravel()[subgoal.squares].max(initial=0))
            if times < MOST:
                found.append(subgoal._replace(price=subgoal.price + WEARY * times))
        return found


def _known(model: WorldModel) -> State:
    """What tells whether anything new is known: how much was seen and is settled, what stopped him, where loads lie."""
    settled = int((model.view.state != OPEN).sum())
    things = tuple(
        (node.name, node.stuck, node.patch.west, node.patch.south) for node in model.objects if node.moved or node.stuck
    )
    return int(model.view.seen.sum()), settled, len(model.barred), things
