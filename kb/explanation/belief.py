"""Why a predicate that users' rules define for queries certainly holds: rule instances down to believed facts."""

from collections.abc import Sequence
from functools import lru_cache
from typing import Any

from utak.kb.explanation.programs import (
    BELIEF,
    OBJECT_RULE,
    ExplanationError,
    RuleUnit,
    canonical,
    decision_program,
    texts_of,
    words_of_users,
)
from utak.kb.explanation.support import Support, supports_of
from utak.kb.explanation.tree import ProofTrees
from utak.kb.explanation.values import Proof, RuleInstance, RuleText
from utak.kb.language.atoms import long_form, short_form
from utak.kb.language.diagnostics import BadInputError
from utak.kb.reasoning.query import request_entries
from utak.kb.reasoning.rulebook import Statement
from utak.kb.reasoning.sentences import fill
from utak.kb.reasoning.user_rules import MAX_RULE_SECONDS, read_rules, rules_worker
from utak.kb.tracing.syntax import JsonValues

OBJECT_TEXT = RuleText("queries", 1, 1, OBJECT_RULE, "rule", "{N} is believed to be an object, with {C} percent.")


def explain_query_atom(facts: Sequence[str], atom: str, rule_files: Sequence[str] = ()) -> Proof:
    """Return why an atom certainly holds in queries."""
    (wanted,) = canonical([atom])
    files = tuple(map(str, rule_files))
    trees, holding = _trees(canonical(facts), files, texts_of(files))
    if wanted not in holding:
        raise ExplanationError(f"{wanted} does not certainly hold by what is believed")
    return Proof(BELIEF, trees.node(wanted))


def certain_atoms(facts: Sequence[str], rule_files: Sequence[str] = ()) -> tuple[str, ...]:
    """Return all atoms that certainly hold in queries, believed facts included, sorted."""
    files = tuple(map(str, rule_files))
    return tuple(sorted(_trees(canonical(facts), files, texts_of(files))[1]))


def query_response(
    facts: Sequence[str], rule_files: tuple[str, ...], request: JsonValues
) -> tuple[JsonValues, tuple[Statement, ...]]:
    """Return what the process for queries answers to a request, and the users' rules that took part."""
    rules = read_rules(rule_files).query_rules if rule_files else ()
    whole = {**request, "facts": request_entries(facts), "rules": [one.written for one in rules]}
    found = rules_worker().exchange(whole, MAX_RULE_SECONDS)
    if "limit" in found:
        raise ExplanationError(f"the explanation was given up: {found['limit']}")
    if "rule" in found:
        raise BadInputError([rules[found["rule"]].problem(found["error"], hint=found["hint"])])
    if "error" in found:
        raise ExplanationError(found["error"])
    return found, rules


@lru_cache(maxsize=16)
def _trees(
    facts: tuple[str, ...], rule_files: tuple[str, ...], _texts: tuple[str, ...]
) -> tuple[ProofTrees, frozenset[str]]:
    """Return the proofs of all atoms that certainly hold, and these atoms; the last ones are kept."""
    found, rules = query_response(facts, rule_files, {"justify": True})
    sentences, words = words_of_users(rules)
    units = [_unit(entry, rules, sentences) for entry in found["units"]]
    supports = supports_of(found, units)
    for fact in facts:
        _add_object(fact, supports)
        _add_other_form(fact, supports)
    trees = ProofTrees(
        supports, facts, found["atoms"], {**decision_program(BELIEF).words, **words}, (), _instance, _none
    )
    return trees, frozenset(found["atoms"])


def _unit(entry: dict[str, Any], rules: Sequence[Statement], sentences: Sequence[str]) -> RuleUnit:
    """Return a unit from the response of the worker."""
    number = entry["statement"]
    one, names = rules[number], tuple(entry["names"])
    named = tuple(name for name in one.variables if name in names)
    rule = RuleText(one.source.file, one.at[0], one.at[1], " ".join(one.written.split()), "rule", sentences[number])
    return RuleUnit(rule, named, names, tuple(entry["literals"]), tuple(map(tuple, entry["conditions"])))


def _add_object(fact: str, supports: dict[str, list[Support]]) -> None:
    """Add the instance of OBJECT_RULE that a fact gives, if it is that of an object."""
    name, _, rest = fact.partition("(")
    parts = rest.removesuffix(")").split(",")
    if name == "kind" and len(parts) == 3 and parts[1] == "object":
        unit = RuleUnit(OBJECT_TEXT, ("N", "C"), ("N", "C"), ({"kind": "atom", "text": "kind(N, object, C)"},), ((),))
        one = Support(-1, unit, (parts[0], parts[2]), (fact,), ((),), 0, ())
        supports.setdefault(f"object({parts[0]})", []).append(one)


def _add_other_form(fact: str, supports: dict[str, list[Support]]) -> None:
    """Add that a fact which is known holds in its short form, or in its long one."""
    other = short_form(fact) or long_form(fact)
    if other:
        rule = RuleText("queries", 1, 1, f"{other} :- {fact}.", "rule", "What is stated without a confidence is known.")
        unit = RuleUnit(rule, (), (), ({"kind": "atom", "text": fact},), ((),))
        supports.setdefault(other, []).append(Support(-1, unit, (), (fact,), ((),), 0, ()))


def _instance(support: Support) -> RuleInstance:
    """Return a rule with the values of one of its instances."""
    rule, values = support.unit.rule, dict(zip(support.unit.names, support.values, strict=True))
    named = tuple((name, values[name]) for name in support.unit.variables)
    return RuleInstance(rule, named, fill(rule.sentence, values) or rule.text)


def _none(_support: Support) -> tuple[()]:
    """Return no other ways to choose: rules of queries choose nothing."""
    return ()
