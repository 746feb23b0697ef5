"""Interpretation: what each region is, and which shape an object has. Facts go in, answers of kb/asp come out."""

from collections.abc import Collection, Iterable, Mapping, Sequence
from functools import cache
from pathlib import Path
from types import MappingProxyType
from typing import Any, NamedTuple

from utak.kb.language.atoms import signature_of
from utak.kb.perception.regions import Percept, Region
from utak.kb.reasoning.encodings import KB_ENCODINGS, encoding_constant, encoding_facts
from utak.kb.reasoning.solver import solve
from utak.kb.reasoning.user_rules import predicates_read, rules_reach
from utak.kb.tracing.decisions import record_decisions

SHAPES = KB_ENCODINGS / "shapes.lp"
PRIORS_OF_PLACES = KB_ENCODINGS / "priors_of_places.lp"
INTERPRETATION = KB_ENCODINGS / "interpretation.lp"
TAKEN = KB_ENCODINGS / "taken.lp"
LONGEST_OBJECT = encoding_constant(INTERPRETATION, "longest_object")  # squares: what is longer is no object
LARGE_MASS = 1000  # tenths of squares: of what is surely there


class Kinds(NamedTuple):
    """The kinds that regions are taken for."""

    # Region -> {floor, verge, object or utak: confidence in percent}. A region of which nothing is derived is missing.
    kind: Mapping[str, Mapping[str, int]]
    # Role -> the regions that are taken for it when the robot acts: bounds, wall, thing (kb/asp/taken.lp)
    taken: Mapping[str, frozenset[str]] = MappingProxyType({})

    def is_taken(self, region: str, role: str) -> bool:
        """Return whether a region is taken for bounds, wall or thing."""
        return region in self.taken.get(role, ())

    def of(self, region: str, kind: str) -> int:
        """Return the confidence that a region is of a kind, in percent; 0 when nothing supports it."""
        return self.kind.get(region, {}).get(kind, 0)


NO_KINDS = Kinds({})


def counted_percent(case: str, measure: int) -> int:
    """Return how often facts about places of a case were true that were measured alike, 1 to 99, in percent.

    >>> 0 < counted_percent("corner", 50) < 100
    True
    """
    thousandths = next(share for least, most, share in _counted_chances()[case] if least <= measure <= most)
    return min(max(round(thousandths / 10), 1), 99)


@cache
def _counted_chances() -> Mapping[str, Sequence[tuple[int, int, int]]]:
    """Return by case the counts of facts about places: from which measure to which, and how many of 1000 were true."""
    found: dict[str, list[tuple[int, int, int]]] = {}
    for case, *numbers in encoding_facts(PRIORS_OF_PLACES, "counted_chance", 4):
        least, most, share = (int(number) for number in numbers)
        found.setdefault(str(case), []).append((least, most, share))
    return found


def percept_facts(percept: Percept, touched: Iterable[tuple[str, str]] = ()) -> list[str]:
    """Return the facts about regions for kb/asp/interpretation.lp, without full stops."""
    facts = [fact for region in percept.regions for fact in _region_facts(region)]
    facts += [f"surrounds({outer},{inner})" for outer, inner in sorted(percept.surrounds)]
    return facts + _touch_facts(touched)


def _region_facts(region: Region) -> list[str]:
    """Return the facts about one region alone, without full stops."""
    facts = [f"region({region.name},{'nonzero' if region.occupied else 'zero'},{region.certain})"]
    facts += [f"extent({region.name},{region.extent})", f"mass({region.name},{region.mass})"]
    return facts + [f"rim({region.name})"] * region.rim


def interpret_regions(percept: Percept, touched: Iterable[tuple[str, str]] = (), rules: tuple[Path, ...] = ()) -> Kinds:
    """Decide what every region is: floor, verge or object, and what it is taken for."""
    felt = tuple(touched)
    return with_taken(_interpreted(percept_facts(percept, felt), rules), percept.regions, felt, rules)


def interpret_cut(regions: Sequence[Region], touched: Iterable[tuple[str, str]], rules: tuple[Path, ...] = ()) -> Kinds:
    """Decide what regions are that were cut out of what bounds the floor, since they were felt."""
    facts = [fact for region in regions for fact in (*_region_facts(region), f"cut({region.name})")]
    return _interpreted([*facts, *_touch_facts(touched)], rules)


def _touch_facts(touched: Iterable[tuple[str, str]]) -> list[str]:
    """Return the facts about what was felt at regions, without full stops."""
    return [f"touched({region},{colour})" for region, colour in sorted(set(touched))]


def _interpreted(facts: Sequence[str], rules: tuple[Path, ...]) -> Kinds:
    """Return what kb/asp/interpretation.lp says of regions; what users' rules state of a region counts first."""
    atoms = solve([INTERPRETATION, *rules], facts) or []
    kinds = _kinds_of(atoms)
    if rules_reach(INTERPRETATION.stem, rules):
        with record_decisions():  # what rules change is asked, not decided
            usual = solve([INTERPRETATION], facts) or []
        counted, stated = _kinds_of(usual), _kinds_of(atom for atom in atoms if atom not in usual)
        kinds = counted | {region: _with_stated(counted.get(region, {}), stated[region]) for region in stated}
    return Kinds(kinds)


def _kinds_of(atoms: Iterable[Any]) -> dict[str, dict[str, int]]:
    """Return region -> kind -> confidence in percent, the greatest of those that atoms state."""
    found: dict[str, dict[str, int]] = {}
    for region, kind, percent in (atom.arguments for atom in atoms if atom.match("kind", 3)):
        known = found.setdefault(str(region), {})
        known[str(kind)] = max(known.get(str(kind), 0), percent.number)
    return found


def _with_stated(counted: Mapping[str, int], stated: Mapping[str, int]) -> dict[str, int]:
    """Return the kinds of a region as stated; its other kinds share what is left of 100, as they were counted."""
    others = {kind: percent for kind, percent in counted.items() if kind not in stated}
    left, whole = max(100 - sum(stated.values()), 0), sum(others.values())
    return {**{kind: left * percent // whole for kind, percent in others.items() if whole}, **stated}


def with_taken(
    kinds: Kinds, regions: Iterable[Region], touched: Iterable[tuple[str, str]], rules: tuple[Path, ...] = ()
) -> Kinds:
    """Return the kinds of regions with what each is taken for, by kb/asp/taken.lp and users' rules."""
    occupied = [region for region in regions if region.occupied]
    facts = [f"longest({LONGEST_OBJECT})", *(f"extent({region.name},{region.extent})" for region in occupied)]
    for region in occupied:
        facts.append(f"region({region.name},nonzero,{region.certain})")
        facts += [f"kind({region.name},{kind},{kinds.of(region.name, kind)})" for kind in ("object", "verge")]
    names = {region.name for region in occupied}
    facts += _touch_facts(one for one in touched if one[0] in names)
    found: dict[str, set[str]] = {}
    for atom in solve([TAKEN, *rules], facts) or ():
        if atom.match("taken", 2):
            found.setdefault(str(atom.arguments[1]), set()).add(str(atom.arguments[0]))
    return kinds._replace(taken={role: frozenset(regions) for role, regions in found.items()})


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
) -> tuple[Mapping[str, Mapping[str, int]], Collection[str]]:
    """Decide which shapes objects have; also return the names of those whose outline is that of their squares."""
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
    return answer, {str(atom.arguments[0]) for atom in atoms if atom.match("traced", 1)}
