"""A checker of proofs that shares no code with what makes them: it asks clingo anew about every node.

A rule node is right when its rule alone, as it stands in its file, derives the claim from the claims below it, and also
from all atoms of the answer. Leaves must be given, absent from the answer, or true whatever is given. Costs of other
choices are computed anew with the choice forced.
"""

import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import NamedTuple

import clingo
import clingo.ast

from utak.kb.explanation.values import ProofNode, RivalChoice, RuleText
from utak.kb.reasoning.encodings import encoding_files, encoding_text

ROOT = Path(__file__).resolve().parent.parent.parent.parent


class Decision(NamedTuple):
    """An answer of an encoding: its facts, all atoms that hold, the shown ones, and its cost by level."""

    encoding: Path
    facts: str
    atoms: frozenset[str]
    shown: frozenset[str]
    cost: dict[int, int]


def best_decisions(encoding: Path, facts: str) -> list[Decision]:
    """Return all best answers of an encoding."""
    control = _control(f"{encoding_text(encoding)}\n{facts}", ["--opt-mode=optN", "0"])
    found: list[Decision] = []

    def keep(model: clingo.Model) -> None:
        if model.optimality_proven or not model.cost:
            atoms, shown = (frozenset(map(str, model.symbols(**{way: True}))) for way in ("atoms", "shown"))
            cost = dict(zip(model.priority, model.cost, strict=True))
            found.append(Decision(encoding, facts, atoms, shown, cost))

    control.solve(on_model=keep)
    return found


def nodes(root: ProofNode) -> Iterator[ProofNode]:
    """Yield a node and all nodes below it, each once, a node before its children."""
    seen: set[int] = set()
    waiting = [root]
    while waiting:
        node = waiting.pop()
        if id(node) not in seen:
            seen.add(id(node))
            yield node
            waiting += reversed(node.children)


def faults(decision: Decision, root: ProofNode) -> list[str]:
    """Return what is wrong with a proof; [] when it is right."""
    found = list(_circles(root, ()))
    for node in nodes(root):
        found += _faults_of_node(decision, node)
    return found


def _circles(node: ProofNode, above: tuple[str, ...]) -> Iterator[str]:
    """Yield the atoms that rest on themselves."""
    if node.instance is not None and node.claim in above:
        yield f"{node.claim} rests on itself"
        return
    for child in node.children:
        yield from _circles(child, (*above, node.claim) if node.instance is not None else above)


def _faults_of_node(decision: Decision, node: ProofNode) -> Iterator[str]:
    if node.kind == "given":
        if node.claim not in _atoms_of(decision.facts):
            yield f"{node.claim} is not given"
    elif node.kind in ("derived", "chosen"):
        yield from _faults_of_rule(decision, node)
    elif node.kind == "absent":
        pattern = re.escape(node.claim.removeprefix("not ")).replace("_,", "[^,]*,").replace("_\\)", "[^,]*\\)")
        holding = [atom for atom in decision.atoms if re.fullmatch(pattern, atom)]
        if holding:
            yield f"{node.claim}, but {holding[0]} holds"
    elif node.kind == "comparison":
        if not _derives(f"{_constants(decision.encoding)} trace_ok :- {node.claim}.", "trace_ok"):
            yield f"{node.claim} is not so"
    elif node.kind not in ("aggregate", "each"):
        yield f"{node.claim} is of kind {node.kind}"
    for text in (node.words, node.sentence):
        if not text or re.search(r"\{[A-Z]\w*(/10+)?\}", text):
            yield f"{node.claim} reads {text!r}"
    if re.search(r"\bfalse\b", node.words):
        yield f"{node.claim} reads {node.words}"


def _faults_of_rule(decision: Decision, node: ProofNode) -> Iterator[str]:
    assert node.instance is not None
    rule = _rule_at(decision.encoding, _place(node.instance.rule))
    if node.claim not in decision.atoms:
        yield f"{node.claim} does not hold"
    below = {one.claim for child in node.children for one in _claims(child)}
    for facts in (below, decision.atoms):
        program = " ".join([rule, _constants(decision.encoding), *(f"{fact}." for fact in facts - {node.claim})])
        if not _derives(program, node.claim):
            yield f"{node.claim} does not follow by {rule} from {sorted(facts)}"
    if (node.kind == "chosen") != ("{" in rule.split(":-")[0]):
        yield f"{node.claim} is {node.kind} by {rule}"


def _claims(node: ProofNode) -> Iterator[ProofNode]:
    """Yield the atoms that a child of a rule node claims: itself, or those below an aggregate or a condition."""
    if node.kind in ("given", "derived", "chosen"):
        yield node
    else:
        for child in node.children:
            yield from _claims(child)


