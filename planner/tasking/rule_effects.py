"""The effects of users' rules on a task plan: doors that they close to every plan, and rules that leave no plan."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from geometry.kernels.arrays import XY
from kb.reasoning.solver import solve
from kb.reasoning.user_rules import rules_reach, rules_to_blame
from kb.tracing.decisions import record_decisions
from planner.situation import Situation
from planner.tasking.proposal import TASK_ENCODING
from planner.tasking.search import MadePlan

SAME_DOOR = 1.5  # squares between the middles of what is one door, as it was and as it is believed now; a convention


@dataclass(frozen=True)
class RuleEffects:
    """The effects of users' rules on a plan.

    Attributes
    ----------
    closed : the middles (x, y) of doors that no plan passes, in squares, map frame.
    blamed : the places of rules because of which the plan does not attain all goals, such as `rules.lp:3`.
    """

    closed: tuple[XY, ...] = ()
    blamed: tuple[str, ...] = ()

    def names_of_closed(self, situation: Situation) -> frozenset[str]:
        """Return the names that the closed doors bear now."""
        return doors_at(self.closed, situation)


def doors_at(middles: Sequence[XY], situation: Situation) -> frozenset[str]:
    """Return the names that doors at some places bear now.

    middles : the middles (x, y) of the doors as they were, in squares, map frame.
    """
    view = situation.model.view
    places = [(x - view.west, y - view.south) for x, y in middles]
    doors = situation.rooms.doors
    return frozenset(door.name for door in doors if any(math.dist(door.place, place) <= SAME_DOOR for place in places))


def doors_led_round(made: MadePlan, situation: Situation) -> tuple[tuple[XY, ...], ...]:
    """Return the doors that each errand of a plan does not pass; () when no users' rule is about task plans.

    Rules may give doors a price, or forbid them for some errands. Then the way of an errand is that of the plan.

    For each errand the middles (x, y) of such doors, in squares, map frame.

    made : the plan, with the facts from which it was made.
    """
    if not rules_reach(TASK_ENCODING.stem, situation.rules):
        return ()
    doors = _doors_of(made, situation)
    return tuple(
        tuple(middle for name, middle in doors.items() if name not in errand.doors) for errand in made.plan.errands
    )


def _doors_of(made: MadePlan, situation: Situation) -> dict[str, XY]:
    """Return the middles (x, y) of the doors that a plan knows, by name, in squares, map frame."""
    view = situation.model.view
    return {
        door.name: (door.place[0] + view.west, door.place[1] + view.south)
        for door in situation.rooms.doors
        if any(fact.startswith(f"connects({door.name},") for fact in made.facts)
    }


def effects_of_rules(made: MadePlan, situation: Situation) -> RuleEffects:
    """Return what users' rules did to a plan; nothing when none of them is about task plans.

    made : the plan, with the facts from which it was made.
    """
    rules = situation.rules
    if not made.facts or not rules_reach(TASK_ENCODING.stem, rules):
        return RuleEffects()
    closed = []
    for name, middle in _doors_of(made, situation).items():
        with record_decisions():  # a question about the plan, not a decision
            answer = solve([TASK_ENCODING, *rules], (*made.facts, f"asked({name})"))
        if answer and any(atom.name == "closed" for atom in answer):
            closed.append(middle)
    blamed = rules_to_blame(TASK_ENCODING, rules, made.facts, _leaves_goals) if made.plan.unmet else ()
    return RuleEffects(tuple(closed), blamed)


def _leaves_goals(atoms: object) -> bool:
    """Return whether a plan, given by the shown atoms, does not attain all goals."""
    assert isinstance(atoms, list)
    return any(atom.name == "unmet" for atom in atoms)
