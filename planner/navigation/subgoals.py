"""What is worth doing now, as facts with a price, and the choice among them (planner/asp/aims.lp)."""

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from kb.reasoning.solver import solve
from planner.screen.projection import CostMaps, Squares

ASP = Path(__file__).resolve().parent.parent / "asp"


class Subgoal(NamedTuple):
    """Somewhere to go and why.

    kind : attain, inspect, explore, pass or settle (planner/asp/aims.lp).
    squares : flat indices of the screen, any of which will do. what : the reason in words.
    chance : percent of belief that it leads to what is looked for. price : squares that it costs besides the way.
    """

    kind: str
    squares: Squares
    what: str
    chance: int = 100
    price: float = 0.0


def choose(subgoals: Sequence[Subgoal], cost_maps: CostMaps, last: frozenset[int]) -> Subgoal | None:
    """The aim to pursue, or None when none can be reached.

    last: the squares (flat indices of this screen) of the aim chosen last time; an aim that shares one with it
    continues it.
    """
    facts = []
    for number, subgoal in enumerate(subgoals):
        reached = cost_maps.nearest(subgoal.squares) if len(subgoal.squares) else None
        if reached is not None:
            kind = "pass" if reached.level and subgoal.kind == "explore" else subgoal.kind
            facts.append(f"aim({number},{kind},{round(10 * (reached.cost + subgoal.price))})")
            facts.append(f"chance({number},{subgoal.chance})")
            facts += [f"last({number})"] * bool(last and not last.isdisjoint(subgoal.squares.tolist()))
    answer = solve([ASP / "aims.lp"], facts) if facts else None
    return subgoals[answer[0].arguments[0].number] if answer else None
