"""Questions about a run, answered with trees of reasons from what the robot recorded: never from the truth."""

import os
import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace

from shapely.errors import ShapelyError

from utak.kb.evidence.absences import AbsenceExplainer
from utak.kb.evidence.beliefs import FactExplainer, plain_fact, with_node
from utak.kb.evidence.cells import explain_cell
from utak.kb.evidence.goals import RecordedTask, explain_command, explain_goal, explain_verdict
from utak.kb.evidence.proving import (
    EncodingProver,
    call_deriving,
    prove_query_atom,
    query_predicates,
    unknown_predicate,
)
from utak.kb.evidence.reason import Reason, ReasonKind
from utak.kb.evidence.record import MissingRecordError, Record
from utak.kb.explanation.belief import certain_atoms
from utak.kb.explanation.programs import ExplanationError
from utak.kb.language.atoms import atom_parts
from utak.kb.language.diagnostics import BadInputError, Problem
from utak.kb.language.reader import facts_from_text
from utak.kb.language.vocabulary import BELIEF_PREDICATES
from utak.simulator.episode.episode import Episode, EpisodeLine
from utak.simulator.explaining.certified import certificate_reason
from utak.simulator.explaining.missing_rules import missing_rules

QUESTION_VARIABLE = re.compile(r"(?<![\w\"])(?:[A-Z]\w*|_)(?![\w\"])")  # in a question: stands for anything

# What well-formed values that do not fit together end in; the last one is of outlines that cross themselves.
MISFIT_ERRORS = (
    LookupError,
    ValueError,
    TypeError,
    AttributeError,
    ArithmeticError,
    AssertionError,
    RuntimeError,
    ShapelyError,
)
NO_VERDICT = "no verdict is recorded: the run goes on, or was cut short"
MORE_LIKELY = 50  # percent: a fact with less confidence is more likely wrong than right


