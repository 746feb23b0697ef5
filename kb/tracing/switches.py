"""A program whose input facts can be switched on and off: given facts taken away, candidates given besides.

A change is a set of switches that are on, as their indices, ascending: first those that take given facts away, then
those that give candidates.
"""

from collections.abc import Sequence
from typing import Any

import clingo

from utak.kb.tracing.answers import best_model, grounded
from utak.kb.tracing.candidates import CandidateFacts
from utak.kb.tracing.syntax import ParsedProgram

MAX_CHANGE_SIZE = 12  # facts of one change that is looked for size by size; a convention
FactChange = tuple[int, ...]


class SwitchedProgram:
    """A program grounded once with switches for its facts, and an atom that is wanted."""

    def __init__(
        self, program: ParsedProgram, facts: Sequence[str], candidates: CandidateFacts, wanted: clingo.Symbol
    ) -> None:
        self.removable = list(candidates.removable)
        self.addable = list(candidates.facts)
        self.checks = 0
        fixed = [fact for fact in facts if fact not in candidates.removable]
        self._control = _switched(program, fixed, self.removable, self.addable, candidates.by_choice)
        known = self._control.symbolic_atoms
        names = [clingo.Function("trace__gone", [clingo.Number(index)]) for index in range(len(self.removable))]
        names += [clingo.Function("trace__added", [clingo.Number(index)]) for index in range(len(self.addable))]
        self._switches = [found.literal for name in names if (found := known[name]) is not None]
        atom = known[wanted]
        self._wanted = None if atom is None else atom.literal

    def least_of_one_answer(self) -> FactChange | None:
        """Return a change of least size after which the only answer holds the wanted atom; None when none does."""
        return None if self._wanted is None else self._solved([self._wanted], "opt")

    def least_possible(self) -> FactChange | None:
        """Return a change of least size after which some answer holds the wanted atom, at whatever cost; or None."""
        if self._wanted is None:
            return None
        for size in range(MAX_CHANGE_SIZE + 1):
            bound = self._control.symbolic_atoms[clingo.Function("trace__size", [clingo.Number(size)])]
            assert bound is not None
            found = self._solved([self._wanted, bound.literal], "ignore")
            if found is not None:
                return found
        return None

    def excess(self, change: FactChange) -> tuple[int, ...] | None:
        """Return by how much the best answer with the wanted atom is dearer than the best one, after a change."""
        # None when no answer holds it.
        self.checks += 1
        on = set(change)
        assumptions = [literal if index in on else -literal for index, literal in enumerate(self._switches)]
        with_wanted = None if self._wanted is None else self._best_cost([*assumptions, self._wanted])
        best = None if with_wanted is None else self._best_cost(assumptions)
        if with_wanted is None or best is None:
            return None
        return tuple(one - other for one, other in zip(with_wanted, best, strict=True))

    def _solved(self, assumptions: Sequence[int], mode: str) -> FactChange | None:
        """Return the switches that are on in the best answer, or in any one with the mode `ignore`; or None."""
        settings: Any = self._control.configuration.solve
        settings.opt_mode = mode
        change, _ = best_model(
            self._control,
            assumptions,
            lambda model: tuple(index for index, literal in enumerate(self._switches) if model.is_true(literal)),
        )
        settings.opt_mode = "opt"
        return change

    def _best_cost(self, assumptions: Sequence[int]) -> list[int] | None:
        """Return the cost of the best answer under assumptions; None when there is none."""
        return best_model(self._control, assumptions, lambda model: list(model.cost))[0]


def _switched(
    program: ParsedProgram, fixed: Sequence[str], removable: Sequence[str], addable: Sequence[str], by_choice: bool
) -> clingo.Control:
    """Return the program grounded with switches for facts."""
    lines = [str(one.node) for one in program.statements if one.kind != "weak" or by_choice]
    lines += [*program.constants, *(f"#defined {name}/{arity}." for name, arity in program.defined)]
    lines += [f"{fact}." for fact in fixed]
    lines += ["#defined trace__gone/1.", "#defined trace__added/1."]
    for index, fact in enumerate(removable):
        lines.append(f"{{ trace__gone({index}) }}. {fact} :- not trace__gone({index}).")
    for index, fact in enumerate(addable):
        lines.append(f"{{ trace__added({index}) }}. {fact} :- trace__added({index}).")
    if by_choice:
        lines.append(f"{{ trace__size(0..{MAX_CHANGE_SIZE}) }}.")
        lines.append(":- trace__size(N), N < #count { 0,I : trace__gone(I); 1,I : trace__added(I) }.")
    else:
        # Among changes of one size those of candidates that stand first are preferred, for the same change each time.
        lines.append(":~ trace__gone(I). [1@2,0,I]")
        lines.append(":~ trace__added(I). [1@2,1,I]")
        lines.append(":~ trace__added(I). [I+1@1,1,I]")
    return grounded(lines, (), messages_count=False)
