"""Users' rules checked against the vocabulary: the encodings that each rule reaches, and the errors in it.

A rule reaches an encoding when all its predicates are known there: documented predicates of that encoding, or
predicates of the user's own that rules define there. `belief` stands for the facts that queries read.
"""

from collections.abc import Container, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from utak.kb.language.arguments import ArgumentType
from utak.kb.language.diagnostics import BadInputError, Problem, SourceSpan, did_you_mean
from utak.kb.language.reader import facts_from_text
from utak.kb.language.source_text import Source
from utak.kb.language.terms import Fact
from utak.kb.language.vocabulary import BELIEF_PREDICATES, Signature
from utak.kb.reasoning.interfaces import (
    COMPOUND_FORMS,
    DEFINING_FACTS,
    READ_ONLY_PREDICATES,
    READ_ONLY_THERE,
    TRANSIENT_NUMBERS,
    USER_RULE_INTERFACES,
    WORLD_FACTS_THERE,
)

QUERY_INTERFACE = "belief"  # the name under which the facts that queries read stand among the encodings
# Predicates of encodings that users' rules do not reach, and those encodings.
INTERNAL_PREDICATES: Mapping[Signature, tuple[str, ...]] = {
    ("chosen", 1): ("accommodation",), ("explanation", 4): ("accommodation",), ("choose", 1): ("aims", "routes"),
    ("aim", 3): ("aims",), ("besides", 2): ("aims",), ("chance", 2): ("aims",),
    ("last", 1): ("aims", "routes", "transport"),
    ("take", 1): ("boldness",), ("plan", 2): ("boldness",), ("hopes", 1): ("boldness",), ("askew", 1): ("boldness",),
    ("short", 1): ("boldness",), ("aside", 1): ("boldness",), ("route", 4): ("routes",), ("through", 2): ("routes",),
    ("not_through", 1): ("routes",), ("door_price", 2): ("routes",), ("option", 4): ("transport",),
    ("refuted", 3): ("transport",),
    ("undecided", 3): ("transport",), ("hopeless", 0): ("transport",), ("try", 3): ("transport",),
    ("halt", 3): ("feel",), ("tells", 4): ("feel",), ("feel", 1): ("feel",),
    ("unlikely", 2): ("accommodation",), ("odd", 1): ("accommodation",), ("crooked", 2): ("accommodation",),
    ("stands", 0): ("accommodation",), ("met", 1): ("accommodation",), ("off_middle", 0): ("accommodation",),
    ("trust", 1): ("accommodation",), ("slips", 0): ("accommodation",), ("proven", 0): ("accommodation",),
    ("contradicted", 1): ("accommodation",), ("cramped", 1): ("accommodation",),
    ("clear", 0): ("accommodation",), ("uneven", 0): ("accommodation",), ("unchanged", 0): ("accommodation",),
}  # fmt: skip
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
    # Of each argument its name and number of arguments when it is a compound term, else None
    forms: tuple[tuple[str, int] | None, ...]
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
    heads, body = (tuple(_atom(one) for one in entry[part]) for part in ("heads", "body"))
    declares = (entry["declares"][0], entry["declares"][1]) if entry["declares"] else None
    return Statement(
        source=source,
        at=(entry["at"][0], entry["at"][1]),
        heads=heads,
        body=body,
        text=entry["text"],
        written=entry["written"],
        condition=entry["condition"],
        is_single_atom_rule=entry["plain"],
        declares=declares,
        variables=tuple(entry["variables"]),
    )