class Questions:
    """Answers questions about a run."""

    def __init__(
        self,
        header: EpisodeLine,
        lines: Sequence[EpisodeLine],
        result: EpisodeLine | None = None,
        rule_files: Sequence[str] = (),
        certificate: str = "",
    ) -> None:
        self._header, self._lines, self._result = header, lines, result
        self._certificate = certificate  # the text of one, which is told with the verdict; "" for none
        self.beliefs = FactExplainer(Record(lines), EncodingProver(rule_files))
        self._rule_files = tuple(rule_files)
        self._absences = AbsenceExplainer(self.beliefs, rule_files)

    @property
    def last_step(self) -> int:
        """The number of the last step."""
        return len(self.beliefs.record.steps) - 1

    @property
    def lacking(self) -> str:
        """Rules of the run that are not given, so that answers lack them, in a line; "" for none."""
        # Raises CannotOpenError when a file of rules cannot be read.
        return missing_rules(self._header, self._rule_files)

    def why(self, fact: str, step: int | None = None) -> Reason:
        """Return the reason why a fact is believed, or why a goal or a verdict stands as it does."""
        at, wanted = self._checked(step), _one_fact(fact)
        with _refusing_damage(fact):
            if atom_parts(wanted)[0] == "verdict":
                return self._why_verdict(wanted)
            if goal := self._goal_asked(wanted, at):
                return explain_goal(self.beliefs, goal, at)
            if _is_derived(wanted):
                return self._why_derived(plain_fact(wanted), at)
            found, *others = self._instances(wanted, at)
            return _one_of(self.beliefs.explain(found, at), 1 + len(others))

    def why_not(self, fact: str, step: int | None = None) -> Reason:
        """Return why a fact is not believed: the smallest set of facts that is missing or in the way."""
        at, wanted = self._checked(step), _one_fact(fact)
        with _refusing_damage(fact):
            if atom_parts(wanted)[0] == "verdict":
                return self._why_not_verdict(wanted, at)
            if goal := self._goal_asked(wanted, at):
                return self._why_not_goal(goal, at)
            if _is_derived(wanted) and _has_variables(wanted):
                raise _problem(fact, "one atom at a time: give values in the place of variables")
            believed = self._instances(wanted, at)[0]
            if believed in self.beliefs.record.steps[at].fact_set and not _is_weak(wanted, believed):
                raise _problem(fact, f"this is believed at step {at}: {believed}; why tells the reason")
            return self._absences.explain(wanted, at)

    def _goal_asked(self, wanted: str, step: int) -> str:
        """Return the goal that a fact states, unless it is believed as a fact; "" for none."""
        plain = plain_fact(wanted)
        if plain in self.beliefs.record.steps[step].fact_set:
            return ""
        return next((goal for goal in self._task_at(step).goals if plain_fact(goal) == plain), "")

    def _task_at(self, step: int) -> RecordedTask:
        """Return the task that counts at a step: goals may be others after a fork or a change at the prompt."""
        goals = self._header["task"]["goals"]
        for stage in reversed(self._header.get("forked", ())):
            if step < stage["until"]:
                goals = stage["task"]["goals"]
        for change in self._header.get("changes", ()):
            if "goal" in change and change["step"] <= step:
                goals = facts_from_text(f"{str(change['goal']).strip().removesuffix('.')}.", "goal")
        return RecordedTask(tuple(map(str, goals)), self._result)

    def _why_not_goal(self, goal: str, step: int) -> Reason:
        """Return what a goal is about that is not concluded to hold; raise BadInputError when all goals hold then."""
        result = self._result
        if step == self.last_step and result is not None and result.get("verdict") == "done":
            raise _problem(goal, "the robot concluded that this holds: verdict(done); why tells the reason")
        because = "it is not concluded that this goal holds" + (" yet" if step < self.last_step else "")
        found = explain_goal(self.beliefs, goal, step)
        return Reason(f"not {goal}", because, ReasonKind.NEGATION, f"step {step}", (found,))

    def _why_not_verdict(self, wanted: str, step: int) -> Reason:
        """Return why the verdict is another one, or why there is none at a step."""
        last, task = self.last_step, self._task_at(self.last_step)
        found = explain_verdict(self.beliefs, task)
        if found is None:
            below = tuple(explain_goal(self.beliefs, goal, last) for goal in task.goals)
            return Reason(f"not {wanted}", NO_VERDICT, ReasonKind.NEGATION, f"step {last}", below)
        if step == last and _fits(wanted, found.claim):
            raise _problem(wanted, f"this is the verdict: {found.claim}; why tells the reason")
        given = f"the verdict is {found.claim}" + (f", and is given at step {last} alone" if step < last else "")
        return Reason(f"not {wanted}", given, ReasonKind.NEGATION, found.source, (found,))

    def why_cell(self, cell: int, step: int | None = None) -> Reason:
        """Return what a cell of the impression of a step (None for the last one) is laid to; cells count from 0."""
        with _refusing_damage(f"cell {cell}"):
            return explain_cell(self.beliefs, cell, self._checked(step))

    def why_step(self, step: int | None = None) -> Reason:
        """Return the reason of the command of a step (None for the last one): goals, facts, and what was not chosen."""
        with _refusing_damage("step"):
            return explain_command(self.beliefs, self._task_at(max(0, self._checked(step) - 1)), self._checked(step))

    def _why_derived(self, atom: str, step: int) -> Reason:
        """Return the reason of an atom of a predicate that users' rules define, or of `object(N)`."""
        facts = self.beliefs.record.steps[step].facts

        def leaf(fact: str) -> Reason:
            """Return the reason of a believed fact on which the atom rests."""
            found = self.beliefs.reason(fact, step)
            return found or Reason(fact, "it is assumed", ReasonKind.TASK, "what was assumed")

        name, arguments = atom_parts(atom)
        signature = name, len(arguments)
        call = call_deriving(self.beliefs.record.decisions(step), atom, self._rule_files)
        if call is not None:
            return self.beliefs.prove(call, atom, step)
        if signature not in BELIEF_PREDICATES and signature not in query_predicates(self._rule_files):
            raise BadInputError([unknown_predicate(atom, signature, self._rule_files)])
        atom = with_node(atom)
        if _has_variables(atom):
            holding = [one for one in certain_atoms(facts, self._rule_files) if _fits(atom, one)]
            if not holding:
                raise _problem(atom, "no atom of this form certainly holds by what is believed")
            return _one_of(prove_query_atom(facts, holding[0], leaf, self._rule_files), len(holding))
        return prove_query_atom(facts, atom, leaf, self._rule_files)

    def _why_verdict(self, wanted: str) -> Reason:
        """Return the reason of the verdict; raise BadInputError when it is another one, or the run goes on."""
        found = explain_verdict(self.beliefs, self._task_at(self.last_step))
        if found is None:
            raise _problem(wanted, NO_VERDICT)
        if not _fits(wanted, found.claim):
            raise _problem(wanted, f"this is not the verdict: it is {found.claim}")
        if self._certificate:
            certified = certificate_reason(self._header, self.beliefs.record.steps, self._lines, self._certificate)
            return replace(found, rests_on=(certified, *found.rests_on))
        return found

    def _instances(self, wanted: str, step: int) -> list[str]:
        """Return the believed facts that fit a fact with variables, the surest first; the fact itself for none."""
        plain = plain_fact(wanted)
        found = [fact for fact in self.beliefs.record.steps[step].facts if _fits(plain, fact)]
        return sorted(found, key=_confidence, reverse=True) or [plain]

    def _checked(self, step: int | None) -> int:
        """Return the number of a step; raise BadInputError when there is no such step."""
        if step is None:
            return self.last_step
        if not 0 <= step <= self.last_step:
            raise _problem(f"step {step}", f"there is no step {step}: the last is {self.last_step}")
        return step


