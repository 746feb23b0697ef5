"""Why an atom holds in the answer of an encoding: a proof tree down to the input facts."""

from collections.abc import Iterator, Mapping, Sequence
from functools import lru_cache
from typing import Any

from kb.explanation.programs import DecisionProgram, ExplanationError, canonical, decision_program
from kb.explanation.rivals import rivals_of
from kb.explanation.support import (
    CountedElement,
    LiteralValue,
    Support,
    element_atoms,
    founded_elements,
    founded_supports,
    positive_atoms,
    supports_of,
)
from kb.explanation.values import Proof, ProofNode, RivalChoice
from kb.explanation.wording import (
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
from kb.reasoning.sentences import fill

Json = dict[str, Any]


class TracedDecision:
    """A decision with the rule instance that explains each of its atoms.

    Parameters
    ----------
    program : the encoding, with users' rules.
    facts : its input facts, as clingo writes them.
    answer : the shown atoms of its answer, likewise.
    assumed : those of the facts that are not given really.

    Attributes
    ----------
    program, facts, answer, assumed : as given.
    atoms : all atoms that hold, shown or not.
    supports : the rule instances that derive or may choose each atom.
    """

    def __init__(
        self, program: DecisionProgram, facts: Sequence[str], answer: Sequence[str], assumed: Sequence[str] = ()
    ) -> None:
        self.program, self.facts, self.answer, self.assumed = program, tuple(facts), tuple(answer), frozenset(assumed)
        found = program.ask({"task": "trace", "facts": list(facts), "answer": list(answer)})
        self.atoms = frozenset(found["atoms"])
        self.supports = supports_of(found, program.units)
        self._chosen, self._heights = founded_supports(self.supports, facts, self.atoms)
        self._nodes: dict[str, ProofNode] = {}
        self._rivals: dict[tuple[int, tuple[str, ...]], tuple[RivalChoice, ...]] = {}

    def node(self, atom: str) -> ProofNode:
        """Return the proof of an atom that holds; the proof of an atom is one object, wherever it stands."""
        for other in sorted(self._needed(atom), key=lambda one: (self._heights[one], one)):
            if other not in self._nodes:
                self._nodes[other] = self._built(other)
        return self._nodes[atom]

    def siblings(self, support: Support) -> list[str]:
        """Return the atoms among which an instance of a choice chooses, those that hold included, in their order."""
        return [
            atom
            for atom, options in self.supports.items()
            if any(one.number == support.number and one.values == support.values for one in options)
        ]

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
        yield from positive_atoms(support.literals, support.unit.literals)
        if support.condition:
            yield from positive_atoms(support.condition, support.unit.conditions[support.head_element])
        for info, elements in zip(support.unit.literals, support.elements, strict=True):
            for one in founded_elements(info, elements, self._heights, self._heights[atom]):
                yield from element_atoms(one, info)
                if info["kind"] == "conditional":
                    yield from positive_atoms(one.terms, [info["literal"]])

    def _built(self, atom: str) -> ProofNode:
        """Return the proof of an atom whose parts have been built."""
        words = atom_words(atom, self.program.words)
        support = self._chosen.get(atom)
        if support is None:
            return ProofNode("assumed" if atom in self.assumed else "given", atom, words)
        instance = self.program.instance(support.unit, support.values)
        kind = "chosen" if support.unit.rule.kind == "choice" else "derived"
        children = tuple({node.claim: node for node in self._children(atom, support)}.values())
        return ProofNode(kind, atom, words, instance, children, self._rivals_of(atom))

    def _rivals_of(self, atom: str) -> tuple[RivalChoice, ...]:
        """Return the other ways to choose for a chosen atom; () for any other atom."""
        support = self._chosen[atom]
        if support.unit.rule.kind != "choice":
            return ()
        key = (support.number, support.values)
        if key not in self._rivals:
            heads = self.siblings(support)
            self._rivals[key] = rivals_of(self.program, self.facts, self.answer, heads)
        return self._rivals[key]

    def _children(self, atom: str, support: Support) -> Iterator[ProofNode]:
        """Yield the parts of the body of the rule instance that explains an atom."""
        values = dict(zip(support.unit.names, support.values, strict=True))
        parts = zip(support.literals, support.unit.literals, support.elements, strict=True)
        for value, info, elements in parts:
            ready = founded_elements(info, elements, self._heights, self._heights[atom])
            yield from self._literal(value, info, ready, values)
        if support.condition:
            infos = support.unit.conditions[support.head_element]
            for value, info in zip(support.condition, infos, strict=True):
                yield from self._literal(value, info, (), None)

    def _literal(
        self,
        value: LiteralValue,
        info: Json,
        elements: Sequence[CountedElement],
        values: Mapping[str, str] | None,
    ) -> Iterator[ProofNode]:
        """Yield the node of one literal; nothing for a constant truth.

        values : the values of the variables of its rule; None where local variables may stand in it.
        """
        kind, words = info["kind"], self.program.words
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
            number = f"in all {len(elements)} cases" if len(elements) > 1 else "in the one case that there is"
            told = f"{number} it holds that {text}" if elements else f"there is no case in which to check {text}"
            yield ProofNode("each", text, told, children=tuple(self._cases(info, elements)))

    def _members(self, info: Json, elements: Sequence[CountedElement]) -> Iterator[ProofNode]:
        """Yield a node for each element that counts in an aggregate; that of its only atom when it has one."""
        for one in elements:
            infos = info["conditions"][one.element]
            parts = [
                node
                for value, inner in zip(one.condition, infos, strict=True)
                for node in self._literal(value, inner, (), None)
            ]
            if len(parts) == 1:
                yield parts[0]
            else:
                text = member_text(one.terms)
                yield ProofNode("each", text, f"{text} counts", children=tuple(parts))

    def _cases(self, info: Json, elements: Sequence[CountedElement]) -> Iterator[ProofNode]:
        """Yield a node for each case of a conditional literal: its literal, with its condition below."""
        for one in elements:
            (literal,) = self._literal(one.terms[0], info["literal"], (), None)
            infos = info["conditions"][one.element]
            parts = [
                node
                for value, inner in zip(one.condition, infos, strict=True)
                for node in self._literal(value, inner, (), None)
            ]
            below = (literal,) if literal.children or literal.instance else ()
            yield ProofNode("each", literal.claim, literal.words, children=(*parts, *below))


@lru_cache(maxsize=128)
def traced_decision(
    encoding: str, facts: tuple[str, ...], answer: tuple[str, ...], rule_files: tuple[str, ...] = ()
) -> TracedDecision:
    """Return a decision with the rule instance that explains each of its atoms; the last ones are kept.

    Parameters, errors as of `explain_decision`; facts and atoms as clingo writes them.
    """
    return TracedDecision(decision_program(encoding, rule_files), facts, answer)


def explain_decision(
    encoding: str, facts: Sequence[str], answer: Sequence[str], atom: str, rule_files: Sequence[str] = ()
) -> Proof:
    """Return why an atom holds in an answer of an encoding.

    Parameters
    ----------
    encoding : the name of the encoding without `.lp`, such as "interpretation".
    facts : its input facts, atoms as text with or without full stops.
    answer : the shown atoms of its answer, likewise.
    atom : the atom, likewise; it may be one that the encoding does not show.
    rule_files : the paths of files with users' rules that took part.

    Returns
    -------
    The proof: a tree whose leaves are input facts, what is not known, and what holds whatever is given. No atom in it
    rests on itself. A chosen atom carries the other ways to choose, with their costs.

    Raises
    ------
    ExplanationError : there is no such encoding, the answer is none of its answers, or the atom does not hold in it.
    BadInputError, CannotOpenError : a text is no fact; users' rules have errors or cannot be read.
    """
    (wanted,) = canonical([atom])
    decision = traced_decision(encoding, canonical(facts), canonical(answer), tuple(map(str, rule_files)))
    if wanted not in decision.atoms:
        raise ExplanationError(f"{wanted} does not hold in this answer of {encoding}.lp")
    return Proof(encoding, decision.node(wanted))