def _atom(entry: Mapping[str, Any]) -> RuleAtom:
    """Return an atom from the JSON values of the worker: name, constants, at, places, forms, negative."""
    line, column = entry["at"]
    places = tuple((place[0], place[1]) for place in entry["places"])
    forms = tuple(None if form is None else (form[0], form[1]) for form in entry["forms"])
    return RuleAtom(entry["name"], tuple(entry["constants"]), (line, column), places, forms, entry["negative"])


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
        for atom in (*one.heads, *one.body):
            if (
                atom.signature in INTERNAL_PREDICATES
                and atom.signature not in INTERFACE_PREDICATES | self.own_predicates
            ):
                where = " and ".join(f"{name}.lp" for name in INTERNAL_PREDICATES[atom.signature])
                what = f"{_form(atom.signature)} belongs to {where}, which rules of users do not reach"
                yield one.problem(
                    what, atom.at, f"they reach {', '.join(f'{name}.lp' for name in sorted(USER_RULE_INTERFACES))}"
                )
        for atom in one.body:
            if atom.signature not in INTERFACE_PREDICATES | self.own_predicates | self._declared | set(
                INTERNAL_PREDICATES
            ):
                yield one.problem(*_unknown(atom, INTERFACE_PREDICATES | self.own_predicates))
            yield from self._unknown_steps(one, atom)
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

    def _unknown_steps(self, one: Statement, atom: RuleAtom) -> Iterator[Problem]:
        """Yield the problems of steps and activities in an atom of a body that no encoding knows."""
        # The atom never holds.
        options = [types[atom.signature] for types in USER_RULE_INTERFACES.values() if atom.signature in types]
        for number, place in enumerate(atom.places):
            form, constant = atom.forms[number], atom.constants[number]
            kinds = {types[number].name for types in options}
            if (form is None and constant is None) or not kinds or not kinds <= COMPOUND_FORMS.keys():
                continue
            name, count = form or (str(constant), 0)
            known = {known: counts for kind in sorted(kinds) for known, counts in COMPOUND_FORMS[kind].items()}
            if known.get(name) != count:
                hint = f"there is {name}/{known[name]}" if name in known else did_you_mean(name, known)
                yield one.problem(f"unknown {' or '.join(sorted(kinds))} {name}/{count}", place, hint)

    def _constants_outside_domains(self, one: Statement, atom: RuleAtom) -> Iterator[Problem]:
        """Yield the problems of constants in a head atom that no encoding accepts at their place."""
        options = [
            interface[atom.signature] for interface in USER_RULE_INTERFACES.values() if atom.signature in interface
        ]
        for number, constant in enumerate(atom.constants):
            if constant is not None and options:
                term = facts_from_text(f"p({constant}).")[0].args[0]
                complaints = [types[number].check(term) for types in options]
                if options[0][number].name in TRANSIENT_NUMBERS:
                    what = f"there is no {options[0][number].name} {constant}: they are numbered anew each time"
                    yield one.problem(what, atom.places[number], "take the number from the facts, as a variable")
                elif all(complaint is not None for complaint in complaints) and complaints[0] is not None:
                    yield one.problem(complaints[0].what, atom.places[number], complaints[0].hint)

    def _taking_part(self, encoding: str) -> tuple[Statement, ...]:
        """Return the statements that take part in an encoding."""
        known, world = PREDICATES_BY_ENCODING[encoding], WORLD_FACTS_THERE.get(encoding, frozenset())
        found = self._applicable(known | world, READ_ONLY_THERE.get(encoding, frozenset()) | world)
        if not world or encoding == "task":
            return found
        of_world = self._applicable(world, world)  # with what they define
        return tuple(one for one in found if one.heads or one not in of_world)

    def world_facts_named(self, encoding: str, lines: Container[str] | None = None) -> frozenset[Signature]:
        """Return the predicates of the world model that rules name, all or those at some lines, in an encoding."""
        rules = (one for one in self.rules_reaching(encoding) if lines is None or one.line in lines)
        named = {atom.signature for one in rules for atom in one.body}
        return WORLD_FACTS_THERE.get(encoding, frozenset()) & named

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


def _unknown(atom: RuleAtom, known: Iterable[Signature]) -> tuple[str, tuple[int, int], str]:
    """Return message, place (line, column) and hint for an atom whose predicate does not exist."""
    known = set(known)
    forms = sorted(_form(other) for other in known if other[0] == atom.name)
    hint = f"there is {', '.join(forms)}" if forms else did_you_mean(atom.name, {name for name, _ in known})
    return f"unknown predicate {_form(atom.signature)}", atom.at, hint


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
