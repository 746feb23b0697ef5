"""Assumptions: facts and rules that a user adds while the robot runs, checked, and brought to where they count.

A fact of a predicate that an encoding knows becomes a rule of that encoding, as with `--kb`. A fact of the world model
that no encoding takes counts for queries alone. Some facts of the world model have an equivalent in
`reconciliation.lp`: what an object's colour is, and what a parameter of the task means.
"""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from utak.kb.language.diagnostics import BadInputError
from utak.kb.language.integers import integers_beyond_32_bits
from utak.kb.language.reader import parse_facts
from utak.kb.language.source_text import Source, source_from_bytes
from utak.kb.language.terms import Fact, Number, Symbol
from utak.kb.language.vocabulary import (
    BELIEF_PREDICATES,
    THING_ARGUMENT,
    Signature,
    check_facts,
    hint_for,
    thing_positions,
)
from utak.kb.reasoning.interfaces import DEFINING_FACTS, READ_ONLY_PREDICATES, READ_ONLY_THERE, USER_RULE_INTERFACES
from utak.kb.reasoning.rulebook import (
    INTERFACE_PREDICATES,
    INTERNAL_PREDICATES,
    PREDICATES_BY_ENCODING,
    QUERY_INTERFACE,
)
from utak.kb.reasoning.user_rules import read_rules, read_tested_sources, sources_of

ASSUMPTION_FILE = "assume"  # the name of an assumption in messages
# By a predicate of the world model: the atom of reconciliation.lp that says the same of a fact; '' for none.
EQUIVALENTS: Mapping[Signature, Callable[[Fact], str]] = {
    ("bound", 2): lambda fact: f"bind({fact.args[0]},{fact.args[1]})",
    ("colour", 3): lambda fact: f"has({fact.args[0]},colour,{fact.args[1]},{fact.args[2]})",
}


class Assumption(NamedTuple):
    """One fact or rule that is assumed."""

    written: str  # the fact or rule in one line, with its full stop
    rule: str  # the text of a rule file that states it; '' when it counts for queries alone
    facts: tuple[str, ...]  # facts that queries see besides those that the robot believes, with their full stops
    # The names of the encodings that it reaches, without `.lp`; () when it counts for queries alone.
    reaches: tuple[str, ...]


def read_assumptions(text: str, kb_files: Sequence[str] = ()) -> tuple[Assumption, ...]:
    """Return the assumptions that a text states: facts, or rules in the language of `--kb`."""
    source = source_from_bytes(ASSUMPTION_FILE, _ended(text).encode("utf-8", errors="surrogateescape"))
    beyond = list(integers_beyond_32_bits(source))
    if beyond:
        raise BadInputError(beyond)
    if ":-" in source.text or ":~" in source.text or "{" in source.text:
        return (_rule(source.text, " ".join(source.text.split()), (), kb_files),)
    facts = parse_facts(source)
    if not facts:
        raise BadInputError([source.problem(source.start(), "nothing is assumed", "such as shape(o1, square, 90).")])
    return tuple(_assumed_fact(source, fact, kb_files) for fact in facts)


def canonical_facts(text: str, file: str) -> tuple[str, ...]:
    """Return the facts of a text as the world model writes them: no blanks, full stops, `org` for `utak`."""
    source = source_from_bytes(file, _ended(text).encode("utf-8", errors="surrogateescape"))
    facts = parse_facts(source)
    if not facts:
        raise BadInputError([source.problem(source.start(), "a fact is wanted", "such as shape(o1, square, 90).")])
    return tuple(f"{_with_org(fact)}." for fact in facts)


def _ended(text: str) -> str:
    """Return a text with a full stop at its end."""
    text = text.strip()
    return text if text.endswith(".") or not text else f"{text}."


def _with_org(fact: Fact) -> Fact:
    """Return a fact of the world model with `org` for `utak` where a thing is named; any other fact as it is."""
    things = thing_positions(fact.signature)
    args = tuple(
        Symbol("org", (), term.span) if at in things and str(term) == "utak" else term
        for at, term in enumerate(fact.args)
    )
    return Symbol(fact.name, args, fact.span)


