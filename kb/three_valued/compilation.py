"""Bodies of rules and queries compiled to clingo: what certainly holds of them, and what may hold.

For each predicate p there are three: `p` for the rows that hold for certain, `maybe__p` for those that may hold, and
`any__p` for these with any confidence that may turn out. A value that is not known is a term of
kb.three_valued.values. Where it may meet another value, the functions of kb.three_valued.functions decide.
A variable gets a new name whenever less is possible for it, so that no calculation comes before what guards it.
"""

import itertools
import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from functools import partial
from typing import Any

from clingo import String, SymbolType
from clingo.ast import ASTType, Sign

from utak.kb.language.vocabulary import BELIEF_PREDICATES, Signature
from utak.kb.three_valued.arithmetic import ClauseError, place_of
from utak.kb.three_valued.values import MIRRORED_SIGNS
from utak.kb.tracing.syntax import (
    ANY_NAME,
    BINARY_SIGNS,
    FUNCTIONS,
    SIGNS,
    UNARY_SIGNS,
    nodes_in,
    outer_parts,
    variables_in,
)

ComparedTerms = tuple[Any, str, Any]  # a comparison of two terms
WaitingPart = tuple[Sequence[Any], partial[Any]]  # parts of a body, and what adds what they say
CLINGO_VARIABLE = re.compile(r"\bV[0-9]+__")
_numbers = itertools.count()


def signature_of(node: Any) -> Signature:
    """Return the name of the predicate of a symbolic atom, and its number of arguments."""
    symbol = node.symbol
    if symbol.ast_type == ASTType.UnaryOperation:
        hint = "write not, for what is not believed"
        raise ClauseError("classical negation is not known here", place_of(symbol), hint)
    return (symbol.symbol.name, 0) if symbol.ast_type == ASTType.SymbolicTerm else (symbol.name, len(symbol.arguments))


def arguments_of(node: Any) -> list[Any]:
    """Return the arguments of a symbolic atom."""
    return list(getattr(node.symbol, "arguments", ()))


def names_in(nodes: Iterable[Any]) -> dict[str, None]:
    """Return the names of the variables in parts of a syntax tree in their order; `_` stands for all unnamed ones."""
    return dict.fromkeys(name for node in nodes for name in variables_in(node))


class UnsafeError(ClauseError):
    """Nothing binds a variable."""

    def __init__(self, name: str, at: tuple[int, int]) -> None:
        super().__init__(f"nothing says what {name} can be: it must be in an atom that holds", at)


def read_as_they_stand(body: Iterable[Any], passed: Iterable[Any] = ()) -> frozenset[str]:
    """Return the variables that are passed on, or compared with others: confidences are read as believed for them."""
    found = names_in(passed)
    for literal in body:
        if literal.ast_type == ASTType.Literal and literal.atom.ast_type == ASTType.Comparison:
            names = names_in([literal])
            found |= names if len(names) > 1 else {}
    return frozenset(found)


def is_atom(literal: Any) -> bool:
    """Return whether a literal is an atom without negation."""
    plain = literal.ast_type == ASTType.Literal and literal.sign == Sign.NoSign
    return plain and bool(literal.atom.ast_type == ASTType.SymbolicAtom)


def _negated(literal: Any) -> Any:
    """Return the negation of a literal."""
    if literal.atom.ast_type == ASTType.SymbolicAtom:
        return literal.updated(sign=Sign.DoubleNegation if literal.sign == Sign.Negation else Sign.Negation)
    return literal.updated(sign=Sign.NoSign if literal.sign == Sign.Negation else Sign.Negation)


def atom_text(name: str, parts: Sequence[str]) -> str:
    """Return an atom, or a term with arguments."""
    return f"{name}({','.join(parts)}{',' * (not name and len(parts) == 1)})" if parts or not name else name


def tuple_text(parts: Sequence[str]) -> str:
    """Return a tuple."""
    return atom_text("", parts)


