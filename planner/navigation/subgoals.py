"""Subgoals: what is worth doing now, as facts with a cost, and the choice among them (planner/asp/aims.lp)."""

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from kb.reasoning.solver import solve
from planner.screen.projection import CostMaps, SquareIndices
from planner.subgoal_kind import SubgoalKind

PLANNER_ASP = Path(__file__).resolve().parent.parent / "asp"  # the folder of the planner's encodings
TENTHS_PER_SQUARE = 10  # the encodings count lengths and costs in tenths of squares


class Subgoal(NamedTuple):
    """A place to go to, and the reason.

    Attributes
    ----------
    kind : a SubgoalKind, or its value.
    squares : flat indices (row * columns + column) on the arrays of the view, (n,) int64; any of them will do.
    what : the reason, in words.
    chance : percent of belief that it leads to what is looked for.
    price : squares of way that it costs besides the way there; negative for a bonus.
    """

    kind: str
    squares: SquareIndices
    what: str
    chance: int = 100
    price: float = 0.0


def choose(subgoals: Sequence[Subgoal], cost_maps: CostMaps, last: frozenset[int]) -> Subgoal | None:
    """Choose the subgoal to pursue, by planner/asp/aims.lp; None when none can be reached.

    The facts for the encoding, each a string without a full stop, for each subgoal that can be reached, numbered from
    0: `aim(number, kind, cost)` in tenths of squares, `chance(number, percent)`, and `last(number)` for one that
    continues the last one. One of kind ATTAIN comes before all others; then the least cost divided by the chance, plus
    three squares for a switch to another subgoal; of equals the first. The cost is that of the way plus the price, with
    an extra cost for some kinds.

    Parameters
    ----------
    last : the squares (flat indices on the arrays of this view) of the subgoal chosen last time; empty for none. A
        subgoal that shares one of them continues it.
    """
    facts = []
    for number, subgoal in enumerate(subgoals):
        reached = cost_maps.nearest(subgoal.squares) if len(subgoal.squares) else None
        if reached is not None:
            assumed = reached.level and subgoal.kind == SubgoalKind.EXPLORE
            kind = SubgoalKind.PASS if assumed else SubgoalKind(subgoal.kind)
            facts.append(f"aim({number},{kind},{round(TENTHS_PER_SQUARE * (reached.cost + subgoal.price))})")
            facts.append(f"chance({number},{subgoal.chance})")
            facts += [f"last({number})"] * bool(last and not last.isdisjoint(subgoal.squares.tolist()))
    about = [subgoal.what for subgoal in subgoals]
    answer = solve([PLANNER_ASP / "aims.lp"], facts, about=about) if facts else None
    return subgoals[answer[0].arguments[0].number] if answer else None
