"""Reasons for the facts of the task plan: the decision that made it, what the task wants, and what geometry said."""

from collections.abc import Iterator, Sequence
from typing import Protocol

from utak.kb.evidence.proving import words_of
from utak.kb.evidence.reason import Reason, ReasonKind
from utak.kb.evidence.record import Record
from utak.kb.evidence.witness import command_reason
from utak.kb.language.atoms import atom_parts
from utak.kb.language.goal_words import ROBOT
from utak.kb.language.vocabulary import PLAN_PREDICATES, SETTLING_WORDS
from utak.kb.tracing.decisions import SolverCall
from utak.kb.world.stated_plan import circumstance_in_words, robot_step_in_words, stated_plan

PLAN_ENCODING = "task"  # the encoding of the task plan
DECIDED_BY = "deciding"  # the encoding that chooses what is done, and with which verdict a run ends
DOOR_STEP = "go"  # the step of that encoding that passes a door; all others are steps of the plan
TASK_PLAN_NAMES = frozenset(name for name, _ in PLAN_PREDICATES)
FOUND_WHEN_MADE = frozenset({"refuted", "given"})  # what is said of the step of the run at which the plan was made


class PlanExplainer(Protocol):
    """Explains facts and answers of encodings, as `utak.kb.evidence.beliefs.FactExplainer` does."""

    record: Record

    def reason(self, fact: str, step: int) -> Reason | None:
        """Return the reason of a fact at a step; None when it is not believed then."""

    def prove(self, call: SolverCall, atom: str, step: int) -> Reason:
        """Return the reason of an atom of an answer that was given at a step."""


def plan_fact_reason(beliefs: PlanExplainer, fact: str, step: int) -> Reason:
    """Return the reason of a fact of the task plan at a step."""
    name, arguments = atom_parts(fact)
    says = _in_words(beliefs, name, arguments, step) or words_of("belief", fact)
    if name == "means":
        return Reason(fact, says, ReasonKind.TASK, "the task")
    below = tuple(_below(beliefs, name, arguments, step))
    at = _made_at(beliefs.record, step) if name in FOUND_WHEN_MADE else step
    kind = ReasonKind.MEASURED if name in ("takes", "verified", *FOUND_WHEN_MADE) else ReasonKind.DECIDED
    return Reason(fact, says, ReasonKind.FACT if below else kind, f"step {at}", below)


def plan_step_reasons(beliefs: PlanExplainer, step: int) -> Iterator[Reason]:
    """Yield the reason of the present step of the plan at a step of the run, or of goals that no plan attains."""
    for fact in beliefs.record.steps[step].facts:
        name, arguments = atom_parts(fact)
        if fact.startswith("plan(0,") or (name == "unmet" and any(_search_for(beliefs, arguments[0], step))):
            yield plan_fact_reason(beliefs, fact, step)
    plan = stated_plan(beliefs.record.steps[step].facts, f"step {step}")
    if plan is not None and len(plan.robot) > 1:
        told = "; ".join(map(robot_step_in_words, plan.robot))
        yield Reason("the robot goes on so", told, ReasonKind.DECIDED, f"step {step}")


def _below(beliefs: PlanExplainer, name: str, arguments: Sequence[str], step: int) -> Iterator[Reason]:
    """Yield what a fact of the plan rests on; nothing when geometry measured it."""
    if name == "goal":
        yield from _stated(beliefs, f"means({arguments[0]},", step)
    elif name == "serves":
        yield from _stated(beliefs, f"goal({arguments[1]})", step)
        yield from _stated(beliefs, f"plan({arguments[0]},", step)
    elif name == "plan":
        yield from _decided(beliefs, int(arguments[0]), arguments[1], step)
        yield from _goals_served(beliefs, arguments[0], step)
        yield from _refutations_about(beliefs, arguments[1], step)
        yield from _what_stands_in_the_way(beliefs.record, arguments[1], step)
        for fact in (f"takes({arguments[0]},", f"verified({arguments[0]})"):
            yield from _stated(beliefs, fact, step)
    elif name == "passes":
        number = int(arguments[0])
        yield from _decided(beliefs, number, f"{DOOR_STEP}({arguments[1]})", step)
    elif name == "unmet":
        searched = tuple(_search_for(beliefs, arguments[0], step))
        yield from searched or _done_next(beliefs.record, step)
    elif name == "step":
        yield from _stated(beliefs, "plan(0,", step)
        yield from _done_next(beliefs.record, step) if arguments[0] == "0" else ()
    elif name == "refuted":
        yield from _found_by_geometry(beliefs.record, arguments[1], step)
        yield from _stated(beliefs, f"given({arguments[1]},", step)
    elif name == "price":
        yield from _stated(beliefs, "takes(", step)


def _search_for(beliefs: PlanExplainer, goal: str, step: int) -> Iterator[Reason]:
    """Yield what the search for a plan found against a goal, by its name; nothing where none was made."""
    found = _decision(beliefs.record, step)
    if found is not None and f"unmet({goal})" in (found[1].answer or ()):
        yield beliefs.prove(found[1], f"unmet({goal})", found[0])
    yield from _refutations_of_goal(beliefs, goal, step)


def _done_next(record: Record, step: int) -> Iterator[Reason]:
    """Yield the command that was given after a step, with its reason; nothing after the last one."""
    yield from map(command_reason, record.steps[step + 1 : step + 2])


def _what_stands_in_the_way(record: Record, planned: str, step: int) -> Iterator[Reason]:
    """Yield what pursuing a goal came to when a step was planned that settles something for it; nothing for others."""
    action, (subject, *_) = atom_parts(planned)
    found = _decision(record, step) if action in SETTLING_WORDS else None
    if found is None or f"occurs({planned},0)" not in (found[1].answer or ()):
        return
    for call in record.decisions(found[0]):
        for about in call.about if call.encoding == DECIDED_BY else ():
            came, _, why = str(about).partition(": ")
            if came == f"pursue({subject})":
                yield Reason(f"activity {came} led no further", why, ReasonKind.DECIDED, f"step {found[0]}")


