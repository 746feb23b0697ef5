"""What rules of a user derive from what is believed: for certain, and what may hold besides."""

from collections.abc import Iterable, Sequence

from kb.three_valued.clauses import Aggregate, Atom, Clause, ClauseError, Every, Literal, atoms_of
from kb.three_valued.evaluation import bindings, confidences_read, value_of
from kb.three_valued.open_world import Beliefs, Signature


def derive(clauses: Sequence[Clause], beliefs: Beliefs) -> None:
    """Add to beliefs what clauses with heads derive; raises ClauseError where one is defined through its own negation.

    Predicates are worked out one after the other, those that others rest on first, so that `not` speaks of what is
    whole.
    """
    for group in _in_order(clauses):
        grows = True
        while grows:
            grows = sum(_apply(clause, beliefs, possible) for possible in (False, True) for clause in group) > 0


def _apply(clause: Clause, beliefs: Beliefs, possible: bool) -> int:
    """How many new rows a clause derives."""
    assert clause.head is not None
    head, now = clause.head, confidences_read(clause.body, ())
    found = list(bindings(clause.body, {}, beliefs, possible, now))
    rows = [tuple(value_of(part, one, beliefs) for part in head.parts) for one in found]
    return sum(beliefs.derive(head.signature, row, possible) for row in rows)


def _in_order(clauses: Sequence[Clause]) -> list[list[Clause]]:
    """The clauses in groups of those that define each other."""
    heads = {clause.head.signature: clause for clause in clauses if clause.head is not None}
    uses: dict[Signature, set[Signature]] = {head: set() for head in heads}
    for clause in clauses:
        assert clause.head is not None
        uses[clause.head.signature] |= {atom.signature for atom in atoms_of(clause.body)} & heads.keys()
    reach = {head: _reached(head, uses) for head in uses}
    groups: list[list[Clause]] = []
    placed: set[Signature] = set()
    for head in sorted(uses, key=lambda one: (len(reach[one]), one)):
        if head in placed:
            continue
        together = {other for other in reach[head] if head in reach[other]} | {head}
        placed |= together
        group = [clause for clause in clauses if clause.head is not None and clause.head.signature in together]
        _check(group, together)
        groups.append(group)
    return groups


def _reached(head: Signature, uses: dict[Signature, set[Signature]]) -> set[Signature]:
    found: set[Signature] = set()
    edge = [head]
    while edge:
        new = uses[edge.pop()] - found
        found |= new
        edge += sorted(new)
    return found


def _check(group: Iterable[Clause], together: set[Signature]) -> None:
    for clause in group:
        for atom in _under_negation(clause.body):
            if atom.signature in together:
                what = f"{atom.name}/{len(atom.parts)} is defined through its own negation"
                raise ClauseError(what, clause.at)


def _under_negation(body: Iterable[Literal]) -> Iterable[Atom]:
    for literal in body:
        if isinstance(literal, Atom) and literal.negations:
            yield literal
        elif isinstance(literal, Aggregate | Every):
            yield from atoms_of(literal)
