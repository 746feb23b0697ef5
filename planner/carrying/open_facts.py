"""Open facts that may overturn the verdict that a goal cannot be attained, and what geometry finds if they are so.

`impossible` is claimed only of what holds under every completion of what is open. A wall that was only seen may be a
thing that can be moved; the floor may go on where nothing was seen; a thing that was never moved may be more than one
thing; an opening that fills no whole square looks like wall; a thing that others moved lies somewhere. While one of
these is open, planner/asp/deciding chooses the fewest with which a plan may exist, and derives the verdict.
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import islice

import numpy as np

from utak.geometry.kernels.arrays import XY, Bools, Square
from utak.geometry.raster.components import with_edge_neighbours
from utak.kb.task.stretches import MAX_THICK_WALL
from utak.kb.world.model import WorldModel
from utak.planner.decision import Decision
from utak.planner.screen.moves import orientation_is_settled
from utak.planner.sights.things import things_in_question
from utak.planner.sights.walls import (
    ALL_WALLS,
    EDGE_STEPS,
    MAX_NICHE_WIDTH,
    FeelingScope,
    floor_apart,
    walls_in_question,
)
from utak.planner.situation import Situation

# Questions to geometry: by so many the first refutation is widened, and each later one by twice as many as were asked
# before (mostly the first open fact that helps does so alone); and after so many none is. Bounds on time.
FIRST_QUESTIONS, ALL_QUESTIONS = 16, 1024
NOTHING_LEFT = "nothing is left to look at"  # a fact that proofs name: all floor that can be reached was seen


@dataclass(frozen=True, eq=False)
class OpenFact:
    """Something that is not settled, and may allow another plan."""

    kind: str  # as planner/asp/deciding names it
    words: str  # a clause without full stop
    # (rows, columns) bool on the arrays of the view, the squares that may be free if it is so; None where that is not
    # known
    opens: Bools | None = None
    far: float = 0.0  # squares from what the verdict is about; 0 where that is not known


# Whether a plan may exist if some squares, (rows, columns) bool, are free. More free squares never allow less.
PlanExists = Callable[[Bools], bool]


class OpenQuestion:
    """Whether open facts overturn a verdict: planner/asp/deciding chooses which are supposed, geometry answers."""

    def __init__(self, facts: Iterable[OpenFact], plan_exists: PlanExists) -> None:
        """Make a question that was not asked yet."""
        self.facts = {f"f{number}": fact for number, fact in enumerate(facts, 1)}
        self._plan_exists = plan_exists
        self._asked = self._most = 0  # questions that geometry was asked, and that it is asked before widening ends

    def in_words(self, names: Sequence[str]) -> str:
        """Return some open facts in words, a clause without full stop; the first one where none is named."""
        return " and ".join(self.facts[name].words for name in names or [*self.facts][:1])

    def answer(self, supposed: Sequence[str]) -> list[str]:
        """Return what geometry finds if some facts are so, each with known squares, as facts for the agenda.

        These are that a plan may exist; or that there is none, even if all others are so but those that it leaves out.
        One of these is needed; as long as no bound on questions is reached, each would allow a plan then, or nothing
        tells which squares it frees.
        """
        if self._allow(supposed):
            return [f"plan_with({name})" for name in supposed]
        self._most = min(ALL_QUESTIONS, max(FIRST_QUESTIONS, 3 * self._asked))
        others = [name for name, fact in self.facts.items() if fact.opens is not None and name not in supposed]
        left_out = self.facts.keys() - self._widened(supposed, others)
        return [f"refutes(a{self._asked})", *(f"left_out(a{self._asked},{name})" for name in sorted(left_out))]

    def _widened(self, refuted: Sequence[str], others: Sequence[str]) -> Sequence[str]:
        """Return facts with which there is no plan: some with as many others as may be, found by halves."""
        if not others or self._asked >= self._most:
            return refuted
        if not self._allow([*refuted, *others]):
            return [*refuted, *others]
        half = len(others) // 2
        return self._widened(self._widened(refuted, others[:half]), others[half:]) if half else refuted

    def _allow(self, names: Sequence[str]) -> bool:
        """Return whether a plan may exist if some facts are so, each with known squares."""
        self._asked += 1
        opened = (mask for name in names if (mask := self.facts[name].opens) is not None)
        return self._plan_exists(np.any(list(opened), axis=0))


def proof_if_not_found(model: WorldModel, immovable: bool = False) -> tuple[str, ...]:
    """Return what proves, when everything was looked at, that no object fits a parameter of the task."""
    # () for nothing.
    proved = model.view.sure and orientation_is_settled(model) if immovable else not model.shaken
    fact = "what fits did not move when it was pushed" if immovable else "nothing that was seen fits"
    return (fact, NOTHING_LEFT) if proved and not model.missing else ()


def open_facts(decision: Decision, situation: Situation, scope: FeelingScope = ALL_WALLS) -> Iterator[OpenFact]:
    """Yield the open facts that may overturn a verdict: the one that it names, or all that may allow another plan."""
    if decision.unless:
        yield OpenFact("stated", decision.unless)
        return
    model, reached = situation.model, situation.cost_maps.floor
    near = decision.near or model.place_on_view
    for name in model.missing:
        yield OpenFact("gone", f"{name}, which is no longer where it lay, lies where the robot has not looked since")
    walls = np.any(list(walls_in_question(model, reached, scope).values()), axis=0)
    for square, where, far in _by_distance(walls, near):
        words = f"the wall at {model.point_in_words(where)}, which was never felt, is a thing that can be moved"
        yield OpenFact("wall", words, _filled(square, model.space), far)
    unseen = with_edge_neighbours(model.space & reached) & ~model.view.seen
    hidden = np.zeros_like(walls) if scope.parting else floor_apart(model, reached)
    for kind, mask, words, opens in (
        ("unseen", unseen, "the floor goes on at {}, which was never seen", ~model.view.seen),
        ("passage", hidden, "a passage that fills no whole square leads to the floor at {}", ~model.space),
    ):  # of those that would free the same squares the nearest one stands for all
        for _, where, far in islice(_by_distance(mask, near), 1):
            yield OpenFact(kind, words.format(model.point_in_words(where)), opens, far)
    for node in things_in_question(situation.cost_maps, scope):
        seen = "was not seen to move as one thing" if node.moved else "was never moved"
        yield OpenFact("parts", f"{node.name}, which {seen}, is more than one thing")


def _by_distance(mask: Bools, near: XY) -> Iterator[tuple[Square, XY, float]]:
    """Yield the marked squares (column, row), their middles (x, y) and distances to a place, the nearest first."""
    rows, columns = np.nonzero(mask)
    far = np.hypot(columns + 0.5 - near[0], rows + 0.5 - near[1])
    for n in np.argsort(far, kind="stable").tolist():
        column, row = int(columns[n]), int(rows[n])
        yield (column, row), (column + 0.5, row + 0.5), float(far[n])


def _filled(square: Square, space: Bools) -> Bools:
    """Return the squares that are no floor on which a thing may stand that fills a doorway at one (column, row)."""
    (column, row), mask, wide = square, np.zeros_like(space), MAX_NICHE_WIDTH // 2
    floor = np.pad(space, 1)
    for east, north in EDGE_STEPS:  # into the wall, from floor before it
        if floor[row + 1 - north, column + 1 - east]:
            (west, far_east), (south, far_north) = (
                sorted((0, MAX_THICK_WALL * step)) if step else (-wide, wide) for step in (east, north)
            )
            mask[max(row + south, 0) : row + far_north + 1, max(column + west, 0) : column + far_east + 1] = True
    return mask & ~space
