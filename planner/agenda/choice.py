"""The next activity, chosen by planner/asp/deciding from what is left to do and what came of earlier ones."""

from collections.abc import Iterable
from typing import NamedTuple

from utak.planner.carrying.open_facts import OpenQuestion
from utak.planner.decision import Decision, TaskVerdict, nothing_to_do
from utak.planner.navigation.subgoals import TENTHS_PER_SQUARE
from utak.planner.question import Atoms, Question


class Activity(NamedTuple):
    """Something that the robot may do next."""

    kind: str  # what it does, as planner/asp/deciding names it, such as carry.
    subject: str = ""  # what it is about, such as the name of a goal; "" for nothing in particular

    def __str__(self) -> str:
        """Return the activity as the encoding writes it."""
        return f"{self.kind}({self.subject})" if self.subject else self.kind


class StageEnd(NamedTuple):
    """Nothing is left to do for a stage."""

    verdict: TaskVerdict  # `done` for a stage that is attained; else the verdict with which the robot gives up
    forbidden: str = ""  # by which users' rules all that may still be done is forbidden, in words; "" where it is not


def _chooses_nothing(atoms: Atoms) -> bool:
    """Return whether an answer, given by the shown atoms, has neither an activity nor an end."""
    return not any(atom.name in ("do", "verdict", "stage_attained") for atom in atoms)


class Agenda:
    """The choice among activities within one decision, with the results of those that were tried."""

    def __init__(self, given: Question) -> None:
        """Make an agenda on which nothing was done."""
        self.question = given
        self._stuck: list[str] = []
        self.open = OpenQuestion((), bool)  # whether open facts overturn what the robot is stuck with
        self.named: tuple[str, ...] = ()  # the open facts that are supposed, or on which the verdict depends

    @property
    def results(self) -> tuple[str, ...]:
        """The results of activities, and what the robot is stuck with, as facts without full stops."""
        return (*(fact for fact in self.question.facts if fact.startswith("came_to(")), *self._stuck)

    def next(self) -> Activity | StageEnd:
        """Return the activity that is chosen now, or the end when nothing is left."""
        answer = self.question.answer("activities", "verdicts") or ()
        self._stuck = [str(atom) for atom in answer if atom.name == "stuck"]
        self.named = tuple({str(atom.arguments[0]): "" for atom in answer if atom.name in ("suppose", "depends")})
        for atom in answer:
            if atom.name == "do":
                activity = atom.arguments[0]
                return Activity(activity.name, " ".join(map(str, activity.arguments)))
            if atom.name in ("verdict", "stage_attained"):
                return StageEnd(TaskVerdict(str(atom.arguments[0])) if atom.arguments else TaskVerdict.DONE)
        blamed = self.question.blamed(_chooses_nothing)
        return StageEnd(
            TaskVerdict.LIMIT, f", by the rule at {' and '.join(blamed)}" if blamed else ", as far as is known"
        )

    def note(self, activity: Activity, decision: Decision) -> None:
        """Note that an activity came to no command, and why."""
        self.question = self.question.adding(
            [f"came_to({activity},{decision.result})"], [f"{activity}: {decision.why}"]
        )

    def learn(self, facts: Iterable[str]) -> None:
        """Note more facts, without full stops."""
        self.question = self.question.adding(facts)

    def ask(self, activity: Activity, asked: OpenQuestion) -> None:
        """Note the open facts that an activity found."""
        self.open = asked
        self.note(activity, nothing_to_do(f"{len(asked.facts) or 'no'} open facts are known"))
        facts = [
            f"open_fact({name},{one.kind},{round(TENTHS_PER_SQUARE * one.far)})" for name, one in asked.facts.items()
        ]
        self.question = self.question.adding(facts, (f"{name}: {one.words}" for name, one in asked.facts.items()))
