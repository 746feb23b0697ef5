"""The answer sets of an encoding as possible worlds, each with a probability; exact, by independent components.

The weak constraints of the encoding weigh in thousandths of nats: a world that violates weights w1, w2, ... is as
probable as exp(-(w1 + w2 + ...) / 1000), all worlds together 1. A ground program falls into components that share no
open atom in any rule. Each is enumerated by itself, so that their numbers of worlds add up instead of multiplying.

The encoding shows all atoms (no `#show`): clasp tells the consequences of shown atoms alone.
"""

import math
from collections.abc import Collection, Iterable, Sequence
from functools import cached_property
from itertools import pairwise
from typing import Any, NamedTuple

import clingo

NATS = 1000.0  # weights are thousandths of nats
MAX_COMPONENT_WORLDS = 20_000  # worlds of one component; beyond, its chances are intervals from 0 to 1


class NoWorldError(Exception):
    """The encoding has no answer set: certain evidence contradicts itself."""


class Component(NamedTuple):
    """Open atoms that depend on each other, and how they may hold together."""

    atoms: frozenset[clingo.Symbol]
    # The sets of its atoms that hold together, and the probability of each, the likeliest first; () where there are
    # more than MAX_COMPONENT_WORLDS
    worlds: tuple[tuple[frozenset[clingo.Symbol], float], ...]


class PossibleWorlds:
    """The answer sets of a program, with their probabilities."""

    def __init__(self, known: frozenset[clingo.Symbol], components: Iterable[Component]) -> None:
        self.known = known  # what holds in every world
        self.components = tuple(components)

    @cached_property
    def open(self) -> frozenset[clingo.Symbol]:
        """The atoms that hold in some worlds and not in others."""
        return frozenset(atom for component in self.components for atom in component.atoms)

    def chance(self, *atoms: clingo.Symbol) -> tuple[float, float]:
        """Return the least and the greatest probability that some atoms hold together; equal where it is exact."""
        wanted = frozenset(atoms) - self.known
        if not wanted <= self.open:
            return 0.0, 0.0
        least = greatest = 1.0
        for component in self.components:
            here = wanted & component.atoms
            if here:
                share = math.fsum(chance for world, chance in component.worlds if here <= world)
                least *= share
                greatest *= share if component.worlds else 1.0
        return least, greatest

    def likeliest(self, number: int) -> list[tuple[tuple[frozenset[clingo.Symbol], ...], float]]:
        """Return the likeliest worlds, each as what holds in each component, with its probability."""
        best: list[tuple[tuple[frozenset[clingo.Symbol], ...], float]] = [((), 1.0)]
        for component in self.components:
            choices = component.worlds or ((frozenset(), 1.0),)
            longer = [((*there, world), chance * more) for there, chance in best for world, more in choices]
            best = sorted(longer, key=lambda entry: -entry[1])[:number]
        return best


def possible_worlds(program: str, most: int = MAX_COMPONENT_WORLDS) -> PossibleWorlds:
    """Return the possible worlds of a program without `#show`."""
    known, possible = _consequences(program, "cautious"), _consequences(program, "brave")
    control, ground = _grounded(program, ["--opt-mode=ignore", "0"])
    symbols = {atom.literal: atom.symbol for atom in control.symbolic_atoms}
    undecided = possible - known
    settled = {number: symbol in known for number, symbol in symbols.items() if symbol not in undecided}
    open_atoms = {symbol: number for number, symbol in symbols.items() if number not in settled}
    groups = ground.groups(settled, open_atoms.values())
    with control.solve(yield_=True) as handle:
        model = handle.model()
        assert model is not None  # there are consequences, so there is an answer set
        one = {symbol: model.contains(symbol) for symbol in open_atoms}
    components = []
    for numbers in groups:
        atoms = frozenset(symbols[number] for number in numbers)
        others = [(symbol, value) for symbol, value in one.items() if symbol not in atoms]
        tied = ground.tied(numbers)
        weights = [(literal, weight) for literal, weight in ground.weights if abs(literal) in tied]
        components.append(Component(atoms, _worlds(control, atoms, others, weights, most)))
    return PossibleWorlds(frozenset(known), sorted(components, key=lambda one: sorted(map(str, one.atoms))))


