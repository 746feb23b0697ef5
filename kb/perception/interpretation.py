"""Interpretation: what each region is, and which shape an object has. Facts go in, answers of kb/asp come out."""

from collections.abc import Iterable, Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import NamedTuple

from utak.kb.language.atoms import signature_of
from utak.kb.perception.regions import Percept
from utak.kb.reasoning.encodings import KB_ENCODINGS, encoding_constant, encoding_facts
from utak.kb.reasoning.solver import solve
from utak.kb.reasoning.user_rules import predicates_read, rules_reach
from utak.kb.tracing.decisions import record_decisions

SHAPES = KB_ENCODINGS / "shapes.lp"
PLACE_PRIORS = KB_ENCODINGS / "place_priors.lp"
INTERPRETATION = KB_ENCODINGS / "interpretation.lp"
LONGEST_OBJECT = encoding_constant(INTERPRETATION, "longest_object")  # squares: what is longer is no object
# Percent: of things that were felt and cut out of the bounds (kb.world.objects), so many were objects; counted
FELT_OBJECT_CONFIDENCE = encoding_constant(INTERPRETATION, "cut_object")
UNTRIED_MOVABLE = encoding_constant(INTERPRETATION, "untried_movable")  # percent: of objects never tried; counted
MIN_OBJECT_BELIEF = 5  # percent: a region less likely an object is none: 1 of 20, a convention
SURELY_VERGE = 100 - MIN_OBJECT_BELIEF  # percent: of what is no object then
LARGE_MASS = 1000  # tenths of squares: of what is surely there


class Kinds(NamedTuple):
    """The kinds that regions are taken for."""

    # Region -> {floor, verge, object or utak: confidence in percent}. A region of which nothing is derived is missing.
    kind: Mapping[str, Mapping[str, int]]
    # Pairs of free regions that must be connected by floor that is not seen
    hidden_passages: frozenset[tuple[str, str]]

    def of(self, region: str, kind: str) -> int:
        """Return the confidence that a region is of a kind, in percent; 0 when nothing supports it."""
        return self.kind.get(region, {}).get(kind, 0)


def counted_percent(case: str, measure: int) -> int:
    """Return how often facts about places of a case were true that were measured alike; both 1 to 99, in percent.

    >>> 0 < counted_percent("corner", 50) < 100
    True
    """
    thousandths = next(share for least, most, share in _counted_chances()[case] if least <= measure <= most)
    return min(max(round(thousandths / 10), 1), 99)


@cache
def _counted_chances() -> Mapping[str, Sequence[tuple[int, int, int]]]:
    """Return by case the counts of facts about places: from which measure to which, and how many of 1000 were true."""
    found: dict[str, list[tuple[int, int, int]]] = {}
    for case, *numbers in encoding_facts(PLACE_PRIORS, "counted_chance", 4):
        least, most, share = (int(number) for number in numbers)
        found.setdefault(str(case), []).append((least, most, share))
    return found


def percept_facts(percept: Percept, touched: Iterable[tuple[str, str]] = ()) -> list[str]:
    """Return the facts about regions for kb/asp/interpretation.lp, without full stops."""
    facts = []
    for region in percept.regions:
        facts.append(f"region({region.name},{'nonzero' if region.occupied else 'zero'},{region.certain})")
        facts += [f"extent({region.name},{region.extent})", f"mass({region.name},{region.mass})"]
        facts += [f"rim({region.name})"] * region.rim
    facts += [f"surrounds({outer},{inner})" for outer, inner in sorted(percept.surrounds)]
    facts += [f"touched({region},{colour})" for region, colour in sorted(set(touched))]
    return facts


def interpret_regions(percept: Percept, touched: Iterable[tuple[str, str]] = (), rules: tuple[Path, ...] = ()) -> Kinds:
    """Decide what every region is: floor, verge or object."""
    kind: dict[str, dict[str, int]] = {}
    passages = set()
    for atom in solve([INTERPRETATION, *rules], percept_facts(percept, touched)) or ():
        args = [str(a) for a in atom.arguments]
        if atom.match("kind", 3):
            known = kind.setdefault(args[0], {})
            known[args[1]] = max(known.get(args[1], 0), int(args[2]))
        elif atom.match("hidden_passage", 2):
            passages.add((args[0], args[1]))
    return Kinds(kind, frozenset(passages))


@cache
def surest_kind(kind: str) -> int:
    """Return the greatest confidence with which a region is of a kind, in percent: of one felt to be so."""
    facts = ["region(f,zero,100)", "region(t,nonzero,100)", "region(v,nonzero,100)", "surrounds(f,t)"]
    facts += ["touched(t,g)", "touched(v,b)"]
    facts += [fact for region in ("t", "v") for fact in (f"extent({region},1)", f"mass({region},{LARGE_MASS})")]
    found = [atom for atom in solve([INTERPRETATION], facts) or () if atom.match("kind", 3)]
    return max((atom.arguments[2].number for atom in found if str(atom.arguments[1]) == kind), default=100)


def classify_shapes(
    facts: Iterable[str], rules: tuple[Path, ...] = (), world: Iterable[str] = ()
) -> Mapping[str, Mapping[str, int]]:
    """Decide which shapes objects have."""
    answer: dict[str, dict[str, int]] = {}
    given = list(facts)
    named = [fact for fact in world if signature_of(fact) in predicates_read(SHAPES.stem, rules)]
    atoms = solve([SHAPES, *rules], [*given, *named]) or []
    if rules_reach(SHAPES.stem, rules):
        with record_decisions():  # what rules change is asked, not decided
            usual = solve([SHAPES], given) or []
        stated = [atom for atom in atoms if atom not in usual]
        replaced = {tuple(atom.arguments[:2]) for atom in stated}
        atoms = [*(atom for atom in usual if tuple(atom.arguments[:2]) not in replaced), *stated]
    for atom in atoms:
        if atom.match("shape", 3):
            node, shape, confidence = (str(a) for a in atom.arguments)
            known = answer.setdefault(node, {})
            known[shape] = max(known.get(shape, 0), int(confidence))
    return answer
