"""Subgoals: what is worth doing now, as facts with a cost, and the choice among them (planner/asp/deciding)."""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from utak.geometry.kernels.arrays import Square
from utak.kb.world.model import WorldModel, hundredths
from utak.kb.world.rooms import Rooms
from utak.planner.question import Question, argument
from utak.planner.screen.projection import CostMaps, SquareIndices
from utak.planner.subgoal_kind import SubgoalKind

TENTHS_PER_SQUARE = 10  # subgoals have lengths and costs in tenths of squares
PLACE_PREDICATES = (("point", 3), ("goes_to", 2), ("beside", 2))  # where subgoals lead: users' rules alone ask for that


class Subgoal(NamedTuple):
    """A place to go to, and the reason."""

    kind: str  # a SubgoalKind, or its value
    # Flat indices (row * columns + column) on the arrays of the view, (n,) int64; any of them will do
    squares: SquareIndices
    what: str  # the reason, in words
    chance: int = 100  # percent of belief that it leads to what is looked for
    in_vain: bool = False  # whether it led to the same command in the same state of belief
    price: float = 0.0  # squares of way that it costs besides the way there; negative for a bonus
    felt: tuple[str, ...] = ()  # of a halt to feel walls: the moves there, and where things may begin, as arguments


class Chosen(NamedTuple):
    """The subgoal that is pursued."""

    subgoal: Subgoal
    question: Question  # what was given, with the choice kept


class NoSubgoal(NamedTuple):
    """No subgoal can be pursued."""

    rules: tuple[str, ...] = ()  # the rules of users because of which, as `rules.lp:3`; () where none can be reached


def choose(
    subgoals: Sequence[Subgoal], cost_maps: CostMaps, last: frozenset[int], question: Question, rooms: Rooms
) -> Chosen | NoSubgoal:
    """Choose the subgoal to pursue, by planner/asp/deciding."""
    facts, first = list[str](), len(question.about)
    places = question.speaks_of(PLACE_PREDICATES)
    for number, subgoal in enumerate(subgoals, first):
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
            facts += [f"in_vain({number})"] * subgoal.in_vain
            facts += [f"last({number})"] * bool(last and not last.isdisjoint(subgoal.squares.tolist()))
            if subgoal.felt:
                moves, *told = subgoal.felt
                facts += [f"halt({number},{way},{moves})", *(f"tells({number},{one})" for one in told)]
            if places:
                there = cost_maps.nearest_at(reached.level, subgoal.squares)
                facts += _place_facts(number, there, cost_maps.model, rooms)
    if not facts:
        return NoSubgoal()
    given = question.adding(facts, (subgoal.what for subgoal in subgoals))
    chosen = argument(given.answer("subgoals") or (), "choose")
    if chosen is None:
        return NoSubgoal(given.blamed(lambda atoms: argument(atoms, "choose") is None))
    return Chosen(subgoals[chosen.number - first], given.keeping(f"choose({chosen})"))


def _place_facts(number: int, place: Square, model: WorldModel, rooms: Rooms) -> Iterator[str]:
    """Yield where a subgoal leads, and what lies beside that."""
    column, row = place
    east, north = model.place_to_utak(column + 0.5, row + 0.5)
    yield f"point({number},{hundredths(east)},{hundredths(north)})"
    room = int(rooms.labels[row, column])
    yield from [f"goes_to({number},r{room})"] * (room > 0)
    near = np.s_[max(row - 1, 0) : row + 2, max(column - 1, 0) : column + 2]
    yield from (f"beside({number},{node.name})" for node in model.objects if model.mask(node.patch)[near].any())
