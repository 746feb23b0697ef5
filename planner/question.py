"""The question what to do, which one decision puts to planner/asp/deciding.

The parts of a decision add their facts one after the other: what is left to do for the stage, the subgoals of the
activity that was chosen, links and ways to the subgoal that was chosen, at last the steps of the robot. Each time all
that was given before is asked with them, so users' rules may speak of all of it together. The last answer is the whole
decision, and the one that is recorded.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

from utak.kb.language.vocabulary import Signature
from utak.kb.reasoning.encodings import SHARED_PARTS, BoundedAnswer, encoding_files
from utak.kb.reasoning.solver import solve, solve_within
from utak.kb.reasoning.user_rules import rules_speak_of, rules_to_blame
from utak.kb.tracing.decisions import record_decisions

PLANNER_ASP = Path(__file__).resolve().parent / "asp"  # the folder of the planner's encodings
DECIDING_ENCODING = PLANNER_ASP / "deciding"
MAX_DECIDING_CONFLICTS = 20_000  # of clingo's search for a walk; a bound on work, so that all machines do the same
Atoms = Sequence[Any]  # as clingo shows them
Found = TypeVar("Found")  # what comes of an option; false for nothing


class Question(NamedTuple):
    """All that is given until now, and users' rules."""

    rules: tuple[Path, ...] = ()  # the users' rule files
    facts: tuple[str, ...] = ()  # without full stops
    # What the candidates are: a numbered one by its number, and others in texts that begin with their name and a colon
    about: tuple[Any, ...] = ()

    def adding(self, facts: Iterable[str], about: Iterable[Any] = ()) -> "Question":
        """Return the question with more given."""
        return self._replace(facts=(*self.facts, *facts), about=(*self.about, *about))

    def keeping(self, choice: str) -> "Question":
        """Return the question with a choice that was made."""
        # Without users' rules what is given later changes no choice that was made before.
        return self.adding([f"kept({choice})"]) if self.rules else self

    def speaks_of(self, predicates: Iterable[Signature]) -> bool:
        """Return whether users' rules that take part speak of any of some predicates."""
        return rules_speak_of(DECIDING_ENCODING.stem, self.rules, predicates)

    def answer(self, *parts: str) -> list[Any] | None:
        """Return the shown atoms of the best answer; None when there is none."""
        # parts : the files that make a choice, alone where no rules of users speak of several together; () for all
        with record_decisions():  # a part of a decision
            return solve(self._files(parts), self.facts, about=self.about)

    def first_of(self, part: str, name: str, options: "Mapping[str, Callable[[Question], Found]]") -> Found | None:
        """Return what comes of the option that a part of the program chooses of those of which something comes."""
        # name : the predicate of the choice. Each option is called with what is given and the choice that is kept.
        question = self
        while (choice := str(argument(question.answer(part) or (), name))) in options:
            if found := options[choice](question.keeping(f"{name}({choice})")):
                return found
            question = question.adding([f"vain({choice})"])
        return None

    def recorded(self) -> list[Any] | None:
        """Return the same, and write it into the record of decisions."""
        return solve([DECIDING_ENCODING, *self.rules], self.facts, about=self.about)

    def bounded(self, *parts: str) -> BoundedAnswer:
        """Return the best answer that is found within MAX_DECIDING_CONFLICTS conflicts."""
        with record_decisions():
            return solve_within(self._files(parts), self.facts, MAX_DECIDING_CONFLICTS)

    def _files(self, parts: Sequence[str]) -> list[Path]:
        """Return the files that are solved."""
        if self.rules or not parts:
            return [DECIDING_ENCODING, *self.rules]
        return [path for path in encoding_files(DECIDING_ENCODING) if path.stem in ("inputs", *parts, *SHARED_PARTS)]

    def blamed(self, is_bad: Callable[[Atoms], bool]) -> tuple[str, ...]:
        """Return the users' rules because of which the answer is bad, or there is none, as `rules.lp:3`."""
        return rules_to_blame(DECIDING_ENCODING, self.rules, self.facts, is_bad) if self.rules else ()


NO_QUESTION = Question()  # nothing is given


def argument(answer: Iterable[Any], name: str) -> Any:
    """Return the first argument of the first atom of a name in an answer; None where there is none."""
    return next((atom.arguments[0] for atom in answer if atom.name == name), None)
