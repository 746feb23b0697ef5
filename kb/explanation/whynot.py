"""Why an atom does not hold in the answer of an encoding: the least change of the facts with which it would."""

from collections.abc import Sequence

from utak.kb.explanation.programs import DecisionProgram, ExplanationError, canonical, decision_program
from utak.kb.explanation.proof import TracedDecision, traced_decision
from utak.kb.explanation.rivals import rivals_of
from utak.kb.explanation.values import Absence, Proof
from utak.kb.explanation.wording import absent_words, atom_words
from utak.kb.language.atoms import atom_parts
from utak.kb.language.reader import facts_from_text
from utak.kb.reasoning.interfaces import USER_RULE_INTERFACES
from utak.kb.tracing.syntax import JsonValues

PAST_FACTS = ("done", "lay")  # of planner/asp/task/history.lp: what was done would not be done by other circumstances


def explain_absence(
    encoding: str,
    facts: Sequence[str],
    answer: Sequence[str] | None,
    atom: str,
    rule_files: Sequence[str] = (),
) -> Absence:
    """Return why an atom does not hold in an answer of an encoding."""
    (wanted,) = canonical([atom])
    files = tuple(map(str, rule_files))
    program, given = decision_program(encoding, files), canonical(facts)
    known: Sequence[str] = given
    rival = None
    if answer is not None:
        shown = canonical(answer)
        decision = traced_decision(encoding, given, shown, files)
        if wanted in decision.atoms:
            raise ExplanationError(f"{wanted} holds in this answer of {encoding}.lp")
        known = sorted(decision.atoms)
        options = decision.supports.get(wanted, ())
        if any(one.unit.rule.kind == "choice" for one in options):
            rival = next(iter(rivals_of(program, given, shown, [wanted], with_none=False)), None)
    found = least_change(program, given, wanted, known)
    missing, in_way = tuple(found["missing"]), tuple(found["in_way"])
    is_single = bool(found["found"]) and len(missing) + len(in_way) <= 1
    partial = not found["least"] or (found["cut"] and not is_single)
    proof = _proof_after(program, given, missing, in_way, wanted) if found["found"] else None
    sentence = _sentence(program, wanted, _otherwise(wanted, known), given, missing, in_way, found["found"])
    return Absence(encoding, wanted, missing, in_way, partial, found["found"], sentence, rival, proof)


def least_change(program: DecisionProgram, given: Sequence[str], wanted: str, known: Sequence[str]) -> JsonValues:
    """Return the least change with which an atom holds, and whether candidates for it were `cut`, as JSON values."""
    request = {"facts": list(given), "atom": wanted}
    candidates = program.ask({**request, "task": "candidates", "known": list(known)})
    candidates["facts"] = [fact for fact in candidates["facts"] if _is_sensible(program.encoding, fact)]
    return {**program.ask({**request, "task": "change", "candidates": candidates}), "cut": candidates["cut"]}


def _is_sensible(encoding: str, fact: str) -> bool:
    """Return whether a candidate fact is not of the past, and its arguments are of the types that are declared."""
    (one,) = facts_from_text(f"{fact}.")
    types = USER_RULE_INTERFACES.get(encoding, {}).get(one.signature)
    fits = types is None or all(type_.check(term) is None for type_, term in zip(types, one.args, strict=True))
    return fits and one.name not in PAST_FACTS


def _proof_after(
    program: DecisionProgram,
    given: Sequence[str],
    missing: Sequence[str],
    in_way: Sequence[str],
    wanted: str,
) -> Proof | None:
    """Return why an atom holds after a change of the given facts; None when no best answer holds it."""
    facts = [fact for fact in given if fact not in in_way] + list(missing)
    found = program.ask({"task": "answer", "facts": facts, "atom": wanted})
    if found["atoms"] is None:
        return None
    try:
        decision = TracedDecision(program, facts, found["atoms"], missing)
    except ExplanationError:  # the search for this answer was cut off
        return None
    return Proof(program.encoding, decision.node(wanted)) if wanted in decision.atoms else None


def _otherwise(wanted: str, known: Sequence[str]) -> str:
    """Return the atom among some that differs from the wanted one in a last number alone; "" for none."""
    name, arguments = atom_parts(wanted)
    rest = f"{name}({','.join(arguments[:-1])}," if len(arguments) > 1 and arguments[-1].isdigit() else ""
    same = [atom for atom in known if rest and atom.startswith(rest) and atom[len(rest) : -1].isdigit()]
    return same[0] if len(same) == 1 else ""


def _sentence(
    program: DecisionProgram,
    wanted: str,
    other: str,
    given: Sequence[str],
    missing: Sequence[str],
    in_way: Sequence[str],
    found: bool,
) -> str:
    """Return in one sentence why an atom does not hold. other : the atom with another last number that does, or ""."""
    said = f"{other} does" if other else absent_words(wanted, program.words)
    start = f"{wanted} does not hold" if said == f"no {wanted} is known" else f"{wanted} does not hold: {said}"
    if not found:
        return f"{start}; no change of the given facts was found with which it would."
    if not missing and not in_way:
        return f"{start}, but another answer that costs the same holds it."
    return f"{start}; it would if {change_in_words(program, given, missing, in_way, 'given')}."


def change_in_words(
    program: DecisionProgram, given: Sequence[str], missing: Sequence[str], in_way: Sequence[str], how: str
) -> str:
    """Return a change of facts as a condition in words. how : what facts are: given, or believed."""
    parts = [f"{_fact_words(fact, program)} were {how}{_replaced(fact, given, how)}" for fact in missing]
    parts += [f"{_fact_words(fact, program)} were not {how}" for fact in in_way]
    return " and ".join(parts)


def _fact_words(fact: str, program: DecisionProgram) -> str:
    """Return a fact with its plain words in brackets, where it has any."""
    words = atom_words(fact, program.words)
    return fact if words == fact else f"{fact} ({words})"


def _replaced(fact: str, given: Sequence[str], how: str) -> str:
    """Return the given fact that differs from another one in one number alone, as an addition to a sentence; or ''."""
    name, arguments = atom_parts(fact)
    for other in given:
        their_name, theirs = atom_parts(other)
        if their_name == name and len(theirs) == len(arguments):
            unlike = [(a, b) for a, b in zip(arguments, theirs, strict=True) if a != b]
            if len(unlike) == 1 and all(part.removeprefix("-").isdigit() for part in unlike[0]):
                return f" ({how} is {other})"
    return ""
