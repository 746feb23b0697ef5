"""The smallest changes of the input facts with which a wanted atom holds: facts given besides, and facts taken away.

The program is grounded once with every candidate as a fact that may be given and every given fact as one that may be
taken away. Where no choice is involved, clingo itself finds a change of least size. Where costs decide what is chosen,
changes are tried in order of their size, each with two searches under assumptions: for the best answer, and for the
best one with the wanted atom. The atom holds after a change when both cost the same.
"""

from collections.abc import Iterator, Sequence
from itertools import combinations
from typing import Any, NamedTuple

import clingo

from kb.tracing.answers import MAX_TRACE_CONFLICTS, TraceError
from kb.tracing.candidates import CandidateFacts
from kb.tracing.syntax import ParsedProgram

MAX_CHECKS = 900  # changes that are tried where costs decide; a convention, one to three seconds
MAX_CHANGE_SIZE = 12  # facts of one change; a convention
FactChange = tuple[int, ...]  # indices of switches, ascending


class FoundChange(NamedTuple):
    """A change of the input facts after which the wanted atom holds, or none.

    Attributes
    ----------
    missing : facts that must be given besides.
    in_way : given facts that must be taken away.
    found : whether there is such a change; else both are ().
    least : whether no change of fewer facts among the candidates would do.
    """

    missing: tuple[str, ...]
    in_way: tuple[str, ...]
    found: bool
    least: bool


class ChangeSearch:
    """A program whose input facts can be switched on and off.

    Parameters
    ----------
    program : the program taken apart.
    facts : its input facts.
    candidates : what may be given besides, and which predicates matter.
    wanted : the atom that shall hold.
    """

    def __init__(
        self, program: ParsedProgram, facts: Sequence[str], candidates: CandidateFacts, wanted: clingo.Symbol
    ) -> None:
        self._wanted, self._by_choice = wanted, candidates.by_choice
        self._removable = [fact for fact in facts if _signature(fact) in candidates.relevant]
        self._addable = list(candidates.facts)
        fixed = [fact for fact in facts if _signature(fact) not in candidates.relevant]
        self._control = _switched(program, fixed, self._removable, self._addable, candidates.by_choice)
        self._switches = self._switch_literals()
        self._checks = 0

    def least_change(self) -> FoundChange:
        """Return a change of least size with which the wanted atom holds, as far as the limits of the search allow."""
        possible = self._possible_change()
        if possible is None:
            return FoundChange((), (), False, True)
        if not self._by_choice:
            return self._as_found(possible, True)
        for size in range(len(possible) if possible else 0, MAX_CHANGE_SIZE + 1):
            for change in self._changes_of_size(size):
                if self._checks >= MAX_CHECKS:
                    return self._greedy(possible)
                if self._holds(change):
                    return self._as_found(change, True)
        return self._greedy(possible)

    def _switch_literals(self) -> list[int]:
        """Return the solver literals of all switches: those that take facts away, then those that give facts."""
        known = self._control.symbolic_atoms
        numbers = [("trace__gone", len(self._removable)), ("trace__added", len(self._addable))]
        found = []
        for name, count in numbers:
            for index in range(count):
                atom = known[clingo.Function(name, [clingo.Number(index)])]
                assert atom is not None
                found.append(atom.literal)
        return found

    def _possible_change(self) -> FactChange | None:
        """Return a change of least size after which some answer holds the atom, at whatever cost; None without one."""
        wanted = self._control.symbolic_atoms[self._wanted]
        if wanted is None:
            return None
        if not self._by_choice:
            return self._solved([wanted.literal], "opt")
        for size in range(MAX_CHANGE_SIZE + 1):
            bound = self._control.symbolic_atoms[clingo.Function("trace__size", [clingo.Number(size)])]
            assert bound is not None
            found = self._solved([wanted.literal, bound.literal], "ignore")
            if found is not None:
                return found
        return None

    def _solved(self, assumptions: Sequence[int], mode: str) -> FactChange | None:
        """Return the switches that are on in the best answer, or in any one with the mode `ignore`; or None."""
        best: list[FactChange] = []

        def keep(model: clingo.Model) -> None:
            """Keep the change of a model."""
            best[:] = [self._change_of(model)]

        settings: Any = self._control.configuration.solve
        settings.opt_mode = mode
        self._control.solve(assumptions=list(assumptions), on_model=keep)
        settings.opt_mode = "opt"
        return best[0] if best else None

    def _change_of(self, model: clingo.Model) -> FactChange:
        """Return the switches that are on in a model."""
        return tuple(index for index, literal in enumerate(self._switches) if model.is_true(literal))

    def _holds(self, change: FactChange) -> bool:
        """Return whether the wanted atom is part of some best answer after a change."""
        self._checks += 1
        on = set(change)
        assumptions = [literal if index in on else -literal for index, literal in enumerate(self._switches)]
        wanted = self._control.symbolic_atoms[self._wanted]
        if wanted is None:
            return False
        with_wanted = self._best_cost([*assumptions, wanted.literal])
        return with_wanted is not None and with_wanted == self._best_cost(assumptions)

    def _best_cost(self, assumptions: Sequence[int]) -> list[int] | None:
        """Return the cost of the best answer under assumptions; None when there is none."""
        costs: list[list[int]] = []
        self._control.solve(assumptions=list(assumptions), on_model=lambda model: costs.append(list(model.cost)))
        return costs[-1] if costs else None

    def _changes_of_size(self, size: int) -> Iterator[FactChange]:
        """Yield the changes of a size: those that only take facts away, and for two those that replace one, first."""
        removals = len(self._removable)
        seen = dict.fromkeys(combinations(range(removals), size))
        yield from seen
        if size == 2:
            near = [pair for pair in self._replacements() if pair not in seen]
            yield from near
            seen |= dict.fromkeys(near)
        yield from (change for change in combinations(range(len(self._switches)), size) if change not in seen)

    def _replacements(self) -> Iterator[FactChange]:
        """Yield the pairs of a given fact and a candidate that differ in one argument."""
        gone = [clingo.parse_term(fact) for fact in self._removable]
        for index, text in enumerate(self._addable):
            added = clingo.parse_term(text)
            for number, fact in enumerate(gone):
                if fact.name == added.name and len(fact.arguments) == len(added.arguments):
                    pairs = zip(fact.arguments, added.arguments, strict=True)
                    if sum(one != other for one, other in pairs) == 1:
                        yield number, len(gone) + index

    def _greedy(self, possible: FactChange) -> FoundChange:
        """Return a change of which no member can be left out, found by taking away facts one after the other."""
        change = possible
        for index in range(len(self._removable)):
            if self._holds(change):
                break
            if index not in change and self._wanted_is_possible((*change, index)):
                change = tuple(sorted({*change, index}))
        if not self._holds(change):
            return FoundChange((), (), False, False)
        for index in sorted(change, reverse=True):
            fewer = tuple(other for other in change if other != index)
            if self._holds(fewer):
                change = fewer
        return self._as_found(change, False)

    def _wanted_is_possible(self, change: FactChange) -> bool:
        """Return whether some answer holds the wanted atom after a change, whatever it costs."""
        on = set(change)
        assumptions = [literal if index in on else -literal for index, literal in enumerate(self._switches)]
        wanted = self._control.symbolic_atoms[self._wanted]
        return wanted is not None and bool(self._control.solve(assumptions=[*assumptions, wanted.literal]).satisfiable)

    def _as_found(self, change: FactChange, least: bool) -> FoundChange:
        """Return a change as facts."""
        count = len(self._removable)
        in_way = tuple(sorted(self._removable[index] for index in change if index < count))
        missing = tuple(sorted(self._addable[index - count] for index in change if index >= count))
        return FoundChange(missing, in_way, True, least)


