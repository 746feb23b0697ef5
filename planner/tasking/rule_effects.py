"""The effects of users' rules: doors that they close or price, whatever the plan, and rules that leave no plan."""

import math
from collections.abc import Mapping, Sequence
from itertools import product
from typing import Any, NamedTuple

from utak.geometry.kernels.arrays import XY
from utak.kb.language.atoms import signature_of
from utak.kb.reasoning.encodings import BoundedAnswer
from utak.kb.reasoning.interfaces import USER_RULE_INTERFACES, WORLD_PREDICATES
from utak.kb.reasoning.solver import solve_within
from utak.kb.reasoning.user_rules import predicates_read, rules_reach, rules_to_blame
from utak.kb.tracing.decisions import record_decisions
from utak.kb.world.model import hundredths
from utak.kb.world.rooms import SAME_DOOR
from utak.planner.oracles.problem import TableState, TaskProblem
from utak.planner.situation import Situation
from utak.planner.tasking.facts import problem_facts
from utak.planner.tasking.proposal import MAX_PLAN_CONFLICTS, TASK_ENCODING
from utak.planner.tasking.search import MadePlan

# What rules read in the task plan that may change: what is believed, and what was settled.
SETTLED_BY_RUN = ("size", "settled", "settling", "left", "stuck", "came_to")
BELIEVED = WORLD_PREDICATES | {one for one in USER_RULE_INTERFACES["task"] if one[0] in SETTLED_BY_RUN}
ANY_DOOR = "unseen_door"  # a door that nobody has seen
ANY_ROOM = "unseen_room"  # a room that nobody has seen, behind a door of which nothing is known
DOOR_COMMANDS = 1  # that planner/asp/task/go.lp reckons for a pass through a door


def doors_at(middles: Sequence[XY], situation: Situation) -> frozenset[str]:
    """Return the names that doors at some places bear now."""
    view = situation.model.view
    places = [(x - view.west, y - view.south) for x, y in middles]
    doors = situation.rooms.doors
    return frozenset(door.name for door in doors if any(math.dist(door.place, place) <= SAME_DOOR for place in places))


def doors_led_round(made: MadePlan, situation: Situation) -> tuple[tuple[XY, ...], ...]:
    """Return the doors that each errand of a plan does not pass; () when no users' rule is about task plans."""
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


class DoorRules(NamedTuple):
    """The doors that users' rules close or price, whatever the plan."""

    closed: frozenset[str] = frozenset()  # the names of doors that no plan passes
    # By the name of a door: the commands that rules add to a pass through it, where they add any
    prices: Mapping[str, int] = {}
    # By the name of a door: how many commands fewer that is than rules say for the width believed, as it may be more
    reliefs: Mapping[str, int] = {}


