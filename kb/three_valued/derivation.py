"""Atoms that users' rules derive from the believed facts: certain atoms, and atoms that may hold besides."""

from collections.abc import Iterable, Sequence

from utak.kb.language.vocabulary import Signature
from utak.kb.three_valued.clauses import Aggregate, Atom, Clause, ClauseError, ConditionalLiteral, Literal, atoms_of
from utak.kb.three_valued.evaluation import find_bindings, fixed_confidence_variables
from utak.kb.three_valued.open_world import Beliefs
from utak.kb.three_valued.term_values import value_of


def derive(clauses: Sequence[Clause], beliefs: Beliefs) -> None:
    """Add to `beliefs` all atoms that the clauses derive."""
    # Predicates are evaluated in the order of their dependencies, so that `not` reads complete predicates (stratified
    # negation).
    for group in _dependency_groups(clauses):
        grows = True
        while grows:
            grows = sum(_apply(clause, beliefs, possible) for possible in (False, True) for clause in group) > 0


def _apply(clause: Clause, beliefs: Beliefs, possible: bool) -> int:
    """Add to `beliefs` the atoms that a clause derives, and return how many of them are new: a count, 0 for none."""
    assert clause.head is not None
    head, fixed_confidences = clause.head, fixed_confidence_variables(clause.body, ())
    found = list(find_bindings(clause.body, {}, beliefs, possible, fixed_confidences))
    rows = [tuple(value_of(part, one) for part in head.parts) for one in found]
    return sum(beliefs.add_derived(head.signature, row, possible) for row in rows)


def _dependency_groups(clauses: Sequence[Clause]) -> list[list[Clause]]:
    """Return the clauses in groups that define each other, each group after those on which it depends."""
    # Raises ClauseError when a group depends on its own negation.
    heads = {clause.head.signature: clause for clause in clauses if clause.head is not None}
    uses: dict[Signature, set[Signature]] = {head: set() for head in heads}
    for clause in clauses:
        assert clause.head is not None
        uses[clause.head.signature] |= {atom.signature for atom in atoms_of(clause.body)} & heads.keys()
    reach = {head: _reachable(head, uses) for head in uses}
    groups: list[list[Clause]] = []
    placed: set[Signature] = set()
    for head in sorted(uses, key=lambda one: (len(reach[one]), one)):
        if head in placed:
            continue
        mutual = {other for other in reach[head] if head in reach[other]} | {head}
        placed |= mutual
        group = [clause for clause in clauses if clause.head is not None and clause.head.signature in mutual]
        _check_stratified(group, mutual)
        groups.append(group)
    return groups


def _reachable(head: Signature, uses: dict[Signature, set[Signature]]) -> set[Signature]:
    """Return all predicates on which a predicate depends, directly or not; itself only if it depends on itself."""
    found: set[Signature] = set()
    edge = [head]
    while edge:
        new = uses[edge.pop()] - found
        found |= new
        edge += sorted(new)
    return found


def _check_stratified(group: Iterable[Clause], mutual: set[Signature]) -> None:
    """Raise ClauseError when a group of predicates depends on the negation of one of them."""
    for clause in group:
        for atom in _negated_atoms(clause.body):
            if atom.signature in mutual:
                what = f"{atom.name}/{len(atom.parts)} is defined through its own negation"
                raise ClauseError(what, clause.at)


def _negated_atoms(body: Iterable[Literal]) -> Iterable[Atom]:
    """Yield the atoms of a body that are negated, once or twice, or stand in aggregates or conditional literals."""
    for literal in body:
        if isinstance(literal, Atom) and literal.negations:
            yield literal
        elif isinstance(literal, Aggregate | ConditionalLiteral):
            yield from atoms_of(literal)
