"""Subgoals: what is worth doing now, as facts with a cost, and the choice among them (planner/asp/aims.lp)."""

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from utak.kb.reasoning.solver import solve
from utak.planner.screen.projection import CostMaps, SquareIndices
from utak.planner.subgoal_kind import SubgoalKind

PLANNER_ASP = Path(__file__).resolve().parent.parent / "asp"  # the folder of the planner's encodings
TENTHS_PER_SQUARE = 10  # the encodings count lengths and costs in tenths of squares


class Subgoal(NamedTuple):
    """A place to go to, and the reason."""

    kind: str  # a SubgoalKind, or its value
    # Flat indices (row * columns + column) on the arrays of the view, (n,) int64; any of them will do
    squares: SquareIndices
    what: str  # the reason, in words
    chance: int = 100  # percent of belief that it leads to what is looked for
    price: float = 0.0  # squares of way that it costs besides the way there; negative for a bonus


def choose(subgoals: Sequence[Subgoal], cost_maps: CostMaps, last: frozenset[int]) -> Subgoal | None:
    """Choose the subgoal to pursue, by planner/asp/aims.lp; None when none can be reached."""
    facts = []
    for number, subgoal in enumerate(subgoals):
        reached = cost_maps.nearest(subgoal.squares) if len(subgoal.squares) else None
        if reached is not None:
            assumed = reached.level and subgoal.kind == SubgoalKind.EXPLORE
            kind = SubgoalKind.PASS if assumed else SubgoalKind(subgoal.kind)
            besides = round(TENTHS_PER_SQUARE * subgoal.price)
            # Both add up to the rounded whole, so that telling them apart changes no choice.
            way = round(TENTHS_PER_SQUARE * (reached.cost + subgoal.price)) - besides
            facts.append(f"aim({number},{kind},{way})")
            facts += [f"besides({number},{besides})"] * bool(besides)
            facts.append(f"chance({number},{subgoal.chance})")
            facts += [f"last({number})"] * bool(last and not last.isdisjoint(subgoal.squares.tolist()))
    about = [subgoal.what for subgoal in subgoals]
    answer = solve([PLANNER_ASP / "aims.lp"], facts, about=about) if facts else None
    return subgoals[answer[0].arguments[0].number] if answer else None