def rules_about_doors(situation: Situation) -> DoorRules:
    """Return which doors users' rules close to the robot, and which they price; nothing without such rules."""
    if not rules_reach(TASK_ENCODING.stem, situation.rules):
        return DoorRules()
    facts = _facts_about_doors(situation)
    reads_width = ("width", 2) in predicates_read(TASK_ENCODING.stem, situation.rules)
    with record_decisions():  # questions about doors, not decisions
        without = _answer(facts, situation)
        closed, prices, reliefs = set(), {}, {}
        widths = {door.name: f"width({door.name},{hundredths(door.width_bound) - 1})" for door in situation.doors}
        for door in _doors_asked_about(situation):
            answer = _answer((*facts, f"asked({door})"), situation)
            if answer.atoms is None or _closes(answer.atoms):
                closed.add(door)
            elif (price := answer.cost_at(1) - without.cost_at(1) - DOOR_COMMANDS) > 0:
                prices[door] = price
                if not reads_width:
                    continue
                others = [fact for fact in facts if not fact.startswith(f"width({door},")]
                widest = _answer((*others, widths[door], f"asked({door})"), situation)
                saved = 0 if widest.atoms is None else answer.cost_at(1) - widest.cost_at(1)
                reliefs[door] = max(0, min(saved, price) // 2)  # as likely as not
                prices[door] -= reliefs[door]
    return DoorRules(frozenset(closed), prices, reliefs)


def rules_that_close(situation: Situation) -> tuple[str, ...]:
    """Return the places of users' rules that close doors, such as `rules.lp:3`; () where none is closed."""
    blamed: list[str] = []
    facts = _facts_about_doors(situation) if situation.closed else ()
    for door in sorted(situation.closed.intersection(_doors_asked_about(situation))):
        blamed += rules_to_blame(TASK_ENCODING, situation.rules, (*facts, f"asked({door})"), _closes)
    return tuple(dict.fromkeys(blamed))


def rules_close_all_doors(situation: Situation) -> bool:
    """Return whether users' rules close even a door of which nothing is known, and so whatever may be found."""
    if not situation.closed:
        return False
    unknown = (f"connects({ANY_DOOR},before_{ANY_DOOR},behind_{ANY_DOOR})", f"asked({ANY_DOOR})")
    with record_decisions():  # a question about doors, not a decision
        answer = _answer((*_facts_about_doors(situation), *unknown), situation)
    return answer.atoms is None or _closes(answer.atoms)


def _doors_asked_about(situation: Situation) -> list[str]:
    """Return the names of the doors that are likely enough to be tried, and of those that a touch would make doors."""
    likely = [door.name for door in situation.rooms.doors if door.likely]
    return [*likely, *(door.name for door in situation.possible_doors)]


def _facts_about_doors(situation: Situation) -> tuple[str, ...]:
    """Return the facts of a problem without goals; a door behind which nothing is known leads to a room of its own."""
    state = TableState({}, situation.model.place_on_view, None)
    facts = problem_facts(TaskProblem({}, (), {}, {}, {}, state), (), situation, frozenset(), ())
    known = {fact.partition("(")[2].partition(",")[0] for fact in facts if fact.startswith("connects(")}
    beyond = [
        f"connects({door},before_{door},behind_{door})" for door in _doors_asked_about(situation) if door not in known
    ]
    widths = [f"width({door.name},{hundredths(door.width)})" for door in situation.possible_doors]
    return ("horizon(1)", *facts, *beyond, *widths)


def _answer(facts: tuple[str, ...], situation: Situation) -> BoundedAnswer:
    return solve_within([TASK_ENCODING, *situation.rules], facts, MAX_PLAN_CONFLICTS)


def rules_without_plan(made: MadePlan, situation: Situation) -> tuple[str, ...]:
    """Return the places of users' rules because of which a plan does not attain all goals, such as `rules.lp:3`."""
    rules = situation.rules
    if not made.facts or not made.plan.unmet or not rules_reach(TASK_ENCODING.stem, rules):
        return ()
    return rules_to_blame(TASK_ENCODING, rules, made.facts, _leaves_goals)


def facts_rules_read(situation: Situation) -> frozenset[str]:
    """Return the facts of the world model and of meanings that users' rules read: a plan is made anew with these."""
    named = predicates_read(TASK_ENCODING.stem, situation.rules)
    read = (named & BELIEVED) | ({("bound", 2)} if ("meaning", 2) in named else set())
    if not read:
        return frozenset()
    state = TableState({}, situation.model.place_on_view, None)
    facts = problem_facts(TaskProblem({}, (), {}, {}, {}, state), (), situation, frozenset(), ())
    return frozenset(fact for fact in facts if signature_of(fact) in read)


def rules_alone_leave_no_plan(made: MadePlan, blamed: Sequence[str], situation: Situation) -> bool:
    """Return whether users' rules leave no plan whatever geometry answers and whatever else is seen, for good."""
    if not blamed or situation.closed or BELIEVED & predicates_read(TASK_ENCODING.stem, situation.rules, blamed):
        return False  # other ways may be found, or what is believed may change
    named = {x for x, parameter in situation.task.parameters.items() if parameter.kind == "object"}
    if any(fact.startswith("done(") for fact in made.facts) or named - situation.binding.keys():
        return False  # it may be what was done that leaves none, or what is not found yet that helps
    facts = [fact for fact in made.facts if not fact.startswith(("refuted(", "overlap("))]
    known = {fact.rpartition(",")[2][:-1] for fact in facts if fact.startswith("lies(")}
    facts += [f"connects(way_to_{ANY_ROOM},{room},{ANY_ROOM})" for room in sorted(known)]
    things = [fact[len("thing(") : -1] for fact in facts if fact.startswith("thing(")]
    for name, room in product(things, sorted({*known, ANY_ROOM})):  # as if there were room for everything everywhere
        facts += [f"place({name},any_{room})", f"aside({name},any_{room})", f"lies({name},any_{room},{room})"]
    answer = _answer(tuple(facts), situation)
    return answer.proved and (answer.atoms is None or _leaves_goals(answer.atoms))


def _closes(atoms: Sequence[Any]) -> bool:
    """Return whether an answer, given by the shown atoms, says that a door is closed."""
    return any(atom.name == "closed" for atom in atoms)


def _leaves_goals(atoms: Sequence[Any]) -> bool:
    """Return whether a plan, given by the shown atoms, does not attain all goals."""
    return any(atom.name == "unmet" for atom in atoms)
