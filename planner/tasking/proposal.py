"""Proposals of the encoding of task plans: one answer of clingo, read as steps in order."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

from utak.kb.language.goal_words import ROBOT
from utak.kb.reasoning.solver import solve_within
from utak.planner.question import PLANNER_ASP
from utak.planner.tasking.task_plan import Errand

TASK_ENCODING = PLANNER_ASP / "task"  # a folder, with a file for each action
MAX_PLAN_CONFLICTS = 20_000  # of clingo's search for one proposal; a bound on work, so that all machines do the same
UNMET_PLAN = "plan"  # what is unmet where users' rules leave no plan at all, as in planner/asp/deciding/activities.lp


class Proposal(NamedTuple):
    """A plan as the encoding proposes it."""

    errands: tuple[Errand, ...]  # its steps, in order
    unmet: tuple[str, ...]  # the goals that do not hold after them, and what is not settled
    facts: tuple[str, ...]  # what the encoding was given
    missed: Mapping[str, int]  # the wishes that do not hold after them, each with the commands that it may cost
    # The object that each parameter of the task means: (parameter, object), sorted
    meanings: tuple[tuple[str, str], ...] = ()
    proved: bool = True  # whether the search of clingo ended, so that no plan is cheaper by what the facts say
    left: tuple[str, ...] = ()  # the steps that may settle something, whether they are done or not


def propose(
    facts: tuple[str, ...], rules: Sequence[Path], about: Sequence[str] = (), without: tuple[str, ...] = ()
) -> Proposal:
    """Return the plan that the encoding finds cheapest; the same answer for the same facts."""
    answer = solve_within([TASK_ENCODING, *rules], facts, MAX_PLAN_CONFLICTS, about, without)
    if answer.atoms is None:  # rules leave no plan of that length, or the search was cut off before it found one
        return Proposal((), (UNMET_PLAN,), facts, {}, proved=answer.proved)
    atoms = answer.atoms
    unmet = tuple(str(atom.arguments[0]) for atom in atoms if atom.name == "unmet")
    doors: dict[int, list[str]] = {}
    found: dict[int, Errand] = {}
    for atom in (atom for atom in atoms if atom.name == "occurs"):
        step, time = atom.arguments[0], atom.arguments[1].number
        if f"done({step},{time})" in facts:
            continue  # the past of the plan
        words = [str(word) for word in step.arguments]
        if step.name == "go":
            doors.setdefault(time, []).append(words[0])
        else:
            subject, place = (ROBOT, words[0]) if step.name == "arrive" else (words[0], "".join(words[1:]))
            found[time] = Errand(step.name, subject, place)
    errands = tuple(replace(found[time], doors=tuple(sorted(doors.get(time, ())))) for time in sorted(found))
    missed = {str(atom.arguments[0]): atom.arguments[1].number for atom in atoms if atom.name == "missed"}
    pairs = [(str(atom.arguments[0]), str(atom.arguments[1])) for atom in atoms if atom.name == "meaning"]
    left = tuple(sorted(str(atom.arguments[0]) for atom in atoms if atom.name == "left"))
    return Proposal(errands, unmet, facts, missed, tuple(sorted(pairs)), answer.proved, left)
