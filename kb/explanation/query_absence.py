"""Why an atom of a predicate that users' rules define for queries does not certainly hold: what is not believed."""

from collections.abc import Sequence
from itertools import count

from utak.kb.explanation.belief import explain_query_atom, query_response
from utak.kb.explanation.programs import BELIEF, ExplanationError, canonical, decision_program
from utak.kb.explanation.values import Absence, Proof
from utak.kb.explanation.whynot import change_in_words, least_change
from utak.kb.language.atoms import long_form, short_form
from utak.kb.language.diagnostics import SourceSpan
from utak.kb.language.goal_words import CORNER_NAMES
from utak.kb.language.terms import Number, Symbol, Term
from utak.kb.language.vocabulary import BELIEF_PREDICATES, SHAPE_CLASSES

NUMBERED_LETTERS = "odrjl"  # of objects, doors, rooms, junctions and links, which have a number behind them


def explain_query_absence(facts: Sequence[str], atom: str, rule_files: Sequence[str] = ()) -> Absence:
    """Return why an atom does not certainly hold in queries."""
    (wanted,) = canonical([atom])
    files, given = tuple(map(str, rule_files)), canonical(facts)
    answer = _answer(given, wanted, files)
    if answer == "yes":
        raise ExplanationError(f"{wanted} certainly holds by what is believed")
    program = decision_program(BELIEF, files)
    found = least_change(program, given, wanted, [*given, *_possible_atoms(given)])
    missing, in_way = tuple(found["missing"]), tuple(found["in_way"])
    proof = _proof_after(given, missing, in_way, wanted, files) if found["found"] else None
    start = f"{wanted} does not hold" if answer == "no" else f"whether {wanted} holds is not known"
    if not found["found"]:
        sentence = f"{start}; no change of what is believed was found with which it would certainly hold."
    elif not missing and not in_way:
        sentence = f"{start}: what is believed allows it, and something that was not seen could rule it out."
    elif proof is None:
        change = change_in_words(program, given, missing, in_way, "believed")
        sentence = f"{start}; if {change}, it would be possible, and still not certain."
    else:
        sentence = f"{start}; it would if {change_in_words(program, given, missing, in_way, 'believed')}."
    if proof is None:
        return Absence(BELIEF, wanted, (), (), bool(found["cut"]) or found["found"], False, sentence)
    partial = not found["least"] or (bool(found["cut"]) and len(missing) + len(in_way) > 1)
    return Absence(BELIEF, wanted, missing, in_way, partial, True, sentence, None, proof)


def _possible_atoms(given: Sequence[str]) -> list[str]:
    """Return atoms of all believed predicates with unused names, and with the classes of the vocabulary."""
    told = " ".join(given)
    numbered = [next(f"{letter}{n}" for n in count(1) if f"{letter}{n}" not in told) for letter in NUMBERED_LETTERS]
    nowhere, words = SourceSpan(1, 1, 1), [*numbered, *SHAPE_CLASSES, *CORNER_NAMES, "object"]
    terms: list[Term] = [*(Symbol(word, (), nowhere) for word in words), Number(100, nowhere)]
    unfit = Symbol("any_other_name", (), nowhere)
    found = []
    for (name, _), predicate in BELIEF_PREDICATES.items():
        values = [[str(term) for term in terms if type_.check(term) is None] for type_ in predicate.arguments]
        if all(values) and not any(type_.check(unfit) is None for type_ in predicate.arguments):
            most = max(map(len, values))
            found += [f"{name}({','.join(one[n % len(one)] for one in values)})" for n in range(most)]
    return found


def _answer(facts: Sequence[str], atom: str, rule_files: tuple[str, ...]) -> str:
    """Return what queries answer to an atom: yes, no or don't know."""
    found, _ = query_response(facts, rule_files, {"query": atom, "max_rows": 1, "number": 0})
    return str(found["answer"])


def _proof_after(
    given: Sequence[str], missing: Sequence[str], in_way: Sequence[str], wanted: str, rule_files: tuple[str, ...]
) -> Proof | None:
    """Return why an atom certainly holds after a change of what is believed; None when it does not."""
    try:
        gone = {*in_way, *map(short_form, in_way), *map(long_form, in_way)}
        return explain_query_atom([*(fact for fact in given if fact not in gone), *missing], wanted, rule_files)
    except ExplanationError:
        return None
