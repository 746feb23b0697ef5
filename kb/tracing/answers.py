"""Programs grounded once to be asked often: their whole answer sets, the instances of their rules, and their costs."""

from collections.abc import Callable, Iterable, Sequence
from functools import lru_cache
from typing import Any, NamedTuple, TypeVar

import clingo

from utak.kb.tracing.instrument import instance_rules, relaxed_rules, weight_rules
from utak.kb.tracing.syntax import ParsedProgram, ProgramPart, parsed

MAX_TRACE_CONFLICTS = 100_000  # conflicts of clingo's search for one answer; a convention
Read = TypeVar("Read")
Assumptions = Sequence[tuple[clingo.Symbol, bool]]


class TraceError(Exception):
    """A decision cannot be traced: the program is wrong, or the recorded answer is none of its answers."""


class PricedAnswer(NamedTuple):
    """The best answer set under assumptions."""

    atoms: frozenset[str]  # its shown atoms
    costs: tuple[tuple[int, int], ...]  # (level, cost) of each level of priority with a price, the highest level first
    # What these costs consist of: (unit, values of its named variables, weight, level)
    prices: tuple[tuple[int, tuple[str, ...], int, int], ...]
    proved: bool  # whether it was proved that no answer is better


class GroundedProgram:
    """A program with its facts, grounded by clingo."""

    def __init__(self, parts: Sequence[ProgramPart], facts: Sequence[str]) -> None:
        self.parts, self.facts = tuple(parts), tuple(facts)
        try:
            self.program: ParsedProgram = parsed(self.parts)
        except RuntimeError as error:
            raise TraceError(f"the program cannot be read: {error}") from None
        self._control = grounded([*(part.text for part in self.parts), _weight_text(self.parts)], self.facts)
        self._relaxed: clingo.Control | None = None

    def whole_answer(self, answer: Iterable[str]) -> list[clingo.Symbol]:
        """Return all atoms, also those not shown, of the answer set with the given shown atoms."""
        # Raises TraceError when the program has no such answer set.
        given = {clingo.parse_term(atom) for atom in answer}
        assumptions = self._shown_as(given)
        atoms, _ = best_model(self._control, assumptions, lambda model: model.symbols(atoms=True))
        if atoms is None and not self._control.solve(assumptions=list(assumptions)).satisfiable:
            raise TraceError("the recorded answer is no answer of this program")
        return [atom for atom in atoms or () if not atom.name.startswith("trace__")]

    def priced_answer(self, answer: Iterable[clingo.Symbol]) -> PricedAnswer:
        """Return the answer set with the given shown atoms, with its costs; TraceError when there is none."""
        found = self._best(self._shown_as(set(answer)))
        if found is None:
            raise TraceError("the recorded answer is no answer of this program")
        return found

    def best_answer(self, assumptions: Assumptions = ()) -> PricedAnswer | None:
        """Return the best answer set in which some atoms hold (True) or do not hold (False)."""
        # None when there is none.
        known = self._control.symbolic_atoms
        if any(value and known[symbol] is None for symbol, value in assumptions):
            return None
        return self._best([(symbol, value) for symbol, value in assumptions if known[symbol] is not None])

    def _best(self, assumptions: Assumptions) -> PricedAnswer | None:
        """Return the best answer set under assumptions about atoms that rules can derive; None when there is none."""
        shown, proved = best_model(self._control, assumptions, lambda model: model.symbols(shown=True))
        return None if shown is None else _priced(shown, proved)

    def broken_constraints(self, assumptions: Assumptions) -> list[tuple[int, tuple[str, ...]]] | None:
        """Return the fewest constraints that are broken where some atoms hold: (unit, values of its variables)."""
        # None when there is no answer even without constraints.
        if self._relaxed is None:
            rules = [*relaxed_rules(self.program), *(f"#defined {n}/{a}." for n, a in self.program.defined)]
            self._relaxed = grounded(rules, self.facts)
        known = self._relaxed.symbolic_atoms
        if any(value and known[symbol] is None for symbol, value in assumptions):
            return None
        possible = [(symbol, value) for symbol, value in assumptions if known[symbol] is not None]
        atoms, _ = best_model(self._relaxed, possible, lambda model: model.symbols(atoms=True))
        if atoms is None:
            return None
        broken = (atom.arguments for atom in atoms if atom.name == "trace__broken")
        return sorted((unit.number, _texts(values)) for unit, values in broken)

    def _shown_as(self, given: set[clingo.Symbol]) -> Assumptions:
        """Return the assumptions that exactly the given atoms are shown; TraceError for an atom that cannot hold."""
        known = self._control.symbolic_atoms
        strange = sorted(str(symbol) for symbol in given if known[symbol] is None)
        if strange:
            raise TraceError(f"the recorded answer is no answer of this program: {strange[0]} cannot hold in it")
        assumptions = [(symbol, True) for symbol in given]
        for name, arity in self.program.shown:
            for atom in known.by_signature(name, arity):
                if atom.symbol not in given:
                    assumptions.append((atom.symbol, False))
        return assumptions


