"""Users' rules checked against the vocabulary: the encodings that each rule reaches, and the errors in it.

A rule reaches an encoding when all its predicates are known there: documented predicates of that encoding, or
predicates of the user's own that rules define there. `belief` stands for the facts that queries read.
"""

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from utak.kb.language.arguments import ArgumentType
from utak.kb.language.diagnostics import BadInputError, Problem, SourceSpan, did_you_mean
from utak.kb.language.goal_words import ROBOT
from utak.kb.language.reader import facts_from_text
from utak.kb.language.source_text import Source
from utak.kb.language.terms import Fact, Symbol
from utak.kb.language.vocabulary import BELIEF_PREDICATES, Signature, hint_for
from utak.kb.reasoning.interfaces import (
    COMPOUND_FORMS,
    DEFINING_FACTS,
    READ_ONLY_PREDICATES,
    READ_ONLY_THERE,
    TRANSIENT_NUMBERS,
    USER_RULE_INTERFACES,
    WORLD_FACTS_THERE,
    WORLD_PREDICATES,
)

QUERY_INTERFACE = "belief"  # the name under which the facts that queries read stand among the encodings
# By the name of an encoding: its predicates that users' rules do not reach.
INTERNAL_THERE = {
    "accommodation": (
        "chosen/1 explanation/4 unlikely/2 odd/1 crooked/2 stands/0 met/1 off_middle/0 trust/1 slips/0 proven/0 "
        "contradicted/1 cramped/1 clear/0 uneven/0 unchanged/0"
    ),
}
# These predicates, and those encodings.
INTERNAL_PREDICATES: dict[Signature, tuple[str, ...]] = {}
for _encoding, _forms in INTERNAL_THERE.items():
    for _name, _arity in (form.split("/") for form in _forms.split()):
        INTERNAL_PREDICATES[_name, int(_arity)] = (*INTERNAL_PREDICATES.get((_name, int(_arity)), ()), _encoding)
# The predicates that rules may use, by encoding.
PREDICATES_BY_ENCODING: Mapping[str, frozenset[Signature]] = {
    **{name: frozenset(interface) for name, interface in USER_RULE_INTERFACES.items()},
    QUERY_INTERFACE: frozenset(BELIEF_PREDICATES),
}
# All predicates of the world model and of the encodings that users' rules may use.
INTERFACE_PREDICATES = frozenset(signature for known in PREDICATES_BY_ENCODING.values() for signature in known)


@dataclass(frozen=True)
class RuleAtom:
    """An atom in a rule."""

    name: str  # the name of the predicate
    constants: tuple[str | None, ...]  # of each argument its text when it is a constant, else None
    at: tuple[int, int]  # line and column of the atom, from 1
    places: tuple[tuple[int, int], ...]  # line and column of each argument, from 1
    # Of each argument its name and the text of its own arguments without variables when it is compound, else None
    forms: tuple[tuple[str, tuple[str | None, ...]] | None, ...]
    negative: bool  # whether `not` stands before the atom, or it stands in an aggregate or a condition

    @property
    def signature(self) -> Signature:
        """The name of the predicate and its number of arguments."""
        return self.name, len(self.constants)


@dataclass(frozen=True)
class Statement:
    """A statement of a rule file."""

    source: Source  # the text of the file
    at: tuple[int, int]  # line and column of the statement, from 1
    heads: tuple[RuleAtom, ...]  # the atoms that it states or chooses
    body: tuple[RuleAtom, ...]  # the atoms on which these depend
    text: str  # the statement as clingo gets it, with checked arithmetic
    written: str  # the statement as the user wrote it, with constants replaced
    condition: str  # its body as clingo gets it; '' where it has none
    is_single_atom_rule: bool  # whether it is a rule with one atom as its head
    # The predicate (name, number of arguments) of a `#defined`, which states nothing; None for other statements
    declares: Signature | None
    variables: tuple[str, ...]  # the names of its global variables, in the order of the text

    @property
    def place(self) -> str:
        """File, line and column of the statement, such as `rules.lp:3:1`."""
        return f"{self.line}:{self.at[1]}"

    @property
    def line(self) -> str:
        """File and line of the statement, such as `rules.lp:3`."""
        return f"{self.source.file}:{self.at[0]}"

    def problem(self, what: str, at: tuple[int, int] | None = None, hint: str = "") -> Problem:
        """Return the problem `what` at the statement's place, or at another line and column (from 1)."""
        line, column = at or self.at
        return self.source.problem(SourceSpan(line, column, column), what, hint)


def statement_of(source: Source, entry: Mapping[str, Any]) -> Statement:
    """Return a statement from the JSON values of the worker (kb.reasoning.rule_reader.read_statements)."""
    values = _frozen(entry)
    heads, body = (tuple(RuleAtom(**one) for one in values.pop(part)) for part in ("heads", "body"))
    return Statement(source, heads=heads, body=body, **values)


def _frozen(value: Any) -> Any:
    """Return a JSON value with tuples in the place of lists."""
    if isinstance(value, Mapping):
        return {key: _frozen(inner) for key, inner in value.items()}
    return tuple(map(_frozen, value)) if isinstance(value, list | tuple) else value


