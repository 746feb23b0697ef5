"""Subgoals: what is worth doing now, as facts with a cost, and the choice among them (planner/asp/aims.lp)."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from utak.geometry.kernels.arrays import Square
from utak.kb.reasoning.solver import solve
from utak.kb.reasoning.user_rules import rules_to_blame
from utak.kb.world.model import WorldModel, hundredths
from utak.kb.world.rooms import Rooms
from utak.planner.screen.projection import CostMaps, SquareIndices
from utak.planner.subgoal_kind import SubgoalKind

PLANNER_ASP = Path(__file__).resolve().parent.parent / "asp"  # the folder of the planner's encodings
AIMS_ENCODING = PLANNER_ASP / "aims.lp"
TENTHS_PER_SQUARE = 10  # the encodings count lengths and costs in tenths of squares


class Subgoal(NamedTuple):
    """A place to go to, and the reason."""

    kind: str  # a SubgoalKind, or its value
    # Flat indices (row * columns + column) on the arrays of the view, (n,) int64; any of them will do
    squares: SquareIndices
    what: str  # the reason, in words
    chance: int = 100  # percent of belief that it leads to what is looked for
    price: float = 0.0  # squares of way that it costs besides the way there; negative for a bonus


class AimRules(NamedTuple):
    """The users' rules about subgoals, and what they read besides."""

    files: tuple[Path, ...]  # the users' rule files
    world: tuple[str, ...]  # the facts of the world model that they name
    rooms: Rooms  # the rooms of the floor


class NoSubgoal(NamedTuple):
    """No subgoal can be pursued."""

    rules: tuple[str, ...] = ()  # the rules of users because of which, as `rules.lp:3`; () where none can be reached


def choose(
    subgoals: Sequence[Subgoal], cost_maps: CostMaps, last: frozenset[int], rules: AimRules | None = None
) -> Subgoal | NoSubgoal:
    """Choose the subgoal to pursue, by planner/asp/aims.lp."""
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
            if rules is not None:
                there = cost_maps.nearest_at(reached.level, subgoal.squares)
                facts += _facts_for_rules(number, there, cost_maps.model, rules)
    if not facts:
        return NoSubgoal()
    files, world = ((), ()) if rules is None else (rules.files, rules.world)
    about, given = [subgoal.what for subgoal in subgoals], [*facts, *world]
    answer = solve([AIMS_ENCODING, *files], given, about=about)
    if not answer:
        return NoSubgoal(rules_to_blame(AIMS_ENCODING, files, given, lambda atoms: not atoms))
    return subgoals[answer[0].arguments[0].number]


def _facts_for_rules(number: int, place: Square, model: WorldModel, rules: AimRules) -> Iterator[str]:
    """Yield what users' rules alone ask of a subgoal: where it leads, and what lies beside that."""
    column, row = place
    east, north = model.place_to_utak(column + 0.5, row + 0.5)
    yield f"point({number},{hundredths(east)},{hundredths(north)})"
    room = int(rules.rooms.labels[row, column])
    yield from [f"in_room({number},r{room})"] * (room > 0)
    near = np.s_[max(row - 1, 0) : row + 2, max(column - 1, 0) : column + 2]
    yield from (f"beside({number},{node.name})" for node in model.objects if model.mask(node.patch)[near].any())
