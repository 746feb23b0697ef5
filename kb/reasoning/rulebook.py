"""What the rules of a user say, held against the vocabulary: which encodings they reach, and what is wrong with them.

A rule counts in an encoding when all that it speaks of is known there: documented predicates of that encoding, and
predicates of the user's own that rules define there. `belief` stands for the facts that queries are asked of.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from kb.language.arguments import ArgumentType
from kb.language.diagnostics import BadInputError, Problem, Span, did_you_mean
from kb.language.reader import facts_of
from kb.language.source_text import Source
from kb.language.terms import Fact
from kb.language.vocabulary import BELIEF
from kb.reasoning.interfaces import DOMAINS, PASSING, REACHED, READ_ONLY, Signature

QUERIES = "belief"
UNREACHED: Mapping[Signature, tuple[str, ...]] = {
    ("chosen", 1): ("accommodation",), ("explanation", 4): ("accommodation",), ("choose", 1): ("aims", "routes"),
    ("aim", 3): ("aims",), ("chance", 2): ("aims",), ("last", 1): ("aims", "routes", "transport"),
    ("take", 1): ("boldness",), ("plan", 2): ("boldness",), ("hopes", 1): ("boldness",), ("askew", 1): ("boldness",),
    ("short", 1): ("boldness",), ("aside", 1): ("boldness",), ("route", 4): ("routes",), ("through", 2): ("routes",),
    ("not_through", 1): ("routes",), ("option", 4): ("transport",), ("refuted", 3): ("transport",),
    ("undecided", 3): ("transport",), ("hopeless", 0): ("transport",), ("try", 3): ("transport",),
    ("unlikely", 2): ("accommodation",), ("odd", 1): ("accommodation",), ("crooked", 2): ("accommodation",),
    ("stands", 0): ("accommodation",), ("met", 1): ("accommodation",), ("off_middle", 0): ("accommodation",),
    ("trust", 1): ("accommodation",), ("slips", 0): ("accommodation",), ("proven", 0): ("accommodation",),
    ("clear", 0): ("accommodation",), ("uneven", 0): ("accommodation",), ("unchanged", 0): ("accommodation",),
}  # fmt: skip
KNOWN: Mapping[str, frozenset[Signature]] = {
    **{name: frozenset(interface) for name, interface in REACHED.items()},
    QUERIES: frozenset(BELIEF),
}
DECLARED = frozenset(signature for known in KNOWN.values() for signature in known)


@dataclass(frozen=True)
class RuleAtom:
    """An atom in a rule. constants : arguments that are given, as text; None for others. places : line and column."""

    name: str
    constants: tuple[str | None, ...]
    at: tuple[int, int]
    places: tuple[tuple[int, int], ...]
    negative: bool

    @property
    def signature(self) -> Signature:
        """The name and the number of arguments."""
        return self.name, len(self.constants)


@dataclass(frozen=True)
class Statement:
    """A statement of a rule file.

    text : as it is given to clingo, with checked arithmetic. plain : a rule with one atom as its head; `written` is
    its text as the user wrote it. declares : the predicate of a `#defined`, which states nothing.
    """

    source: Source
    at: tuple[int, int]
    heads: tuple[RuleAtom, ...]
    body: tuple[RuleAtom, ...]
    text: str
    written: str
    plain: bool
    declares: Signature | None

    def problem(self, what: str, at: tuple[int, int] | None = None, hint: str = "") -> Problem:
        """Return what is wrong with this statement, at its place or another one."""
        line, column = at or self.at
        return self.source.problem(Span(line, column, column), what, hint)


def statement_of(source: Source, entry: Mapping[str, Any]) -> Statement:
    """Return a statement from what the worker has read (kb.reasoning.rule_reader)."""
    heads, body = (tuple(_atom(one) for one in entry[part]) for part in ("heads", "body"))
    declares = (entry["declares"][0], entry["declares"][1]) if entry["declares"] else None
    return Statement(
        source=source,
        at=(entry["at"][0], entry["at"][1]),
        heads=heads,
        body=body,
        text=entry["text"],
        written=entry["written"],
        plain=entry["plain"],
        declares=declares,
    )


def _atom(entry: Mapping[str, Any]) -> RuleAtom:
    line, column = entry["at"]
    places = tuple((place[0], place[1]) for place in entry["places"])
    return RuleAtom(entry["name"], tuple(entry["constants"]), (line, column), places, entry["negative"])


class Rulebook:
    """The rules of all files of a user together; raises BadInputError when they cannot be what is meant."""

    def __init__(self, statements: Sequence[Statement]) -> None:
        self.statements = tuple(one for one in statements if one.declares is None)
        self._declared = {one.declares for one in statements if one.declares is not None}
        self.own = {atom.signature for one in self.statements for atom in one.heads} - DECLARED - set(UNREACHED)
        problems = [problem for one in self.statements for problem in self._wrong(one)]
        if problems:
            raise BadInputError(problems)
        self._counting = {name: self._applicable(known) for name, known in KNOWN.items()}
        problems = [problem for one in self.statements for problem in self._useless(one)]
        if problems:
            raise BadInputError(problems)

    def counting(self, encoding: str) -> tuple[Statement, ...]:
        """Return the rules that count in an encoding, in the order of the files."""
        return self._counting.get(encoding, ())

    @property
    def alone(self) -> tuple[Statement, ...]:
        """The rules that speak of nothing but what they define themselves."""
        return self._applicable(frozenset())

    @property
    def queried(self) -> tuple[Statement, ...]:
        """The plain rules over what is believed, which define predicates that can be asked for."""
        return tuple(one for one in self.counting(QUERIES) if one.plain and one.heads[0].signature in self.own)

    def _wrong(self, one: Statement) -> Iterator[Problem]:
        """What is wrong with a statement by itself."""
        for atom in (*one.heads, *one.body):
            if atom.signature in UNREACHED and atom.signature not in DECLARED | self.own:
                where = " and ".join(f"{name}.lp" for name in UNREACHED[atom.signature])
                what = f"{_form(atom.signature)} belongs to {where}, which rules of users do not reach"
                yield one.problem(what, atom.at, f"they reach {', '.join(f'{name}.lp' for name in sorted(REACHED))}")
        for atom in one.body:
            if atom.signature not in DECLARED | self.own | self._declared | set(UNREACHED):
                yield one.problem(*_unknown(atom, DECLARED | self.own))
        for atom in one.heads:
            if atom.signature in READ_ONLY:
                what = f"{_form(atom.signature)} says what there is, and rules add nothing to it"
                yield one.problem(what, atom.at)
            elif atom.signature in DECLARED:
                yield from self._bad_constants(one, atom)
            elif atom.name in {name for name, _ in DECLARED} and atom.signature in self.own:
                yield one.problem(*_unknown(atom, DECLARED))

    def _bad_constants(self, one: Statement, atom: RuleAtom) -> Iterator[Problem]:
        """Constants that can stand in no encoding where they do."""
        options = [interface[atom.signature] for interface in REACHED.values() if atom.signature in interface]
        for number, constant in enumerate(atom.constants):
            if constant is not None and options:
                term = facts_of(f"p({constant}).")[0].args[0]
                complaints = [slots[number].check(term) for slots in options]
                if options[0][number].name in PASSING:
                    what = f"there is no {options[0][number].name} {constant}: they are numbered anew each time"
                    yield one.problem(what, atom.places[number], "take the number from the facts, as a variable")
                elif all(complaint is not None for complaint in complaints) and complaints[0] is not None:
                    yield one.problem(complaints[0].what, atom.places[number], complaints[0].hint)

    def _applicable(self, known: frozenset[Signature]) -> tuple[Statement, ...]:
        """The statements of which all is known in an encoding: the greatest set in which own predicates are defined."""
        found = self.statements
        while True:
            defined = {atom.signature for one in found for atom in one.heads} & self.own | self._declared
            left = tuple(one for one in found if self._counts(one, known, defined))
            if left == found:
                return found
            found = left

    def _counts(self, one: Statement, known: frozenset[Signature], defined: set[Signature]) -> bool:
        stated = all(atom.signature in known or atom.signature in self.own for atom in one.heads)
        return stated and all(atom.signature in known | defined for atom in one.body)

    def _useless(self, one: Statement) -> Iterator[Problem]:
        """Why a statement has no effect, if it has none."""
        where = [name for name in KNOWN if one in self._counting[name]]
        if not where:
            names = sorted({_form(atom.signature) for atom in (*one.heads, *one.body)} - {_form(s) for s in self.own})
            what = f"this rule counts nowhere: no encoding knows all of {', '.join(names) or 'what it rests on'}"
            yield one.problem(what, hint="docs/vocabulary.md says which predicates are known together")
        elif where == [QUERIES] and not (one.plain and one.heads[0].signature in self.own):
            what = "this changes nothing: what is believed is stated by the robot, and this rule reaches queries alone"
            yield one.problem(what, hint="define a predicate of your own, which can be asked for")


def _form(signature: Signature) -> str:
    return f"{signature[0]}/{signature[1]}"


def _unknown(atom: RuleAtom, known: Iterable[Signature]) -> tuple[str, tuple[int, int], str]:
    """What is said of an atom whose predicate does not exist."""
    known = set(known)
    forms = sorted(_form(other) for other in known if other[0] == atom.name)
    hint = f"there is {', '.join(forms)}" if forms else did_you_mean(atom.name, {name for name, _ in known})
    return f"unknown predicate {_form(atom.signature)}", atom.at, hint


def misfit(encoding: str, atom: Fact, given: Mapping[Signature, Sequence[Fact]]) -> str:
    """Return why an atom that rules derived cannot stand in an encoding, or ''. given : the facts, by predicate."""
    slots = REACHED[encoding][atom.signature]
    for slot, term in zip(slots, atom.args, strict=True):
        complaint = slot.check(term)
        if complaint is not None:
            return complaint.what
        if slot.name in DOMAINS and str(term) not in _domain(slot, given):
            return f"there is no {slot.name} {term}"
    return ""


def _domain(slot: ArgumentType, given: Mapping[Signature, Sequence[Fact]]) -> set[str]:
    """The names of what given facts speak of."""
    return {str(fact.args[at]) for signature, at in DOMAINS[slot.name] for fact in given.get(signature, ())}
