"""Proof trees built from rule instances: the same for encodings and for users' rules in queries."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

from utak.kb.explanation.support import (
    CountedElement,
    LiteralValue,
    Support,
    founded_elements,
    founded_supports,
    needed_atoms,
)
from utak.kb.explanation.values import ProofNode, RivalChoice, RuleInstance
from utak.kb.explanation.wording import (
    WordsByPredicate,
    absent_words,
    aggregate_claim,
    aggregate_words,
    atom_pattern,
    atom_words,
    comparison_claim,
    comparison_words,
    member_text,
    substituted,
    variables_in,
)
from utak.kb.tracing.syntax import JsonValues


class ProofTrees:
    """The proofs of the atoms that hold."""

    def __init__(
        self,
        supports: Mapping[str, Sequence[Support]],
        given: Iterable[str],
        holding: Iterable[str],
        words: WordsByPredicate,
        assumed: Iterable[str],
        instance: Callable[[Support], RuleInstance],
        rivals: Callable[[Support], tuple[RivalChoice, ...]],
    ) -> None:
        self._chosen, self._heights = founded_supports(supports, given, holding)
        self._words, self._assumed, self._instance, self._rivals = words, frozenset(assumed), instance, rivals
        self._nodes: dict[str, ProofNode] = {}

    def node(self, atom: str) -> ProofNode:
        """Return the proof of an atom that holds; the proof of an atom is one object, wherever it stands."""
        for other in sorted(self._needed(atom), key=lambda one: (self._heights[one], one)):
            if other not in self._nodes:
                self._nodes[other] = self._built(other)
        return self._nodes[atom]

    def _needed(self, atom: str) -> set[str]:
        """Return an atom and all atoms on which its proof rests."""
        found, waiting = {atom}, [atom]
        while waiting:
            one = waiting.pop()
            for other in self._direct(one):
                if other not in found:
                    found.add(other)
                    waiting.append(other)
        return found

    def _direct(self, atom: str) -> Iterator[str]:
        """Yield the atoms on which the rule instance that explains an atom rests."""
        support = self._chosen.get(atom)
        if support is None:
            return
        yield from needed_atoms(support, founded_elements(support, self._heights, self._heights[atom]))

    def _built(self, atom: str) -> ProofNode:
        """Return the proof of an atom whose parts have been built."""
        words = atom_words(atom, self._words)
        support = self._chosen.get(atom)
        if support is None:
            return ProofNode("assumed" if atom in self._assumed else "given", atom, words)
        chosen = support.unit.rule.kind == "choice"
        children = tuple({node.claim: node for node in self._children(atom, support)}.values())
        rivals = self._rivals(support) if chosen else ()
        return ProofNode("chosen" if chosen else "derived", atom, words, self._instance(support), children, rivals)

    def _children(self, atom: str, support: Support) -> Iterator[ProofNode]:
        """Yield the parts of the body of the rule instance that explains an atom."""
        values = dict(zip(support.unit.names, support.values, strict=True))
        ready = founded_elements(support, self._heights, self._heights[atom])
        for value, info, elements in zip(support.literals, support.unit.literals, ready, strict=True):
            yield from self._literal(value, info, elements, values)
        if support.condition:
            yield from self._conditions(support.condition, support.unit.conditions[support.head_element])

    def _conditions(self, values: Iterable[LiteralValue], infos: Iterable[JsonValues]) -> Iterator[ProofNode]:
        """Yield the nodes of the literals of a condition."""
        for value, info in zip(values, infos, strict=True):
            yield from self._literal(value, info, (), None)

    def _literal(
        self,
        value: LiteralValue,
        info: JsonValues,
        elements: Sequence[CountedElement],
        values: Mapping[str, str] | None,
    ) -> Iterator[ProofNode]:
        """Yield the node of one literal; nothing for a constant truth."""
        # None where local variables may stand in it.
        kind, words = info["kind"], self._words
        if kind == "atom" and isinstance(value, str):
            yield self._nodes[value]
        elif kind == "not" and isinstance(value, str):
            yield ProofNode("absent", f"not {atom_pattern(value)}", absent_words(value, words))
        elif kind == "notnot" and isinstance(value, str):
            claim = f"not not {atom_pattern(value)}"
            yield ProofNode("negated", claim, f"it holds, whatever derives it, that {atom_words(value, words)}")
        elif kind == "comparison" and not isinstance(value, str):
            known = values if values is not None and variables_in(info["text"]) <= values.keys() else None
            claim, told = comparison_claim(info, value, known), comparison_words(info, value, known)
            yield ProofNode("comparison", claim, told)
        elif kind == "aggregate":
            claim, told = aggregate_claim(info, list(value), elements), aggregate_words(info, list(value), elements)
            yield ProofNode("aggregate", claim, told, children=tuple(self._members(info, elements)))
        elif kind == "conditional":
            text = substituted(info["text"], values or {})
            literal, _, cases = text.partition(": ")
            number = f"{len(elements)} cases, and in each" if len(elements) > 1 else "one case, and there"
            told = (
                f"{cases} holds in {number} {literal}" if elements else f"there is no {cases}, so nothing had to hold"
            )
            yield ProofNode("each", text, told, children=tuple(self._cases(info, elements)))

    def _members(self, info: JsonValues, elements: Sequence[CountedElement]) -> Iterator[ProofNode]:
        """Yield a node for each element that counts in an aggregate; that of its only atom when it has one."""
        for one in elements:
            parts = [*self._conditions(one.condition, info["conditions"][one.element])]
            if len(parts) == 1:
                yield parts[0]
            else:
                text = member_text(one.terms)
                yield ProofNode("each", text, f"{text} counts", children=tuple(parts))

    def _cases(self, info: JsonValues, elements: Sequence[CountedElement]) -> Iterator[ProofNode]:
        """Yield a node for each case of a conditional literal: its literal, with its condition below."""
        for one in elements:
            (literal,) = self._literal(one.terms[0], info["literal"], (), None)
            parts = [*self._conditions(one.condition, info["conditions"][one.element])]
            below = (literal,) if literal.children or literal.instance else ()
            yield ProofNode("each", literal.claim, literal.words, children=(*parts, *below))
