"""Rules and queries over the believed facts, joined by clingo: what certainly holds, and what may hold.

Predicates are derived in the order of their dependencies, so that negation and aggregates read complete ones. Then
all that clingo derives are facts: nothing is searched.
"""

from collections.abc import Iterator, Sequence
from typing import Any

import clingo
from clingo.ast import AST, ASTType, Sign

from utak.kb.language.vocabulary import Signature
from utak.kb.three_valued.arithmetic import ClauseError, place_of
from utak.kb.three_valued.compilation import (
    Conjunction,
    UnsafeError,
    arguments_of,
    is_atom,
    read_as_they_stand,
    signature_of,
)
from utak.kb.three_valued.functions import FoundError, Functions
from utak.kb.three_valued.open_world import Beliefs
from utak.kb.tracing.instrument import instance_rules
from utak.kb.tracing.requests import instance_infos, unit_infos
from utak.kb.tracing.syntax import JsonValues, ProgramPart, SyntaxPart, nodes_in, parsed

AtomRow = Sequence[clingo.Symbol]  # the arguments of an atom


class Evaluation:
    """The facts of a world model, with all that rules derive of them."""

    # A query is joined by a clingo of its own, and then forgotten.

    def __init__(self, beliefs: Beliefs, rules: Sequence[AST]) -> None:
        """Raise ClauseError for rules that cannot be evaluated."""
        self._beliefs, self._written = beliefs, rules
        clauses = [SyntaxPart(rule) for rule in rules]
        self._control = _control()
        self._functions = Functions(self._rows, beliefs.known_names)
        self.derived = {_head(rule) for rule in clauses}  # the predicates that the rules derive
        for number, level in enumerate(_levels(clauses)):
            self._derive(number, level)

    def _rows(self, predicate: str, arity: int) -> Iterator[AtomRow]:
        """Yield the rows of a predicate of any prefix, which rules or facts state."""
        prefix = next((one for one in ("maybe__", "any__") if predicate.startswith(one)), "")
        signature = predicate.removeprefix(prefix), arity
        if signature in self.derived:
            found = self._control.symbolic_atoms.by_signature(predicate, arity)
            yield from (atom.symbol.arguments for atom in found)
        rows = self._beliefs.possible_rows(signature, prefix == "any__") if prefix else self._beliefs.rows(signature)
        yield from rows

    def _derive(self, number: int, rules: Sequence[Any]) -> None:
        """Derive what some rules say, certain and possible."""
        texts: list[str] = []
        growing = {_head(rule) for rule in rules}
        for rule in rules:
            fixed, (name, _) = read_as_they_stand(rule.body), _head(rule)
            for certain, prefix in ((True, ""), (False, "maybe__")):
                body = Conjunction(certain, fixed, growing=growing).add(rule.body)
                parts = [body.term(part) for part in arguments_of(rule.head.atom)]
                texts.append(body.rule(f"{prefix}{name}", parts if certain else body.widest(name, parts)))
        self._ground(self._control, f"level{number}", texts)

    def _ground(self, control: clingo.Control, part: str, texts: Sequence[str]) -> clingo.Control:
        """Return clingo after it joined rules; raise ClauseError for a calculation without a result."""
        self._functions.forget()
        control.add(part, [], "\n".join(texts))
        control.ground([(part, [])], context=self._functions)
        if self._functions.error is not None:
            raise self._functions.error
        return control

    def rows(self, body: Sequence[Any], names: Sequence[str]) -> list[AtomRow]:
        """Return the values of some variables for which a body certainly holds."""
        query = Conjunction(True).add(body)
        if missing := [name for name in names if name not in query.values]:
            raise UnsafeError(missing[0], place_of(body[0]))
        text = query.rule("query__", [query.values[name] for name in names])
        control = self._ground(_control(), "base", [text])
        return [atom.symbol.arguments for atom in control.symbolic_atoms.by_signature("query__", len(names))]

    def may_hold(self, body: Sequence[Any]) -> bool:
        """Return whether a body may hold."""
        query = Conjunction(False).add(body)
        try:
            self._ground(_control(), "base", [query.rule("query__", [f"@stop({','.join(query.told())})"])])
        except FoundError:
            return True
        return False

    def instances(self) -> JsonValues:
        """Return the instances of the rules that certainly hold, and all atoms that do, as of kb.tracing.requests."""
        program = parsed((ProgramPart("rules", 1, "\n".join(map(str, self._written))),))

        def joined(body: Sequence[AST], given: Sequence[str]) -> list[str]:
            """Return a body as it certainly holds, with the values of its variables under their names."""
            trees = [SyntaxPart(one) for one in body]
            found = Conjunction(True, read_as_they_stand(trees), {name: name for name in given}).add(trees)
            return [*found.text, *(f"{name} = {value}" for name, value in found.values.items() if name not in given)]

        control = self._ground(_control(), "base", [*instance_rules(program, joined)])
        atoms = [atom.symbol for atom in control.symbolic_atoms]
        own = (str(atom.symbol) for one in self.derived for atom in self._control.symbolic_atoms.by_signature(*one))
        rows = self._beliefs.signatures.items()
        stated = [*(str(clingo.Function(name, row)) for (name, _), known in rows for row in known), *own]
        found = instance_infos(atom for atom in atoms if atom.name.startswith("trace__"))
        return {"units": unit_infos(program), "atoms": stated, **found}


def _control() -> clingo.Control:
    """Return clingo without a program."""
    return clingo.Control(["--warn=none"], logger=lambda _code, _text: None, message_limit=0)


def _head(rule: Any) -> Signature:
    """Return the predicate that a rule derives."""
    head = rule.head
    if head.ast_type != ASTType.Literal or head.sign != Sign.NoSign or head.atom.ast_type != ASTType.SymbolicAtom:
        raise ClauseError("a rule has one plain atom as its head here", place_of(head))
    return signature_of(head.atom)


def _levels(rules: Sequence[Any]) -> list[list[Any]]:
    """Return rules in groups, each after those whose complete predicates it reads."""
    # Raises ClauseError when a predicate depends on its own negation.
    level = {_head(rule): 0 for rule in rules}
    needs = [(_head(rule), read, more, rule) for rule in rules for read, more in _reads(rule) if read in level]
    while low := [one for one in needs if level[one[0]] < level[one[1]] + one[2]]:
        head, read, more, rule = low[0]
        level[head] = level[read] + more
        if level[head] > len(level):
            raise ClauseError("{}/{} is defined through its own negation".format(*read), place_of(rule))
    return [[rule for rule in rules if level[_head(rule)] == at] for at in range(max(level.values(), default=-1) + 1)]


def _reads(rule: Any) -> Iterator[tuple[Signature, int]]:
    """Yield the predicates that a rule reads, each with 1 where it must be complete before."""
    for literal in rule.body:
        for node in nodes_in(literal):
            if node.ast_type == ASTType.SymbolicAtom:
                yield signature_of(node), int(not is_atom(literal))