def _found_by_geometry(record: Record, number: str, step: int) -> Iterator[Reason]:
    """Yield what geometry found for a refutation by its number: where, how wide, what is missing; if recorded."""
    decision, begin = _decision(record, step), f"refutation {number}: "
    for about in decision[1].about if decision is not None else ():
        if isinstance(about, str) and about.startswith(begin):
            found = about.removeprefix(begin)
            at = decision[0] if decision else step
            yield Reason(f"what was found: {found}", "", ReasonKind.MEASURED, f"step {at}")


def _stated(beliefs: PlanExplainer, start: str, step: int) -> Iterator[Reason]:
    """Yield the reasons of the facts of a step that begin with a text."""
    for fact in beliefs.record.steps[step].facts:
        if fact.startswith(start) and (found := beliefs.reason(fact, step)) is not None:
            yield found


def _goals_served(beliefs: PlanExplainer, number: str, step: int) -> Iterator[Reason]:
    """Yield the reasons of the goals that a step of the plan serves: those that hold at its place."""
    start = f"serves({number},"
    for fact in beliefs.record.steps[step].facts:
        if fact.startswith(start):
            yield from _stated(beliefs, f"goal({atom_parts(fact)[1][1]})", step)


def _refutations_of_goal(beliefs: PlanExplainer, goal: str, step: int) -> Iterator[Reason]:
    """Yield the refutations of ways to places where a goal holds. goal : its name."""
    for fact in beliefs.record.steps[step].facts:
        if fact.startswith("refuted(") and _place(fact).startswith(f"{goal}_"):
            yield from _stated(beliefs, fact, step)


def _refutations_about(beliefs: PlanExplainer, planned: str, step: int) -> Iterator[Reason]:
    """Yield the refutations that concern what a step of the plan brings: of ways of it, and those that rest on it."""
    facts = beliefs.record.steps[step].facts
    action, arguments = atom_parts(planned)
    if action in SETTLING_WORDS:
        yield from _refutations_of_goal(beliefs, arguments[0], step)
        return
    thing = _brought(planned)
    rests_on = [atom_parts(fact)[1] for fact in facts if fact.startswith("given(")]
    numbers = {number for number, given in rests_on if given.startswith(f"at({thing},")}
    for fact in facts:
        name, parts = atom_parts(fact)
        if name != "refuted" or not (parts[1] in numbers or _brought(parts[0]) == thing):
            continue
        yield from _stated(beliefs, fact, step)
        if planned.startswith("clear(") and _brought(parts[0]) != thing:
            later = [atom_parts(one)[1] for one in facts if one.startswith("plan(")]
            for number, what in later:
                if _brought(what) == _brought(parts[0]):
                    yield from _goals_served(beliefs, number, step)


def _brought(planned: str) -> str:
    """Return the name of what a step of the plan brings; that of the robot for its own way."""
    action, arguments = atom_parts(planned)
    return arguments[0] if action in ("carry", "clear") else ROBOT


def _place(refuted: str) -> str:
    """Return the place to which the step of a fact refuted(Step, Number) brings something."""
    return atom_parts(atom_parts(refuted)[1][0])[1][-1]


def _in_words(beliefs: PlanExplainer, name: str, arguments: Sequence[str], step: int) -> str:
    """Return a step of the plan, a refutation or the cost in words; "" for other facts of the plan."""
    told = name in ("plan", "refuted", "price", "step")
    if name == "given":
        return f"refutation {arguments[0]} holds while {circumstance_in_words(arguments[1])}"
    plan = stated_plan(beliefs.record.steps[step].facts, f"step {step}") if told else None
    if plan is None:
        return ""
    if name == "price":
        return plan.cost_words
    if name == "step":
        return f"step {arguments[0]} of the robot itself: {robot_step_in_words(arguments[1])}"
    if name == "plan":
        return next((one.explained for one in plan.steps if str(one.number) == arguments[0]), "")
    return next((one.words for one in plan.refutations if str(one.number) == arguments[1]), "")


def _decided(beliefs: PlanExplainer, number: int, planned: str, step: int) -> Iterator[Reason]:
    """Yield why the encoding `task` chose a step of the plan; nothing when the record does not tell."""
    for call, atom, at in planned_choice(beliefs.record, str(number), planned, step):
        if atom in (call.answer or ()):
            yield beliefs.prove(call, atom, at)


def planned_choice(record: Record, number: str, planned: str, step: int) -> Iterator[tuple[SolverCall, str, int]]:
    """Yield the decision of the plan of a step, the atom that says there that the plan has some step, and its step."""
    found = _decision(record, step)
    left = sum(1 for fact in record.steps[step].facts if fact.startswith("plan("))
    if found is None or not left or not number.isdigit():
        return
    steps = [atom_parts(atom)[1][0] for atom in found[1].answer or () if atom.startswith("occurs(")]
    done = sum(1 for one in steps if atom_parts(one)[0] != DOOR_STEP) - left
    yield found[1], f"occurs({planned},{done + int(number)})", found[0]


def _decision(record: Record, step: int) -> tuple[int, SolverCall] | None:
    """Return the newest decision of the encoding `task` up to a step, with its step; None when there is none."""
    return next((found for found in record.answers(step, PLAN_ENCODING) if found[1].answer is not None), None)


def _made_at(record: Record, step: int) -> int:
    """Return the step at which the plan of a step was made, as far as the record tells; else that step."""
    found = _decision(record, step)
    return step if found is None else found[0]
