"""Which rule instance derives each atom of an answer, such that no atom rests on itself."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from utak.kb.explanation.programs import RuleUnit
from utak.kb.tracing.syntax import JsonValues

LiteralValue = str | list[str]  # an atom, or the sides of a comparison or the bounds of an aggregate


@dataclass(frozen=True)
class CountedElement:
    """An element of an aggregate or of a conditional literal whose condition holds."""

    element: int  # the index of the element in its literal
    terms: tuple[LiteralValue, ...]  # its tuple; for a conditional literal its literal
    condition: tuple[LiteralValue, ...]  # the literals of its condition


@dataclass(frozen=True)
class Support:
    """A rule instance that derives or chooses an atom."""

    number: int  # the index of its unit
    unit: RuleUnit  # the rule with one alternative of each pool
    values: tuple[str, ...]  # a value for each of the unit's names
    literals: tuple[LiteralValue, ...]  # the literals of its body
    # Of each literal the elements that count; () for literals other than aggregates and conditional ones
    elements: tuple[tuple[CountedElement, ...], ...]
    head_element: int  # the index of the atom in the rule's head
    condition: tuple[LiteralValue, ...]  # the literals of the condition of that atom


def supports_of(trace: JsonValues, units: Sequence[RuleUnit]) -> dict[str, list[Support]]:
    """Return the rule instances that derive or may choose each atom, by atom."""
    # A choice lists also what is not chosen.
    bodies = {(unit, tuple(values)): tuple(literals) for unit, values, literals in trace["on"]}
    counted: dict[tuple[int, tuple[str, ...], int], list[CountedElement]] = {}
    for unit, literal, element, values, terms, condition in trace["elements"]:
        member = CountedElement(element, tuple(terms), tuple(condition))
        counted.setdefault((unit, tuple(values), literal), []).append(member)
    found: dict[str, list[Support]] = {}
    for unit, element, values, head, condition in trace["heads"]:
        key = (unit, tuple(values))
        inner = tuple(tuple(counted.get((*key, at), ())) for at in range(len(units[unit].literals)))
        one = Support(unit, units[unit], key[1], bodies[key], inner, element, tuple(condition))
        found.setdefault(head, []).append(one)
    return found


def founded_supports(
    supports: Mapping[str, Sequence[Support]], given: Iterable[str], holding: Iterable[str]
) -> tuple[dict[str, Support], dict[str, int]]:
    """Return for each atom of an answer the rule instance that explains it, and its height in the proof."""
    heights = dict.fromkeys(given, 0)
    chosen: dict[str, Support] = {}
    wanted = set(holding)
    _raise_levels(supports, wanted, heights, chosen)
    while True:  # what rests on aggregates that are founded by a part of their elements
        level = max(heights.values(), default=0) + 1
        ready = {
            atom: best
            for atom in sorted(wanted - heights.keys())
            if (best := _best_at_least(supports.get(atom, ()), heights)) is not None
        }
        if not ready:
            return chosen, heights
        for atom, support in ready.items():
            heights[atom], chosen[atom] = level, support


def _raise_levels(
    supports: Mapping[str, Sequence[Support]], wanted: set[str], heights: dict[str, int], chosen: dict[str, Support]
) -> None:
    """Give heights and rule instances to all atoms that rest on given facts, level after level."""
    waiting: dict[str, list[tuple[str, int]]] = {}  # by atom the instances that need it: (their atom, their index)
    left: dict[tuple[str, int], int] = {}  # how many needed atoms of an instance have no height yet
    size: dict[tuple[str, int], int] = {}
    ready: list[tuple[str, int]] = []
    for atom in sorted(wanted - heights.keys()):
        for index, support in enumerate(supports.get(atom, ())):
            needed = set(needed_atoms(support, support.elements))
            key = (atom, index)
            size[key], left[key] = len(needed), len(needed - heights.keys())
            for other in needed - heights.keys():
                waiting.setdefault(other, []).append(key)
            if not left[key]:
                ready.append(key)
    level = 0
    while ready:
        level += 1
        best: dict[str, tuple[int, int]] = {}
        for atom, index in ready:
            if atom not in heights:
                best[atom] = min(best.get(atom, (size[atom, index], index)), (size[atom, index], index))
        ready = []
        for atom, (_, index) in best.items():
            heights[atom], chosen[atom] = level, supports[atom][index]
            for key in waiting.get(atom, ()):
                left[key] -= 1
                if not left[key]:
                    ready.append(key)


def positive_atoms(literals: Iterable[LiteralValue], infos: Iterable[JsonValues]) -> Iterator[str]:
    """Yield the atoms among literals that are not negated."""
    for value, info in zip(literals, infos, strict=True):
        if info["kind"] == "atom" and isinstance(value, str):
            yield value


def needed_atoms(support: Support, counted: Iterable[Sequence[CountedElement]]) -> Iterator[str]:
    """Yield the atoms that an instance reads without negation, for each of its literals those of some elements."""
    yield from positive_atoms(support.literals, support.unit.literals)
    if support.condition:
        yield from positive_atoms(support.condition, support.unit.conditions[support.head_element])
    for info, elements in zip(support.unit.literals, counted, strict=True):
        for one in elements:
            yield from positive_atoms(one.condition, info["conditions"][one.element])
            if info["kind"] == "conditional":
                yield from positive_atoms(one.terms, [info["literal"]])


def _best_at_least(options: Sequence[Support], heights: Mapping[str, int]) -> Support | None:
    """Return the first instance that holds by atoms that have heights, aggregates by a part of their elements."""
    for support in options:
        ready = founded_elements(support, heights)
        if _keeps_bounds(support, ready) and all(atom in heights for atom in needed_atoms(support, ready)):
            return support
    return None


def _keeps_bounds(support: Support, counted: Iterable[Sequence[CountedElement]]) -> bool:
    """Return whether the aggregates of an instance that are not negated hold by some of their elements alone."""
    parts = zip(support.literals, support.unit.literals, counted, strict=True)
    return all(
        info["kind"] != "aggregate" or info["negated"] or holds_aggregate(info, value, elements)
        for value, info, elements in parts
    )


def founded_elements(
    support: Support, heights: Mapping[str, int], below: int | None = None
) -> list[list[CountedElement]]:
    """Return for each literal the elements whose conditions have heights; with `below`, heights less than that."""

    def is_founded(one: CountedElement, info: JsonValues) -> bool:
        """Return whether all atoms of an element's condition have such heights."""
        atoms = positive_atoms(one.condition, info["conditions"][one.element])
        return all(atom in heights and (below is None or heights[atom] < below) for atom in atoms)

    pairs = zip(support.unit.literals, support.elements, strict=True)
    return [[one for one in elements if is_founded(one, info)] for info, elements in pairs]