@lru_cache(maxsize=64)
def _weight_text(parts: tuple[ProgramPart, ...]) -> str:
    """Return the helping rules for the costs of a program; the last ones are kept."""
    program = parsed(parts)
    weights = [*weight_rules(program)]
    if weights and program.shown:
        weights.append("#show trace__weight/5.")
    return "\n".join(weights)


@lru_cache(maxsize=64)
def _instance_text(parts: tuple[ProgramPart, ...]) -> str:
    """Return the helping rules for the instances of a program; the last ones are kept."""
    program = parsed(parts)
    return "\n".join([*instance_rules(program), *program.constants])


def instances(parts: tuple[ProgramPart, ...], atoms: Iterable[clingo.Symbol]) -> list[clingo.Symbol]:
    """Return the helping atoms (kb.tracing.instrument) of all instances of a program that hold in an answer set."""
    control = grounded([_instance_text(parts)], [str(atom) for atom in atoms], messages_count=False)
    found = [atom for atom in control.symbolic_atoms if atom.symbol.name.startswith("trace__")]
    if all(atom.is_fact for atom in found):
        return [atom.symbol for atom in found]
    holding, _ = best_model(control, (), lambda model: model.symbols(atoms=True))  # there is one model
    return [atom for atom in holding or () if atom.name.startswith("trace__")]


def grounded(texts: Sequence[str], facts: Sequence[str], messages_count: bool = True) -> clingo.Control:
    """Return a program grounded with its facts."""
    # Raises TraceError with clingo's first message.
    messages: list[str] = []
    control = clingo.Control(["--stats=0"], logger=lambda _code, text: messages.append(text), message_limit=20)
    try:
        control.add("base", [], "\n".join(texts))
        control.add("base", [], "".join(f"{fact}.\n" for fact in facts))
        control.ground([("base", [])])
    except RuntimeError as error:
        raise TraceError("\n".join([*messages[:1], str(error)])) from None
    harmless = ("does not occur in any rule head", "operation undefined")  # a rule without an instance for some values
    telling = [text for text in messages if not any(one in text for one in harmless)]
    if telling and messages_count:
        raise TraceError(telling[0])
    settings: Any = control.configuration.solve
    settings.solve_limit = f"{MAX_TRACE_CONFLICTS},umax"
    return control


def best_model(
    control: clingo.Control, assumptions: Sequence[Any], read: Callable[[clingo.Model], Read]
) -> tuple[Read | None, bool]:
    """Return what is read of the best model, None without one, and whether the search for it was complete."""
    found: list[Read] = []
    result = control.solve(assumptions=list(assumptions), on_model=lambda model: found.append(read(model)))
    return found[-1] if found else None, bool(result.exhausted)


def _priced(shown: Iterable[clingo.Symbol], proved: bool) -> PricedAnswer:
    """Return an answer with its costs, from shown atoms among which those of `trace__weight` are."""
    atoms: set[str] = set()
    prices: list[tuple[int, tuple[str, ...], int, int]] = []
    counted: set[tuple[clingo.Symbol, ...]] = set()
    for atom in shown:
        if atom.name != "trace__weight":
            atoms.add(str(atom))
            continue
        unit, names, weight, level, terms = atom.arguments
        key = (weight, level, terms)
        if key not in counted:
            counted.add(key)
            prices.append((unit.number, _texts(names), weight.number, level.number))
    costs: dict[int, int] = {}
    for _, _, price, height in prices:
        costs[height] = costs.get(height, 0) + price
    ordered = tuple(sorted(costs.items(), reverse=True))
    return PricedAnswer(frozenset(atoms), ordered, tuple(sorted(prices, key=lambda one: (-one[3], one))), proved)


def _texts(values: clingo.Symbol) -> tuple[str, ...]:
    """Return the members of a tuple as texts."""
    return tuple(map(str, values.arguments))