class Conjunction:
    """A conjunction compiled to clingo, as it certainly holds or as it may hold."""

    def __init__(
        self,
        certain: bool,
        fixed: frozenset[str] = frozenset(),
        values: Mapping[str, str] | None = None,
        growing: Collection[Signature] = (),
    ) -> None:
        # growing : the predicates that are not complete yet.
        self.certain, self._fixed, self._growing = certain, fixed, growing
        self.values = dict(values or {})  # the variables of clingo that have the values of the user's variables
        self.text: list[str] = []  # literals of clingo
        self._outer: Iterable[str] = ()  # the variables of the body outside of aggregates and conditions

    def told(self) -> list[str]:
        """Return variables that have values only where all literals hold: each gives one."""
        return list(
            dict.fromkeys(CLINGO_VARIABLE.findall(" ".join(one.partition(" = #count")[0] for one in self.text)))
        )

    def widest(self, name: str, parts: Sequence[str]) -> Sequence[str]:
        """Return a row of a predicate that the literals derive, none that another one includes: else some never end."""
        if not parts or not all(map(CLINGO_VARIABLE.search, self.text)):
            return parts  # it could be asked for before all literals hold
        row = [self.fresh() for _ in parts]
        given = ",".join([f'"{name}"', str(len(parts)), *parts, *self.told()])
        self.text.append(f"{tuple_text(row)} = @widest({given})")
        return row

    def rule(self, name: str, parts: Sequence[str]) -> str:
        """Return a rule with these literals as its body."""
        return f"{atom_text(name, parts)} :- {'; '.join(self.text)}." if self.text else f"{atom_text(name, parts)}."

    # ---- terms ----

    def fresh(self) -> str:
        """Return a new variable."""
        return f"V{next(_numbers)}__"

    def call(self, function: str, *parts: object) -> str:
        """Return a new variable with the value of a function (kb.three_valued.functions)."""
        found = self.fresh()
        self.text.append(f"{found} = @{function}({','.join(map(str, parts))})")
        return found

    def term(self, node: Any) -> str:
        """Return the value of a term whose variables all have values."""
        kind = node.ast_type
        if kind == ASTType.Variable:
            if node.name not in self.values:
                raise UnsafeError(node.name, place_of(node))
            return self.values[node.name]
        if kind == ASTType.SymbolicTerm:
            return str(node.symbol)
        if kind == ASTType.Interval:
            return f"range__({self._number(node.left)},{self._number(node.right)})"
        if kind == ASTType.UnaryOperation:
            constant = getattr(node.argument, "symbol", None)
            if UNARY_SIGNS[node.operator_type] == "-" and constant and constant.type == SymbolType.Number:
                return str(-abs(constant.number))  # clingo has wrapped 2147483648 to the least number
            return self._calculated(node, UNARY_SIGNS[node.operator_type], self.term(node.argument))
        if kind == ASTType.BinaryOperation:
            return self._calculated(node, BINARY_SIGNS[node.operator_type], self.term(node.left), self.term(node.right))
        if kind == ASTType.Function and not node.external:
            return self.call("compound", f'"{node.name}"', *map(self.term, node.arguments))
        raise ClauseError("operation undefined: there are no functions from outside", place_of(node))

    def unbound(self, *nodes: Any) -> list[str]:
        """Return the variables in some terms that have no values yet."""
        return [name for name in names_in(nodes) if name not in self.values]

    def unify(self, node: Any, value: str) -> None:
        """Say that a term has a value, of which its variables get theirs; raise UnsafeError where they cannot."""
        kind, certain = node.ast_type, int(self.certain)
        if kind == ASTType.Variable and node.name not in self.values:
            self.values |= {node.name: value} if node.name != "_" else {}
        elif not self.unbound(node):
            self._narrow(node, "=", value)
        elif kind == ASTType.Function:
            for at, part in enumerate(node.arguments):
                self.unify(part, self.call("part", certain, value, f'"{node.name}"', len(node.arguments), at))
        elif kind == ASTType.UnaryOperation and UNARY_SIGNS[node.operator_type] == "-":
            self.unify(node.argument, self.call("undo", '"-"', 0, 0, value))
        elif kind == ASTType.BinaryOperation and (sign := BINARY_SIGNS[node.operator_type]) in "+-*":
            first = bool(self.unbound(node.left))
            open_, other = (node.left, node.right) if first else (node.right, node.left)
            self.unify(open_, self.call("undo", f'"{sign}"', int(first), self.term(other), value))
        else:
            raise UnsafeError(self.unbound(node)[0], place_of(node))

    def _narrow(self, node: Any, sign: str, value: str) -> None:
        """Say how a term compares with a value; a variable is from then on what it can still be."""
        found = self.call("narrow", int(self.certain), self.term(node), f'"{sign}"', value)
        if node.ast_type == ASTType.Variable:
            self.values[node.name] = found

    # ---- literals ----

    def add(self, body: Sequence[Any]) -> "Conjunction":
        """Add literals, each as soon as its variables have values: atoms first, and tests before what gives values."""
        self._outer = self.values.keys() | names_in(part for literal in body for part in outer_parts(literal))
        atoms = [literal.atom for literal in body if is_atom(literal)]
        waiting = [one for literal in body if not is_atom(literal) for one in self._waiting(literal)]
        while atoms:
            chosen = max(atoms, key=lambda atom: len(self.values.keys() & names_in([atom])))
            atoms = [atom for atom in atoms if atom is not chosen]
            waiting += self._atom(chosen)
        while waiting:
            waiting.sort(key=lambda one: self._cost(one[0]))
            failures = []
            for at, (_, say) in enumerate(waiting):
                before = dict(self.values), len(self.text)
                try:
                    say()
                except UnsafeError as error:
                    self.values, self.text[before[1] :] = before[0], []
                    failures.append(error)
                else:
                    del waiting[at]
                    break
            else:
                if not self._between([say.args for nodes, say in waiting if len(nodes) == 2]):
                    raise failures[0]
        return self

    def _waiting(self, literal: Any) -> list[WaitingPart]:
        """Return what a literal says that must wait until variables have values."""
        if literal.ast_type == ASTType.ConditionalLiteral:
            return [([literal], partial(self._conditional, literal))]
        atom, negated = literal.atom, literal.sign == Sign.Negation
        if atom.ast_type == ASTType.SymbolicAtom:
            signature_of(atom)
            return [([literal], partial(self._negation, literal))]
        if atom.ast_type == ASTType.Comparison:
            pairs = list(pairs_of(atom))
            if negated:
                return [([literal], partial(self._not_all, pairs))]
            return [([left, right], partial(self._compare, left, sign, right)) for left, sign, right in pairs]
        if atom.ast_type == ASTType.TheoryAtom:
            raise ClauseError("theory atoms are not known here", place_of(literal))
        if atom.ast_type == ASTType.BooleanConstant:
            return [([literal], partial(self.call, "nothing"))] if bool(atom.value) == negated else []
        return [([literal], partial(self._aggregate, literal))]

    def _atom(self, atom: Any) -> Iterator[WaitingPart]:
        """Add a positive atom; yield what its arguments say of variables that have no values yet."""
        signature = signature_of(atom)
        predicate = f"{'' if self.certain else self._prefix(atom, signature)}{signature[0]}"
        is_complete, before = signature not in self._growing, dict(self.values)
        given, parts, same = [], [], []
        for node in arguments_of(atom):
            is_plain = node.ast_type in (ASTType.Variable, ASTType.SymbolicTerm)
            name = node.name if node.ast_type == ASTType.Variable else ""
            given.append(before.get(name, ANY_NAME) if name or not is_plain else self.term(node))
            if self.certain and not is_complete and is_plain and (not name or name in self.values):
                parts.append(self.term(node))
                continue
            parts.append(self.fresh())
            is_first = self.values.get(name) == before.get(name) and (is_complete or name not in before)
            if not is_plain:
                yield [node], partial(self.unify, node, parts[-1])
            elif name not in ("", "_") and is_first:
                self.values[name] = parts[-1]
            elif name or not is_complete:
                same.append((node, parts[-1]))
        if not is_complete:
            self.text.append(atom_text(predicate, parts))
        elif parts:
            self.text.append(f'{tuple_text(parts)} = @joined({int(self.certain)},"{predicate}",{",".join(given)})')
        else:
            self.call("match", 1, f'"{predicate}"')
        for node, value in same:
            self.unify(node, value)

    def _prefix(self, atom: Any, signature: Signature) -> str:
        """Return the prefix of the predicate of what may hold, with any confidence unless it is read as it stands."""
        declared = BELIEF_PREDICATES.get(signature)
        if declared is None or not declared.confident:
            return "maybe__"
        last = arguments_of(atom)[-1]
        return "maybe__" if last.ast_type == ASTType.Variable and last.name in self._fixed else "any__"

    def _cost(self, nodes: Sequence[Any]) -> int:
        """Return 0 for a test without arithmetic, 1 for one with it, 2 for what gives a value."""
        if self.unbound(*nodes):
            return 2
        return int(any(part.ast_type == ASTType.BinaryOperation for node in nodes for part in nodes_in(node)))

    def _between(self, pairs: Sequence[ComparedTerms]) -> bool:
        """Give a variable that is only compared with numbers those between the least and the greatest of them."""
        ends: dict[str, dict[str, Any]] = {"<": {}, ">": {}, "=": {}, "!": {}}
        for left, sign, right in [*pairs, *((right, MIRRORED_SIGNS[sign], left) for left, sign, right in pairs)]:
            if left.ast_type == ASTType.Variable and not names_in([right]):
                ends[sign[0]].setdefault(left.name, right)
        name = next((name for name in ends["<"] if name in ends[">"] and name not in self.values), "")
        if name:
            self.values[name] = self._each(ends[">"][name], ends["<"][name])
        return bool(name)

    def _compare(self, left: Any, sign: str, right: Any) -> None:
        """Add a comparison of two terms, which may give values to the variables of one of them."""
        if sign == "=" and self.unbound(right):
            left, right = right, left
        if sign == "=" and self.unbound(left):
            many = right.ast_type == ASTType.Interval
            self.unify(left, self._each(right.left, right.right) if many else self.term(right))
            return
        if left.ast_type != ASTType.Variable and (
            right.ast_type == ASTType.Variable or left.ast_type == ASTType.Interval
        ):
            left, sign, right = right, MIRRORED_SIGNS[sign], left
        one, other = self.term(left), self.term(right)
        if one == other:
            if sign in ("<", ">", "!="):
                self.call("nothing")
            return
        self._narrow(left, sign, other)
        if not self.certain and right.ast_type == ASTType.Variable:
            self._narrow(right, MIRRORED_SIGNS[sign], one)

    def _each(self, low: Any, high: Any) -> str:
        """Return each number of an interval in turn."""
        ends = self._number(low), self._number(high)
        if not self.certain:
            return self.call("each", *ends)
        self.text.append(f"{(found := self.fresh())} = {ends[0]}..{ends[1]}")
        return found

    def _number(self, node: Any) -> str:
        """Return the value of a term that must be a number."""
        return self._calculated(node, "+", "0", self.term(node))

    def _calculated(self, node: Any, sign: str, *parts: str) -> str:
        """Return the result of a calculation, which is made only where all that was said before holds."""
        place, shown = "({},{})".format(*place_of(node)), sign.replace("\\", "\\\\")
        return self.call("calculate_if", place, f'"{shown}"', tuple_text(parts), *self.told())

    def _not_all(self, pairs: Sequence[ComparedTerms]) -> None:
        """Add that not all of some comparisons hold."""
        shown = (f'({self.value_of(left)},"{sign}",{self.value_of(right)})' for left, sign, right in pairs)
        self.call("not_all", int(self.certain), *shown)

    def value_of(self, one: Any) -> str:
        """Return the value of a term, or a value itself."""
        return one if isinstance(one, str) else self.term(one)

    def _negation(self, literal: Any) -> None:
        """Add a negated atom: what is certain rules out `not`, and what may hold makes it uncertain."""
        atom, signature = literal.atom, signature_of(literal.atom)
        parts = [self._pattern(node) for node in arguments_of(atom)]
        wanted = literal.sign != Sign.Negation
        prefix = "" if self.certain == wanted else self._prefix(atom, signature)
        self.call("match", int(wanted), f'"{prefix}{signature[0]}"', *parts)

    def _pattern(self, node: Any) -> str:
        """Return an argument of a negated atom, with `any__` for `_`."""
        if not (missing := self.unbound(node)):
            return self.term(node)
        if missing != ["_"]:
            raise UnsafeError(min(missing), place_of(node))
        if node.ast_type == ASTType.Function:
            return atom_text(node.name, list(map(self._pattern, node.arguments)))
        return ANY_NAME

    def _require(self, inside: Iterable[Any]) -> None:
        """Raise UnsafeError unless the variables that stand inside of an aggregate and outside have values."""
        for name in names_in(inside):
            if name in self._outer and name not in self.values and name != "_":
                raise UnsafeError(name, place_of(next(iter(inside))))

    def _conditional(self, literal: Any) -> None:
        """Add that the literal holds wherever its condition may hold: nowhere does its condition without it."""
        condition = list(literal.condition)
        self._require([literal])
        fixed = self._fixed | read_as_they_stand(condition, [literal.literal])
        inner = Conjunction(not self.certain, fixed, self.values).add([*condition, _negated(literal.literal)])
        count = self.fresh()
        self.text.append(f"{count} = #count {{ 1 : {', '.join(inner.text)} }}")
        self.call("narrow", 1, 0, '"="', count)

    def _aggregate(self, literal: Any) -> None:
        """Add an aggregate: its tuples are put together while clingo joins, and its value is told of them."""
        node, negated = literal.atom, literal.sign == Sign.Negation
        inside = [*node.elements]
        self._require(inside)
        given = [self.values[name] for name in names_in(inside) if name in self.values]
        key = tuple_text([str(next(_numbers)), *given])
        parts = []
        for element in inside:
            terms, condition = _element(element)
            fixed = self._fixed | read_as_they_stand(condition, terms)
            for certain in (True, False):
                inner = Conjunction(certain, fixed, self.values).add(condition)
                values = tuple_text([inner.term(term) for term in terms])
                put = f"@put({key},{int(certain)},{','.join([values, *inner.told()])})"
                parts.append(f"{put} : {', '.join(inner.text)}" if inner.text else put)
        count = self.fresh()
        self.text.append(f"{count} = #count {{ {'; '.join(parts)} }}")
        function = FUNCTIONS[node.function] if node.ast_type == ASTType.BodyAggregate else "#count"
        value = self.call("tally", "({},{})".format(*place_of(literal)), f'"{function}"', key, count)
        left, right = node.left_guard, node.right_guard
        guards = [(left.term, SIGNS[left.comparison])] if left is not None else []
        guards += [(right.term, MIRRORED_SIGNS[SIGNS[right.comparison]])] if right is not None else []
        if negated:
            self._not_all([(term, sign, value) for term, sign in guards])
            return
        for term, sign in sorted(guards, key=lambda guard: guard[1] != "=" or not self.unbound(guard[0])):
            if sign == "=" and self.unbound(term):
                self.unify(term, self.call("settled", value) if self.certain else value)
            else:
                self._narrow(term, sign, value)


def pairs_of(comparison: Any) -> Iterator[ComparedTerms]:
    """Yield the comparisons of a chain, each of two terms."""
    left = comparison.term
    for guard in comparison.guards:
        yield left, SIGNS[guard.comparison], guard.term
        left = guard.term


def _element(node: Any) -> tuple[list[Any], list[Any]]:
    """Return the tuple of an element of an aggregate, and its condition."""
    if node.ast_type == ASTType.BodyAggregateElement:
        return list(node.terms), list(node.condition)
    atom = node.literal.atom
    positive = atom.ast_type == ASTType.SymbolicAtom and node.literal.sign == Sign.NoSign
    return [_named(node.literal), *(arguments_of(atom) if positive else ())], [node.literal, *node.condition]


def _named(literal: Any) -> Any:
    """Return a text that tells literals of different predicates apart, as a term."""
    atom = literal.atom
    name = "{}/{}".format(*signature_of(atom)) if atom.ast_type == ASTType.SymbolicAtom else str(literal.location)
    return literal.updated(ast_type=ASTType.SymbolicTerm, symbol=String(name), child_keys=())
