"""Proof trees of encodings as reasons; the facts that an encoding was given are traced further."""

from collections.abc import Callable, Sequence
from functools import lru_cache

from utak.kb.evidence.reason import Reason, ReasonKind
from utak.kb.explanation.belief import explain_query_atom
from utak.kb.explanation.programs import decision_program
from utak.kb.explanation.proof import explain_decision
from utak.kb.explanation.values import ProofNode, RivalChoice
from utak.kb.explanation.wording import atom_words
from utak.kb.language.atoms import atom_parts
from utak.kb.language.diagnostics import Problem, SourceSpan
from utak.kb.language.vocabulary import BELIEF_PREDICATES, GOAL_VOCABULARY, Signature, hint_for
from utak.kb.reasoning.user_rules import read_rules
from utak.kb.tracing.decisions import SolverCall

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
    """Explains the answers of encodings by the rules that derived them."""

    # Satisfies `utak.kb.evidence.beliefs.AnswerProver`.

    def __init__(self, rule_files: Sequence[str] = ()) -> None:
        self._rule_files = tuple(rule_files)

    def __call__(self, call: SolverCall, atom: str, leaf: Callable[[str], Reason]) -> Reason:
        """Return the reason why an answer holds an atom."""
        proof = explain_decision(call.encoding, call.facts, call.answer or (), atom, self._rule_files)
        return reason_of_proof(proof.root, leaf)


@lru_cache(maxsize=4096)
def words_of(encoding: str, atom: str) -> str:
    """Return an atom of an encoding in plain words, as the encoding says its predicate reads; '' where it does not."""
    words = atom_words(atom, decision_program(encoding).words)
    return "" if words == atom else words


def query_predicates(rule_files: Sequence[str]) -> frozenset[Signature]:
    """Return the predicates that users' rules define for queries, by name and number of arguments."""
    rules = read_rules(tuple(rule_files)).query_rules if rule_files else ()
    return frozenset(head.signature for one in rules for head in one.heads)


def call_deriving(calls: Sequence[SolverCall], atom: str, rule_files: Sequence[str]) -> SolverCall | None:
    """Return the newest of some answers whose encoding has users' rules for the predicate of an atom; None for none."""
    # Of several encodings that know the rule, one that was given something about what the atom names.
    name, arguments = atom_parts(atom)
    signature, named = (name, len(arguments)), set(arguments)
    if not rule_files or signature in query_predicates(rule_files):
        return None
    rules, newest_first = read_rules(tuple(rule_files)), tuple(reversed(calls))
    names = {call.encoding for call in newest_first}
    deriving = {
        name
        for name in names
        if any(head.signature == signature for one in rules.rules_reaching(name) for head in one.heads)
    }
    known = [call for call in newest_first if call.encoding in deriving]
    about = (call for call in known if any(not named.isdisjoint(atom_parts(fact)[1]) for fact in call.facts))
    return next(about, next(iter(known), None))


def unknown_predicate(text: str, signature: Signature, rule_files: Sequence[str]) -> Problem:
    """Return the problem that neither the world model nor users' rules have a predicate. text : the question."""
    name, arity = signature
    named = read_rules(tuple(rule_files)).own_predicates if rule_files else frozenset[Signature]()
    what, hint = f"unknown predicate {name}/{arity}", hint_for(name, {*BELIEF_PREDICATES, *named})
    if signature in named:
        what, hint = f"nothing that was asked so far knows {name}/{arity}", ""
    elif name in GOAL_VOCABULARY:
        what, hint = f"{name} is a word of goals, and this is no goal of the task", "ask about facts of the world model"
    return Problem("why", SourceSpan(1, 1, max(1, len(text))), what, text, hint)


def prove_query_atom(
    facts: Sequence[str], atom: str, leaf: Callable[[str], Reason], rule_files: Sequence[str] = ()
) -> Reason:
    """Return the reason why an atom holds in queries: one that users' rules derive, or `object(N)`."""
    return reason_of_proof(explain_query_atom(facts, atom, rule_files).root, leaf)


def reason_of_proof(root: ProofNode, leaf: Callable[[str], Reason]) -> Reason:
    """Return the reason of a node of a proof; proofs may be higher than Python's limit on recursion."""
    known: dict[int, Reason] = {}  # by the identity of the nodes
    waiting = [root]
    while waiting:
        node = waiting[-1]
        missing = [] if node.kind == "given" else [child for child in node.children if id(child) not in known]
        if id(node) in known or not missing:
            waiting.pop()
            if id(node) not in known:
                known[id(node)] = leaf(node.claim) if node.kind == "given" else _reason_of_rule(node, known)
        else:
            waiting += reversed(missing)
    return known[id(root)]


def _reason_of_rule(node: ProofNode, known: dict[int, Reason]) -> Reason:
    """Return the reason of a node that is not given. known : those of its children, by their identity."""
    children = dict.fromkeys(map(id, node.children))
    below = [known[child] for child in children] + [_rejected(rival) for rival in node.rivals]
    source = f"{node.instance.rule.file}:{node.instance.rule.line}" if node.instance else ""
    data = {"rule": node.instance.rule.text} if node.instance else {}
    kind = KIND_OF_NODE[node.kind] if below or node.kind != "derived" else ReasonKind.CONVENTION
    return Reason(node.claim, node.sentence, kind, source, tuple(below), data)


def _rejected(rival: RivalChoice) -> Reason:
    """Return the reason why another choice was not made."""
    claim = f"not chosen: {rival.atom or 'none of them'}"
    return Reason(claim, rival.sentence, ReasonKind.REJECTED, "", (), {"costs": [list(cost) for cost in rival.costs]})