class Rulebook:
    """The rules of all files of a user together."""

    def __init__(self, statements: Sequence[Statement]) -> None:
        self.statements = tuple(one for one in statements if one.declares is None)
        self._declared = {one.declares for one in statements if one.declares is not None}
        self._used = {atom.signature for one in self.statements for atom in one.body}
        self.own_predicates = {atom.signature for one in self.statements for atom in one.heads} - INTERFACE_PREDICATES
        problems = [problem for one in self.statements for problem in self._invalid_parts(one)]
        if problems:
            raise BadInputError(problems)
        self._counting = {name: self._taking_part(name) for name in PREDICATES_BY_ENCODING}
        problems = [problem for one in self.statements for problem in self._without_effect(one)]
        if problems:
            raise BadInputError(problems)

    @property
    def predicates(self) -> frozenset[Signature]:
        """All predicates (name, number of arguments) that these rules name or declare."""
        named = {atom.signature for one in self.statements for atom in (*one.heads, *one.body)}
        return frozenset(named | self._declared)

    def rules_reaching(self, encoding: str) -> tuple[Statement, ...]:
        """Return the rules that take part in an encoding, in the order of the files; () for none."""
        return self._counting.get(encoding, ())

    @property
    def self_contained(self) -> tuple[Statement, ...]:
        """The rules that depend on no predicate but those that they define themselves, in the order of the files."""
        return self._applicable(frozenset(), frozenset())

    @property
    def query_rules(self) -> tuple[Statement, ...]:
        """The rules over the world model with one atom as the head, a predicate of the user's own."""
        return tuple(
            one
            for one in self.rules_reaching(QUERY_INTERFACE)
            if one.is_single_atom_rule and one.heads[0].signature in self.own_predicates
        )

    def _invalid_parts(self, one: Statement) -> Iterator[Problem]:
        """Yield the problems of one statement: unknown, unreachable and read-only predicates, impossible constants."""
        known = INTERFACE_PREDICATES | self.own_predicates
        for atom in (*one.heads, *one.body):
            if atom.signature in INTERNAL_PREDICATES and atom.signature not in known:
                where = " and ".join(f"{name}.lp" for name in INTERNAL_PREDICATES[atom.signature])
                what = f"{_form(atom.signature)} belongs to {where}, which rules of users do not reach"
                reached = ", ".join(f"{name}.lp" for name in sorted(USER_RULE_INTERFACES))
                yield one.problem(what, atom.at, f"they reach {reached}")
        for atom in one.body:
            if atom.signature not in known | self._declared | INTERNAL_PREDICATES.keys():
                yield one.problem(*_unknown(atom, known))
            yield from _never_held(one, atom)
        for atom in one.heads:
            if atom.signature in READ_ONLY_PREDICATES:
                what = f"{_form(atom.signature)} says what there is, and rules add nothing to it"
                yield one.problem(what, atom.at)
            elif atom.signature in INTERFACE_PREDICATES:
                yield from self._constants_outside_domains(one, atom)
            elif self._is_misspelt(atom, one):
                yield one.problem(*_unknown(atom, INTERFACE_PREDICATES))

    def _is_misspelt(self, atom: RuleAtom, one: Statement) -> bool:
        """Return whether a head states a predicate that rules may state, with a wrong number of arguments."""
        if atom.signature not in self.own_predicates or atom.signature in self._used:
            return False
        spoken = {other.signature for other in one.body} & INTERFACE_PREDICATES
        known = [names for names in PREDICATES_BY_ENCODING.values() if not spoken or spoken & names]
        return any(atom.name == name for names in known for name, _ in names - READ_ONLY_PREDICATES)

    def _constants_outside_domains(self, one: Statement, atom: RuleAtom) -> Iterator[Problem]:
        """Yield the problems of constants in a head atom that no encoding accepts at their place."""
        options = [
            interface[atom.signature] for interface in USER_RULE_INTERFACES.values() if atom.signature in interface
        ]
        for constant, place, types in zip(atom.constants, atom.places, zip(*options, strict=True), strict=False):
            if constant is not None and types[0].name in TRANSIENT_NUMBERS:
                what = f"there is no {types[0].name} {constant}: they are numbered anew each time"
                yield one.problem(what, place, "take the number from the facts, as a variable")
            else:
                yield from _refused_everywhere(one, constant, types, place)

    def _taking_part(self, encoding: str) -> tuple[Statement, ...]:
        """Return the statements that take part in an encoding."""
        known, world = PREDICATES_BY_ENCODING[encoding], WORLD_FACTS_THERE.get(encoding, frozenset())
        read_only = READ_ONLY_THERE.get(encoding, frozenset())
        found = self._applicable(known | world, read_only | world)
        if not world or encoding == "task":
            return found
        world |= {signature for signature in read_only if signature in WORLD_PREDICATES}
        of_world = self._applicable(world, world)  # with what they define
        return tuple(one for one in found if one.heads or one not in of_world)

    def _applicable(self, known: frozenset[Signature], read_only: frozenset[Signature]) -> tuple[Statement, ...]:
        """Return the greatest set of statements whose predicates are all in `known` or defined by the set itself."""
        found = self.statements
        while True:
            defined = {atom.signature for one in found for atom in one.heads} & self.own_predicates | self._declared
            left = tuple(one for one in found if self._counts(one, known, defined, read_only))
            if left == found:
                return found
            found = left

    def _counts(
        self, one: Statement, known: frozenset[Signature], defined: set[Signature], read_only: frozenset[Signature]
    ) -> bool:
        """Return whether all predicates of a statement count."""
        stated = all(atom.signature in known - read_only or atom.signature in self.own_predicates for atom in one.heads)
        return stated and all(atom.signature in known | defined for atom in one.body)

    def _without_effect(self, one: Statement) -> Iterator[Problem]:
        """Yield one problem, why a statement has no effect in any encoding and in no query; nothing when it has one."""
        where = [name for name in PREDICATES_BY_ENCODING if one in self._counting[name]]
        if not where:
            names = sorted(
                {_form(atom.signature) for atom in (*one.heads, *one.body)} - {_form(s) for s in self.own_predicates}
            )
            what = f"this rule counts nowhere: no encoding knows all of {', '.join(names) or 'what it rests on'}"
            yield one.problem(what, hint="docs/reference/vocabulary.md says which predicates are known together")
        elif where == [QUERY_INTERFACE] and not (
            one.is_single_atom_rule and one.heads[0].signature in self.own_predicates
        ):
            what = "this changes nothing: what is believed is stated by the robot, and this rule reaches queries alone"
            yield one.problem(what, hint="define a predicate of your own, which can be asked for")


