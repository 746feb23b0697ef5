"""Proof trees of encodings as reasons; the facts that an encoding was given are traced further."""

from collections.abc import Callable, Sequence
from functools import lru_cache

from kb.evidence.reason import Reason, ReasonKind
from kb.explanation.belief import explain_query_atom
from kb.explanation.programs import decision_program
from kb.explanation.proof import explain_decision
from kb.explanation.values import ProofNode, RivalChoice
from kb.explanation.wording import atom_words
from kb.language.diagnostics import Problem, SourceSpan, did_you_mean
from kb.language.vocabulary import BELIEF_PREDICATES, Signature
from kb.reasoning.user_rules import read_rules
from kb.tracing.decisions import SolverCall

KIND_OF_NODE = {  # kind of a node of a proof -> kind of the reason
    "derived": ReasonKind.RULE,
    "chosen": ReasonKind.RULE,
    "absent": ReasonKind.NEGATION,
    "negated": ReasonKind.NEGATION,
    "comparison": ReasonKind.COMPUTED,
    "aggregate": ReasonKind.COMPUTED,
    "each": ReasonKind.COMPUTED,
    "assumed": ReasonKind.INPUT,
}


class EncodingProver:
    """Explains the answers of encodings by the rules that derived them; satisfies `kb.evidence.beliefs.AnswerProver`.

    Parameters
    ----------
    rule_files : the paths of the files with users' rules that took part in the run.
    """

    def __init__(self, rule_files: Sequence[str] = ()) -> None:
        self._rule_files = tuple(rule_files)

    def __call__(self, call: SolverCall, atom: str, leaf: Callable[[str], Reason]) -> Reason:
        """Return the reason why an answer holds an atom.

        Parameters
        ----------
        call : the answer.
        atom : the atom, as text.
        leaf : returns the reason of a fact that the encoding was given.

        Raises
        ------
        kb.explanation.programs.ExplanationError : the record is none of an answer of this encoding.
        """
        proof = explain_decision(call.encoding, call.facts, call.answer or (), atom, self._rule_files)
        return _reason(proof.root, leaf, {})


@lru_cache(maxsize=4096)
def words_of(encoding: str, atom: str) -> str:
    """Return an atom of an encoding in plain words, as the encoding says its predicate reads; '' where it does not.

    encoding : its name without `.lp`; `belief` for facts of the world model. atom : the atom, as text.
    """
    words = atom_words(atom, decision_program(encoding).words)
    return "" if words == atom else words


def query_predicates(rule_files: Sequence[str]) -> frozenset[Signature]:
    """Return the predicates that users' rules define for queries, by name and number of arguments."""
    rules = read_rules(tuple(rule_files)).query_rules if rule_files else ()
    return frozenset(head.signature for one in rules for head in one.heads)


def call_deriving(calls: Sequence[SolverCall], signature: Signature, rule_files: Sequence[str]) -> SolverCall | None:
    """Return the newest of some answers in whose encoding users' rules define a predicate; None for none.

    None also for predicates that they define for queries, too. calls : the answers, oldest first.
    """
    if not rule_files or signature in query_predicates(rule_files):
        return None
    rules, newest_first = read_rules(tuple(rule_files)), tuple(reversed(calls))
    names = {call.encoding for call in newest_first}
    deriving = {
        name
        for name in names
        if any(head.signature == signature for one in rules.rules_reaching(name) for head in one.heads)
    }
    return next((call for call in newest_first if call.encoding in deriving), None)


def unknown_predicate(text: str, signature: Signature, rule_files: Sequence[str]) -> Problem:
    """Return the problem that neither the world model nor users' rules have a predicate. text : the question."""
    name, arity = signature
    named = read_rules(tuple(rule_files)).own_predicates if rule_files else frozenset[Signature]()
    known = {one for one, _ in (*BELIEF_PREDICATES, *named)}
    arities = sorted(count for one, count in (*BELIEF_PREDICATES, *named) if one == name)
    what = f"unknown predicate {name}/{arity}"
    hint = did_you_mean(name, known - {name})
    if signature in named:
        what, hint = f"nothing that was asked so far knows {name}/{arity}", ""
    elif arities:
        hint = f"{name} has {' or '.join(map(str, arities))} argument{'s' * (arities != [1])}"
    return Problem("why", SourceSpan(1, 1, max(1, len(text))), what, text, hint)


def prove_query_atom(
    facts: Sequence[str], atom: str, leaf: Callable[[str], Reason], rule_files: Sequence[str] = ()
) -> Reason:
    """Return the reason why an atom holds in queries: one that users' rules derive, or `object(N)`.

    Parameters
    ----------
    facts : the world model, as text.
    atom : the atom, without variables.
    leaf : returns the reason of a believed fact.
    rule_files : the paths of the files with users' rules.

    Raises
    ------
    kb.explanation.programs.ExplanationError : the atom does not certainly hold.
    """
    return _reason(explain_query_atom(facts, atom, rule_files).root, leaf, {})


def _reason(node: ProofNode, leaf: Callable[[str], Reason], known: dict[int, Reason]) -> Reason:
    """Return the reason of a node of a proof.

    known : the reasons of nodes so far, by the identity of the nodes; grows.
    """
    if id(node) not in known:
        if node.kind == "given":
            known[id(node)] = leaf(node.claim)
        else:
            children = {id(child): child for child in node.children}
            below = [_reason(child, leaf, known) for child in children.values()]
            below += [_rejected(rival) for rival in node.rivals]
            source = f"{node.instance.rule.file}:{node.instance.rule.line}" if node.instance else ""
            data = {"rule": node.instance.rule.text} if node.instance else {}
            kind = KIND_OF_NODE[node.kind] if below or node.kind != "derived" else ReasonKind.CONVENTION
            known[id(node)] = Reason(node.claim, node.sentence, kind, source, tuple(below), data)
    return known[id(node)]


def _rejected(rival: RivalChoice) -> Reason:
    """Return the reason why another choice was not made."""
    claim = f"not chosen: {rival.atom or 'none of them'}"
    return Reason(claim, rival.sentence, ReasonKind.REJECTED, "", (), {"costs": [list(cost) for cost in rival.costs]})
