"""Reasons for goals, commands and verdicts: the facts that they are about, and the decisions that led to them."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from utak.kb.evidence.beliefs import FactExplainer
from utak.kb.evidence.plans import DECIDED_BY, plan_step_reasons
from utak.kb.evidence.reason import Reason, ReasonKind
from utak.kb.evidence.record import Record
from utak.kb.evidence.witness import command_reason, line_squares, node_squares, seen_reason
from utak.kb.language.atoms import atom_parts
from utak.kb.language.goal_words import GOAL_WORDS, PLACE_FACTS, ROBOT, WRAPPING_GOALS, Holds
from utak.kb.tracing.decisions import SolverCall
from utak.kb.world.model import FACT_UNITS_PER_SQUARE, ROOT_NODE, VERGE_NODE

CHOICES = {  # the predicates of its choices, and what was chosen, in words
    "do": "this activity was chosen",
    "choose": "this subgoal was chosen",
    "sense": "this was to be seen or felt first",
    "react": "this was chosen for what is carried, beside its plan",
    "walked": "this way was chosen, before it was pulled tight",
}


@dataclass(frozen=True)
class RecordedTask:
    """The task of a run and its end, as an episode states them."""

    goals: Sequence[str]  # the goals in the order of goal.lp, as text.
    result: Mapping[str, Any] | None = None  # the end, with the keys verdict and reason; None while the run goes on


def explain_command(beliefs: FactExplainer, task: RecordedTask, step: int) -> Reason:
    """Return the reason of the command before the impression of a step: goal, facts, and what was chosen among what."""
    now = beliefs.record.steps[step]
    if now.action is None:
        return Reason("the robot wakes", "every run begins so", ReasonKind.CONVENTION, "step 0")
    command = command_reason(now)
    planned = plan_step_reasons(beliefs, step - 1)
    below = (*planned, *_goal_reasons(beliefs, task, step - 1), *_choices(beliefs, step - 1))
    return Reason(command.claim, now.why, ReasonKind.COMMAND, f"step {step}", below, command.data)


def explain_verdict(beliefs: FactExplainer, task: RecordedTask) -> Reason | None:
    """Return the reason of the verdict: the rules of the agenda, what was planned, the goals, and the last choices."""
    if task.result is None:
        return None
    last = len(beliefs.record.steps) - 1
    claim = f"verdict({task.result['verdict']})"
    ruled = tuple(_ruled_verdicts(beliefs, claim, last))
    choices = () if ruled else _choices(beliefs, last)
    below = (*ruled, *plan_step_reasons(beliefs, last), *_goal_reasons(beliefs, task, last), *choices)
    return Reason(claim, str(task.result["reason"]), ReasonKind.RULE, f"step {last}", below)


def explain_goal(beliefs: FactExplainer, goal: str, step: int) -> Reason:
    """Return a goal with the facts that it is about and what its parameters mean, as believed at a step."""
    name, arguments = atom_parts(goal)
    if name in WRAPPING_GOALS:
        name, arguments = atom_parts(arguments[0])
    facts = [*_meant(beliefs, arguments, step), *_facts_about(beliefs, name, arguments, step)]
    now = (reason for fact in facts if (reason := beliefs.reason(fact, step)) is not None)
    below = (*now, *_began(beliefs, name, arguments, step))
    below += tuple(_unbound(beliefs, name, arguments, step)) if below else ()
    says = "the goal is about these facts" if below else "nothing that is believed is about it yet"
    return Reason(goal, says, ReasonKind.INPUT if below else ReasonKind.TASK, "the task", below)


def _goal_reasons(beliefs: FactExplainer, task: RecordedTask, step: int) -> Iterator[Reason]:
    """Yield a reason for each goal: the facts that it is about, as believed at a step."""
    yield from (explain_goal(beliefs, goal, step) for goal in task.goals)


def _meant(beliefs: FactExplainer, arguments: Sequence[str], step: int) -> Iterator[str]:
    """Yield the facts `bound(Parameter, Node)` for the arguments of a goal that are bound."""
    bound = beliefs.record.steps[step].bound
    yield from (f"bound({argument},{bound[argument]})" for argument in arguments if argument in bound)


def _unbound(beliefs: FactExplainer, name: str, arguments: Sequence[str], step: int) -> Iterator[Reason]:
    """Yield for each door or room of a goal that nothing is bound to it."""
    kinds = GOAL_WORDS[name].parameters if name in GOAL_WORDS else ()
    for argument, names in zip(arguments, kinds, strict=False):
        kind = (names or ("",))[0]
        if kind in ("door", "room") and "(" not in argument and argument not in beliefs.record.steps[step].bound:
            says = f"no {kind} is bound to it; where the task says nothing else of it, any {kind} will do"
            yield Reason(f"the task's {argument}", says, ReasonKind.TASK, f"step {step}")


def _began(beliefs: FactExplainer, name: str, arguments: Sequence[str], step: int) -> Iterator[Reason]:
    """Yield where the thing of a goal was first seen, where the goal depends on that, and the way that it demands."""
    word, record = GOAL_WORDS.get(name), beliefs.record
    node = _node(beliefs, arguments[0], step) if arguments else ""
    if word is None or not node:
        return
    if word.holds is Holds.ALONG_A_TRACK:
        way = " ".join(f"({east:g} {north:g})" for east, north in record.steps[step].places)
        yield Reason(
            f"the robot went {way}", "so far, one point for each impression", ReasonKind.MEASURED, f"step {step}"
        )
    places = [(one.number, fact) for one in record.steps[: step + 1] for fact in one.facts if _is_place(fact, node)]
    if not places or not word.from_origin:
        return
    (number, began), (last, now) = places[0], places[-1]
    if node != ROOT_NODE and number < step and (reason := beliefs.reason(began, number)):
        seen = (
            f"the goal depends on where {node} was at first, which is where the middle of what was seen of it then lay"
        )
        yield replace(reason, because=f"{seen}: {reason.because}")
    if word.out_of_sight and last == step:
        yield from _hiding(record, began, now, step)


def _is_place(fact: str, node: str) -> bool:
    """Return whether a fact says where a node is."""
    return fact.startswith(f"offset({node},")


def _hiding(record: Record, began: str, now: str, step: int) -> Iterator[Reason]:
    """Yield the wall between two places of a thing, by the facts that say them; nothing where none lies between."""
    (_, *start), (_, *end) = (atom_parts(fact)[1] for fact in (began, now))
    first, last = (
        (int(east) / FACT_UNITS_PER_SQUARE, int(north) / FACT_UNITS_PER_SQUARE) for east, north in (start, end)
    )
    verge = set(node_squares(record.steps[step], VERGE_NODE))
    between = [square for square in line_squares(record.steps[step], first, last, 0.0) if square in verge]
    if between:
        yield seen_reason(record, step, between, True, "the wall between where it was at first and where it is now")


def _facts_about(beliefs: FactExplainer, name: str, arguments: Sequence[str], step: int) -> Iterator[str]:
    """Yield the believed facts that decide a goal."""
    now = beliefs.record.steps[step]
    nodes = [_node(beliefs, argument, step) for argument in (*arguments, "", "")]
    for form in GOAL_WORDS[name].facts if name in GOAL_WORDS else PLACE_FACTS:  # a damaged episode has any name
        start = form.format(*nodes)
        if "(," not in start:
            yield from (fact for fact in now.long_facts if fact.startswith(start) and _leads(fact, now.facts))


def _leads(fact: str, facts: Sequence[str]) -> bool:
    """Return whether a fact is not the width of a door that is believed to lead nowhere yet."""
    name, arguments = atom_parts(fact)
    return name != "width" or any(other.startswith(f"connects({arguments[0]},") for other in facts)


def _node(beliefs: FactExplainer, argument: str, step: int) -> str:
    """Return the node, or the name of the corner, that an argument of a goal means; '' for none."""
    if argument == ROBOT:
        return ROOT_NODE
    name, parts = atom_parts(argument) if argument else ("", ())
    if name == "corner" and parts:
        return parts[0]
    return beliefs.record.steps[step].bound.get(argument, "")


def _ruled_verdicts(beliefs: FactExplainer, claim: str, step: int) -> Iterator[Reason]:
    """Yield the reason that the agenda has for a verdict at a step: what each activity came to; nothing without it."""
    asked = [call for call in beliefs.record.decisions(step) if call.encoding == DECIDED_BY]
    if asked and claim in (asked[-1].answer or ()):
        yield replace(beliefs.prove(asked[-1], claim, step), because="the agenda ends with this verdict")


def _choices(beliefs: FactExplainer, step: int) -> Iterator[Reason]:
    """Yield what was chosen last at a step: why, and what was refused."""
    asked = [call for call in beliefs.record.decisions(step) if call.encoding == DECIDED_BY and call.answer]
    for call in asked[-1:]:
        chosen = (atom for name in CHOICES for atom in call.answer or () if atom_parts(atom)[0] == name)
        yield from (replace(beliefs.prove(call, atom, step), because=_about(call, atom)) for atom in chosen)


def _about(call: SolverCall, atom: str) -> str:
    """Return in words what a choice is about."""
    name, arguments = atom_parts(atom)
    number = arguments[0] if arguments else ""
    if not number.isdigit() or int(number) >= len(call.about):
        return CHOICES[name]
    about = call.about[int(number)]
    if not isinstance(about, str):
        about = " ".join(f"({east:g}, {north:g})" for east, north in about)
    return f"{CHOICES[name]}: {about}"
