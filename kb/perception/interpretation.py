"""From regions, touches and fits to kinds and shapes: facts in, kb/asp's answers out."""

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import NamedTuple

from kb.perception.regions import Percept
from kb.reasoning.solver import KB, solve


class Kinds(NamedTuple):
    """What each region is taken for.

    kind : region -> {floor, verge, object or utak: confidence in percent}.
    hidden_passages : pairs of zero regions that must be connected by floor not seen.
    """

    kind: Mapping[str, Mapping[str, int]]
    hidden_passages: frozenset[tuple[str, str]]

    def of(self, region: str, kind: str) -> int:
        """The confidence that a region is of a kind; 0 when nothing speaks for it."""
        return self.kind.get(region, {}).get(kind, 0)


def percept_facts(percept: Percept, touched: Iterable[tuple[str, str]] = ()) -> list[str]:
    """The facts that kb/asp/interpretation.lp wants. touched: pairs (region, colour felt there)."""
    facts = []
    for region in percept.regions:
        facts.append(f"region({region.name},{'nonzero' if region.occupied else 'zero'},{region.certain})")
        facts += [f"extent({region.name},{region.extent})", f"mass({region.name},{region.mass})"]
        facts += [f"rim({region.name})"] * region.rim + [f"own({region.name})"] * region.own
    facts += [f"surrounds({outer},{inner})" for outer, inner in sorted(percept.surrounds)]
    facts += [f"touched({region},{colour})" for region, colour in sorted(set(touched))]
    return facts


def interpret(percept: Percept, touched: Iterable[tuple[str, str]] = (), rules: tuple[Path, ...] = ()) -> Kinds:
    """Decide what every region is. rules: the user's own encodings, beside ours."""
    kind: dict[str, dict[str, int]] = {}
    passages = set()
    for atom in solve([KB / "interpretation.lp", *rules], percept_facts(percept, touched)) or ():
        args = [str(a) for a in atom.arguments]
        if atom.match("kind", 3):
            known = kind.setdefault(args[0], {})
            known[args[1]] = max(known.get(args[1], 0), int(args[2]))
        elif atom.match("hidden_passage", 2):
            passages.add((args[0], args[1]))
    return Kinds(kind, frozenset(passages))


def shapes(facts: Iterable[str], rules: tuple[Path, ...] = ()) -> Mapping[str, Mapping[str, int]]:
    """The shapes of nodes, node -> {shape: confidence}, from facts fit/3 and open_squares/2."""
    answer: dict[str, dict[str, int]] = {}
    for atom in solve([KB / "shapes.lp", *rules], facts) or ():
        if atom.match("shape", 3):
            node, shape, confidence = (str(a) for a in atom.arguments)
            known = answer.setdefault(node, {})
            known[shape] = max(known.get(shape, 0), int(confidence))
    return answer