def questions_of_episode(episode: Episode, rule_files: Sequence[str] = (), certificate: str = "") -> Questions:
    """Return the questions about an episode that was read; rule_files : the files with users' rules of its run."""
    return Questions(episode.header, episode.steps, episode.result, rule_files, certificate)


@contextmanager
def _refusing_damage(question: str) -> Iterator[None]:
    """Turn what an episode cannot tell into BadInputError, in a `with` block."""
    try:
        yield
    except (MissingRecordError, ExplanationError) as error:
        raise _problem(question, str(error)) from None
    except MISFIT_ERRORS as error:
        if os.environ.get("UTAK_DEBUG"):
            raise
        what = f"the episode's record does not fit together, so this cannot be explained ({type(error).__name__})"
        raise _problem(question, what) from None


def _fits(wanted: str, fact: str) -> bool:
    """Return whether a fact is the wanted one; variables of the wanted one fit anything, each the same everywhere."""
    (name, arguments), (other, values) = atom_parts(wanted), atom_parts(fact)
    if name != other or len(arguments) != len(values):
        return False
    known: dict[str, str] = {}
    for argument, value in zip(arguments, values, strict=True):
        is_variable = argument[:1].isupper() and argument.isidentifier()
        if argument != "_" and (known.setdefault(argument, value) if is_variable else argument) != value:
            return False
    return True


def _is_derived(atom: str) -> bool:
    """Return whether an atom is no fact of the world model by itself: users' rules define it, or it is `object(N)`."""
    name, arguments = atom_parts(atom)
    return (name, len(arguments)) not in BELIEF_PREDICATES or name == "object"


def _has_variables(atom: str) -> bool:
    return any(QUESTION_VARIABLE.fullmatch(argument) for argument in atom_parts(atom)[1])


def _confidence(fact: str) -> int:
    """Return the confidence of a fact; 100 for one that states none."""
    name, arguments = atom_parts(fact)
    declared = BELIEF_PREDICATES.get((name, len(arguments)))
    return int(arguments[-1]) if declared is not None and declared.confident else 100


def _one_of(reason: Reason, count: int) -> Reason:
    """Return the reason of the first of several facts that fit a question; it says how many there are."""
    if count == 1:
        return reason
    return replace(
        reason, because=f"{reason.because} (1 of {count} that fit)".lstrip(), data={**reason.data, "fit": count}
    )


def _is_weak(wanted: str, believed: str) -> bool:
    """Return whether a question leaves the confidence open, and the fact is believed to be less likely than not."""
    (name, arguments), (_, values) = atom_parts(wanted), atom_parts(believed)
    declared = BELIEF_PREDICATES.get((name, len(arguments)))
    is_open = declared is not None and declared.confident and QUESTION_VARIABLE.fullmatch(arguments[-1]) is not None
    return is_open and int(values[-1]) < MORE_LIKELY


def _one_fact(text: str) -> str:
    """Return a fact without full stop and blanks; raise BadInputError when the text is no fact."""
    written = text.strip().removesuffix(".").strip()
    checked = QUESTION_VARIABLE.sub(lambda match: "v" * len(match[0]), written)
    try:
        found = facts_from_text(f"{checked}.", "why")
    except BadInputError as bad:
        first = bad.problems[0]
        raise BadInputError([Problem("why", first.span, first.what, written, first.hint)]) from None
    if len(found) != 1:
        raise _problem(text, "one fact at a time")
    name, arguments = atom_parts(written)
    if QUESTION_VARIABLE.fullmatch(name):
        raise _problem(text, "a fact begins with the name of its predicate, in small letters")
    return f"{name}({','.join(arguments)})" if arguments else name


def _problem(text: str, what: str) -> BadInputError:
    line = text.split("\n")[0][:200]
    return BadInputError.about("why", line, what)
