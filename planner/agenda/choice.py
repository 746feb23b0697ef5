"""The next activity, chosen by planner/asp/agenda.lp from what is left to do and what came of earlier ones."""

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from utak.kb.reasoning.solver import solve
from utak.kb.reasoning.user_rules import rules_to_blame
from utak.kb.tracing.decisions import record_decisions
from utak.planner.carrying.open_facts import OpenQuestion
from utak.planner.decision import Decision, TaskVerdict, nothing_to_do
from utak.planner.navigation.subgoals import PLANNER_ASP, TENTHS_PER_SQUARE


class Activity(NamedTuple):
    """Something that the robot may do next."""

    kind: str  # what it does, as planner/asp/agenda.lp names it, such as carry.
    subject: str = ""  # what it is about, such as the name of a goal; "" for nothing in particular

    def __str__(self) -> str:
        """Return the activity as the encoding writes it."""
        return f"{self.kind}({self.subject})" if self.subject else self.kind


class StageEnd(NamedTuple):
    """Nothing is left to do for a stage."""

    verdict: TaskVerdict  # `done` for a stage that is attained; else the verdict with which the robot gives up
    forbidden: str = ""  # by which users' rules all that may still be done is forbidden, in words; "" where it is not


def _chooses_nothing(atoms: Sequence[Any]) -> bool:
    """Return whether an answer, given by the shown atoms, has neither an activity nor an end."""
    return not any(atom.name in ("do", "verdict", "stage_attained") for atom in atoms)


class Agenda:
    """The choice among activities within one decision, with the results of those that were tried."""

    def __init__(self, given: Iterable[str], rules: Sequence[Path], about: Sequence[str]) -> None:
        """Make an agenda on which nothing was done."""
        self._facts, self._about = list(given), list(about)
        self._files = [PLANNER_ASP / "agenda.lp", *rules]
        self._stuck: list[str] = []
        self.question = OpenQuestion((), bool)  # whether open facts overturn what the robot is stuck with
        self.named: tuple[str, ...] = ()  # the open facts that are supposed, or on which the verdict depends

    @property
    def results(self) -> tuple[str, ...]:
        """The results of activities, and what the robot is stuck with, as facts without full stops."""
        return (*(fact for fact in self._facts if fact.startswith("came_to(")), *self._stuck)

    def next(self) -> Activity | StageEnd:
        """Return the activity that is chosen now, or the end when nothing is left."""
        with record_decisions():  # of all choices, only the last one is recorded
            answer = solve(self._files, self._facts) or ()
        self._stuck = [str(atom) for atom in answer if atom.name == "stuck"]
        self.named = tuple({str(atom.arguments[0]): "" for atom in answer if atom.name in ("suppose", "depends")})
        for atom in answer:
            if atom.name == "do":
                activity = atom.arguments[0]
                return Activity(activity.name, " ".join(map(str, activity.arguments)))
            if atom.name in ("verdict", "stage_attained"):
                return StageEnd(TaskVerdict(str(atom.arguments[0])) if atom.arguments else TaskVerdict.DONE)
        agenda, *rules = self._files
        blamed = rules_to_blame(agenda, rules, self._facts, _chooses_nothing)
        where = f", by the rule at {' and '.join(blamed)}" if blamed else ", as far as is known"
        return StageEnd(TaskVerdict.LIMIT, where)

    def note(self, activity: Activity, decision: Decision) -> None:
        """Note that an activity came to no command, and why."""
        self._facts.append(f"came_to({activity},{decision.result})")
        self._about.append(f"{activity}: {decision.why}")

    def learn(self, facts: Iterable[str]) -> None:
        """Note more facts, without full stops."""
        self._facts += facts

    def ask(self, activity: Activity, question: OpenQuestion) -> None:
        """Note the open facts that an activity found."""
        self.question = question
        self.note(activity, nothing_to_do(f"{len(question.facts) or 'no'} open facts are known"))
        facts = question.facts.items()
        self._about += [f"{name}: {fact.words}" for name, fact in facts]
        self.learn(f"open_fact({name},{fact.kind},{round(TENTHS_PER_SQUARE * fact.far)})" for name, fact in facts)

    def record(self) -> None:
        """Write the last choice into the record of decisions: it has the facts of all that were refused before."""
        solve(self._files, self._facts, about=self._about)