def _signature(fact: str) -> tuple[str, int]:
    """Return the predicate of a fact."""
    symbol = clingo.parse_term(fact)
    return symbol.name, len(symbol.arguments)


def _switched(
    program: ParsedProgram,
    fixed: Sequence[str],
    removable: Sequence[str],
    addable: Sequence[str],
    by_choice: bool,
) -> clingo.Control:
    """Return the program grounded with switches for facts.

    Without a choice the number of switches that are on is minimised; with one, the costs of the program are, and
    `trace__size(N)` says that at most N switches are on.
    """
    lines = [str(one.node) for one in program.statements if one.kind != "weak" or by_choice]
    lines += [*program.constants, *(f"#defined {name}/{arity}." for name, arity in program.defined)]
    lines += [f"{fact}." for fact in fixed]
    lines += ["#defined trace__gone/1.", "#defined trace__added/1."]
    lines += [
        f"{{ trace__gone({index}) }}. {fact} :- not trace__gone({index})." for index, fact in enumerate(removable)
    ]
    lines += [f"{{ trace__added({index}) }}. {fact} :- trace__added({index})." for index, fact in enumerate(addable)]
    if by_choice:
        lines.append(f"{{ trace__size(0..{MAX_CHANGE_SIZE}) }}.")
        lines.append(":- trace__size(N), N < #count { 0,I : trace__gone(I); 1,I : trace__added(I) }.")
    else:
        # Among changes of one size those of candidates that stand first are preferred, for the same change each time.
        lines.append(":~ trace__gone(I). [1@2,0,I]")
        lines.append(":~ trace__added(I). [1@2,1,I]")
        lines.append(":~ trace__added(I). [I+1@1,1,I]")
    control = clingo.Control(["--stats=0"], logger=lambda _code, _text: None, message_limit=20)
    try:
        control.add("base", [], "\n".join(lines))
        control.ground([("base", [])])
    except RuntimeError as error:
        raise TraceError(str(error)) from None
    settings: Any = control.configuration.solve
    settings.solve_limit = f"{MAX_TRACE_CONFLICTS},umax"
    return control
