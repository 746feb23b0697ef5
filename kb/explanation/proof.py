"""Why an atom holds in the answer of an encoding: a proof tree down to the input facts."""

from collections.abc import Sequence
from functools import lru_cache

from utak.kb.explanation.programs import DecisionProgram, ExplanationError, canonical, decision_program
from utak.kb.explanation.rivals import rivals_of
from utak.kb.explanation.support import Support, supports_of
from utak.kb.explanation.tree import ProofTrees
from utak.kb.explanation.values import Proof, ProofNode, RivalChoice


class TracedDecision:
    """A decision with the proofs of its atoms."""

    def __init__(
        self, program: DecisionProgram, facts: Sequence[str], answer: Sequence[str], assumed: Sequence[str] = ()
    ) -> None:
        self.program, self.facts, self.answer = program, tuple(facts), tuple(answer)
        found = program.ask({"task": "trace", "facts": list(facts), "answer": list(answer)})
        self.atoms = frozenset(found["atoms"])
        self.supports = supports_of(found, program.units)
        self._rivals: dict[tuple[int, tuple[str, ...]], tuple[RivalChoice, ...]] = {}
        self._trees = ProofTrees(
            self.supports,
            facts,
            self.atoms,
            program.words,
            assumed,
            lambda support: program.instance(support.unit, support.values),
            self._rivals_of,
        )

    def node(self, atom: str) -> ProofNode:
        """Return the proof of an atom that holds; the proof of an atom is one object, wherever it stands."""
        return self._trees.node(atom)

    def _rivals_of(self, support: Support) -> tuple[RivalChoice, ...]:
        """Return the other ways to choose for an instance of a choice; asked once for each instance."""
        key = (support.number, support.values)
        if key not in self._rivals:
            heads = [
                atom
                for atom, options in self.supports.items()
                if any((one.number, one.values) == key for one in options)
            ]
            self._rivals[key] = rivals_of(self.program, self.facts, self.answer, heads)
        return self._rivals[key]


def traced_decision(
    encoding: str, facts: tuple[str, ...], answer: tuple[str, ...], rule_files: tuple[str, ...] = ()
) -> TracedDecision:
    """Return a decision with the rule instance that explains each of its atoms; the last ones are kept."""
    return _kept_decision(decision_program(encoding, rule_files), facts, answer)


@lru_cache(maxsize=128)
def _kept_decision(program: DecisionProgram, facts: tuple[str, ...], answer: tuple[str, ...]) -> TracedDecision:
    """Return a decision with its proofs; the last ones are kept."""
    return TracedDecision(program, facts, answer)


def explain_decision(
    encoding: str, facts: Sequence[str], answer: Sequence[str] | None, atom: str, rule_files: Sequence[str] = ()
) -> Proof:
    """Return why an atom holds in an answer of an encoding."""
    (wanted,) = canonical([atom])
    if answer is None:
        raise ExplanationError(f"{encoding}.lp had no answer, so {wanted} does not hold")
    decision = traced_decision(encoding, canonical(facts), canonical(answer), tuple(map(str, rule_files)))
    if wanted not in decision.atoms:
        raise ExplanationError(f"{wanted} does not hold in this answer of {encoding}.lp")
    return Proof(encoding, decision.node(wanted))
