"""The effects of users' rules on a task plan: doors that they close to every plan, and rules that leave no plan."""

import math
from dataclasses import dataclass

from geometry.kernels.arrays import XY
from kb.reasoning.solver import solve
from kb.reasoning.user_rules import rules_reach, rules_to_blame
from kb.tracing.decisions import record_decisions
from planner.situation import Situation
from planner.tasking.search import TASK_ENCODING, MadePlan

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
        """Return the names that the closed doors bear now.

        Parameters
        ----------
        situation : what is believed: world model, rooms, doors, corners and track.
        """
        view = situation.model.view
        places = [(x - view.west, y - view.south) for x, y in self.closed]
        doors = situation.rooms.doors
        return frozenset(
            door.name for door in doors if any(math.dist(door.place, place) <= SAME_DOOR for place in places)
        )


def effects_of_rules(made: MadePlan, situation: Situation) -> RuleEffects:
    """Return what users' rules did to a plan; nothing when none of them is about task plans.

    Parameters
    ----------
    made : the plan, with the facts from which it was made.
    situation : what is believed: world model, rooms, doors, corners and track.
    """
    rules = situation.rules
    if not made.facts or not rules_reach(TASK_ENCODING.stem, rules):
        return RuleEffects()
    closed = []
    view = situation.model.view
    for door in situation.rooms.doors:
        if not any(fact.startswith(f"connects({door.name},") for fact in made.facts):
            continue
        with record_decisions():  # a question about the plan, not a decision
            answer = solve([TASK_ENCODING, *rules], (*made.facts, f"asked({door.name})"))
        if answer and any(atom.name == "closed" for atom in answer):
            closed.append((door.place[0] + view.west, door.place[1] + view.south))
    blamed = rules_to_blame(TASK_ENCODING, rules, made.facts, _leaves_goals) if made.plan.unmet else ()
    return RuleEffects(tuple(closed), blamed)


def _leaves_goals(atoms: object) -> bool:
    """Return whether a plan, given by the shown atoms, does not attain all goals."""
    assert isinstance(atoms, list)
    return any(atom.name == "unmet" for atom in atoms)