def _assumed_fact(source: Source, fact: Fact, kb_files: Sequence[str]) -> Assumption:
    """Return the assumption of one fact of a text; raise BadInputError when it cannot be assumed."""
    fact = _with_confidence(source, _with_org(fact))
    written = f"{fact}."
    signature = fact.signature
    if signature in BELIEF_PREDICATES and _counts_for_queries(source, fact):
        types = {fact.name: BELIEF_PREDICATES[signature].arguments}
        problems = check_facts(source, [fact], types)
        if problems:
            raise BadInputError(problems)
        atom = EQUIVALENTS[signature](fact) if signature in EQUIVALENTS else ""
        seen_by_queries = () if signature == ("bound", 2) else (written,)
        if atom:
            (equivalent,) = parse_facts(source_from_bytes(source.file, f"{atom}.".encode()))
            return _rule(_placed(_guarded(equivalent), fact), written, seen_by_queries, kb_files)
        return Assumption(written, "", seen_by_queries, ())
    complaints = [
        check_facts(source, [fact], {fact.name: interface[signature]})
        for interface in USER_RULE_INTERFACES.values()
        if signature in interface
    ]
    if complaints and all(complaints):  # no encoding takes these arguments
        raise BadInputError(complaints[0])
    if signature not in INTERFACE_PREDICATES and signature not in INTERNAL_PREDICATES:
        _require_own_predicate(source, fact, kb_files)
    return _rule(_placed(_guarded(fact), fact), written, (), kb_files)


def _with_confidence(source: Source, fact: Fact) -> Fact:
    """Return the long form of a fact in its short form where that has an effect beyond queries, else the fact."""
    declared = BELIEF_PREDICATES.get(fact.signature)
    if declared is None or declared.long is None:
        return fact
    long = Symbol(fact.name, (*fact.args, Number(100, fact.span)), fact.span)
    return long if long.signature in EQUIVALENTS or not _counts_for_queries(source, long) else fact


def _counts_for_queries(source: Source, fact: Fact) -> bool:
    """Return whether a fact of the world model counts for queries alone: no encoding takes such a fact from rules."""
    signature = fact.signature
    if signature == ("kind", 3) and THING_ARGUMENT.check(fact.args[0]) is None:
        return True
    taking = [
        interface[signature]
        for name, interface in USER_RULE_INTERFACES.items()
        if signature in interface and signature not in {*READ_ONLY_THERE.get(name, ()), *READ_ONLY_PREDICATES}
    ]
    refused = all(check_facts(source, [fact], {fact.name: slots}) for slots in taking)
    believed = check_facts(source, [fact], {fact.name: BELIEF_PREDICATES[signature].arguments})
    return not taking or (refused and not believed)


def _require_own_predicate(source: Source, fact: Fact, kb_files: Sequence[str]) -> None:
    """Raise BadInputError unless the user's rules name the predicate of a fact: nothing would read it."""
    rules = read_rules(kb_files) if kb_files else None
    named = set(rules.predicates) if rules else set()
    if fact.signature in named:
        return
    known = named | INTERFACE_PREDICATES
    hint = hint_for(fact.name, known) or "docs/reference/vocabulary.md lists all of them"
    raise BadInputError([source.problem(fact.span, f"unknown predicate {fact.name}/{len(fact.args)}", hint)])


def _guarded(fact: Fact) -> str:
    """Return a rule that states a fact as long as the things that it names are there."""
    guards = []
    for interface in USER_RULE_INTERFACES.values():
        for slot, term in zip(interface.get(fact.signature, ()), fact.args, strict=False):
            for (name, arity), at in DEFINING_FACTS.get(slot.name, ()):
                if not isinstance(term, Number):
                    guards.append(f"{name}({','.join(str(term) if n == at else '_' for n in range(arity))})")
    return f"{fact} :- {', '.join(dict.fromkeys(guards))}." if guards else f"{fact}."


def _placed(rule: str, fact: Fact) -> str:
    """Return a rule at the line and column of a fact, so that messages about it name the place of the fact."""
    return "\n" * (fact.span.line - 1) + " " * (fact.span.start - 1) + rule


def _rule(text: str, written: str, facts: tuple[str, ...], kb_files: Sequence[str]) -> Assumption:
    """Return the assumption of rules, tested together with the user's files; raise BadInputError for errors."""
    own = source_from_bytes(ASSUMPTION_FILE, text.encode("utf-8", errors="surrogateescape"))
    rules = read_tested_sources([*sources_of([Path(file) for file in kb_files]), own])
    reaches = tuple(
        name
        for name in PREDICATES_BY_ENCODING
        if name != QUERY_INTERFACE and any(one.source == own for one in rules.rules_reaching(name))
    )
    reaches = tuple(name for name in reaches if _states_something(name, own, rules.rules_reaching(name)))
    return Assumption(written, text, facts, reaches)


def _states_something(encoding: str, own: Source, reaching: Sequence[object]) -> bool:
    """Return whether rules that an assumption adds to an encoding can change its answer."""
    known = set(USER_RULE_INTERFACES[encoding])
    atoms = {atom.signature for one in reaching for atom in (*one.heads, *one.body)}  # type: ignore[attr-defined]
    return bool(known & atoms)
