"""From the world model to the next command: what is attained, what to aim at, which way, which move.

The plan is kept while it holds: its aim is still wanted, and the squares ahead are still believed free.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from kb.body import Command, Move
from kb.reconciliation import Reconciled, reconcile
from kb.rooms import rooms_of
from kb.task import Task
from kb.worldmodel import WorldModel
from planner import exploring
from planner.aims import Aim, choose
from planner.destinations import Destination, Situation, contains, destination
from planner.goals import Stage, stages
from planner.screen import Screens, grown
from planner.steps import Square, moves
from planner.ways import Finder, Way

LONGEST_LOOKING = 8  # squares of one move while something is looked for
LONGEST_KNOWN = 12  # squares of one move on the way to a known goal


@dataclass(frozen=True)
class Decision:
    """The next command and why; or no command, and the verdict."""

    command: Command | None
    why: str
    verdict: str = ""


@dataclass
class Decider:
    """Decides, and remembers what it decided."""

    task: Task
    paths: str
    rules: tuple[Path, ...] = ()

    def __post_init__(self) -> None:
        self.stages = stages(self.task)
        self.attained = 0
        self.bound: Mapping[str, str] = {}
        self._aimed: set[tuple[int, int]] = set()
        self._finder = Finder(self.paths)
        self._way: Way | None = None

    def decide(self, model: WorldModel) -> Decision:
        """What to do after an impression."""
        screens = Screens(model)
        reconciled = self._reconcile(model, screens)
        rooms = rooms_of(model)
        while self.attained < len(self.stages):
            stage = self.stages[self.attained]
            situation = Situation(model, screens, self.bound, rooms)
            where = [destination(goal, situation) for goal in stage.goals]
            if not all(not d.missing and contains(d.squares, model) for d in where):
                return self._pursue(stage, where, model, screens, reconciled)
            self.attained += 1
        return Decision(None, " and ".join(map(str, self.stages)) + " holds", "done")

    def _reconcile(self, model: WorldModel, screens: Screens) -> Reconciled:
        distances = {}
        for node in model.objects:
            reached = screens.nearest(np.flatnonzero(grown(model.mask(node.patch), 1)))
            if reached:
                distances[node.name] = reached.cost
        reconciled = reconcile(self.task, model, distances, self.bound, self.rules)
        self.bound = reconciled.binding
        return reconciled

    def _pursue(
        self, stage: Stage, where: list[Destination], model: WorldModel, screens: Screens, reconciled: Reconciled
    ) -> Decision:
        aims = self._aims(stage, where, model, screens, reconciled)
        aim = choose(aims, screens, self._last(model))
        if aim is None:
            missing = "; ".join(d.missing for d in where if d.missing) or "no way leads there"
            return Decision(None, f"{stage} cannot be attained: {missing}, and nothing is left to look at", "impossible")
        columns = model.labels.shape[1]
        self._aimed = {(int(s) % columns + model.view.west, int(s) // columns + model.view.south) for s in aim.squares}
        way = self._finder.way(screens, aim.squares)
        halts = moves(screens.free(way.level), way.squares)
        command = self._command(model, screens, way, halts, aim)
        return Decision(command, f"{aim.what}; {stage}")

    def _aims(
        self, stage: Stage, where: list[Destination], model: WorldModel, screens: Screens, reconciled: Reconciled
    ) -> list[Aim]:
        missing = [d for d in where if d.missing]
        if not missing:
            squares = where[0].squares
            for d in where[1:]:
                squares = np.intersect1d(squares, d.squares)
            return [Aim("attain", "the way to the goal is known", squares)]
        aims = [Aim("explore", look.what, look.squares) for d in missing for look in d.lookouts]
        special = bool(aims)
        for x, name in reconciled.doubtful:
            node = model.object(name)
            if x in reconciled.hypothesised and node is not None:
                touch = node.open == 0
                look = exploring.inspection(screens, node, touch)
                aims.append(Aim("inspect", f"{look.what}: it may be {x}", look.squares))
        if not special or not any(screens.nearest(aim.squares) and screens.nearest(aim.squares).level == 0 for aim in aims):
            aims += [Aim("explore", look.what, look.squares) for look in exploring.frontiers(screens)]
            aims += [Aim("explore", look.what, look.squares) for look in exploring.vague_places(screens)]
            aims += [Aim("explore", look.what, look.squares) for look in exploring.rooms_beyond(screens)]
        return aims

    def _last(self, model: WorldModel) -> frozenset[int]:
        rows, columns = model.labels.shape
        indices = set()
        for x, y in self._aimed:
            row, column = model.view.index(x, y)
            if 0 <= row < rows and 0 <= column < columns:
                indices.add(row * columns + column)
        return frozenset(indices)

    def _command(
        self, model: WorldModel, screens: Screens, way: Way, halts: list[Square], aim: Aim
    ) -> Command:
        """The first move: as far along the first straight piece as it is safe, and not too far without a look."""
        longest = LONGEST_KNOWN if aim.kind == "attain" else LONGEST_LOOKING
        here = halts[0]
        there = _shortened(screens, way, longest)
        x, y = model.view.west + there[0] + 0.5, model.view.south + there[1] + 0.5
        east, north = model.lattice.to_utak(x - model.place[0], y - model.place[1])
        return Move(_tidy(east), _tidy(north))


def _shortened(screens: Screens, way: Way, longest: int) -> Square:
    """The furthest square of the way that one clear move over safe squares reaches."""
    from planner.steps import clear

    safe = screens.safe
    here = way.squares[0]
    for there in reversed(way.squares[1:]):
        if max(abs(there[0] - here[0]), abs(there[1] - here[1])) <= longest and clear(safe, here, there):
            return there
    return way.squares[1]


def _tidy(length: float) -> float:
    return round(length, 9) + 0.0