def likeliest_worlds(program: str, number: int) -> dict[str, Any]:
    """Return the likeliest worlds as JSON values, for `Alternatives`; `failed` says that there is none."""
    try:
        found = possible_worlds(program)
    except NoWorldError as error:
        return {"failed": str(error)}
    chosen = {
        clingo.Function("true", [atom.arguments[-1]])
        for atom in found.known
        if atom.match("alone", 1) or atom.match("choice", 2)
    }
    deciding: dict[clingo.Symbol, list[str]] = {}
    for atom in found.known:
        if atom.match("decides", 2):
            deciding.setdefault(atom.arguments[1], []).append(str(atom.arguments[0]))
    open_facts = sorted(found.open & chosen, key=str)
    return {
        "worlds": [
            [chance, sorted(str(atom.arguments[0]) for part in parts for atom in part & chosen)]
            for parts, chance in found.likeliest(number)
        ],
        "open": [
            [str(fact), *found.chance(atom), sorted(deciding.get(fact, ()))]
            for atom in open_facts
            for fact in atom.arguments
        ],
    }


def _worlds(
    control: clingo.Control,
    atoms: Collection[clingo.Symbol],
    others: Sequence[tuple[clingo.Symbol, bool]],
    weights: Sequence[tuple[int, int]],
    most: int,
) -> tuple[tuple[frozenset[clingo.Symbol], float], ...]:
    """Return the worlds of one component, all else as in one world of the program."""
    costs: dict[frozenset[clingo.Symbol], float] = {}
    with control.solve(assumptions=others, yield_=True) as handle:
        for number, model in enumerate(handle):
            if number == most:
                return ()
            there = frozenset(atom for atom in atoms if model.contains(atom))
            costs[there] = sum(weight for literal, weight in weights if model.is_true(literal)) / NATS
    least = min(costs.values())
    shares = {there: math.exp(least - cost) for there, cost in costs.items()}
    whole = math.fsum(shares.values())
    found = ((there, share / whole) for there, share in shares.items())
    return tuple(sorted(found, key=lambda entry: (-entry[1], sorted(map(str, entry[0])))))


class _GroundProgram(clingo.Observer):
    """The rules and weights of a ground program, as clingo tells them."""

    def __init__(self) -> None:
        self.rules: list[tuple[tuple[int, ...], tuple[int, ...]]] = []  # the atoms of a head, the literals of a body
        self.weights: list[tuple[int, int]] = []  # literals whose truth costs a weight
        self._group: dict[int, int] = {}

    def rule(self, choice: bool, head: Sequence[int], body: Sequence[int]) -> None:
        """Take a rule."""
        self.rules.append((tuple(head), tuple(body)))

    def weight_rule(self, choice: bool, head: Sequence[int], lower_bound: int, body: Sequence[tuple[int, int]]) -> None:
        """Take a rule whose body has a weight."""
        self.rules.append((tuple(head), tuple(literal for literal, _ in body)))

    def minimize(self, priority: int, literals: Sequence[tuple[int, int]]) -> None:
        """Take weak constraints; all levels weigh alike."""
        self.weights += literals

    def groups(self, settled: dict[int, bool], named: Iterable[int]) -> list[list[int]]:
        """Return the open atoms with a name in groups that no rule ties together."""
        for head, body in self.rules:
            if any((literal > 0) != settled[abs(literal)] for literal in body if abs(literal) in settled):
                continue  # a settled atom switches this rule off
            atoms = [abs(literal) for literal in body if abs(literal) not in settled]
            # What holds in every world may still need one of several bodies: it ties these together.
            atoms += [atom for atom in head if settled.get(atom, True) and (atom not in settled or atoms)]
            for one, other in pairwise(atoms):
                self._group[self._first(one)] = self._first(other)
        found: dict[int, list[int]] = {}
        for number in named:
            found.setdefault(self._first(number), []).append(number)
        return list(found.values())

    def tied(self, numbers: Sequence[int]) -> frozenset[int]:
        """Return all atoms, also those without a name, that are in the group of some atoms."""
        first = self._first(numbers[0])
        return frozenset(number for number in [*self._group, *numbers] if self._first(number) == first)

    def _first(self, number: int) -> int:
        """Return the atom that stands for a group."""
        while (above := self._group.setdefault(number, number)) != number:
            self._group[number] = self._group.get(above, above)
            number = self._group[number]
        return number


def _grounded(program: str, options: list[str]) -> tuple[clingo.Control, _GroundProgram]:
    """Return a program grounded, and its rules."""
    control, ground = clingo.Control(["--warn=none", *options]), _GroundProgram()
    control.register_observer(ground)
    control.add("base", [], program)
    control.ground([("base", [])])
    return control, ground


def _consequences(program: str, kind: str) -> set[clingo.Symbol]:
    """Return what holds in all answer sets (cautious), or in any one (brave)."""
    control, _ = _grounded(program, ["--opt-mode=ignore", f"--enum-mode={kind}", "0"])
    found: set[clingo.Symbol] | None = None
    with control.solve(yield_=True) as handle:
        for model in handle:
            found = set(model.symbols(shown=True))
    if found is None:
        raise NoWorldError("no world agrees with what is certain")
    return found