def faults_of_rivals(decision: Decision, node: ProofNode) -> list[str]:
    """Return what is wrong with the other ways to choose of a chosen atom; [] when nothing is."""
    heads = {rival.atom for rival in node.rivals if rival.atom} | {node.claim}
    return [fault for rival in node.rivals for fault in _faults_of_rival(decision, rival, heads)]


def _faults_of_rival(decision: Decision, rival: RivalChoice, heads: set[str]) -> Iterator[str]:
    force = f":- not {rival.atom}." if rival.atom else " ".join(f":- {head}." for head in sorted(heads))
    cost = _best_cost(encoding_text(decision.encoding), f"{decision.facts}\n{force}")
    if rival.verdict == "forbidden":
        if cost is not None:
            yield f"{rival.atom} is possible at {cost}"
        if rival.forbidden_by:
            places = {_place(one.rule) for one in rival.forbidden_by}
            rest = "\n".join(str(part) for part in _statements(decision.encoding) if _begin(part) not in places)
            if _best_cost(rest, f"{decision.facts}\n{force}") is None:
                yield f"{rival.atom} is forbidden by other rules than {sorted(places)}"
        return
    if cost is None:
        yield f"{rival.atom} is impossible"
        return
    given = {level: value for level, value in rival.costs if value}
    if {level: value for level, value in cost.items() if value} != given:
        yield f"{rival.atom} costs {cost}, not {given}"
    for level in sorted({*cost, *decision.cost}, reverse=True):
        more = sum(price.weight for price in rival.prices if price.level == level)
        more -= sum(price.weight for price in rival.saved if price.level == level)
        if more != cost.get(level, 0) - decision.cost.get(level, 0):
            yield f"{rival.atom}: prices differ by {more} on level {level}"
    unlike = [
        level
        for level in sorted({*cost, *decision.cost}, reverse=True)
        if cost.get(level, 0) != decision.cost.get(level, 0)
    ]
    if (rival.level, rival.verdict) != ((unlike[0], "dearer") if unlike else (None, "equal")):
        yield f"{rival.atom} is {rival.verdict} on level {rival.level}"
    if unlike and rival.difference != cost.get(unlike[0], 0) - decision.cost.get(unlike[0], 0):
        yield f"{rival.atom} differs by {rival.difference}"


def holds_somewhere(encoding: Path, facts: str, atom: str) -> bool:
    """Return whether some best answer of an encoding holds an atom, by cost: with it an answer costs no more."""
    text = encoding_text(encoding)
    with_atom = _best_cost(text, f"{facts}\n:- not {atom}.")
    return with_atom is not None and with_atom == _best_cost(text, facts)


def _best_cost(program: str, facts: str) -> dict[int, int] | None:
    """Return the cost by level of the best answer; None when there is none."""
    control = _control(f"{program}\n{facts}", ["--opt-mode=opt"])
    costs: list[dict[int, int]] = []
    control.solve(on_model=lambda model: costs.append(dict(zip(model.priority, model.cost, strict=True))))
    return costs[-1] if costs else None


def _derives(program: str, atom: str) -> bool:
    """Return whether a program has the atom in some answer."""
    control = _control(program, [])
    symbol = control.symbolic_atoms[clingo.parse_term(atom)]
    return symbol is not None and bool(control.solve(assumptions=[(clingo.parse_term(atom), True)]).satisfiable)


def _control(program: str, options: list[str]) -> clingo.Control:
    control = clingo.Control(options, logger=lambda _code, _text: None)
    control.add("base", [], program)
    control.ground([("base", [])])
    return control


@cache
def _statements(encoding: Path) -> tuple[clingo.ast.AST, ...]:
    found: list[clingo.ast.AST] = []
    clingo.ast.parse_files(list(map(str, encoding_files(encoding))), found.append)
    return tuple(found)


def _place(rule: RuleText) -> tuple[str, int]:
    """Return the name of the file in which a rule stands, and the line in which it begins."""
    return Path(rule.file).name, rule.line


def _begin(statement: clingo.ast.AST) -> tuple[str, int]:
    """Return the same of a statement of clingo's."""
    begin = statement.location.begin
    return Path(begin.filename).name, begin.line


@cache
def _rule_at(encoding: Path, place: tuple[str, int]) -> str:
    """Return the statement of an encoding that begins in a line of a file, as text."""
    kinds = (clingo.ast.ASTType.Rule, clingo.ast.ASTType.Minimize)
    (found,) = (s for s in _statements(encoding) if _begin(s) == place and s.ast_type in kinds)
    return str(found)


@cache
def _constants(encoding: Path) -> str:
    """Return the constants of an encoding as text."""
    return " ".join(str(s) for s in _statements(encoding) if s.ast_type == clingo.ast.ASTType.Definition)


@cache
def _atoms_of(facts: str) -> frozenset[str]:
    """Return the atoms that facts state, as clingo writes them."""
    control = _control(facts, [])  # it must live as long as its atoms are read
    return frozenset(str(atom.symbol) for atom in control.symbolic_atoms)