def aggregate_value(info: JsonValues, elements: Iterable[CountedElement]) -> str:
    """Return the value of an aggregate over its elements as text."""
    # `#inf` and `#sup` for the greatest and least of none.
    tuples = dict.fromkeys(_flat(one.terms) for one in elements)
    function = info["function"]
    if function == "#count":
        return str(len(tuples))
    firsts = [terms[0] for terms in tuples if terms]
    if function in ("#sum", "#sum+"):
        numbers = [int(term) for term in firsts if _is_number(term)]
        return str(sum(number for number in numbers if function == "#sum" or number > 0))
    if not firsts:
        return "#inf" if function == "#max" else "#sup"
    pick = max if function == "#max" else min
    return pick(firsts, key=_order)


def holds_aggregate(info: JsonValues, bounds: LiteralValue, elements: Iterable[CountedElement]) -> bool:
    """Return whether the value of an aggregate over its elements keeps the bounds."""
    value = aggregate_value(info, elements)
    terms = iter(bounds)
    return all(
        _compare(next(terms), sign, value) if side == 0 else _compare(value, sign, next(terms))
        for side, sign in enumerate(info["signs"])
        if sign
    )


def _compare(left: str, sign: str, right: str) -> bool:
    """Return whether `left sign right` holds, for terms as texts."""
    a, b = _order(left), _order(right)
    return {"=": a == b, "!=": a != b, "<": a < b, "<=": a <= b, ">": a > b, ">=": a >= b}[sign]


def _order(term: str) -> tuple[int, int, str]:
    """Return a key that orders terms: `#inf`, numbers, other terms, `#sup`."""
    if term in ("#inf", "#sup"):
        return (-1 if term == "#inf" else 2), 0, ""
    return (0, int(term), "") if _is_number(term) else (1, 0, term)


def _is_number(term: str) -> bool:
    """Return whether a term is an integer."""
    return term.removeprefix("-").isdigit()


def _flat(terms: Iterable[LiteralValue]) -> tuple[str, ...]:
    """Return the members of a tuple as texts."""
    return tuple(one if isinstance(one, str) else f"({','.join(one)})" for one in terms)