def _form(signature: Signature) -> str:
    """Return a predicate (name, number of arguments) as text, such as shape/3."""
    return f"{signature[0]}/{signature[1]}"


def _unknown(atom: RuleAtom, known: Collection[Signature]) -> tuple[str, tuple[int, int], str]:
    """Return message, place (line, column) and hint for an atom whose predicate does not exist."""
    return f"unknown predicate {_form(atom.signature)}", atom.at, hint_for(atom.name, known)


def _never_held(one: Statement, atom: RuleAtom) -> Iterator[Problem]:
    """Yield the problems of steps, activities and constants in an atom of a body with which no atom ever holds."""
    options = [types[atom.signature] for types in USER_RULE_INTERFACES.values() if atom.signature in types]
    if atom.signature in BELIEF_PREDICATES:
        options.append(BELIEF_PREDICATES[atom.signature].arguments)
    for form, constant, place, types in zip(
        atom.forms, atom.constants, atom.places, zip(*options, strict=True), strict=False
    ):
        kinds = sorted({type_.name for type_ in types})
        if not COMPOUND_FORMS.keys() >= set(kinds):
            yield from _refused_everywhere(one, constant, types, place)
            continue
        if form is None and constant is None:
            continue
        name, parts = form or (str(constant), ())
        known = {known: arguments for kind in kinds for known, arguments in COMPOUND_FORMS[kind].items()}
        if name not in known or len(known[name]) != len(parts):
            hint = f"there is {name}/{len(known[name])}" if name in known else did_you_mean(name, known)
            yield one.problem(f"unknown {' or '.join(kinds)} {name}/{len(parts)}", place, hint)
            continue
        for part, type_ in zip(parts, known[name], strict=True):
            yield from _refused_everywhere(one, part, [type_], place)


def _refused_everywhere(
    one: Statement, constant: str | None, types: Sequence[ArgumentType], place: tuple[int, int]
) -> Iterator[Problem]:
    """Yield the problem of a constant that none of some argument types accepts."""
    if constant in (None, ROBOT):  # rules call the node of the robot utak
        return
    term = facts_from_text(f"p({constant}).")[0].args[0]
    complaints = [complaint for type_ in types if (complaint := type_.check(term)) is not None]
    if len(complaints) == len(types):
        named = isinstance(term, Symbol) and complaints[0].hint.startswith("such as o1")
        hint = f"; for what parameter {constant} of a task means, write meaning({constant}, X)" if named else ""
        yield one.problem(complaints[0].what, place, complaints[0].hint + hint)


def why_not_in_domain(encoding: str, atom: Fact, given: Mapping[Signature, Sequence[Fact]]) -> str:
    """Return the reason why an encoding cannot take an atom that users' rules derived; '' when it can."""
    types = USER_RULE_INTERFACES[encoding][atom.signature]
    for type_, term in zip(types, atom.args, strict=True):
        complaint = type_.check(term)
        if complaint is not None:
            return complaint.what
        if type_.name in DEFINING_FACTS and str(term) not in _domain(type_, given):
            return f"there is no {type_.name} {term}"
    return ""


def _domain(type_: ArgumentType, given: Mapping[Signature, Sequence[Fact]]) -> set[str]:
    """Return the names of all things of a kind that given facts mention."""
    return {str(fact.args[at]) for signature, at in DEFINING_FACTS[type_.name] for fact in given.get(signature, ())}
